//! Verdicts: the overall one, and those with a name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Reason, RulePlace, told};

/// The overall verdict, whatever its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Verdict {
    #[serde(rename = "validated")]
    Validated,
    #[serde(rename = "not validated")]
    NotValidated,
    #[serde(rename = "not assessable")]
    NotAssessable,
}

impl Verdict {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Validated => "validated",
            Self::NotValidated => "not validated",
            Self::NotAssessable => "not assessable",
        }
    }
}

/// What a verdict came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Outcome {
    #[serde(rename = "holds")]
    Holds,
    #[serde(rename = "does not hold")]
    DoesNotHold,
    #[serde(rename = "not assessable")]
    NotAssessable,
    /// A person decides it.
    #[serde(rename = "open")]
    Open,
}

impl Outcome {
    /// `None` where it neither holds nor does not.
    pub fn holds(self) -> Option<bool> {
        match self {
            Self::Holds => Some(true),
            Self::DoesNotHold => Some(false),
            Self::NotAssessable | Self::Open => None,
        }
    }

    /// As the overall verdict: what is open is never validated.
    pub fn overall(self) -> Verdict {
        match self {
            Self::Holds => Verdict::Validated,
            Self::DoesNotHold => Verdict::NotValidated,
            Self::NotAssessable | Self::Open => Verdict::NotAssessable,
        }
    }

    /// Of the two words of a verdict the one that applies.
    pub fn word(self, [good, bad]: &[String; 2]) -> &str {
        match self {
            Self::Holds => good,
            Self::DoesNotHold => bad,
            Self::NotAssessable => "not assessable",
            Self::Open => "open",
        }
    }
}

/// A verdict with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictResult {
    pub name: String,
    pub title: String,
    /// Whether it is the overall verdict.
    pub overall: bool,
    pub outcome: Outcome,
    /// The outcome in the words of the protocol.
    pub word: String,
    /// If it holds, and if it does not.
    pub words: [String; 2],
    /// `accepted when every limit holds (of SigmaY, YQ)`
    pub criterion: String,
    /// Why it does not hold, is not assessable or is open.
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
    /// Who decides it, if a person does.
    pub judged_by: Option<String>,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    /// Place of its definition in the protocol.
    pub rule: RulePlace,
}
