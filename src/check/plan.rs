//! The checked protocol: names resolved, numbers in SI, dimensions checked, parameters inserted.

use std::ops::Deref;
use std::sync::Arc;

use crate::catalog::{Function, Metric, Reducer, Statistic};
use crate::metrics::filter::{Band, Cutoff, Phase, TransferFunction, Warping};
use crate::metrics::percentile::Method;
use crate::metrics::window::Ends;
use crate::result;
use crate::source::{Span, Spanned};
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
    /// Definitions and quantities with numbers that are to be confirmed against the standard, and why.
    pub unconfirmed: Vec<(String, String)>,
    pub vehicle: Vec<Datum>,
    pub columns: Vec<Datum>,
    /// Names of campaigns that conditions ask for, where they stand.
    pub campaigns: Vec<Spanned<String>>,
    pub records: Vec<DeclaredRecord>,
    pub filters: Vec<NamedFilter>,
    pub zones: Vec<Zone>,
    pub checks: Vec<Check>,
    pub plausibility: Vec<Plausibility>,
    pub sections: SectionRules,
    pub domains: Vec<Domain>,
    pub quantities: Vec<Quantity>,
    pub independent: Independent,
    /// The overall verdict first, the others in the order of the text.
    pub verdicts: Vec<VerdictRule>,
}

impl Plan {
    /// Whether a quantity needs records of this side.
    pub fn reads(&self, side: Side) -> bool {
        self.quantities.iter().any(|quantity| quantity.evaluation.reads(side))
    }

    /// What the protocol is about.
    pub fn kind(&self) -> result::Kind {
        result::Kind::of_all(self.quantities.iter().map(|quantity| quantity.evaluation.kind()))
    }

    /// The overall verdict in the protocol's own words, or in those of its kind.
    pub fn verdict_words(&self) -> result::VerdictWords {
        let rule = self.overall();
        if !rule.has_words() {
            return result::VerdictWords::of(self.kind());
        }
        let [good, bad] = rule.words.clone();
        result::VerdictWords { good, bad }
    }

    /// The verdict of the protocol as a whole: the one without a name, else the first.
    pub fn overall(&self) -> &VerdictRule {
        &self.verdicts[0]
    }

    /// The same plan, with all plausibility findings as notes: they are reported and exclude no section.
    #[must_use]
    pub fn only_telling(&self) -> Self {
        let mut plan = self.clone();
        plan.plausibility.iter_mut().for_each(|rule| rule.otherwise = OnFault::Note);
        plan
    }
}

/// A column that records are sampled along: distance or time.
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
    /// Why its value is to be confirmed against the standard.
    pub unconfirmed: Option<String>,
    /// The words of a choice; empty otherwise.
    pub choices: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetBy {
    Default,
    Campaign,
    CommandLine,
}

/// A value that the vehicle file or the table of sections must contain.
#[derive(Clone, Debug)]
pub struct Datum {
    pub name: String,
    pub title: String,
    /// Path in the vehicle file, or column header without unit.
    pub key: String,
    pub kind: DatumKind,
    pub default: Option<Scalar>,
    /// Whether the vehicle file may omit it. Rules that depend on it then apply as far as they hold for every value.
    pub may_be_absent: bool,
    /// Allowed values of a number; `None` where the protocol states none.
    pub range: Option<DatumRange>,
    pub span: Span,
}

/// The least and the greatest value of a datum, both allowed.
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
    /// The name of the section's campaign, which is not known before the run.
    Campaign,
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

/// Where an expression is written, and its words. In YAML, the place of a part of a field is not always known, but its words are.
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
    /// One of these words; empty for a word by itself.
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
    /// A value taken from a signal or from a group: index into the list stored with the expression.
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
    /// The value of the first condition that holds, else the last value.
    Cases(Vec<(Expr, Expr)>, Option<Box<Expr>>),
}

impl Expr {
    /// Visits every part, the whole expression first.
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
    /// The own processed signal of this side, at the points where both sides have one. Only in values taken from both sides.
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

#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepSpec,
    /// As printed: `low-pass 20 Hz, order 4, zero-phase, as-applied`.
    pub words: String,
    /// Whether its frequencies are in cycles per length, so that it must follow a resampling over a length.
    pub per_length: bool,
    /// Dimension of the output divided by that of the input.
    pub factor: Dimension,
    pub span: Span,
}

/// Steps with numbers in SI. A length or time step states the axis it is used over.
#[derive(Clone, Debug, PartialEq)]
pub enum StepSpec {
    Butterworth { band: Band, order: usize, phase: Phase, cutoff: Cutoff },
    Transfer { function: TransferFunction, phase: Phase, warping: Warping },
    Window { rms: bool, width: f64, step: f64, over_time: bool, ends: Ends, short_sections: bool },
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
    /// The campaign is not assessable. Only for plausibility rules or a domain.
    NotAssessable,
}

/// A condition that sound data satisfy, checked in every section and at every position. A violation is reported as a finding.
///
/// A block with several fields `of` gives one rule for each of them.
#[derive(Clone, Debug)]
pub struct Plausibility {
    pub name: String,
    pub title: String,
    /// Each position with the name of its signal; empty where the rule uses only data or named signals.
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

/// A condition on data and on values taken from signals.
#[derive(Clone, Debug)]
pub struct Requirement {
    pub holds: Expr,
    pub inputs: Vec<Input>,
    pub of: Looks,
    /// The two numbers compared and the unit in which both are printed, where the condition is one comparison.
    pub compared: Option<(Expr, Expr, Unit)>,
    pub words: String,
}

/// The records that a requirement uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looks {
    /// No record: section and vehicle data only.
    Data,
    Track,
    /// Simulation and measurement, each separately.
    EachSide,
    /// Both together: metrics, `simulated(...)`, `measured(...)`.
    BothSides,
}

/// Between which signals equality is reported.
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
    /// Index of the column of the zone.
    pub zone: Option<usize>,
    pub only: Option<Expr>,
    pub only_words: String,
    pub faulty: OnFault,
    pub minimum: usize,
    pub percentiles: Method,
}

/// What sections cover, and wanted operation is compared with.
#[derive(Clone, Debug)]
pub struct Domain {
    pub name: String,
    pub title: String,
    pub over: Vec<Coordinate>,
    /// Indices into [`Plan::columns`]: sections of other words are of another hull.
    pub each: Vec<usize>,
    /// Either a note, or not assessable.
    pub otherwise: OnFault,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    pub span: Span,
}

/// One of the numbers that span a domain.
#[derive(Clone, Debug)]
pub struct Coordinate {
    pub expr: Expr,
    /// As printed.
    pub name: String,
    pub unit: Unit,
}

/// A number that an expression takes from signals.
#[derive(Clone, Debug)]
pub struct Input {
    pub taken: Taken,
    /// `None`: the quantity's own processed signal.
    pub signal: Option<Signal>,
    /// Filters and windows that a named signal passes.
    pub chain: Vec<Step>,
    /// The signal that a slope or a metric uses in place of the axis.
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
    /// From an expression over the samples of both sides.
    OfBoth(Reducer),
}

impl Taken {
    /// Whether it needs samples at common points. These are not available after a window or resampling.
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
    /// Unit in which the values are printed.
    pub unit: Unit,
    /// Unit in which the signals are plotted.
    pub signal_unit: Unit,
    pub positions: Vec<Position>,
    pub chain: Vec<Step>,
    pub evaluation: Arc<Evaluation>,
    pub only: Option<Expr>,
    pub limits: Vec<Arc<Limit>>,
    pub minimum_signals: usize,
    pub minimum_pairs: usize,
    /// Pairs that groups of values need.
    pub minimum_of_groups: Vec<MinimumOfGroups>,
    pub span: Span,
}

/// How many pairs each group of some scope needs.
#[derive(Clone, Debug)]
pub struct MinimumOfGroups {
    pub needed: usize,
    pub scope: Scope,
}

impl Quantity {
    /// Whether the samples of the record are still available after the filter.
    pub fn keeps_samples(&self) -> bool {
        self.chain.iter().all(|step| step.kind.keeps_samples())
    }
}

/// The rules of the quantity, as printed.
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
    /// Each place with its member, such as `wheelset` and `1`.
    pub places: Vec<(String, String)>,
    /// The condition on the sections in which it is evaluated; `None` for all.
    pub only: Option<Expr>,
}

/// How the rows of the table of values are computed.
#[derive(Clone, Debug)]
pub enum Evaluation {
    /// Numbers of each record, assessed or compared.
    Values { values: Vec<Valued>, records: Records },
    /// One number of the two signals; `over` is the other signal its wording names, one for each position, with its name and unit.
    Metric { metric: Metric, over: Vec<Signal>, over_axis: Option<Axis>, pairing: Pairing },
    /// One number of metrics, of numbers of one side, and of numbers of both sides' samples.
    Combined { of: Valued, pairing: Pairing },
}

/// A number of one record.
#[derive(Clone, Debug)]
pub struct Valued {
    pub expr: Expr,
    /// For each position of the quantity: a named signal is taken at the same wheelset or side.
    pub inputs: Vec<Vec<Input>>,
}

/// The records that give the rows.
#[derive(Clone, Debug)]
pub enum Records {
    /// One row for each of these records: an assessment.
    Of(Chosen),
    /// One row for each pair of records.
    Compared { pairing: Pairing, difference: Expr },
    /// One row for each of these records, compared with what is central of others on the same side.
    Spread { of: Chosen, among: Chosen, center: Center, difference: Expr },
}

/// Records of one side: all that the campaign has, or those of a record of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chosen {
    pub side: Side,
    /// Index into [`Plan::records`].
    pub record: Option<usize>,
}

/// A record that the protocol declares.
#[derive(Clone, Debug)]
pub struct DeclaredRecord {
    pub name: String,
    pub title: String,
    pub side: Side,
    /// Names that the campaign gives to its records; all of the side where there are none.
    pub members: Vec<Spanned<String>>,
    pub span: Span,
}

/// Which records are compared. In a row the first stands in the place of the simulation, the second in that of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pairing {
    /// Each of the first with each of the second; a record is not compared with itself.
    Each(Chosen, Chosen),
    /// Each record with each later one.
    EachOther(Chosen),
    /// Each measured record of a section that repeats another with that of its original.
    Repeats,
}

impl Pairing {
    /// Every simulated record with every measured one.
    pub const SIDES: Self = Self::Each(Chosen { side: Side::Simulated, record: None }, Chosen { side: Side::Measured, record: None });

    fn reads(self, side: Side) -> bool {
        match self {
            Self::Each(first, second) => first.side == side || second.side == side,
            Self::EachOther(of) => of.side == side,
            Self::Repeats => side == Side::Measured,
        }
    }

    /// The side of both records, where it is the same.
    pub fn within(self) -> Option<Side> {
        match self {
            Self::Each(first, second) => (first.side == second.side).then_some(first.side),
            Self::EachOther(of) => Some(of.side),
            Self::Repeats => None,
        }
    }
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

impl Center {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Median => "median",
        }
    }
}

impl Evaluation {
    /// The metrics in it that are not checked against a reference implementation, in words.
    pub fn unverified(&self) -> Vec<String> {
        let of_inputs = |inputs: &[Input]| -> Vec<Metric> {
            inputs.iter().filter_map(|input| if let Taken::Compared(metric) = input.taken { Some(metric) } else { None }).collect()
        };
        let metrics = match self {
            Self::Values { .. } => Vec::new(),
            Self::Metric { metric, .. } => vec![*metric],
            Self::Combined { of, .. } => of.inputs.first().map_or_else(Vec::new, |inputs| of_inputs(inputs)),
        };
        metrics.into_iter().filter(|metric| metric.0.unverified).map(|metric| metric.0.form.in_words()).collect()
    }

    /// Whether records of this side are needed.
    pub fn reads(&self, side: Side) -> bool {
        match self {
            Self::Values { records: Records::Of(of) | Records::Spread { of, .. }, .. } => of.side == side,
            Self::Values { records: Records::Compared { pairing, .. }, .. }
            | Self::Metric { pairing, .. }
            | Self::Combined { pairing, .. } => pairing.reads(side),
        }
    }

    /// Which records are compared pair by pair; `None` where each is taken by itself or compared with what is central of several.
    pub fn pairing(&self) -> Option<Pairing> {
        match self {
            Self::Values { records: Records::Compared { pairing, .. }, .. }
            | Self::Metric { pairing, .. }
            | Self::Combined { pairing, .. } => Some(*pairing),
            Self::Values { .. } => None,
        }
    }

    /// What a quantity is about.
    pub fn kind(&self) -> result::Kind {
        match self {
            Self::Values { records: Records::Of(_), .. } => result::Kind::Assessment,
            Self::Values { records: Records::Spread { .. }, .. } => result::Kind::Comparison,
            _ if self.of_repeats() => result::Kind::Comparison,
            _ => result::Kind::Validation,
        }
    }

    /// The words of one of several values of a record.
    pub fn value_in_words(&self, which: usize) -> Option<String> {
        match self {
            Self::Values { values, .. } if values.len() > 1 => {
                // Without the condition of its case.
                let words = &values.get(which)?.expr.span.words;
                Some(words.split_once(" when ").map_or(words.as_ref(), |(value, _)| value).to_string())
            }
            _ => None,
        }
    }

    /// Whether rows are values of one record, without comparison.
    pub fn assesses(&self) -> bool {
        matches!(self, Self::Values { records: Records::Of(_), .. })
    }

    /// Whether rows have two sides and a difference.
    pub fn has_sides(&self) -> bool {
        matches!(self, Self::Values { records: Records::Compared { .. } | Records::Spread { .. }, .. })
    }

    /// Whether repeated sections are compared with their originals.
    pub fn of_repeats(&self) -> bool {
        self.pairing() == Some(Pairing::Repeats)
    }
}

#[derive(Clone, Debug)]
pub struct Limit {
    pub estimate: Estimate,
    pub at_least: bool,
    pub bound: OfGroup,
    /// Each factor with the condition under which it applies.
    pub factors: Vec<(Expr, Expr)>,
    pub only_when: Option<Expr>,
    pub scope: Scope,
    /// As written: `2/3 of std`.
    pub words: String,
    /// A number in it is to be confirmed against the standard.
    pub unconfirmed: bool,
    pub span: Span,
}

/// What is estimated from the rows of a group.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Name in result files: `mean`, `p95`, the name of an estimate, or an expression as written.
    pub name: String,
    /// As printed: `standard deviation (n-1)`.
    pub title: String,
    pub kind: EstimateKind,
    /// Whether it measures scatter. The best value is then 0 for every quantity.
    pub of_scatter: bool,
    /// Unit in which it is printed, where it differs from that of the values: for a share or a length.
    pub unit: Option<Unit>,
}

#[derive(Clone, Debug)]
pub enum EstimateKind {
    /// Every value separately; the worst decides.
    Each,
    Of(Box<OfGroup>),
}

impl Estimate {
    /// See [`OfGroup::others`].
    pub fn others(&self) -> Vec<usize> {
        if let EstimateKind::Of(of) = &self.kind { of.others() } else { Vec::new() }
    }

    /// The statistic and `ddof` (divisor n - `ddof`), where the estimate is one statistic only.
    pub fn statistic(&self) -> Option<(Statistic, usize)> {
        match &self.kind {
            EstimateKind::Each => Some((Statistic::Each, 0)),
            EstimateKind::Of(of) => match (&of.expr.kind, of.taken.as_slice()) {
                (Kind::Input(0), [Taking::Statistic(statistic, ddof)]) => Some((*statistic, *ddof)),
                _ => None,
            },
        }
    }

    /// The weighted statistic that it is and nothing more: statistic, n - `ddof`, weight.
    pub fn weighted(&self) -> Option<(Statistic, usize, &Expr)> {
        let EstimateKind::Of(of) = &self.kind else { return None };
        match (&of.expr.kind, of.taken.as_slice()) {
            (Kind::Input(0), [Taking::Weighted { statistic, ddof, by }]) => Some((*statistic, *ddof, by)),
            _ => None,
        }
    }
}

/// An expression over numbers taken from the rows of a group; [`Kind::Input`] is an index into `taken`.
#[derive(Clone, Debug)]
pub struct OfGroup {
    pub expr: Expr,
    pub taken: Vec<Taking>,
}

impl OfGroup {
    /// Indices of the other quantities whose rows it needs.
    pub fn others(&self) -> Vec<usize> {
        fn of(taking: &Taking) -> Vec<usize> {
            match taking {
                Taking::Other { quantity, .. } => vec![*quantity],
                Taking::Share { others, .. } => others.iter().flat_map(of).collect(),
                Taking::Bound { of, .. } => of.others(),
                Taking::EachGroup { of, .. } => of.others(),
                Taking::Fit(fit) => fit.at.iter().flat_map(OfGroup::others).collect(),
                Taking::Statistic(..) | Taking::Weighted { .. } | Taking::Count | Taking::Data { .. } => Vec::new(),
            }
        }
        self.taken.iter().flat_map(of).collect()
    }
}

/// A number taken from the rows of a group.
#[derive(Clone, Debug)]
pub enum Taking {
    /// A statistic of the values, with divisor n - `ddof`.
    Statistic(Statistic, usize),
    /// The same with a weight for each value, from the data of its section.
    Weighted {
        statistic: Statistic,
        ddof: usize,
        by: Expr,
    },
    /// Number of independent units.
    Count,
    /// An end of the confidence interval of an estimate.
    Bound {
        of: Estimate,
        upper: bool,
        confidence: f64,
        bootstrap: bool,
    },
    /// Share of the rows, or of the sections, that satisfy a condition. [`Kind::Input`] 0 is the value of a row; inputs from 1 on
    /// are `others`, statistics of other quantities.
    Share {
        condition: Expr,
        of_sections: bool,
        others: Vec<Taking>,
        /// What rows or sections count by, if not all alike.
        by: Option<Expr>,
    },
    /// A statistic of all rows of another quantity, an index into [`Plan::quantities`].
    Other {
        quantity: usize,
        id: String,
        statistic: Statistic,
        ddof: usize,
    },
    /// A number from data of the group's sections, each section counted once.
    Data {
        reducer: DataReducer,
        of: Expr,
        by: Option<Expr>,
    },
    /// Of one number for each group that the rows form by some keys.
    EachGroup {
        reducer: DataReducer,
        keys: Vec<Key>,
        of: Box<OfGroup>,
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
    /// Whether the bound is that of a further value (prediction); otherwise that of the mean.
    pub prediction: bool,
    pub over: Vec<Expr>,
    pub at: Vec<OfGroup>,
    /// Confidence level of the bound; without one, the fitted value itself.
    pub confidence: Option<f64>,
    pub one_sided: bool,
    pub lower: bool,
}

/// The rows that a limit applies to, and their groups. A limit `for each zone` gives one limit for every zone.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Only rows of these zones; all rows if empty.
    pub zones: Vec<String>,
    pub each: Vec<Key>,
    pub condition: Option<(Expr, String)>,
}

impl Scope {
    pub fn is_all(&self) -> bool {
        self.zones.is_empty() && self.each.is_empty() && self.condition.is_none()
    }

    /// Whether both have the same rows and the same groups.
    pub fn same(&self, other: &Self) -> bool {
        let words = |scope: &Self| scope.condition.as_ref().map(|(_, words)| words.clone());
        self.zones == other.zones && self.each == other.each && words(self) == words(other)
    }
}

/// A key by which rows are grouped.
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

/// What counts as one independent unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Independent {
    #[default]
    Site,
    Section,
    /// Index into [`Plan::columns`].
    Column(usize),
}

/// A verdict: its rule and its words.
#[derive(Clone, Debug)]
pub struct VerdictRule {
    /// `None` for the verdict without a name, which is the overall one.
    pub name: Option<String>,
    pub title: String,
    pub decision: Decision,
    /// The word if it holds, and the word if it does not.
    pub words: [String; 2],
    /// Whether the protocol states the words.
    pub own_words: bool,
    /// The rule in words: `validated when every limit holds`.
    pub criterion: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    pub span: Span,
}

impl VerdictRule {
    /// Whether its words are its own, and not those of the kind of the protocol.
    pub fn has_words(&self) -> bool {
        self.name.is_some() || self.own_words
    }
}

#[derive(Clone, Debug)]
pub enum Decision {
    /// By the limits of quantities, given by index.
    Limits { rule: Rule, quantities: Vec<usize> },
    /// By other verdicts.
    Verdicts(Over),
    /// By a person.
    Person(String),
}

/// A condition on other verdicts, given by their index in [`Plan::verdicts`].
#[derive(Clone, Debug)]
pub enum Over {
    Holds(usize),
    /// Both hold, or neither holds.
    Same(usize, usize),
    AtLeast(usize, Vec<usize>),
    Not(Box<Over>),
    All(Vec<Over>),
    Any(Vec<Over>),
}

impl Over {
    /// The verdicts that the condition uses, each once.
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
