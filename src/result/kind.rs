//! What a protocol is about, which follows from its quantities, and the words of its verdict.

use serde::Serialize;

use super::{Certification, QuantityResult, Verdict};

/// What a protocol is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Kind {
    /// Every quantity compares simulated with measured records.
    Validation,
    /// Every quantity is of one record by itself.
    Assessment,
    /// Every quantity compares several records of one side with what is central of them.
    Comparison,
    Mixed,
}

impl Kind {
    /// Without quantities, a validation.
    pub fn of(quantities: &[QuantityResult]) -> Self {
        let one = |quantity: &QuantityResult| match (&quantity.from, &quantity.among) {
            (Some(_), _) => Self::Assessment,
            (None, Some(_)) => Self::Comparison,
            (None, None) => Self::Validation,
        };
        let mut kinds = quantities.iter().map(one);
        let first = kinds.next().unwrap_or(Self::Validation);
        if kinds.all(|kind| kind == first) { first } else { Self::Mixed }
    }

    /// The verdict in words: a model is validated, requirements are met.
    pub fn verdict_words(self, verdict: Verdict) -> &'static str {
        match (self, verdict) {
            (Self::Validation, verdict) => verdict.in_words(),
            (_, Verdict::Validated) => "requirements met",
            (_, Verdict::NotValidated) => "requirements not met",
            (_, Verdict::NotAssessable) => "not assessable",
        }
    }
}

impl Certification {
    pub fn kind(&self) -> Kind {
        Kind::of(&self.quantities)
    }

    /// The verdict in the words of the report.
    pub fn verdict_words(&self) -> &'static str {
        self.kind().verdict_words(self.verdict)
    }

    /// The verdict in the protocol's own words, or in those of the report.
    pub fn verdict_word(&self) -> &str {
        self.own_word.as_deref().unwrap_or(self.verdict_words())
    }

    /// The same with its note: `validated, with a simulation fitted to the same measurements`
    pub fn verdict_in_words(&self) -> String {
        let note = self.verdict_note.as_ref().map_or(String::new(), |note| format!(", {note}"));
        format!("{}{note}", self.verdict_word())
    }

    /// Sides of which records are in the quantities: simulated, measured.
    pub fn reads(&self) -> (bool, bool) {
        let is = |side: &str, quantity: &QuantityResult| {
            let alone = quantity.from.as_ref().or(quantity.among.as_ref());
            alone.is_none_or(|of| of == side)
        };
        let any = |side: &str| self.quantities.is_empty() || self.quantities.iter().any(|quantity| is(side, quantity));
        (any("simulated"), any("measured"))
    }
}
