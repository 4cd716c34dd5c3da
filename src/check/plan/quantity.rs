//! Quantities: their positions, values, records and comparisons.

use std::sync::Arc;

use indexmap::IndexMap;

use super::{Axis, Expr, Limit, Report, Scope, Step};
use crate::catalog::{Metric, Reducer};
use crate::result;
use crate::source::{Span, Spanned};
use crate::units::{Dimension, Unit};

/// The position chosen of each place.
pub type Assignment = IndexMap<String, String>;

/// A number that an expression takes from signals.
#[derive(Clone, Debug)]
pub struct Input {
    pub taken: Taken,
    /// `None`: the quantity's own processed signal.
    pub signal: Option<Expr>,
    /// Filters and windows that a named signal passes.
    pub chain: Vec<Step>,
    /// The signal that a slope or a metric uses in place of the axis.
    pub over: Option<Expr>,
    pub side: InputSide,
    /// Whether it is that of the other positions of the rule: their upper quartile.
    pub siblings: bool,
    pub span: Span,
}

/// How a number is taken from signals.
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
    /// Whether it needs samples at common points. These are not available after a window or
    /// resampling.
    pub fn needs_samples(self) -> bool {
        match self {
            Self::Reduced(_) => false,
            Self::Compared(metric) => metric.on_common_points(false),
            Self::OfBoth(_) => true,
        }
    }

    /// The dimension of the number, from those of the signal and of the axis.
    pub fn gives(self, signal: Dimension, axis: Dimension) -> Dimension {
        match self {
            Self::Reduced(reducer) | Self::OfBoth(reducer) => reducer.gives(signal, axis),
            Self::Compared(metric) => (metric.0.gives)(signal, axis),
        }
    }
}

/// The side of a number that is taken from a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputSide {
    /// The side that the expression is evaluated for.
    Own,
    Simulated,
    Measured,
}

/// What is assessed or compared: signals, their processing, limits.
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
    /// The best value, SI, where it is known.
    pub best: Option<f64>,
    pub only: Option<Expr>,
    /// Words of outcomes in order, the best first; a limit is of the number of the one that applies.
    pub outcomes: Vec<String>,
    pub limits: Vec<Arc<Limit>>,
    pub reports: Vec<Arc<Report>>,
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
    /// The signals that its values are taken from.
    pub fn signals(&self) -> impl Iterator<Item = &Expr> {
        let named = match self.evaluation.as_ref() {
            Evaluation::Values { values, .. } => values.as_slice(),
            Evaluation::Combined { of, .. } => std::slice::from_ref(of),
            Evaluation::Metric { .. } => &[],
        };
        let named = named.iter().flat_map(|value| value.inputs.iter().flatten());
        let own = self.positions.iter().map(|position| &position.signal);
        own.chain(named.filter_map(|input| input.signal.as_ref()))
    }

    /// Number of its limits, of which one between two edges is one.
    pub fn limits_written(&self) -> usize {
        self.limits.iter().filter(|limit| !limit.is_lower_edge()).count()
    }

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
    pub signal: Expr,
    /// Each place with its member, such as `wheelset` and `1`.
    pub places: Assignment,
    /// The condition on the sections in which it is evaluated; `None` for all.
    pub only: Option<Expr>,
}

/// How the rows of the table of values are computed.
#[derive(Clone, Debug)]
pub enum Evaluation {
    /// Numbers of each record, assessed or compared.
    Values { values: Vec<Valued>, records: Records },
    /// One number of the two signals; `over` is the other signal its wording names, one for each
    /// position, with its name and unit.
    Metric { metric: Metric, over: Vec<Expr>, over_axis: Option<Axis>, pairing: Pairing },
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
    /// Index into [`Plan::records`](super::Plan::records).
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

/// Which records are compared. In a row the first stands in the place of the simulation, the second
/// in that of the measurement.
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
    pub const SIDES: Self = Self::Each(
        Chosen { side: Side::Simulated, record: None },
        Chosen { side: Side::Measured, record: None },
    );

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

/// The two kinds of records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Simulated,
    Measured,
}

impl Side {
    /// Both sides, the simulated one first.
    pub const ALL: [Self; 2] = [Self::Simulated, Self::Measured];

    /// The side that `simulated` or `measured` stands for.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|side| side.in_words() == word)
    }

    /// As written in protocols.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::Measured => "measured",
        }
    }
}

/// What is central of several records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Center {
    Mean,
    Median,
}

impl Center {
    /// As written in protocols.
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
            inputs
                .iter()
                .filter_map(|input| {
                    if let Taken::Compared(metric) = input.taken { Some(metric) } else { None }
                })
                .collect()
        };
        let metrics = match self {
            Self::Values { .. } => Vec::new(),
            Self::Metric { metric, .. } => vec![*metric],
            Self::Combined { of, .. } => {
                of.inputs.first().map_or_else(Vec::new, |inputs| of_inputs(inputs))
            }
        };
        metrics
            .into_iter()
            .filter(|metric| metric.0.unverified)
            .map(|metric| metric.0.form.in_words())
            .collect()
    }

    /// Whether records of this side are needed.
    pub fn reads(&self, side: Side) -> bool {
        match self {
            Self::Values { records: Records::Of(of) | Records::Spread { of, .. }, .. } => {
                of.side == side
            }
            Self::Values { records: Records::Compared { pairing, .. }, .. }
            | Self::Metric { pairing, .. }
            | Self::Combined { pairing, .. } => pairing.reads(side),
        }
    }

    /// Which records are compared pair by pair; `None` where each is taken by itself or compared
    /// with what is central of several.
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
                Some(
                    words
                        .split_once(" when ")
                        .map_or(words.as_ref(), |(value, _)| value)
                        .to_string(),
                )
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
        matches!(
            self,
            Self::Values { records: Records::Compared { .. } | Records::Spread { .. }, .. }
        )
    }

    /// Whether repeated sections are compared with their originals.
    pub fn of_repeats(&self) -> bool {
        self.pairing() == Some(Pairing::Repeats)
    }
}
