//! Remarks on how a result was made: data, whose sentences are in the table of texts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    ParameterInfo, Reason, StatisticName, Unmatched,
    parts::{RecordsOf, Sections},
};
use crate::words::{self, Text};

/// What a result remarks without a change of its verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Remark {
    /// As a file of results without data has it.
    Said {
        says: String,
    },

    // Certifications.
    /// What the protocol does not do of its standard.
    LeavesOut {
        says: String,
    },
    /// A record that was changed after its import.
    RecordEdited {
        file: String,
        reason: String,
    },
    /// Rules that differ from the parent protocol.
    RulesChanged {
        rules: usize,
    },
    ParametersSet {
        parameters: Vec<ParameterInfo>,
    },
    /// Beside a verdict: how many values nobody confirmed.
    Provisional {
        values: usize,
    },
    /// Beside a verdict: how many quantities it does not speak of.
    WithoutQuantities {
        quantities: usize,
    },
    /// A confirmation of a value in `campaign.yaml` that does not count.
    ConfirmationNotCounted {
        name: String,
        by: String,
        why: Unmatched,
    },
    Origin {
        says: String,
    },
    FittedToTheSame,
    /// Effects that were added to the simulation, which was fitted to other measurements if so.
    SimulationWith {
        effects: Vec<String>,
        fitted: bool,
    },
    /// Channels that some records lack, whose positions are left out.
    LackingChannels {
        channels: Vec<String>,
        records: Vec<RecordsOf>,
    },
    /// A quantity that is not assessed, or not in all, for want of something optional.
    NotAssessed {
        quantity: String,
        in_part: bool,
        reason: Reason,
    },
    /// Plausibility rules that are not checked, for want of an optional channel.
    RulesNotChecked {
        rules: Vec<String>,
        reason: Reason,
    },
    /// What was added to the axis of the measurement, by a column of the table of sections.
    Shifted {
        axis: String,
        unit: String,
        column: String,
        offsets: Vec<SectionOffset>,
    },
    /// An uncertainty of a channel that the protocol does not read.
    UncertaintyNotUsed {
        channel: String,
    },
    /// A check that a section does not meet.
    OfSection {
        section: String,
        reason: Reason,
    },
    Unchecked {
        check: String,
        reason: Reason,
        sections: Sections,
    },
    /// Records that end sooner beyond their section than a slow filter needs; trials say how far
    /// values then move. Times in s, the frequency in Hz, shares in %.
    ShortMargins {
        short: usize,
        sections: usize,
        least: f64,
        needed: f64,
        frequency: f64,
        rms: u8,
        extreme: u8,
    },
    NoPlot {
        quantity: String,
        section: String,
        reason: Reason,
    },

    // Studies.
    /// Even the sections with the most pairs have too few.
    NoSelectionSuffices {
        quantity: String,
        most: usize,
        needed: usize,
    },
    VerdictChanged {
        now: String,
        before: String,
    },
    /// A reason of the verdict on all sections that is new, or no longer one.
    ReasonChanged {
        gone: bool,
        reason: Reason,
    },
    /// Of a single selection: its criterion is newly met, or no longer.
    CriterionChanged {
        statistic: StatisticName,
        quantity: String,
        met: bool,
    },

    // Diagnoses.
    SimulationFailed {
        says: String,
    },
    SectionExcluded {
        section: String,
        says: String,
    },
    SectionRepeats {
        section: String,
    },
    UnknownTolerance {
        name: String,
    },
    NoToleranceDeclared,
    Outlying {
        sections: Vec<OutlyingSection>,
    },
    /// What is left is larger or smaller than what is allowed, which would have to be multiplied by
    /// a factor, known to `within`.
    WrongAllowance {
        larger: bool,
        chi2_per_feature: f64,
        factor: f64,
        within: f64,
    },
    StandingDiscrepancyFrom {
        campaigns: Vec<String>,
    },
    NoSimulator,
}

/// What is added to the axis of the measurement of a section.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SectionOffset {
    pub section: String,
    pub offset: f64,
}

/// A section with the channels in which it differs from the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OutlyingSection {
    pub section: String,
    pub channels: Vec<String>,
}

impl Remark {
    /// Its sentence.
    pub fn text(&self) -> Text {
        words::text(self)
    }
}
