//! How much the simulated features change with what the test engineer admits not to know.

use super::candidates::{Bench, Runs};
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
        let scaled = tolerance.scales.iter().filter_map(|key| Some((key, value(key)?, value(key)? * sd)));
        let added = tolerance.adds.iter().filter_map(|(key, factor)| Some((key, value(key)?, factor * sd)));
        for (key, from, step) in scaled.chain(added).filter(|(_, _, step)| *step != 0.0) {
            runs.made += bench.seen.sections.len();
            match bench.features(&[(key.clone(), from + STEP * step)]) {
                Ok(made) => columns.push(Sensitivity {
                    tolerance: tolerance.name.clone(),
                    column: made.iter().zip(base).map(|(made, base)| (made - base) / STEP).collect(),
                    per_section: tolerance.per_section,
                    shared: tolerance.shared,
                }),
                Err(problem) => runs.failed.push(format!("{key}: {}", problem.says)),
            }
        }
    }
    columns
}
