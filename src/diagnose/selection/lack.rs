//! Lack of fit: the residual of a set of causes beyond the allowed difference.

use crate::diagnose::features::layout::Kind;
use crate::diagnose::features::observations::Observations;
use crate::diagnose::inference::chosen::{Chosen, Refused};
use crate::diagnose::inference::fit::Fitter;
use crate::diagnose::inference::sets::refit;
use crate::diagnose::levels::lack::{FAR_BEYOND, LACK, LITTLE, MOST_LEFT, ONE_IN, WORSE};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::selection::guards::{View, part};
use crate::diagnose::selection::place::Place;
use crate::diagnose::uncertainty::whiten::{Covariance, less};

/// The covariance with an answer, plus the model error of the simulated members, independent
/// between features.
#[must_use]
pub fn with_room(
    beside: &Covariance,
    candidates: &[Candidate],
    masks: &[Mask],
    chosen: &Chosen,
) -> Covariance {
    let mut wider = beside.clone();
    for member in chosen.members.iter().filter(|member| !candidates[member.candidate].exact) {
        let change = member.change(candidates, masks);
        wider
            .diagonal
            .iter_mut()
            .zip(change)
            .for_each(|(variance, change)| *variance += (beside.response.each * change).powi(2));
    }
    wider
}

/// Lack of fit of a channel, in its levels or in all other features.
#[derive(Clone, Debug)]
pub struct Lack {
    pub channel: String,
    pub kind: Kind,
    /// Standardised: standard deviations of chi-squared.
    pub sigma: f64,
    /// Chi-squared less its expectation.
    pub excess: f64,
    /// Outlying sections, which are excluded.
    pub alone: Vec<usize>,
    /// Standard deviations with the outlying sections included.
    pub sigma_with_them: f64,
}

/// Lack of fit by channel, separately for levels and all other features.
#[must_use]
pub fn lack_of_fit(covariance: &Covariance, seen: &Observations, rest: &[f64]) -> Vec<Lack> {
    use rayon::prelude::*;
    let all: Vec<usize> = seen.first_runs();
    let mut views = Vec::new();
    for (channel, of) in seen.layout.channels.iter().enumerate() {
        for level in [true, false] {
            let keep = |kind: Kind| (kind == Kind::Level) == level;
            let features: Vec<usize> = seen
                .features
                .iter()
                .enumerate()
                .filter(|(_, f)| f.channel == channel && keep(f.kind))
                .map(|(at, _)| at)
                .collect();
            if !features.is_empty() {
                let kind = if level { Kind::Level } else { Kind::Band(0) };
                views.push((
                    of.name.clone(),
                    kind,
                    View { says: String::new(), sections: all.clone(), features },
                ));
            }
        }
    }
    let each = |(channel, kind, mut view): (String, Kind, View)| {
        let count = |view: &View| (view.sections.len() * view.features.len()) as f64;
        let beyond = |chi: f64, n: f64| (chi - n) / (2.0 * n).sqrt();
        let all = count(&view);
        let (with_them, chi, alone) = without_those_alone(covariance, &mut view, rest);
        let n = count(&view);
        Lack {
            channel,
            kind,
            sigma: beyond(chi, n),
            excess: chi - n,
            alone,
            sigma_with_them: beyond(with_them, all),
        }
    };
    views.into_par_iter().map(each).collect()
}

/// Chi-squared of a view with and without outlying sections, and these. A section is outlying if
/// its conditional chi-squared given the others exceeds [`LACK`] standard deviations. The sections
/// are removed from the view.
fn without_those_alone(
    covariance: &Covariance,
    view: &mut View,
    rest: &[f64],
) -> (f64, f64, Vec<usize>) {
    let own = view.features.len() as f64;
    let most = view.sections.len() / ONE_IN;
    let (mut first, mut alone) = (None, Vec::new());
    loop {
        let rest = part(rest, covariance.size, view);
        let products = covariance.part(&view.sections, &view.features).products().of(
            &rest,
            &rest,
            alone.len() < most,
        );
        let (whole, others) =
            products.split_first().map_or((0.0, &[][..]), |(whole, others)| (whole.0, others));
        let with_them = *first.get_or_insert(whole);
        let least = others.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        match least {
            Some((at, left)) if whole - left.0 > own + LACK * (2.0 * own).sqrt() => {
                alone.push(view.sections.remove(at))
            }
            _ => return (with_them, whole, alone),
        }
    }
}

/// Excess of chi-squared over all channels.
pub fn excess(lack: &[Lack]) -> f64 {
    lack.iter().map(|lack| lack.excess.max(0.0)).sum()
}

/// The share of the excess that remains, and whether the gap is unexplained: more than half
/// remains, in more than one kind of feature or channel or far beyond the threshold. One of some
/// forty may exceed the threshold by a little.
#[must_use]
pub fn unexplained(before: &[Lack], after: &[Lack]) -> (f64, bool) {
    let (gap, rest) = (excess(before), excess(after));
    let share = if gap > 0.0 { (rest / gap).clamp(0.0, 1.0) } else { 0.0 };
    let beyond: Vec<f64> =
        after.iter().map(|lack| lack.sigma).filter(|sigma| *sigma > LACK).collect();
    (
        share,
        share > MOST_LEFT
            && (beyond.len() > 1 || beyond.iter().any(|sigma| *sigma > FAR_BEYOND * LACK)),
    )
}

/// Drops members that increase the lack of fit, and gives the remaining lack of fit.
pub fn drop_what_harms(
    fitter: &Fitter<'_>,
    (place, seen): (&Place, &Observations),
    z: &[f64],
    chosen: &mut Chosen,
    refused: &mut Vec<Refused>,
    before: &[Lack],
) -> Vec<Lack> {
    loop {
        let lack = |chosen: &Chosen| {
            lack_after(
                &place.covariance,
                seen,
                (fitter.candidates, &fitter.masks),
                &place.difference,
                chosen,
            )
        };
        let now = lack(chosen);
        let Some(last) = chosen.members.len().checked_sub(1) else { return now };
        let mut without = chosen.clone();
        without.members.remove(last);
        refit(fitter, z, &mut without);
        let then = if without.members.is_empty() { before.to_vec() } else { lack(&without) };
        if excess(&now) <= WORSE * excess(&then) + LITTLE {
            return now;
        }
        let reason = format!(
            "what channels show beyond what is allowed for grows from {:.0} to {:.0}",
            excess(&then),
            excess(&now)
        );
        refused.push(Refused::new(chosen.members[last].clone(), reason));
        *chosen = without;
    }
}

/// The residual of the members, not whitened.
#[must_use]
pub fn left(
    candidates: &[Candidate],
    masks: &[Mask],
    difference: &[f64],
    chosen: &Chosen,
) -> Vec<f64> {
    chosen
        .members
        .iter()
        .fold(difference.to_vec(), |rest, member| less(&rest, &member.change(candidates, masks)))
}

/// Lack of fit of the residual.
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
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::uncertainty::response::ResponseError;

    /// Sixteen sections of nine features of unit variance; a difference of 10 in each feature gives
    /// a chi-squared of 900.
    #[test]
    fn two_of_sixteen_sections_may_stand_out_alone() {
        let covariance = Covariance {
            diagonal: vec![1.0; 16 * 9],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 9,
            response: ResponseError::default(),
        };
        let lack = |off: &[usize]| {
            let rest: Vec<f64> =
                (0..16 * 9).map(|at| if off.contains(&(at / 9)) { 10.0 } else { 0.0 }).collect();
            let mut view = View {
                says: String::new(),
                sections: (0..16).collect(),
                features: (0..9).collect(),
            };
            without_those_alone(&covariance, &mut view, &rest)
        };
        assert_eq!(lack(&[]), (0.0, 0.0, vec![]));
        assert_eq!(lack(&[3]), (900.0, 0.0, vec![3]));
        let (with_them, chi, alone) = lack(&[3, 7, 11]);
        assert_eq!((with_them, chi, alone.len()), (2700.0, 900.0, 2));
    }

    /// A simulated change of 10 has a model error of 2; an operation on the signals has none.
    #[test]
    fn only_what_is_simulated_may_be_wrong() {
        let mut response = ResponseError::default();
        response.each = 0.2;
        let covariance = Covariance {
            diagonal: vec![1.0; 2],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response,
        };
        let whitener = covariance.whitener();
        let nodes =
            vec![Node { size: 0.0, change: Vec::new() }, Node { size: 1.0, change: vec![10.0; 2] }];
        for (exact, variance) in [(false, 1.0 + 4.0), (true, 1.0)] {
            let candidates = [Candidate { exact, ..Candidate::path("effect", nodes.clone()) }];
            let masks = vec![Mask { confined: None, sections: vec![true; 2], asked_by: None }];
            let fitter = Fitter::new(&whitener, &candidates, masks.clone());
            let member = fitter.fit(&[10.0; 2], 0, 0).expect("a path");
            let chosen = Chosen { members: vec![member], ..Chosen::none(&[0.0; 2]) };
            let wider = with_room(&covariance, &candidates, &masks, &chosen);
            assert!(
                wider.diagonal.iter().all(|seen| (seen - variance).abs() < 1e-9),
                "{:?}",
                wider.diagonal
            );
        }
    }
}
