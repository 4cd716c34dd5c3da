//! Checked expressions: over numbers, words and conditions, and over the samples of records.

use std::{fmt, ops::Deref, sync::Arc};

use super::{Optional, Scalar, Side, Step};
use crate::catalog::{Function, Reducer};
use crate::metrics::welch::Density;
use crate::source::{Located, Span};
use crate::units::{Dimension, Unit, raised};

pub use crate::syntax::phrase::Operator;

/// Where an expression is written, and its words. In YAML, the place of a part of a field is not
/// always known, but its words are.
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

impl Located for Origin {
    fn place(&self) -> Span {
        self.span.clone()
    }
}

/// A typed expression. One over samples states how the signal of one position is computed from
/// channels.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: Kind,
    pub ty: Type,
    pub span: Origin,
}

impl Located for Expr {
    fn place(&self) -> Span {
        self.span.place()
    }
}

/// What an expression gives.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    Number(Dimension),
    /// One of these words; empty for a word by itself.
    Word(Vec<String>),
    Flag,
    /// A number for each sample.
    Samples {
        dimension: Dimension,
        points: Points,
    },
    /// Whether a condition holds, for each sample.
    SampleFlags {
        points: Points,
    },
}

/// What samples are taken at; those at different points cannot be combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// The samples of the simulated and measured records.
    Record,
    Track,
    /// The frequencies of a spectrum.
    Spectrum,
    /// The half cycles of a signal, in the order in which they are counted.
    Cycles,
}

impl Points {
    /// Whether they are not those of a record.
    pub fn of_section(self) -> bool {
        matches!(self, Self::Spectrum | Self::Cycles)
    }
}

/// How an expression is computed.
#[derive(Clone, Debug)]
pub enum Kind {
    Constant(Scalar),
    /// A parameter that has no value unless it is set, and is not set.
    NotStated(String, Optional),
    /// Index into [`Plan::vehicle`](super::Plan::vehicle).
    Vehicle(usize),
    /// Index into [`Plan::columns`](super::Plan::columns).
    Column(usize),
    /// Start or end of the section on the axis.
    Start,
    End,
    /// A value taken from a signal or from a group: index into the list stored with the expression.
    Input(usize),
    /// The value of this side. Over samples, the own processed signal of this side, at the points
    /// where both sides have one; only in values taken from both sides.
    Side(Side),
    LimitOf(LimitName),
    /// A column of the records, with the channel it belongs to.
    Channel {
        column: String,
        channel: String,
        /// The unit that the protocol declares.
        unit: Unit,
    },
    Negative(Box<Expr>),
    Not(Box<Expr>),
    /// A constant power of a number or of samples, or their value in a table.
    Mapped(Box<Expr>, Mapping),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Call(&'static Function, Vec<Expr>),
    Filtered(Box<Expr>, Vec<Step>),
    OverAxis(AxisOperation, Box<Expr>),
    OfSection(SectionOperation, Box<Expr>),
    /// The frequencies of the spectrum that it is combined with; not in a plan.
    Frequency,
    /// The number of a section that is taken from a signal, the same all along: `Y - mean of Y`.
    Level(Reducer, Box<Expr>),
    /// The value of the first condition that holds, else the last value.
    Cases(Vec<(Expr, Expr)>, Option<Box<Expr>>),
}

/// A limit that another one refers to, of the same rows: `limit of std`, `limit of std of Q_max`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LimitName {
    /// Name of the estimate that it limits.
    pub estimate: String,
    /// Another quantity: its index in [`Plan::quantities`](super::Plan::quantities) and its name.
    pub of: Option<(usize, String)>,
}

impl fmt::Display for LimitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.of {
            None => write!(f, "{}", self.estimate),
            Some((_, quantity)) => write!(f, "{} of {quantity}", self.estimate),
        }
    }
}

/// An operation on a signal along its axis.
#[derive(Clone, Debug)]
pub enum AxisOperation {
    /// Shifted forward by this distance.
    Shifted(Box<Expr>),
    Derivative {
        over_time: bool,
    },
    Integral {
        over_time: bool,
    },
}

/// What is computed of the samples of a section as a whole. It has samples of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionOperation {
    /// The power spectral density.
    Spectrum(Density),
    /// The frequencies of a spectrum.
    Frequencies,
    /// The ranges of the half cycles.
    CycleRanges,
}

/// The parts of an expression of this kind, to be read or to be changed.
macro_rules! parts {
    ($kind:expr, $iter:ident, $as_deref:ident) => {
        match $kind {
            Kind::OverAxis(AxisOperation::Shifted(distance), inner) => vec![distance, inner],
            Kind::Negative(inner)
            | Kind::Not(inner)
            | Kind::Mapped(inner, _)
            | Kind::Filtered(inner, _)
            | Kind::Level(_, inner)
            | Kind::OverAxis(_, inner)
            | Kind::OfSection(_, inner) => vec![inner],
            Kind::Binary(_, left, right) => vec![left, right],
            Kind::Call(_, arguments) => arguments.$iter().collect(),
            Kind::Cases(arms, otherwise) => {
                let arms = arms.$iter().flat_map(|(value, condition)| [value, condition]);
                arms.chain(otherwise.$as_deref()).collect()
            }
            _ => Vec::new(),
        }
    };
}

impl Expr {
    /// A number, not of samples.
    pub fn number(kind: Kind, dimension: Dimension, span: &Origin) -> Self {
        Self { kind, ty: Type::Number(dimension), span: span.clone() }
    }

    /// A number for each sample.
    pub fn samples(kind: Kind, dimension: Dimension, points: Points, span: &Origin) -> Self {
        Self { kind, ty: Type::Samples { dimension, points }, span: span.clone() }
    }

    /// A comparison of two parts, or two conditions that are joined.
    pub fn flag(operator: Operator, left: Self, right: Self, span: &Origin) -> Self {
        let kind = Kind::Binary(operator, Box::new(left), Box::new(right));
        Self { kind, ty: Type::Flag, span: span.clone() }
    }

    /// The dimension of a number or of samples; that of a plain number for words and conditions.
    pub fn dimension(&self) -> Dimension {
        match self.ty {
            Type::Number(dimension) | Type::Samples { dimension, .. } => dimension,
            Type::Word(_) | Type::Flag | Type::SampleFlags { .. } => Dimension::ONE,
        }
    }

    /// What its samples are taken at; `None` where it has none.
    pub fn points(&self) -> Option<Points> {
        match self.ty {
            Type::Samples { points, .. } | Type::SampleFlags { points } => Some(points),
            Type::Number(_) | Type::Word(_) | Type::Flag => None,
        }
    }

    /// Whether its samples are those of the track record.
    pub fn track(&self) -> bool {
        self.points() == Some(Points::Track)
    }

    /// The dimension of what its samples lie along, where those of records lie along `axis`.
    pub fn along(&self, axis: Dimension) -> Dimension {
        match self.points() {
            Some(Points::Spectrum) => Dimension::FREQUENCY,
            Some(Points::Cycles) => Dimension::ONE,
            Some(Points::Record | Points::Track) | None => axis,
        }
    }

    /// Whether some of its samples may be missing: `Y when Q > 60 kN`.
    pub fn may_miss_samples(&self) -> bool {
        let of_samples = |arm: &(Expr, Expr)| matches!(arm.1.ty, Type::SampleFlags { .. });
        matches!(&self.kind, Kind::Cases(arms, None) if arms.iter().any(of_samples))
    }

    /// The parts that it is directly made of.
    pub fn parts(&self) -> Vec<&Expr> {
        parts!(&self.kind, iter, as_deref)
    }

    /// The same, to be changed.
    fn parts_mut(&mut self) -> Vec<&mut Expr> {
        parts!(&mut self.kind, iter_mut, as_deref_mut)
    }

    /// Puts `other` in the place of the frequencies of a spectrum.
    pub fn with_frequencies(&mut self, other: &Kind) {
        if matches!(self.kind, Kind::Frequency) {
            self.kind = other.clone();
        } else {
            self.parts_mut().into_iter().for_each(|part| part.with_frequencies(other));
        }
    }

    /// Visits every part, the whole expression first.
    pub fn visit(&self, see: &mut dyn FnMut(&Expr)) {
        see(self);
        self.parts().into_iter().for_each(|part| part.visit(see));
    }

    /// The first part that satisfies a test, the whole expression included.
    pub fn find(&self, test: &dyn Fn(&Expr) -> bool) -> Option<&Expr> {
        if test(self) {
            return Some(self);
        }
        self.parts().into_iter().find_map(|part| part.find(test))
    }

    /// Whether a part, or the whole, satisfies a test.
    pub fn any(&self, test: &dyn Fn(&Expr) -> bool) -> bool {
        self.find(test).is_some()
    }
}

/// A function of one number with constants of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Mapping {
    /// The exponent.
    Power(f64),
    Table(Table),
}

/// Two points or more with ascending x; in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub points: Vec<(f64, f64)>,
    /// Whether the values of the ends hold outside.
    pub held: bool,
}

impl Mapping {
    /// The value of a number; not a number where there is none.
    pub fn of(&self, x: f64) -> f64 {
        match self {
            Self::Power(exponent) => raised(x, *exponent),
            Self::Table(table) => table.at(x),
        }
    }
}

impl Table {
    /// Linear between two points; not a number outside, unless the ends are held.
    pub fn at(&self, x: f64) -> f64 {
        let (first, last) = self.ends();
        let x = if self.held { x.clamp(first, last) } else { x };
        let inside = (first..=last).contains(&x);
        let beyond = self.points.partition_point(|(at, _)| *at <= x);
        match (inside, self.points.get(beyond.wrapping_sub(1)), self.points.get(beyond)) {
            (true, Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * ((x - x0) / (x1 - x0)),
            (true, Some((_, y)), None) => *y,
            _ => f64::NAN,
        }
    }

    /// The first and the last x.
    pub fn ends(&self) -> (f64, f64) {
        let x = |point: Option<&(f64, f64)>| point.map_or(f64::NAN, |(x, _)| *x);
        (x(self.points.first()), x(self.points.last()))
    }
}

impl fmt::Display for Mapping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Power(exponent) => write!(f, "^{exponent}"),
            Self::Table(Table { points, held }) => {
                write!(f, "table{points:?}{}", if *held { ", held" } else { "" })
            }
        }
    }
}
