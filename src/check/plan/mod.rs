//! The checked protocol: names resolved, numbers in SI, dimensions checked, parameters inserted.

mod clause;
mod estimate;
mod expression;
mod filter;
mod find;
mod quantity;
mod section;
mod stated;
mod verdict;

use serde::{Deserialize, Serialize};

use crate::result::{self, Reason};
use crate::source::{Span, Spanned};
use crate::units::Unit;

pub use clause::*;
pub use estimate::*;
pub use expression::*;
pub use filter::*;
pub use find::*;
pub use quantity::*;
pub use section::*;
pub use stated::*;
pub use verdict::*;

/// A checked protocol.
#[derive(Clone, Debug)]
pub struct Plan {
    pub name: String,
    pub title: String,
    pub edition: Option<String>,
    pub source: Option<String>,
    pub scope: Option<String>,
    pub notes: Vec<String>,
    /// What of the standard it does not do.
    pub leaves_out: Vec<String>,
    /// In the order of the text.
    pub clauses: Vec<Clause>,
    pub axis: Axis,
    pub time: Option<Axis>,
    pub parameters: Vec<Parameter>,
    /// Values that are to be confirmed.
    pub values: StatedValues,
    pub vehicle: Vec<Datum>,
    pub columns: Vec<Datum>,
    /// Names of campaigns that conditions ask for, where they stand.
    pub campaigns: Vec<Spanned<String>>,
    pub records: Vec<DeclaredRecord>,
    /// Channels that records may lack.
    pub optional: Vec<OptionalChannel>,
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

    /// A verdict that is decided by draws of the sections.
    pub fn by_draws(&self) -> Option<&VerdictRule> {
        self.verdicts.iter().find(|rule| rule.decision.by_draws())
    }

    /// The same plan, with all plausibility findings as notes: they are reported and exclude no
    /// section.
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
    /// Where the protocol names it.
    pub span: Span,
}

/// A parameter and what it is set to, as printed.
#[derive(Clone, Debug)]
pub struct Parameter {
    pub name: String,
    pub title: String,
    pub value: String,
    pub default: String,
    pub set_by: SetBy,
    /// Whether it has no value, and nothing can be assessed without it.
    pub lacking: bool,
    /// Why its default is to be confirmed.
    pub unconfirmed: Option<String>,
    /// The words of a choice; empty otherwise.
    pub choices: Vec<String>,
    /// Of a number with a range.
    pub range: Option<ParameterRange>,
}

/// A number between the ends of its range, in the unit in which the range is written.
#[derive(Clone, Debug)]
pub struct ParameterRange {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    /// As written; `-` of a number without a unit.
    pub unit: String,
    /// The number and both ends are whole: it is a count.
    pub whole: bool,
}

impl ParameterRange {
    /// From the number and both ends in SI, and the range as written: `5 Hz to 60 Hz`.
    pub fn new(si: f64, ends: [f64; 2], written: &str) -> Self {
        let last = written.rsplit(" to ").next().unwrap_or_default();
        let unit = last.trim().split_once(' ').map_or("-", |(_, unit)| unit.trim());
        let known = Unit::parse(unit).ok();
        let shown = |si: f64| known.as_ref().map_or(si, |unit| unit.from_si(si));
        let (value, low, high) = (shown(si), shown(ends[0]), shown(ends[1]));
        let whole = unit == "-" && [value, low, high].iter().all(|number| number.fract() == 0.0);
        Self { value, low, high, unit: unit.to_owned(), whole }
    }
}

/// Who sets a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetBy {
    Default,
    Campaign,
    CommandLine,
}

/// A value that the vehicle file or the table of sections must contain, or of a section a value
/// that the protocol computes.
#[derive(Clone, Debug)]
pub struct Datum {
    pub name: String,
    pub title: String,
    /// Path in the vehicle file, or column header without unit.
    pub key: String,
    pub kind: DatumKind,
    pub default: Option<Scalar>,
    /// Whether campaigns may omit it. Rules that depend on it then apply as far as they hold for
    /// every value.
    pub optional: Option<Optional>,
    /// Whether the protocol computes it from others: [`SectionRules::computed`].
    pub computed: bool,
    /// Allowed values of a number; `None` where the protocol states none.
    pub range: Option<DatumRange>,
    pub span: Span,
}

impl Datum {
    /// Whether a table states it, or a campaign of its run.
    pub fn is_stated(&self) -> bool {
        !self.computed && self.kind != DatumKind::Campaign
    }
}

/// What follows for a rule from the absence of something that it needs and that may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optional {
    /// It is not assessed, and other rules are.
    NotAssessed,
    /// It is not assessable, and so the verdict on it.
    NotAssessable,
}

impl Optional {
    /// The reason that rules are told.
    pub fn told(self, absent: Reason) -> Reason {
        match self {
            Self::NotAssessed => Reason::Optional { reason: Box::new(absent) },
            Self::NotAssessable => absent,
        }
    }
}

/// A channel that records may lack.
#[derive(Clone, Debug)]
pub struct OptionalChannel {
    pub name: String,
    pub columns: Vec<String>,
    /// Whether it is one of the track record.
    pub track: bool,
    pub optional: Optional,
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

/// What values a datum has.
#[derive(Clone, Debug, PartialEq)]
pub enum DatumKind {
    Number(Unit),
    Words(Vec<String>),
    /// A word that the protocol does not list.
    AnyWord,
    Flag,
    /// The name of the section's campaign, which is not known before the run.
    Campaign,
}

/// A value of an expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Scalar {
    /// In SI.
    Number(f64),
    Word(String),
    Flag(bool),
}
