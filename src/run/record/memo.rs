//! Results of nodes, kept under what the nodes do: what does the same with the same is computed
//! once, in the graphs of several protocols or in sections that share a stretch of a run.

use std::{
    collections::HashMap,
    hash::{Hash, Hasher},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::signal::Signal;
use crate::catalog::Reducer;
use crate::graph::Node;
use crate::metrics::percentile::Method;
use crate::run::{
    prelude::*,
    sections::{Known, chosen},
};

/// The number of what each node of a graph does, the same in every graph; `None` for nodes that
/// join records, and where a name in the node has no value.
pub type Keys = Vec<Option<usize>>;

/// What a node does with its inputs, with the values of all names put in.
#[derive(Debug, PartialEq, Eq, Hash)]
enum Does {
    Read { column: String, track: bool, axis: String, time: Option<String> },
    Constant(u64),
    Arithmetic(Compared<Operator>),
    Negative,
    Mapped(Compared<Mapping>),
    Apply(&'static str),
    Shifted(u64, ExtentKey),
    Derivative { over_time: bool },
    Integral { over_time: bool },
    Level(ExtentKey),
    Step(Compared<StepSpec>),
    Cut(ExtentKey),
    Window(Compared<StepSpec>, ExtentKey),
    OfSection(Compared<SectionOperation>),
    Reduce(Compared<Reducer>, Method),
}

/// The bits of the start and the end of a section; `None` of a whole record.
type ExtentKey = Option<(u64, u64)>;

/// A part of a key that is compared and not hashed, as it contains numbers with decimals.
#[derive(Debug, PartialEq)]
struct Compared<T>(T);

impl<T: PartialEq> Eq for Compared<T> {}

impl<T> Hash for Compared<T> {
    fn hash<H: Hasher>(&self, _: &mut H) {}
}

impl Does {
    /// `None` where the operation does not work on one record, or a name has no value.
    fn of(plan: &Plan, node: &Node, known: &Known<'_>) -> Option<Self> {
        let place = known.extent.map(|(start, end)| (start.to_bits(), end.to_bits()));
        Some(match &node.operation {
            Operation::Read { column } => Self::Read {
                column: column.clone(),
                track: node.track,
                axis: plan.axis.column.clone(),
                time: plan.time.as_ref().map(|time| time.column.clone()),
            },
            Operation::Constant(expr) => Self::Constant(number(expr, known).ok()?.to_bits()),
            Operation::Arithmetic(operator) => Self::Arithmetic(Compared(*operator)),
            Operation::Negative => Self::Negative,
            Operation::Mapped(mapping) => Self::Mapped(Compared(mapping.clone())),
            Operation::Apply(function) => Self::Apply(function.name),
            Operation::OverAxis(AxisOperation::Shifted(distance)) => {
                Self::Shifted(number(distance, known).ok()?.to_bits(), place)
            }
            Operation::OverAxis(AxisOperation::Derivative { over_time }) => {
                Self::Derivative { over_time: *over_time }
            }
            Operation::OverAxis(AxisOperation::Integral { over_time }) => {
                Self::Integral { over_time: *over_time }
            }
            Operation::Level => Self::Level(place),
            Operation::Step(spec) => Self::Step(Compared(spec.clone())),
            Operation::Cut => Self::Cut(place),
            Operation::Window(spec) => Self::Window(Compared(spec.clone()), place),
            Operation::OfSection(operation) => Self::OfSection(Compared(operation.clone())),
            Operation::Reduce(reducer) => {
                Self::Reduce(Compared(*reducer), plan.sections.percentiles)
            }
            Operation::Select(_)
            | Operation::Choose(_)
            | Operation::Present
            | Operation::Value(_)
            | Operation::Compare(_)
            | Operation::Estimate(_)
            | Operation::Report(_)
            | Operation::Limit(_)
            | Operation::Verdict(_) => return None,
        })
    }
}

/// What nodes do, each with the numbers of its inputs and its own.
#[derive(Debug, Default)]
pub struct Numbers(HashMap<(Does, Vec<usize>), usize>);

impl Numbers {
    /// Numbers the nodes of a protocol's graph for a section.
    pub fn keys(&mut self, plan: &Plan, graph: &Graph, known: &Known<'_>) -> Keys {
        let mut keys: Keys = Vec::with_capacity(graph.nodes.len());
        for node in &graph.nodes {
            let inputs =
                || node.inputs.iter().map(|&input| keys[input]).collect::<Option<Vec<_>>>();
            let key = match &node.operation {
                Operation::Select(conditions) => chosen(conditions, &node.inputs, known)
                    .ok()
                    .and_then(|input| keys[node.inputs[input]]),
                _ => inputs().zip(Does::of(plan, node, known)).map(|(inputs, does)| {
                    let next = self.0.len();
                    *self.0.entry((does, inputs)).or_insert(next)
                }),
            };
            keys.push(key);
        }
        keys
    }
}

/// A result of a node.
#[derive(Clone, Debug)]
pub enum Computed {
    Signal(Signal),
    /// A reduced signal, and of how many samples.
    Number(f64, usize),
}

/// Results of one record by the numbers of what made them.
#[derive(Debug, Default)]
pub struct Memo {
    results: Mutex<HashMap<usize, Computed>>,
    filtered: AtomicUsize,
    asked: AtomicUsize,
}

/// What a thread that panicked left is not looked at: its panic ends the run.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Memo {
    pub fn get(&self, key: usize) -> Option<Computed> {
        locked(&self.results).get(&key).cloned()
    }

    pub fn put(&self, key: usize, result: Computed) {
        locked(&self.results).insert(key, result);
    }

    /// Counts signals that a filter ran over.
    pub fn count_filtered(&self, signals: usize) {
        self.filtered.fetch_add(signals, Ordering::Relaxed);
    }

    /// Counts signals that a protocol by itself would have filtered.
    pub fn count_asked(&self, signals: usize) {
        self.asked.fetch_add(signals, Ordering::Relaxed);
    }

    /// Signals that were filtered, and those that protocols by themselves would have filtered.
    pub fn counts(&self) -> (usize, usize) {
        (self.filtered.load(Ordering::Relaxed), self.asked.load(Ordering::Relaxed))
    }
}
