//! The effects of a domain, with units and ranges from the records.

use serde::Serialize;

use super::allowances::Allowance;
use super::records::Roles;
use super::scales::{Of, Scales};
use super::windows::{Cut, two_digits};
use crate::init::protocol::identifier;
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::units::Unit;
use crate::yaml::{self, Entries, Reader, fields};

const EFFECTS: &str = include_str!("../../templates/new/effects.yaml");
/// Trials of a diagnosis as shares of the way from the neutral value to an end of the range: five
/// towards one end, three towards each of two. Small ones are close, since effects change features
/// about in proportion.
const ONE_SIDED: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
const TWO_SIDED: [f64; 3] = [0.1, 0.3, 0.8];
/// A clip at this many times the largest value changes nothing.
const ABOVE_PEAK: f64 = 1.05;

fields! {
    /// An effect that is offered, as `templates/new/effects.yaml` has it.
    struct Listed: "an effect" {
        "title" title: String,
        "means" means: String,
        "domains" domains: Vec<String>,
        /// What its parameter multiplies.
        "of" of: String = String::new(),
        "operator" operator: Option<String>,
        "parameter" parameter: String = String::new(),
        "neutral" neutral: f64 = 0.0,
        "range" range: Vec<f64>,
        "default" default: f64,
        "vanishes" vanishes: Option<String>,
        "settled by" settled_by: String,
        "term" term: String = String::new(),
    }
}

/// An effect of the catalogue, as its template prints it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Entry {
    pub name: String,
    pub title: String,
    pub means: String,
    pub acts_on: &'static str,
    pub settled_by: String,
    pub operator: Option<String>,
    /// The group of an operator.
    pub group: String,
    pub parameter: String,
    pub unit: String,
    pub neutral: String,
    pub default: String,
    pub range: String,
    pub trials: String,
    pub measured_in: String,
    pub vanishes: bool,
    /// The term of the model, for the stub.
    pub term: String,
}

/// Effects of a domain. Those of the machine need a force and a motion.
///
/// # Errors
/// `internal`: the list of effects cannot be read.
pub fn entries(
    domain: &str,
    all: &[Scales],
    roles: &Roles,
    sizes: &[(Allowance, Unit)],
    cut: &Cut,
) -> Result<Vec<Entry>, Problem> {
    let wrong = |says: &str| Problem::error("internal", format!("the list of effects: {says}"));
    let mut problems = Problems::default();
    let tree = yaml::load(&Source::new("effects.yaml", EFFECTS), &mut problems)
        .ok_or_else(|| wrong("no YAML"))?;
    let mut reader = Reader { with: (), problems: &mut problems };
    let listed: Option<Entries<Listed>> = reader.file(&tree);
    if let Some(problem) = problems.0.into_iter().next() {
        return Err(problem);
    }
    let mut found = Vec::new();
    for (key, effect) in listed.map(|listed| listed.0).unwrap_or_default() {
        if !effect.domains.iter().any(|known| known == domain) {
            continue;
        }
        let (&[low, high], default) = (effect.range.as_slice(), effect.default) else {
            return Err(wrong("an effect without range"));
        };
        let entry = Entry {
            name: key.text.clone(),
            title: effect.title,
            means: effect.means.clone(),
            acts_on: "vehicle",
            settled_by: effect.settled_by,
            parameter: key.text.clone(),
            unit: "-".into(),
            neutral: "0".into(),
            term: effect.term,
            ..Entry::default()
        };
        let sized = |entry: Entry, neutral: f64, scale: f64| {
            sized(entry, (low, high), neutral, default, scale)
        };
        let Some(operator) = effect.operator else {
            let of = Of::named(&effect.of).ok_or_else(|| wrong("an unknown `of`"))?;
            for scales in all {
                let (unit, scale) = of.of(scales);
                if !(scale.is_finite() && scale > 0.0) {
                    continue;
                }
                let name = format!("{}{}", key.text, scales.suffix);
                let title = if scales.suffix.is_empty() {
                    entry.title.clone()
                } else {
                    format!("{} of {}", entry.title, scales.channel)
                };
                let term = entry.term.replacen(&key.text, &name, 1);
                let entry = Entry {
                    parameter: name.clone(),
                    name,
                    title,
                    term,
                    measured_in: effect.means.clone(),
                    unit,
                    ..entry.clone()
                };
                found.push(sized(entry, 0.0, scale));
            }
            continue;
        };
        let entry = Entry {
            acts_on: "measuring chain",
            operator: Some(operator.clone()),
            parameter: effect.parameter,
            ..entry
        };
        let neutral = effect.neutral;
        match effect.of.as_str() {
            "" => found.push(sized(
                Entry { group: "all_channels".into(), measured_in: "factor".into(), ..entry },
                neutral,
                1.0,
            )),
            "axis" => {
                let unit = if cut.over_distance { "m" } else { "s" };
                let (group, measured_in) =
                    ("all_channels".to_string(), "recorded minus true position".to_string());
                let entry = Entry { unit: unit.into(), group, measured_in, ..entry };
                found.push(sized(entry, neutral, cut.furthest));
            }
            _ => {
                for (channel, (allowance, unit)) in roles.outputs.iter().zip(sizes) {
                    let group = identifier(channel);
                    let several = roles.outputs.len() > 1;
                    let name = if several {
                        format!("{}_{group}", entry.name)
                    } else {
                        entry.name.clone()
                    };
                    let title = if several {
                        format!("{} ({channel})", entry.title)
                    } else {
                        entry.title.clone()
                    };
                    let measured_in = format!("in {unit}");
                    let of_channel = Entry { name, title, group, measured_in, ..entry.clone() };
                    let clip = operator == "clip";
                    let bound = ABOVE_PEAK * allowance.peak;
                    found.push(if clip {
                        clipped(of_channel, low * allowance.rms, bound)
                    } else {
                        sized(of_channel, neutral, allowance.rms)
                    });
                }
            }
        }
    }
    Ok(found)
}

/// A bound: neutral above every value.
fn clipped(entry: Entry, low: f64, bound: f64) -> Entry {
    let (low, bound) = (two_digits(low.min(0.3 * bound)), up(bound));
    let trials: Vec<f64> =
        ONE_SIDED.iter().rev().map(|share| two_digits(bound - share * (bound - low))).collect();
    let trials: Vec<f64> =
        trials.into_iter().filter(|trial| *trial > low && *trial < bound).collect();
    let default = trials.get(trials.len() / 2).copied().unwrap_or(low);
    Entry {
        neutral: bound.to_string(),
        default: default.to_string(),
        range: listed(&[low, bound]),
        trials: listed(&trials),
        ..entry
    }
}

/// Range, default and trials in the unit of the parameter.
fn sized(entry: Entry, (low, high): (f64, f64), neutral: f64, default: f64, scale: f64) -> Entry {
    let (low, high, default) =
        (two_digits(low * scale), two_digits(high * scale), two_digits(default * scale));
    let towards = |end: f64, share: &f64| two_digits(neutral + share * (end - neutral));
    let mut trials: Vec<f64> = match (low < neutral, high > neutral) {
        (true, true) => {
            TWO_SIDED.iter().flat_map(|share| [towards(low, share), towards(high, share)]).collect()
        }
        (true, false) => ONE_SIDED.iter().map(|share| towards(low, share)).collect(),
        _ => ONE_SIDED.iter().map(|share| towards(high, share)).collect(),
    };
    trials.sort_by(f64::total_cmp);
    trials.dedup();
    let default = default.clamp(low, high);
    Entry {
        neutral: neutral.to_string(),
        default: default.to_string(),
        range: listed(&[low, high]),
        trials: listed(&trials),
        ..entry
    }
}

fn listed(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
}

/// The next number of two digits that is not smaller.
fn up(value: f64) -> f64 {
    let near = two_digits(value);
    if near >= value {
        near
    } else {
        two_digits(near + 10f64.powf(value.abs().log10().floor() - 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry() -> Entry {
        Entry { acts_on: "vehicle", ..Entry::default() }
    }

    #[test]
    fn trials_are_spread_over_the_range() {
        let one = sized(entry(), (0.0, 1.0), 0.0, 0.1, 20.0);
        assert_eq!(
            (one.range.as_str(), one.trials.as_str(), one.default.as_str()),
            ("[0, 20]", "[1, 2, 4, 8, 16]", "2")
        );
        let two = sized(entry(), (0.5, 1.6), 1.0, 0.8, 1.0);
        assert_eq!(
            (two.range.as_str(), two.trials.as_str()),
            ("[0.5, 1.6]", "[0.6, 0.85, 0.95, 1.1, 1.2, 1.5]")
        );
        let clip = clipped(entry(), 3.0, 10.5);
        assert_eq!((clip.neutral.as_str(), clip.range.as_str()), ("11", "[3, 11]"));
        assert!(
            (up(10.01) - 11.0).abs() < 1e-12
                && (up(0.0101) - 0.011).abs() < 1e-12
                && (up(20.0) - 20.0).abs() < 1e-12
        );
    }
}
