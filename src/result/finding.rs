//! Findings about the data, with the value found and the expected value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{FindingData, told};
use crate::words::{self, Text};

/// A finding for the attention of the assessor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Kind of finding: the name of the protocol's rule, or a code of the program in kebab case.
    pub code: String,
    /// The channel, position or field concerned; `None` if it concerns a section or the campaign.
    pub channel: Option<String>,
    /// Which of several campaigns it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub campaign: Option<String>,
    /// `None` if it concerns the campaign.
    pub section: Option<String>,
    /// The kind of record: `simulation`, `measurement` or `track`.
    pub record: Option<String>,
    /// The value found, in `unit`.
    pub value: Option<f64>,
    /// The expected value, or the bound that is exceeded, in `unit`.
    pub expected: Option<f64>,
    pub unit: Option<String>,
    /// What it says.
    #[serde(flatten, with = "told::says")]
    #[schemars(with = "told::Says<FindingData>")]
    pub data: FindingData,
    /// The likely cause, if known.
    pub cause: Option<String>,
    pub consequence: Consequence,
}

/// Influence of a finding on the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// Reported only.
    Note,
    /// The section is not used.
    NotUsed,
    /// The campaign is not assessable.
    NotAssessable,
}

impl Consequence {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Note => "noted",
            Self::NotUsed => "section not used",
            Self::NotAssessable => "not assessable",
        }
    }
}

impl Finding {
    /// A finding about the campaign that is reported only.
    pub fn note(code: impl Into<String>, data: FindingData) -> Self {
        Self {
            code: code.into(),
            channel: None,
            campaign: None,
            section: None,
            record: None,
            value: None,
            expected: None,
            unit: None,
            data,
            cause: None,
            consequence: Consequence::Note,
        }
    }

    /// The finding as a sentence without a full stop.
    pub fn text(&self) -> Text {
        words::text(&self.data)
    }
}
