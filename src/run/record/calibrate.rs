//! A record whose channels are calibrated otherwise. What follows from the values as recorded by a
//! straight line is not computed again: a filter, a mean and a percentile of `a x + b` follow from
//! those of `x`. All else runs through the graph again, from the changed channels.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex},
};

use super::{memo::locked, opened::Opened, signal::Samples, state::NodeValue};
use crate::catalog::Reducer;
use crate::run::{
    prelude::*,
    sections::{Known, chosen, needed},
};

/// A value `x` becomes `factor * x + offset`, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub factor: f64,
    pub offset: f64,
}

impl Line {
    pub const SAME: Self = Self { factor: 1.0, offset: 0.0 };

    fn of(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }

    /// Without an offset, by a function of the factor.
    fn scaled(self, factor: impl Fn(f64) -> f64) -> Option<Self> {
        (self.offset == 0.0).then(|| Self { factor: factor(self.factor), offset: 0.0 })
    }
}

/// What becomes of the columns of measured records; others stay.
pub type Lines = BTreeMap<String, Line>;

/// How a node follows from its value as recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Follows {
    /// It is a number that no channel changes.
    Number(f64),
    By(Line),
    /// It must be computed.
    Not,
}

impl From<Option<Line>> for Follows {
    fn from(line: Option<Line>) -> Self {
        line.map_or(Self::Not, Self::By)
    }
}

/// The values of a record as recorded, to be calibrated otherwise.
#[derive(Debug)]
pub struct Calibrated<'a> {
    opened: &'a Opened,
    of: (&'a Plan, &'a Graph),
    known: &'a Known<'a>,
    recorded: Vec<(NodeId, NodeValue)>,
    needed: BTreeSet<NodeId>,
    /// What a filter makes of the constant 1, where that is a constant.
    responses: Mutex<BTreeMap<NodeId, Option<f64>>>,
}

/// How much what a filter makes of the constant 1 may vary along the record and count as constant.
const CONSTANT: f64 = 1e-9;

impl<'a> Calibrated<'a> {
    pub fn new(
        opened: &'a Opened,
        of: (&'a Plan, &'a Graph),
        known: &'a Known<'a>,
        recorded: Vec<(NodeId, NodeValue)>,
        needed: BTreeSet<NodeId>,
    ) -> Self {
        Self { opened, of, known, recorded, needed, responses: Mutex::default() }
    }

    /// The values of the same nodes with other calibrations.
    ///
    /// # Errors
    /// As of [`Opened::evaluate`].
    pub fn with(&self, lines: &Lines) -> Result<Vec<(NodeId, NodeValue)>, Reason> {
        let follows = self.follows(lines);
        let mut found = Vec::with_capacity(self.recorded.len());
        let mut open = BTreeSet::new();
        for (id, value) in &self.recorded {
            match (follows[*id], value) {
                (Follows::Number(_), value) => found.push((*id, value.clone())),
                (Follows::By(line), value) if line == Line::SAME => {
                    found.push((*id, value.clone()));
                }
                (Follows::By(line), NodeValue::Number(value, samples)) => {
                    found.push((*id, NodeValue::Number(line.of(*value), *samples)));
                }
                (Follows::By(line), NodeValue::Samples(samples)) => {
                    found.push((*id, NodeValue::Samples(changed(samples, line))));
                }
                (Follows::By(_), NodeValue::Failed(_)) | (Follows::Not, _) => {
                    open.insert(*id);
                }
            }
        }
        if !open.is_empty() {
            let opened = self.opened.calibrated(lines);
            let needed = needed(self.of.1, &open, self.known)?;
            found.extend(opened.evaluate(self.of, &needed, &open, self.known, None)?);
        }
        Ok(found)
    }

    /// How each needed node follows; inputs stand before the nodes that use them.
    fn follows(&self, lines: &Lines) -> Vec<Follows> {
        let mut all = vec![Follows::Not; self.of.1.nodes.len()];
        for &id in &self.needed {
            all[id] = self.node(id, lines, &all);
        }
        all
    }

    fn node(&self, id: NodeId, lines: &Lines, all: &[Follows]) -> Follows {
        let node = &self.of.1.nodes[id];
        let line = |index: usize| match all[node.inputs[index]] {
            Follows::Number(_) => Some(Line::SAME),
            Follows::By(line) => Some(line),
            Follows::Not => None,
        };
        let unchanged = || (0..node.inputs.len()).all(|index| line(index) == Some(Line::SAME));
        match &node.operation {
            Operation::Read { column } if !node.track => {
                Follows::By(lines.get(column).copied().unwrap_or(Line::SAME))
            }
            Operation::Constant(expr) => {
                number(expr, self.known).map_or(Follows::By(Line::SAME), Follows::Number)
            }
            _ if unchanged() => Follows::By(Line::SAME),
            Operation::Arithmetic(operator) => {
                arithmetic(*operator, all[node.inputs[0]], all[node.inputs[1]]).into()
            }
            Operation::Negative => line(0).map(|line| Line { offset: -line.offset, ..line }).into(),
            Operation::Mapped(Mapping::Power(exponent)) => line(0)
                .filter(|line| line.factor > 0.0)
                .and_then(|line| line.scaled(|by| by.powf(*exponent)))
                .into(),
            Operation::Select(conditions) => chosen(conditions, &node.inputs, self.known)
                .map_or(Follows::Not, |input| all[node.inputs[input]]),
            Operation::OverAxis(operation) => line(0)
                .and_then(|line| match operation {
                    AxisOperation::Shifted(_) => Some(line),
                    AxisOperation::Derivative { .. } => Some(Line { offset: 0.0, ..line }),
                    AxisOperation::Integral { .. } => line.scaled(|by| by),
                })
                .into(),
            Operation::Step(spec) | Operation::Window(spec) => {
                line(0).and_then(|line| self.step(id, spec, line)).into()
            }
            Operation::Cut | Operation::Level => line(0).into(),
            Operation::Reduce(reducer) if node.inputs.len() == 1 => {
                line(0).and_then(|line| follow(*reducer, line)).into()
            }
            _ => Follows::Not,
        }
    }

    fn step(&self, id: NodeId, spec: &StepSpec, line: Line) -> Option<Line> {
        match spec {
            StepSpec::Magnitude => line.scaled(f64::abs),
            StepSpec::Window { reducer, .. } => follow(*reducer, line),
            StepSpec::Resample { .. } => Some(line),
            StepSpec::RemoveMean => Some(Line { offset: 0.0, ..line }),
            StepSpec::Butterworth { .. } | StepSpec::Transfer { .. } if line.offset == 0.0 => {
                Some(line)
            }
            StepSpec::Butterworth { .. } | StepSpec::Transfer { .. } => {
                let response = self.response(id, spec)?;
                Some(Line { offset: response * line.offset, ..line })
            }
        }
    }

    fn response(&self, id: NodeId, spec: &StepSpec) -> Option<f64> {
        let mut known = locked(&self.responses);
        *known.entry(id).or_insert_with(|| {
            let along = &self.opened.sampled.along;
            let ones =
                Samples { along: Arc::clone(along), values: Arc::new(vec![1.0; along.axis.len()]) };
            let filter = ones.designed(spec).ok()?;
            let found = filter.apply_many(&[ones.values.as_slice()]).ok()?.pop()?;
            let first = *found.first()?;
            found.iter().all(|value| (value - first).abs() <= CONSTANT).then_some(first)
        })
    }
}

/// What becomes of the value of a reducer.
fn follow(reducer: Reducer, line: Line) -> Option<Line> {
    let (factor, offset) =
        reducer.of_line((line.factor, line.offset)).filter(|_| line.factor > 0.0)?;
    Some(Line { factor, offset })
}

/// A sum of two signals follows where both are scaled alike; a product where neither has an offset.
fn arithmetic(operator: Operator, left: Follows, right: Follows) -> Option<Line> {
    use Follows::{By, Number};
    let sum = |a: Line, b: Line, sign: f64| {
        (a.factor == b.factor)
            .then_some(Line { factor: a.factor, offset: a.offset + sign * b.offset })
    };
    // The number itself is not scaled: its share of the scaled sum is taken back.
    let kept = |line: Line, number: f64| Line {
        offset: line.offset + number * (1.0 - line.factor),
        ..line
    };
    match (operator, left, right) {
        (Operator::Add, By(a), By(b)) => sum(a, b, 1.0),
        (Operator::Subtract, By(a), By(b)) => sum(a, b, -1.0),
        (Operator::Add, By(line), Number(k)) | (Operator::Add, Number(k), By(line)) => {
            Some(kept(line, k))
        }
        (Operator::Subtract, By(line), Number(k)) => Some(kept(line, -k)),
        (Operator::Subtract, Number(k), By(line)) => {
            Some(kept(Line { offset: -line.offset, ..line }, k))
        }
        (Operator::Multiply, By(a), By(b)) if b.offset == 0.0 => a.scaled(|by| by * b.factor),
        (Operator::Multiply, By(line), Number(k)) | (Operator::Multiply, Number(k), By(line)) => {
            Some(Line { offset: k * line.offset, ..line })
        }
        (Operator::Divide, By(a), By(b)) if b.offset == 0.0 => a.scaled(|by| by / b.factor),
        (Operator::Divide, By(line), Number(k)) => Some(Line { offset: line.offset / k, ..line }),
        (Operator::Divide, Number(_), By(line)) => line.scaled(f64::recip),
        _ => None,
    }
    .filter(|line| line.factor.is_finite() && line.offset.is_finite())
}

fn changed(samples: &Samples, line: Line) -> Samples {
    samples.with(samples.values.iter().map(|value| line.of(*value)).collect())
}

impl Opened {
    /// The record with other channels, read by one protocol alone: what others have computed of it
    /// does not count.
    fn calibrated(&self, lines: &Lines) -> Self {
        let sampled = self.sampled.with_columns(|name, values| {
            let line = lines.get(name).filter(|line| **line != Line::SAME)?;
            Some(values.iter().map(|value| line.of(*value)).collect())
        });
        Self { sampled, memo: None, stretch: None, ..self.clone() }
    }
}
