//! The diagnosis from end to end: features, candidates, search, guards, verdict.

use super::bench::{Bench, Runs};
use super::beside::alone_again;
use super::cache::Cache;
use super::candidates::{Candidate, Trying, Workshop};
use super::converge::{Converged, Converging};
use super::covariance::{Sensitivity, covariance, discrepancies, expect, strata};
use super::declared::Declared;
use super::fit::{Fitted, Fitter, Known, Mask, less};
use super::guards::families;
use super::lack::{Lack, drop_what_harms, lack_after, lack_of_fit, left, unexplained};
use super::masks::masks;
use super::observe::Observations;
use super::recorded::as_recorded;
use super::search::{Bars, Chosen, Refused, chi_squared, contradicting, nearest, refit, rivals};
use super::sensitivity::sensitivities;
use super::settings::Settings;
use super::settle::{Settled, Weighed};
use super::stability::{Stability, stability};
use super::standing::{Reference, learnt};
use super::suspects::{Suspect, suspect};
use super::whiten::{Covariance, Whitener, dot};
use crate::data::Campaign;
use crate::effects::Catalogue;
use crate::model::parameter;
use crate::problem::{Problem, Problems};
use crate::simulate::{Section, Simulator};

/// What a diagnosis is made of.
pub struct Inputs<'a> {
    pub campaign: &'a Campaign,
    pub catalogue: &'a Catalogue,
    pub settings: &'a Settings,
    pub simulator: Option<&'a dyn Simulator>,
    pub cache: Option<Cache>,
    /// Campaigns whose state is known.
    pub references: &'a [Reference<'a>],
    pub seed: u64,
    pub trying: Trying<'a>,
}

impl std::fmt::Debug for Inputs<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Inputs").field("campaign", &self.campaign.name).finish_non_exhaustive()
    }
}

/// What was found, before it is put in words.
#[derive(Debug)]
pub struct Found {
    pub seen: Observations,
    pub candidates: Vec<Candidate>,
    pub masks: Vec<Mask>,
    pub covariance: Covariance,
    /// With the tolerances as they act where the answer is: what is left is judged by it.
    pub beside: Covariance,
    /// The same without what stands out in a section alone, and its whitener: what the sizes are fitted by.
    pub settled: Covariance,
    pub weighing: Whitener,
    /// Noise and tolerances alone.
    pub tolerated: Covariance,
    pub whitener: Whitener,
    /// Measured - simulated, without what is expected of the tolerances.
    pub difference: Vec<f64>,
    /// The same, without what is expected of the tolerances as they act beside the members.
    pub difference_beside: Vec<f64>,
    pub simulated: Vec<f64>,
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    /// Other candidates in the place of a member: member, fit, how much less evidence.
    pub rivals: Vec<(usize, Fitted, f64)>,
    /// What has most evidence for what the members leave, and is not named.
    pub nearest: Vec<Fitted>,
    /// What no effect of the catalogue moves, where it explains more than the answer.
    pub suspect: Option<Suspect>,
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

/// The value of a simulator's parameter without any effect: of the vehicle file, or neutral.
#[must_use]
pub fn value_of(campaign: &Campaign, key: &str) -> Option<f64> {
    campaign.vehicle.lookup(key).and_then(crate::yaml::Node::number).or_else(|| parameter(key)?.neutral)
}

/// Tolerances that name a parameter which neither the vehicle file nor the model has cannot be sent through the simulator.
fn check_tolerated(inputs: &Inputs<'_>, problems: &mut Problems) {
    if inputs.simulator.is_none() {
        return;
    }
    let model = crate::simulate::model_parameters();
    for (key, span) in inputs.settings.tolerances.iter().flat_map(|tolerance| &tolerance.named) {
        if value_of(inputs.campaign, key).is_none() && parameter(key).is_none() {
            let says = format!("neither the vehicle file nor the model has `{key}`: this tolerance is not allowed for");
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
    let value = |key: &str| value_of(inputs.campaign, key);
    let settings = inputs.settings;
    (inputs.trying)("reading records");
    let unit = |channel: &str| inputs.simulator?.unit(channel);
    let seen = Observations::read(inputs.campaign, sections, inputs.catalogue, settings, &declared, &unit, problems)?;
    let simulated = seen.all(true, |observed| &observed.simulated);
    let measured = seen.all(false, |observed| &observed.measured);
    let mut difference = less(&measured, &simulated);
    let mut runs = Runs::default();
    let standing = learnt(inputs, &mut runs, problems)?;
    standing.take_off(&discrepancies(&seen, settings).0, &mut difference);
    let bench = inputs.simulator.map(|simulator| Bench { seen: &seen, simulator, cache: inputs.cache.clone(), set: Vec::new() });
    (inputs.trying)("simulation without effects");
    let base = match bench.as_ref().map(|bench| bench.features(&[])).transpose() {
        Ok(base) => base.unwrap_or_else(|| simulated.clone()),
        Err(problem) => {
            problems.push(problem);
            return None;
        }
    };
    (inputs.trying)("what the tolerances change");
    let columns = match &bench {
        Some(bench) => sensitivities(bench, settings, &base, &value, &declared, &|_| true, &mut runs),
        None => Vec::new(),
    };
    let sensitivities: Vec<Sensitivity> = columns.iter().flatten().cloned().collect();
    let whole_difference = difference.clone();
    expect(&sensitivities, &mut difference);
    let workshop = Workshop {
        seen: &seen,
        catalogue: inputs.catalogue,
        bench: bench.as_ref(),
        base,
        simulated: simulated.clone(),
        recorded: as_recorded(&seen, bench.as_ref(), settings, &value, &declared, &mut runs),
        neutral: &value,
        trying: inputs.trying,
    };
    let mut candidates = workshop.candidates(&mut runs);
    (inputs.trying)("weighing");
    let whole = covariance(&seen, settings, &simulated, &sensitivities, &declared, Some(&standing));
    let tolerated = covariance(&seen, settings, &simulated, &sensitivities, &declared, None);
    let whitener = whole.whitener();
    let mut masks = masks(&seen, settings);
    let strata = strata(&seen, settings);
    let families = families(&seen, &strata);
    let far = |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted, false);
    // What lies between the two takes its part of the difference, so that nothing else does, and is not named.
    let further = |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted, true);
    let converging = Converging {
        workshop: &workshop,
        covariance: &whole,
        whitener: &whitener,
        difference: &difference,
        families: &families,
        far: &far,
        seed: inputs.seed,
    };
    let Converged { chosen, mut refused, bars, mut known } = converging.search(&mut candidates, &mut masks, &mut runs);
    let lack_before = lack_of_fit(&whole, &seen, &difference);
    let z = whitener.apply(&difference);
    let first = Weighed { difference: difference.clone(), covariance: whole.clone(), whitener: whitener.clone(), z: z.clone(), chosen };
    let again = Settled {
        workshop: &workshop,
        settings,
        columns: &columns,
        standing: &standing,
        value: &value,
        declared: &declared,
        whole: &whole_difference,
        far: &further,
    };
    let before = refused.len();
    let (mut beside, mut settled) = again.answer((&mut candidates, &masks), first.clone(), &lack_before, &bars, &mut refused, &mut runs);
    let mut left = settled.chosen.clone();
    if refused.len() > before && converging.exchange((&candidates, &masks), &mut left, &bars, &refused, &mut known) {
        alone_again(&mut candidates, &left.members);
        let first = Weighed { chosen: left, ..first };
        (beside, settled) = again.answer((&mut candidates, &masks), first, &lack_before, &bars, &mut refused, &mut runs);
    }
    let Weighed { difference: difference_beside, covariance: settled, whitener: weighing, z: own, mut chosen } = settled;
    let fitter = Fitter::of(&weighing, &candidates, masks.clone(), &chosen.members);
    refit(&fitter, &own, &mut chosen);
    let lack_after = drop_what_harms(&fitter, (&beside, &seen), (&difference_beside, &own), &mut chosen, &mut refused, &lack_before);
    drop(fitter);
    let suspect = suspect(&workshop, settings, (&whitener, &z), (&candidates, &masks, &chosen), &mut runs);
    drop(bench);
    let mut found = Found {
        candidates,
        masks,
        covariance: whole,
        tolerated,
        whitener,
        beside,
        settled,
        weighing,
        difference,
        difference_beside,
        simulated,
        chosen,
        refused,
        rivals: Vec::new(),
        nearest: Vec::new(),
        suspect,
        contradicting: None,
        stability: Vec::new(),
        lack_before,
        lack_after,
        bars,
        runs,
        strata,
        seen,
        declared: admitted,
    };
    found.weigh(known, inputs.seed);
    Some(found)
}

impl Found {
    /// Without a member, the others fitted again.
    pub fn refuse(&mut self, at: usize, reason: String, seed: u64) {
        if at == 0 {
            self.suspect = None;
        }
        self.refused.push(Refused::new(self.chosen.members.remove(at), reason));
        alone_again(&mut self.candidates, &self.chosen.members);
        self.fit_again();
        if unexplained(&self.lack_before, &self.lack_after).1 {
            self.beside = self.covariance.clone();
            self.settled = self.covariance.clone();
            self.difference_beside = self.difference.clone();
            self.weighing = self.whitener.clone();
            self.fit_again();
        }
        self.weigh(Known::new(), seed);
    }

    /// Evidence, rivals and stability of the answer. They are those of the covariance without effects: a tolerance that a member is the
    /// blown form of is free there for its rivals as it is for the member, and so is what else might be in its place.
    fn weigh(&mut self, known: Known, seed: u64) {
        let fitter = Fitter::knowing(&self.whitener, &self.candidates, self.masks.clone(), known);
        let z = self.whitener.apply(&self.difference);
        let mut first = self.chosen.clone();
        refit(&fitter, &z, &mut first);
        self.rivals = rivals(&fitter, &z, &first);
        self.nearest = nearest(&fitter, &first, &self.refused);
        self.contradicting = contradicting(&fitter, &first, &self.refused);
        let (own, sized) = (self.weighing.apply(&self.difference_beside), &self.chosen);
        let sizes = Fitter::of(&self.weighing, &self.candidates, self.masks.clone(), &sized.members);
        self.stability = stability((&fitter, &z, &first), (&sizes, &own, sized), &self.refused, &self.strata, seed);
        for (member, first) in self.chosen.members.iter_mut().zip(first.members) {
            (member.fall, member.evidence) = (first.fall, first.evidence);
        }
    }

    fn fit_again(&mut self) {
        self.chosen.members = super::shrink::trained(self, &[]);
        self.chosen.rest =
            self.chosen.members.iter().fold(self.weighing.apply(&self.difference_beside), |rest, member| less(&rest, &member.whitened));
        self.lack_after = lack_after(&self.beside, &self.seen, (&self.candidates, &self.masks), &self.difference_beside, &self.chosen);
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
    let beside = found.beside.whitener();
    let before = beside.apply(&found.difference);
    let after = beside.apply(&left(&found.candidates, &found.masks, &found.difference_beside, &found.chosen));
    let n = before.len().max(1) as f64;
    (chi_squared(&before) / n, chi_squared(&after) / n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::candidates::Node;
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
