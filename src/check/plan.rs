//! The checked protocol: every name resolved, every number SI, every dimension right, parameters put in.

use std::ops::Deref;
use std::sync::Arc;

use crate::catalog::{Function, Metric, Reducer, Statistic};
use crate::metrics::filter::{Band, Cutoff, Phase};
use crate::metrics::percentile::Method;
use crate::metrics::window::Ends;
use crate::source::Span;
use crate::units::{Dimension, Unit};

#[derive(Clone, Debug)]
pub struct Plan {
    pub name: String,
    pub title: String,
    pub edition: Option<String>,
    pub source: Option<String>,
    pub scope: Option<String>,
    pub notes: Vec<String>,
    pub axis: Axis,
    pub time: Option<Axis>,
    pub parameters: Vec<Parameter>,
    pub vehicle: Vec<Datum>,
    pub columns: Vec<Datum>,
    pub filters: Vec<NamedFilter>,
    pub zones: Vec<Zone>,
    pub checks: Vec<Check>,
    pub sections: SectionRules,
    pub quantities: Vec<Quantity>,
    pub verdict: VerdictRule,
}

/// A column that records run along.
#[derive(Clone, Debug)]
pub struct Axis {
    pub column: String,
    pub unit: Unit,
}

#[derive(Clone, Debug)]
pub struct Parameter {
    pub name: String,
    pub title: String,
    pub value: String,
    pub default: String,
    pub set_by: SetBy,
    /// Its words, where it is a choice of words.
    pub choices: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetBy {
    Default,
    Campaign,
    CommandLine,
}

/// A value that the vehicle file or the table of sections must hold.
#[derive(Clone, Debug)]
pub struct Datum {
    pub name: String,
    pub title: String,
    /// Path in the vehicle file, or column header without its unit.
    pub key: String,
    pub kind: DatumKind,
    pub default: Option<Scalar>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum DatumKind {
    Number(Unit),
    Words(Vec<String>),
    Flag,
}

/// A value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// In SI.
    Number(f64),
    Word(String),
    Flag(bool),
}

#[derive(Clone, Debug)]
pub struct NamedFilter {
    pub name: String,
    pub title: String,
    pub steps: Vec<Step>,
    pub source: Option<String>,
}

/// Where an expression was written, and its words: in YAML the place of a part of a field is not always known, its words are.
#[derive(Clone, Debug)]
pub struct Origin {
    pub span: Span,
    pub words: Arc<str>,
}

impl Deref for Origin {
    type Target = Span;
    fn deref(&self) -> &Span {
        &self.span
    }
}

/// A typed expression over numbers, words and conditions.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: Kind,
    pub ty: Type,
    pub span: Origin,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    Number(Dimension),
    /// One of these words; empty for a word that stands by itself.
    Word(Vec<String>),
    Flag,
}

#[derive(Clone, Debug)]
pub enum Kind {
    Constant(Scalar),
    /// Index into [`Plan::vehicle`].
    Vehicle(usize),
    /// Index into [`Plan::columns`].
    Column(usize),
    /// Start, end or length of the section on the axis.
    Start,
    End,
    /// A reduced signal: index into the list of inputs that stands beside the expression.
    Input(usize),
    Simulated,
    Measured,
    /// The limit of another statistic of the same quantity and scope.
    LimitOf(String),
    Negative(Box<Expr>),
    Not(Box<Expr>),
    Power(Box<Expr>, i8),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Call(&'static Function, Vec<Expr>),
    /// The first whose condition holds, else the last.
    Cases(Vec<(Expr, Expr)>, Option<Box<Expr>>),
}

pub use crate::syntax::phrase::Operator;

/// A signal expression: what a channel of one position is computed from.
#[derive(Clone, Debug)]
pub struct Signal {
    pub kind: SignalKind,
    pub dimension: Dimension,
    /// Whether it comes from the track record.
    pub track: bool,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum SignalKind {
    /// A column of the records, and the channel it is a position of.
    Column {
        column: String,
        channel: String,
    },
    /// A number that does not change along the record.
    Scalar(Expr),
    Binary(Operator, Box<Signal>, Box<Signal>),
    Negative(Box<Signal>),
    Power(Box<Signal>, i8),
    Call(&'static Function, Vec<Signal>),
    Filtered(Box<Signal>, Vec<Step>),
    /// The first whose condition on the section holds.
    Select(Vec<(Expr, Signal)>, Option<Box<Signal>>),
}

#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepSpec,
    /// As printed: `low-pass 20 Hz, order 4, zero-phase, as-applied`.
    pub words: String,
    /// Whether its frequencies are cycles per length, so that it can only follow a resampling over a length.
    pub per_length: bool,
    pub span: Span,
}

/// Numbers in SI; a length or time step says which axis it runs over.
#[derive(Clone, Debug, PartialEq)]
pub enum StepSpec {
    Butterworth { band: Band, order: usize, phase: Phase, cutoff: Cutoff },
    Window { rms: bool, width: f64, step: f64, over_time: bool, ends: Ends },
    Resample { step: f64, over_time: bool },
    RemoveMean,
    Magnitude,
}

#[derive(Clone, Debug)]
pub struct Zone {
    pub name: String,
    pub title: String,
    pub condition: Option<Expr>,
    pub condition_words: String,
    pub minimum_sections: usize,
    pub minimum_length: Option<Expr>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Check {
    pub name: String,
    pub title: String,
    pub require: Expr,
    pub inputs: Vec<Input>,
    pub unless: Option<Expr>,
    pub words: String,
    pub otherwise: OnFault,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFault {
    NotUsed,
    Note,
    Stop,
}

#[derive(Clone, Debug)]
pub struct SectionRules {
    pub whole_records: bool,
    /// Index of the column with the zone.
    pub zone: Option<usize>,
    pub only: Option<Expr>,
    pub only_words: String,
    pub faulty: OnFault,
    pub minimum: usize,
    pub percentiles: Method,
}

/// A reducer of a signal that an expression uses.
#[derive(Clone, Debug)]
pub struct Input {
    pub reducer: Reducer,
    /// `None`: the quantity's own processed signal.
    pub signal: Option<Signal>,
    pub side: InputSide,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputSide {
    /// The side that the expression is evaluated for.
    Own,
    Simulated,
    Measured,
}

#[derive(Clone, Debug)]
pub struct Quantity {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub words: QuantityWords,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    /// Unit in which values are printed.
    pub unit: Unit,
    /// Unit in which its signals are plotted.
    pub signal_unit: Unit,
    /// Each position with the name of its signal.
    pub signals: Vec<(String, Signal)>,
    pub chain: Vec<Step>,
    pub evaluation: Evaluation,
    pub only: Option<Expr>,
    pub limits: Vec<Limit>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    pub span: Span,
}

/// The quantity's rules as printed.
#[derive(Clone, Debug)]
pub struct QuantityWords {
    pub of: String,
    pub filter: String,
    pub processing: String,
    pub comparison: String,
}

#[derive(Clone, Debug)]
pub enum Evaluation {
    /// A number of each side, then their difference.
    Sides { value: Expr, inputs: Vec<Input>, difference: Expr },
    /// One number of the two signals; `over` is the other signal its wording names, one for each position, with its name and unit.
    Metric { metric: Metric, over: Vec<Signal>, over_axis: Option<Axis> },
}

#[derive(Clone, Debug)]
pub struct Limit {
    pub statistic: Statistic,
    pub ddof: usize,
    pub at_least: bool,
    pub bound: Expr,
    /// Factor and when it applies.
    pub factors: Vec<(Expr, Expr)>,
    pub only_when: Option<Expr>,
    pub scope: Scope,
    /// As written: `2/3 of std`.
    pub words: String,
    pub span: Span,
}

/// Which pairs a limit is about. A limit `for each zone` is one limit for every zone.
#[derive(Clone, Debug)]
pub enum Scope {
    All,
    Zones(Vec<String>),
    Where(Box<Expr>, String),
}

#[derive(Clone, Debug)]
pub struct VerdictRule {
    pub rule: Rule,
    pub words: String,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    EveryLimit,
    AtLeastQuantities(usize),
    AtLeastLimits(usize),
}
