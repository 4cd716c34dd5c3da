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

/// `run R1: the shift that aligns the measurement with the simulation, by correlation: +0.02 to
/// -10.91 m along the run (28 of 30 windows) ...`; nothing where it is not known.
pub fn drift_in_words(run: &FoundInRun, unit: &str) -> Option<String> {
    let Drift { points, along, windows, corrected } = run.drift.as_ref()?;
    let range = |shifts: &mut dyn Iterator<Item = f64>| {
        let (least, most) = shifts
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), shift| {
                (least.min(shift), most.max(shift))
            });
        format!("{least:+.2} to {most:+.2} {unit}")
    };
    let mut parts = Vec::new();
    if !along.is_empty() {
        let all = range(&mut along.iter().map(|point| point.shift));
        parts.push(format!("{all} in {} of {windows} windows along the run", along.len()));
    }
    if !points.is_empty() {
        let all = range(&mut points.iter().map(|point| point.shift));
        parts.push(format!(
            "{all} at {} section{}",
            points.len(),
            if points.len() == 1 { "" } else { "s" }
        ));
    }
    let done = if *corrected {
        "this was added to the distance of the measurement"
    } else {
        "nothing was corrected (`drift: correct` in the run adds it)"
    };
    Some(format!(
        "run {}: the shift that aligns the measurement with the simulation, by correlation, is {}; {done}",
        run.run,
        parts.join(", and ")
    ))
}

/// `rejected first by: steady speed 5 120, in no zone 311`.
pub fn rejected_in_words(found: &FoundSections) -> String {
    let one = |rejected: &Rejected| {
        format!(
            "{} {}",
            rejected.reason.text().to_string().to_lowercase(),
            count(rejected.places as u64)
        )
    };
    let all: Vec<String> = found.rejected().iter().map(one).collect();
    if all.is_empty() {
        String::new()
    } else {
        format!("rejected, each by the first reason: {}", all.join("; "))
    }
}
