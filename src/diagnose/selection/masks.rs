//! Sections to which an effect may be confined.

use crate::diagnose::features::observations::Observations;
use crate::diagnose::inference::chosen::Chosen;
use crate::diagnose::inference::fit::{Fitted, Fitter};
use crate::diagnose::levels::converge::{NEAR, WORTH};
use crate::diagnose::response::mask::Mask;
use crate::diagnose::settings::Settings;

/// Lists of sections to which strong candidates seem to be confined and that are not masks yet.
pub fn section_masks(
    fitter: &Fitter<'_>,
    z: &[f64],
    chosen: &Chosen,
    seen: &Observations,
) -> Vec<Mask> {
    let mut more: Vec<Mask> = Vec::new();
    for rest in [z, &chosen.rest] {
        let fits = fitter.all(rest);
        let best = fits.iter().map(|fit| fit.evidence).fold(0.0, f64::max);
        let confinable = |fit: &&Fitted| fitter.candidates[fit.candidate].confinable;
        for fit in
            fits.iter().filter(confinable).filter(|fit| fit.evidence >= (NEAR * best).max(WORTH))
        {
            let Some(sections) = fitter.seems_in(rest, fit) else { continue };
            let asked_by = Some(fit.candidate);
            let known = |mask: &Mask| {
                mask.sections == sections && (mask.asked_by.is_none() || mask.asked_by == asked_by)
            };
            let asked =
                fitter.masks.iter().chain(&more).filter(|mask| mask.asked_by == asked_by).count();
            // The list converges after one or two rounds.
            if asked < 2 && !fitter.masks.iter().chain(&more).any(known) {
                let names = (0..sections.len())
                    .filter(|at| sections[*at])
                    .map(|at| seen.sections[at].section.name().to_string());
                more.push(Mask {
                    confined: Some(("section".to_string(), names.collect())),
                    sections,
                    asked_by,
                });
            }
        }
    }
    more
}

/// All sections, the values of the columns by which an effect may be confined, and pairs of
/// successive values.
#[must_use]
pub fn masks(seen: &Observations, settings: &Settings) -> Vec<Mask> {
    let all = seen.sections.len();
    let mut masks = vec![Mask { confined: None, sections: vec![true; all], asked_by: None }];
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
            let inside = |at: &crate::diagnose::features::observed::Observed| {
                at.section.fact(column).is_some_and(|value| values.iter().any(|one| one == value))
            };
            let sections: Vec<bool> = seen.sections.iter().map(inside).collect();
            let some = sections.iter().filter(|inside| **inside).count();
            if some > 0 && some < all && !masks.iter().any(|mask| mask.sections == sections) {
                masks.push(Mask {
                    confined: Some((column.clone(), values)),
                    sections,
                    asked_by: None,
                });
            }
        };
        values.iter().for_each(|value| push(vec![value.clone()]));
        values.windows(2).for_each(|pair| push(pair.to_vec()));
    }
    masks
}
