//! The effects of a domain, with units and ranges from the records.

use serde::Serialize;

use super::{
    allowances::Allowance,
    records::Roles,
    scales::{Scales, scale_of},
    windows::{Cut, two_digits},
};
use crate::init::protocol::identifier;
use crate::problem::{Problem, Problems, problem};
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
    let wrong = |says: &str| problem!("internal", "the list of effects: {says}");
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
        let &[low, high] = effect.range.as_slice() else {
            return Err(wrong("an effect without range"));
        };
        let entry = Entry {
            name: key.text.clone(),
            title: effect.title,
            means: effect.means,
            acts_on: "vehicle",
            settled_by: effect.settled_by,
            parameter: key.text,
            unit: "-".into(),
            term: effect.term,
            ..Entry::default()
        };
        let (range, neutral, default) = ((low, high), effect.neutral, effect.default);
        let Some(operator) = effect.operator else {
            for scales in all {
                let scale = scale_of(&effect.of, scales);
                let (unit, scale) = scale.ok_or_else(|| wrong("an unknown `of`"))?;
                if scale.is_finite() && scale > 0.0 {
                    let entry = of_machine(&entry, scales, unit);
                    found.push(sized(entry, range, 0.0, default, scale));
                }
            }
            continue;
        };
        let entry = Entry {
            acts_on: "measuring chain",
            operator: Some(operator.clone()),
            group: "all_channels".into(),
            measured_in: "factor".into(),
            parameter: effect.parameter,
            ..entry
        };
        match effect.of.as_str() {
            "" => found.push(sized(entry, range, neutral, default, 1.0)),
            "axis" => {
                let unit = if cut.over_distance { "m" } else { "s" }.into();
                let measured_in = "recorded minus true position".into();
                let entry = Entry { unit, measured_in, ..entry };
                found.push(sized(entry, range, neutral, default, cut.furthest));
            }
            _ => {
                let several = roles.outputs.len() > 1;
                for (channel, (Allowance { rms, peak, .. }, unit)) in
                    roles.outputs.iter().zip(sizes)
                {
                    let entry = of_channel(&entry, channel, unit, several);
                    found.push(match operator.as_str() {
                        "clip" => clipped(entry, low * rms, ABOVE_PEAK * peak),
                        _ => sized(entry, range, neutral, default, *rms),
                    });
                }
            }
        }
    }
    Ok(found)
}

/// An effect of the machine on a force.
fn of_machine(entry: &Entry, scales: &Scales, unit: String) -> Entry {
    let name = format!("{}{}", entry.name, scales.suffix);
    let title = if scales.suffix.is_empty() {
        entry.title.clone()
    } else {
        format!("{} of {}", entry.title, scales.channel)
    };
    Entry {
        term: entry.term.replacen(&entry.name, &name, 1),
        parameter: name.clone(),
        name,
        title,
        measured_in: entry.means.clone(),
        unit,
        ..entry.clone()
    }
}

/// An effect of the measuring chain on a channel.
fn of_channel(entry: &Entry, channel: &str, unit: &Unit, several: bool) -> Entry {
    let group = identifier(channel);
    let mut entry = entry.clone();
    if several {
        entry.name += &format!("_{group}");
        entry.title += &format!(" ({channel})");
    }
    Entry { group, measured_in: format!("in {unit}"), ..entry }
}

/// A bound: neutral above every value.
fn clipped(entry: Entry, low: f64, bound: f64) -> Entry {
    let (low, bound) = (two_digits(low.min(0.3 * bound)), up(bound));
    let mut trials: Vec<f64> =
        ONE_SIDED.iter().rev().map(|share| two_digits(bound - share * (bound - low))).collect();
    trials.retain(|trial| *trial > low && *trial < bound);
    let default = trials.get(trials.len() / 2).copied().unwrap_or(low);
    ranged(entry, (low, bound), bound, default, &trials)
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
    ranged(entry, (low, high), neutral, default.clamp(low, high), &trials)
}

fn ranged(
    entry: Entry,
    (low, high): (f64, f64),
    neutral: f64,
    default: f64,
    trials: &[f64],
) -> Entry {
    let (neutral, default) = (neutral.to_string(), default.to_string());
    Entry { neutral, default, range: listed(&[low, high]), trials: listed(trials), ..entry }
}

/// A list as YAML has it.
pub fn listed(numbers: &[f64]) -> String {
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
