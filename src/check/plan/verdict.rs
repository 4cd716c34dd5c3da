//! Verdicts, and the unit of independence.

use crate::source::Span;

/// What counts as one independent unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Independent {
    #[default]
    Site,
    Section,
    /// Index into [`Plan::columns`](super::Plan::columns).
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

/// By what a verdict is decided.
#[derive(Clone, Debug)]
pub enum Decision {
    /// By the limits of quantities, given by index: once, or in a share (0 to 1) of draws of the
    /// independent units.
    Limits { rule: Rule, quantities: Vec<usize>, draws: Option<f64> },
    /// By other verdicts.
    Verdicts(Over),
    /// By a person.
    Person(String),
    /// The first of several outcomes whose rule is met; the last has none.
    Ordered(Vec<Grade>),
}

/// One of several outcomes of a verdict.
#[derive(Clone, Debug)]
pub struct Grade {
    pub word: String,
    /// Whether the verdict then holds.
    pub holds: bool,
    pub when: Option<Box<Decision>>,
}

impl Decision {
    /// The quantities whose limits it needs, each once.
    pub fn quantities(&self) -> Vec<usize> {
        match self {
            Self::Limits { quantities, .. } => quantities.clone(),
            Self::Verdicts(_) | Self::Person(_) => Vec::new(),
            Self::Ordered(grades) => of_grades(grades, Self::quantities),
        }
    }

    /// Whether it is decided by draws, also if one of several outcomes is.
    pub fn by_draws(&self) -> bool {
        match self {
            Self::Limits { draws, .. } => draws.is_some(),
            Self::Verdicts(_) | Self::Person(_) => false,
            Self::Ordered(grades) => {
                grades.iter().filter_map(|grade| grade.when.as_deref()).any(Self::by_draws)
            }
        }
    }

    /// The other verdicts that it needs, each once.
    pub fn verdicts(&self) -> Vec<usize> {
        match self {
            Self::Verdicts(over) => over.verdicts(),
            Self::Limits { .. } | Self::Person(_) => Vec::new(),
            Self::Ordered(grades) => of_grades(grades, Self::verdicts),
        }
    }
}

fn of_grades(grades: &[Grade], of: fn(&Decision) -> Vec<usize>) -> Vec<usize> {
    let mut all: Vec<usize> =
        grades.iter().filter_map(|grade| grade.when.as_deref()).flat_map(of).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// A condition on other verdicts, given by their index in
/// [`Plan::verdicts`](super::Plan::verdicts).
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

/// How many limits must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    EveryLimit,
    AtLeastQuantities(usize),
    AtLeastLimits(usize),
}
