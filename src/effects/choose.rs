//! Effects as chosen on a command line: `friction=0.5`, `payload.payload.mass=3.5 t`,
//! `sensor_gain=0.8 on Y_3R`, `friction=0.2 in zones 3, 4`.

use super::catalogue::{Action, Catalogue, Effect, Parameter};
use super::operators::Operator;
use super::read::CHANNEL;
use crate::problem::Problem;
use crate::source::{Source, Span};
use crate::units::Unit;
use crate::units::number::{Refused, split};
use crate::yaml::unknown_unit;

/// An effect with its size and sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied {
    pub effect: String,
    /// Values of its parameters in their units; all others are neutral.
    pub values: Vec<(String, f64)>,
    /// The channels of an operator.
    pub channels: Vec<String>,
    pub confined: Option<Confined>,
}

/// The sections to which an effect is confined: those with one of the values in a column of the
/// section table.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Confined {
    /// `zone`, `direction` or `section`.
    pub column: String,
    pub values: Vec<String>,
}

impl Confined {
    /// Whether sections with this value in the column are included.
    #[must_use]
    pub fn has(&self, value: &str) -> bool {
        self.values.iter().any(|one| one == value)
    }
}

impl Applied {
    /// The value of a parameter, if it is not neutral.
    #[must_use]
    pub fn value(&self, parameter: &str) -> Option<f64> {
        self.values.iter().find(|(name, _)| name == parameter).map(|(_, value)| *value)
    }
}

/// Words for values of model parameters.
const WORDS: [(&str, f64); 3] = [("both", 0.0), ("R", 1.0), ("L", -1.0)];
const COLUMNS: [(&str, &str); 6] = [
    ("zone", "zone"),
    ("zones", "zone"),
    ("direction", "direction"),
    ("directions", "direction"),
    ("section", "section"),
    ("sections", "section"),
];

/// Reads effects as written; several parameters of one effect may be given one after the other.
///
/// # Errors
/// All invalid texts: `unknown-effect`, `unknown-parameter` and `unknown-channel` with the nearest
/// name, `range` with the range, `unknown-unit`, `unit-mismatch`, `wrong-kind`.
pub fn choose(catalogue: &Catalogue, texts: &[String]) -> Result<Vec<Applied>, Vec<Problem>> {
    let mut chosen: Vec<Applied> = Vec::new();
    let mut problems = Vec::new();
    for text in texts {
        let source = Source::new("--effect", text.clone());
        match one(catalogue, text, &source) {
            Err(problem) => problems.push(problem),
            Ok(applied) => match chosen.iter_mut().find(|known| {
                known.effect == applied.effect
                    && known.channels == applied.channels
                    && known.confined == applied.confined
            }) {
                // Of several parameters of an effect, each has its own text.
                Some(known) => {
                    match known.values.iter().find(|(name, _)| applied.value(name).is_some()) {
                        Some((name, _)) => {
                            let says = format!(
                                "`{}` of the effect `{}` is given twice",
                                name, applied.effect
                            );
                            problems.push(
                                Problem::error("duplicate-effect", says)
                                    .at(&source.whole())
                                    .help("give one value"),
                            );
                        }
                        None => known.values.extend(applied.values),
                    }
                }
                None => chosen.push(applied),
            },
        }
    }
    if problems.is_empty() { Ok(chosen) } else { Err(problems) }
}

fn one(
    catalogue: &Catalogue,
    text: &str,
    source: &std::sync::Arc<Source>,
) -> Result<Applied, Problem> {
    let place = |part: &str| -> Span {
        let start = part.as_ptr() as usize - text.as_ptr() as usize;
        source.span(start..start + part.len())
    };
    let (rest, confined) = match text.split_once(" in ") {
        Some((rest, within)) => (rest, Some(confinement(within, &place)?)),
        None => (text, None),
    };
    let (rest, on) = match rest.split_once(" on ") {
        Some((rest, on)) => (rest, Some(on)),
        None => (rest, None),
    };
    let (named, value) = match rest.split_once('=') {
        Some((named, value)) => (named.trim(), Some(value.trim())),
        None => (rest.trim(), None),
    };
    let (name, parameter) = match named.split_once('.') {
        Some((name, parameter)) => (name, Some(parameter)),
        None => (named, None),
    };
    let effect = catalogue.effect(name).ok_or_else(|| {
        let problem = Problem::error("unknown-effect", format!("there is no effect `{name}`"))
            .at(&place(name));
        problem.suggest(name, catalogue.effects.iter().map(|effect| effect.name.as_str()))
    })?;
    let (parameter, channel) = parameter_named(effect, parameter, &place)?;
    let value = match value {
        Some(written) => number(parameter, written, &place)?,
        None => parameter.default,
    };
    if value < parameter.low || value > parameter.high {
        let (low, high, unit) = (parameter.low, parameter.high, parameter.unit.suffix());
        let says = format!(
            "{value}{unit} is outside the range of `{}`: {low} to {high}{unit}",
            parameter.name
        );
        return Err(Problem::error("range", says).at(&place(rest)));
    }
    let mut channels: Vec<String> = channel.into_iter().collect();
    if let Action::Signals(operator, allowed) = &effect.action {
        for name in on.map_or(Vec::new(), |on| on.split(',').map(str::trim).collect()) {
            let found = catalogue
                .channels(name)
                .filter(|found| found.iter().all(|channel| allowed.contains(channel)));
            channels.extend(found.ok_or_else(|| {
                let problem = Problem::error(
                    "unknown-channel",
                    format!("`{}` does not act on `{name}`", effect.name),
                )
                .at(&place(name));
                let groups = catalogue.groups.iter().map(|group| group.name.as_str());
                problem.suggest(name, allowed.iter().map(String::as_str).chain(groups))
            })?);
        }
        channels = in_pairs(*operator, channels, allowed).map_err(|says| {
            let problem = Problem::error("channel-missing", format!("`{}` {says}", effect.name))
                .at(&place(rest));
            problem.help(format!(
                "write `{rest} on {}, {}`",
                allowed[0],
                allowed.get(1).unwrap_or(&allowed[0])
            ))
        })?;
        if channels.is_empty() {
            if parameter.name.contains(CHANNEL) {
                let says = format!(
                    "`{}` acts on one channel or a group, which must be given",
                    effect.name
                );
                return Err(Problem::error("channel-missing", says)
                    .at(&place(rest))
                    .help(format!("write `{rest} on {}`", allowed[0])));
            }
            channels.clone_from(allowed);
        }
    } else if let Some(on) = on {
        let says =
            format!("`{}` acts on the {}, not on channels", effect.name, effect.acts.in_words());
        return Err(Problem::error("unknown-channel", says).at(&place(on)));
    }
    Ok(Applied {
        effect: name.to_string(),
        values: vec![(parameter.name.clone(), value)],
        channels,
        confined,
    })
}

/// Channels as pairs, for an operator on pairs: a swap needs two channels; for a crosstalk either
/// channel identifies the pair.
fn in_pairs(
    operator: Operator,
    named: Vec<String>,
    allowed: &[String],
) -> Result<Vec<String>, &'static str> {
    match operator {
        Operator::Swap if named.len() != 2 || named[0] == named[1] => {
            Err("exchanges two channels, which must be given")
        }
        Operator::Crosstalk => {
            let chosen = allowed
                .chunks_exact(2)
                .filter(|pair| pair.iter().any(|channel| named.contains(channel)));
            Ok(chosen.flatten().cloned().collect())
        }
        _ => Ok(named),
    }
}

/// The parameter given by its full name or its last words, and the channel in its name.
fn parameter_named<'a>(
    effect: &'a Effect,
    named: Option<&str>,
    place: &dyn Fn(&str) -> Span,
) -> Result<(&'a Parameter, Option<String>), Problem> {
    let Some(named) = named else {
        // The first parameter is the main one.
        return Ok((&effect.parameters[0], None));
    };
    for parameter in &effect.parameters {
        if let Some(stem) = parameter.name.strip_suffix(CHANNEL) {
            if let Some(channel) = named.strip_prefix(stem).filter(|channel| !channel.is_empty()) {
                if let Action::Signals(_, allowed) = &effect.action
                    && !allowed.iter().any(|known| known == channel)
                {
                    let problem = Problem::error(
                        "unknown-channel",
                        format!("`{}` does not act on `{channel}`", effect.name),
                    );
                    return Err(problem
                        .at(&place(channel))
                        .suggest(channel, allowed.iter().map(String::as_str)));
                }
                return Ok((parameter, Some(channel.to_string())));
            }
        } else if parameter.name == named
            || parameter.name.strip_suffix(named).is_some_and(|head| head.ends_with('.'))
        {
            return Ok((parameter, None));
        }
    }
    let problem = Problem::error(
        "unknown-parameter",
        format!("`{}` has no parameter `{named}`", effect.name),
    )
    .at(&place(named));
    Err(problem.suggest(named, effect.parameter_names()))
}

fn number(
    parameter: &Parameter,
    written: &str,
    place: &dyn Fn(&str) -> Span,
) -> Result<f64, Problem> {
    if let Some((_, value)) = WORDS.iter().find(|(word, _)| *word == written) {
        return Ok(*value);
    }
    let refused = |refused: Refused| Problem {
        help: refused.help,
        ..Problem::error("wrong-kind", refused.says).at(&place(written))
    };
    let (value, unit) = split(written, &Unit::one()).map_err(refused)?;
    if unit.is_empty() {
        return Ok(value);
    }
    let unit = Unit::parse(unit).map_err(|unknown| unknown_unit(&unknown, &place(unit)))?;
    if unit.dimension != parameter.unit.dimension {
        let says = format!("`{}` is in {}, not in {unit}", parameter.name, parameter.unit);
        return Err(Problem::error("unit-mismatch", says).at(&place(written)));
    }
    Ok(parameter.unit.from_si(unit.to_si(value)))
}

fn confinement(text: &str, place: &dyn Fn(&str) -> Span) -> Result<Confined, Problem> {
    let text = text.trim();
    let (word, values) = text.split_once(' ').unwrap_or((text, ""));
    let column = COLUMNS
        .iter()
        .find(|(known, _)| *known == word)
        .map(|(_, column)| *column)
        .ok_or_else(|| {
            let problem =
                Problem::error("unknown-word", format!("an effect cannot be confined to `{text}`"))
                    .at(&place(text));
            problem.help("write `in zones 3, 4`, `in direction left` or `in sections S01, S02`")
        })?;
    let values = values
        .split(',')
        .map(|value| value.trim().to_string())
        .filter(|value| !value.is_empty())
        .collect();
    Ok(Confined { column: column.to_string(), values })
}
