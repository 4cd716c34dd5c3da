//! Alternative causes, their probabilities, and recommended measurements where the data do not
//! discriminate.

use super::apart::{Apart, apart};
use super::causes::{cause, title};
use super::verdict::Verdict;
use crate::diagnose::fit::{fitter::Fitted, set::plausible};
use crate::diagnose::inputs::Inputs;
use crate::diagnose::levels::{
    rivals::{NEAREST, OUTSIDE, OUTSIDE_SUSPECTED, OUTSIDE_UNEXPLAINED, TEMPERATURE, TOLD_APART},
    search::TOLERANCE_SD,
};
use crate::diagnose::run::{Found, deviations};
use crate::effects::Effect;
use crate::result::{Statement, diagnosis::Cause};

/// Sets in which another effect replaces one member, and whether the data discriminate them from
/// the answer.
pub fn ambiguity(inputs: &Inputs<'_>, found: &Found) -> Vec<Cause> {
    let best = found.answer.chosen.evidence;
    let mut causes: Vec<Cause> = Vec::new();
    let own = |at: usize| &found.fitted.candidates[found.answer.chosen.members[at].candidate];
    for (at, fit, fall) in &found.answer.rivals {
        let of = &found.fitted.candidates[fit.candidate];
        // The same effect on another channel is another cause if the data do not show which channel
        // it is.
        let elsewhere = of.effect == own(*at).effect
            && of.channels != own(*at).channels
            && !of.channels.is_empty()
            && *fall <= NEAREST;
        let named = found
            .answer
            .chosen
            .members
            .iter()
            .any(|member| found.fitted.candidates[member.candidate].effect == of.effect);
        if named && !elsewhere {
            continue;
        }
        if causes.len() >= 5
            || causes
                .iter()
                .any(|cause| cause.effects.iter().any(|effect| effect.name == of.effect))
        {
            continue;
        }
        // Effects refused by a guard are reported separately.
        if found
            .answer
            .refused
            .iter()
            .any(|refused| found.fitted.candidates[refused.fitted.candidate].is_like(of))
            || !plausible(of, fit.size)
        {
            continue;
        }
        // A size within a declared tolerance is part of the covariance already.
        if deviations(of, fit.size, inputs.settings, &found.declared) < TOLERANCE_SD {
            continue;
        }
        let near = *fall <= NEAREST && fit.evidence > found.rates.bars.least(of)
            || found
                .answer
                .stability
                .get(*at)
                .is_some_and(|stability| stability.as_well(fit.candidate));
        let drawn = found
            .answer
            .stability
            .get(*at)
            .map_or(0.0, |stability| stability.instead_of(fit.candidate));
        let mut members = found.answer.chosen.members.clone();
        members[*at] = fit.clone();
        let mut cause = cause(inputs, found, &members, causes.len() + 2);
        (cause.in_ambiguity_set, cause.probability) = (near, drawn);
        cause.evidence = best - fall;
        causes.push(cause);
    }
    causes
}

/// Sets the probability of each cause. `failing` is the smallest share of resamples in which a
/// member has the most evidence, where that share is too small. The probabilities are then these
/// shares, which the causes contain as `probability` on entry.
pub fn probabilities(
    causes: &mut [Cause],
    verdict: Verdict,
    suspected: bool,
    failing: Option<f64>,
) {
    // A rival may have more evidence than an answer that was selected with the simulated
    // tolerances: both are then equally probable.
    let best = causes.first().map_or(0.0, |answer| answer.evidence);
    let by_evidence =
        |cause: &Cause| ((cause.evidence - best).min(0.0) / (2.0 * TEMPERATURE)).exp();
    let weights: Vec<f64> = match failing {
        Some(first) => causes
            .iter()
            .map(|cause| if cause.rank == 1 { first } else { cause.probability })
            .collect(),
        None => causes.iter().map(by_evidence).collect(),
    };
    // A cause outside the catalogue is always possible, and more probable where a residual remains.
    let outside = match verdict {
        Verdict::Unexplained => OUTSIDE_UNEXPLAINED,
        _ if suspected => OUTSIDE_SUSPECTED,
        _ => OUTSIDE,
    };
    let all = weights.iter().sum::<f64>() + outside;
    causes.iter_mut().zip(weights).for_each(|(cause, weight)| cause.probability = weight / all);
    if verdict == Verdict::Unexplained {
        causes.iter_mut().for_each(|cause| cause.in_ambiguity_set = false);
    }
}

pub fn discriminating(
    inputs: &Inputs<'_>,
    found: &Found,
    causes: &[Cause],
    verdict: Verdict,
) -> Option<String> {
    if verdict != Verdict::Ambiguous {
        return None;
    }
    let effects =
        causes.iter().filter(|cause| cause.in_ambiguity_set).flat_map(|cause| &cause.effects);
    let mut measurements: Vec<String> = Vec::new();
    for effect in effects {
        let known: Option<&Effect> = inputs.catalogue.effect(&effect.name);
        if let Some(settled) = known.and_then(|known| known.settled_by.clone())
            && !measurements.contains(&settled)
        {
            measurements.push(settled);
        }
    }
    measurements.extend(
        found.answer.further.suspect().map(|free| format!("a measurement of `{}`", free.parameter)),
    );
    measurements.extend(more_sections(inputs, found, causes));
    (!measurements.is_empty()).then(|| measurements.join("; or "))
}

/// A statement where two possible causes are far apart but neither is preferred: the data would
/// discriminate them if one were the whole cause.
pub fn neither(
    inputs: &Inputs<'_>,
    found: &Found,
    causes: &[Cause],
    verdict: Verdict,
) -> Option<Statement> {
    let (names, apart) = nearest(found, causes)
        .filter(|(_, apart)| verdict == Verdict::Ambiguous && apart.now >= TOLD_APART)?;
    let [one, other] = names.map(|name| title(inputs, name).to_owned());
    Some(Statement::FurtherEffect { one, other, deviations: apart.now })
}

/// A member of the answer and the possible cause closest to it, by name.
fn nearest<'a>(found: &'a Found, causes: &[Cause]) -> Option<([&'a str; 2], Apart)> {
    let near = |name: &str| {
        causes.iter().skip(1).any(|cause| {
            cause.in_ambiguity_set && cause.effects.iter().any(|effect| effect.name == name)
        })
    };
    let effect = |fit: &Fitted| found.fitted.candidates[fit.candidate].effect.as_str();
    let differs = |at: usize, fit: &Fitted| {
        near(effect(fit)) && effect(fit) != effect(&found.answer.chosen.members[at])
    };
    let (at, rival, _) = found.answer.rivals.iter().find(|(at, fit, _)| differs(*at, fit))?;
    let member = &found.answer.chosen.members[*at];
    Some(([effect(member), effect(rival)], apart(found, member, rival)?))
}

/// Further sections of the kind that best discriminates the answer from its closest rival, unless
/// the data discriminate them already.
fn more_sections(inputs: &Inputs<'_>, found: &Found, causes: &[Cause]) -> Option<String> {
    let (_, apart) = nearest(found, causes).filter(|(_, apart)| apart.now < TOLD_APART)?;
    let sections: Vec<&str> =
        apart.sections.iter().map(|at| found.seen.sections[*at].section.name()).collect();
    let stratum = inputs.settings.stratum.as_deref();
    let kind = apart
        .sections
        .first()
        .zip(stratum)
        .and_then(|(at, column)| found.seen.sections[*at].section.says(column));
    Some(format!(
        "the same number of additional sections like {} ({}); the two closest causes would then differ by {3:.1} standard deviations instead of {2:.1}",
        sections.join(", "),
        kind.unwrap_or_else(|| "the most effective kind".into()),
        apart.now,
        apart.then
    ))
}
