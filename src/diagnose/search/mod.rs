//! The search over sets of effects: add, replace, drop. Every set is scored by its joint evidence;
//! sets that were scored are kept.

pub mod calibration;

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, PoisonError},
};

use rayon::prelude::*;

use crate::diagnose::fit::{
    fitter::{Fitted, Fitter, Member},
    joint::{Joint, fit},
    set::{Bars, Chosen, plausible},
};
use crate::diagnose::levels::search::{
    BETTER, CONFINED, CONFINED_SHARE, FIRSTS, MOST, SECONDS, TOGETHER, TOLERANCE_SD, TRIED, WORTH,
};
use crate::diagnose::linearise::candidate::Candidate;

/// Distance of a size from neutral in declared standard deviations.
pub type Far<'a> = &'a (dyn Fn(&Candidate, f64) -> f64 + Sync);

/// The search for one whitened difference.
#[allow(missing_debug_implementations)]
pub struct Search<'a> {
    pub fitter: &'a Fitter<'a>,
    z: &'a [f64],
    bars: &'a Bars,
    far: Far<'a>,
    scored: Mutex<HashMap<Vec<Member>, Option<Arc<Joint>>>>,
}

/// The requirement that a member does not meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Its evidence, and the required one.
    Evidence(f64, f64),
    /// Its size is outside the range of the catalogue.
    Range,
    /// All sections show it as well as those that it is confined to.
    Confinement,
}

impl<'a> Search<'a> {
    pub fn new(fitter: &'a Fitter<'a>, z: &'a [f64], bars: &'a Bars, far: Far<'a>) -> Self {
        Self { fitter, z, bars, far, scored: Mutex::default() }
    }

    /// The joint fit of a set; members in increasing order. Nothing for the empty set.
    fn joint(&self, set: &[Member]) -> Option<Arc<Joint>> {
        let mut key = set.to_vec();
        key.sort_unstable();
        if key.is_empty() {
            return None;
        }
        let scored = || self.scored.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = scored().get(&key) {
            return known.clone();
        }
        let found = fit(self.fitter, self.z, &key).map(Arc::new);
        scored().insert(key, found.clone());
        found
    }

    /// Evidence of a set; zero for the empty one.
    pub fn evidence(&self, set: &[Member]) -> f64 {
        self.joint(set).map_or(0.0, |joint| joint.evidence)
    }

    /// A set with all members fitted together, in the given order.
    pub fn chosen(&self, set: &[Member]) -> Chosen {
        let Some(joint) = self.joint(set) else { return Chosen::none(self.z) };
        let member = |at: usize| {
            let own =
                joint.members.iter().find(|member| (member.candidate, member.mask) == set[at])?;
            let without = self.joint(&without(set, at));
            let (fall, evidence) =
                without.map_or((0.0, 0.0), |without| (without.fall, without.evidence));
            Some(Fitted {
                fall: joint.fall - fall,
                evidence: joint.evidence - evidence,
                ..own.clone()
            })
        };
        let all = (0..set.len()).filter_map(member);
        let (members, nuisances) = all.partition(|member| self.is_named(member));
        Chosen {
            members,
            nuisances,
            rest: joint.rest.clone(),
            evidence: joint.evidence,
            metric: joint.metric.clone(),
        }
    }

    /// Whether a member is named: beyond its declared tolerance, if it has one.
    pub fn is_named(&self, member: &Fitted) -> bool {
        (self.far)(&self.fitter.candidates[member.candidate], member.size) >= TOLERANCE_SD
    }

    /// The candidates with the most evidence beside a set, each under its best mask, most first.
    pub fn further(&self, set: &[Member], barred: &[usize], most: usize) -> Vec<Fitted> {
        let beside = self.joint(set);
        let rest = beside.as_ref().map_or_else(
            || self.z.to_vec(),
            |joint| joint.metric.apply(&joint.metric.apply(&joint.rest)),
        );
        let mut fits = self.fitter.all(&rest);
        fits.iter_mut().for_each(|fit| self.unconfine(&rest, fit));
        fits.retain(|fit| {
            fit.evidence >= WORTH
                && !barred.contains(&fit.candidate)
                && !self.taken(set, fit.candidate)
        });
        fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        fits.truncate(most);
        let before = self.evidence(set);
        let jointly = |fit: Fitted| {
            let member = (fit.candidate, fit.mask);
            let joint = self.joint(&with(set, member))?;
            let own = joint.members.iter().find(|own| (own.candidate, own.mask) == member)?;
            Some(Fitted { evidence: joint.evidence - before, ..own.clone() })
        };
        let mut fits: Vec<Fitted> = fits.into_par_iter().filter_map(jointly).collect();
        fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        fits
    }

    /// Removes a confinement that adds too little to the same candidate in all sections.
    fn unconfine(&self, rest: &[f64], fit: &mut Fitted) {
        if fit.mask == 0 {
            return;
        }
        let Some(whole) = self.fitter.fit(rest, fit.candidate, 0) else { return };
        if fit.evidence < whole.evidence + CONFINED.max(CONFINED_SHARE * whole.evidence) {
            *fit = whole;
        }
    }

    /// Whether the same cause is a member already: the same effect on the same channels, or an
    /// inverted channel.
    fn taken(&self, set: &[Member], candidate: usize) -> bool {
        let of = &self.fitter.candidates[candidate];
        set.iter().any(|member| {
            let known = &self.fitter.candidates[member.0];
            let inverted = known.exact
                && of.exact
                && (known.discrete || of.discrete)
                && known.channels == of.channels;
            let alike = known.channels == of.channels || of.channels.is_empty();
            inverted || known.effect == of.effect && alike
        })
    }

    /// The requirement that a member of a set does not meet.
    pub fn fault(&self, set: &[Member], at: usize) -> Option<Fault> {
        let joint = self.joint(set)?;
        let member = joint.members.iter().find(|own| (own.candidate, own.mask) == set[at])?;
        let of = &self.fitter.candidates[member.candidate];
        let evidence = joint.evidence - self.evidence(&without(set, at));
        let needed = self.bars.least(of);
        if evidence < needed {
            return Some(Fault::Evidence(evidence, needed));
        }
        if !plausible(of, member.size) {
            return Some(Fault::Range);
        }
        if member.mask != 0 {
            let everywhere = with(&without(set, at), (member.candidate, 0));
            let adds = joint.evidence - self.evidence(&everywhere);
            return (adds < CONFINED.max(CONFINED_SHARE * evidence)).then_some(Fault::Confinement);
        }
        None
    }

    fn is_sound(&self, set: &[Member]) -> bool {
        self.chosen(set).members.len() <= MOST
            && (0..set.len()).all(|at| self.fault(set, at).is_none())
    }

    /// The set with the most evidence that steps from `start` reach. A member of `start` that does
    /// not meet the requirements is dropped first.
    pub fn run(&self, start: &[Member], barred: &[usize]) -> Vec<Member> {
        let mut set = self.dropped(start);
        while let Some(next) = self.step(&set, barred) {
            set = next;
        }
        // The order of an answer: the most evidence first.
        let mut chosen = self.chosen(&set);
        chosen.members.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        chosen.set()
    }

    /// The set without members that do not meet the requirements, the one with the least evidence
    /// first; a confinement is dropped before its effect.
    fn dropped(&self, start: &[Member]) -> Vec<Member> {
        let mut set = start.to_vec();
        loop {
            let faults = (0..set.len()).filter_map(|at| Some((at, self.fault(&set, at)?)));
            let evidence = |at: usize| self.evidence(&set) - self.evidence(&without(&set, at));
            let worst = faults.min_by(|a, b| evidence(a.0).total_cmp(&evidence(b.0)));
            match worst {
                None => {
                    let named = self.chosen(&set).members;
                    let least = named.iter().min_by(|a, b| a.evidence.total_cmp(&b.evidence));
                    match least.filter(|_| named.len() > MOST) {
                        None => return set,
                        Some(least) => {
                            set.retain(|member| *member != (least.candidate, least.mask))
                        }
                    }
                }
                Some((at, Fault::Confinement)) => set[at].1 = 0,
                Some((at, _)) => {
                    set.remove(at);
                }
            }
        }
    }

    /// The best sound set that is one step away: a member more, a pair in place of none, or another
    /// effect in place of a member. Nothing if none has more evidence.
    fn step(&self, set: &[Member], barred: &[usize]) -> Option<Vec<Member>> {
        let mut proposed: Vec<Vec<Member>> = Vec::new();
        let members = |fits: Vec<Fitted>| fits.into_iter().map(|fit| (fit.candidate, fit.mask));
        if set.len() < TOGETHER {
            let firsts: Vec<Member> = members(self.further(set, barred, TRIED)).collect();
            proposed.extend(firsts.iter().map(|member| with(set, *member)));
            // The best single effect need not be a member of the best pair.
            for first in firsts.iter().filter(|_| set.is_empty()).take(FIRSTS) {
                let seconds = members(self.further(&[*first], barred, SECONDS));
                proposed.extend(seconds.map(|second| vec![*first, second]));
            }
        }
        for at in 0..set.len() {
            let others = without(set, at);
            let instead = members(self.further(&others, barred, SECONDS));
            proposed.extend(
                instead.filter(|other| *other != set[at]).map(|other| with(&others, other)),
            );
        }
        let needed = self.evidence(set) + BETTER;
        let mut scored: Vec<(f64, Vec<Member>)> =
            proposed.into_iter().map(|set| (self.evidence(&set), set)).collect();
        scored.retain(|(evidence, _)| *evidence > needed);
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        scored.into_iter().map(|(_, set)| set).find(|set| self.is_sound(set))
    }
}

/// A set without one of its members.
pub fn without(set: &[Member], at: usize) -> Vec<Member> {
    let others = set.iter().enumerate().filter(|(other, _)| *other != at);
    others.map(|(_, member)| *member).collect()
}

/// A set with one more member.
pub fn with(set: &[Member], member: Member) -> Vec<Member> {
    [set, &[member]].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::Node;
    use crate::diagnose::linearise::mask::Mask;
    use crate::diagnose::linearise::response::ResponseError;
    use crate::diagnose::linearise::whiten::Covariance;

    const SECTIONS: usize = 10;

    fn per_section(of: &[f64]) -> Vec<f64> {
        (0..SECTIONS).flat_map(|_| of.to_vec()).collect()
    }

    fn path(effect: &str, change: &[f64]) -> Candidate {
        let nodes = vec![
            Node { size: 0.0, change: Vec::new() },
            Node { size: 100.0, change: per_section(change) },
        ];
        Candidate { range: (0.0, 100.0), ..Candidate::path(effect, nodes) }
    }

    /// The members found for a difference of all sections: candidate and fall.
    fn named(
        candidates: &[Candidate],
        response: ResponseError,
        difference: &[f64],
    ) -> Vec<(usize, f64)> {
        let size = difference.len();
        let diagonal = vec![1.0; size * SECTIONS];
        let covariance =
            Covariance { diagonal, inside: Vec::new(), shared: Vec::new(), size, response };
        let whitener = covariance.whitener();
        let fitter = Fitter::new(&whitener, candidates, vec![Mask::everywhere(SECTIONS)]);
        let z = per_section(difference);
        let bars = Bars { first: 30.0, exact: 15.0 };
        let search = Search::new(&fitter, &z, &bars, &|_, _| 100.0);
        let found = search.chosen(&search.run(&[], &[]));
        found.members.iter().map(|member| (member.candidate, member.fall)).collect()
    }

    /// Differences of 30 and 3. The first effect changes both features, the second by a tenth of
    /// the first, with an independent model error of a fifth of the change in each: 3 * 0.2 = 0.6
    /// would be usual, but the second feature differs by all of 3 more than it should where the
    /// first effect leaves it alone.
    #[test]
    fn what_a_simulated_effect_may_be_wrong_by_is_not_named_beside_it() {
        let error = |sd: f64| ResponseError::of(&[(&[0], sd), (&[1], sd)], SECTIONS);
        let found = |second: f64, exact: bool| {
            let candidates = [
                Candidate { exact, ..path("large", &[100.0, 30.0]) },
                path("small", &[0.0, 100.0]),
            ];
            let found = named(&candidates, error(0.2), &[30.0, 9.0 + second]);
            found.into_iter().map(|(candidate, _)| candidate).collect::<Vec<_>>()
        };
        // 3 is 1.7 standard deviations of the error of 0.2 * 9 = 1.8; 60 is more than
        // that error can be at any size.
        assert_eq!(found(3.0, false), [0]);
        assert_eq!(found(3.0, true), [0, 1]);
        assert_eq!(found(60.0, false), [0, 1]);
    }

    /// Two effects that are each half of a third one: the third explains most alone, but the two
    /// explain all.
    #[test]
    fn two_effects_are_found_where_a_third_is_the_best_single_one() {
        let candidates = [
            path("one", &[100.0, 0.0, 0.0]),
            path("other", &[0.0, 100.0, 0.0]),
            path("between", &[70.0, 70.0, 15.0]),
        ];
        let found = named(&candidates, ResponseError::default(), &[20.0, 20.0, 0.0]);
        assert_eq!(found.iter().map(|(candidate, _)| *candidate).collect::<Vec<_>>(), [0, 1]);
        // Each loses what it explains: 10 * 20^2.
        assert!(found.iter().all(|(_, fall)| (fall - 4000.0).abs() < 1e-6), "{found:?}");
    }

    /// The first two effects explain a difference of 20 and 20. From a set of another effect that
    /// is not there, they are reached by dropping it: it explains 15 of the third feature, whose
    /// evidence of 10 * 0.3^2 is too little.
    #[test]
    fn a_member_that_is_not_there_is_dropped() {
        let candidates = [
            path("one", &[100.0, 0.0, 0.0]),
            path("other", &[0.0, 100.0, 0.0]),
            path("third", &[0.0, 0.0, 100.0]),
        ];
        let covariance = Covariance {
            diagonal: vec![1.0; 3 * SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 3,
            response: ResponseError::default(),
        };
        let whitener = covariance.whitener();
        let fitter = Fitter::new(&whitener, &candidates, vec![Mask::everywhere(SECTIONS)]);
        let z = per_section(&[20.0, 20.0, 0.3]);
        let bars = Bars { first: 30.0, exact: 15.0 };
        let search = Search::new(&fitter, &z, &bars, &|_, _| 100.0);
        let fault = search.fault(&[(2, 0)], 0);
        assert!(matches!(fault, Some(Fault::Evidence(evidence, needed)) if evidence < needed));
        let mut found = search.run(&[(2, 0)], &[]);
        found.sort_unstable();
        assert_eq!(found, [(0, 0), (1, 0)]);
        // A candidate that is barred is not proposed.
        assert_eq!(search.run(&[(2, 0)], &[1]), [(0, 0)]);
        // A size that is a declared tolerance is not named.
        let near = Search::new(&fitter, &z, &bars, &|_, _| 3.0);
        let fitted = near.chosen(&[(0, 0)]);
        assert!(near.fault(&[(0, 0)], 0).is_none());
        assert!(fitted.members.is_empty() && fitted.nuisances.len() == 1);
        assert!(near.chosen(&near.run(&[], &[])).members.is_empty());
    }
}
