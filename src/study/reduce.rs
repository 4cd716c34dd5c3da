//! Reduction of the sections to at most a given number per zone, so that the highest standard
//! deviation is kept.

use super::case::Case;
use crate::metrics::moments::{Moment, Summed};
use crate::result::study::Reduction;
use crate::run::keep::reduction;

/// The case with at most `most` sections in each stratum, and the change of the scatter.
pub fn reduced(case: &Case, most: usize) -> (Case, Reduction) {
    let (symbols, measures): (Vec<&str>, Vec<Summed>) = case
        .measures()
        .filter_map(|(at, measure)| Some((case.quantities[at].symbol.as_str(), measure.summed()?)))
        .filter(|(_, summed)| summed.kind != Moment::Mean)
        .unzip();
    let strata = case.strata.iter();
    let keep: Vec<usize> =
        strata.clone().map(|stratum| most.max(stratum.take).min(stratum.members.len())).collect();
    let groups = strata.map(|stratum| (stratum.zone.clone(), stratum.members.clone()));
    let name = |at: usize| case.sections[at].clone();
    let (kept, reduction) = reduction(groups, most, &keep, (&symbols, &measures), name);
    let mut smaller = case.clone();
    smaller.strata.iter_mut().zip(kept).for_each(|(stratum, kept)| stratum.members = kept);
    (smaller, reduction)
}
