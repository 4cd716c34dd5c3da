//! Computed signals.

use super::{Expr, Operator, Side, Step};
use crate::catalog::{Function, Reducer};
use crate::source::Span;
use crate::units::{Dimension, Unit};

/// A signal expression: how the signal of one position is computed from channels.
#[derive(Clone, Debug)]
pub struct Signal {
    pub kind: SignalKind,
    pub dimension: Dimension,
    /// Whether it is read from the track record.
    pub track: bool,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum SignalKind {
    /// A column of the records, with the channel it belongs to.
    Column {
        column: String,
        channel: String,
        /// The unit that the protocol declares.
        unit: Unit,
    },
    /// A number that is constant along the record.
    Scalar(Expr),
    Binary(Operator, Box<Signal>, Box<Signal>),
    Negative(Box<Signal>),
    Power(Box<Signal>, i8),
    Call(&'static Function, Vec<Signal>),
    Filtered(Box<Signal>, Vec<Step>),
    OverAxis(AxisOperation, Box<Signal>),
    /// The number of a section that is taken from a signal, the same all along: `Y - mean of Y`.
    Level(Reducer, Box<Signal>),
    /// The own processed signal of this side, at the points where both sides have one. Only in
    /// values taken from both sides.
    Side(Side),
    /// The signal of the first condition on the section that holds.
    Select(Vec<(Expr, Signal)>, Option<Box<Signal>>),
}

/// An operation on a signal along its axis.
#[derive(Clone, Debug)]
pub enum AxisOperation {
    /// Shifted forward by this distance.
    Shifted(Expr),
    Derivative {
        over_time: bool,
    },
    Integral {
        over_time: bool,
    },
}
