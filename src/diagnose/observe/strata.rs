//! Sections by stratum.

use super::observations::Observations;
use crate::diagnose::settings::Settings;

/// The stratum of a section.
pub fn stratum_of<'a>(seen: &'a Observations, settings: &Settings, section: usize) -> &'a str {
    settings
        .stratum
        .as_deref()
        .and_then(|column| seen.sections[section].section.fact(column))
        .unwrap_or("")
}

/// Sections by stratum, in the order in which strata first appear.
pub fn strata(seen: &Observations, settings: &Settings) -> Vec<Vec<usize>> {
    let mut found: Vec<(String, Vec<usize>)> = Vec::new();
    for at in seen.first_runs() {
        let value = stratum_of(seen, settings, at).to_string();
        match found.iter_mut().find(|(known, _)| *known == value) {
            Some((_, sections)) => sections.push(at),
            None => found.push((value, vec![at])),
        }
    }
    found.into_iter().map(|(_, sections)| sections).collect()
}
