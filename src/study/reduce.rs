//! Reduction of the sections with nearly the same scatter: at most a given number per zone, so that the highest standard deviation is
//! kept.
//!
//! Götz and Polach (section 4.1) choose nine sections per zone so that the highest standard deviation of a validation quantity over all
//! sections remains almost the same. They do not describe the method. Here sections are removed one at a time, always the one whose
//! removal changes the scatter least; then sections are exchanged as long as the result improves.

use super::case::{Case, Kind};
use super::judged::Sums;
use crate::result::study::Reduction;

/// Weight of the scatter of single quantities against the highest.
const OTHERS: f64 = 0.1;
/// Largest number of exchanges.
const MOST_EXCHANGES: usize = 200;

/// The case with at most `most` sections in each stratum, and the change of the scatter.
pub fn reduced(case: &Case, most: usize) -> (Case, Reduction) {
    let deviations: Vec<(usize, Sums<'_>)> = case
        .measures()
        .filter(|(_, measure)| matches!(measure.kind, Kind::Deviation { .. } | Kind::RootMeanSquare))
        .map(|(quantity, measure)| (quantity, Sums::of(measure)))
        .collect();
    let scatter = |sections: &[usize]| -> Vec<f64> {
        deviations.iter().map(|(_, sums)| sums.over(sections.iter().copied()).unwrap_or(0.0)).collect()
    };
    let all = scatter(&case.usable());
    let highest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    let cost = |sections: &[usize]| {
        let found = scatter(sections);
        let others = found.iter().zip(&all).map(|(found, all)| (found - all).powi(2)).sum::<f64>() / all.len().max(1) as f64;
        (highest(&found) - highest(&all)).abs() + OTHERS * others.sqrt()
    };
    let keep: Vec<usize> = case.strata.iter().map(|stratum| most.max(stratum.take).min(stratum.members.len())).collect();
    let mut kept: Vec<Vec<usize>> = case.strata.iter().map(|stratum| stratum.members.clone()).collect();
    // One section removed, or one exchanged for another: the first of the best.
    let flat = |kept: &[Vec<usize>]| kept.concat();
    while let Some(next) = (0..kept.len())
        .filter(|&stratum| kept[stratum].len() > keep[stratum])
        .flat_map(|stratum| (0..kept[stratum].len()).map(move |place| (stratum, place)))
        .map(|(stratum, place)| {
            let mut without = kept.clone();
            without[stratum].remove(place);
            (cost(&flat(&without)), without)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
    {
        kept = next.1;
    }
    let mut now = cost(&flat(&kept));
    for _ in 0..MOST_EXCHANGES {
        let mut best: Option<(f64, Vec<Vec<usize>>)> = None;
        for (stratum, of) in case.strata.iter().enumerate() {
            for place in 0..kept[stratum].len() {
                for &other in of.members.iter().filter(|other| !kept[stratum].contains(other)) {
                    let mut changed = kept.clone();
                    changed[stratum][place] = other;
                    let cost = cost(&flat(&changed));
                    if cost < now - 1e-12 && best.as_ref().is_none_or(|(before, _)| cost < *before) {
                        best = Some((cost, changed));
                    }
                }
            }
        }
        let Some((cost, changed)) = best else { break };
        (now, kept) = (cost, changed);
    }
    kept.iter_mut().for_each(|members| members.sort_unstable());
    let after = scatter(&flat(&kept));
    let name = |at: &usize| case.sections[*at].clone();
    let left_out = case.strata.iter().zip(&kept).flat_map(|(stratum, kept)| stratum.members.iter().filter(|at| !kept.contains(at)));
    let reduction = Reduction {
        most,
        kept: case.strata.iter().zip(&kept).map(|(stratum, kept)| (stratum.zone.clone(), kept.iter().map(name).collect())).collect(),
        left_out: left_out.map(name).collect(),
        scatter: deviations
            .iter()
            .zip(all.iter().zip(&after))
            .map(|((quantity, _), (all, after))| (case.quantities[*quantity].symbol.clone(), *all, *after))
            .collect(),
    };
    let mut smaller = case.clone();
    smaller.strata.iter_mut().zip(kept).for_each(|(stratum, kept)| stratum.members = kept);
    (smaller, reduction)
}
