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
    /// `Y through LP20`.
    Through(Box<Phrase>, At<String>),
    /// `a when b, c when d, otherwise e`.
    Cases(Vec<(Phrase, Phrase)>, Option<Box<Phrase>>),
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

impl Phrase {
    /// The phrase without places and ways of writing: equal for `0.40 m/s^2`, `0.4 m/s²` and `400 mm/s^2`.
    pub fn meaning(&self) -> String {
        match &self.node {
            Node::Number { value, unit } => number(*value, unit.as_ref()),
            Node::Percentile(percent) => format!("p{percent}"),
            Node::Path(path) => path.clone(),
            Node::Binary(operator, left, right) => format!("({operator:?} {} {})", left.meaning(), right.meaning()),
            Node::Negative(inner) => format!("(neg {})", inner.meaning()),
            Node::Not(inner) => format!("(not {})", inner.meaning()),
            Node::Magnitude(inner) => format!("|{}|", inner.meaning()),
            Node::Power(inner, exponent) => format!("{}^{exponent}", inner.meaning()),
            Node::Call(name, arguments) => format!("{}({})", name.node, joined(arguments, " ", Phrase::meaning)),
            Node::Near { value, target, tolerance, by_factor } => {
                format!("{} near {} within {by_factor} {}", value.meaning(), target.meaning(), tolerance.meaning())
            }
            Node::Reduced(reducer, signal) => format!("{} of {}", reducer.meaning(), signal.meaning()),
            Node::PlaceOf(signal, words) => format!("{}@{}", signal.node, joined(words, ".", |word| word.node.clone())),
            Node::Through(inner, filter) => format!("{}>{}", inner.meaning(), filter.node),
            Node::Cases(arms, otherwise) => {
                let arms = joined(arms, ", ", |(value, condition)| format!("{}?{}", value.meaning(), condition.meaning()));
                format!("[{arms}; {}]", otherwise.as_ref().map_or(String::new(), |value| value.meaning()))
            }
        }
    }
}

impl Limit {
    /// As [`Phrase::meaning`]; conditions and factors may stand in any order.
    pub fn meaning(&self) -> String {
        let mut factors: Vec<String> =
            self.factors.iter().map(|(factor, condition)| format!("{}?{}", factor.meaning(), condition.meaning())).collect();
        factors.sort();
        let only = self.only_when.as_ref().map_or(String::new(), Phrase::meaning);
        format!("{} {} * [{}] only {only} {}", self.bounds(), self.bound.meaning(), factors.join(", "), self.scope.node.meaning())
    }

    /// What it is a limit of: `std`, `p95 at least`.
    pub fn bounds(&self) -> String {
        format!("{}{}", self.statistic.node, if self.at_least { " at least" } else { "" })
    }
}

impl Scope {
    pub fn meaning(&self) -> String {
        match self {
            Self::All => String::new(),
            Self::EachZone => "for each zone".into(),
            Self::Zones(zones) => {
                let mut zones: Vec<&str> = zones.iter().map(|zone| zone.node.as_str()).collect();
                zones.sort_unstable();
                format!("for zones {}", zones.join(", "))
            }
            Self::Where(condition) => format!("for sections where {}", condition.meaning()),
        }
    }
}

impl Step {
    pub fn meaning(&self) -> String {
        let item = |item: &At<Item>| match &item.node {
            Item::Word(word) => word.clone(),
            Item::Value(value) => value.meaning(),
        };
        let parts = joined(&self.parts, ", ", |part| joined(part, " ", item));
        format!("{parts} when {}", self.when.as_ref().map_or(String::new(), Phrase::meaning))
    }
}

fn joined<T>(items: &[T], between: &str, one: impl Fn(&T) -> String) -> String {
    items.iter().map(one).collect::<Vec<_>>().join(between)
}

/// To twelve digits, so that the last bit of a conversion makes no difference.
fn number(value: f64, unit: Option<&Unit>) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    match unit {
        Some(unit) if unit.dimension != crate::units::Dimension::ONE => format!("{rounded}{{{}}}", unit.dimension),
        _ => rounded.to_string(),
    }
}
