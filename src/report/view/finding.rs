//! What a check, a criterion or a verdict came to, as printed.

use serde::Serialize;

use crate::result::{QuantityResult, StatisticResult};

/// Result of a check or verdict as a word, a sign and a class for styling, so that it does not
/// depend on colour alone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// `good`, `bad` or `open`.
    pub class: &'static str,
    /// `✓`, `✗` or `?`.
    pub sign: &'static str,
    pub word: String,
}

impl Finding {
    pub(crate) fn new(holds: Option<bool>, good: &str, bad: &str, open: &str) -> Self {
        let (class, sign, word) = match holds {
            Some(true) => ("good", "✓", good),
            Some(false) => ("bad", "✗", bad),
            None => ("open", "?", open),
        };
        Self { class, sign, word: word.to_owned() }
    }

    /// Of a statistic: marginal if its interval contains the limit.
    pub(crate) fn of_statistic(statistic: Option<&StatisticResult>) -> Self {
        Self::of(statistic.and_then(|one| one.holds))
            .marginal(statistic.is_some_and(|one| one.marginal))
    }

    /// Of a quantity: marginal if one of its statistics is.
    pub(crate) fn of_quantity(quantity: &QuantityResult) -> Self {
        if quantity.decides_nothing() {
            return Self { class: "open", sign: "–", word: "no limit".into() };
        }
        Self::of(quantity.holds).marginal(
            quantity.holds.is_some() && quantity.statistics.iter().any(|one| one.marginal),
        )
    }

    pub(super) fn marginal(mut self, marginal: bool) -> Self {
        if marginal {
            self.word.push_str(", marginal");
        }
        self
    }

    /// Of an acceptance criterion or a requirement: `met`, `not met`, `not assessed`.
    pub(crate) fn of(holds: Option<bool>) -> Self {
        Self::new(holds, "met", "not met", "not assessed")
    }
}
