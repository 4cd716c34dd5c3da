//! The processing graph: typed operations from channels to verdicts. Common parts are stored once.
//! Each node knows the line of its rule.
//!
//! Nodes up to [`Operation::Value`] are executed once for each record. [`Operation::Compare`] makes
//! the rows of the table of values, from one record or from several. The following nodes use groups
//! of rows. Inputs always have a smaller index than the node. The order of the nodes is therefore
//! an order of execution, and cycles are impossible.

mod build;
mod draw;
mod print;

pub use build::from_plan;
pub use draw::svg;
pub use print::{dot, json, text};

use std::{collections::BTreeSet, sync::Arc};

use crate::catalog::{Function, Metric, Reducer};
use crate::check::plan::{
    AxisOperation, Decision, Evaluation, Expr, InputSide, Limit, Mapping, Operator, Report,
    SectionOperation, StepSpec,
};
use crate::source::Span;
use crate::units::Dimension;

pub type NodeId = usize;

#[derive(Clone, Debug)]
pub struct Graph {
    pub nodes: Vec<Node>,
    pub quantities: Vec<QuantityNodes>,
    /// One for each section check of the plan.
    pub checks: Vec<Vec<InputNode>>,
    pub find: FindNodes,
    /// One for each plausibility rule of the plan.
    pub plausibility: Vec<PlausibilityNodes>,
    /// One for each verdict of the plan, the overall verdict first.
    pub verdicts: Vec<NodeId>,
}

impl Graph {
    /// The columns that nodes are computed from, whichever of their cases apply, and whether each
    /// is of the track record. One that several nodes read is there several times.
    pub fn columns_of(&self, nodes: impl IntoIterator<Item = NodeId>) -> Vec<(String, bool)> {
        let (mut seen, mut open) = (BTreeSet::new(), nodes.into_iter().collect::<Vec<_>>());
        while let Some(id) = open.pop() {
            if seen.insert(id) {
                open.extend(&self.nodes[id].inputs);
            }
        }
        let of = |id: NodeId| match &self.nodes[id].operation {
            Operation::Read { column } => Some((column.clone(), self.nodes[id].track)),
            _ => None,
        };
        seen.into_iter().filter_map(of).collect()
    }
}

/// Values of signals by which sections are found; empty where they are not.
#[derive(Clone, Debug, Default)]
pub struct FindNodes {
    /// One for each section datum that is found, in the order of the plan.
    pub data: Vec<Vec<InputNode>>,
    /// One for each condition.
    pub conditions: Vec<Vec<InputNode>>,
    pub prefer: Vec<InputNode>,
}

#[derive(Clone, Debug)]
pub struct Node {
    pub operation: Operation,
    pub inputs: Vec<NodeId>,
    pub dimension: Dimension,
    /// Whether it is computed from the track record.
    pub track: bool,
    /// The first rule that needed it.
    pub from: Span,
    pub label: Label,
    /// Nodes with the same operation at different positions have the same class. They are drawn as
    /// one box.
    pub class: usize,
}

/// What a node does, in words.
#[derive(Clone, Debug)]
pub struct Label {
    /// `low-pass 20 Hz, order 4, zero-phase, as-applied`
    pub text: String,
    /// What a drawing shows where it draws several nodes as one box: the quantity, and what is done
    /// at any position.
    pub subject: Option<String>,
    pub what: String,
}

impl From<String> for Label {
    fn from(text: String) -> Self {
        Self { what: text.clone(), subject: None, text }
    }
}

impl Label {
    /// What is done for a quantity.
    pub fn of(quantity: &str, what: String) -> Self {
        Self { text: format!("{quantity}: {what}"), subject: Some(quantity.to_owned()), what }
    }
}

#[derive(Clone, Debug)]
pub enum Operation {
    Read {
        column: String,
    },
    /// A number that is constant along the record.
    Constant(Expr),
    Arithmetic(Operator),
    Negative,
    /// A constant power, or the value in a table.
    Mapped(Mapping),
    Apply(&'static Function),
    /// Shifted, differentiated or integrated along the axis.
    OverAxis(AxisOperation),
    /// A number of the section, all along the record.
    Level,
    /// The first input whose condition on the section holds, else the last.
    Select(Vec<Expr>),
    /// For each sample the first input whose condition holds, else one that follows them without a
    /// condition; none where there is no such one. The conditions, 1 where they hold and else 0,
    /// are the last inputs: so many.
    Choose(usize),
    /// Leaves out the samples that there are not.
    Present,
    /// A step over the whole record.
    Step(StepSpec),
    /// The samples of the section.
    Cut,
    /// A step inside the section.
    Window(StepSpec),
    /// A signal with samples of its own, from those of the section.
    OfSection(SectionOperation),
    /// A value of a signal; for a slope, the second input can replace the axis.
    Reduce(Reducer),
    /// A number of one record, computed from values of signals.
    Value(Arc<Expr>),
    /// Rows of the table of values: of single records, or of compared records.
    Compare(Arc<Evaluation>),
    /// The estimate of a limit, for each group of rows.
    Estimate(Arc<Limit>),
    /// An estimate without a limit, for each group of rows.
    Report(Arc<Report>),
    /// Compares estimates with their limit, for each group of rows.
    Limit(Arc<Limit>),
    /// From limits, from other verdicts, or by a person.
    Verdict(Arc<Decision>),
}

impl Operation {
    /// The stage it belongs to, in the order of execution.
    pub fn stage(&self) -> Stage {
        match self {
            Self::Read { .. } => Stage::Read,
            Self::Constant(_)
            | Self::Arithmetic(_)
            | Self::Negative
            | Self::Mapped(_)
            | Self::Apply(_)
            | Self::OverAxis(_)
            | Self::Level
            | Self::Select(_)
            | Self::Choose(_) => Stage::Derive,
            Self::Step(_) => Stage::Filter,
            Self::Window(_) | Self::OfSection(_) => Stage::Window,
            Self::Cut | Self::Present => Stage::Cut,
            Self::Reduce(_) | Self::Value(_) => Stage::Process,
            Self::Compare(_) => Stage::Compare,
            Self::Estimate(_) | Self::Report(_) => Stage::Estimate,
            Self::Limit(_) => Stage::Limit,
            Self::Verdict(_) => Stage::Verdict,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    Read,
    Derive,
    Filter,
    Window,
    Cut,
    Process,
    Compare,
    Estimate,
    Limit,
    Verdict,
}

impl Stage {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Derive => "derive",
            Self::Filter => "filter",
            Self::Window => "window",
            Self::Cut => "cut",
            Self::Process => "process",
            Self::Compare => "compare",
            Self::Estimate => "estimate",
            Self::Limit => "limit",
            Self::Verdict => "verdict",
        }
    }
}

/// The nodes of one quantity.
#[derive(Clone, Debug)]
pub struct QuantityNodes {
    /// One for each position of the quantity.
    pub signals: Vec<SignalNodes>,
    /// One for each limit of the quantity.
    pub limits: Vec<LimitNodes>,
    /// One for each report of the quantity.
    pub reports: Vec<NodeId>,
}

#[derive(Clone, Copy, Debug)]
pub struct LimitNodes {
    pub estimate: NodeId,
    pub limit: NodeId,
}

#[derive(Clone, Debug)]
pub struct SignalNodes {
    /// The processed signal of the section.
    pub processed: NodeId,
    /// The filtered but uncut signal, for plots. `None` where the chain resamples.
    pub filtered: NodeId,
    /// One for each value of the quantity; empty for a metric or an expression of metrics.
    pub values: Vec<ValueNodes>,
    /// The processed signal that a metric uses in place of the axis.
    pub over: Option<NodeId>,
    /// The inputs of an expression of metrics.
    pub inputs: Vec<InputNode>,
    pub compare: NodeId,
}

#[derive(Clone, Debug)]
pub struct ValueNodes {
    /// The node of the value, or of the reduced signal if the value is just that.
    pub node: NodeId,
    pub inputs: Vec<InputNode>,
}

/// The nodes of one plausibility rule.
#[derive(Clone, Debug)]
pub struct PlausibilityNodes {
    /// One for each signal of the rule; a single one where it has no signal.
    pub positions: Vec<PositionNodes>,
}

#[derive(Clone, Debug)]
pub struct PositionNodes {
    /// The rule's own signal, processed, where it has one.
    pub own: Option<NodeId>,
    pub inputs: Vec<InputNode>,
}

#[derive(Clone, Debug)]
pub struct InputNode {
    /// A value, or the signal of both sides from which a value is taken.
    pub node: NodeId,
    pub side: InputSide,
    /// Whether it is taken at the other positions of the rule.
    pub siblings: bool,
    pub joint: Option<Joint>,
}

impl InputNode {
    /// The nodes whose values it needs.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        let over = if let Some(Joint::Metric { over, .. }) = &self.joint { *over } else { None };
        std::iter::once(self.node).chain(over)
    }
}

/// How a value is taken from the signals of both sides.
#[derive(Clone, Debug)]
pub enum Joint {
    Metric {
        metric: Metric,
        /// Whether the simulated signal is interpolated at the points of the measured one.
        on_common_points: bool,
        over: Option<NodeId>,
    },
    /// From an expression over the samples of both sides.
    Samples { reducer: Reducer, signal: Arc<Expr> },
}
