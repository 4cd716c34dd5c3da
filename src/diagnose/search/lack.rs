//! What a set of causes leaves beyond what is allowed for.

use super::candidates::Candidate;
use super::choose::{Chosen, Refused, refit};
use super::fit::{Fitted, Fitter, Mask};
use super::guards::{View, part};
use super::place::Place;
use crate::diagnose::allowed::whiten::{Covariance, less};
use crate::diagnose::observe::features::Kind;
use crate::diagnose::observe::observations::Observations;

/// Lack of fit, in standard deviations of chi-squared of a channel, beyond which something is not explained.
pub const LACK: f64 = 5.0;

/// With a member the excess of the channels may be this share of what it was without it, at the most: some effects show elsewhere.
const WORSE: f64 = 1.1;
/// And this much more of chi-squared, which is nothing beside some thousand features.
const LITTLE: f64 = 10.0;

/// Of the change that an effect makes, what the model that makes it is wrong by, feature by feature.
const WRONG: f64 = 0.2;
/// Of that of the levels as one.
const WRONG_LEVEL: f64 = 0.05;

/// The covariance beside an answer, with room for what is wrong in the changes of its members: an operation on the signals has nothing
/// wrong.
#[must_use]
pub fn with_room(beside: &Covariance, candidates: &[Candidate], masks: &[Mask], chosen: &Chosen) -> Covariance {
    let mut wider = beside.clone();
    for member in chosen.members.iter().filter(|member| !candidates[member.candidate].exact) {
        let change = member.change(candidates, masks);
        wider.diagonal.iter_mut().zip(change).for_each(|(variance, change)| *variance += (WRONG * change).powi(2));
    }
    wider
}

/// What a model has wrong of the changes of the members, as one: little of the levels, which follow from equilibrium, more of all else.
/// It leaves a size as it is that only the one or the other says, and makes its interval wider. `levels` says which features of a section
/// are levels.
#[must_use]
pub fn wrong_as_one(levels: &[bool], candidates: &[Candidate], masks: &[Mask], members: &[Fitted]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for member in members.iter().filter(|member| !candidates[member.candidate].exact) {
        let change = member.change(candidates, masks);
        for (level, share) in [(true, WRONG_LEVEL), (false, WRONG)] {
            let inside = |at: usize| levels[at % levels.len()] == level;
            columns.push(change.iter().enumerate().map(|(at, change)| if inside(at) { share * change } else { 0.0 }).collect());
        }
    }
    columns
}

/// How far a channel goes beyond what is allowed for, in its levels or in all else.
#[derive(Clone, Debug)]
pub struct Lack {
    pub channel: String,
    pub kind: Kind,
    /// Standard deviations of chi-squared.
    pub sigma: f64,
    /// Chi-squared less what is expected of it.
    pub excess: f64,
    /// Sections that stand out alone and do not count in this.
    pub alone: Vec<usize>,
    /// Standard deviations with them.
    pub sigma_with_them: f64,
}

/// One section in so many may stand out alone: a wheelset that reaches the flange, or hunts, on one side of the comparison only.
const ONE_IN: usize = 8;

/// What is left beyond what is allowed for, channel by channel, levels and all else apart.
#[must_use]
pub fn lack_of_fit(covariance: &Covariance, seen: &Observations, rest: &[f64]) -> Vec<Lack> {
    use rayon::prelude::*;
    let all: Vec<usize> = seen.first_runs();
    let mut views = Vec::new();
    for (channel, of) in seen.layout.channels.iter().enumerate() {
        for level in [true, false] {
            let keep = |kind: Kind| (kind == Kind::Level) == level;
            let features: Vec<usize> =
                seen.features.iter().enumerate().filter(|(_, f)| f.channel == channel && keep(f.kind)).map(|(at, _)| at).collect();
            if !features.is_empty() {
                let kind = if level { Kind::Level } else { Kind::Band(0) };
                views.push((of.name.clone(), kind, View { says: String::new(), sections: all.clone(), features }));
            }
        }
    }
    let each = |(channel, kind, mut view): (String, Kind, View)| {
        let count = |view: &View| (view.sections.len() * view.features.len()) as f64;
        let beyond = |chi: f64, n: f64| (chi - n) / (2.0 * n).sqrt();
        let all = count(&view);
        let (with_them, chi, alone) = without_those_alone(covariance, &mut view, rest);
        let n = count(&view);
        Lack { channel, kind, sigma: beyond(chi, n), excess: chi - n, alone, sigma_with_them: beyond(with_them, all) }
    };
    views.into_par_iter().map(each).collect()
}

/// Chi-squared of a view with and without the sections that stand out alone, and these: each by more than [`LACK`] standard deviations
/// of its own chi-squared given the others. They are taken out of the view.
fn without_those_alone(covariance: &Covariance, view: &mut View, rest: &[f64]) -> (f64, f64, Vec<usize>) {
    let own = view.features.len() as f64;
    let most = view.sections.len() / ONE_IN;
    let (mut first, mut alone) = (None, Vec::new());
    loop {
        let rest = part(rest, covariance.size, view);
        let products = covariance.part(&view.sections, &view.features).products().of(&rest, &rest, alone.len() < most);
        let (whole, others) = products.split_first().map_or((0.0, &[][..]), |(whole, others)| (whole.0, others));
        let with_them = *first.get_or_insert(whole);
        let least = others.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match least {
            Some((at, left)) if whole - left.0 > own + LACK * (2.0 * own).sqrt() => alone.push(view.sections.remove(at)),
            _ => return (with_them, whole, alone),
        }
    }
}

/// What is beyond what is allowed for, over all channels.
pub fn excess(lack: &[Lack]) -> f64 {
    lack.iter().map(|lack| lack.excess.max(0.0)).sum()
}

/// What is left of the excess, and whether that is too much to call the gap explained: more than half of it, in more than one kind of
/// one channel or far beyond. One among some forty may be a little beyond without anything being missing.
#[must_use]
pub fn unexplained(before: &[Lack], after: &[Lack]) -> (f64, bool) {
    let (gap, rest) = (excess(before), excess(after));
    let share = if gap > 0.0 { (rest / gap).clamp(0.0, 1.0) } else { 0.0 };
    let beyond: Vec<f64> = after.iter().map(|lack| lack.sigma).filter(|sigma| *sigma > LACK).collect();
    (share, share > 0.5 && (beyond.len() > 1 || beyond.iter().any(|sigma| *sigma > 3.0 * LACK)))
}

/// A member that makes channels go further beyond what is allowed for is no cause. Gives what is left.
pub fn drop_what_harms(
    fitter: &Fitter<'_>,
    (place, seen): (&Place, &Observations),
    z: &[f64],
    chosen: &mut Chosen,
    refused: &mut Vec<Refused>,
    before: &[Lack],
) -> Vec<Lack> {
    loop {
        let lack = |chosen: &Chosen| lack_after(&place.covariance, seen, (fitter.candidates, &fitter.masks), &place.difference, chosen);
        let now = lack(chosen);
        let Some(last) = chosen.members.len().checked_sub(1) else { return now };
        let mut without = chosen.clone();
        without.members.remove(last);
        refit(fitter, z, &mut without);
        let then = if without.members.is_empty() { before.to_vec() } else { lack(&without) };
        if excess(&now) <= WORSE * excess(&then) + LITTLE {
            return now;
        }
        let reason = format!("what channels show beyond what is allowed for grows from {:.0} to {:.0}", excess(&then), excess(&now));
        refused.push(Refused::new(chosen.members[last].clone(), reason));
        *chosen = without;
    }
}

/// What the members leave of the difference, in the features' own units.
#[must_use]
pub fn left(candidates: &[Candidate], masks: &[Mask], difference: &[f64], chosen: &Chosen) -> Vec<f64> {
    chosen.members.iter().fold(difference.to_vec(), |rest, member| less(&rest, &member.change(candidates, masks)))
}

/// Where what the members leave is more than is allowed for.
#[must_use]
pub fn lack_after(
    covariance: &Covariance,
    seen: &Observations,
    (candidates, masks): (&[Candidate], &[Mask]),
    difference: &[f64],
    chosen: &Chosen,
) -> Vec<Lack> {
    let rest = left(candidates, masks, difference, chosen);
    lack_of_fit(&with_room(covariance, candidates, masks, chosen), seen, &rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::candidates::Node;

    /// Sixteen sections of nine features of unit variance: one that is off by 10 in each of them has a chi-squared of 900.
    #[test]
    fn two_of_sixteen_sections_may_stand_out_alone() {
        let covariance = Covariance { diagonal: vec![1.0; 16 * 9], inside: Vec::new(), shared: Vec::new(), size: 9 };
        let lack = |off: &[usize]| {
            let rest: Vec<f64> = (0..16 * 9).map(|at| if off.contains(&(at / 9)) { 10.0 } else { 0.0 }).collect();
            let mut view = View { says: String::new(), sections: (0..16).collect(), features: (0..9).collect() };
            without_those_alone(&covariance, &mut view, &rest)
        };
        assert_eq!(lack(&[]), (0.0, 0.0, vec![]));
        assert_eq!(lack(&[3]), (900.0, 0.0, vec![3]));
        let (with_them, chi, alone) = lack(&[3, 7, 11]);
        assert_eq!((with_them, chi, alone.len()), (2700.0, 900.0, 2));
    }

    /// Levels ask for a size of 1, all else for one of 0.5, both without noise: 0.05 and 0.2 of either are wrong, so that the size is
    /// (1 / 0.05^2 + 0.5 / 0.2^2) / (1 / 0.05^2 + 1 / 0.2^2) = 0.9706, with an error of 1 / (1 / 0.05^2 + 1 / 0.2^2)^1/2 of it. An operation
    /// on the signals has nothing wrong: there it is the mean.
    #[test]
    fn levels_say_more_of_a_size_than_all_else() {
        const SECTIONS: usize = 3;
        let per_section = |level: f64, rest: f64| (0..SECTIONS).flat_map(|_| [level, rest]).collect::<Vec<f64>>();
        let masks = vec![Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None }];
        let nodes = vec![Node { size: 0.0, change: Vec::new() }, Node { size: 2.0, change: per_section(20.0, 20.0) }];
        let of = |exact: bool| {
            let mut covariance = Covariance { diagonal: vec![1e-6; 2 * SECTIONS], inside: Vec::new(), shared: Vec::new(), size: 2 };
            let candidates = [Candidate { exact, ..Candidate::path("effect", nodes.clone()) }];
            let fit = |covariance: &Covariance| {
                let whitener = covariance.whitener();
                let z = whitener.apply(&per_section(10.0, 5.0));
                Fitter::new(&whitener, &candidates, masks.clone()).fit(&z, 0, 0).expect("a path")
            };
            let first = fit(&covariance);
            assert!((first.size - 0.75).abs() < 1e-9);
            covariance.shared = wrong_as_one(&[true, false], &candidates, &masks, std::slice::from_ref(&first));
            let fitted = fit(&covariance);
            (fitted.size, 1.0 / fitted.slope / first.size)
        };
        let weights = [0.05_f64.powi(-2), 0.2_f64.powi(-2)];
        let (size, error) = of(false);
        assert!((size - (weights[0] + 0.5 * weights[1]) / (weights[0] + weights[1])).abs() < 1e-5, "{size}");
        assert!((error - (weights[0] + weights[1]).powf(-0.5)).abs() < 1e-5, "{error}");
        assert!((of(true).0 - 0.75).abs() < 1e-9);
    }

    /// A change of 10 that is simulated may be wrong by 2, one by an operation on the signals by nothing.
    #[test]
    fn only_what_is_simulated_may_be_wrong() {
        let covariance = Covariance { diagonal: vec![1.0; 2], inside: Vec::new(), shared: Vec::new(), size: 1 };
        let whitener = covariance.whitener();
        let nodes = vec![Node { size: 0.0, change: Vec::new() }, Node { size: 1.0, change: vec![10.0; 2] }];
        for (exact, variance) in [(false, 1.0 + 4.0), (true, 1.0)] {
            let candidates = [Candidate { exact, ..Candidate::path("effect", nodes.clone()) }];
            let masks = vec![Mask { confined: None, sections: vec![true; 2], asked_by: None }];
            let fitter = Fitter::new(&whitener, &candidates, masks.clone());
            let member = fitter.fit(&[10.0; 2], 0, 0).expect("a path");
            let chosen = Chosen { rest: vec![0.0; 2], members: vec![member] };
            let wider = with_room(&covariance, &candidates, &masks, &chosen);
            assert!(wider.diagonal.iter().all(|seen| (seen - variance).abs() < 1e-9), "{:?}", wider.diagonal);
        }
    }
}
