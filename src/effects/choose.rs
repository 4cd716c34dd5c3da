//! Effects as chosen on a command line: `friction=0.5`, `payload.payload.mass=3.5 t`,
//! `sensor_gain=0.8 on Y_3R`, `friction=0.2 in zones 3, 4`.

use std::sync::Arc;

use super::{
    catalogue::{Action, Catalogue, Effect, Parameter},
    operators::Operator,
    read::CHANNEL,
};
use crate::problem::{Problem, error};
use crate::source::{Source, Span};
use crate::units::{Unit, number::split};
use crate::yaml::{Words, unknown_unit};

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
    pub fn has(&self, value: &str) -> bool {
        self.values.iter().any(|one| one == value)
    }
}

impl Applied {
    /// The value of a parameter, if it is not neutral.
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
    let (mut chosen, mut problems) = (Vec::new(), Vec::new());
    for text in texts {
        let written = Written { catalogue, source: Source::new("--effect", text.as_str()) };
        let joined = written.applied().and_then(|applied| written.join(applied, &mut chosen));
        problems.extend(joined.err());
    }
    if problems.is_empty() { Ok(chosen) } else { Err(problems) }
}

/// A text that chooses an effect.
struct Written<'a> {
    catalogue: &'a Catalogue,
    source: Arc<Source>,
}

/// What stands before and behind a word.
fn halves<'a>(text: &'a str, word: &str) -> (&'a str, Option<&'a str>) {
    text.split_once(word).map_or((text, None), |(before, behind)| (before, Some(behind)))
}

impl Written<'_> {
    /// The place of a part of the text.
    fn place(&self, part: &str) -> Span {
        let start = part.as_ptr() as usize - self.source.text.as_ptr() as usize;
        self.source.span(start..start + part.len())
    }

    fn error(&self, code: &'static str, says: String, part: &str) -> Problem {
        error(code, says, &self.place(part))
    }

    /// Adds an effect to those chosen before. Of several parameters of an effect, each has its own
    /// text.
    fn join(&self, applied: Applied, chosen: &mut Vec<Applied>) -> Result<(), Problem> {
        let Some(known) = chosen.iter_mut().find(|known| {
            known.effect == applied.effect
                && known.channels == applied.channels
                && known.confined == applied.confined
        }) else {
            chosen.push(applied);
            return Ok(());
        };
        let twice = known.values.iter().find(|(name, _)| applied.value(name).is_some());
        if let Some((name, _)) = twice {
            return Err(self
                .error(
                    "duplicate-effect",
                    format!("`{name}` of the effect `{}` is given twice", applied.effect),
                    &self.source.text,
                )
                .help("give one value"));
        }
        known.values.extend(applied.values);
        Ok(())
    }

    fn applied(&self) -> Result<Applied, Problem> {
        let (rest, within) = halves(&self.source.text, " in ");
        let confined = within.map(|within| self.confinement(within.trim())).transpose()?;
        let (rest, on) = halves(rest, " on ");
        let (named, value) = halves(rest, "=");
        let (name, parameter) = halves(named.trim(), ".");
        let effect = self.catalogue.effect(name).ok_or_else(|| {
            let known = self.catalogue.effects.iter().map(|effect| &effect.name);
            self.error("unknown-effect", format!("there is no effect `{name}`"), name)
                .suggest(name, known)
        })?;
        let (parameter, channel) = self.parameter(effect, parameter)?;
        let value = match value {
            Some(written) => self.number(parameter, written.trim())?,
            None => parameter.default,
        };
        let Parameter { low, high, .. } = *parameter;
        if value < low || value > high {
            let (name, unit) = (&parameter.name, parameter.unit.suffix());
            return Err(self.error(
                "range",
                format!("{value}{unit} is outside the range of `{name}`: {low} to {high}{unit}"),
                rest,
            ));
        }
        let named = channel.into_iter().collect();
        let channels = match (&effect.action, on) {
            (Action::Signals(operator, allowed), _) => {
                let of_channel = parameter.name.contains(CHANNEL);
                self.channels(&effect.name, (*operator, allowed), named, (rest, on, of_channel))?
            }
            (_, None) => named,
            (_, Some(on)) => {
                let acts = effect.acts.word();
                return Err(self.error(
                    "unknown-channel",
                    format!("`{}` acts on the {acts}, not on channels", effect.name),
                    on,
                ));
            }
        };
        let values = vec![(parameter.name.clone(), value)];
        Ok(Applied { effect: name.to_string(), values, channels, confined })
    }

    /// The channels of an operator: those that are named with the parameter or after `on`, else all
    /// that it may act on, unless its parameter is one of a channel.
    fn channels(
        &self,
        effect: &str,
        (operator, allowed): (Operator, &[String]),
        mut channels: Vec<String>,
        (rest, on, of_channel): (&str, Option<&str>, bool),
    ) -> Result<Vec<String>, Problem> {
        for name in on.into_iter().flat_map(|on| on.split(',')).map(str::trim) {
            let found = self.catalogue.channels(name);
            let found = found.filter(|found| found.iter().all(|channel| allowed.contains(channel)));
            channels.extend(found.ok_or_else(|| {
                let groups = self.catalogue.groups.iter().map(|group| &group.name);
                self.error("unknown-channel", format!("`{effect}` does not act on `{name}`"), name)
                    .suggest(name, allowed.iter().chain(groups))
            })?);
        }
        let lacking = |says: &str, example: String| {
            let problem = self.error("channel-missing", format!("`{effect}` {says}"), rest);
            Err(problem.help(format!("write `{rest} on {example}`")))
        };
        // An operator on pairs: a swap needs two channels; for a crosstalk either channel
        // identifies the pair.
        match operator {
            Operator::Swap if channels.len() != 2 || channels[0] == channels[1] => {
                let example = format!("{}, {}", allowed[0], allowed.get(1).unwrap_or(&allowed[0]));
                return lacking("exchanges two channels, which must be given", example);
            }
            Operator::Crosstalk => {
                let named =
                    |pair: &&[String]| pair.iter().any(|channel| channels.contains(channel));
                channels = allowed.chunks_exact(2).filter(named).flatten().cloned().collect();
            }
            _ => {}
        }
        match (channels.is_empty(), of_channel) {
            (false, _) => Ok(channels),
            (true, false) => Ok(allowed.to_vec()),
            (true, true) => {
                lacking("acts on one channel or a group, which must be given", allowed[0].clone())
            }
        }
    }

    /// The parameter given by its full name or its last words, and the channel in its name. The
    /// first parameter is the main one.
    fn parameter<'a>(
        &self,
        effect: &'a Effect,
        named: Option<&str>,
    ) -> Result<(&'a Parameter, Option<String>), Problem> {
        let Some(named) = named else { return Ok((&effect.parameters[0], None)) };
        for parameter in &effect.parameters {
            let name = &parameter.name;
            let Some(stem) = name.strip_suffix(CHANNEL) else {
                if name
                    .strip_suffix(named)
                    .is_some_and(|head| head.is_empty() || head.ends_with('.'))
                {
                    return Ok((parameter, None));
                }
                continue;
            };
            let channel = named.strip_prefix(stem).filter(|channel| !channel.is_empty());
            let Some(channel) = channel else { continue };
            if let Action::Signals(_, allowed) = &effect.action
                && !allowed.iter().any(|known| known == channel)
            {
                return Err(self
                    .error(
                        "unknown-channel",
                        format!("`{}` does not act on `{channel}`", effect.name),
                        channel,
                    )
                    .suggest(channel, allowed));
            }
            return Ok((parameter, Some(channel.to_string())));
        }
        let problem = self.error(
            "unknown-parameter",
            format!("`{}` has no parameter `{named}`", effect.name),
            named,
        );
        Err(problem.suggest(named, effect.parameter_names()))
    }

    fn number(&self, parameter: &Parameter, written: &str) -> Result<f64, Problem> {
        if let Some((_, value)) = WORDS.iter().find(|(word, _)| *word == written) {
            return Ok(*value);
        }
        let (value, unit) = split(written, &Unit::one()).map_err(|refused| {
            self.error("wrong-kind", refused.says, written).help_if(refused.help)
        })?;
        if unit.is_empty() {
            return Ok(value);
        }
        let unit =
            Unit::parse(unit).map_err(|unknown| unknown_unit(&unknown, &self.place(unit)))?;
        if unit.dimension != parameter.unit.dimension {
            return Err(self.error(
                "unit-mismatch",
                format!("`{}` is in {}, not in {unit}", parameter.name, parameter.unit),
                written,
            ));
        }
        Ok(parameter.unit.from_si(unit.to_si(value)))
    }

    fn confinement(&self, text: &str) -> Result<Confined, Problem> {
        let (word, values) = text.split_once(' ').unwrap_or((text, ""));
        let Some((_, column)) = COLUMNS.iter().find(|(known, _)| *known == word) else {
            return Err(self
                .error("unknown-word", format!("an effect cannot be confined to `{text}`"), text)
                .help("write `in zones 3, 4`, `in direction left` or `in sections S01, S02`"));
        };
        let values = values.split(',').map(str::trim).filter(|value| !value.is_empty());
        let values = values.map(str::to_string).collect();
        Ok(Confined { column: (*column).to_string(), values })
    }
}
