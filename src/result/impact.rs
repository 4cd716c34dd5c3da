//! What a change of a protocol would have decided over an archive of campaigns.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Reason,
    comparison::{Compared, OnCampaign},
    told,
};

/// The keys of `impact.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Impact {
    pub fishplate: String,
    pub format: u32,
    pub old: Compared,
    pub new: Compared,
    /// Number of campaigns that were judged by both.
    pub campaigns: usize,
    /// The changed rules that can touch a verdict.
    pub rules: Vec<ChangedRule>,
    /// Number of differences that touch no verdict: titles, sources, notes, rules that no quantity
    /// uses.
    pub only_words: usize,
    /// Campaigns with another verdict.
    pub flips: Vec<Flip>,
    /// Of each other campaign the changed limit that is nearest to another verdict, the nearest
    /// first.
    pub near: Vec<Near>,
    pub not_replayed: Vec<NotReplayed>,
    pub shares: Vec<Share>,
    /// Every campaign of the archive.
    pub archive: Vec<Judged>,
    /// Protocols that were compiled, and sets of changed rules that were looked at.
    pub work: Work,
}

/// A rule that differs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChangedRule {
    /// The subject: `quantity Y_max, limit std`.
    pub rule: String,
    pub before: Option<String>,
    pub after: Option<String>,
    /// Why it cannot be applied alone.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
}

/// A campaign with another verdict under the new protocol.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Flip {
    pub campaign: String,
    /// In the words of the old protocol.
    pub before: String,
    /// In the words of the new protocol.
    pub after: String,
    /// The smallest sets of changed rules that, made to the old protocol, give the new verdict: none
    /// of them contains another.
    pub minimal: Vec<Vec<String>>,
    /// Whether these are all of them.
    pub exact: bool,
    /// The largest number of rules of the sets that were looked at.
    pub looked_at: usize,
    /// Limits of the new protocol that, changed alone, give another verdict.
    pub margin: Vec<Margin>,
}

/// The smallest change of a limit of the new protocol that gives another verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Margin {
    pub rule: String,
    /// Whether the two protocols differ in it.
    pub changed: bool,
    /// The limit of the new protocol.
    pub value: f64,
    /// Beyond this limit, the verdict is another one.
    pub flips_at: f64,
    pub unit: String,
}

impl Margin {
    /// How far the limit is from the one that gives another verdict, as a logarithm of their ratio:
    /// half and double are equally far.
    pub fn distance(&self) -> f64 {
        (self.flips_at / self.value).ln().abs()
    }
}

/// How close a campaign came to another verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Near {
    pub campaign: String,
    /// Under both protocols.
    pub verdict: String,
    #[serde(flatten)]
    pub margin: Margin,
}

/// A campaign of which there are only values, and not those that both protocols need.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NotReplayed {
    pub campaign: String,
    /// Quantities whose values are made in another way.
    pub quantities: Vec<String>,
    /// Whether sections are selected or checked in another way; the quantities are then all.
    pub sections: bool,
}

/// Campaigns whose verdict holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Share {
    /// A vehicle datum or a section datum of words; `all` of all campaigns.
    pub by: String,
    pub group: String,
    pub campaigns: usize,
    pub before: f64,
    pub after: f64,
}

/// A campaign and both verdicts.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Judged {
    #[serde(flatten)]
    pub of: OnCampaign,
    /// Whether its records were read, or values of them.
    pub from: String,
    pub before: Option<String>,
    pub after: Option<String>,
    /// Why the new verdict does not hold or is not assessable.
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Work {
    pub protocols: usize,
    pub sets: usize,
    /// Operations in the processing graphs of the old and the new protocol.
    pub operations: usize,
}
