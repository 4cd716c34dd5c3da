//! Before a diagnosis: each effect once on one section. It shows which features an effect changes,
//! and stops at a simulator that fails.

use indexmap::IndexSet;
use rayon::prelude::*;

use super::settings::Settings;
use crate::data::Campaign;
use crate::diagnose::levels::preflight::{LISTED, SEEN};
use crate::diagnose::observe::{layout::Kind, observations::Observations};
use crate::effects::{Action, Applied, Catalogue, Effect, Fit, Parameter};
use crate::problem::{Problem, Problems};
use crate::simulate::{Plan, Section, Simulator, Task};
use crate::terminal::Lines;

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
    /// How it was tested: once, or on each of its channels.
    pub tries: Vec<Try>,
}

/// An effect on some channels.
#[derive(Debug)]
pub struct Try {
    /// Empty for an effect of the simulator.
    pub channels: Vec<String>,
    /// Features that change by a standard deviation or more, the largest change first: what it is,
    /// and the change in standard deviations.
    pub features: Vec<(String, f64)>,
}

/// Runs each effect of a catalogue on the first section that can be compared.
///
/// # Errors
/// No section can be compared; no effect has a parameter of this simulator; the first failure of
/// the simulator.
pub fn preflight(
    campaign: &Campaign,
    sections: &[Section],
    catalogue: &Catalogue,
    settings: &Settings,
    simulator: Option<&dyn Simulator>,
) -> Result<Preflight, Problems> {
    let mut problems = Problems::default();
    let unit = |channel: &str| simulator?.unit(channel);
    let mut seen = None;
    for section in sections {
        problems = Problems::default();
        seen = Observations::read(
            campaign,
            vec![section.clone()],
            catalogue,
            settings,
            &|_| None,
            &unit,
            &mut problems,
        );
        if seen.is_some() {
            break;
        }
    }
    let Some(seen) = seen else { return Err(problems) };
    let observed = &seen.sections[0];
    let name = simulator.and_then(Simulator::catalogue_name);
    let reached = |effect: &&Effect| {
        effect.action != Action::Simulator || simulator.is_some() && reaches(effect, name)
    };
    let candidates =
        || catalogue.effects.iter().filter(|effect| effect.candidate && !effect.fits.is_empty());
    let simulated = |effect: &&Effect| effect.action == Action::Simulator;
    if let (Some(name), true, false) = (
        name,
        candidates().any(|effect| simulated(&effect)),
        candidates().any(|one| simulated(&one) && reached(&one)),
    ) {
        return Err(other_name(catalogue, name).into());
    }
    let run = |settings: &[(String, f64)]| match simulator {
        Some(simulator) => simulator.run(&Task {
            section: &observed.section,
            settings,
            shift: 0.0,
            inside_only: false,
        }),
        None => Ok(observed.simulated.clone()),
    };
    let without = run(&[])?;
    let before = seen.of(0, &without, true);
    let each = |(effect, fit, channels): &(&Effect, &Fit, Vec<String>)| -> Result<Try, Problem> {
        let applied = applied(effect, fit, channels);
        let plan = Plan::new(catalogue, &applied, &observed.section, name)?;
        let mut signals =
            if plan.settings.is_empty() { without.clone() } else { run(&plan.settings)? };
        plan.operate(&mut signals, &observed.section)?;
        let after = seen.of(0, &signals, true);
        let on = if effect.action == Action::Simulator { Vec::new() } else { channels.clone() };
        // A channel of several groups is named once.
        let on: Vec<String> = on.into_iter().collect::<IndexSet<_>>().into_iter().collect();
        Ok(Try { channels: on, features: moved(&seen, settings, &before, &after) })
    };
    let fits = || {
        candidates()
            .filter(reached)
            .flat_map(|effect| effect.fits.iter().map(move |fit| (effect, fit)))
    };
    let tries: Vec<(&Effect, &Fit, Vec<String>)> = fits()
        .flat_map(|(effect, fit)| {
            on(effect, fit).into_iter().map(move |channels| (effect, fit, channels))
        })
        .collect();
    let made: Vec<Result<Try, Problem>> = tries.par_iter().map(each).collect();
    let mut made = made.into_iter().collect::<Result<Vec<Try>, Problem>>()?.into_iter();
    let moved = |(effect, fit): (&Effect, &Fit)| Moved {
        title: effect.title.clone(),
        size: size(fit, effect),
        tries: made.by_ref().take(on(effect, fit).len()).collect(),
    };
    let effects = fits().map(moved).collect();
    let left_out =
        candidates().filter(|effect| !reached(effect)).map(|effect| effect.title.clone()).collect();
    Ok(Preflight {
        section: observed.section.name().to_string(),
        features: seen.features.len(),
        effects,
        left_out,
    })
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
    let mut known: Vec<&str> = parameters
        .flat_map(|parameter| &parameter.simulators)
        .map(|(known, ..)| known.as_str())
        .collect();
    known.sort_unstable();
    known.dedup();
    let says = format!(
        "no effect of the catalogue `{}` has a parameter of the simulator `{name}`",
        catalogue.name
    );
    let problem = Problem::error("not-simulated", says)
        .at(&catalogue.source.span(0..catalogue.source.text.lines().next().map_or(0, str::len)));
    problem.suggest(name, known)
}

/// The sets of channels that a candidate is tested on: each that it may act on.
fn on(effect: &Effect, fit: &Fit) -> Vec<Vec<String>> {
    if effect.action == Action::Simulator || fit.channels.is_empty() {
        return vec![fit.channels.first().cloned().unwrap_or_default()];
    }
    fit.channels.clone()
}

/// The parameters of a candidate at their default sizes, or at their largest trials if the defaults
/// change nothing.
fn sizes<'a>(effect: &'a Effect, fit: &Fit) -> Vec<(&'a Parameter, f64)> {
    let size = |(at, trials): &(usize, Vec<f64>)| {
        let parameter = &effect.parameters[*at];
        let changes = parameter.neutral != Some(parameter.default);
        (
            parameter,
            if changes {
                parameter.default
            } else {
                trials.last().copied().unwrap_or(parameter.default)
            },
        )
    };
    fit.axes.iter().map(size).collect()
}

fn size(fit: &Fit, effect: &Effect) -> String {
    let one = |(parameter, value): &(&Parameter, f64)| {
        format!(
            "{} {value}{}",
            parameter.name.trim_end_matches(".<channel>"),
            parameter.unit.suffix()
        )
    };
    sizes(effect, fit).iter().map(one).collect::<Vec<_>>().join(", ")
}

fn applied(effect: &Effect, fit: &Fit, channels: &[String]) -> Vec<Applied> {
    let values = sizes(effect, fit)
        .iter()
        .map(|(parameter, value)| (parameter.name.clone(), *value))
        .collect();
    vec![Applied {
        effect: effect.name.clone(),
        values,
        channels: channels.to_vec(),
        confined: None,
    }]
}

/// Features that change by a standard deviation or more. The standard deviation is that of one
/// feature in one section, from the catalogue and, for a level, from the record.
fn moved(
    seen: &Observations,
    settings: &Settings,
    before: &[f64],
    after: &[f64],
) -> Vec<(String, f64)> {
    let mut found: Vec<(String, f64)> = Vec::new();
    for (at, feature) in seen.features.iter().enumerate() {
        let channel = &seen.layout.channels[feature.channel];
        let group = &settings.groups[channel.group];
        let scatter = seen.sections[0].scatter[feature.channel];
        let edges = &seen.layout.edges;
        let (sd, what) = match feature.kind {
            Kind::Level => (group.level_sd.hypot(scatter.level.sqrt()), "level".to_string()),
            Kind::Band(band) => {
                (group.band_sd, format!("{} to {} Hz", edges[band], edges[band + 1]))
            }
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

impl Moved {
    /// ` on x: x level +3.2 sd`; of several sets of channels the largest change, and the channels
    /// without one.
    fn in_words(&self) -> String {
        let on = |of: &Try| {
            if of.channels.is_empty() {
                String::new()
            } else {
                format!(" on {}", of.channels.join(", "))
            }
        };
        let Some(largest) = self.tries.iter().max_by(|a, b| a.largest().total_cmp(&b.largest()))
        else {
            return String::new();
        };
        let unseen: Vec<String> = self
            .tries
            .iter()
            .filter(|of| of.features.is_empty())
            .map(|of| of.channels.join(", "))
            .collect();
        let each = if self.tries.len() > 1 {
            format!(" on each of {}, the largest change", self.tries.len())
        } else {
            String::new()
        };
        if largest.features.is_empty() {
            let on = if self.tries.len() > 1 {
                format!(" on each of {}", self.tries.len())
            } else {
                on(largest)
            };
            // The preflight cannot tell a parameter without effect from one that the simulator does
            // not read.
            let why = if largest.channels.is_empty() {
                "it cannot be seen in this section, or the simulator does not use the parameter"
            } else {
                "it cannot be seen in this section"
            };
            return format!("{on}: changes no feature by one sd; {why}");
        }
        let rest = match unseen.len() {
            0 => String::new(),
            1..=LISTED => format!("; it cannot be seen on {}", unseen.join("; ")),
            many => format!(
                "; it cannot be seen on {many} of them: {}, ...",
                unseen[..LISTED].join("; ")
            ),
        };
        format!("{each}{}: {}{rest}", on(largest), largest.in_words())
    }
}

impl Try {
    fn largest(&self) -> f64 {
        self.features.first().map_or(0.0, |(_, by)| by.abs())
    }

    fn in_words(&self) -> String {
        let mut parts: Vec<String> = self
            .features
            .iter()
            .take(LISTED)
            .map(|(what, by)| format!("{what} {by:+.1} sd"))
            .collect();
        let more = self.features.len() - parts.len();
        parts.extend((more > 0).then(|| format!("and {more} more")));
        parts.join(", ")
    }
}

impl Preflight {
    /// One line for each effect.
    pub fn in_words(&self) -> Lines {
        use std::fmt::Write;
        let mut out = Lines::default();
        let _ = writeln!(
            out,
            "Preflight on section {}, {} features; sd: one standard deviation of a feature",
            self.section, self.features
        );
        for effect in &self.effects {
            let _ = writeln!(out, "  {}, {}{}", effect.title, effect.size, effect.in_words());
        }
        for title in &self.left_out {
            let _ =
                writeln!(out, "  {title}: the simulator has no parameter for it; it is not tested");
        }
        out
    }
}
