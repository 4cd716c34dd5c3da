//! The verdicts with a name: a table, and a box for each that a person decides.

use serde::Serialize;

use super::Finding;
use crate::result::{Certification, Verdict, VerdictResult};

/// A verdict with its reasons in symbols.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VerdictRow {
    pub finding: Finding,
    #[serde(flatten)]
    pub verdict: VerdictResult,
}

pub(super) fn rows(found: &Certification) -> Vec<VerdictRow> {
    let row = |verdict: &VerdictResult| VerdictRow {
        finding: Finding::new(verdict.outcome.holds(), &verdict.word, &verdict.word, &verdict.word),
        verdict: VerdictResult {
            reasons: verdict.reasons.iter().map(|reason| super::in_symbols(reason, found)).collect(),
            ..verdict.clone()
        },
    };
    found.verdicts.iter().map(row).collect()
}

/// Title of the overall verdict, if it has a name.
pub(super) fn title(found: &Certification) -> Option<String> {
    found.verdicts.iter().find(|verdict| verdict.overall).map(|verdict| verdict.title.clone())
}

/// What is said of an overall verdict with words of its own: the protocol says what it means.
pub(super) fn sentence(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Validated => "The rule of the verdict is met, for the domain stated in this report.",
        Verdict::NotValidated => "The rule of the verdict is not met.",
        Verdict::NotAssessable => "The verdict cannot be given: data that it requires are missing, or a judgement is open.",
    }
}
