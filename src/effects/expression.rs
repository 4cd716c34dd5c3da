//! Effects as expressions of the protocol language: a channel is computed sample by sample from
//! channels of the same record.

use std::collections::BTreeMap;

use super::signals::Signals;
use crate::catalog::{FUNCTIONS, Function, Signature};
use crate::problem::{Problem, Problems, error};
use crate::syntax::{
    document::Text,
    from_pest::expression,
    phrase::{Node, Operator, Phrase},
};
use crate::units::{Dimension, Unit, raised};

/// The expression for a channel, with consistent units.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// The channel that is replaced.
    pub channel: String,
    unit: Unit,
    phrase: Phrase,
    /// The names in the expression.
    names: BTreeMap<String, Meaning>,
}

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
enum Meaning {
    Channel(Unit),
    /// Index of the effect's parameter.
    Parameter(usize, Unit),
}

/// The names that an expression can use.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    /// Channels with their units.
    pub channels: &'a [(String, Unit)],
    /// The last words of the effect's parameters, with their units.
    pub parameters: &'a [(String, Unit)],
}

impl Formula {
    /// Reads and checks `text`, the expression for `channel`.
    ///
    /// Problems: those of the grammar; `unknown-name` with the nearest name, `unit-mismatch`,
    /// `not-here`, `power`.
    pub(super) fn read(
        channel: (&str, &Unit),
        text: &Text,
        known: Known<'_>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let phrase = expression(text, problems)?;
        let mut checker = Checker { known, problems, names: BTreeMap::new() };
        let dimension = checker.dimension(&phrase)?;
        let (name, unit) = channel;
        if dimension != unit.dimension {
            let says = format!(
                "`{name}` is {}, but its expression is {}",
                unit.dimension.in_words(),
                dimension.in_words()
            );
            return checker.refuse(error("unit-mismatch", says, text));
        }
        let names = checker.names;
        Some(Self { channel: name.to_string(), unit: unit.clone(), phrase, names })
    }

    /// The new values of the channel in its unit; `None` if the record lacks a channel of the
    /// expression. `parameters` are in their units, in the order of the effect.
    ///
    /// # Errors
    /// A value is not finite; the message gives its position.
    pub(super) fn values(
        &self,
        signals: &Signals,
        parameters: &[f64],
    ) -> Option<Result<Vec<f64>, String>> {
        signals.channel(&self.channel)?;
        let values: Vec<f64> = match self.evaluated(&self.phrase, signals, parameters)? {
            Values::All(values) => {
                values.into_iter().map(|value| self.unit.from_si(value)).collect()
            }
            Values::One(value) => vec![self.unit.from_si(value); signals.axis.len()],
        };
        Some(match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(format!(
                "`{}` is not finite at {:.3}",
                self.channel,
                signals.axis.get(at).copied().unwrap_or(0.0)
            )),
            None => Ok(values),
        })
    }

    /// The values of a part of the expression, SI.
    fn evaluated(&self, part: &Phrase, signals: &Signals, parameters: &[f64]) -> Option<Values> {
        let of = |part: &Phrase| self.evaluated(part, signals, parameters);
        Some(match &part.node {
            Node::Number(number) => Values::One(number.value),
            Node::Path(name) => match self.names.get(name)? {
                Meaning::Parameter(at, unit) => Values::One(unit.to_si(*parameters.get(*at)?)),
                Meaning::Channel(unit) => Values::All(
                    signals.channel(name)?.values.iter().map(|value| unit.to_si(*value)).collect(),
                ),
            },
            Node::Negative(inner) => each(&[of(inner)?], |x| -x[0]),
            Node::Magnitude(inner) => each(&[of(inner)?], |x| x[0].abs()),
            Node::Power(inner, exponent) => {
                let exponent = exponent.plain_number()?;
                each(&[of(inner)?], |x| raised(x[0], exponent))
            }
            Node::Binary(operator, left, right) => {
                each(&[of(left)?, of(right)?], |x| match operator {
                    Operator::Add => x[0] + x[1],
                    Operator::Subtract => x[0] - x[1],
                    Operator::Multiply => x[0] * x[1],
                    _ => x[0] / x[1],
                })
            }
            Node::Call(name, arguments) => {
                let arguments = arguments.iter().map(of).collect::<Option<Vec<_>>>()?;
                each(&arguments, function(&name.node)?.run)
            }
            // The checker accepts nothing else.
            _ => return None,
        })
    }
}

/// One value for all samples, or one per sample.
enum Values {
    One(f64),
    All(Vec<f64>),
}

fn each(arguments: &[Values], run: impl Fn(&[f64]) -> f64) -> Values {
    let samples = arguments
        .iter()
        .filter_map(
            |values| if let Values::All(values) = values { Some(values.len()) } else { None },
        )
        .min();
    let mut row = vec![0.0; arguments.len()];
    let mut at = |n: usize| {
        for (cell, values) in row.iter_mut().zip(arguments) {
            *cell = match values {
                Values::One(value) => *value,
                Values::All(values) => values[n],
            };
        }
        run(&row)
    };
    match samples {
        None => Values::One(at(0)),
        Some(samples) => Values::All((0..samples).map(at).collect()),
    }
}

fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

struct Checker<'a> {
    known: Known<'a>,
    problems: &'a mut Problems,
    names: BTreeMap<String, Meaning>,
}

impl Checker<'_> {
    fn refuse<T>(&mut self, problem: Problem) -> Option<T> {
        self.problems.push(problem);
        None
    }

    /// The dimension of an expression. The grammar limits its depth.
    fn dimension(&mut self, phrase: &Phrase) -> Option<Dimension> {
        match &phrase.node {
            Node::Number(number) => Some(number.dimension()),
            Node::Path(name) => self.named(name, phrase),
            Node::Negative(inner) | Node::Magnitude(inner) => self.dimension(inner),
            Node::Power(inner, exponent) => {
                let base = self.dimension(inner)?;
                let found = exponent.plain_number().map(|exponent| base.power(exponent));
                match found {
                    Some(Some(dimension)) => Some(dimension),
                    Some(None) => {
                        self.refuse(error("power", "this power is beyond any unit", phrase))
                    }
                    None => {
                        let says = "an exponent here is a number such as 2, 0.3 or (1/3)";
                        self.refuse(error("power", says, &**exponent))
                    }
                }
            }
            Node::Binary(operator, left, right) => {
                let (left, right) = (self.dimension(left), self.dimension(right));
                let (a, b) = (left?, right?);
                match operator {
                    Operator::Multiply => Some(a * b),
                    Operator::Divide => Some(a / b),
                    Operator::Add | Operator::Subtract if a == b => Some(a),
                    Operator::Add | Operator::Subtract => {
                        let says = format!("{} and {} cannot be added", a.in_words(), b.in_words());
                        self.refuse(error("unit-mismatch", says, phrase))
                    }
                    _ => self.refuse(error("not-here", "a condition is not a signal", phrase)),
                }
            }
            Node::Call(name, arguments) => self.call(&name.node, arguments, phrase),
            _ => self.refuse(error(
                "not-here",
                "an effect may contain only numbers, channels, parameters and functions of samples",
                phrase,
            )),
        }
    }

    fn named(&mut self, name: &str, phrase: &Phrase) -> Option<Dimension> {
        let Known { channels, parameters } = self.known;
        let parameter = parameters.iter().enumerate().find(|(_, (known, _))| known == name);
        let channel = channels.iter().find(|(known, _)| known == name);
        let (meaning, unit) = match (parameter, channel) {
            (Some((at, (_, unit))), _) => (Meaning::Parameter(at, unit.clone()), unit),
            (None, Some((_, unit))) => (Meaning::Channel(unit.clone()), unit),
            (None, None) => {
                let known = parameters.iter().chain(channels).map(|(name, _)| name);
                let says = format!(
                    "`{name}` is neither a parameter of this effect nor a channel with a unit"
                );
                return self.refuse(error("unknown-name", says, phrase).suggest(name, known));
            }
        };
        self.names.insert(name.to_string(), meaning);
        Some(unit.dimension)
    }

    fn call(&mut self, name: &str, arguments: &[Phrase], phrase: &Phrase) -> Option<Dimension> {
        let Some(function) = function(name) else {
            let known = FUNCTIONS.iter().map(|function| function.name);
            let says = format!("there is no function `{name}`");
            return self.refuse(error("unknown-name", says, phrase).suggest(name, known));
        };
        let needed = if function.signature == Signature::PairSame { 2 } else { 1 };
        if arguments.len() != needed {
            let says = format!("`{name}` takes {needed}, but {} are given", arguments.len());
            return self.refuse(error("wrong-kind", says, phrase));
        }
        let found: Vec<Dimension> =
            arguments.iter().map(|argument| self.dimension(argument)).collect::<Option<_>>()?;
        let first = found[0];
        let dimension = match function.signature {
            Signature::Same => Some(first),
            Signature::ToPlain => Some(Dimension::ONE),
            Signature::Plain => (first == Dimension::ONE).then_some(first),
            Signature::Root => first.power(0.5),
            Signature::PairSame => (first == found[1]).then_some(first),
        };
        if dimension.is_some() {
            return dimension;
        }
        let says = format!("`{name}` does not take {}", found.last()?.in_words());
        self.refuse(error("unit-mismatch", says, phrase))
    }
}
