//! What a limit bounds, and the share of it that a value uses.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a limit bounds of a statistic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Its magnitude.
    #[default]
    Magnitude,
    /// Its value with the sign, from above.
    AtMost,
    /// Its value with the sign, from below.
    AtLeast,
}

impl Direction {
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// As printed before the limit.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Magnitude => "",
            Self::AtMost => "≤ ",
            Self::AtLeast => "≥ ",
        }
    }

    /// The share of a limit that a value uses, up to 1 where it is met: |value| / limit; value /
    /// limit of `at most`; limit / value of `at least`, where both are above zero. A least value
    /// below zero is used by values below zero only: value / limit, otherwise 0. A largest value that
    /// is not above zero is as a least one of the opposite sign. `None`: the value
    /// does not reach a limit above zero, and no share says how far it is away.
    pub fn share(self, value: f64, limit: f64) -> Option<f64> {
        let share = match (self, limit > 0.0) {
            (Self::Magnitude, true) => value.abs() / limit,
            (Self::AtMost, true) => value / limit,
            (Self::AtMost, false) => return Self::AtLeast.share(-value, -limit),
            (Self::AtLeast, true) if value > 0.0 => limit / value,
            (Self::AtLeast, false) if value >= 0.0 => 0.0,
            (Self::AtLeast, false) => value / limit,
            _ => return None,
        };
        share.is_finite().then_some(share)
    }

    /// What the worst of several values has most of: one that does not meet its limit is worse than
    /// any that does, then the larger share counts, then, where shares are equal or there are none,
    /// how far the value has come towards its limit and beyond.
    pub fn badness(self, value: f64, limit: f64, holds: bool) -> (bool, f64, f64) {
        let share = self.share(value, limit).unwrap_or(if holds { 0.0 } else { f64::INFINITY });
        (!holds, share, -self.distance(value, limit))
    }

    /// How far a value is from its limit, in their unit; below zero where it does not meet it.
    pub fn distance(self, value: f64, limit: f64) -> f64 {
        match self {
            Self::Magnitude => limit - value.abs(),
            Self::AtMost => limit - value,
            Self::AtLeast => value - limit,
        }
    }
}
