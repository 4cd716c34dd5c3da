//! The diagnosis from end to end: features, candidates, search, guards, verdict.

use std::sync::Arc;

use rayon::prelude::*;

use super::inputs::{Inputs, value_of};
use super::settings::Settings;
use crate::diagnose::features::bench::Runs;
use crate::diagnose::features::observations::Observations;
use crate::diagnose::features::observed::Observed;
use crate::diagnose::features::strata::strata;
use crate::diagnose::inference::chosen::{
    Bars, Chosen, Refused, chi_squared, contradicting, nearest,
};
use crate::diagnose::inference::fit::{Fitted, Fitter, Known, alone_again};
use crate::diagnose::inference::sets::{Sets, refit};
use crate::diagnose::response::candidate::Candidate;
use crate::diagnose::response::ground::Ground;
use crate::diagnose::response::mask::Mask;
use crate::diagnose::selection::converging::{Converged, Converging};
use crate::diagnose::selection::guards::families;
use crate::diagnose::selection::lack::{Lack, drop_what_harms, lack_of_fit, left};
use crate::diagnose::selection::masks::masks;
use crate::diagnose::selection::place::{Place, Places};
use crate::diagnose::selection::settle::{Settled, Weighed};
use crate::diagnose::selection::stability::{Stability, stability};
use crate::diagnose::selection::suspects::{Suspect, suspect};
use crate::diagnose::uncertainty::declared::Declared;
use crate::diagnose::uncertainty::whiten::{Covariance, Whitener, dot};
use crate::effects::{Action, Applied, Signals};
use crate::model::parameter;
use crate::problem::{Problem, Problems};
use crate::result::diagnosis::Calibration;
use crate::simulate::{Plan, Section, Task, incremented};

/// Numerical results of a diagnosis.
#[derive(Debug)]
pub struct Found {
    pub seen: Observations,
    pub strata: Vec<Vec<usize>>,
    pub declared: Declared,
    pub ground: Ground,
    pub allowed: Allowed,
    pub candidates: Vec<Candidate>,
    pub masks: Vec<Mask>,
    pub answer: Answer,
    pub rates: Rates,
    pub runs: Runs,
}

/// The allowed difference.
#[derive(Debug)]
pub struct Allowed {
    /// Covariance of noise and tolerances alone.
    pub tolerated: Covariance,
    /// The weighing without effects.
    pub alone: Arc<Place>,
    /// The weighing with the tolerances simulated together with the answer. Residuals are judged by
    /// it.
    pub beside: Arc<Place>,
    /// The same without outlying sections. Sizes are fitted by it.
    pub settled: Arc<Place>,
    /// All weighings that were computed.
    places: Places,
}

/// The named effects, and what speaks for and against others.
#[derive(Debug)]
pub struct Answer {
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    /// Other candidates in place of a member: number of the member, fit, loss of evidence.
    pub rivals: Vec<(usize, Fitted, f64)>,
    /// Candidates with the most evidence for the residual that are not named.
    pub nearest: Vec<Fitted>,
    /// A vehicle parameter outside the catalogue that explains more than the answer.
    pub suspect: Option<Suspect>,
    /// Number of the first member when `suspect` was computed.
    suspected: Option<usize>,
    /// A candidate refused for contradictory views that has more evidence for the residual than the
    /// answer has; with that evidence.
    pub contradicting: Option<(Refused, f64)>,
    /// Stability under resampling of the sections, by member.
    pub stability: Vec<Stability>,
    /// Lack of fit by channel and kind of feature, before and after the effects are added.
    pub lack_before: Vec<Lack>,
    pub lack_after: Vec<Lack>,
}

/// The required evidence, and how often the search is right in drawn campaigns.
#[derive(Debug)]
pub struct Rates {
    pub bars: Bars,
    /// Share of drawn campaigns with nothing hidden in which a cause would be named.
    pub false_name_rate: f64,
    /// What the search names in drawn campaigns with known effects.
    pub calibration: Calibration,
}

/// Warns of tolerances whose parameter is in neither the vehicle file nor the model: they cannot be
/// simulated.
fn check_tolerated(inputs: &Inputs<'_>, problems: &mut Problems) {
    if inputs.simulator.is_none() {
        return;
    }
    let model = crate::simulate::model_parameters();
    for (key, span) in inputs.settings.tolerances.iter().flat_map(|tolerance| &tolerance.named) {
        if value_of(inputs.campaign, key).is_none() && parameter(key).is_none() {
            let says = format!(
                "neither the vehicle file nor the model has `{key}`: this tolerance is not used"
            );
            problems.push(
                Problem::warning("unknown-parameter", says)
                    .at(span)
                    .suggest(key, model.iter().map(|(name, _)| *name)),
            );
        }
    }
}

/// Adds the comparison sample by sample, where the catalogue asks for it: each simulated effect is
/// run at the ends of its trials.
fn compare_samples(
    inputs: &Inputs<'_>,
    seen: &mut Observations,
    runs: &mut Runs,
) -> Result<(), Problem> {
    let groups: Vec<bool> = inputs.settings.groups.iter().map(|group| group.samples).collect();
    let Some(simulator) = inputs.simulator.filter(|_| groups.contains(&true)) else {
        return Ok(());
    };
    (inputs.trying)("changes sample by sample");
    let effects = inputs
        .catalogue
        .effects
        .iter()
        .filter(|effect| effect.candidate && effect.action == Action::Simulator);
    let mut trials: Vec<Applied> = Vec::new();
    for (effect, fit) in effects.flat_map(|effect| effect.fits.iter().map(move |fit| (effect, fit)))
    {
        let Some(((_, sizes), _)) = fit.axes.split_first() else { continue };
        let mut ends: Vec<f64> = sizes.first().into_iter().chain(sizes.last()).copied().collect();
        ends.dedup();
        for size in ends {
            let first = |(at, values): (usize, &(usize, Vec<f64>))| {
                let value = if at == 0 { Some(size) } else { values.1.first().copied() };
                Some((effect.parameters[values.0].name.clone(), value?))
            };
            let values = fit.axes.iter().enumerate().filter_map(first).collect();
            trials.push(Applied {
                effect: effect.name.clone(),
                values,
                channels: Vec::new(),
                confined: None,
            });
        }
    }
    let run = |settings: &[(String, f64)], observed: &Observed| {
        simulator.run(&Task { section: &observed.section, settings, shift: 0.0, inside_only: true })
    };
    let without: Vec<Signals> =
        seen.sections.par_iter().map(|observed| run(&[], observed)).collect::<Result<_, _>>()?;
    let each = |applied: &Applied| -> Result<Vec<Signals>, Problem> {
        let one = |(observed, without): (&Observed, &Signals)| {
            let effects = std::slice::from_ref(applied);
            let plan = Plan::new(
                inputs.catalogue,
                effects,
                &observed.section,
                simulator.catalogue_name(),
            )?;
            Ok(incremented(&observed.simulated, &run(&plan.settings, observed)?, without))
        };
        seen.sections.par_iter().zip(&without).map(one).collect()
    };
    // An effect that this simulator does not know has no change to compare.
    let known = |applied: &&Applied| {
        let effects = std::slice::from_ref(*applied);
        Plan::new(inputs.catalogue, effects, &seen.sections[0].section, simulator.catalogue_name())
            .is_ok()
    };
    let with: Vec<Vec<Signals>> =
        trials.iter().filter(known).map(each).collect::<Result<_, _>>()?;
    runs.made += (1 + with.len()) * seen.sections.len();
    seen.compare_samples(&groups, &with);
    Ok(())
}

/// Finds the effects that explain the difference of measurement and simulation.
///
/// Problems: records that cannot be read; no section or channel to compare.
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
    let mut seen = Observations::read(
        inputs.campaign,
        sections,
        inputs.catalogue,
        settings,
        &declared,
        &unit,
        problems,
    )?;
    let mut runs = Runs::default();
    if let Err(problem) = compare_samples(inputs, &mut seen, &mut runs) {
        problems.push(problem);
        return None;
    }
    let ground = Ground::find(inputs, &seen, &admitted, &mut runs, problems)?;
    let strata = strata(&seen, settings);
    let mut masks = masks(&seen, settings);
    let families = families(&seen, &strata);
    let far =
        |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted, false);
    let (alone, tolerated) = ground.alone(settings, &seen, &admitted);
    let lack_before = lack_of_fit(&alone.covariance, &seen, &alone.difference);
    let (candidates, converged, places) =
        ground.work(inputs, &seen, &admitted, Places::default(), |tolerances| {
            let workshop = tolerances.workshop;
            let mut candidates = workshop.candidates(&mut runs);
            (inputs.trying)("weighing");
            let converging = Converging {
                workshop,
                place: &alone,
                tolerances: Some(tolerances),
                families: &families,
                far: &far,
                false_name_rate: settings.false_name_rate,
                seed: inputs.seed,
            };
            let converged = converging.search(&mut candidates, &mut masks, &mut runs);
            let places = tolerances.looked_at().clone();
            (candidates, converged, places)
        });
    let Converged { chosen, refused, bars, false_name_rate, calibration, known } = converged;
    let alone = Arc::new(alone);
    let answer = Answer {
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
    };
    let allowed =
        Allowed { tolerated, beside: alone.clone(), settled: alone.clone(), alone, places };
    let rates = Rates { bars, false_name_rate, calibration };
    let mut found = Found {
        seen,
        strata,
        declared: admitted,
        ground,
        allowed,
        candidates,
        masks,
        answer,
        rates,
        runs,
    };
    found.settle(inputs, false, known);
    Some(found)
}

impl Found {
    /// Refuses a member, then fits the others again.
    pub fn refuse(&mut self, at: usize, reason: String, inputs: &Inputs<'_>) {
        self.answer.refused.push(Refused::new(self.answer.chosen.members.remove(at), reason));
        alone_again(&mut self.candidates, &self.answer.chosen.members);
        self.settle(inputs, true, Known::new());
    }

    /// Fits the answer again with the tolerances simulated together with it, and updates residuals
    /// and alternatives. `gone` says that a member was refused, so that another candidate may
    /// replace one that was chosen together with it.
    fn settle(&mut self, inputs: &Inputs<'_>, gone: bool, known: Known) {
        let far = |candidate: &Candidate, size: f64| {
            deviations(candidate, size, inputs.settings, &self.declared, false)
        };
        // An effect between the threshold without `besides` and the one with it is fitted but not
        // named, so that no other effect explains it.
        let further = |candidate: &Candidate, size: f64| {
            deviations(candidate, size, inputs.settings, &self.declared, true)
        };
        let families = families(&self.seen, &self.strata);
        let places = std::mem::take(&mut self.allowed.places);
        let (masks, alone, bars) = (&self.masks, &self.allowed.alone, &self.rates.bars);
        let answered = self.ground.work(inputs, &self.seen, &self.declared, places, |tolerances| {
            let workshop = tolerances.workshop;
            let (candidates, refused, runs) =
                (&mut self.candidates, &mut self.answer.refused, &mut self.runs);
            let converging = Converging {
                workshop,
                place: alone,
                tolerances: Some(tolerances),
                families: &families,
                far: &far,
                false_name_rate: inputs.settings.false_name_rate,
                seed: inputs.seed,
            };
            let again = Settled { tolerances, far: &further };
            let first = |chosen: Chosen| Weighed { place: alone.clone(), chosen };
            let mut chosen = self.answer.chosen.clone();
            if gone && converging.again((candidates, masks), &mut chosen, bars, refused) {
                alone_again(candidates, &chosen.members);
            }
            let before = refused.len();
            let (mut beside, mut now) = again.answer(
                (candidates, masks),
                first(chosen),
                &self.answer.lack_before,
                bars,
                refused,
                runs,
            );
            let mut left = now.chosen.clone();
            if refused.len() > before
                && converging.again((candidates, masks), &mut left, bars, refused)
            {
                alone_again(candidates, &left.members);
                (beside, now) = again.answer(
                    (candidates, masks),
                    first(left),
                    &self.answer.lack_before,
                    bars,
                    refused,
                    runs,
                );
            }
            let Weighed { place: settled, mut chosen } = now;
            let fitter = Fitter::of(&settled.whitener, candidates, masks.clone(), &chosen.members);
            refit(&fitter, &settled.z, &mut chosen);
            let lack_after = drop_what_harms(
                &fitter,
                (&beside, &self.seen),
                &settled.z,
                &mut chosen,
                refused,
                &self.answer.lack_before,
            );
            drop(fitter);
            let first_of = |chosen: &Chosen| chosen.members.first().map(|member| member.candidate);
            // The suspect depends on the first member, and in place of several members on all of
            // them.
            if !gone
                || first_of(&chosen) != self.answer.suspected
                || self.answer.suspect.as_ref().is_some_and(|suspect| suspect.of_all)
            {
                self.answer.suspected = first_of(&chosen);
                self.answer.suspect =
                    suspect(workshop, inputs.settings, alone, (candidates, masks, &chosen), runs);
            }
            let places = tolerances.looked_at().clone();
            (beside, settled, chosen, lack_after, places)
        });
        (
            self.allowed.beside,
            self.allowed.settled,
            self.answer.chosen,
            self.answer.lack_after,
            self.allowed.places,
        ) = answered;
        self.weigh(known, inputs.seed);
    }

    /// Evidence, rivals and stability of the answer. A member is weighed with the tolerances
    /// simulated together with the members before it. A tolerance of the same parameter is then
    /// free for rivals as well as for the member.
    fn weigh(&mut self, known: Known, seed: u64) {
        let sizes = Fitter::of(
            &self.allowed.settled.whitener,
            &self.candidates,
            self.masks.clone(),
            &self.answer.chosen.members,
        );
        let mut known = known;
        let (mut found, mut stable, mut evidence) = (Vec::new(), Vec::new(), Vec::new());
        let before = |at: usize| {
            self.allowed
                .places
                .beside(&self.answer.chosen.members[..at])
                .unwrap_or_else(|| self.allowed.alone.clone())
        };
        let places: Vec<Arc<Place>> = (0..self.answer.chosen.members.len())
            .map(before)
            .chain([self.allowed.beside.clone()])
            .collect();
        let mut last: Option<(&Arc<Place>, Fitter<'_>, Chosen)> = None;
        for (at, place) in places.iter().enumerate() {
            if last.as_ref().is_none_or(|(known, ..)| !Arc::ptr_eq(known, place)) {
                let known = if Arc::ptr_eq(place, &self.allowed.alone) {
                    std::mem::take(&mut known)
                } else {
                    Known::new()
                };
                let fitter =
                    Fitter::knowing(&place.whitener, &self.candidates, self.masks.clone(), known);
                let mut here = self.answer.chosen.clone();
                refit(&fitter, &place.z, &mut here);
                last = Some((place, fitter, here));
            }
            let Some((_, fitter, here)) = &last else { continue };
            let Some(member) = here.members.get(at) else {
                self.answer.nearest = nearest(fitter, here, &self.answer.refused);
                self.answer.contradicting = contradicting(fitter, here, &self.answer.refused);
                break;
            };
            found.extend(Sets::new(fitter, &place.z).rivals(here, at, &self.rates.bars));
            stable.push(stability(
                (fitter, &place.z, here),
                (&sizes, &self.allowed.settled.z, &self.answer.chosen),
                at,
                &self.answer.refused,
                &self.strata,
                seed,
            ));
            evidence.push((member.fall, member.evidence));
        }
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
        (self.answer.rivals, self.answer.stability) = (found, stable);
        for (member, evidence) in self.answer.chosen.members.iter_mut().zip(evidence) {
            (member.fall, member.evidence) = evidence;
        }
    }
}

/// Distance of a size from neutral in declared standard deviations. `besides` adds the tolerance's
/// further standard deviation. Infinite for an effect that is not a tolerance.
#[must_use]
pub fn deviations(
    candidate: &Candidate,
    size: f64,
    settings: &Settings,
    declared: &Declared,
    besides: bool,
) -> f64 {
    let tolerance = candidate
        .tolerance
        .as_ref()
        .and_then(|name| settings.tolerances.iter().find(|one| one.name == *name));
    let (Some(tolerance), Some(neutral)) = (tolerance, candidate.neutral()) else {
        return f64::INFINITY;
    };
    let sd = declared.get(&tolerance.name).unwrap_or(tolerance.default);
    // For a tolerance declared by section, only the share common to all sections counts.
    let sd = if tolerance.shared > 0.0 { sd * tolerance.shared } else { sd };
    let sd = if besides { sd.hypot(tolerance.besides) } else { sd };
    // A scaled parameter is declared by a relative standard deviation: the distance is that of the
    // logarithm.
    let scaled = tolerance.scales.contains(&candidate.size) && neutral != 0.0;
    let away = if scaled { (size / neutral).max(0.0).ln().abs() } else { (size - neutral).abs() };
    if sd > 0.0 { away / sd } else { f64::INFINITY }
}

/// Length of the whitened change, in standard deviations.
#[must_use]
pub fn length(whitener: &Whitener, change: &[f64]) -> f64 {
    let z = whitener.apply(change);
    dot(&z, &z).sqrt()
}

/// Chi-squared per feature before and after the effects.
#[must_use]
pub fn chi(found: &Found) -> (f64, f64) {
    let beside = &found.allowed.beside;
    let before = beside.whitener.apply(&found.allowed.alone.difference);
    let after = beside.whitener.apply(&left(
        &found.candidates,
        &found.masks,
        &beside.difference,
        &found.answer.chosen,
    ));
    let n = before.len().max(1) as f64;
    (chi_squared(&before) / n, chi_squared(&after) / n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::response::candidate::Node;
    use crate::diagnose::settings::Tolerance;

    /// 0.7 e^0.2 is 4 standard deviations from 0.7 for a relative standard deviation of 5 %, and so
    /// is 0.7 e^-0.2, where the tolerance scales the parameter; otherwise 0.155 is 3.1 of 0.05.
    /// With a common share of 0.5 the number doubles; without one (0) it is unchanged.
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
            let nodes = vec![
                Node { size: neutral, change: Vec::new() },
                Node { size: 2.0, change: vec![1.0] },
            ];
            let candidate = Candidate {
                tolerance: Some("declared".into()),
                ..Candidate::path("effect", nodes)
            };
            move |size: f64| {
                deviations(&candidate, size, &settings, &Declared::default(), besides > 0.0)
            }
        };
        let near = |found: f64, wanted: f64| {
            assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}")
        };
        let (more, less) = (0.7 * 0.2_f64.exp(), 0.7 * (-0.2_f64).exp());
        let scaled = deviations_of(&["size"], 0.7, 1.0, 0.0);
        near(scaled(more), 4.0);
        near(scaled(less), 4.0);
        assert_eq!(scaled(0.0), f64::INFINITY);
        near(deviations_of(&["another"], 0.7, 1.0, 0.0)(0.855), 3.1);
        near(deviations_of(&["another"], 0.7, 0.5, 0.0)(0.855), 6.2);
        near(deviations_of(&["another"], 0.7, 0.0, 0.0)(0.855), 3.1);
        // 5 % and 12 % combine to 13 %.
        near(deviations_of(&["size"], 0.7, 1.0, 0.12)(more), 0.2 / 0.13);
        // A relative change of zero is not defined: the size is taken as absolute.
        near(deviations_of(&["size"], 0.0, 1.0, 0.0)(0.155), 3.1);
    }
}
