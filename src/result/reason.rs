//! Why a result is what it is, and what findings say: data, whose sentences are in the table of
//! texts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    parts::{
        Beyond, Channels, Datum, GivenVerdict, InDraws, LimitNotMet, OfVehicle, RecordsOf,
        Sections, ShortZone, Subject, SuspectedFactor,
    },
    told,
};
use crate::words::{self, Text};

/// Why something has no value, is not used, does not hold or is not assessable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Reason {
    /// A reason with what it is about.
    About {
        subject: Subject,
        name: String,
        reason: Box<Self>,
    },
    /// A reason with the estimate or domain that it is about, and with the group if it is one of
    /// several.
    OfEstimate {
        title: String,
        scope: Option<String>,
        reason: Box<Self>,
    },
    /// Two reasons, such as those of both records of a section.
    Both {
        first: Box<Self>,
        second: Box<Self>,
    },
    /// What the reader of an input text says of it, or a file of results without data.
    Said {
        says: String,
    },
    /// A file cannot be read.
    Unreadable {
        says: String,
    },
    /// What a method of computation says of its numbers.
    Method {
        says: String,
    },
    /// Something optional is absent: what needs it is not assessed, and the rest is.
    Optional {
        reason: Box<Self>,
    },
    /// A finding that excludes the section.
    Finding {
        finding: Box<FindingData>,
    },
    /// A step that the checker of protocols excludes.
    Internal,

    // Expressions, and the names in them.
    NoCaseOf {
        expression: String,
    },
    NotFinite {
        expression: String,
    },
    NotNumber {
        expression: String,
        value: String,
    },
    NotCondition {
        expression: String,
        value: String,
    },
    VehicleDataUnknown,
    SectionDataUnknown,
    NoSectionHere,
    NoSignalHere,
    NoPairHere,
    LimitUnknown {
        estimate: String,
    },
    DiffersBetweenSections,
    DependsOnVehicle {
        values: Vec<OfVehicle>,
    },
    NoVehicle,
    VehicleDataNotStated {
        key: String,
    },
    ParameterNotStated {
        parameter: String,
    },
    /// Parameters without which nothing can be assessed.
    ParametersNotStated {
        parameters: Vec<String>,
    },

    // The table of sections and the data of runs.
    NoColumn {
        column: String,
    },
    /// As [`Self::EmptyCell`], of a file of results.
    EmptyDatum {
        column: String,
    },
    EmptyCell {
        column: String,
        file: String,
        row: usize,
    },
    WrongCell {
        column: String,
        says: String,
        file: String,
        row: usize,
    },
    StartNotBeforeEnd {
        file: String,
        row: usize,
    },
    UnknownOfWholeRecord {
        column: String,
    },
    NotStatedOfRun {
        column: String,
        run: String,
    },
    WrongUnitOfRun {
        column: String,
        run: String,
        unit: String,
    },
    WrongDataOfRun {
        column: String,
        run: String,
        says: String,
    },

    // Records.
    NoChannel {
        channel: String,
    },
    /// An optional channel: its columns that some records lack, and the most similar one that they
    /// have.
    NotRecorded {
        channel: String,
        columns: Vec<String>,
        records: Vec<RecordsOf>,
        near: Option<String>,
    },
    NoCaseOfSignal {
        expression: String,
    },
    NoSampleBetween {
        from: f64,
        to: f64,
    },
    NoSampleInside,
    NoSampleSatisfies,
    TooFewSamples,
    MeanOfNothing,
    RecordTooShort {
        first: f64,
        last: f64,
        from: f64,
        to: f64,
    },
    /// The sample is in a row of the file, or at a place of the axis.
    NotFiniteSample {
        row: Option<usize>,
        at: Option<f64>,
    },
    NotFiniteResult {
        row: Option<usize>,
        at: Option<f64>,
    },
    /// A number, or a sample in a row of the file or at a place of the axis, is not between the
    /// first and the last point of its table.
    OutsideTable {
        of: String,
        row: Option<usize>,
        at: Option<f64>,
    },
    /// Samples of channels that others are divided by; where the first of them is.
    DividedByZero {
        channels: Vec<String>,
        zeros: usize,
        samples: usize,
        row: Option<usize>,
        at: Option<f64>,
    },
    NotFiniteNumber,
    DifferentSampling,
    ReducerUndefined {
        reducer: String,
        samples: usize,
    },
    NotInterpolated {
        repeat: bool,
        says: String,
    },
    TooShortForShift {
        says: String,
    },
    NoSamplesOfConstant,
    ShiftedOut {
        shift: f64,
        missing: f64,
    },
    InputMissing,
    ValueMissing,
    SignalMissing,
    SectionNumberMissing,
    /// No shift changes the channels by so many standard deviations.
    NoShift {
        section: String,
        size: f64,
    },
    OneRecord {
        side: String,
    },
    NoValueApplies,
    NoMeanOfRecords,
    NoSamples,
    NoRecordOfSide {
        side: String,
    },
    SignalsNotKept,

    // The search for sections in runs.
    RecordEnds,
    InNoZone,
    /// Of some zones, for want of some vehicle data.
    LengthWithoutValue {
        zones: Vec<String>,
        keys: Vec<String>,
    },
    ConditionOfSearch {
        condition: String,
    },
    LengthWithoutBound {
        reason: Box<Self>,
    },

    // Requirements on sections.
    /// A condition on data of the section, with the data that it reads.
    Condition {
        holds: bool,
        condition: String,
        found: Vec<Datum>,
    },
    Length {
        length: f64,
        minimum: f64,
        unit: String,
    },
    /// Long enough whatever data are missing.
    LongEnough {
        length: f64,
        most: f64,
        unit: String,
    },
    NotChecked {
        reason: Box<Self>,
    },
    /// What the protocol requires, in sections that are used.
    RequiredNotChecked {
        check: String,
        reason: Box<Self>,
        sections: Sections,
    },
    NoTrackRecord,
    RecordsNotEvaluated,
    DoesNotApply,
    ZoneNotMet {
        zone: String,
        reason: Box<Self>,
    },
    ZoneUnknown {
        zone: String,
        reason: Box<Self>,
    },
    LeftOutByReduction {
        kept: String,
    },
    ValuesMissing,
    LeftOut,
    ValuesOfSectionsMissing {
        sections: Vec<String>,
        total: usize,
    },

    // Estimates and limits.
    NoValue,
    NoValueInGroup,
    NoRowsOf {
        quantity: String,
    },
    NegativeWeight {
        weight: String,
    },
    NoPositiveWeight,
    NoInterval,
    Undefined {
        count: usize,
        groups: bool,
    },
    UndefinedWeighted {
        count: usize,
    },
    AllEqual {
        count: usize,
    },
    EmptyShare,
    GroupUnknown {
        section: String,
        reason: Box<Self>,
    },
    LimitApplicationUnknown {
        reason: Box<Self>,
    },
    NoLimit {
        reason: Box<Self>,
    },
    NoLimitOf {
        estimate: String,
    },
    LimitDependsOnItself,
    LimitNotPositive,
    EdgesCrossed,
    EdgesCounted,
    /// Vehicles of one group have different limits.
    GiveEachItsOwn {
        reason: Box<Self>,
        campaigns: bool,
    },
    LimitNotMet(LimitNotMet),
    TooFewPairs {
        pairs: usize,
        rows: usize,
        minimum: usize,
    },
    TooFewInGroups {
        group: String,
        reason: Box<Self>,
        others: usize,
    },
    TooFewSignals {
        signals: usize,
        minimum: usize,
    },
    NotEvaluated {
        section: String,
        reason: Box<Self>,
        others: usize,
    },
    NoRepeats,
    SameWhateverRecords {
        value: f64,
        unit: String,
    },
    FailsAlone {
        simulations: usize,
        simulation: String,
        reason: Box<Self>,
    },

    // Verdicts.
    NoVerdict,
    ToBeJudged {
        person: String,
    },
    TooFewQuantities {
        met: usize,
        quantities: usize,
        minimum: usize,
    },
    TooFewLimits {
        met: usize,
        minimum: usize,
    },
    /// In how many draws of the sections a rule holds.
    InDraws(InDraws),
    /// A unit that no other can be drawn for, with sections in these zones.
    TooFewToDraw {
        zones: Vec<String>,
    },
    DrawsNeedValues,
    /// No limit is stated, or none applies; of the whole protocol or of the quantities of a
    /// verdict.
    NoCriterion {
        stated: bool,
        protocol: bool,
    },
    VerdictsRequired {
        verdicts: Vec<GivenVerdict>,
        required: String,
    },
    ZoneTooSmall {
        zone: String,
        used: usize,
        sites: usize,
        minimum: usize,
    },
    /// Several zones that need the same number.
    ZonesTooSmall {
        zones: Vec<ShortZone>,
        minimum: usize,
    },
    /// What another table says in full.
    SeeVerdict,
    /// A zone has fewer sections than a selection takes; some of those that are not used.
    TooFewToSelect {
        zone: String,
        sections: usize,
        take: usize,
        unused: Vec<UnusedSection>,
    },
    TooFewSitesToSelect {
        zone: String,
        sites: usize,
        take: usize,
    },
    TooFewInBoth {
        zone: String,
        sections: usize,
        take: usize,
    },
    NoSelectionDecides,
    NothingDependsOnSections,
    TooFewSections {
        used: usize,
        sites: usize,
        minimum: usize,
    },
    /// Of the sections, with the largest share allowed, in %.
    TooManyRemoved {
        removed: usize,
        sections: usize,
        most: f64,
        names: Vec<String>,
    },
    NoSectionOfCampaign {
        campaign: String,
    },
    Implausible {
        rule: String,
        sections: usize,
    },
    NotUsedFor {
        rule: String,
        sections: usize,
    },
    /// Records that are not as they were imported, for which no reason is stated.
    RecordsChanged {
        records: usize,
    },

    // Comparisons of protocols.
    /// Further problems of the campaign.
    AndMore {
        more: usize,
    },
    NotTried,
    SectionAlone,
    MetricWithoutNumber,
    NoCommonScore,
    TooFewCommonScores,
    EqualScores,

    // Wanted operation.
    NoSectionUsed {
        group: Option<String>,
    },
    TooFewForHull {
        sections: usize,
        coordinates: usize,
    },
    FlatHull {
        extends: usize,
        coordinates: usize,
        same: Vec<String>,
    },
    PointsOutside {
        outside: usize,
        points: usize,
    },
    DependsOnVehicles {
        vehicles: usize,
    },

    // Selections of sections.
    NotAllEvaluated,
    UndefinedInAnySelection,

    // Causes.
    /// Vehicle data on which a limit depends.
    VehicleData {
        data: Vec<Datum>,
    },
    WithoutSignal,
    /// A value has another sign than the expected one, or differs from it by a factor.
    WrongSize {
        reversed: bool,
        factor: Option<SuspectedFactor>,
    },
}

/// The number that sections have together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OfSections {
    /// The median of their values.
    Level,
    /// The slope of the values found over those expected.
    Slope,
    /// The change of the values from the first section to the last.
    Change,
}

/// What a finding says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum FindingData {
    /// As a file of results without data has it.
    Said { says: String },
    /// A requirement of a rule is not met. Where it compares two numbers: what is compared, its
    /// value and the one expected.
    Required {
        rule: String,
        what: Option<String>,
        value: Option<f64>,
        expected: Option<f64>,
        unit: String,
        required: String,
    },
    /// A requirement that all sections meet together is not met: the number that is compared, with
    /// its interval, and the bounds.
    OverSections {
        rule: String,
        what: String,
        of: OfSections,
        value: f64,
        low: f64,
        high: f64,
        least: Option<f64>,
        most: Option<f64>,
        unit: String,
        sections: usize,
    },
    /// Channels repeat the samples of others, or of the same channels: of another record or section
    /// if these are named.
    Copies {
        rule: String,
        channels: Channels,
        copied: Option<Channels>,
        record: Option<String>,
        section: Option<String>,
    },
    /// A rule could not be checked at a position, for its samples.
    RuleNotChecked { rule: String, reason: Reason },
    /// A measured channel is more like another simulated one than its own.
    Exchanged {
        rule: String,
        channel: String,
        other: String,
        correlation: f64,
        own_correlation: f64,
    },
    /// A measured record, or a channel of it, does not belong where it stands: it agrees with another
    /// section, with the measurement there or better than with its own simulation; or with none,
    /// though others do.
    Matched {
        rule: String,
        section: Option<String>,
        record: Option<String>,
        correlation: f64,
        own_correlation: Option<f64>,
    },
    /// A record is not as an import wrote it; why, if the campaign says so.
    RecordChanged { file: String, imported: bool, reason: Option<String> },
    /// As earlier versions told a requirement that could not be checked.
    CheckWithoutVehicleData { key: String, check: String, sections: Sections },
    /// Rules were not checked for want of a column.
    RulesWithoutColumn { column: String, sections: Sections, rules: Vec<String> },
    /// Vehicle data are read in the units of the protocol.
    UnitsAssumed { vehicle: Option<String>, data: Vec<Datum> },
    /// Limits are multiplied for a reason in the vehicle data.
    FactorOfLimits { quantities: Vec<String>, by: f64, because: Reason },
    /// Regressions are read outside their data. Of one estimate, its title and groups.
    ReadOutside {
        quantities: Vec<String>,
        estimates: usize,
        estimate: Option<String>,
        groups: Vec<String>,
        regressor: String,
        target: f64,
        beyond: f64,
        low: f64,
        high: f64,
        unit: String,
    },
    /// Estimates with regressions lie far beyond the values that they are from. The farthest one, and
    /// the range of its values.
    BeyondMeasured {
        quantity: String,
        estimates: usize,
        estimate: String,
        group: Option<String>,
        value: f64,
        count: usize,
        low: f64,
        high: f64,
        unit: String,
    },
    /// A point of wanted operation lies outside the sections; the distance is in their range.
    OutsideDomain {
        title: String,
        scope: Option<String>,
        point: String,
        distance: Option<f64>,
        by: Vec<Beyond>,
        nearest: Option<String>,
    },
    /// Sections of which there are measured records, and which the table does not name.
    NotInTable { sections: Vec<String> },
    /// Of points of wanted operation nothing can be said.
    NoDomain { title: String, scope: Option<String>, reason: Reason, points: usize },
}

/// A section that is not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnusedSection {
    pub section: String,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::OneReason<Reason>")]
    pub reason: Reason,
}

impl FindingData {
    /// Title of the plausibility rule that it comes from.
    pub fn rule(&self) -> Option<&str> {
        match self {
            Self::Required { rule, .. }
            | Self::OverSections { rule, .. }
            | Self::Copies { rule, .. }
            | Self::RuleNotChecked { rule, .. }
            | Self::Matched { rule, .. }
            | Self::Exchanged { rule, .. } => Some(rule),
            _ => None,
        }
    }

    /// Whether both say the same of some place, whatever it is and whatever the values are.
    pub fn alike(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Required { required, .. }, Self::Required { required: other_one, .. }) => {
                self.rule() == other.rule() && required == other_one
            }
            (Self::OverSections { of, .. }, Self::OverSections { of: other_one, .. }) => {
                self.rule() == other.rule() && of == other_one
            }
            (Self::Copies { .. }, Self::Copies { .. })
            | (Self::Exchanged { .. }, Self::Exchanged { .. })
            | (Self::Matched { .. }, Self::Matched { .. })
            | (Self::RuleNotChecked { .. }, Self::RuleNotChecked { .. }) => {
                self.rule() == other.rule()
            }
            (
                Self::RecordChanged { imported, reason, .. },
                Self::RecordChanged { imported: of, reason: other_one, .. },
            ) => (imported, reason) == (of, other_one),
            _ => self == other,
        }
    }
}

impl Reason {
    /// What an input text says of itself.
    pub fn said(says: impl Into<String>) -> Self {
        Self::Said { says: says.into() }
    }

    /// What a method of computation says.
    pub fn method(error: impl std::fmt::Display) -> Self {
        Self::Method { says: error.to_string() }
    }

    /// The reason with what it is about.
    pub fn about(self, subject: Subject, name: impl Into<String>) -> Self {
        Self::About { subject, name: name.into(), reason: Box::new(self) }
    }

    /// The reason without the verdicts that it comes through.
    pub fn root(&self) -> &Self {
        match self {
            Self::About { subject: Subject::Verdict, reason, .. } => reason.root(),
            _ => self,
        }
    }

    /// Whether a section is not used for what was asked, and not for what its data are.
    pub fn is_choice(&self) -> bool {
        matches!(self, Self::LeftOutByReduction { .. } | Self::LeftOut | Self::ValuesMissing)
    }

    /// Whether samples of a record have no finite result.
    pub fn is_of_samples(&self) -> bool {
        match self {
            Self::NotFiniteSample { .. }
            | Self::NotFiniteResult { .. }
            | Self::OutsideTable { row: Some(_), .. }
            | Self::DividedByZero { .. } => true,
            Self::About { reason, .. } => reason.is_of_samples(),
            Self::Both { first, second } => first.is_of_samples() || second.is_of_samples(),
            _ => false,
        }
    }

    /// Whether it is for the absence of something optional alone.
    pub fn is_of_optional(&self) -> bool {
        match self {
            Self::Optional { .. } => true,
            Self::About { reason, .. }
            | Self::OfEstimate { reason, .. }
            | Self::NotChecked { reason }
            | Self::GroupUnknown { reason, .. }
            | Self::LimitApplicationUnknown { reason }
            | Self::NoLimit { reason }
            | Self::GiveEachItsOwn { reason, .. } => reason.is_of_optional(),
            Self::Both { first, second } => first.is_of_optional() && second.is_of_optional(),
            _ => false,
        }
    }

    /// Whether a file could not be read.
    pub fn is_unreadable(&self) -> bool {
        match self {
            Self::Unreadable { .. } => true,
            Self::About { reason, .. } => reason.is_unreadable(),
            Self::Both { first, second } => first.is_unreadable() || second.is_unreadable(),
            _ => false,
        }
    }

    /// The same, with the quantity that it is about called as `name` says.
    pub fn naming(&self, called: impl Fn(&str) -> String) -> Self {
        match self {
            Self::About { subject: Subject::Quantity, name, reason } => {
                reason.as_ref().clone().about(Subject::Quantity, called(name))
            }
            other => other.clone(),
        }
    }

    /// Whether both are of the same limit or the same in all, whatever the value compared with a
    /// limit is.
    pub fn same_limit(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::About { subject, name, reason },
                Self::About { subject: of, name: other_name, reason: other },
            ) => (subject, name) == (of, other_name) && reason.same_limit(other),
            (Self::LimitNotMet(one), Self::LimitNotMet(other)) => {
                (&one.estimate, &one.scope) == (&other.estimate, &other.scope)
            }
            _ => self == other,
        }
    }

    /// Whether both come from the same rule, whatever the numbers are.
    pub fn same_rule(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::About { subject, name, .. },
                Self::About { subject: of, name: other_name, .. },
            ) => (subject, name) == (of, other_name),
            (Self::Finding { finding }, Self::Finding { finding: other }) => {
                finding.rule().is_some() && finding.rule() == other.rule()
            }
            (Self::ZoneNotMet { zone, .. }, Self::ZoneNotMet { zone: other, .. }) => zone == other,
            _ => self == other,
        }
    }

    /// Its sentence, without a full stop.
    pub fn text(&self) -> Text {
        words::text(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_known_again_whatever_its_value() {
        let reason = |estimate: &str, scope: &str, value: f64| {
            let reason = Reason::LimitNotMet(LimitNotMet {
                estimate: estimate.into(),
                scope: Some(scope.into()),
                value: Some(value),
                limit: Some(3.33),
                unit: "kN".into(),
                at_least: false,
            });
            reason.about(Subject::Quantity, "Q")
        };
        let known = reason("95 % value", "zones 1, 2", 4.33);
        assert!(known.same_limit(&reason("95 % value", "zones 1, 2", -5.1)));
        assert!(!known.same_limit(&reason("95 % value", "zone 1", 4.33)));
        assert!(!known.same_limit(&reason("90 % value", "zones 1, 2", 4.33)));
    }
}
