//! The diagnosis from end to end: features, candidates, search, guards, verdict.

use super::bench::{Bench, Runs};
use super::cache::Cache;
use super::candidates::{Candidate, Trying, Workshop};
use super::covariance::{Sensitivity, covariance, strata};
use super::declared::Declared;
use super::fit::{Fitted, Fitter, Known, Mask, less};
use super::guards::{View, carried, contradiction, families};
use super::lack::{Lack, drop_what_harms, lack_after, lack_of_fit, left, unexplained};
use super::masks::{masks, section_masks};
use super::observe::Observations;
use super::reference::Reference;
use super::search::{Bars, Chosen, Judged, Refused, chi_squared, nearest, plausible, refit, rivals, search};
use super::sensitivity::sensitivities;
use super::settings::Settings;
use super::settle::{ROUNDS, Settled, Weighed, polish};
use super::stability::{Stability, stability};
use super::suspects::{Suspect, suspect};
use super::whiten::{Covariance, Whitener, dot};
use crate::data::Campaign;
use crate::effects::{Catalogue, Gauss};
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
    pub references: &'a [&'a Campaign],
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
    /// Measured - simulated.
    pub difference: Vec<f64>,
    pub simulated: Vec<f64>,
    pub chosen: Chosen,
    pub refused: Vec<Refused>,
    /// Other candidates in the place of a member: member, fit, how much less evidence.
    pub rivals: Vec<(usize, Fitted, f64)>,
    /// What has most evidence for what the members leave, and is not named.
    pub nearest: Vec<Fitted>,
    /// What no effect of the catalogue moves, where it explains more than the answer.
    pub suspect: Option<Suspect>,
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

/// A size that is a declared tolerance is named from so many standard deviations on: what is declared is an estimate itself.
pub const TOLERANCE_SD: f64 = 3.5;
/// Draws for the threshold.
const DRAWS: usize = 60;
/// Evidence below which no cause is named: real discrepancies are not those of the covariance.
const FLOOR: f64 = 30.0;
/// The same for an operation on the signals, which no such discrepancy enters: half as much, where 10 is called very strong (Kass and
/// Raftery 1995).
const FLOOR_EXACT: f64 = 15.0;
/// A candidate is simulated at all its sizes from this share of the best evidence on, and from this evidence on.
pub const NEAR: f64 = 0.5;
pub const WORTH: f64 = 10.0;

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
    let mut reference = Reference::default();
    for campaign in inputs.references {
        let sections = crate::simulate::sections(campaign, problems)?;
        reference.learn(&Observations::read(campaign, sections, inputs.catalogue, settings, &declared, &unit, problems)?, settings);
    }
    reference.take_off(&seen, settings, &mut difference);
    let settings = &reference.narrowed(settings);
    let mut runs = Runs::default();
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
    // What was learnt from a reference has that in it already.
    for sensitivity in sensitivities.iter().filter(|sensitivity| sensitivity.expected != 0.0 && inputs.references.is_empty()) {
        difference.iter_mut().zip(&sensitivity.column).for_each(|(difference, column)| *difference -= sensitivity.expected * column);
    }
    let workshop = Workshop {
        seen: &seen,
        catalogue: inputs.catalogue,
        bench: bench.as_ref(),
        base,
        simulated: simulated.clone(),
        neutral: &value,
        trying: inputs.trying,
    };
    let mut candidates = workshop.candidates(&mut runs);
    (inputs.trying)("weighing");
    let whole = covariance(&seen, settings, &simulated, &sensitivities, &declared, true);
    let tolerated = covariance(&seen, settings, &simulated, &sensitivities, &declared, false);
    let whitener = whole.whitener();
    let mut masks = masks(&seen, settings);
    let z = whitener.apply(&difference);
    let strata = strata(&seen, settings);
    let families = families(&seen, &strata);
    let far = |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted);
    let mut refused = Vec::new();
    let mut chosen;
    let mut chance = None;
    let mut known = Known::new();
    let mut reconsidered: Vec<usize> = Vec::new();
    // Until no candidate that matters has sizes left to be simulated.
    loop {
        let fitter = Fitter::knowing(&whitener, &candidates, masks.clone(), std::mem::take(&mut known));
        let bars = bars(*chance.get_or_insert_with(|| limit(&fitter, z.len(), inputs.seed)));
        refused.clear();
        let guard = |fit: &Fitted, chosen: &Chosen| guard((&whole, &seen), &families, &fitter, &difference, chosen, fit);
        let found = search(&fitter, &z, &bars, &far, &guard, &mut refused);
        let wanted = promising(&fitter, &z, &found);
        let more = if wanted.is_empty() { section_masks(&fitter, &z, &found, &seen) } else { Vec::new() };
        known = fitter.whitened;
        if wanted.is_empty() && more.is_empty() {
            // Nor may a veto: what was refused is looked at again with the size that was found.
            let again: Vec<Fitted> = refused
                .iter()
                .map(|refused| refused.fitted.clone())
                .filter(|fit| fit.evidence >= NEAR * found.evidence() && !reconsidered.contains(&fit.candidate))
                .collect();
            reconsidered.extend(again.iter().map(|fit| fit.candidate));
            if !polish(&workshop, &mut candidates, &again, &mut runs) {
                chosen = found;
                break;
            }
        }
        masks.extend(more);
        wanted.into_iter().for_each(|(at, size)| workshop.refine(&mut candidates[at], size, &mut runs));
        (inputs.trying)("weighing");
    }
    // Nothing may rest on interpolation: the members are fitted again with the sizes that were found, and one that was above the bar
    // by interpolation alone goes.
    for _ in 0..ROUNDS {
        if !polish(&workshop, &mut candidates, &chosen.members, &mut runs) {
            break;
        }
        let fitter = Fitter::knowing(&whitener, &candidates, masks.clone(), known);
        refit(&fitter, &z, &mut chosen, 6);
        known = fitter.whitened;
    }
    let fitter = Fitter::knowing(&whitener, &candidates, masks.clone(), known);
    let bars = bars(chance.unwrap_or(FLOOR));
    let fault = |member: &Fitted, count: usize| {
        if member.evidence < bars.least(&fitter.candidates[member.candidate], count) {
            return Some("simulated at the size that was found, it has too little evidence");
        }
        (!plausible(&fitter.candidates[member.candidate], member.size))
            .then_some("beside the others it asks for a size that is not plausible")
    };
    let first_fault = |members: &[Fitted]| {
        let count = members.len();
        members.iter().enumerate().find_map(|(at, member)| Some((at, fault(member, count)?)))
    };
    while let Some((at, reason)) = first_fault(&chosen.members) {
        let fitted = chosen.members.remove(at);
        refused.push(Refused { fitted, reason: reason.into() });
        refit(&fitter, &z, &mut chosen, 6);
    }
    let known = fitter.whitened;
    let lack_before = lack_of_fit(&whole, &seen, &difference);
    let first = Weighed { covariance: whole.clone(), whitener: whitener.clone(), z, chosen };
    let again = Settled {
        workshop: &workshop,
        settings,
        columns: &columns,
        value: &value,
        declared: &declared,
        difference: &difference,
        far: &far,
    };
    let (beside, settled) = again.answer((&mut candidates, &masks), first, &lack_before, &bars, &mut refused, &mut runs);
    let Weighed { covariance: settled, whitener: weighing, z, mut chosen } = settled;
    let fitter = Fitter::of(&weighing, &candidates, masks.clone(), &chosen.members);
    refit(&fitter, &z, &mut chosen, 6);
    let lack_after = drop_what_harms(&fitter, (&beside, &seen), (&difference, &z), &mut chosen, &mut refused, &lack_before);
    drop(fitter);
    let base_z = whitener.apply(&difference);
    let suspect = suspect(&workshop, settings, (&whitener, &base_z), (&candidates, &masks, &chosen), &mut runs);
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
        simulated,
        chosen,
        refused,
        rivals: Vec::new(),
        nearest: Vec::new(),
        suspect,
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

/// Bars from what chance reaches.
fn bars(chance: f64) -> Bars {
    let first = chance.max(FLOOR);
    Bars { first, exact: chance.max(FLOOR_EXACT), next: 1.25 * first, confined: 15.0, tolerance_sd: TOLERANCE_SD, share: 0.12, most: 3 }
}

impl Found {
    /// Without a member, the others fitted again.
    pub fn refuse(&mut self, at: usize, reason: String, seed: u64) {
        if at == 0 {
            self.suspect = None;
        }
        self.refused.push(Refused { fitted: self.chosen.members.remove(at), reason });
        self.fit_again();
        if unexplained(&self.lack_before, &self.lack_after).1 {
            self.beside = self.covariance.clone();
            self.settled = self.covariance.clone();
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
        refit(&fitter, &z, &mut first, 6);
        self.rivals = rivals(&fitter, &z, &first);
        self.nearest = nearest(&fitter, &first, &self.refused);
        let (own, sized) = (self.weighing.apply(&self.difference), &self.chosen);
        let sizes = Fitter::of(&self.weighing, &self.candidates, self.masks.clone(), &sized.members);
        self.stability = stability((&fitter, &z, &first), (&sizes, &own, sized), &self.refused, &self.strata, seed);
        for (member, first) in self.chosen.members.iter_mut().zip(first.members) {
            (member.fall, member.evidence) = (first.fall, first.evidence);
        }
    }

    fn fit_again(&mut self) {
        self.chosen.members = super::shrink::trained(self, &[]);
        self.chosen.rest =
            self.chosen.members.iter().fold(self.weighing.apply(&self.difference), |rest, member| less(&rest, &member.whitened));
        self.lack_after = lack_after(&self.beside, &self.seen, (&self.candidates, &self.masks), &self.difference, &self.chosen);
    }
}

/// How many declared standard deviations a size is from neutral; infinitely many for an effect that is no tolerance.
#[must_use]
pub fn deviations(candidate: &Candidate, size: f64, settings: &Settings, declared: &Declared) -> f64 {
    let tolerance = candidate.tolerance.as_ref().and_then(|name| settings.tolerances.iter().find(|one| one.name == *name));
    let (Some(tolerance), Some(neutral)) = (tolerance, candidate.neutral()) else { return f64::INFINITY };
    let sd = declared.get(&tolerance.name).unwrap_or(tolerance.default);
    // What is scaled is declared as a share of what the vehicle file has.
    let scaled = tolerance.scales.contains(&candidate.size) && neutral != 0.0;
    let sd = if scaled { sd * neutral.abs() } else { sd };
    if sd > 0.0 { (size - neutral).abs() / sd } else { f64::INFINITY }
}

/// More evidence than the best candidate reaches by chance in any draw from the covariance.
fn limit(fitter: &Fitter<'_>, features: usize, seed: u64) -> f64 {
    use rayon::prelude::*;
    let mut most: Vec<f64> = (0..DRAWS)
        .into_par_iter()
        .map(|draw| {
            let mut random = Gauss::new(seed ^ (draw as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
            let z: Vec<f64> = (0..features).map(|_| random.next()).collect();
            fitter.most(&z)
        })
        .collect();
    most.sort_by(f64::total_cmp);
    most.last().copied().unwrap_or(0.0) + 3.0
}

/// Refuses a member that views contradict, or that a single section carries.
fn guard(
    (covariance, seen): (&Covariance, &Observations),
    families: &[Vec<View>],
    fitter: &Fitter<'_>,
    difference: &[f64],
    chosen: &Chosen,
    fit: &Fitted,
) -> Judged {
    let rest = left(fitter.candidates, &fitter.masks, difference, chosen);
    let fitted = (&fitter.candidates[fit.candidate], &fitter.masks[fit.mask], fit);
    let mut judged = Judged::Sound;
    for family in families {
        match contradiction(covariance, family, fitted, &rest) {
            Judged::Sound => {}
            Judged::Doubtful => judged = Judged::Doubtful,
            refused @ Judged::Refused(_) => return refused,
        }
    }
    let change = fit.change(fitter.candidates, &fitter.masks);
    carried(covariance, &fitter.masks[fit.mask], &change, &rest).map_or(judged, |(at, share)| {
        let section = seen.sections[at].section.name();
        Judged::Refused(format!("without section {section} only {:.0} % of the evidence is left", 100.0 * share))
    })
}

/// Candidates that are worth their other sizes, and towards which: those within reach of the best for the whole difference, for what a first set of
/// causes leaves, or for what it leaves without one of them; and the members of that set.
fn promising(fitter: &Fitter<'_>, z: &[f64], chosen: &Chosen) -> Vec<(usize, f64)> {
    let pending = |fit: &&Fitted| fitter.candidates[fit.candidate].pending_towards(fit.size);
    let towards = |fit: &Fitted| (fit.candidate, fit.size);
    let mut found: Vec<(usize, f64)> = chosen.members.iter().filter(pending).map(towards).collect();
    let without = |member: &Fitted| chosen.rest.iter().zip(&member.whitened).map(|(rest, own)| rest + own).collect();
    let mut rests: Vec<Vec<f64>> = vec![z.to_vec(), chosen.rest.clone()];
    if chosen.members.len() > 1 {
        rests.extend(chosen.members.iter().map(without));
    }
    for rest in rests {
        let fits = fitter.all(&rest);
        let best = fits.iter().map(|fit| fit.evidence).fold(0.0, f64::max);
        let near = |fit: &&Fitted| fit.evidence >= (NEAR * best).max(WORTH) && pending(fit);
        found.extend(fits.iter().filter(near).map(towards));
    }
    // One after the other in the order of the catalogue; a second one on the same side finds nothing left.
    found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    found
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
    let before = found.weighing.apply(&found.difference);
    let n = before.len().max(1) as f64;
    (chi_squared(&before) / n, chi_squared(&found.chosen.rest) / n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::candidates::Node;
    use crate::diagnose::settings::Tolerance;

    /// 0.7 times 1.2 is 0.14 off: 4 standard deviations of 5 % of 0.7 where the tolerance scales the parameter, 2.8 of 0.05 else.
    #[test]
    fn what_is_scaled_is_declared_as_a_share_of_what_the_vehicle_has() {
        let deviations_of = |scales: &[&str], neutral: f64| {
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
                shared: true,
                suspects: false,
            };
            let settings = Settings { tolerances: vec![tolerance], ..Settings::default() };
            let nodes = vec![Node { size: neutral, change: Vec::new() }, Node { size: 2.0, change: vec![1.0] }];
            let candidate = Candidate { tolerance: Some("declared".into()), ..Candidate::path("effect", nodes) };
            deviations(&candidate, neutral + 0.14, &settings, &Declared::default())
        };
        assert!((deviations_of(&["size"], 0.7) - 4.0).abs() < 1e-9);
        assert!((deviations_of(&["another"], 0.7) - 2.8).abs() < 1e-9);
        // A share of nothing would be infinitely far: it is taken as it stands.
        assert!((deviations_of(&["size"], 0.0) - 2.8).abs() < 1e-9);
    }
}
