//! Before a diagnosis: each effect once on one section. It shows which features an effect changes, and stops at a simulator that fails.

use rayon::prelude::*;

use super::settings::Settings;
use crate::data::Campaign;
use crate::diagnose::features::layout::Kind;
use crate::diagnose::features::observations::Observations;
use crate::diagnose::levels::preflight::{LISTED, SEEN};
use crate::effects::{Action, Applied, Catalogue, Effect, Fit};
use crate::problem::{Problem, Problems};
use crate::simulate::{Plan, Section, Simulator, Task};

/// What the effects of a catalogue change in one section.
#[derive(Debug)]
pub struct Preflight {
    pub section: String,
    /// Number of features.
    pub features: usize,
    /// In the order of the catalogue.
    pub effects: Vec<Moved>,
    /// Effects for which the simulator has no parameter.
    pub left_out: Vec<String>,
}

/// What one effect of one size changes.
#[derive(Debug)]
pub struct Moved {
    pub title: String,
    /// `coulomb 0.1 N m`
    pub size: String,
    /// Features that change by a standard deviation or more, the largest change first: what it is, and the change in standard deviations.
    pub features: Vec<(String, f64)>,
}

/// Runs each effect of a catalogue on the first section that can be compared.
///
/// # Errors
/// No section can be compared; no effect has a parameter of this simulator; the first failure of the simulator.
pub fn preflight(
    campaign: &Campaign,
    sections: &[Section],
    catalogue: &Catalogue,
    settings: &Settings,
    simulator: Option<&dyn Simulator>,
) -> Result<Preflight, Problems> {
    let one = |problem: Problem| Problems(vec![problem]);
    let mut problems = Problems::default();
    let unit = |channel: &str| simulator?.unit(channel);
    let mut seen = None;
    for section in sections {
        problems = Problems::default();
        seen = Observations::read(campaign, vec![section.clone()], catalogue, settings, &|_| None, &unit, &mut problems);
        if seen.is_some() {
            break;
        }
    }
    let Some(seen) = seen else { return Err(problems) };
    let observed = &seen.sections[0];
    let name = simulator.and_then(Simulator::catalogue_name);
    let reached = |effect: &&Effect| effect.action != Action::Simulator || simulator.is_some() && reaches(effect, name);
    let candidates = || catalogue.effects.iter().filter(|effect| effect.candidate && !effect.fits.is_empty());
    let simulated = |effect: &&Effect| effect.action == Action::Simulator;
    if let (Some(name), true, false) =
        (name, candidates().any(|effect| simulated(&effect)), candidates().any(|one| simulated(&one) && reached(&one)))
    {
        return Err(one(other_name(catalogue, name)));
    }
    let run = |settings: &[(String, f64)]| match simulator {
        Some(simulator) => simulator.run(&Task { section: &observed.section, settings, shift: 0.0, inside_only: false }),
        None => Ok(observed.simulated.clone()),
    };
    let without = run(&[]).map_err(one)?;
    let before = seen.of(0, &without, true);
    let each = |(effect, fit): &(&Effect, &Fit)| -> Result<Moved, Problem> {
        let (applied, size) = applied(effect, fit);
        let plan = Plan::new(catalogue, &applied, &observed.section, name)?;
        let mut signals = if plan.settings.is_empty() { without.clone() } else { run(&plan.settings)? };
        plan.operate(&mut signals, &observed.section)?;
        let after = seen.of(0, &signals, true);
        Ok(Moved { title: effect.title.clone(), size, features: moved(&seen, settings, &before, &after) })
    };
    let fits: Vec<(&Effect, &Fit)> =
        candidates().filter(reached).flat_map(|effect| effect.fits.iter().map(move |fit| (effect, fit))).collect();
    let made: Vec<Result<Moved, Problem>> = fits.par_iter().map(each).collect();
    let effects = made.into_iter().collect::<Result<Vec<Moved>, Problem>>().map_err(one)?;
    let left_out = candidates().filter(|effect| !reached(effect)).map(|effect| effect.title.clone()).collect();
    Ok(Preflight { section: observed.section.name().to_string(), features: seen.features.len(), effects, left_out })
}

/// Whether the catalogue says how a simulator adds the fitted parameters of an effect.
fn reaches(effect: &Effect, simulator: Option<&str>) -> bool {
    effect.fits.iter().flat_map(|fit| &fit.axes).all(|(at, _)| {
        let parameter = &effect.parameters[*at];
        match simulator {
            None => parameter.model.is_some(),
            Some(name) => parameter.simulators.iter().any(|(known, ..)| known == name),
        }
    })
}

fn other_name(catalogue: &Catalogue, name: &str) -> Problem {
    let parameters = catalogue.effects.iter().flat_map(|effect| &effect.parameters);
    let mut known: Vec<&str> = parameters.flat_map(|parameter| &parameter.simulators).map(|(known, ..)| known.as_str()).collect();
    known.sort_unstable();
    known.dedup();
    let says = format!("no effect of the catalogue `{}` has a parameter of the simulator `{name}`", catalogue.name);
    let problem =
        Problem::error("not-simulated", says).at(&catalogue.source.span(0..catalogue.source.text.lines().next().map_or(0, str::len)));
    problem.suggest(name, known)
}

/// A candidate at its default size, or at its largest trial if the default changes nothing, on its first channels.
fn applied(effect: &Effect, fit: &Fit) -> (Vec<Applied>, String) {
    let size = |(at, trials): &(usize, Vec<f64>)| {
        let parameter = &effect.parameters[*at];
        let changes = parameter.neutral != Some(parameter.default);
        (parameter, if changes { parameter.default } else { trials.last().copied().unwrap_or(parameter.default) })
    };
    let sizes: Vec<_> = fit.axes.iter().map(size).collect();
    let channels = fit.channels.first().cloned().unwrap_or_default();
    let mut words: Vec<String> = sizes
        .iter()
        .map(|(parameter, value)| format!("{} {value}{}", parameter.name.trim_end_matches(".<channel>"), parameter.unit.suffix()))
        .collect();
    if effect.action != Action::Simulator && !channels.is_empty() {
        words.push(format!("on {}", channels.join(", ")));
    }
    let values = sizes.iter().map(|(parameter, value)| (parameter.name.clone(), *value)).collect();
    (vec![Applied { effect: effect.name.clone(), values, channels, confined: None }], words.join(", "))
}

/// Features that change by a standard deviation or more. The standard deviation is that of one feature in one section, from the catalogue
/// and, for a level, from the record.
fn moved(seen: &Observations, settings: &Settings, before: &[f64], after: &[f64]) -> Vec<(String, f64)> {
    let mut found: Vec<(String, f64)> = Vec::new();
    for (at, feature) in seen.features.iter().enumerate() {
        let channel = &seen.layout.channels[feature.channel];
        let group = &settings.groups[channel.group];
        let scatter = seen.sections[0].scatter[feature.channel];
        let edges = &seen.layout.edges;
        let (sd, what) = match feature.kind {
            Kind::Level => (group.level_sd.hypot(scatter.level.sqrt()), "level".to_string()),
            Kind::Band(band) => (group.band_sd, format!("{} to {} Hz", edges[band], edges[band + 1])),
            Kind::Gain => (group.gain_sd, "gain".to_string()),
            Kind::Lag if !scatter.has_lag => continue,
            // The preflight has no changes of all effects to compare with.
            Kind::Increment(_) => continue,
            Kind::Lag => (group.lag_sd, "lag".to_string()),
        };
        let change = (after[at] - before[at]) / sd.max(f64::MIN_POSITIVE);
        if change.abs() >= SEEN {
            found.push((format!("{} {what}", channel.name), change));
        }
    }
    found.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
    found
}

impl Preflight {
    /// One line for each effect.
    #[must_use]
    pub fn in_words(&self) -> String {
        use std::fmt::Write;
        let mut out =
            format!("Preflight on section {}, {} features; sd: one standard deviation of a feature\n", self.section, self.features);
        for effect in &self.effects {
            let _ = write!(out, "  {}, {}: ", effect.title, effect.size);
            if effect.features.is_empty() {
                out += "changes no feature by one sd; it cannot be seen in this section\n";
                continue;
            }
            let listed = effect.features.iter().take(LISTED).map(|(what, by)| format!("{what} {by:+.1} sd"));
            out += &listed.collect::<Vec<_>>().join(", ");
            let more = effect.features.len().saturating_sub(LISTED);
            out += &if more > 0 { format!(", and {more} more\n") } else { "\n".to_string() };
        }
        for title in &self.left_out {
            let _ = writeln!(out, "  {title}: the simulator has no parameter for it; it is not tested");
        }
        out
    }
}
