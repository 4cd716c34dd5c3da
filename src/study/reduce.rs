//! Reduction of the sections to at most a given number per zone, so that the highest standard
//! deviation is kept.

use super::case::Case;
use super::judged::Sums;
use crate::metrics::reduction::{self, Measure};
use crate::result::study::Reduction;

/// The case with at most `most` sections in each stratum, and the change of the scatter.
pub fn reduced(case: &Case, most: usize) -> (Case, Reduction) {
    let (quantities, measures): (Vec<usize>, Vec<Measure>) = case
        .measures()
        .filter_map(|(quantity, measure)| Some((quantity, Sums::of(measure).scatter()?)))
        .unzip();
    let scatter = |sections: &[usize]| {
        measures.iter().map(|measure| measure.over(sections)).collect::<Vec<f64>>()
    };
    let all = scatter(&case.usable());
    let keep: Vec<usize> = case
        .strata
        .iter()
        .map(|stratum| most.max(stratum.take).min(stratum.members.len()))
        .collect();
    let members: Vec<Vec<usize>> =
        case.strata.iter().map(|stratum| stratum.members.clone()).collect();
    let kept = reduction::reduced(&members, &keep, &measures);
    let after = scatter(&kept.concat());
    let name = |at: &usize| case.sections[*at].clone();
    let left_out = case
        .strata
        .iter()
        .zip(&kept)
        .flat_map(|(stratum, kept)| stratum.members.iter().filter(|at| !kept.contains(at)));
    let reduction = Reduction {
        most,
        kept: case
            .strata
            .iter()
            .zip(&kept)
            .map(|(stratum, kept)| (stratum.zone.clone(), kept.iter().map(name).collect()))
            .collect(),
        left_out: left_out.map(name).collect(),
        scatter: quantities
            .iter()
            .zip(all.iter().zip(&after))
            .map(|(quantity, (all, after))| {
                (case.quantities[*quantity].symbol.clone(), *all, *after)
            })
            .collect(),
    };
    let mut smaller = case.clone();
    smaller.strata.iter_mut().zip(kept).for_each(|(stratum, kept)| stratum.members = kept);
    (smaller, reduction)
}
