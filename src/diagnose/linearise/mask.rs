//! Sections to which an effect is confined.

use super::candidate::Candidate;
use crate::diagnose::observe::{observations::Observations, observed::Observed};
use crate::diagnose::settings::Settings;

/// Sections to which an effect is confined; mask 0 is all sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Column and values; nothing for all sections.
    pub confined: Option<(String, Vec<String>)>,
    pub sections: Vec<bool>,
}

/// Whether an effect may be confined so.
pub fn allowed(candidates: &[Candidate], candidate: usize, mask: usize) -> bool {
    mask == 0 || candidates[candidate].confinable
}

impl Mask {
    /// All of so many sections.
    pub fn everywhere(sections: usize) -> Self {
        Self { confined: None, sections: vec![true; sections] }
    }

    /// A change in the sections of the mask, zero elsewhere.
    pub fn on(&self, change: &[f64]) -> Vec<f64> {
        let mut masked = change.to_vec();
        let size = masked.len() / self.sections.len().max(1);
        for (section, inside) in self.sections.iter().enumerate() {
            if !inside {
                masked[section * size..(section + 1) * size].fill(0.0);
            }
        }
        masked
    }
}

/// All sections, the values of the columns by which an effect may be confined, and pairs of
/// successive values.
pub fn masks(seen: &Observations, settings: &Settings) -> Vec<Mask> {
    let all = seen.sections.len();
    let mut masks = vec![Mask::everywhere(all)];
    for column in &settings.confine {
        let mut values: Vec<String> = Vec::new();
        for observed in &seen.sections {
            if let Some(value) = observed.section.fact(column)
                && !values.iter().any(|known| known == value)
            {
                values.push(value.to_string());
            }
        }
        let mut push = |values: Vec<String>| {
            let inside = |at: &Observed| {
                at.section.fact(column).is_some_and(|value| values.iter().any(|one| one == value))
            };
            let sections: Vec<bool> = seen.sections.iter().map(inside).collect();
            let some = sections.iter().filter(|inside| **inside).count();
            if some > 0 && some < all && !masks.iter().any(|mask| mask.sections == sections) {
                masks.push(Mask { confined: Some((column.clone(), values)), sections });
            }
        };
        values.iter().for_each(|value| push(vec![value.clone()]));
        values.windows(2).for_each(|pair| push(pair.to_vec()));
    }
    masks
}
