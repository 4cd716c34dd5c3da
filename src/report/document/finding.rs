//! What a check, a criterion or a verdict came to, as printed.

use serde::Serialize;

use crate::result::{QuantityResult, StatisticResult};

/// How a finding is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    Good,
    Bad,
    Open,
}

/// Result of a check or verdict as a word and a sign, so that it does not depend on colour alone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    pub tone: Tone,
    /// `✓`, `✗` or `?`.
    pub sign: &'static str,
    pub word: String,
}

impl Finding {
    /// One of three words.
    pub fn new(holds: Option<bool>, good: &str, bad: &str, open: &str) -> Self {
        let (tone, sign, word) = match holds {
            Some(true) => (Tone::Good, "✓", good),
            Some(false) => (Tone::Bad, "✗", bad),
            None => (Tone::Open, "?", open),
        };
        Self { tone, sign, word: word.to_owned() }
    }

    /// Neither positive nor negative.
    pub fn neutral(word: impl Into<String>) -> Self {
        Self { tone: Tone::Open, sign: "–", word: word.into() }
    }

    /// Of a statistic: marginal if its interval contains the limit.
    pub fn of_statistic(statistic: Option<&StatisticResult>) -> Self {
        Self::of(statistic.and_then(|one| one.holds))
            .marginal(statistic.is_some_and(|one| one.marginal))
    }

    /// Of a quantity: marginal if one of its statistics is.
    pub fn of_quantity(quantity: &QuantityResult) -> Self {
        if quantity.decides_nothing() {
            return Self::neutral("no limit");
        }
        Self::of(quantity.holds).marginal(
            quantity.holds.is_some() && quantity.statistics.iter().any(|one| one.marginal),
        )
    }

    /// With the remark that it is marginal, if it is.
    pub fn marginal(mut self, marginal: bool) -> Self {
        if marginal {
            self.word.push_str(", marginal");
        }
        self
    }

    /// Of an acceptance criterion or a requirement: `met`, `not met`, `not assessed`.
    pub fn of(holds: Option<bool>) -> Self {
        Self::new(holds, "met", "not met", "not assessed")
    }
}
