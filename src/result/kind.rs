//! What a protocol is about, which follows from its quantities, and the words of its verdict.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Certification, QuantityResult, Remark, Verdict};
use crate::words;

/// What a protocol is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Kind {
    /// Quantities compare simulated with measured records.
    Validation,
    /// Quantities are of one record by itself.
    Assessment,
    /// Every quantity compares records of one side: several with what is central of them, or
    /// repeats with their originals.
    Comparison,
    /// Validation and assessment.
    Mixed,
}

impl Kind {
    /// Without quantities, a validation.
    pub fn of(quantities: &[QuantityResult]) -> Self {
        Self::of_all(quantities.iter().map(QuantityResult::kind))
    }

    /// Of a protocol with quantities of these kinds. Comparisons of records of one side make a
    /// comparison only where there is nothing else: a validation that also looks at repeats is a
    /// validation.
    pub fn of_all(kinds: impl Iterator<Item = Self>) -> Self {
        let kinds: Vec<Self> = kinds.collect();
        let some = |kind| kinds.contains(&kind);
        match (some(Self::Validation), some(Self::Assessment), some(Self::Comparison)) {
            (true, true, _) => Self::Mixed,
            (false, true, _) => Self::Assessment,
            (false, false, true) => Self::Comparison,
            (_, false, _) => Self::Validation,
        }
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

impl QuantityResult {
    fn kind(&self) -> Kind {
        match (&self.from, &self.among) {
            (Some(_), _) => Kind::Assessment,
            (None, Some(_)) => Kind::Comparison,
            (None, None) if self.repeats => Kind::Comparison,
            (None, None) => Kind::Validation,
        }
    }

    /// Whether a record of this side is in its values.
    fn reads(&self, side: &str) -> bool {
        match self.from.as_ref().or(self.among.as_ref()) {
            Some(of) => of == side,
            None => !self.repeats || side == "measured",
        }
    }
}

/// The verdict of a protocol in its words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictWords {
    pub good: String,
    pub bad: String,
}

impl VerdictWords {
    pub fn of(kind: Kind) -> Self {
        let word = |verdict| kind.verdict_words(verdict).to_owned();
        Self { good: word(Verdict::Validated), bad: word(Verdict::NotValidated) }
    }

    pub fn word(&self, verdict: Verdict) -> &str {
        match verdict {
            Verdict::Validated => &self.good,
            Verdict::NotValidated => &self.bad,
            Verdict::NotAssessable => verdict.in_words(),
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
        let note = self.beside_the_verdict().map_or(String::new(), |note| format!(", {note}"));
        format!("{}{note}", self.verdict_word())
    }

    /// How many quantities are not assessed and values not confirmed, and what the simulation was
    /// fitted to.
    pub fn beside_the_verdict(&self) -> Option<String> {
        let values = self.provisional.len();
        let provisional = (values > 0 && self.verdict != Verdict::NotAssessable)
            .then(|| words::text(&Remark::Provisional { values }).into());
        let note = self.verdict_note.as_ref().map(|note| note.text().into());
        let not_assessed: BTreeSet<&String> = (self.deviations.iter())
            .filter_map(|deviation| match &deviation.what {
                Remark::NotAssessed { quantity, in_part: false, .. } => Some(quantity),
                _ => None,
            })
            .collect();
        let quantities = not_assessed.len();
        let without = (quantities > 0 && self.verdict != Verdict::NotAssessable)
            .then(|| words::text(&Remark::WithoutQuantities { quantities }).into());
        let all: Vec<String> = without.into_iter().chain(provisional).chain(note).collect();
        (!all.is_empty()).then(|| all.join(", "))
    }

    /// Sides of which records are in the quantities: simulated, measured.
    pub fn reads(&self) -> (bool, bool) {
        let any = |side: &str| {
            self.quantities.is_empty()
                || self.quantities.iter().any(|quantity| quantity.reads(side))
        };
        (any("simulated"), any("measured"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Repeats or codes beside other quantities do not change what a protocol is about.
    #[test]
    fn comparisons_count_where_there_is_nothing_else() {
        use Kind::{Assessment, Comparison, Mixed, Validation};
        let cases: [(&[Kind], Kind); 7] = [
            (&[], Validation),
            (&[Validation], Validation),
            (&[Comparison, Comparison], Comparison),
            (&[Comparison, Validation], Validation),
            (&[Assessment, Comparison], Assessment),
            (&[Validation, Assessment], Mixed),
            (&[Validation, Assessment, Comparison], Mixed),
        ];
        for (kinds, expected) in cases {
            assert_eq!(Kind::of_all(kinds.iter().copied()), expected, "{kinds:?}");
        }
    }

    #[test]
    fn a_verdict_that_cannot_be_given_has_no_word_of_its_own() {
        let words = VerdictWords { good: "accepted".into(), bad: "rejected".into() };
        let all = [Verdict::Validated, Verdict::NotValidated, Verdict::NotAssessable];
        assert_eq!(
            all.map(|verdict| words.word(verdict)),
            ["accepted", "rejected", "not assessable"]
        );
        assert_eq!(VerdictWords::of(Kind::Assessment).good, "requirements met");
    }
}
