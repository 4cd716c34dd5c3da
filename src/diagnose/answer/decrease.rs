//! Reduction of the gap by cross-validation: the effects simulated on sections excluded from the
//! fit, and the protocol evaluated again.

use rayon::prelude::*;

use crate::diagnose::checks::channels::View;
use crate::diagnose::fit::{
    fitter::{Fitted, Fitter, Member},
    joint,
};
use crate::diagnose::levels::{
    common::RESAMPLES,
    decrease::{FOLDS, TOUCHED},
};
use crate::diagnose::linearise::{candidate::Candidate, mask::Mask, whiten::dot};
use crate::diagnose::observe::observed::Observed;
use crate::diagnose::run::Found;
use crate::effects::{Applied, Catalogue, Confined, Gauss, Signals};
use crate::problem::Problem;
use crate::result::{
    Certification, QuantityResult,
    StatisticName::{self, Mean, StandardDeviation},
    diagnosis::{QuantityShrink, Shrink, Touched},
};
use crate::simulate::{Simulator, simulate};

/// The chosen effects with the sizes of the members.
pub fn applied(found: &Found, members: &[Fitted]) -> Vec<Applied> {
    members
        .iter()
        .map(|member| {
            let of = found.candidate(member);
            let mut values = of.fixed.clone();
            values.push((of.size.clone(), member.size));
            let confined = found.masks[member.mask]
                .confined
                .clone()
                .map(|(column, values)| Confined { column, values });
            Applied { effect: of.effect.clone(), values, channels: of.channels.clone(), confined }
        })
        .collect()
}

/// Distributes the sections to folds, stratum by stratum in turn.
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

/// The members with sizes fitted to the sections outside a fold.
pub fn trained(found: &Found, fold: &[usize]) -> Vec<Fitted> {
    let kept: Vec<usize> = (0..found.seen.sections.len()).filter(|at| !fold.contains(at)).collect();
    let features: Vec<usize> = (0..found.seen.features.len()).collect();
    let view = View { sections: kept.clone(), features: features.clone() };
    let size = found.seen.features.len();
    let whitener = found.fitted.covariance.part(&kept, &features).whitener();
    let part = |column: &[f64]| crate::diagnose::checks::channels::part(column, size, &view);
    let members: Vec<Fitted> = found.answer.chosen.all().cloned().collect();
    let inside = |member: &Fitted| {
        let mut candidate = found.candidate(member).clone();
        let changed = candidate.nodes.iter_mut().filter(|node| !node.change.is_empty());
        changed.for_each(|node| node.change = part(&node.change));
        candidate
    };
    let candidates: Vec<Candidate> = members.iter().map(inside).collect();
    let masks = found.masks.iter().map(|mask| Mask {
        confined: mask.confined.clone(),
        sections: kept.iter().map(|at| mask.sections[*at]).collect(),
    });
    let fitter = Fitter::new(&whitener, &candidates, masks.collect());
    let z = whitener.apply(&part(&found.fitted.difference));
    let set: Vec<Member> =
        members.iter().enumerate().map(|(at, member)| (at, member.mask)).collect();
    let mut trained = match joint::fit(&fitter, &z, &set) {
        None => members,
        Some(joint) => std::iter::zip(joint.members, members)
            .map(|(new, old)| Fitted { candidate: old.candidate, ..new })
            .collect(),
    };
    trained.truncate(found.answer.chosen.members.len());
    trained
}

/// Records of all sections with the effects added; `members` by section.
///
/// # Errors
/// The error of the first section whose simulation fails.
pub fn improved(
    sections: &[Observed],
    catalogue: &Catalogue,
    simulator: Option<&dyn Simulator>,
    members: &(dyn Fn(usize) -> Vec<Applied> + Sync),
) -> Result<Vec<Signals>, Problem> {
    let each = |at: usize| {
        let observed = &sections[at];
        let effects = members(at);
        match simulator {
            Some(simulator) => simulate(
                simulator,
                catalogue,
                &effects,
                &observed.section,
                Some(&observed.simulated),
            ),
            None => {
                let mut signals = observed.simulated.clone();
                crate::simulate::Plan::new(catalogue, &effects, &observed.section, None)?
                    .operate(&mut signals, &observed.section)?;
                Ok(signals)
            }
        }
    };
    (0..sections.len()).into_par_iter().map(each).collect()
}

/// The gap of some sections before and after, over all quantities.
pub fn within(
    before: &Certification,
    after: &Certification,
    sections: &[&str],
    seed: u64,
) -> Touched {
    let (before, after) = (of_sections(before, sections), of_sections(after, sections));
    removed(&before, &after, &(0..before.quantities.len()).collect::<Vec<_>>(), seed)
}

/// The values of some sections only.
pub fn of_sections(of: &Certification, sections: &[&str]) -> Certification {
    let mut part = of.clone();
    part.sections.retain(|section| sections.contains(&section.section.as_str()));
    for quantity in &mut part.quantities {
        quantity.values.retain(|value| sections.contains(&value.section.as_str()));
    }
    part
}

/// Quantities before and after, with the interval of the removed share. `noise` is the protocol
/// evaluated on records that differ only by the declared noise.
pub fn compare(
    before: &Certification,
    after: &Certification,
    noise: Option<&Certification>,
    seed: u64,
    shares: Vec<(String, f64)>,
) -> Shrink {
    let every: Vec<usize> = (0..before.quantities.len()).collect();
    let whole = removed(before, after, &every, seed);
    let touched: Vec<usize> = every
        .into_iter()
        .filter(|at| change(&before.quantities[*at], &after.quantities[*at]) >= TOUCHED)
        .collect();
    let quantity = |at: usize| {
        let (was, is) = (&before.quantities[at], &after.quantities[at]);
        let floor = noise.map_or(0.0, |noise| sum_of_squares(&noise.quantities[at]));
        let (from, to) = (sum_of_squares(was), sum_of_squares(is));
        let own = removed(before, after, &[at], seed);
        QuantityShrink {
            id: was.id.clone(),
            normalised_std_before: normalised(was, &StandardDeviation),
            normalised_std_after: normalised(is, &StandardDeviation),
            normalised_mean_before: normalised(was, &Mean),
            normalised_mean_after: normalised(is, &Mean),
            variance_explained: explained(from, to, 0.0),
            noise_floor: noise.filter(|_| from > 0.0).map(|_| floor / from),
            variance_explained_above_noise: noise.and_then(|_| explained(from, to, floor)),
            fraction_removed: own.fraction_removed,
            low: own.low,
            high: own.high,
        }
    };
    let quantities = (0..before.quantities.len()).map(quantity);
    Shrink {
        measure:
            "root mean square of the normalised means and standard deviations of all quantities"
                .into(),
        before: whole.before,
        after: whole.after,
        fraction_removed: whole.fraction_removed,
        low: whole.low,
        high: whole.high,
        held_out: true,
        quantities: quantities.collect(),
        verdict_before: before.verdict,
        verdict_after: after.verdict,
        touched: (!touched.is_empty()).then(|| removed(before, after, &touched, seed)),
        shares,
    }
}

/// The removed share of some quantities, with its interval by resampling sections.
fn removed(
    before: &Certification,
    after: &Certification,
    quantities: &[usize],
    seed: u64,
) -> Touched {
    let names = sections(before);
    let all: Vec<usize> = (0..names.len()).collect();
    let both = |drawn: &[usize]| {
        (measure(before, quantities, &names, drawn), measure(after, quantities, &names, drawn))
    };
    let share = |(from, to): (f64, f64)| if from > 0.0 { 1.0 - to / from } else { 0.0 };
    let mut random = Gauss::new(seed);
    let mut shares: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            share(both(&all.iter().map(|_| random.below(names.len().max(1))).collect::<Vec<_>>()))
        })
        .collect();
    shares.sort_by(f64::total_cmp);
    let at = |share: f64| shares[((RESAMPLES - 1) as f64 * share) as usize];
    let (from, to) = both(&all);
    Touched {
        quantities: quantities.iter().map(|at| before.quantities[*at].id.clone()).collect(),
        before: from,
        after: to,
        fraction_removed: share((from, to)),
        low: at(0.05),
        high: at(0.95),
        variance_explained: {
            let sum = |of: &Certification| -> f64 {
                quantities.iter().map(|at| squares(&of.quantities[*at])).sum()
            };
            let from = sum(before);
            if from > 0.0 { 1.0 - sum(after) / from } else { 0.0 }
        },
    }
}

/// Sum of squared differences, each divided by the limit of their standard deviation; 0 without
/// such a limit.
fn squares(quantity: &QuantityResult) -> f64 {
    let limit = limit_of(quantity, &StandardDeviation).filter(|limit| *limit > 0.0);
    limit.map_or(0.0, |limit| {
        quantity.values.iter().map(|value| (value.difference / limit).powi(2)).sum()
    })
}

/// Root mean square change of a quantity's differences, divided by the limit of their standard
/// deviation.
fn change(before: &QuantityResult, after: &QuantityResult) -> f64 {
    let Some(limit) = limit_of(before, &StandardDeviation).filter(|limit| *limit > 0.0) else {
        return 0.0;
    };
    let squares: f64 = before
        .values
        .iter()
        .zip(&after.values)
        .map(|(a, b)| (a.difference - b.difference).powi(2))
        .sum();
    (squares / before.values.len().max(1) as f64).sqrt() / limit
}

fn limit_of(quantity: &QuantityResult, name: &StatisticName) -> Option<f64> {
    quantity
        .statistics
        .iter()
        .find(|statistic| statistic.name == *name)
        .and_then(|statistic| statistic.limit)
}

fn normalised(quantity: &QuantityResult, name: &StatisticName) -> Option<f64> {
    quantity
        .statistics
        .iter()
        .find(|statistic| statistic.name == *name)
        .and_then(|statistic| statistic.normalised)
        .map(f64::abs)
}

fn sum_of_squares(quantity: &QuantityResult) -> f64 {
    quantity.values.iter().map(|value| value.difference.powi(2)).sum()
}

/// Removed share of a sum of squares above a floor.
fn explained(before: f64, after: f64, floor: f64) -> Option<f64> {
    let (from, to) = (before - floor, (after - floor).max(0.0));
    (from > 0.0).then(|| 1.0 - to / from)
}

fn sections(of: &Certification) -> Vec<String> {
    of.sections
        .iter()
        .filter(|section| section.used)
        .map(|section| section.section.clone())
        .collect()
}

/// Root mean square of the normalised means and standard deviations of some quantities, over the
/// drawn sections.
fn measure(of: &Certification, quantities: &[usize], names: &[String], drawn: &[usize]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for quantity in quantities.iter().map(|at| &of.quantities[*at]) {
        let values: Vec<f64> = drawn
            .iter()
            .flat_map(|at| {
                quantity
                    .values
                    .iter()
                    .filter(|value| value.section == names[*at])
                    .map(|value| value.difference)
            })
            .collect();
        let n = values.len() as f64;
        if values.len() < 2 {
            continue;
        }
        let mean = values.iter().sum::<f64>() / n;
        let std =
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        for (value, limit) in
            [(mean.abs(), limit_of(quantity, &Mean)), (std, limit_of(quantity, &StandardDeviation))]
        {
            if let Some(limit) = limit.filter(|limit| *limit > 0.0) {
                sum += (value / limit).powi(2);
                count += 1;
            }
        }
    }
    if count == 0 { 0.0 } else { (sum / f64::from(count)).sqrt() }
}

/// The part of the whitened difference that each member removes alone, as a share of what all
/// remove together.
pub fn shares(found: &Found) -> Vec<(String, f64)> {
    let all: f64 = found
        .answer
        .chosen
        .members
        .iter()
        .map(|member| dot(&member.whitened, &member.whitened))
        .sum();
    let share = |member: &Fitted| dot(&member.whitened, &member.whitened) / all.max(1e-300);
    found
        .answer
        .chosen
        .members
        .iter()
        .map(|member| (found.candidate(member).effect.clone(), share(member)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 25 to 5 is a reduction by four fifths; above a floor of 5 by all, above 4 by 20 of 21. With
    /// a floor of 25 nothing is to be explained.
    #[test]
    fn what_noise_makes_is_not_to_be_explained() {
        assert_eq!(explained(25.0, 5.0, 0.0), Some(0.8));
        assert_eq!(explained(25.0, 5.0, 5.0), Some(1.0));
        assert!((explained(25.0, 5.0, 4.0).expect("above") - 20.0 / 21.0).abs() < 1e-12);
        assert_eq!(explained(25.0, 3.0, 5.0), Some(1.0));
        assert_eq!(explained(25.0, 5.0, 25.0), None);
    }
}
