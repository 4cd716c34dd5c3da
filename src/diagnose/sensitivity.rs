//! How much the simulated features change with what the test engineer admits not to know.

use super::bench::{Bench, Runs};
use super::covariance::Sensitivity;
use super::settings::Settings;

/// Finite differences are taken over so many standard deviations: beyond the noise of branches, within what is linear.
const STEP: f64 = 1.5;

/// A column per tolerated parameter: the change of all features with one standard deviation of it.
#[must_use]
pub fn sensitivities(
    bench: &Bench<'_>,
    settings: &Settings,
    base: &[f64],
    value: &dyn Fn(&str) -> Option<f64>,
    declared: &dyn Fn(&str) -> Option<f64>,
    runs: &mut Runs,
) -> Vec<Sensitivity> {
    let mut columns = Vec::new();
    for tolerance in &settings.tolerances {
        let sd = declared(&tolerance.name).unwrap_or(tolerance.default);
        // What is set, and how many standard deviations that is.
        let mut tried: Vec<(Vec<(String, f64)>, f64)> = Vec::new();
        for key in &tolerance.scales {
            tried.extend(value(key).map(|from| (vec![(key.clone(), from + STEP * from * sd)], STEP)));
        }
        for (key, factor) in &tolerance.adds {
            tried.extend(value(key).map(|from| (vec![(key.clone(), from + STEP * factor * sd)], STEP)));
        }
        if !tolerance.sets.is_empty() && sd > 0.0 {
            tried.push((tolerance.sets.clone(), 1.0 / sd));
        }
        for (set, deviations) in tried.into_iter().filter(|(set, _)| set.iter().any(|(key, to)| value(key) != Some(*to))) {
            runs.made += bench.seen.sections.len();
            match bench.features(&set) {
                Ok(made) => columns.push(Sensitivity {
                    tolerance: tolerance.name.clone(),
                    column: made.iter().zip(base).map(|(made, base)| (made - base) / deviations).collect(),
                    expected: tolerance.expected,
                    per_section: tolerance.per_section,
                    shared: tolerance.shared,
                }),
                Err(problem) => runs.failed.push(format!("{}: {}", tolerance.name, problem.says)),
            }
        }
    }
    columns
}
