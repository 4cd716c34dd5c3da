//! Found sections in words.

use super::number::count;
use crate::result::found::{FoundSections, Rejected};

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

/// `rejected first by: steady speed 5 120, in no zone 311`.
pub fn rejected_in_words(found: &FoundSections) -> String {
    let one = |rejected: &Rejected| format!("{} {}", rejected.reason.to_lowercase(), count(rejected.places as u64));
    let all: Vec<String> = found.rejected().iter().map(one).collect();
    if all.is_empty() { String::new() } else { format!("rejected, each by the first reason: {}", all.join("; ")) }
}
