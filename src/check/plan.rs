//! The checked protocol: every name resolved, every number SI, every dimension right, parameters put in.

use std::ops::Deref;
use std::sync::Arc;

use crate::catalog::{Function, Metric, Reducer, Statistic};
use crate::metrics::filter::{Band, Cutoff, Phase, TransferFunction, Warping};
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
    pub plausibility: Vec<Plausibility>,
    pub sections: SectionRules,
    pub quantities: Vec<Quantity>,
    pub independent: Independent,
    /// The overall one first, the others as they are written.
    pub verdicts: Vec<VerdictRule>,
}

impl Plan {
    /// Whether some quantity needs records of this side.
    pub fn reads(&self, side: Side) -> bool {
        self.quantities.iter().any(|quantity| quantity.evaluation.reads(side))
    }

    /// The verdict of the protocol as a whole: the one without a name, or the first.
    pub fn overall(&self) -> &VerdictRule {
        &self.verdicts[0]
    }

    /// The same rules, with findings that are told and change nothing: for who asks what is wrong, and not whether it may be used.
    #[must_use]
    pub fn only_telling(&self) -> Self {
        let mut plan = self.clone();
        plan.plausibility.iter_mut().for_each(|rule| rule.otherwise = OnFault::Note);
        plan
    }
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
    /// The vehicle file may be without it; rules that depend on it are then decided as far as they hold whatever its value.
    pub may_be_absent: bool,
    /// What a number may be; none where the protocol does not say.
    pub range: Option<DatumRange>,
    pub span: Span,
}

/// The least and the largest value of a datum, both allowed.
#[derive(Clone, Debug)]
pub struct DatumRange {
    /// In SI.
    pub low: f64,
    /// In SI.
    pub high: f64,
    /// As written: `10 kN to 200 kN`.
    pub words: String,
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
    /// A reduced signal, or a number taken from a group: index into the list that stands beside the expression.
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

impl Expr {
    /// Shows every part, the whole first.
    pub fn visit(&self, see: &mut impl FnMut(&Expr)) {
        see(self);
        match &self.kind {
            Kind::Negative(inner) | Kind::Not(inner) | Kind::Power(inner, _) => inner.visit(see),
            Kind::Binary(_, left, right) => {
                left.visit(see);
                right.visit(see);
            }
            Kind::Call(_, arguments) => arguments.iter().for_each(|argument| argument.visit(see)),
            Kind::Cases(arms, otherwise) => {
                for (value, condition) in arms {
                    value.visit(see);
                    condition.visit(see);
                }
                if let Some(value) = otherwise {
                    value.visit(see);
                }
            }
            _ => {}
        }
    }
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
    OverAxis(AxisOperation, Box<Signal>),
    /// The own processed signal of this side, on the points at which both sides have one. Only in what is taken from both sides.
    Side(Side),
    /// The first whose condition on the section holds.
    Select(Vec<(Expr, Signal)>, Option<Box<Signal>>),
}

/// An operation on a signal along its axis.
#[derive(Clone, Debug)]
pub enum AxisOperation {
    /// Forward by this distance.
    Shifted(Expr),
    Derivative {
        over_time: bool,
    },
    Integral {
        over_time: bool,
    },
}

#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepSpec,
    /// As printed: `low-pass 20 Hz, order 4, zero-phase, as-applied`.
    pub words: String,
    /// Whether its frequencies are cycles per length, so that it can only follow a resampling over a length.
    pub per_length: bool,
    /// Of what comes out over what goes in.
    pub factor: Dimension,
    pub span: Span,
}

/// Numbers in SI; a length or time step says which axis it runs over.
#[derive(Clone, Debug, PartialEq)]
pub enum StepSpec {
    Butterworth { band: Band, order: usize, phase: Phase, cutoff: Cutoff },
    Transfer { function: TransferFunction, phase: Phase, warping: Warping },
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
    /// The campaign is not assessable. Only of a plausibility rule.
    NotAssessable,
}

/// What sound data satisfy, looked at in every section and at every position. What does not is told as a finding.
///
/// A block with several fields `of` is one rule for each of them.
#[derive(Clone, Debug)]
pub struct Plausibility {
    pub name: String,
    pub title: String,
    /// Each position with the name of its signal; empty where the rule is about data or named signals alone.
    pub signals: Vec<(String, Signal)>,
    pub chain: Vec<Step>,
    pub test: Test,
    pub unless: Option<Expr>,
    pub otherwise: OnFault,
    pub cause: Option<String>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Test {
    Require(Box<Requirement>),
    Distinct(Distinct),
}

/// A condition on data and reduced signals.
#[derive(Clone, Debug)]
pub struct Requirement {
    pub holds: Expr,
    pub inputs: Vec<Input>,
    pub of: Looks,
    /// Where the condition is one comparison: what is compared with what, and the unit both are printed in.
    pub compared: Option<(Expr, Expr, Unit)>,
    pub words: String,
}

/// Which record a requirement looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looks {
    /// Section and vehicle data alone.
    Data,
    Track,
    /// Simulation and measurement, each by itself.
    EachSide,
    /// Both at once: metrics, `simulated(...)`, `measured(...)`.
    BothSides,
}

/// Among what no two signals may be the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Distinct {
    /// Channels of one record.
    pub channels: bool,
    /// One channel in several sections.
    pub sections: bool,
    /// Simulation and measurement.
    pub sides: bool,
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

/// A number taken from signals that an expression uses.
#[derive(Clone, Debug)]
pub struct Input {
    pub taken: Taken,
    /// `None`: the quantity's own processed signal.
    pub signal: Option<Signal>,
    /// The signal that a slope or a metric runs over, in place of the axis.
    pub over: Option<Signal>,
    pub side: InputSide,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// From the signal of one side.
    Reduced(Reducer),
    /// From the simulated and the measured signal.
    Compared(Metric),
    /// From an expression over the samples of both.
    OfBoth(Reducer),
}

impl Taken {
    /// Whether it is taken from samples on common points, which are not there after a window or resampling.
    pub fn needs_samples(self) -> bool {
        match self {
            Self::Reduced(_) => false,
            Self::Compared(metric) => metric.on_common_points(false),
            Self::OfBoth(_) => true,
        }
    }

    pub fn gives(self, signal: Dimension, axis: Dimension) -> Dimension {
        match self {
            Self::Reduced(reducer) | Self::OfBoth(reducer) => reducer.gives(signal, axis),
            Self::Compared(metric) => (metric.0.gives)(signal, axis),
        }
    }
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
    pub positions: Vec<Position>,
    pub chain: Vec<Step>,
    pub evaluation: Arc<Evaluation>,
    pub only: Option<Expr>,
    pub limits: Vec<Arc<Limit>>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    pub span: Span,
}

impl Quantity {
    /// Whether the samples of the record are still there after its filter.
    pub fn keeps_samples(&self) -> bool {
        self.chain.iter().all(|step| step.kind.keeps_samples())
    }
}

/// The quantity's rules as printed.
#[derive(Clone, Debug)]
pub struct QuantityWords {
    pub of: String,
    pub filter: String,
    pub processing: String,
    pub comparison: String,
}

/// A signal at one position of a quantity.
#[derive(Clone, Debug)]
pub struct Position {
    /// As printed: `Y_1R`.
    pub name: String,
    pub signal: Signal,
    /// Each place with its member: `wheelset` `1`.
    pub places: Vec<(String, String)>,
    /// In which sections it is evaluated.
    pub only: Option<Expr>,
}

/// What the rows of the table of values are.
#[derive(Clone, Debug)]
pub enum Evaluation {
    /// Numbers of each record, by themselves or compared.
    Values { values: Vec<Valued>, records: Records },
    /// One number of the two signals; `over` is the other signal its wording names, one for each position, with its name and unit.
    /// With `repeats`, of a repeated section and its original.
    Metric { metric: Metric, over: Vec<Signal>, over_axis: Option<Axis>, repeats: bool },
    /// One number of metrics, of numbers of one side, and of numbers of both sides' samples; `repeats` as of a metric.
    Combined { of: Valued, repeats: bool },
}

/// A number of one record.
#[derive(Clone, Debug)]
pub struct Valued {
    pub expr: Expr,
    /// For each position of the quantity: a named signal is that of the same wheelset or side.
    pub inputs: Vec<Vec<Input>>,
}

/// Which records give the rows.
#[derive(Clone, Debug)]
pub enum Records {
    /// One row for each record of this side: an assessment.
    Of(Side),
    /// One row for each simulated and measured record of a section.
    Compared { difference: Expr },
    /// One row for each record of this side, compared with what is central of all of them.
    Spread { side: Side, center: Center, difference: Expr },
    /// One row for each measured record of a section that repeats another, compared with that of its original, which stands in the place of
    /// the measurement.
    Repeats { difference: Expr },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Simulated,
    Measured,
}

impl Side {
    pub const ALL: [Self; 2] = [Self::Simulated, Self::Measured];

    pub fn in_words(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Measured => "measured",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    Mean,
    Median,
}

impl Evaluation {
    /// Whether records of this side are needed.
    pub fn reads(&self, side: Side) -> bool {
        match self {
            Self::Values { records: Records::Of(of) | Records::Spread { side: of, .. }, .. } => *of == side,
            Self::Values { records: Records::Compared { .. }, .. } => true,
            Self::Values { records: Records::Repeats { .. }, .. } => side == Side::Measured,
            Self::Metric { repeats, .. } | Self::Combined { repeats, .. } => !repeats || side == Side::Measured,
        }
    }

    /// The words of one of several values.
    pub fn value_in_words(&self, which: usize) -> Option<String> {
        match self {
            Self::Values { values, .. } if values.len() > 1 => {
                // Without the case that it applies in.
                let words = &values.get(which)?.expr.span.words;
                Some(words.split_once(" when ").map_or(words.as_ref(), |(value, _)| value).to_string())
            }
            _ => None,
        }
    }

    /// Whether rows are values of one record, compared with no other.
    pub fn assesses(&self) -> bool {
        matches!(self, Self::Values { records: Records::Of(_), .. })
    }

    /// Whether rows have two sides and a difference.
    pub fn has_sides(&self) -> bool {
        matches!(self, Self::Values { records: Records::Compared { .. } | Records::Spread { .. } | Records::Repeats { .. }, .. })
    }

    /// Whether repeats of sections are compared with their originals.
    pub fn of_repeats(&self) -> bool {
        matches!(
            self,
            Self::Values { records: Records::Repeats { .. }, .. }
                | Self::Metric { repeats: true, .. }
                | Self::Combined { repeats: true, .. }
        )
    }
}

#[derive(Clone, Debug)]
pub struct Limit {
    pub estimate: Estimate,
    pub at_least: bool,
    pub bound: OfGroup,
    /// Factor and when it applies.
    pub factors: Vec<(Expr, Expr)>,
    pub only_when: Option<Expr>,
    pub scope: Scope,
    /// As written: `2/3 of std`.
    pub words: String,
    pub span: Span,
}

/// What is estimated from the rows of a group.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// As in result files: `mean`, `p95`, the name of an estimate, or an expression as written.
    pub name: String,
    /// As printed: `standard deviation (n-1)`.
    pub title: String,
    pub kind: EstimateKind,
    /// Tells how far values differ from each other, so that 0 is best whatever they are.
    pub of_scatter: bool,
    /// In which it is printed, where that is not the unit of the values: of a share, of a length.
    pub unit: Option<Unit>,
}

#[derive(Clone, Debug)]
pub enum EstimateKind {
    /// Every value by itself: the worst decides.
    Each,
    Of(Box<OfGroup>),
}

impl Estimate {
    /// As [`OfGroup::others`].
    pub fn others(&self) -> Vec<usize> {
        if let EstimateKind::Of(of) = &self.kind { of.others() } else { Vec::new() }
    }

    /// The statistic that it is and nothing more, with the divisor's n - `ddof`.
    pub fn statistic(&self) -> Option<(Statistic, usize)> {
        match &self.kind {
            EstimateKind::Each => Some((Statistic::Each, 0)),
            EstimateKind::Of(of) => match (&of.expr.kind, of.taken.as_slice()) {
                (Kind::Input(0), [Taking::Statistic(statistic, ddof)]) => Some((*statistic, *ddof)),
                _ => None,
            },
        }
    }
}

/// An expression over what is taken from the rows of a group; [`Kind::Input`] is an index into `taken`.
#[derive(Clone, Debug)]
pub struct OfGroup {
    pub expr: Expr,
    pub taken: Vec<Taking>,
}

impl OfGroup {
    /// The quantities whose rows it needs beside those of the group.
    pub fn others(&self) -> Vec<usize> {
        fn of(taking: &Taking) -> Vec<usize> {
            match taking {
                Taking::Other { quantity, .. } => vec![*quantity],
                Taking::Share { others, .. } => others.iter().flat_map(of).collect(),
                Taking::Bound { of, .. } => of.others(),
                Taking::Fit(fit) => fit.at.iter().flat_map(OfGroup::others).collect(),
                Taking::Statistic(..) | Taking::Count | Taking::Data { .. } => Vec::new(),
            }
        }
        self.taken.iter().flat_map(of).collect()
    }
}

/// A number taken from the rows of a group.
#[derive(Clone, Debug)]
pub enum Taking {
    /// Of the values, with the divisor's n - `ddof`.
    Statistic(Statistic, usize),
    /// Number of units that are independent of each other.
    Count,
    /// An end of the confidence interval of an estimate.
    Bound {
        of: Estimate,
        upper: bool,
        confidence: f64,
        bootstrap: bool,
    },
    /// Part of the rows, or of the sections, that satisfy a condition; [`Kind::Input`] 0 is the value of a row.
    /// Beside it `others`, inputs from 1 on: estimates of other quantities.
    Share {
        condition: Expr,
        of_sections: bool,
        others: Vec<Taking>,
    },
    /// A statistic of all rows of another quantity, an index into [`Plan::quantities`].
    Other {
        quantity: usize,
        id: String,
        statistic: Statistic,
        ddof: usize,
    },
    /// Of data of the group's sections, each section once.
    Data {
        reducer: DataReducer,
        of: Expr,
    },
    Fit(Box<Fit>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DataReducer {
    Total,
    Statistic(Statistic, usize),
}

/// A regression of the values over data of their sections.
#[derive(Clone, Debug)]
pub struct Fit {
    /// A bound is one of a further value; else of the mean of values.
    pub prediction: bool,
    pub over: Vec<Expr>,
    pub at: Vec<OfGroup>,
    /// Without one, the fitted value itself.
    pub confidence: Option<f64>,
    pub one_sided: bool,
    pub lower: bool,
}

/// Which rows a limit is about, and how they are grouped. A limit `for each zone` is one limit for every zone.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Only rows of these zones; of all where there are none.
    pub zones: Vec<String>,
    pub each: Vec<Key>,
    pub condition: Option<(Expr, String)>,
}

impl Scope {
    pub fn is_all(&self) -> bool {
        self.zones.is_empty() && self.each.is_empty() && self.condition.is_none()
    }

    /// Whether both are about the same rows, grouped alike.
    pub fn same(&self, other: &Self) -> bool {
        let words = |scope: &Self| scope.condition.as_ref().map(|(_, words)| words.clone());
        self.zones == other.zones && self.each == other.each && words(self) == words(other)
    }
}

/// By what rows are grouped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Key {
    Section,
    Site,
    /// The record, where a side has several.
    Record,
    Place(String),
    /// Index into [`Plan::columns`].
    Column(usize),
}

/// What is independent of each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Independent {
    #[default]
    Site,
    Section,
    /// Index into [`Plan::columns`].
    Column(usize),
}

/// A verdict: what decides it, and in which words.
#[derive(Clone, Debug)]
pub struct VerdictRule {
    /// `None` for the verdict without a name, which is then the overall one.
    pub name: Option<String>,
    pub title: String,
    pub decision: Decision,
    /// If it holds, and if it does not.
    pub words: [String; 2],
    /// Whether the protocol states the words.
    pub own_words: bool,
    /// `validated when every limit holds`
    pub criterion: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Decision {
    /// By the limits of some quantities, by index.
    Limits { rule: Rule, quantities: Vec<usize> },
    /// By other verdicts.
    Verdicts(Over),
    /// By a person, named here.
    Person(String),
}

/// A condition on other verdicts, by their index in [`Plan::verdicts`].
#[derive(Clone, Debug)]
pub enum Over {
    Holds(usize),
    /// Both hold, or neither does.
    Same(usize, usize),
    AtLeast(usize, Vec<usize>),
    Not(Box<Over>),
    All(Vec<Over>),
    Any(Vec<Over>),
}

impl Over {
    /// The verdicts that it is about, each once.
    pub fn verdicts(&self) -> Vec<usize> {
        let all = match self {
            Self::Holds(one) => vec![*one],
            Self::Same(one, other) => vec![*one, *other],
            Self::AtLeast(_, of) => of.clone(),
            Self::Not(inner) => inner.verdicts(),
            Self::All(parts) | Self::Any(parts) => parts.iter().flat_map(Self::verdicts).collect(),
        };
        let mut once = Vec::new();
        for one in all {
            if !once.contains(&one) {
                once.push(one);
            }
        }
        once
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    EveryLimit,
    AtLeastQuantities(usize),
    AtLeastLimits(usize),
}
