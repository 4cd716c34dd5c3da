//! The diagnosis from end to end: observe, linearise, iterate, check.

use std::sync::Arc;

use rayon::prelude::*;

use super::inputs::{Inputs, value_of};
use super::settings::Settings;
use crate::diagnose::checks::{
    channels::{Lack, lack_of_fit},
    further::{Further, free, used},
    heterogeneity::{Heterogeneity, heterogeneity, views},
    stability::{Stability, stability},
};
use crate::diagnose::fit::{
    fitter::{Fitted, Fitter},
    set::{Bars, Chosen, Refused, chi_squared},
};
use crate::diagnose::iterate::{
    Iterate, Iterated,
    point::{Linearisation, Linearise},
};
use crate::diagnose::levels::search::TRIED;
use crate::diagnose::linearise::{
    candidate::Candidate,
    covariance::{Sensitivity, covariance},
    declared::Declared,
    ground::{Ground, bench},
    mask::{Mask, masks},
    whiten::{Covariance, Whitener, dot, less},
    workshop::Workshop,
};
use crate::diagnose::observe::{
    bench::Runs, observations::Observations, observed::Observed, strata::strata,
};
use crate::diagnose::search::{Search, without};
use crate::effects::{Action, Applied, Signals};
use crate::model::parameter;
use crate::problem::{Problem, Problems};
use crate::result::diagnosis::{Calibration, UsedTolerance};
use crate::simulate::{Plan, Section, Task, incremented};

/// Numerical results of a diagnosis.
#[derive(Debug)]
pub struct Found {
    pub seen: Observations,
    pub strata: Vec<Vec<usize>>,
    pub declared: Declared,
    pub ground: Ground,
    pub masks: Vec<Mask>,
    /// Covariance of noise and tolerances alone.
    pub tolerated: Covariance,
    /// The linearisation without effects.
    pub alone: Arc<Linearisation>,
    /// The linearisation at the answer.
    pub fitted: Arc<Linearisation>,
    pub answer: Answer,
    pub rates: Rates,
    pub runs: Runs,
}

/// The named effects, and what speaks for and against others.
#[derive(Debug)]
pub struct Answer {
    pub chosen: Chosen,
    /// Whether names and sizes stood still in the last round.
    pub still: bool,
    pub refused: Vec<Refused>,
    /// Other candidates in place of a member: number of the member, fit, loss of evidence.
    pub rivals: Vec<(usize, Fitted, f64)>,
    /// Candidates with the most evidence beside the answer, nameable or not.
    pub nearest: Vec<Fitted>,
    /// What is left for further candidates.
    pub further: Further,
    /// The deviations of the tolerances that the fit used.
    pub used: Vec<UsedTolerance>,
    pub heterogeneity: Vec<Heterogeneity>,
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
    let settings = inputs.settings;
    let admitted = Declared::read(inputs.campaign, settings, problems);
    if problems.errors() > 0 {
        return None;
    }
    check_tolerated(inputs, problems);
    let declared = |name: &str| admitted.get(name);
    (inputs.trying)("reading records");
    let unit = |channel: &str| inputs.simulator?.unit(channel);
    let (campaign, catalogue) = (inputs.campaign, inputs.catalogue);
    let mut seen =
        Observations::read(campaign, sections, catalogue, settings, &declared, &unit, problems)?;
    let mut runs = Runs::default();
    problems.value(compare_samples(inputs, &mut seen, &mut runs))?;
    let ground = Ground::find(inputs, &seen, &admitted, &mut runs, problems)?;
    let (strata, masks) = (strata(&seen, settings), masks(&seen, settings));
    let far = |candidate: &Candidate, size: f64| deviations(candidate, size, settings, &admitted);
    let (value, bench) = (|key: &str| value_of(campaign, key), bench(inputs, &seen));
    let workshop = Workshop {
        seen: &seen,
        catalogue,
        bench: bench.as_ref(),
        ground: &ground,
        neutral: &value,
        trying: inputs.trying,
    };
    let linearise = Linearise {
        workshop: &workshop,
        settings,
        value: &value,
        declared: &declared,
        masks: &masks,
    };
    let candidates = workshop.candidates(&mut runs);
    let alone = linearise.without_effects(candidates);
    let columns: Vec<Sensitivity> = alone.columns.iter().flatten().cloned().collect();
    let tolerated = covariance(&seen, settings, &ground.simulated, &columns, &declared, None);
    let iterate = Iterate {
        linearise: &linearise,
        far: &far,
        false_name_rate: settings.false_name_rate,
        seed: inputs.seed,
    };
    let Iterated { alone, fitted, chosen, refused, bars, false_name_rate, calibration, still } =
        iterate.run(alone, &mut runs);
    (inputs.trying)("checks");
    let lack_before = lack_of_fit(&alone.covariance, &seen, &alone.difference);
    let fitter = Fitter::new(&fitted.whitener, &fitted.candidates, masks.clone());
    let search = Search::new(&fitter, &fitted.z, &bars, &far);
    let set = chosen.set();
    let members = 0..chosen.members.len();
    let mut rivals: Vec<(usize, Fitted, f64)> = members
        .clone()
        .flat_map(|at| {
            let less = chosen.members[at].evidence;
            let others = search.further(&without(&set, at), &[], TRIED).into_iter();
            others.map(move |fit| (at, less - fit.evidence, fit))
        })
        .map(|(at, less, fit)| (at, fit, less))
        .collect();
    rivals.sort_by(|a, b| a.2.total_cmp(&b.2));
    let stable = |at: usize| stability(&fitter, &fitted.z, &chosen, at, &strata, inputs.seed);
    let nearest = search.further(&set, &[], TRIED);
    let free = free((&alone, &fitted), &masks, &chosen, &bars, &far);
    let answer = Answer {
        rivals,
        further: Further::new(&fitted, &nearest, &free, &far),
        nearest,
        used: used(&fitted, &chosen, &far),
        heterogeneity: heterogeneity(&fitter, &chosen, &views(&seen, settings)),
        stability: members.map(stable).collect(),
        lack_after: lack_before.clone(),
        lack_before,
        chosen,
        still,
        refused,
    };
    let rates = Rates { bars, false_name_rate, calibration };
    let declared = admitted;
    let mut found = Found {
        seen,
        strata,
        declared,
        ground,
        masks,
        tolerated,
        alone,
        fitted,
        answer,
        rates,
        runs,
    };
    if !set.is_empty() {
        found.answer.lack_after = lack_of_fit(&found.wider(), &found.seen, &found.left());
    }
    Some(found)
}

impl Found {
    /// The residual of the answer, not whitened.
    pub fn left(&self) -> Vec<f64> {
        self.answer.chosen.all().fold(self.fitted.difference.clone(), |rest, member| {
            less(&rest, &member.change(&self.fitted.candidates, &self.masks))
        })
    }

    /// The covariance at the answer, plus the error of the responses of the simulated members,
    /// independent between features.
    pub fn wider(&self) -> Covariance {
        let mut wider = self.fitted.covariance.clone();
        let candidates = &self.fitted.candidates;
        let simulated =
            self.answer.chosen.all().filter(|member| !candidates[member.candidate].exact);
        for member in simulated {
            let change = member.change(candidates, &self.masks);
            wider.diagonal.iter_mut().zip(change).for_each(|(variance, change)| {
                *variance += (self.fitted.covariance.response.each * change).powi(2)
            });
        }
        wider
    }

    /// The candidate of a fit, at the answer.
    pub fn candidate(&self, fit: &Fitted) -> &Candidate {
        &self.fitted.candidates[fit.candidate]
    }
}

/// Distance of a size from neutral in declared standard deviations, with the tolerance's further
/// standard deviation. Infinite for an effect that is not a tolerance.
pub fn deviations(
    candidate: &Candidate,
    size: f64,
    settings: &Settings,
    declared: &Declared,
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
    let sd = sd.hypot(tolerance.besides);
    // A scaled parameter is declared by a relative standard deviation: the distance is that of the
    // logarithm.
    let scaled = tolerance.scales.contains(&candidate.size) && neutral != 0.0;
    let away = if scaled { (size / neutral).max(0.0).ln().abs() } else { (size - neutral).abs() };
    if sd > 0.0 { away / sd } else { f64::INFINITY }
}

/// Length of the whitened change, in standard deviations.
pub fn length(whitener: &Whitener, change: &[f64]) -> f64 {
    let z = whitener.apply(change);
    dot(&z, &z).sqrt()
}

/// Chi-squared per feature before and after the effects.
pub fn chi(found: &Found) -> (f64, f64) {
    let of =
        |rest: &[f64]| chi_squared(&found.fitted.whitener.apply(rest)) / rest.len().max(1) as f64;
    (of(&found.alone.difference), of(&found.left()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::Node;
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
            move |size: f64| deviations(&candidate, size, &settings, &Declared::default())
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
