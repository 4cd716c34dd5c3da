//! The simulation as the measuring chain would have recorded it.

use rayon::prelude::*;

use crate::diagnose::levels::recorded::SEED;
use crate::diagnose::linearise::sensitivity::expected;
use crate::diagnose::observe::{
    bench::{Bench, Runs},
    observations::Observations,
};
use crate::diagnose::settings::Settings;
use crate::effects::{Gauss, Signals};
use crate::simulate::{Task, incremented};

/// Signals and their features, section by section.
#[derive(Debug, Default)]
pub struct Recorded {
    pub signals: Vec<Signals>,
    pub features: Vec<f64>,
}

/// The campaign's simulation, section by section, with the expected deviation of the tolerances and
/// with the declared white noise. An operation of the measuring chain also acts on these. They
/// matter where the simulation has almost no content, as at wavelengths below the shortest of its
/// track. `value` gives a parameter's value where no setting changes it. A section for which the
/// expected deviation cannot be simulated has the noise alone.
pub fn as_recorded(
    seen: &Observations,
    bench: Option<&Bench<'_>>,
    settings: &Settings,
    value: &(dyn Fn(&str) -> Option<f64> + Sync),
    declared: &dyn Fn(&str) -> Option<f64>,
    runs: &mut Runs,
) -> Recorded {
    let there = expected(settings, value, declared);
    let each = |at: usize| {
        let observed = &seen.sections[at];
        let mut signals = observed.simulated.clone();
        let mut failed = None;
        if let Some(bench) = bench.filter(|_| !there.is_empty()) {
            let run = |settings: &[(String, f64)]| {
                bench.simulator.run(&Task {
                    section: &observed.section,
                    settings,
                    shift: 0.0,
                    inside_only: false,
                })
            };
            match run(&there).and_then(|with| Ok((with, run(&[])?))) {
                Ok((with, without)) => signals = incremented(&signals, &with, &without),
                Err(problem) => failed = Some(problem.says),
            }
        }
        for (of, sd) in seen.layout.channels.iter().zip(&seen.noise).filter(|(_, sd)| **sd > 0.0) {
            let mut random = Gauss::new(SEED);
            let values = signals
                .channels
                .iter_mut()
                .filter(|channel| channel.name == of.name)
                .flat_map(|channel| &mut channel.values);
            values.for_each(|value| *value += sd * random.next());
        }
        (signals, failed)
    };
    let made: Vec<(Signals, Option<String>)> =
        (0..seen.sections.len()).into_par_iter().map(each).collect();
    if bench.is_some() && !there.is_empty() {
        runs.made += 2 * made.len();
    }
    runs.failed.extend(made.iter().find_map(|(_, failed)| {
        failed.as_ref().map(|says| format!("expected deviation of the tolerances: {says}"))
    }));
    let signals: Vec<Signals> = made.into_iter().map(|(signals, _)| signals).collect();
    // The signals contain their noise already.
    let features = signals
        .par_iter()
        .enumerate()
        .flat_map_iter(|(at, signals)| seen.of(at, signals, false))
        .collect();
    Recorded { signals, features }
}
