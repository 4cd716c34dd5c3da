//! Zones, checks, plausibility rules, the rules of sections, domains.

use std::collections::BTreeSet;

use super::{Expr, Find, Input, Keep, Kind, Report, Step, Taken};
use crate::metrics::percentile::Method;
use crate::source::Span;
use crate::units::Unit;

/// A test zone.
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

/// A requirement on every section.
#[derive(Clone, Debug)]
pub struct Check {
    pub name: String,
    pub title: String,
    pub require: Expr,
    pub inputs: Vec<Input>,
    pub unless: Option<Expr>,
    pub words: String,
    pub otherwise: OnFault,
    /// Whether the verdict is not assessable where it cannot be checked.
    pub required: bool,
    pub span: Span,
}

/// What is done with a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFault {
    NotUsed,
    Note,
    Stop,
    /// The campaign is not assessable. Only for plausibility rules or a domain.
    NotAssessable,
}

/// A condition that sound data satisfy, checked in every section and at every position. A violation
/// is reported as a finding.
///
/// A block with several fields `of` gives one rule for each of them.
#[derive(Clone, Debug)]
pub struct Plausibility {
    pub name: String,
    pub title: String,
    /// Each position with the name of its signal; empty where the rule uses only data or named
    /// signals.
    pub signals: Vec<(String, Expr)>,
    /// The positions among them of which no quantity reads a channel.
    pub unread: Vec<String>,
    pub chain: Vec<Step>,
    pub test: Test,
    pub unless: Option<Expr>,
    pub otherwise: OnFault,
    /// Whether a finding at most positions is one of the record, of which all others follow.
    pub concerns_record: bool,
    pub cause: Option<String>,
    pub span: Span,
}

impl Plausibility {
    /// The order of findings: first those of whole records, then what a channel shows by itself or
    /// by its size, then those that need something else to compare it with.
    pub fn rank(&self) -> u8 {
        match &self.test {
            _ if self.concerns_record => 0,
            Test::Require(requirement) if requirement.of_one_channel(&self.signals) => 1,
            // A fault of single samples, or noise, changes the scatter, too.
            Test::Require(requirement) if requirement.of_size() => 2,
            _ => 3,
        }
    }

    /// What follows from a finding at a position. One at a position that no quantity reads is told,
    /// and the section stays.
    pub fn otherwise_at(&self, position: &str) -> OnFault {
        let unread = self.unread.iter().any(|unread| unread == position);
        if unread && self.otherwise == OnFault::NotUsed { OnFault::Note } else { self.otherwise }
    }
}

/// What a plausibility rule tests.
#[derive(Clone, Debug)]
pub enum Test {
    Require(Box<Requirement>),
    Distinct(Distinct),
    Exchanged(Exchanged),
}

/// A condition on data and on values taken from signals.
#[derive(Clone, Debug)]
pub struct Requirement {
    pub holds: Expr,
    pub inputs: Vec<Input>,
    pub of: Looks,
    /// The comparisons of which the condition consists, where it consists of such alone.
    pub compared: Vec<Comparison>,
    /// Where it is a requirement of all sections together, and not of each.
    pub over_sections: Option<OverSections>,
    pub words: String,
}

impl Requirement {
    /// Whether one record of a channel is compared with the other within a factor.
    fn of_size(&self) -> bool {
        let factor = |one: &Comparison| matches!(one.relation, Relation::WithinFactor);
        let both = self.inputs.array_windows().any(|[a, b]| a.side != b.side);
        both && !self.compared.is_empty() && self.compared.iter().all(factor)
    }

    /// Whether it is on samples of one channel of one record alone, whatever vehicle and section
    /// are.
    fn of_one_channel(&self, signals: &[(String, Expr)]) -> bool {
        let data = |part: &Expr| {
            matches!(part.kind, Kind::Vehicle(_) | Kind::Column(_) | Kind::Start | Kind::End)
        };
        let one_side = self.inputs.array_windows().all(|[a, b]| a.side == b.side);
        let own =
            |input: &Input| input.signal.is_none() && matches!(input.taken, Taken::Reduced(_));
        self.over_sections.is_none()
            && !self.holds.any(&data)
            && one_side
            && self.inputs.iter().all(own)
            && signals.iter().all(|(_, signal)| columns(signal).len() == 1)
    }
}

/// Names of the columns that a signal is computed from.
pub fn columns(signal: &Expr) -> BTreeSet<&str> {
    let mut all = BTreeSet::new();
    let mut parts = vec![signal];
    while let Some(part) = parts.pop() {
        if let Kind::Channel { column, .. } = &part.kind {
            all.insert(column.as_str());
        }
        parts.extend(part.parts());
    }
    all
}

/// Two numbers that are compared.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub holds: Expr,
    pub found: Expr,
    pub expected: Expr,
    /// The unit in which both are printed.
    pub unit: Unit,
    pub relation: Relation,
}

/// How the value found should be to the expected one.
#[derive(Clone, Debug)]
pub enum Relation {
    /// So near, SI.
    Within(Expr),
    WithinFactor,
    AtMost,
    AtLeast,
}

impl Relation {
    /// Whether the value found should be about the expected one, which else is a bound.
    pub fn about(&self) -> bool {
        matches!(self, Self::Within(_) | Self::WithinFactor)
    }
}

/// A requirement that the sections of a campaign meet together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OverSections {
    /// The median of the sections, and bounds of the slope of the values found over those expected.
    Level { slope: Option<(f64, f64)> },
    /// The change of what is found less what is expected, from the first section to the last.
    Change,
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
    /// Simulation and measurement, where all channels of the rule are the same from end to end.
    pub records: bool,
}

/// From when on a measured record or channel is reported that agrees with the simulation of another
/// section or with another simulated channel of its rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchanged {
    /// Least correlation with the other one.
    pub least: f64,
    /// By how much it exceeds that with its own.
    pub more: f64,
    /// From which correlation on the measurements of two sites are reported, if they are.
    pub alike: Option<f64>,
}

/// How sections are treated.
#[derive(Clone, Debug)]
pub struct SectionRules {
    pub whole_records: bool,
    /// How sections are found in the runs of a campaign that has no table of sections.
    pub find: Option<Find>,
    /// Data that follow from others, each after those that it reads.
    pub computed: Vec<super::DerivedDatum>,
    /// Record that there must be on each side of a found section, SI of the axis; without it, the
    /// length of the section.
    pub margin: Option<f64>,
    pub keep: Option<Keep>,
    /// Index of the column of the zone.
    pub zone: Option<usize>,
    pub only: Option<Expr>,
    pub only_words: String,
    pub faulty: OnFault,
    pub minimum: usize,
    /// The largest share of the sections that may be removed.
    pub most_removed: Option<f64>,
    /// Numbers of section data that are printed.
    pub reports: Vec<Report>,
    pub percentiles: Method,
}

/// What sections cover, and wanted operation is compared with.
#[derive(Clone, Debug)]
pub struct Domain {
    pub name: String,
    pub title: String,
    pub over: Vec<Coordinate>,
    /// Indices into [`Plan::columns`](super::Plan::columns): sections of other words are of another
    /// hull.
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
