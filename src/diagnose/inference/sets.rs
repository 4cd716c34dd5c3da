//! The search over sets of effects. Every set is scored by its joint evidence; sets that were
//! scored are kept.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use rayon::prelude::*;

use crate::diagnose::inference::chosen::{
    Bars, Chosen, Guard, Judged, Refused, plausible, taken, unconfine, undone,
};
use crate::diagnose::inference::fit::{Fitted, Fitter, Member};
use crate::diagnose::inference::joint::{Joint, fit};
use crate::diagnose::levels::sets::{BETTER, FIRSTS, ROUNDS, TRIED, WORTH};
use crate::diagnose::response::candidate::Candidate;

/// Joint fits of sets to one whitened difference.
#[allow(missing_debug_implementations)]
pub struct Sets<'a> {
    fitter: &'a Fitter<'a>,
    z: &'a [f64],
    scored: Mutex<HashMap<Vec<Member>, Option<Arc<Joint>>>>,
}

/// Conditions on the members of an answer.
#[allow(missing_debug_implementations)]
pub struct Conditions<'a> {
    pub bars: &'a Bars,
    /// Distance of a size from neutral in declared standard deviations.
    pub far: &'a (dyn Fn(&Candidate, f64) -> f64 + Sync),
    pub guard: Guard<'a>,
}

/// Fits all members together.
pub fn refit(fitter: &Fitter<'_>, z: &[f64], chosen: &mut Chosen) {
    Sets::new(fitter, z).fit(chosen);
}

impl<'a> Sets<'a> {
    #[must_use]
    pub fn new(fitter: &'a Fitter<'a>, z: &'a [f64]) -> Self {
        Self { fitter, z, scored: Mutex::default() }
    }

    /// The joint fit of a set; members in increasing order. Nothing for the empty set.
    fn joint(&self, set: &[Member]) -> Option<Arc<Joint>> {
        let mut key = set.to_vec();
        key.sort_unstable();
        if key.is_empty() {
            return None;
        }
        if let Some(known) = self.scored.lock().expect("no thread stops with it").get(&key) {
            return known.clone();
        }
        let found = fit(self.fitter, self.z, &key).map(Arc::new);
        self.scored.lock().expect("no thread stops with it").insert(key, found.clone());
        found
    }

    /// Fall and evidence of a set; zero for the empty one.
    fn score(&self, set: &[Member]) -> (f64, f64) {
        self.joint(set).map_or((0.0, 0.0), |joint| (joint.fall, joint.evidence))
    }

    /// A set with all members fitted together, in the given order.
    #[must_use]
    pub fn chosen(&self, set: &[Member]) -> Chosen {
        let Some(joint) = self.joint(set) else { return Chosen::none(self.z) };
        let member = |at: usize| {
            let own =
                joint.members.iter().find(|member| (member.candidate, member.mask) == set[at])?;
            let without: Vec<Member> = set
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != at)
                .map(|(_, member)| *member)
                .collect();
            let (fall, evidence) = self.score(&without);
            Some(Fitted {
                fall: joint.fall - fall,
                evidence: joint.evidence - evidence,
                ..own.clone()
            })
        };
        let members = (0..set.len()).filter_map(member).collect();
        Chosen {
            members,
            rest: joint.rest.clone(),
            evidence: joint.evidence,
            metric: joint.metric.clone(),
        }
    }

    /// Candidates as a further member of a set, with the fall and the evidence that they add
    /// jointly; the most evidence first.
    #[must_use]
    pub fn further(&self, chosen: &Chosen, bars: &Bars) -> Vec<Fitted> {
        let rest = chosen.weighed();
        let mut fits = self.fitter.all(&rest);
        fits.iter_mut().for_each(|fit| unconfine(self.fitter, &rest, fit, bars));
        fits.retain(|fit| fit.evidence >= WORTH && !taken(self.fitter, chosen, fit));
        fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        fits.truncate(TRIED);
        let set = chosen.set();
        let (fall, evidence) = self.score(&set);
        let one = |fit: Fitted| {
            let member = (fit.candidate, fit.mask);
            let joint = self.joint(&[&set[..], &[member]].concat())?;
            let own = joint.members.iter().find(|own| (own.candidate, own.mask) == member)?;
            Some(Fitted {
                fall: joint.fall - fall,
                evidence: joint.evidence - evidence,
                ..own.clone()
            })
        };
        let mut fits: Vec<Fitted> = fits.into_par_iter().filter_map(one).collect();
        fits.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        fits
    }

    /// For every candidate near enough, the set in which it replaces a member: that member, the
    /// fit, the loss of evidence.
    #[must_use]
    pub fn rivals(&self, chosen: &Chosen, at: usize, bars: &Bars) -> Vec<(usize, Fitted, f64)> {
        let others = self.without(chosen, at);
        let fits = self.further(&others, bars).into_iter();
        fits.map(|fit| (at, chosen.members[at].evidence - fit.evidence, fit))
            .map(|(at, less, fit)| (at, fit, less))
            .collect()
    }

    fn without(&self, chosen: &Chosen, at: usize) -> Chosen {
        let mut set = chosen.set();
        set.remove(at);
        self.chosen(&set)
    }

    /// The set with the most evidence that meets the conditions, among those that contain `start`.
    /// `barred` candidates are not used.
    #[must_use]
    pub fn search(
        &self,
        start: &Chosen,
        mut barred: Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) -> Chosen {
        let kept = start.members.len();
        let mut best = self.grown(start.clone(), kept, &mut barred, of, refused);
        let pair = if kept == 0 && of.bars.most > 1 { self.pair(start, &barred, of) } else { None };
        if let Some(pair) = pair {
            let grown = self.grown(pair, 0, &mut barred.clone(), of, refused);
            if self.worth(&grown, of.bars) > self.worth(&best, of.bars) + BETTER {
                best = grown;
            }
        }
        refused.retain(|refused| {
            best.members.iter().all(|member| member.candidate != refused.fitted.candidate)
        });
        best
    }

    /// The set after replacing members, and adding further ones where that gains evidence.
    #[must_use]
    pub fn replaced(
        &self,
        start: &Chosen,
        mut barred: Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) -> Chosen {
        let mut chosen = start.clone();
        self.fit(&mut chosen);
        for _ in 0..ROUNDS {
            if !self.replace(&mut chosen, 0, &mut barred, of, refused) {
                break;
            }
        }
        chosen
    }

    /// Evidence of a set beyond what its members need.
    fn worth(&self, chosen: &Chosen, bars: &Bars) -> f64 {
        let needed: f64 = chosen
            .members
            .iter()
            .map(|member| bars.least(&self.fitter.candidates[member.candidate]))
            .sum();
        chosen.evidence - needed
    }

    /// Adds, replaces and drops members, except the first `kept`, until no step improves the set.
    fn grown(
        &self,
        mut chosen: Chosen,
        kept: usize,
        barred: &mut Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) -> Chosen {
        for _ in 0..ROUNDS {
            self.add(&mut chosen, kept, barred, of, refused);
            if !self.replace(&mut chosen, kept, barred, of, refused) {
                break;
            }
        }
        chosen
    }

    fn add(
        &self,
        chosen: &mut Chosen,
        kept: usize,
        barred: &mut Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) {
        while chosen.members.len() < of.bars.most {
            let Some(best) = self.admitted(chosen, barred, of, refused) else { break };
            self.push(chosen, best);
            if let Some(other) = undone(chosen) {
                let last = chosen.members.pop().expect("just pushed");
                barred.push(last.candidate);
                let reason = format!(
                    "it mostly cancels the effect of {}",
                    self.fitter.candidates[chosen.members[other].candidate].effect
                );
                refused.push(Refused::new(last, reason));
                self.fit(chosen);
                continue;
            }
            // A member that the others make redundant is dropped.
            let weak = |member: &Fitted| {
                member.evidence < of.bars.least(&self.fitter.candidates[member.candidate])
            };
            if let Some(at) = (kept..chosen.members.len()).find(|at| weak(&chosen.members[*at])) {
                barred.push(chosen.members[at].candidate);
                chosen.members.remove(at);
                self.fit(chosen);
            }
        }
    }

    fn push(&self, chosen: &mut Chosen, fit: Fitted) {
        chosen.members.push(fit);
        self.fit(chosen);
    }

    /// Fits all members together.
    fn fit(&self, chosen: &mut Chosen) {
        let doubtful: Vec<bool> = chosen.members.iter().map(|member| member.doubtful).collect();
        *chosen = self.chosen(&chosen.set());
        chosen
            .members
            .iter_mut()
            .zip(doubtful)
            .for_each(|(member, doubtful)| member.doubtful = doubtful);
    }

    /// The candidate with the most evidence as a further member that meets the conditions.
    fn admitted(
        &self,
        chosen: &Chosen,
        barred: &mut Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) -> Option<Fitted> {
        let fits = self.further(chosen, of.bars).into_iter();
        for mut best in fits.filter(|fit| self.enough(fit, of)) {
            if barred.contains(&best.candidate) {
                continue;
            }
            match (of.guard)(&best, chosen) {
                Judged::Sound => {}
                Judged::Doubtful => best.doubtful = true,
                judged @ (Judged::Refused(_) | Judged::Contradicted(_)) => {
                    barred.push(best.candidate);
                    refused.extend(judged.refused(best));
                    continue;
                }
            }
            return Some(best);
        }
        None
    }

    /// Whether a further member has enough evidence and a size that can be named.
    fn enough(&self, fit: &Fitted, of: &Conditions<'_>) -> bool {
        let (candidate, mask) =
            (&self.fitter.candidates[fit.candidate], &self.fitter.masks[fit.mask]);
        // A confinement to sections selected from the data needs twice the evidence.
        let needed = of.bars.least(candidate) * if mask.asked_by.is_some() { 2.0 } else { 1.0 };
        let far = (of.far)(candidate, fit.size) >= of.bars.tolerance_sd + mask.picked();
        fit.evidence >= needed && far && plausible(candidate, fit.size)
    }

    /// Replaces the member whose replacement gains most; whether there was one.
    fn replace(
        &self,
        chosen: &mut Chosen,
        kept: usize,
        barred: &mut Vec<usize>,
        of: &Conditions<'_>,
        refused: &mut Vec<Refused>,
    ) -> bool {
        let mut best: Option<(usize, Fitted)> = None;
        for at in kept..chosen.members.len() {
            let others = self.without(chosen, at);
            let Some(fit) = self.admitted(&others, barred, of, refused) else { continue };
            let gain = |at: usize, fit: &Fitted| fit.evidence - chosen.members[at].evidence;
            let more = best.as_ref().map_or(BETTER, |(at, fit)| gain(*at, fit));
            if fit.candidate != chosen.members[at].candidate && gain(at, &fit) > more {
                best = Some((at, fit));
            }
        }
        let Some((at, fit)) = best else { return false };
        chosen.members.remove(at);
        self.push(chosen, fit);
        true
    }

    /// The pair with the most evidence beside one of the strongest single effects, both of which
    /// meet the conditions.
    fn pair(&self, none: &Chosen, barred: &[usize], of: &Conditions<'_>) -> Option<Chosen> {
        let fitter = self.fitter;
        let mut pairs: Vec<Chosen> = Vec::new();
        let usable = |fit: &Fitted| {
            !barred.contains(&fit.candidate)
                && plausible(&fitter.candidates[fit.candidate], fit.size)
        };
        for first in self.further(none, of.bars).iter().filter(|fit| usable(fit)).take(FIRSTS) {
            let alone = self.chosen(&[(first.candidate, first.mask)]);
            let second = self
                .further(&alone, of.bars)
                .into_iter()
                .find(|fit| usable(fit) && self.enough(fit, of));
            pairs.extend(second.map(|second| {
                self.chosen(&[(first.candidate, first.mask), (second.candidate, second.mask)])
            }));
        }
        pairs.retain(|pair| {
            pair.members.iter().all(|member| self.enough(member, of)) && undone(pair).is_none()
        });
        pairs.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
        pairs.into_iter().find_map(|pair| {
            let mut judged = pair.clone();
            for at in 0..pair.members.len() {
                match (of.guard)(&pair.members[at], &self.without(&pair, at)) {
                    Judged::Sound => {}
                    Judged::Doubtful => judged.members[at].doubtful = true,
                    Judged::Refused(_) | Judged::Contradicted(_) => return None,
                }
            }
            // The stronger one first.
            judged.members.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
            Some(judged)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::levels::chosen::TOLERANCE_SD;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::response::mask::Mask;
    use crate::diagnose::uncertainty::response::ResponseError;
    use crate::diagnose::uncertainty::whiten::Covariance;

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
        let everywhere = Mask { confined: None, sections: vec![true; SECTIONS], asked_by: None };
        let fitter = Fitter::new(&whitener, candidates, vec![everywhere]);
        let z = per_section(difference);
        let bars =
            Bars { first: 30.0, exact: 15.0, confined: 15.0, tolerance_sd: TOLERANCE_SD, most: 3 };
        let of = Conditions { bars: &bars, far: &|_, _| 100.0, guard: &|_, _| Judged::Sound };
        let found =
            Sets::new(&fitter, &z).search(&Chosen::none(&z), Vec::new(), &of, &mut Vec::new());
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
}
