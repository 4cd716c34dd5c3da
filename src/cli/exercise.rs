//! `exercise`: two campaigns for each limit of a protocol, inside and outside of it.

use super::{inputs::compiled_for, kit::*};
use crate::certify::Opened;
use crate::exercise::{Mutate, complete, exercise, limits_of};
use crate::report::number::significant;
use crate::result::{
    self,
    exercise::{self as found, Disturbance, Mutated, NoPair, Over, Pair, Shape},
};

/// The numbers of what was made.
const FILE: &str = "exercise.json";

#[derive(Debug, Args)]
pub struct Exercise {
    /// Path of a protocol, or name of a shipped one.
    protocol: String,
    /// Folder of a campaign in which every limit holds; its records are changed [default: records
    /// that are drawn].
    #[arg(long, value_name = "CAMPAIGN")]
    from: Option<PathBuf>,
    /// Output folder; created if missing.
    #[arg(long, short)]
    out: PathBuf,
    /// Also change each number of the text of the protocol by 1 %, and tell which changes no pair
    /// notices.
    #[arg(long)]
    mutate: bool,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Number of threads [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Exercise {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let Opened { compiled, campaigns, overrides, .. } = console.read(|problems| {
            let campaigns = self.from.as_slice();
            let opened = compiled_for(campaigns, Some(&self.protocol), &self.set, problems)?;
            check_outputs(&self.out, CAMPAIGN, &opened.campaigns, problems);
            Some(opened)
        })?;
        let mut outputs = Outputs::of(SetKind::Campaign, &self.out);
        let steps = limits_of(&compiled);
        let found = console.with_progress(steps, |progress| {
            let mutate = Mutate { overrides: &overrides, find: &library::parent };
            let mutate = self.mutate.then_some(mutate);
            exercise(&compiled, campaigns.first(), mutate, &mut outputs, progress)
        })?;
        let added = outputs.add(FILE, result::text(&found).as_bytes());
        console.commit(added.map(|()| outputs))?;
        console.written(&lines(&found), &self.out)?;
        Ok(if complete(&found) { Exit::Done } else { Exit::DoesNotHold })
    }
}

fn lines(found: &found::Exercise) -> Lines {
    let pairs = found.limits.iter().filter(|of| of.pair.is_some()).count();
    let mut all = vec![match found.limits.len() {
        0 => format!("{} states no limit, so that there is nothing to test", found.protocol),
        limits => format!(
            "{}: {pairs} of {limits} limits have a pair of campaigns, made from {}",
            found.protocol, found.campaign
        ),
    }];
    if found.gap < 1.0 {
        let kept = significant(100.0 * found.gap, 2);
        all.push(format!("  {kept} % of the difference of measurement and simulation was kept"));
    }
    for of in &found.limits {
        let says = of.pair.as_ref().map(in_words).or_else(|| of.reason.as_ref().map(why));
        all.push(format!("  {}: {}", of.limit, says.unwrap_or_default()));
    }
    let unnoticed: Vec<&Mutated> =
        found.mutations.iter().filter(|of| of.noticed_by.is_none()).collect();
    if !found.mutations.is_empty() {
        let noticed = found.mutations.len() - unnoticed.len();
        let of = found.mutations.len();
        all.push(format!("numbers changed by 1 %: {noticed} of {of} changes are noticed; not:"));
    }
    for Mutated { line, field, from, to, .. } in unnoticed {
        all.push(format!("  line {line}, {field}: {from} -> {}", significant(*to, 6)));
    }
    all.into_iter().collect()
}

fn in_words(pair: &Pair) -> String {
    let Disturbance { record, columns, shape, over } = &pair.disturbance;
    let shape = match shape {
        Shape::Level => "a constant".to_string(),
        Shape::Gain => "a part of its fluctuation".to_string(),
        Shape::Peaks => "peaks".to_string(),
        Shape::Tone { frequency } => format!("a tone of {frequency} Hz"),
    };
    let over = match over {
        Over::All => "all sections".to_string(),
        Over::Alternating => "all sections, with one sign and the other in turn".into(),
        Over::Section { section } => format!("section {}", section + 1),
    };
    let percent = |of: f64| significant(100.0 * of.abs(), 2);
    let (inside, outside) = (percent(pair.inside.distance), percent(pair.outside.distance));
    let columns = columns.join(", ");
    format!("{inside} % inside, {outside} % outside; {shape} added to {columns}, {record}, {over}")
}

fn why(reason: &NoPair) -> String {
    match reason {
        NoPair::NotInForce => "no pair: it judges nothing in this campaign".into(),
        NoPair::OutOfReach => "no pair: nothing that was added brings its value to it".into(),
        NoPair::NotAlone { others } => {
            format!("no pair: with it changes what is said of {}", others.join("; "))
        }
    }
}
