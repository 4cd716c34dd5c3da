//! Values of a protocol that a user answers for, and who confirmed them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value that is not from a checked source, or that was set in place of a default.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct StatedValue {
    /// Of a parameter, a definition, an estimate or a quantity, or `zone 1`.
    pub name: String,
    pub title: String,
    /// A number, or the text of the rule.
    pub value: String,
    pub unit: Option<String>,
    /// Clause of the rule, else its source.
    pub clause: Option<String>,
    /// Why it is to be confirmed, as the protocol says; `None` for a value that was set.
    pub why: Option<String>,
}

/// A value that is confirmed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ConfirmedValue {
    #[serde(flatten)]
    pub value: StatedValue,
    #[serde(flatten)]
    pub signed: Signed,
}

/// Who confirmed a value, and when.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Signed {
    pub by: String,
    pub date: String,
}

/// What a campaign states of a value that was confirmed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Confirmation {
    pub name: String,
    pub value: String,
    pub unit: Option<String>,
    pub clause: Option<String>,
    /// Edition of the protocol for which it holds.
    pub edition: Option<String>,
    #[serde(flatten)]
    pub signed: Signed,
}

/// Why a confirmation does not count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Unmatched {
    /// The edition of the protocol that is used; empty if it states none.
    OtherEdition {
        edition: String,
    },
    /// The value that is used.
    OtherValue {
        value: String,
    },
    NothingToConfirm,
}

impl StatedValue {
    pub fn in_words(&self) -> String {
        joined(&self.value, self.unit.as_deref())
    }
}

impl Confirmation {
    pub fn in_words(&self) -> String {
        joined(&self.value, self.unit.as_deref())
    }
}

/// `4 kN`; a number without a dimension has no unit.
fn joined(value: &str, unit: Option<&str>) -> String {
    match unit.filter(|unit| *unit != "-") {
        Some(unit) => format!("{value} {unit}"),
        None => value.to_owned(),
    }
}
