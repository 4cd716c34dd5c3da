//! The tree of a field's phrase, without its meaning: expressions, selections, chains, limits.

use std::{ops::Range, sync::Arc};

use super::document::Text;
use crate::source::{Located, Span};
use crate::units::{Dimension, Unit};

/// A node, the text of the field that it is in, and its bytes there.
#[derive(Clone, Debug)]
pub struct At<T> {
    pub node: T,
    pub text: Arc<Text>,
    pub range: Range<usize>,
}

impl<T> At<T> {
    /// The place in the file, as exact as possible.
    pub fn place(&self) -> Span {
        self.text.place(self.range.clone())
    }

    /// The words as written, with single blanks between them.
    pub fn words(&self) -> String {
        self.text.text.get(self.range.clone()).map_or_else(String::new, normalised)
    }

    /// Another node at the same place.
    pub fn with<U>(&self, node: U) -> At<U> {
        self.to(self, node)
    }

    /// A node from the start of this one to the end of a later one of the same field.
    pub fn to<U, V>(&self, later: &At<U>, node: V) -> At<V> {
        let end = later.range.end.max(self.range.end);
        At { node, text: Arc::clone(&self.text), range: self.range.start..end }
    }
}

impl Phrase {
    /// The phrases that it is directly made of.
    pub fn parts(&self) -> Vec<&Phrase> {
        match &self.node {
            Node::Number(_)
            | Node::Percentile(_)
            | Node::PercentileBy(_)
            | Node::Path(_)
            | Node::Quoted(_)
            | Node::PlaceOf(..) => Vec::new(),
            Node::Negative(inner)
            | Node::Not(inner)
            | Node::Magnitude(inner)
            | Node::Power(inner, _)
            | Node::Through(inner, _)
            | Node::ForEach(inner, _)
            | Node::Table { of: inner, .. }
            | Node::Bound { of: inner, .. }
            | Node::Share { condition: inner, .. } => vec![inner],
            Node::Binary(_, left, right)
            | Node::Reduced(left, right)
            | Node::Over(left, right)
            | Node::Weighted(left, right) => vec![left, right],
            Node::Near { value, target, tolerance, .. } => vec![value, target, tolerance],
            Node::Call(_, arguments) => arguments.iter().collect(),
            Node::Fit(fit) => fit.over.iter().chain(&fit.at).collect(),
            Node::Cases(arms, otherwise) => {
                let arms = arms.iter().flat_map(|(value, condition)| [value, condition]);
                arms.chain(otherwise.as_deref()).collect()
            }
        }
    }
}

impl At<String> {
    /// The word as a text of its own.
    pub fn to_text(&self) -> Text {
        Text { text: self.node.clone(), span: self.place(), exact: self.text.exact }
    }
}

impl<T> Located for At<T> {
    fn place(&self) -> Span {
        self.place()
    }
}

impl Item {
    /// The word, where it is one.
    pub fn word(&self) -> Option<&str> {
        if let Self::Word(word) = self { Some(word) } else { None }
    }
}

/// A text with single blanks between its words.
pub fn normalised(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Nodes are compared without their places.
impl<T: PartialEq> PartialEq for At<T> {
    fn eq(&self, other: &Self) -> bool {
        self.node == other.node
    }
}

pub type Phrase = At<Node>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    And,
    Or,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Is,
    IsNot,
}

/// A number with its unit; the value is in SI.
#[derive(Clone, Debug)]
pub struct Number {
    pub value: f64,
    pub unit: Option<Unit>,
}

impl Number {
    /// The dimension of its unit.
    pub fn dimension(&self) -> Dimension {
        self.unit.as_ref().map_or(Dimension::ONE, |unit| unit.dimension)
    }
}

/// Numbers are equal in whatever units they are written: `0.40 m/s^2` and `400 mm/s²`. They are
/// compared with twelve digits, so that rounding of a conversion makes no difference.
impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        let digits = |number: &Self| format!("{:.11e}", number.value);
        self.dimension() == other.dimension() && digits(self) == digits(other)
    }
}

impl Phrase {
    /// The value of plain numbers alone, such as `(1/3)`.
    pub fn plain_number(&self) -> Option<f64> {
        match &self.node {
            Node::Number(Number { value, unit: None }) => Some(*value),
            Node::Negative(of) => Some(-of.plain_number()?),
            Node::Binary(operator, a, b) => {
                let (a, b) = (a.plain_number()?, b.plain_number()?);
                match operator {
                    Operator::Add => Some(a + b),
                    Operator::Subtract => Some(a - b),
                    Operator::Multiply => Some(a * b),
                    Operator::Divide => Some(a / b),
                    _ => None,
                }
            }
            _ => None,
        }
    }
}

/// A node of an expression. Nodes are equal if they mean the same, however they are spelt.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    Number(Number),
    /// `p99.85`: the value below which 99.85 % of the samples lie.
    Percentile(f64),
    /// `percentile level`: the same by a constant.
    PercentileBy(Box<Phrase>),
    /// `vehicle.category`, `Y`, `LP20`.
    Path(String),
    /// `"series 2"`, on the right of a comparison.
    Quoted(String),
    Binary(Operator, Box<Phrase>, Box<Phrase>),
    Negative(Box<Phrase>),
    Not(Box<Phrase>),
    Magnitude(Box<Phrase>),
    /// `a^2`, `a²`, `a^0.3`, `a^(1/3)`: the exponent is constant.
    Power(Box<Phrase>, Box<Phrase>),
    /// `table radius: (300 m, 1.2), (600 m, 1), held`: linear between constant points.
    Table {
        of: Box<Phrase>,
        points: Vec<(Phrase, Phrase)>,
        held: bool,
    },
    /// `name(a, b)`, and `larger of a, b` as `larger(a, b)`.
    Call(At<String>, Vec<Phrase>),
    /// `mean of Q near 50 kN within 10 kN`, or `within a factor of 2`.
    Near {
        value: Box<Phrase>,
        target: Box<Phrase>,
        tolerance: Box<Phrase>,
        by_factor: bool,
    },
    /// `range of curvature`.
    Reduced(Box<Phrase>, Box<Phrase>),
    /// `Y at side R`: the path and the words after `at`.
    PlaceOf(At<String>, Vec<At<String>>),
    /// `Y through LP20`, `Y through (low-pass 10 Hz, order 4, then magnitude)`.
    Through(Box<Phrase>, Vec<At<Step>>),
    /// `slope over cant_angle`: a value of a signal over another signal in place of the axis.
    Over(Box<Phrase>, Box<Phrase>),
    /// `upper 95 % of std`: an end of the confidence interval of an estimate.
    Bound {
        upper: bool,
        /// Confidence level, from 0 to 1: a constant.
        confidence: Box<Phrase>,
        of: Box<Phrase>,
        bootstrap: bool,
    },
    /// `share where value <= 1`, `share of sections where radius < 300 m`, `longest run where Y > Q`.
    Share {
        counted: Counted,
        of_sections: bool,
        condition: Box<Phrase>,
    },
    /// `prediction over cant_deficiency at 143 mm, confidence 99 %`.
    Fit(Box<Fit>),
    /// `mean weighted by length`: a statistic or a share, and by what values count.
    Weighted(Box<Phrase>, Box<Phrase>),
    /// `(mean for each zone)`: one number for each group.
    ForEach(Box<Phrase>, Vec<At<String>>),
    /// `a when b, c when d, otherwise e`.
    Cases(Vec<(Phrase, Phrase)>, Option<Box<Phrase>>),
}

/// What is told of the values or samples that satisfy a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    Share,
    /// How many there are.
    Count,
    /// How often the condition comes to hold from one sample to the next.
    Crossings,
    /// The longest stretch of samples one after the other, along the axis or in time.
    LongestRun {
        in_time: bool,
    },
}

/// A regression of the values of a group over data of their sections, and the point at which it is
/// evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `prediction`: a bound is that of a further value; otherwise that of the mean.
    pub prediction: bool,
    pub over: Vec<Phrase>,
    pub at: Vec<Phrase>,
    /// Confidence level of the bound; without one, the fitted value itself.
    pub confidence: Option<Phrase>,
    pub one_sided: bool,
    pub lower: bool,
}

/// `Y at wheelsets 1, 3 and side R when direction is right`.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPlaces {
    pub signal: At<String>,
    pub picks: Vec<Pick>,
    /// Sections in which these positions are evaluated.
    pub when: Option<Phrase>,
}

/// `running gears I, II`: the words before the first comma, then the further members.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    pub words: Vec<At<String>>,
    pub more: Vec<At<String>>,
}

/// `outer is L when ..., R when ...`.
#[derive(Clone, Debug, PartialEq)]
pub struct Alias {
    pub name: At<String>,
    pub cases: Vec<(At<String>, Phrase)>,
}

/// One step of a chain, or a metric: parts separated by commas.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub parts: Vec<Vec<At<Item>>>,
    /// The step is used only if this holds.
    pub when: Option<Phrase>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    Word(String),
    Value(Phrase),
}

#[derive(Clone, Debug)]
pub struct Limit {
    /// The estimate as written: `std`, `p95`, `(mean + 3 * std)`.
    pub statistic: At<String>,
    /// The estimate as an expression.
    pub estimate: Phrase,
    pub at_least: bool,
    pub at_most: bool,
    /// The lower edge of `between ... and ...`, whose upper one is the bound.
    pub lower: Option<Phrase>,
    pub bound: Phrase,
    pub factors: Vec<(Phrase, Phrase)>,
    pub only_when: Option<Phrase>,
    pub scope: Scope,
}

/// `24`, `3 for each zone`: how many there must be, and of which values.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    pub count: Phrase,
    pub scope: Scope,
}

/// `mean for each zone`, `total of length in km`: an estimate without a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub of: Phrase,
    /// The text of the unit, if it has one.
    pub unit: Option<At<String>>,
    pub scope: Scope,
}

/// The values that a limit applies to, and their groups. By default, all values form one group.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    pub zones: Vec<At<String>>,
    /// `for each zone and wheelset`.
    pub each: Vec<At<String>>,
    pub condition: Option<Phrase>,
}

/// `speed, curvature in 1/km for each state`: what spans a domain, and by what sections are told
/// apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Each with the text of its unit, if it has one.
    pub over: Vec<(Phrase, Option<At<String>>)>,
    pub each: Vec<At<String>>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// `every limit holds`, or so many quantities or limits; of the sections as they are, or in a
    /// share of draws of them.
    Limits {
        needed: Option<Needed>,
        draws: Option<Phrase>,
    },
    Over(OverVerdicts),
}

/// `at least 10 quantities`
#[derive(Clone, Debug, PartialEq)]
pub struct Needed {
    pub count: Phrase,
    pub of_limits: bool,
}

/// One of several outcomes in order: `good: holds when mean <= 2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome<T> {
    pub word: At<String>,
    pub holds: bool,
    /// `None` of the last one, if no other applies.
    pub when: Option<T>,
}

/// A rule over other verdicts.
#[derive(Clone, Debug, PartialEq)]
pub enum OverVerdicts {
    Holds(At<String>),
    /// `a is b`: both have the same outcome.
    Same(At<String>, At<String>),
    AtLeast {
        count: Phrase,
        of: Vec<At<String>>,
    },
    Not(Box<OverVerdicts>),
    All(Vec<OverVerdicts>),
    Any(Vec<OverVerdicts>),
}

impl Scope {
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }
}

/// Zones and keys can be in any order.
impl PartialEq for Scope {
    fn eq(&self, other: &Self) -> bool {
        self.condition == other.condition
            && same_set(&self.zones, &other.zones)
            && same_set(&self.each, &other.each)
    }
}

impl Limit {
    /// Whether both are of the same estimate, in the same direction and for the same values.
    pub fn same_slot(&self, other: &Self) -> bool {
        self.estimate == other.estimate
            && (self.at_least, self.at_most) == (other.at_least, other.at_most)
            && self.lower.is_some() == other.lower.is_some()
            && self.scope == other.scope
    }
}

/// Factors can be in any order.
impl PartialEq for Limit {
    fn eq(&self, other: &Self) -> bool {
        self.same_slot(other)
            && (&self.lower, &self.bound) == (&other.lower, &other.bound)
            && self.only_when == other.only_when
            && same_set(&self.factors, &other.factors)
    }
}

fn same_set<T: PartialEq>(a: &[T], b: &[T]) -> bool {
    a.len() == b.len() && a.iter().all(|item| b.contains(item))
}
