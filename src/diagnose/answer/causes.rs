//! A set of effects as a cause: names, sizes with their intervals, and sections.

use indexmap::IndexMap;
use serde_json::json;

use crate::diagnose::inference::fit::Fitted;
use crate::diagnose::inputs::Inputs;
use crate::diagnose::levels::common::NINETY;
use crate::diagnose::run::{Found, deviations};
use crate::diagnose::selection::stability::Stability;
use crate::diagnose::settings::Settings;
use crate::effects::Action;
use crate::result::diagnosis::{Cause, NamedEffect, Value};
use crate::yaml::Words;

/// A set of effects as a cause.
#[must_use]
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
#[must_use]
pub fn interval(found: &Found, member: &Fitted) -> Option<(f64, f64)> {
    let of = &found.candidates[member.candidate];
    let (low, high) =
        around(found, member, stability_of(found, member).map(|stability| stability.sizes))?;
    let common = NINETY
        * member.common_error(&found.candidates, found.allowed.beside.covariance.response.common);
    let (below, above) = ((member.size - low).hypot(common), (high - member.size).hypot(common));
    Some(((member.size - below).max(of.range.0), (member.size + above).min(of.range.1)))
}

/// Combines the standard error of the fit with the spread of the resampled sizes around the fitted
/// one.
fn around(found: &Found, member: &Fitted, drawn: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let of = &found.candidates[member.candidate];
    if of.discrete || !member.size.is_finite() {
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

/// The member with the least evidence among those whose interval includes the neutral value, or a
/// value within the declared tolerance; with the reason why it is not named. Other sections might
/// then have given the opposite sign, another effect, or no more than the declared deviation.
#[must_use]
pub fn nothing_out_of_the_ordinary(found: &Found, settings: &Settings) -> Option<(usize, String)> {
    let holds = |(at, member): (usize, &Fitted)| {
        let of = &found.candidates[member.candidate];
        let (low, high) =
            around(found, member, stability_of(found, member).map(|stability| stability.judged()))?;
        let nothing = of.neutral()?;
        let nearest = nothing.clamp(low, high);
        let holds = match deviations(of, nearest, settings, &found.declared, true) {
            _ if nearest == nothing => {
                format!("{}, at which the effect has no influence", short(nothing))
            }
            away if away < NINETY => {
                format!("{}, which is {away:.1} declared standard deviations away", short(nearest))
            }
            _ => return None,
        };
        Some((
            at,
            format!(
                "the interval of its size, {} to {}, includes {holds}",
                short(low),
                short(high)
            ),
            member.evidence,
        ))
    };
    let found = found
        .answer
        .chosen
        .members
        .iter()
        .enumerate()
        .filter_map(holds)
        .min_by(|a, b| a.2.total_cmp(&b.2));
    found.map(|(at, says, _)| (at, says))
}

fn named(inputs: &Inputs<'_>, found: &Found, member: &Fitted) -> NamedEffect {
    let of = &found.candidates[member.candidate];
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
        parameters.insert(
            name.clone(),
            Value { value: json!(value), unit: unit(name), assumed: None, low: None, high: None },
        );
    }
    NamedEffect {
        name: of.effect.clone(),
        title: effect.map_or_else(|| of.effect.clone(), |effect| effect.title.clone()),
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
