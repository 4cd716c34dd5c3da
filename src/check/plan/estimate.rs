//! Limits, the estimates that they are of, and the groups of values.

use super::{Expr, Kind};
use crate::catalog::Statistic;
use crate::result::Direction;
use crate::source::Span;
use crate::units::Unit;

/// A limit of an estimate, for the rows of its scope.
#[derive(Clone, Debug)]
pub struct Limit {
    pub estimate: Estimate,
    pub direction: Direction,
    /// Whether it is an edge of `between ... and ...`. The lower one, which is `at least`, stands
    /// before the upper one, which is `at most`; both have the same place and scope.
    pub edge: bool,
    pub bound: OfGroup,
    /// Each factor with the condition under which it applies.
    pub factors: Vec<(Expr, Expr)>,
    pub only_when: Option<Expr>,
    pub scope: Scope,
    /// As written: `2/3 of limit of std`.
    pub words: String,
    /// As printed: `2/3 of the limit of std`.
    pub printed: String,
    /// A number in it is to be confirmed.
    pub unconfirmed: bool,
    pub span: Span,
}

impl Limit {
    /// Whether it is the lower edge of two, of which the upper one stands behind it.
    pub fn is_lower_edge(&self) -> bool {
        self.edge && self.direction == Direction::AtLeast
    }
}

/// An estimate without a limit. It is printed and decides nothing. One `for each zone` gives one
/// for every zone.
#[derive(Clone, Debug)]
pub struct Report {
    pub estimate: Estimate,
    pub scope: Scope,
    /// As written: `mean for each zone`.
    pub words: String,
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
    /// Unit in which it is printed, where it differs from that of the values: for a share or a
    /// length.
    pub unit: Option<Unit>,
}

/// How an estimate is taken from the rows of a group.
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
            EstimateKind::Of(of) => match of.alone()? {
                Taking::Statistic(statistic, ddof) => Some((*statistic, *ddof)),
                _ => None,
            },
        }
    }

    /// The weighted statistic that it is and nothing more: statistic, n - `ddof`, weight.
    pub fn weighted(&self) -> Option<(Statistic, usize, &Expr)> {
        let EstimateKind::Of(of) = &self.kind else { return None };
        match of.alone()? {
            Taking::Weighted { statistic, ddof, by } => Some((*statistic, *ddof, by)),
            _ => None,
        }
    }
}

/// An expression over numbers taken from the rows of a group; [`Kind::Input`] is an index into
/// `taken`.
#[derive(Clone, Debug)]
pub struct OfGroup {
    pub expr: Expr,
    pub taken: Vec<Taking>,
}

impl OfGroup {
    /// The number taken from the rows, if it is that and nothing more.
    pub fn alone(&self) -> Option<&Taking> {
        match (&self.expr.kind, self.taken.as_slice()) {
            (Kind::Input(0), [taking]) => Some(taking),
            _ => None,
        }
    }

    /// Whether an end of a confidence interval is taken, also of groups of the rows.
    pub fn has_bound(&self) -> bool {
        self.taken.iter().any(|taking| match taking {
            Taking::Bound { .. } => true,
            Taking::EachGroup { of, .. } => of.has_bound(),
            _ => false,
        })
    }

    /// Indices of the other quantities whose rows it needs.
    pub fn others(&self) -> Vec<usize> {
        fn of(taking: &Taking) -> Vec<usize> {
            match taking {
                Taking::Other { quantity, .. } => vec![*quantity],
                Taking::Where { others, .. } => others.iter().flat_map(of).collect(),
                Taking::Bound { of, .. } => of.others(),
                Taking::EachGroup { of, .. } => of.others(),
                Taking::Fit(fit) => fit.at.iter().flat_map(OfGroup::others).collect(),
                Taking::Statistic(..)
                | Taking::Weighted { .. }
                | Taking::Count
                | Taking::Data { .. } => Vec::new(),
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
    /// Share of the rows, or of the sections, that satisfy a condition, or how many there are.
    /// [`Kind::Input`] 0 is the value of a row; inputs from 1 on are `others`, statistics of other
    /// quantities.
    Where {
        share: bool,
        condition: Expr,
        of_sections: bool,
        others: Vec<Taking>,
        /// What rows or sections count by, if not all alike.
        by: Option<Expr>,
    },
    /// A statistic of all rows of another quantity, an index into
    /// [`Plan::quantities`](super::Plan::quantities).
    Other {
        quantity: usize,
        id: String,
        statistic: Statistic,
        ddof: usize,
    },
    /// A number from data of the group's sections, each section counted once; or of the rows, of
    /// which [`Kind::Input`] 0 is the value.
    Data {
        reducer: DataReducer,
        of: Expr,
        of_rows: bool,
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

/// How one number is taken from many.
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

/// The rows that a limit applies to, and their groups. A limit `for each zone` gives one limit for
/// every zone.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Only rows of these zones; all rows if empty.
    pub zones: Vec<String>,
    pub each: Vec<Key>,
    pub condition: Option<(Expr, String)>,
}

impl Scope {
    /// Whether all rows form one group.
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
    /// Index into [`Plan::columns`](super::Plan::columns).
    Column(usize),
}
