//! How far the gap shrinks: the effects really added, on sections that the fit did not see, and the protocol run again.

use rayon::prelude::*;

use super::fit::{Fitted, Fitter};
use super::guards::View;
use super::run::Found;
use super::whiten::dot;
use crate::effects::{Applied, Catalogue, Confined, Gauss, Signals};
use crate::problem::Problem;
use crate::result::diagnosis::{QuantityShrink, Shrink};
use crate::result::{Certification, QuantityResult};
use crate::simulate::{Simulator, simulate};

/// Parts that the sections are dealt into, stratum by stratum.
const FOLDS: usize = 4;
/// Resamples of the sections.
const DRAWS: usize = 400;

/// The chosen effects, with the sizes of the members.
#[must_use]
pub fn applied(found: &Found, members: &[Fitted]) -> Vec<Applied> {
    members
        .iter()
        .map(|member| {
            let of = &found.candidates[member.candidate];
            let mut values = of.fixed.clone();
            values.push((of.size.clone(), member.size));
            let confined = found.masks[member.mask].confined.clone().map(|(column, values)| Confined { column, values });
            Applied { effect: of.effect.clone(), values, channels: of.channels.clone(), confined }
        })
        .collect()
}

/// Sections dealt into folds: one of each stratum after the other.
#[must_use]
pub fn folds(strata: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut folds = vec![Vec::new(); FOLDS];
    let mut next = 0;
    for stratum in strata {
        for section in stratum {
            folds[next % FOLDS].push(*section);
            next += 1;
        }
    }
    folds.retain(|fold| !fold.is_empty());
    folds
}

/// Sizes of the members as the sections outside a fold ask for them.
#[must_use]
pub fn trained(found: &Found, fold: &[usize]) -> Vec<Fitted> {
    let kept: Vec<usize> = (0..found.seen.sections.len()).filter(|at| !fold.contains(at)).collect();
    let features: Vec<usize> = (0..found.seen.features.len()).collect();
    let view = View { says: String::new(), sections: kept.clone(), features: features.clone() };
    let size = found.seen.features.len();
    let whitener = found.covariance.part(&kept, &features).whitener();
    let part = |column: &[f64]| super::guards::part(column, size, &view);
    let mut candidates: Vec<super::candidates::Candidate> =
        found.chosen.members.iter().map(|member| found.candidates[member.candidate].clone()).collect();
    for candidate in &mut candidates {
        candidate.nodes.iter_mut().filter(|node| !node.change.is_empty()).for_each(|node| node.change = part(&node.change));
    }
    let masks = found
        .masks
        .iter()
        .map(|mask| super::fit::Mask { confined: mask.confined.clone(), sections: kept.iter().map(|at| mask.sections[*at]).collect() });
    let fitter = Fitter::new(&whitener, &candidates, masks.collect(), size);
    let z = whitener.apply(&part(&found.difference));
    let mut chosen = super::search::Chosen { members: Vec::new(), rest: z.clone() };
    for (at, member) in found.chosen.members.iter().enumerate() {
        let fitted = fitter.fit(&chosen.rest, at, member.mask).unwrap_or_else(|| member.clone());
        chosen.rest = super::fit::less(&chosen.rest, &fitted.whitened);
        chosen.members.push(Fitted { candidate: at, ..fitted });
    }
    super::search::refit(&fitter, &z, &mut chosen, 4);
    chosen.members.into_iter().zip(&found.chosen.members).map(|(new, old)| Fitted { candidate: old.candidate, ..new }).collect()
}

/// Records of all sections with the effects added: `members` by section.
///
/// # Errors
/// The first section whose simulation fails.
pub fn improved(
    found: &Found,
    catalogue: &Catalogue,
    simulator: Option<&dyn Simulator>,
    members: &(dyn Fn(usize) -> Vec<Applied> + Sync),
) -> Result<Vec<Signals>, Problem> {
    let each = |at: usize| {
        let observed = &found.seen.sections[at];
        let effects = members(at);
        match simulator {
            Some(simulator) => Ok(simulate(simulator, catalogue, &effects, &observed.section, Some(&observed.simulated))?.signals),
            None => {
                let mut signals = observed.simulated.clone();
                crate::simulate::Plan::new(catalogue, &effects, &observed.section, None)?.operate(&mut signals, &observed.section)?;
                Ok(signals)
            }
        }
    };
    (0..found.seen.sections.len()).into_par_iter().map(each).collect()
}

/// Before and after, quantity by quantity, with the interval of what is removed.
#[must_use]
pub fn compare(before: &Certification, after: &Certification, seed: u64, shares: Vec<(String, f64)>) -> Shrink {
    let names = sections(before);
    let all: Vec<usize> = (0..names.len()).collect();
    let (from, to) = (measure(before, &names, &all), measure(after, &names, &all));
    let mut random = Gauss::new(seed);
    let mut removed: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let drawn: Vec<usize> = all.iter().map(|_| random.below(names.len().max(1))).collect();
            let (from, to) = (measure(before, &names, &drawn), measure(after, &names, &drawn));
            if from > 0.0 { 1.0 - to / from } else { 0.0 }
        })
        .collect();
    removed.sort_by(f64::total_cmp);
    let at = |share: f64| removed[((DRAWS - 1) as f64 * share) as usize];
    let quantities = before.quantities.iter().zip(&after.quantities).map(|(before, after)| QuantityShrink {
        id: before.id.clone(),
        normalised_std_before: normalised(before, "std"),
        normalised_std_after: normalised(after, "std"),
        normalised_mean_before: normalised(before, "mean"),
        normalised_mean_after: normalised(after, "mean"),
        variance_explained: explained(before, after),
    });
    Shrink {
        measure: "root mean square of the normalised means and standard deviations of all quantities".into(),
        before: from,
        after: to,
        fraction_removed: if from > 0.0 { 1.0 - to / from } else { 0.0 },
        low: at(0.05),
        high: at(0.95),
        held_out: true,
        quantities: quantities.collect(),
        verdict_before: before.verdict.in_words().into(),
        verdict_after: after.verdict.in_words().into(),
        shares,
    }
}

fn normalised(quantity: &QuantityResult, name: &str) -> Option<f64> {
    quantity.statistics.iter().find(|statistic| statistic.name.starts_with(name)).and_then(|statistic| statistic.normalised).map(f64::abs)
}

fn explained(before: &QuantityResult, after: &QuantityResult) -> Option<f64> {
    let square = |quantity: &QuantityResult| quantity.values.iter().map(|value| value.difference.powi(2)).sum::<f64>();
    let (from, to) = (square(before), square(after));
    (from > 0.0).then(|| 1.0 - to / from)
}

fn sections(of: &Certification) -> Vec<String> {
    of.sections.iter().filter(|section| section.used).map(|section| section.section.clone()).collect()
}

/// Root mean square of normalised mean and standard deviation over all quantities, of the sections drawn.
fn measure(of: &Certification, names: &[String], drawn: &[usize]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for quantity in &of.quantities {
        let values: Vec<f64> = drawn
            .iter()
            .flat_map(|at| quantity.values.iter().filter(|value| value.section == names[*at]).map(|value| value.difference))
            .collect();
        let n = values.len() as f64;
        if values.len() < 2 {
            continue;
        }
        let mean = values.iter().sum::<f64>() / n;
        let std = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let limit = |name: &str| {
            quantity.statistics.iter().find(|statistic| statistic.name.starts_with(name)).and_then(|statistic| statistic.limit)
        };
        for (value, limit) in [(mean.abs(), limit("mean")), (std, limit("std"))] {
            if let Some(limit) = limit.filter(|limit| *limit > 0.0) {
                sum += (value / limit).powi(2);
                count += 1;
            }
        }
    }
    if count == 0 { 0.0 } else { (sum / f64::from(count)).sqrt() }
}

/// What each member alone takes from the whitened difference, as shares of what all take.
#[must_use]
pub fn shares(found: &Found) -> Vec<(String, f64)> {
    let all: f64 = found.chosen.members.iter().map(|member| dot(&member.whitened, &member.whitened)).sum();
    let share = |member: &Fitted| dot(&member.whitened, &member.whitened) / all.max(1e-300);
    found.chosen.members.iter().map(|member| (found.candidates[member.candidate].effect.clone(), share(member))).collect()
}
