//! The processing graph: typed operations from channels to the verdicts, common parts once, each knowing the line it came from.
//!
//! Nodes up to [`Operation::Value`] work on one record and run once for each; [`Operation::Compare`] makes the rows of the table of
//! values, of one record or of several; what follows works on groups of rows. Inputs always have a smaller number than the node, so the
//! order of the nodes is an order to run them in, and there can be no cycle.

mod build;
mod draw;
mod print;

pub use build::from_plan;
pub use draw::svg;
pub use print::{dot, json, text};

use std::sync::Arc;

use crate::catalog::{Function, Metric, Reducer};
use crate::check::plan::{AxisOperation, Decision, Evaluation, Expr, InputSide, Limit, Operator, Signal, StepSpec};
use crate::source::Span;
use crate::units::Dimension;

pub type NodeId = usize;

#[derive(Clone, Debug)]
pub struct Graph {
    pub nodes: Vec<Node>,
    pub quantities: Vec<QuantityNodes>,
    /// One per section check of the plan.
    pub checks: Vec<Vec<InputNode>>,
    /// One per plausibility rule of the plan.
    pub plausibility: Vec<PlausibilityNodes>,
    /// One per verdict of the plan, the overall one first.
    pub verdicts: Vec<NodeId>,
}

#[derive(Clone, Debug)]
pub struct Node {
    pub operation: Operation,
    pub inputs: Vec<NodeId>,
    pub dimension: Dimension,
    /// Whether it works on the track record.
    pub track: bool,
    /// The rule it came from first.
    pub from: Span,
    /// In words: `low-pass 20 Hz, order 4, zero-phase, as-applied`.
    pub label: String,
    /// Nodes that do the same at different positions share this number: they are drawn as one box.
    pub class: usize,
}

#[derive(Clone, Debug)]
pub enum Operation {
    Read {
        column: String,
    },
    /// A number along the record.
    Constant(Expr),
    Arithmetic(Operator),
    Negative,
    Power(i8),
    Apply(&'static Function),
    /// Moved, derived or integrated along the axis.
    OverAxis(AxisOperation),
    /// The first input whose condition on the section holds, else the last.
    Select(Vec<Expr>),
    /// A step over the whole record.
    Step(StepSpec),
    /// The samples of the section.
    Cut,
    /// A step inside the section.
    Window(StepSpec),
    /// A number from a signal; a slope over a second one, where there is one.
    Reduce(Reducer),
    /// A number of one record from reduced signals.
    Value(Arc<Expr>),
    /// Rows of the table of values: of one record each, or of records compared.
    Compare(Arc<Evaluation>),
    /// What a limit is of, once for each group of rows.
    Estimate(Arc<Limit>),
    /// What was estimated against the limit, group by group.
    Limit(Arc<Limit>),
    /// From limits, from other verdicts, or by a person.
    Verdict(Arc<Decision>),
}

impl Operation {
    /// The stage it belongs to, in the order data passes them.
    pub fn stage(&self) -> Stage {
        match self {
            Self::Read { .. } => Stage::Read,
            Self::Constant(_)
            | Self::Arithmetic(_)
            | Self::Negative
            | Self::Power(_)
            | Self::Apply(_)
            | Self::OverAxis(_)
            | Self::Select(_) => Stage::Derive,
            Self::Step(_) => Stage::Filter,
            Self::Window(_) => Stage::Window,
            Self::Cut => Stage::Cut,
            Self::Reduce(_) | Self::Value(_) => Stage::Process,
            Self::Compare(_) => Stage::Compare,
            Self::Estimate(_) => Stage::Estimate,
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

/// Where the numbers of one quantity come from.
#[derive(Clone, Debug)]
pub struct QuantityNodes {
    /// One per position of the quantity.
    pub signals: Vec<SignalNodes>,
    /// One per limit of the quantity.
    pub limits: Vec<LimitNodes>,
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
    /// The same signal through the filters but not cut: what plots show. `None` where the chain resamples.
    pub filtered: NodeId,
    /// One per value of the quantity; none where a metric takes both signals, or an expression of metrics.
    pub values: Vec<ValueNodes>,
    /// The signal a metric runs over, processed.
    pub over: Option<NodeId>,
    /// What the expression of a metric is made of.
    pub inputs: Vec<InputNode>,
    pub compare: NodeId,
}

#[derive(Clone, Debug)]
pub struct ValueNodes {
    /// The value, or the reduced signal that it is.
    pub node: NodeId,
    pub inputs: Vec<InputNode>,
}

/// Where the numbers of one plausibility rule come from.
#[derive(Clone, Debug)]
pub struct PlausibilityNodes {
    /// One per signal of the rule; a single one where it has none.
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
    /// A number, or the signal of both sides that a number is taken from.
    pub node: NodeId,
    pub side: InputSide,
    pub joint: Option<Joint>,
}

impl InputNode {
    /// The nodes whose values it needs.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        let over = if let Some(Joint::Metric { over, .. }) = &self.joint { *over } else { None };
        std::iter::once(self.node).chain(over)
    }
}

/// How a number is taken from the signals of both sides.
#[derive(Clone, Debug)]
pub enum Joint {
    Metric {
        metric: Metric,
        /// Whether the simulated signal is brought onto the points of the measured one.
        on_common_points: bool,
        over: Option<NodeId>,
    },
    /// From an expression over the samples of both.
    Samples { reducer: Reducer, signal: Arc<Signal> },
}
