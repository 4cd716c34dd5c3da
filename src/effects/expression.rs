//! Effects as expressions of the protocol language: a channel is computed sample by sample from
//! channels of the same record.

use super::signals::Signals;
use crate::catalog::{FUNCTIONS, Function, Signature};
use crate::problem::{Problem, Problems};
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::from_pest::expression;
use crate::syntax::phrase::{Node, Operator, Phrase};
use crate::units::{Dimension, Unit};

/// The expression for a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// The channel that is replaced.
    pub channel: String,
    unit: Unit,
    tree: Tree,
}

/// An expression with consistent units; values in SI.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Channel(String, Unit),
    /// Index of the effect's parameter.
    Parameter(usize, Unit),
    Binary(Operator, Box<[Tree; 2]>),
    Negative(Box<Tree>),
    Power(Box<Tree>, i8),
    Call(&'static Function, Vec<Tree>),
}

impl PartialEq for Tree {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a == b,
            (Self::Channel(a, u), Self::Channel(b, v)) => a == b && u == v,
            (Self::Parameter(a, u), Self::Parameter(b, v)) => a == b && u == v,
            (Self::Binary(a, x), Self::Binary(b, y)) => a == b && x == y,
            (Self::Negative(a), Self::Negative(b)) => a == b,
            (Self::Power(a, x), Self::Power(b, y)) => a == b && x == y,
            (Self::Call(a, x), Self::Call(b, y)) => a.name == b.name && x == y,
            _ => false,
        }
    }
}

/// Meaning of the names in an expression.
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
        let mut checker = Checker { text, known, problems };
        let (tree, dimension) = checker.tree(&phrase)?;
        let (name, unit) = channel;
        if dimension != unit.dimension {
            let says = format!(
                "`{name}` is {}, but its expression is {}",
                unit.dimension.in_words(),
                dimension.in_words()
            );
            problems.push(Problem::error("unit-mismatch", says).at(&text.span));
            return None;
        }
        Some(Self { channel: name.to_string(), unit: unit.clone(), tree })
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
        let values = self.tree.values(signals, parameters)?;
        let values: Vec<f64> = match values {
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
}

/// One value for all samples, or one per sample.
enum Values {
    One(f64),
    All(Vec<f64>),
}

impl Tree {
    fn values(&self, signals: &Signals, parameters: &[f64]) -> Option<Values> {
        Some(match self {
            Self::Number(value) => Values::One(*value),
            Self::Parameter(at, unit) => Values::One(unit.to_si(*parameters.get(*at)?)),
            Self::Channel(name, unit) => Values::All(
                signals.channel(name)?.values.iter().map(|value| unit.to_si(*value)).collect(),
            ),
            Self::Negative(inner) => each(&[inner.values(signals, parameters)?], |x| -x[0]),
            Self::Power(inner, exponent) => {
                each(&[inner.values(signals, parameters)?], |x| x[0].powi(i32::from(*exponent)))
            }
            Self::Binary(operator, sides) => {
                let sides =
                    [sides[0].values(signals, parameters)?, sides[1].values(signals, parameters)?];
                each(&sides, |x| match operator {
                    Operator::Add => x[0] + x[1],
                    Operator::Subtract => x[0] - x[1],
                    Operator::Multiply => x[0] * x[1],
                    _ => x[0] / x[1],
                })
            }
            Self::Call(function, arguments) => {
                let arguments: Vec<Values> = arguments
                    .iter()
                    .map(|argument| argument.values(signals, parameters))
                    .collect::<Option<_>>()?;
                each(&arguments, function.run)
            }
        })
    }
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

struct Checker<'a> {
    text: &'a Text,
    known: Known<'a>,
    problems: &'a mut Problems,
}

impl Checker<'_> {
    fn refuse<T>(&mut self, code: &'static str, says: String, at: &Span) -> Option<T> {
        self.problems.push(Problem::error(code, says).at(at));
        None
    }

    /// The grammar limits the depth of an expression.
    fn tree(&mut self, phrase: &Phrase) -> Option<(Tree, Dimension)> {
        let span = phrase.place();
        match &phrase.node {
            Node::Number(number) => Some((Tree::Number(number.value), number.dimension())),
            Node::Path(name) => self.named(name, &span),
            Node::Negative(inner) => self
                .tree(inner)
                .map(|(tree, dimension)| (Tree::Negative(Box::new(tree)), dimension)),
            Node::Magnitude(inner) => self.call("magnitude", std::slice::from_ref(inner), &span),
            Node::Power(inner, exponent) => {
                let (tree, dimension) = self.tree(inner)?;
                match dimension.power(*exponent) {
                    Some(dimension) => Some((Tree::Power(Box::new(tree), *exponent), dimension)),
                    None => {
                        self.refuse("power", "this power is beyond any unit".to_string(), &span)
                    }
                }
            }
            Node::Binary(operator, left, right) => {
                let (left, right) = (self.tree(left), self.tree(right));
                let ((left, a), (right, b)) = (left?, right?);
                let dimension = match operator {
                    Operator::Multiply => a * b,
                    Operator::Divide => a / b,
                    Operator::Add | Operator::Subtract if a == b => a,
                    Operator::Add | Operator::Subtract => {
                        return self.refuse(
                            "unit-mismatch",
                            format!("{} and {} cannot be added", a.in_words(), b.in_words()),
                            &span,
                        );
                    }
                    _ => {
                        return self.refuse(
                            "not-here",
                            "a condition is not a signal".to_string(),
                            &span,
                        );
                    }
                };
                Some((Tree::Binary(*operator, Box::new([left, right])), dimension))
            }
            Node::Call(name, arguments) => {
                self.call(&name.node, &arguments.iter().collect::<Vec<_>>(), &span)
            }
            _ => self.refuse(
                "not-here",
                "an effect may contain only numbers, channels, parameters and functions of samples"
                    .into(),
                &span,
            ),
        }
    }

    fn named(&mut self, name: &str, span: &Span) -> Option<(Tree, Dimension)> {
        if let Some(at) = self.known.parameters.iter().position(|(known, _)| known == name) {
            let unit = self.known.parameters[at].1.clone();
            return Some((Tree::Parameter(at, unit.clone()), unit.dimension));
        }
        if let Some((_, unit)) = self.known.channels.iter().find(|(known, _)| known == name) {
            return Some((Tree::Channel(name.to_string(), unit.clone()), unit.dimension));
        }
        let names =
            self.known.parameters.iter().chain(self.known.channels).map(|(name, _)| name.as_str());
        let problem = Problem::error(
            "unknown-name",
            format!("`{name}` is neither a parameter of this effect nor a channel with a unit"),
        );
        self.problems.push(problem.at(span).suggest(name, names));
        None
    }

    fn call(
        &mut self,
        name: &str,
        arguments: &[impl std::borrow::Borrow<Phrase>],
        span: &Span,
    ) -> Option<(Tree, Dimension)> {
        let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) else {
            let problem =
                Problem::error("unknown-name", format!("there is no function `{name}`")).at(span);
            self.problems
                .push(problem.suggest(name, FUNCTIONS.iter().map(|function| function.name)));
            return None;
        };
        let needed = if function.signature == Signature::PairSame { 2 } else { 1 };
        if arguments.len() != needed {
            return self.refuse(
                "wrong-kind",
                format!("`{name}` takes {needed}, but {} are given", arguments.len()),
                span,
            );
        }
        let found: Vec<(Tree, Dimension)> =
            arguments.iter().map(|argument| self.tree(argument.borrow())).collect::<Option<_>>()?;
        let first = found[0].1;
        let dimension = match function.signature {
            Signature::Same => Some(first),
            Signature::ToPlain => Some(Dimension::ONE),
            Signature::Plain => (first == Dimension::ONE).then_some(first),
            Signature::Root => first.root(),
            Signature::PairSame => (first == found[1].1).then_some(first),
        };
        match dimension {
            Some(dimension) => Some((
                Tree::Call(function, found.into_iter().map(|(tree, _)| tree).collect()),
                dimension,
            )),
            None => self.refuse(
                "unit-mismatch",
                format!("`{name}` does not take {}", found.last()?.1.in_words()),
                span,
            ),
        }
    }
}
