//! Pairs of campaigns on both sides of each limit of a protocol.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::RulePlace;

/// The keys of `exercise.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Exercise {
    pub fishplate: String,
    pub format: u32,
    /// The name of the protocol.
    pub protocol: String,
    /// The name of the campaign whose records are changed.
    pub campaign: String,
    /// The share of the difference of measurement and simulation that was kept first, so that
    /// every limit holds; 1 where all of it was.
    pub gap: f64,
    pub limits: Vec<Exercised>,
    /// Numbers of the protocol that were changed, where this was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mutations: Vec<Mutated>,
}

/// A number of the text of the protocol that was changed by one per cent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mutated {
    pub line: usize,
    /// The field it stands in: `limit`, `default`, `step`.
    pub field: String,
    pub from: String,
    pub to: f64,
    /// A limit whose pair is judged otherwise then; `None` where no pair notices the change.
    pub noticed_by: Option<String>,
}

/// A limit as the protocol states it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Exercised {
    /// The subject: `quantity Y_max, limit std`.
    pub limit: String,
    pub rule: RulePlace,
    /// `None` where none was found.
    pub pair: Option<Pair>,
    /// Why there is none.
    pub reason: Option<NoPair>,
}

/// Two campaigns between which one limit changes sides.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Pair {
    /// The folder with the campaigns `inside` and `outside`.
    pub folder: String,
    pub disturbance: Disturbance,
    pub inside: Sized,
    pub outside: Sized,
}

/// What was added, and how close the value then is to its limit.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Sized {
    /// The factor of the shape.
    pub size: f64,
    /// The distance of the value from its limit as a share of the limit; below 0 it is not met.
    pub distance: f64,
}

/// What is added to channels.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Disturbance {
    /// `measurement`, `simulation`, or `both` of them alike.
    pub record: String,
    pub columns: Vec<String>,
    pub shape: Shape,
    pub over: Over,
}

/// A shape. But for a gain it is as large as the rms value of the fluctuation of the channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// A constant.
    Level,
    /// The fluctuation of the channel itself.
    Gain,
    /// Short peaks of one sign.
    Peaks,
    /// Hz.
    Tone { frequency: f64 },
}

/// The sections that are changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Over {
    All,
    /// With one sign and the other in turn.
    Alternating,
    /// One, by its number from 0.
    Section {
        section: usize,
    },
}

/// Why a limit has no pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", tag = "why")]
pub enum NoPair {
    /// Nothing in the campaign is judged by it.
    NotInForce,
    /// The value does not come near the limit with any disturbance.
    OutOfReach,
    /// Others change sides before or with it: these, with the best disturbance.
    NotAlone { others: Vec<String> },
}
