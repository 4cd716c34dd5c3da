//! The diagnosis from end to end: features, candidates, search, guards, verdict.

use std::sync::Arc;

use super::allowed::covariance::strata;
use super::allowed::declared::Declared;
use super::allowed::whiten::{Covariance, Whitener, dot};
use super::inputs::{Inputs, value_of};
use super::observe::bench::Runs;
use super::observe::observations::Observations;
use super::search::beside::alone_again;
use super::search::candidates::Candidate;
use super::search::choose::{Bars, Chosen, Refused, chi_squared, contradicting, nearest, refit, rivals};
use super::search::converge::{Converged, Converging};
use super::search::fit::{Fitted, Fitter, Known, Mask};
use super::search::ground::Ground;
use super::search::guards::families;
use super::search::lack::{Lack, drop_what_harms, lack_of_fit, left};
use super::search::masks::masks;
use super::search::place::{Place, Places};
use super::search::settle::{Settled, Weighed};
use super::search::stability::{Stability, stability};
use super::search::suspects::{Suspect, suspect};
use super::settings::Settings;
use crate::model::parameter;
use crate::problem::{Problem, Problems};
use crate::simulate::Section;

/// What was found, before it is put in words.
#[derive(Debug)]
pub struct Found {
    pub seen: Observations,
    pub candidates: Vec<Candidate>,
    pub masks: Vec<Mask>,
    /// Beside no effect.
    pub alone: Arc<Place>,
    /// Where the answer is: what is left is judged there.
    pub beside: Arc<Place>,
    /// The same without what stands out in a section alone: what the sizes are fitted by.
    pub settled: Arc<Place>,
    /// All that were looked at.
    pub places: Places,
    /// Noise and tolerances alone.
    pub tolerated: Covariance,
    pub ground: Ground,
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    /// Other candidates in the place of a member: member, fit, how much less evidence.
    pub rivals: Vec<(usize, Fitted, f64)>,
    /// What has most evidence for what the members leave, and is not named.
    pub nearest: Vec<Fitted>,
    /// What no effect of the catalogue moves, where it explains more than the answer.
    pub suspect: Option<Suspect>,
    /// The first member when it was looked for.
    suspected: Option<usize>,
    /// What views contradict and has more evidence than the answer, for what that leaves.
    pub contradicting: Option<(Refused, f64)>,
    /// By member: whether it stands when other sections are drawn.
    pub stability: Vec<Stability>,
    /// Channels and kinds where what is left, and what was there, is more than is allowed for.
    pub lack_before: Vec<Lack>,
    pub lack_after: Vec<Lack>,
    pub bars: Bars,
    pub runs: Runs,
    pub strata: Vec<Vec<usize>>,
    pub declared: Declared,
}

/// Tolerances that name a parameter which neither the vehicle file nor the model has cannot be sent through the simulator.
fn check_tolerated(inputs: &Inputs<'_>, problems: &mut Problems) {
    if inputs.simulator.is_none() {
        return;
    }
    let model = crate::simulate::model_parameters();
    for (key, span) in inputs.settings.tolerances.iter().flat_map(|tolerance| &tolerance.named) {
        if value_of(inputs.campaign, key).is_none() && parameter(key).is_none() {
            let says = format!("neither the vehicle file nor the model has `{key}`: this tolerance is not used");
            problems.push(Problem::warning("unknown-parameter", says).at(span).suggest(key, model.iter().map(|(name, _)| *name)));
        }
    }
}

/// Finds what explains the difference of measurement and simulation.
///
/// Problems: of reading; nothing to compare.
pub fn find(inputs: &Inputs<'_>, sections: Vec<Section>, problems: &mut Problems) -> Option<Found> {
    let admitted = Declared::read(inputs.campaign, inputs.settings, problems);
    if problems.errors() > 0 {
        return None;
    }
    check_tolerated(inputs, problems);
    let declared = |name: &str| admitted.get(name);
    let settings = inputs.settings;
    (inputs.trying)("reading records");
    let unit = |channel: &str| inputs.simulator?.unit(channel);
    let seen = Observations::read(inputs.campaign, sections, inputs.catalogue, settings, &declared, &unit, problems)?;
    let mut runs = Runs::default();
    let ground = Ground::find(inputs, &seen, &admitted, &mut runs, problems)?;
    let (alone, tolerated) = ground.alone(inputs, &seen, &admitted);
    let strata = strata(&seen, settings);
    let lack_before = lack_of_fit(&alone.covariance, &seen, &alone.difference);
    let far = |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted, false);
    let mut masks = masks(&seen, settings);
    let families = families(&seen, &strata);
    let (candidates, converged, places) = ground.work(inputs, &seen, &admitted, Places::default(), |tolerances| {
        let workshop = tolerances.workshop;
        let mut candidates = workshop.candidates(&mut runs);
        (inputs.trying)("weighing");
        let converging =
            Converging { workshop, place: &alone, tolerances: Some(tolerances), families: &families, far: &far, seed: inputs.seed };
        let converged = converging.search(&mut candidates, &mut masks, &mut runs);
        let places = tolerances.looked_at().clone();
        (candidates, converged, places)
    });
    let Converged { chosen, refused, bars, known } = converged;
    let alone = Arc::new(alone);
    let mut found = Found {
        candidates,
        masks,
        beside: alone.clone(),
        settled: alone.clone(),
        alone,
        places,
        tolerated,
        ground,
        chosen,
        refused,
        rivals: Vec::new(),
        nearest: Vec::new(),
        suspect: None,
        suspected: None,
        contradicting: None,
        stability: Vec::new(),
        lack_after: lack_before.clone(),
        lack_before,
        bars,
        runs,
        strata,
        seen,
        declared: admitted,
    };
    found.settle(inputs, false, known);
    Some(found)
}

impl Found {
    /// Without a member, what is left settled again.
    pub fn refuse(&mut self, at: usize, reason: String, inputs: &Inputs<'_>) {
        self.refused.push(Refused::new(self.chosen.members.remove(at), reason));
        alone_again(&mut self.candidates, &self.chosen.members);
        self.settle(inputs, true, Known::new());
    }

    /// The answer where it puts the vehicle: sizes, what is left, and what else may be in its place. `gone` says that a member was refused,
    /// which may let another in the place of one that was chosen beside it.
    fn settle(&mut self, inputs: &Inputs<'_>, gone: bool, mut known: Known) {
        let far = |candidate: &Candidate, size: f64| deviations(candidate, size, inputs.settings, &self.declared, false);
        // What lies between the two takes its part of the difference, so that nothing else does, and is not named.
        let further = |candidate: &Candidate, size: f64| deviations(candidate, size, inputs.settings, &self.declared, true);
        let families = families(&self.seen, &self.strata);
        let places = std::mem::take(&mut self.places);
        let (masks, alone, bars) = (&self.masks, &self.alone, &self.bars);
        let answered = self.ground.work(inputs, &self.seen, &self.declared, places, |tolerances| {
            let workshop = tolerances.workshop;
            let (candidates, refused, runs) = (&mut self.candidates, &mut self.refused, &mut self.runs);
            let converging =
                Converging { workshop, place: alone, tolerances: Some(tolerances), families: &families, far: &far, seed: inputs.seed };
            let again = Settled { tolerances, far: &further };
            let first = |chosen: Chosen| Weighed { place: alone.clone(), chosen };
            let mut chosen = self.chosen.clone();
            if gone && converging.exchange((candidates, masks), &mut chosen, bars, refused, &mut known) {
                alone_again(candidates, &chosen.members);
            }
            let before = refused.len();
            let (mut beside, mut now) = again.answer((candidates, masks), first(chosen), &self.lack_before, bars, refused, runs);
            let mut left = now.chosen.clone();
            if refused.len() > before && converging.exchange((candidates, masks), &mut left, bars, refused, &mut known) {
                alone_again(candidates, &left.members);
                (beside, now) = again.answer((candidates, masks), first(left), &self.lack_before, bars, refused, runs);
            }
            let Weighed { place: settled, mut chosen } = now;
            let fitter = Fitter::of(&settled.whitener, candidates, masks.clone(), &chosen.members);
            refit(&fitter, &settled.z, &mut chosen);
            let lack_after = drop_what_harms(&fitter, (&beside, &self.seen), &settled.z, &mut chosen, refused, &self.lack_before);
            drop(fitter);
            let first_of = |chosen: &Chosen| chosen.members.first().map(|member| member.candidate);
            // What may take the place of the first member depends on what that is, and what may take that of all on them.
            if !gone || first_of(&chosen) != self.suspected || self.suspect.as_ref().is_some_and(|suspect| suspect.of_all) {
                self.suspected = first_of(&chosen);
                self.suspect = suspect(workshop, inputs.settings, alone, (candidates, masks, &chosen), runs);
            }
            let places = tolerances.looked_at().clone();
            (beside, settled, chosen, lack_after, places)
        });
        (self.beside, self.settled, self.chosen, self.lack_after, self.places) = answered;
        self.weigh(known, inputs.seed);
    }

    /// Evidence, rivals and stability of the answer. A member is weighed with the tolerances as they act beside those before it: one that
    /// it is the blown form of is free there for its rivals as it is for the member, and so is what else might be in its place.
    fn weigh(&mut self, known: Known, seed: u64) {
        let sizes = Fitter::of(&self.settled.whitener, &self.candidates, self.masks.clone(), &self.chosen.members);
        let mut known = known;
        let (mut found, mut stable, mut evidence) = (Vec::new(), Vec::new(), Vec::new());
        let before = |at: usize| self.places.beside(&self.chosen.members[..at]).unwrap_or_else(|| self.alone.clone());
        let places: Vec<Arc<Place>> = (0..self.chosen.members.len()).map(before).chain([self.beside.clone()]).collect();
        let mut last: Option<(&Arc<Place>, Fitter<'_>, Chosen)> = None;
        for (at, place) in places.iter().enumerate() {
            if last.as_ref().is_none_or(|(known, ..)| !Arc::ptr_eq(known, place)) {
                let known = if Arc::ptr_eq(place, &self.alone) { std::mem::take(&mut known) } else { Known::new() };
                let fitter = Fitter::knowing(&place.whitener, &self.candidates, self.masks.clone(), known);
                let mut here = self.chosen.clone();
                refit(&fitter, &place.z, &mut here);
                last = Some((place, fitter, here));
            }
            let Some((_, fitter, here)) = &last else { continue };
            let Some(member) = here.members.get(at) else {
                self.nearest = nearest(fitter, here, &self.refused);
                self.contradicting = contradicting(fitter, here, &self.refused);
                break;
            };
            found.extend(rivals(fitter, &place.z, here, at));
            stable.push(stability(
                (fitter, &place.z, here),
                (&sizes, &self.settled.z, &self.chosen),
                at,
                &self.refused,
                &self.strata,
                seed,
            ));
            evidence.push((member.fall, member.evidence));
        }
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
        (self.rivals, self.stability) = (found, stable);
        for (member, evidence) in self.chosen.members.iter_mut().zip(evidence) {
            (member.fall, member.evidence) = evidence;
        }
    }
}

/// How many declared standard deviations a size is from neutral, with what may be off `besides` or without; infinitely many for an effect
/// that is no tolerance.
#[must_use]
pub fn deviations(candidate: &Candidate, size: f64, settings: &Settings, declared: &Declared, besides: bool) -> f64 {
    let tolerance = candidate.tolerance.as_ref().and_then(|name| settings.tolerances.iter().find(|one| one.name == *name));
    let (Some(tolerance), Some(neutral)) = (tolerance, candidate.neutral()) else { return f64::INFINITY };
    let sd = declared.get(&tolerance.name).unwrap_or(tolerance.default);
    // Of what is declared for single sections, what all of them have in common is less.
    let sd = if tolerance.shared > 0.0 { sd * tolerance.shared } else { sd };
    let sd = if besides { sd.hypot(tolerance.besides) } else { sd };
    // What is scaled is declared as a factor to what the vehicle file has: twice as much is as far as half of it.
    let scaled = tolerance.scales.contains(&candidate.size) && neutral != 0.0;
    let away = if scaled { (size / neutral).max(0.0).ln().abs() } else { (size - neutral).abs() };
    if sd > 0.0 { away / sd } else { f64::INFINITY }
}

/// Whitened size of a change.
#[must_use]
pub fn length(whitener: &Whitener, change: &[f64]) -> f64 {
    let z = whitener.apply(change);
    dot(&z, &z).sqrt()
}

/// Chi-squared per feature before and after.
#[must_use]
pub fn chi(found: &Found) -> (f64, f64) {
    let beside = &found.beside;
    let before = beside.whitener.apply(&found.alone.difference);
    let after = beside.whitener.apply(&left(&found.candidates, &found.masks, &beside.difference, &found.chosen));
    let n = before.len().max(1) as f64;
    (chi_squared(&before) / n, chi_squared(&after) / n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::candidates::Node;
    use crate::diagnose::settings::Tolerance;

    /// 0.7 times e^0.2 is 4 standard deviations of a factor of 5 % off, and so is 0.7 over e^0.2, where the tolerance scales the
    /// parameter; else 0.155 is 3.1 of 0.05. Twice as many where all sections have half of a standard deviation in common, as many where
    /// they have nothing in common.
    #[test]
    fn what_is_scaled_is_declared_as_a_factor_to_what_the_vehicle_has() {
        let deviations_of = |scales: &[&str], neutral: f64, shared: f64, besides: f64| {
            let tolerance = Tolerance {
                name: "declared".into(),
                unit: crate::units::Unit::one(),
                default: 0.05,
                scales: scales.iter().map(|key| (*key).to_string()).collect(),
                adds: Vec::new(),
                sets: Vec::new(),
                named: Vec::new(),
                expected: 0.0,
                per_section: false,
                shared,
                besides,
                suspects: false,
            };
            let settings = Settings { tolerances: vec![tolerance], ..Settings::default() };
            let nodes = vec![Node { size: neutral, change: Vec::new() }, Node { size: 2.0, change: vec![1.0] }];
            let candidate = Candidate { tolerance: Some("declared".into()), ..Candidate::path("effect", nodes) };
            move |size: f64| deviations(&candidate, size, &settings, &Declared::default(), besides > 0.0)
        };
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}");
        let (more, less) = (0.7 * 0.2_f64.exp(), 0.7 * (-0.2_f64).exp());
        let scaled = deviations_of(&["size"], 0.7, 1.0, 0.0);
        near(scaled(more), 4.0);
        near(scaled(less), 4.0);
        assert_eq!(scaled(0.0), f64::INFINITY);
        near(deviations_of(&["another"], 0.7, 1.0, 0.0)(0.855), 3.1);
        near(deviations_of(&["another"], 0.7, 0.5, 0.0)(0.855), 6.2);
        near(deviations_of(&["another"], 0.7, 0.0, 0.0)(0.855), 3.1);
        // 5 % and 12 % besides are 13 %.
        near(deviations_of(&["size"], 0.7, 1.0, 0.12)(more), 0.2 / 0.13);
        // There is no factor to nothing: it is taken as it stands.
        near(deviations_of(&["size"], 0.0, 1.0, 0.0)(0.155), 3.1);
    }
}
