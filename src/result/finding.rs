//! What is not plausible in the data, with the number found and what it should be near.

use serde::{Deserialize, Serialize};

/// Something in the campaign that an assessor has to look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What kind of finding: the name of the protocol's rule, or a code of the program in kebab case.
    pub code: String,
    /// The channel, position or field that it is about; `None` if it is about a section or the campaign.
    pub channel: Option<String>,
    /// `None` if it is about the campaign as a whole.
    pub section: Option<String>,
    /// The kind of record: `simulation`, `measurement` or `track`.
    pub record: Option<String>,
    /// What was found, in `unit`.
    pub value: Option<f64>,
    /// What it should be near, or the bound that it passes, in `unit`.
    pub expected: Option<f64>,
    pub unit: Option<String>,
    /// The fact as a sentence without a full stop, complete by itself.
    pub says: String,
    /// The likely cause, where the numbers suggest one.
    pub cause: Option<String>,
    pub consequence: Consequence,
}

/// What a finding does to the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// It is told and changes nothing.
    Note,
    /// Its section is not used.
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
    /// A finding about the campaign as a whole that changes nothing.
    pub fn note(code: impl Into<String>, says: impl Into<String>) -> Self {
        Self {
            code: code.into(),
            channel: None,
            section: None,
            record: None,
            value: None,
            expected: None,
            unit: None,
            says: says.into(),
            cause: None,
            consequence: Consequence::Note,
        }
    }
}
