//! Found sections in words.

use super::number::count;
use crate::result::found::{Drift, FoundInRun, FoundSections, Rejected};

/// `33 sections in 1 run; 9 113 places tried, every 1 m, of overlapping ones the first is taken.`
pub fn in_words(found: &FoundSections) -> String {
    let runs = found.runs.len();
    let (sections, unit) = (found.found(), &found.axis_unit);
    format!(
        "{sections} section{} found in {runs} run{}: {} places tried, one every {} {unit}; of places that overlap, {}",
        if sections == 1 { "" } else { "s" },
        if runs == 1 { "" } else { "s" },
        count(found.tried() as u64),
        found.step,
        match found.prefer.as_str() {
            "first" => "the first is taken".to_string(),
            other => format!("the one with the {other} is taken"),
        }
    )
}

/// `The measurement of run R1 has to be moved by -0.3 to -11.0 m along the run ...`; nothing where it is not known.
pub fn drift_in_words(run: &FoundInRun, unit: &str) -> Option<String> {
    let Drift { points, corrected } = run.drift.as_ref()?;
    let least = points.iter().map(|point| point.shift).fold(f64::INFINITY, f64::min);
    let most = points.iter().map(|point| point.shift).fold(f64::NEG_INFINITY, f64::max);
    let done = if *corrected { "this was added to the distance of the measurement" } else { "nothing was corrected" };
    Some(format!(
        "run {}: by correlation at {} sections, the measurement is aligned with the simulation by a shift of {least:+.2} to {most:+.2} {unit}; {done}",
        run.run,
        points.len()
    ))
}

/// `rejected first by: steady speed 5 120, in no zone 311`.
pub fn rejected_in_words(found: &FoundSections) -> String {
    let one = |rejected: &Rejected| format!("{} {}", rejected.reason.to_lowercase(), count(rejected.places as u64));
    let all: Vec<String> = found.rejected().iter().map(one).collect();
    if all.is_empty() { String::new() } else { format!("rejected, each by the first reason: {}", all.join("; ")) }
}
