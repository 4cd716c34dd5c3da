//! The meaning-free tree of what stands in a field: expressions, selections, chains, limits.
//!
//! Every node has the byte range it came from, counted in the field's text; [`super::document::Text::place`] turns it into a place in the file.

use std::ops::Range;

use crate::units::Unit;

/// A node and its bytes in the field's text.
#[derive(Clone, Debug)]
pub struct At<T> {
    pub node: T,
    pub range: Range<usize>,
}

/// Places in the text do not belong to the meaning.
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

#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A number as written and its unit: the value is in SI.
    Number {
        value: f64,
        unit: Option<Unit>,
    },
    /// `p99.85`: the value below which so many per cent of the samples lie.
    Percentile(f64),
    /// `vehicle.category`, `Y`, `LP20`.
    Path(String),
    Binary(Operator, Box<Phrase>, Box<Phrase>),
    Negative(Box<Phrase>),
    Not(Box<Phrase>),
    Magnitude(Box<Phrase>),
    Power(Box<Phrase>, i8),
    /// `name(a, b)`, and `larger of a, b` as `larger(a, b)`.
    Call(At<String>, Vec<Phrase>),
    /// `range of curvature`.
    Reduced(Box<Phrase>, Box<Phrase>),
    /// `Y at side R`: the path and the words after `at`.
    PlaceOf(At<String>, Vec<At<String>>),
    /// `Y through LP20`.
    Through(Box<Phrase>, At<String>),
    /// `a when b, c when d, otherwise e`.
    Cases(Vec<(Phrase, Option<Phrase>)>, Option<Box<Phrase>>),
}

/// `Y at wheelsets 1, 3 and side R`.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPlaces {
    pub signal: At<String>,
    pub picks: Vec<Pick>,
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
    /// The step is left out unless this holds.
    pub when: Option<Phrase>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    Word(String),
    Value(Phrase),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    pub statistic: At<String>,
    pub at_least: bool,
    pub bound: Phrase,
    pub factors: Vec<(Phrase, Phrase)>,
    pub only_when: Option<Phrase>,
    pub scope: At<Scope>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Scope {
    All,
    EachZone,
    Zones(Vec<At<String>>),
    Where(Box<Phrase>),
}

#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    EveryLimit,
    AtLeast { count: Phrase, of_limits: bool },
}
