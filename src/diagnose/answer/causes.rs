//! A set of effects as a cause: names, sizes with their intervals, and sections.

use indexmap::IndexMap;
use serde_json::json;

use crate::diagnose::checks::stability::Stability;
use crate::diagnose::fit::{fitter::Fitted, set::plausible};
use crate::diagnose::inputs::Inputs;
use crate::diagnose::levels::common::NINETY;
use crate::diagnose::linearise::candidate::Candidate;
use crate::diagnose::run::Found;
use crate::effects::Action;
use crate::result::diagnosis::{Cause, NamedEffect, Value};
use crate::yaml::Words;

/// A set of effects as a cause.
pub fn cause(inputs: &Inputs<'_>, found: &Found, members: &[Fitted], rank: usize) -> Cause {
    let effects: Vec<NamedEffect> =
        members.iter().map(|member| named(inputs, found, member)).collect();
    let says = effects.iter().map(in_words).collect::<Vec<_>>().join("; and ");
    Cause {
        rank,
        effects,
        probability: 0.0,
        in_ambiguity_set: true,
        evidence: members.iter().map(|member| member.evidence).sum(),
        says,
    }
}

/// The title of an effect.
pub fn title<'a>(inputs: &'a Inputs<'_>, effect: &'a str) -> &'a str {
    inputs.catalogue.effect(effect).map_or(effect, |effect| &effect.title)
}

fn in_words(effect: &NamedEffect) -> String {
    let values = effect.told().into_iter().map(|told| {
        let (parameter, value) = (&told.parameter, told.value);
        let interval = match (value.low, value.high) {
            (Some(low), Some(high)) => format!(" ({} to {})", short(low), short(high)),
            _ => String::new(),
        };
        let number = value.value.as_f64().map_or_else(|| value.text(), short);
        let unit = if value.unit == "-" { String::new() } else { format!(" {}", value.unit) };
        let assumed =
            value.assumed.map_or_else(String::new, |assumed| format!("{} -> ", short(assumed)));
        format!("{parameter} {assumed}{number}{unit}{interval}{}", told.on())
    });
    format!("{}: {}{}", effect.title, values.collect::<Vec<_>>().join(", "), effect.only_in())
}

/// Formats a value with four significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.digits$}")
}

/// The 90 % interval of a size: uncertainty of the fit, of the interpolation between simulated
/// sizes, of the choice of sections, and of the response of the simulator as a whole. Nothing for
/// an effect without a size.
pub fn interval(found: &Found, member: &Fitted) -> Option<(f64, f64)> {
    let of = &found.fitted.candidates[member.candidate];
    let (low, high) =
        around(found, member, stability_of(found, member).map(|stability| stability.sizes))?;
    let common = NINETY
        * member.common_error(&found.fitted.candidates, found.fitted.covariance.response.common);
    let (below, above) = ((member.size - low).hypot(common), (high - member.size).hypot(common));
    Some(((member.size - below).max(of.range.0), (member.size + above).min(of.range.1)))
}

/// Combines the standard error of the fit with the spread of the resampled sizes around the fitted
/// one.
fn around(found: &Found, member: &Fitted, drawn: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let of = &found.fitted.candidates[member.candidate];
    if of.discrete || !member.size.is_finite() {
        return None;
    }
    if !plausible(of, member.size) {
        return None;
    }
    let error = NINETY * member.error();
    let drawn = drawn.unwrap_or((member.size, member.size));
    let (below, above) = (
        error.hypot((member.size - drawn.0).max(0.0)),
        error.hypot((drawn.1 - member.size).max(0.0)),
    );
    Some(((member.size - below).max(of.range.0), (member.size + above).min(of.range.1)))
}

/// The 90 % interval of a parameter that is tried at a few values: the values at which the answer
/// loses no more than a likelihood ratio of 90 % allows, to the middle between these and the next
/// ones. Nothing for a candidate that is no member of the answer.
fn of_trials(found: &Found, member: &Fitted, name: &str, value: f64) -> Option<(f64, f64)> {
    let own = found.candidate(member);
    let members = &found.answer.chosen.members;
    let at = members.iter().position(|one| one.candidate == member.candidate)?;
    let of = |candidate: &Candidate| {
        let fixed = candidate.fixed.iter().find(|(known, _)| known == name)?;
        (candidate.is_like(own) && candidate.size == own.size).then_some(fixed.1)
    };
    let mut trials: Vec<f64> = found.fitted.candidates.iter().filter_map(of).collect();
    trials.sort_by(f64::total_cmp);
    trials.dedup();
    let is_possible = |trial: &f64| {
        let mut rivals = found.answer.rivals.iter();
        *trial == value
            || rivals.any(|(of_member, fit, loss)| {
                *of_member == at
                    && *loss <= NINETY * NINETY
                    && of(found.candidate(fit)) == Some(*trial)
            })
    };
    let first = trials.iter().position(is_possible)?;
    let last = trials.iter().rposition(is_possible)?;
    let middle = |a: usize, b: usize| 0.5 * (trials[a] + trials[b]);
    let low = if first == 0 { trials[0] } else { middle(first - 1, first) };
    let high = if last + 1 == trials.len() { trials[last] } else { middle(last, last + 1) };
    Some((low, high))
}

fn named(inputs: &Inputs<'_>, found: &Found, member: &Fitted) -> NamedEffect {
    let of = &found.fitted.candidates[member.candidate];
    let effect = inputs.catalogue.effect(&of.effect);
    let mut parameters = IndexMap::new();
    let unit = |name: &str| {
        let known = effect
            .and_then(|effect| effect.parameters.iter().find(|parameter| parameter.name == name));
        known.map_or("-".to_string(), |parameter| parameter.unit.text.clone())
    };
    let interval = interval(found, member);
    let mut push = |name: String, value: serde_json::Value, interval: Option<(f64, f64)>| {
        let unit = of.unit.text.clone();
        let assumed = interval.and(of.neutral()).filter(|neutral| neutral.is_finite());
        parameters.insert(
            name,
            Value {
                value,
                unit,
                assumed,
                low: interval.map(|(low, _)| low),
                high: interval.map(|(_, high)| high),
            },
        );
    };
    if of.effect_is_swap() {
        push(of.size.clone(), json!([of.channels]), None);
    } else if of.size.contains(crate::effects::CHANNEL) {
        for channel in &of.channels {
            push(of.size.replace(crate::effects::CHANNEL, channel), json!(member.size), interval);
        }
    } else {
        push(of.size.clone(), json!(member.size), interval);
        let every = effect.is_some_and(|effect| matches!(&effect.action, Action::Signals(_, all) if all.len() > of.channels.len()));
        if every {
            parameters.insert(
                format!("{}_channels", of.size),
                Value {
                    value: json!(of.channels),
                    unit: "-".into(),
                    assumed: None,
                    low: None,
                    high: None,
                },
            );
        }
    }
    for (name, value) in &of.fixed {
        let interval = of_trials(found, member, name, *value);
        let (low, high) = (interval.map(|of| of.0), interval.map(|of| of.1));
        parameters.insert(
            name.clone(),
            Value { value: json!(value), unit: unit(name), assumed: None, low, high },
        );
    }
    NamedEffect {
        name: of.effect.clone(),
        title: title(inputs, &of.effect).to_owned(),
        parameters,
        channels: of.channels.clone(),
        confined_to: found.masks[member.mask]
            .confined
            .as_ref()
            .map(|(column, values)| confined(column, values)),
        stability: stability_of(found, member).map(|stability| stability.first),
        added_by: match effect.map(|effect| &effect.action) {
            Some(Action::Signals(operator, _)) => {
                format!("an operation on the signals: {}", operator.word())
            }
            Some(Action::Formulas(_)) => "expressions on the signals".into(),
            _ => inputs.simulator.map_or(String::new(), |simulator| {
                format!("increments of the {}", simulator.name())
            }),
        },
    }
}

/// The stability of a member of the answer; a rival has none.
fn stability_of(found: &Found, member: &Fitted) -> Option<Stability> {
    let own = |known: &Fitted| known.candidate == member.candidate && known.mask == member.mask;
    found
        .answer
        .chosen
        .members
        .iter()
        .position(own)
        .and_then(|at| found.answer.stability.get(at).cloned())
}

/// The confinement in the form of the report: `zones` and `sections` are lists, a direction is one
/// word.
fn confined(column: &str, values: &[String]) -> IndexMap<String, serde_json::Value> {
    let numbers: Option<Vec<i64>> = values.iter().map(|value| value.parse().ok()).collect();
    let list = numbers.map_or_else(|| json!(values), |numbers| json!(numbers));
    IndexMap::from([match column {
        "zone" => ("zones".to_string(), list),
        "section" => ("sections".to_string(), list),
        other if values.len() == 1 => (other.to_string(), json!(values[0])),
        other => (other.to_string(), list),
    }])
}
