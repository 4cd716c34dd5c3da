//! Common inputs of the subcommands that evaluate a protocol on a campaign.

use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{Console, Exit};
use super::protocols::load;
use crate::certify::{Compiled, compile};
use crate::check::family::{self, Family};
use crate::check::{Override, Overrides, plan::SetBy};
use crate::data::Campaign;
use crate::data::text::read_text;
use crate::library;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Spanned};
use crate::syntax::document::Text;

/// Maximum number of records processed in parallel. Each takes a thread, and memory for its text and signals. The value exceeds the number
/// of cores of the machines the program is used on.
const MOST_JOBS: usize = 256;

/// Starts the requested number of threads.
///
/// # Errors
/// The number exceeds [`MOST_JOBS`]; the exit code.
pub fn start_jobs(jobs: Option<NonZeroUsize>, console: &Console) -> Result<(), Exit> {
    let Some(jobs) = jobs.map(NonZeroUsize::get) else { return Ok(()) };
    if jobs > MOST_JOBS {
        let says = format!("`--jobs {jobs}` exceeds the maximum of {MOST_JOBS}");
        return Err(console.fail(Problem::error("jobs", says).help("omit it to use one per core"), Exit::Wrong));
    }
    // Fails only if the thread pool exists already, which is not the case here.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(jobs).build_global();
    Ok(())
}

/// A compiled protocol and its campaign.
#[derive(Debug)]
pub struct Prepared {
    pub compiled: Compiled,
    pub campaign: Campaign,
    pub overrides: Overrides,
}

/// Opens a campaign and compiles the protocol named on the command line, else the campaign's, else the first shipped one.
pub fn prepare(folder: &Path, protocol: Option<&str>, set: &[String], problems: &mut Problems) -> Option<Prepared> {
    let campaign = Campaign::open(folder, problems)?;
    let family = match (protocol, &campaign.protocol) {
        (Some(name), _) => load(name, problems),
        (None, Some(named)) => campaign_protocol(&campaign, named, problems),
        (None, None) => load(library::SHIPPED[0].name, problems),
    }?;
    let overrides = overrides(set, &campaign, problems)?;
    let compiled = compile(family, &overrides, problems)?;
    facts_like_parameters(&compiled, &campaign, problems);
    Some(Prepared { compiled, campaign, overrides })
}

/// A fact of the campaign sets nothing; one with the name of a parameter was most likely meant to.
fn facts_like_parameters(compiled: &Compiled, campaign: &Campaign, problems: &mut Problems) {
    for fact in campaign.facts.iter().filter(|fact| compiled.plan.parameters.iter().any(|parameter| parameter.name == fact.name)) {
        let says = format!("`{}` is a parameter of the protocol, and is not set by a fact of the campaign", fact.name);
        let problem = Problem::warning("fact-like-parameter", says).at(&fact.span);
        problems.push(problem.help("to set it, let it stand below `parameters`, indented"));
    }
}

/// Parameters of the campaign, and over them those of the command line.
fn overrides(set: &[String], campaign: &Campaign, problems: &mut Problems) -> Option<Overrides> {
    let mut overrides = Overrides::new();
    for parameter in &campaign.parameters {
        let value = &parameter.value;
        let text = Text { text: value.raw.clone(), span: value.span.clone(), exact: value.exact };
        overrides.insert(parameter.name.text.clone(), Override { text, set_by: SetBy::Campaign });
    }
    for set in set {
        let Some((name, value)) = set.split_once('=') else {
            problems.push(Problem::error("set", format!("`--set {set}` has no `=`")).help("write `--set name=value`"));
            return None;
        };
        let source = Source::new("--set", set.clone());
        let span = source.span(name.len() + 1..set.len());
        overrides.insert(
            name.trim().to_string(),
            Override { text: Text { text: value.to_string(), span, exact: true }, set_by: SetBy::CommandLine },
        );
    }
    Some(overrides)
}

/// The protocol that a campaign names: a shipped one, or a file inside the campaign; the same for those it extends.
fn campaign_protocol(campaign: &Campaign, named: &Spanned<String>, problems: &mut Problems) -> Option<Family> {
    let inside = |named: &Spanned<String>| {
        if let Some(shipped) = library::shipped(&named.value) {
            return Ok(shipped);
        }
        let place = campaign.place(named)?;
        read_text(&place.path, &place.shown).map(|(source, _)| source).map_err(|problem| {
            let problem = if problem.at.is_some() { problem } else { problem.at(&named.span) };
            if problem.code == "file-missing" { problem.suggest(&named.value, library::names()) } else { problem }
        })
    };
    let source = inside(named).map_err(|problem| problems.push(problem)).ok()?;
    let parent = |name: &str, from: &Source| {
        if let Some(shipped) = library::shipped(name) {
            return Ok(shipped);
        }
        let beside = Path::new(campaign.inside(&from.name)).parent().unwrap_or(Path::new(""));
        inside(&Spanned::new(beside.join(name).display().to_string(), source.whole())).map_err(Box::new)
    };
    Some(family::read(&source, &parent, problems))
}

/// A progress bar on a terminal; nothing if the output is redirected.
pub fn progress_bar(console: &Console, steps: usize) -> Arc<ProgressBar> {
    let bar = ProgressBar::new(steps as u64);
    if console.quiet {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    Arc::new(bar)
}
