//! Sensitivity of the simulated features to the declared tolerances.

use rayon::prelude::*;

use crate::diagnose::levels::sensitivity::STEP;
use crate::diagnose::linearise::covariance::Sensitivity;
use crate::diagnose::observe::bench::{Bench, Runs};
use crate::diagnose::settings::{Settings, Tolerance};
use crate::problem::Problem;

/// One column per tolerated parameter: the change of all features per standard deviation. `base`
/// are the features of the bench with its present settings. `value` gives a parameter's value where
/// no setting changes it. `wanted` selects columns by number.
pub fn sensitivities(
    bench: &Bench<'_>,
    settings: &Settings,
    base: &[f64],
    value: &(dyn Fn(&str) -> Option<f64> + Sync),
    declared: &dyn Fn(&str) -> Option<f64>,
    wanted: &dyn Fn(usize) -> bool,
    runs: &mut Runs,
) -> Vec<Option<Sensitivity>> {
    // What is tried, and the name of its tolerance; all simulations are asked for at once, so that
    // many workers have one.
    let mut asked = Vec::new();
    let now = |section: usize, key: &str| bench.value(section, key).or_else(|| value(key));
    for tolerance in &settings.tolerances {
        let sd = declared(&tolerance.name).unwrap_or(tolerance.default);
        // The parameters to change, and the step in standard deviations.
        let mut tried: Vec<(Vec<(String, Move)>, f64)> = Vec::new();
        tried.extend(
            tolerance
                .scales
                .iter()
                .map(|key| (vec![(key.clone(), Move::Times(1.0 + STEP * sd))], STEP)),
        );
        tried.extend(
            tolerance
                .adds
                .iter()
                .map(|(key, factor)| (vec![(key.clone(), Move::Plus(STEP * factor * sd))], STEP)),
        );
        if !tolerance.sets.is_empty() && sd > 0.0 {
            tried.push((
                tolerance.sets.iter().map(|(key, to)| (key.clone(), Move::To(*to))).collect(),
                1.0 / sd,
            ));
        }
        for (moves, deviations) in tried {
            let moved = |section: usize| -> Vec<(String, f64)> {
                moves
                    .iter()
                    .filter_map(|(key, by)| Some((key.clone(), by.from(now(section, key))?)))
                    .collect()
            };
            let some = |section: usize| {
                moved(section).iter().any(|(key, to)| now(section, key) != Some(*to))
            };
            let changes = (0..bench.seen.sections.len()).any(some) && wanted(asked.len());
            let parameter = moves.first().map_or_else(String::new, |(key, _)| key.clone());
            asked.push((
                (tolerance, parameter),
                deviations,
                changes.then(|| (0..bench.seen.sections.len()).map(moved).collect::<Vec<_>>()),
            ));
        }
    }
    let made: Vec<Option<Result<Vec<f64>, Problem>>> = asked
        .par_iter()
        .map(|(.., moved)| {
            moved.as_ref().map(|moved| bench.moved(&|section| moved[section].clone()))
        })
        .collect();
    let mut column = |(tolerance, parameter): &(&Tolerance, String),
                      deviations: f64,
                      made: Result<Vec<f64>, Problem>| {
        runs.made += bench.seen.sections.len();
        let made = made
            .map_err(|problem| runs.failed.push(format!("{}: {}", tolerance.name, problem.says)))
            .ok()?;
        Some(Sensitivity {
            tolerance: tolerance.name.clone(),
            parameter: parameter.clone(),
            column: made.iter().zip(base).map(|(made, base)| (made - base) / deviations).collect(),
            expected: tolerance.expected,
            per_section: tolerance.per_section,
            shared: tolerance.shared,
        })
    };
    asked
        .iter()
        .zip(made)
        .map(|((tolerance, deviations, _), made)| column(tolerance, *deviations, made?))
        .collect()
}

/// Expected deviations of the tolerances, as settings of the simulator. `value` gives a parameter's
/// value where no setting changes it.
pub fn expected(
    settings: &Settings,
    value: &dyn Fn(&str) -> Option<f64>,
    declared: &dyn Fn(&str) -> Option<f64>,
) -> Vec<(String, f64)> {
    let mut there = Vec::new();
    for tolerance in settings.tolerances.iter().filter(|tolerance| tolerance.expected != 0.0) {
        let by = tolerance.expected * declared(&tolerance.name).unwrap_or(tolerance.default);
        let scaled = tolerance.scales.iter().map(|key| (key, Move::Times(1.0 + by)));
        let added = tolerance.adds.iter().map(|(key, factor)| (key, Move::Plus(factor * by)));
        there.extend(
            scaled.chain(added).filter_map(|(key, by)| Some((key.clone(), by.from(value(key))?))),
        );
    }
    there
}

/// How a parameter is changed.
enum Move {
    Times(f64),
    Plus(f64),
    To(f64),
}

impl Move {
    fn from(&self, now: Option<f64>) -> Option<f64> {
        match self {
            Self::Times(factor) => now.map(|now| now * factor),
            Self::Plus(by) => now.map(|now| now + by),
            Self::To(to) => Some(*to),
        }
    }
}
