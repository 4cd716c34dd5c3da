//! The tree of a field's phrase, without its meaning: expressions, selections, chains, limits.
//!
//! Every node has its byte range in the field's text. [`super::document::Text::place`] turns it
//! into a place in the file.

use std::ops::Range;

use crate::units::Unit;

/// A node and its bytes in the field's text.
#[derive(Clone, Debug)]
pub struct At<T> {
    pub node: T,
    pub range: Range<usize>,
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

#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// A number with its unit; the value is in SI.
    Number {
        value: f64,
        unit: Option<Unit>,
    },
    /// `p99.85`: the value below which 99.85 % of the samples lie.
    Percentile(f64),
    /// `vehicle.category`, `Y`, `LP20`.
    Path(String),
    /// `"series 2"`, on the right of a comparison.
    Quoted(String),
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
    /// `slope over cant_angle`: a value of a signal over another signal in place of the axis.
    Over(Box<Phrase>, Box<Phrase>),
    /// `upper 95 % of std`: an end of the confidence interval of an estimate.
    Bound {
        upper: bool,
        /// Confidence level, from 0 to 1.
        confidence: f64,
        of: Box<Phrase>,
        bootstrap: bool,
    },
    /// `share where value <= 1`, `share of sections where radius < 300 m`.
    Share {
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

/// A regression of the values of a group over data of their sections, and the point at which it is
/// evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `prediction`: a bound is that of a further value; otherwise that of the mean.
    pub prediction: bool,
    pub over: Vec<Phrase>,
    pub at: Vec<Phrase>,
    /// Confidence level of the bound; without one, the fitted value itself.
    pub confidence: Option<At<f64>>,
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

#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The estimate as written: `std`, `p95`, `(mean + 3 * std)`.
    pub statistic: At<String>,
    /// The estimate as an expression.
    pub estimate: Phrase,
    pub at_least: bool,
    pub bound: Phrase,
    pub factors: Vec<(Phrase, Phrase)>,
    pub only_when: Option<Phrase>,
    pub scope: At<Scope>,
}

/// `24`, `3 for each zone`: how many there must be, and of which values.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    pub count: Phrase,
    pub scope: At<Scope>,
}

impl Minimum {
    /// As [`Phrase::meaning`].
    pub fn meaning(&self) -> String {
        format!("{} {}", self.count.meaning(), self.scope.node.meaning())
    }
}

/// `mean for each zone`, `total of length in km`: an estimate without a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub of: Phrase,
    /// The text of the unit, if it has one.
    pub unit: Option<At<String>>,
    pub scope: At<Scope>,
}

impl Report {
    /// As [`Phrase::meaning`].
    pub fn meaning(&self) -> String {
        let unit = self.unit.as_ref().map_or(String::new(), |unit| format!(" in {}", unit.node));
        format!("{}{unit} {}", self.of.meaning(), self.scope.node.meaning())
    }
}

/// The values that a limit applies to, and their groups. By default, all values form one group.
#[derive(Clone, Debug, Default, PartialEq)]
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
    EveryLimit,
    AtLeast { count: Phrase, of_limits: bool },
    Over(OverVerdicts),
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

impl Phrase {
    /// The phrase without places and spelling variants: equal for `0.40 m/s^2`, `0.4 m/s²` and `400
    /// mm/s^2`.
    pub fn meaning(&self) -> String {
        match &self.node {
            Node::Number { value, unit } => number(*value, unit.as_ref()),
            Node::Percentile(percent) => format!("p{percent}"),
            Node::Path(path) => path.clone(),
            Node::Quoted(name) => format!("\"{name}\""),
            Node::Binary(operator, left, right) => {
                format!("({operator:?} {} {})", left.meaning(), right.meaning())
            }
            Node::Negative(inner) => format!("(neg {})", inner.meaning()),
            Node::Not(inner) => format!("(not {})", inner.meaning()),
            Node::Magnitude(inner) => format!("|{}|", inner.meaning()),
            Node::Power(inner, exponent) => format!("{}^{exponent}", inner.meaning()),
            Node::Call(name, arguments) => {
                format!("{}({})", name.node, joined(arguments, " ", Phrase::meaning))
            }
            Node::Near { value, target, tolerance, by_factor } => {
                format!(
                    "{} near {} within {by_factor} {}",
                    value.meaning(),
                    target.meaning(),
                    tolerance.meaning()
                )
            }
            Node::Reduced(reducer, signal) => {
                format!("{} of {}", reducer.meaning(), signal.meaning())
            }
            Node::PlaceOf(signal, words) => {
                format!("{}@{}", signal.node, joined(words, ".", |word| word.node.clone()))
            }
            Node::Over(value, signal) => format!("{} over {}", value.meaning(), signal.meaning()),
            Node::Through(inner, filter) => format!("{}>{}", inner.meaning(), filter.node),
            Node::Bound { upper, confidence, of, bootstrap } => {
                let (end, by) = (
                    if *upper { "upper" } else { "lower" },
                    if *bootstrap { " by bootstrap" } else { "" },
                );
                format!("{end} {confidence} of {}{by}", of.meaning())
            }
            Node::Share { of_sections, condition } => {
                format!(
                    "share{} where {}",
                    if *of_sections { " of sections" } else { "" },
                    condition.meaning()
                )
            }
            Node::Fit(fit) => fit.meaning(),
            Node::Weighted(of, by) => format!("{} weighted {}", of.meaning(), by.meaning()),
            Node::ForEach(of, keys) => format!("({} for each {})", of.meaning(), sorted(keys)),
            Node::Cases(arms, otherwise) => {
                let arms = joined(arms, ", ", |(value, condition)| {
                    format!("{}?{}", value.meaning(), condition.meaning())
                });
                format!(
                    "[{arms}; {}]",
                    otherwise.as_ref().map_or(String::new(), |value| value.meaning())
                )
            }
        }
    }
}

impl Limit {
    /// As [`Phrase::meaning`]; conditions and factors can be in any order.
    pub fn meaning(&self) -> String {
        let mut factors: Vec<String> = self
            .factors
            .iter()
            .map(|(factor, condition)| format!("{}?{}", factor.meaning(), condition.meaning()))
            .collect();
        factors.sort();
        let only = self.only_when.as_ref().map_or(String::new(), Phrase::meaning);
        format!(
            "{} {} * [{}] only {only} {}",
            self.bounds(),
            self.bound.meaning(),
            factors.join(", "),
            self.scope.node.meaning()
        )
    }

    /// The estimate and the direction of the limit: `std`, `p95 at least`.
    pub fn bounds(&self) -> String {
        format!("{}{}", self.estimate.meaning(), if self.at_least { " at least" } else { "" })
    }
}

impl Domain {
    /// As [`Phrase::meaning`].
    pub fn meaning(&self) -> String {
        let unit = |unit: &Option<At<String>>| {
            unit.as_ref().map_or(String::new(), |unit| format!(" in {}", unit.node))
        };
        let over =
            joined(&self.over, ", ", |(of, written)| format!("{}{}", of.meaning(), unit(written)));
        format!("{over} each {}", joined(&self.each, ", ", |key| key.node.clone()))
    }
}

impl Verdict {
    /// As [`Phrase::meaning`].
    pub fn meaning(&self) -> String {
        match self {
            Self::EveryLimit => "every limit".into(),
            Self::AtLeast { count, of_limits } => {
                format!(
                    "at least {} {}",
                    count.meaning(),
                    if *of_limits { "limits" } else { "quantities" }
                )
            }
            Self::Over(over) => over.meaning(),
        }
    }
}

impl OverVerdicts {
    fn meaning(&self) -> String {
        match self {
            Self::Holds(name) => name.node.clone(),
            Self::Same(a, b) => format!("({} is {})", a.node, b.node),
            Self::AtLeast { count, of } => format!(
                "(at least {} of {})",
                count.meaning(),
                joined(of, ", ", |name| name.node.clone())
            ),
            Self::Not(inner) => format!("(not {})", inner.meaning()),
            Self::All(all) => format!("({})", joined(all, " and ", Self::meaning)),
            Self::Any(any) => format!("({})", joined(any, " or ", Self::meaning)),
        }
    }
}

impl Scope {
    pub fn is_all(&self) -> bool {
        *self == Self::default()
    }

    /// As [`Phrase::meaning`]: `for zones 2, 3 and each wheelset where ...`.
    pub fn meaning(&self) -> String {
        let mut parts = Vec::new();
        if !self.zones.is_empty() {
            parts.push(format!("zones {}", sorted(&self.zones)));
        }
        if !self.each.is_empty() {
            parts.push(format!("each {}", sorted(&self.each)));
        }
        let mut words = parts.join(" and ");
        if let Some(condition) = &self.condition {
            let sections = if words.is_empty() { "sections " } else { " " };
            words = format!("{words}{sections}where {}", condition.meaning());
        }
        if words.is_empty() { words } else { format!("for {words}") }
    }
}

impl Fit {
    fn meaning(&self) -> String {
        let all = |phrases: &[Phrase]| joined(phrases, ", ", Phrase::meaning);
        let kind = if self.prediction { "prediction" } else { "regression" };
        let confidence = self
            .confidence
            .as_ref()
            .map_or(String::new(), |share| format!(" confidence {}", share.node));
        let (tails, end) = (
            if self.one_sided { "one" } else { "two" },
            if self.lower { "lower" } else { "upper" },
        );
        format!("{kind} over {} at {}{confidence} {tails} {end}", all(&self.over), all(&self.at))
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

fn sorted(names: &[At<String>]) -> String {
    let mut names: Vec<&str> = names.iter().map(|name| name.node.as_str()).collect();
    names.sort_unstable();
    names.join(", ")
}

/// With twelve digits, so that rounding of a conversion makes no difference.
fn number(value: f64, unit: Option<&Unit>) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    match unit {
        Some(unit) if unit.dimension != crate::units::Dimension::ONE => {
            format!("{rounded}{{{}}}", unit.dimension)
        }
        _ => rounded.to_string(),
    }
}
