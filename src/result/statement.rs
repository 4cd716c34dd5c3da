//! What a diagnosis states: data, whose sentences are in the table of texts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A sentence of a diagnosis. Shares are numbers from 0 to 1, deviations are in declared standard
/// deviations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Statement {
    /// As a file without data has it.
    Said {
        says: String,
    },
    FaultyRecording {
        says: String,
        sections: Vec<String>,
    },
    WithinTheAllowed,
    Explained {
        cause: String,
    },
    /// The answer and what could replace it, if that has a name.
    NotDistinguished {
        causes: Vec<String>,
    },
    BeatenInResamples {
        title: String,
        share: f64,
    },
    /// A tolerance that explains more than a member of the answer: by this evidence.
    InPlaceOf {
        parameter: String,
        tolerance: String,
        deviations: f64,
        evidence: f64,
    },
    OutsideTheCatalogue {
        parameter: String,
        tolerance: String,
        deviations: f64,
        evidence: f64,
    },
    /// A further candidate beside the answer, and what it lacks.
    Beside {
        says: String,
        wants: String,
        evidence: f64,
    },
    ToleranceExceeded {
        parameter: String,
        tolerance: String,
        deviations: f64,
    },
    /// The fit used more of a tolerance than an effect may have without being named.
    ToleranceUsed {
        parameter: String,
        tolerance: String,
        deviations: f64,
    },
    NothingExceedsTheAllowed,
    Systematic {
        catalogue: String,
    },
    NothingElseRemains {
        catalogue: String,
    },
    RemainsIn {
        catalogue: String,
        channels: Vec<RemainsOf>,
    },
    PartlyExplained {
        cause: String,
        remains: f64,
    },

    // Reasons of the verdict.
    CriteriaNotMet,
    LargerThanAllowed,
    NotSmallerOnHeldOut,
    NotSmaller,
    StillMoving,
    CriteriaNotTouched,

    // How the gap changes with the effects, with 90 % intervals.
    OnExcludedSections {
        before: f64,
        after: f64,
        removed: f64,
        low: f64,
        high: f64,
    },
    OnHeldOutSections {
        what: String,
        sections: usize,
        before: f64,
        after: f64,
        removed: f64,
        low: Option<f64>,
        high: Option<f64>,
    },

    // What is left.
    NoSingleSize {
        title: String,
        signals: Vec<String>,
        covariate: String,
        parameter: String,
        unit: String,
        change: f64,
        low: f64,
        high: f64,
        from: String,
        to: String,
    },
    DependsOn {
        quantity: String,
        position: String,
        band: String,
        covariate: String,
        change: f64,
        unit: String,
        from: String,
        to: String,
        correlation: f64,
    },
    LargestSum {
        name: String,
        after: f64,
        unit: String,
        times: f64,
        parity: String,
    },
    SpectraAlike {
        quantity: String,
    },
    /// In Hz; a ratio of amplitudes.
    SpectraDiffer {
        quantity: String,
        frequency: f64,
        ratio: f64,
    },
    SpectraByFrequency {
        quantity: String,
        frequency: f64,
        ratio: f64,
    },
    /// In m; with the number of waves per wheel revolution, if it is a whole one.
    SpectraByWavelength {
        quantity: String,
        wavelength: f64,
        ratio: f64,
        turns: Option<f64>,
    },
    /// Two causes that data of this kind discriminate, so that neither is the whole cause.
    FurtherEffect {
        one: String,
        other: String,
        deviations: f64,
    },
}

/// A channel with a difference that remains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RemainsOf {
    pub channel: String,
    pub dynamic: bool,
}
