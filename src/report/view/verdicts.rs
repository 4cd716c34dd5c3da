//! The verdicts with a name: a table, and a box for each that a person decides.

use serde::Serialize;

use super::Finding;
use crate::result::{Certification, Verdict, VerdictResult};

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VerdictRow {
    pub title: String,
    pub finding: Finding,
    pub overall: bool,
    /// If it holds, and if it does not.
    pub words: [String; 2],
    /// `accepted when every limit holds`
    pub criterion: String,
    pub reasons: Vec<String>,
    /// Who decides it, if a person does.
    pub judged_by: Option<String>,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
}

pub(super) fn rows(found: &Certification) -> Vec<VerdictRow> {
    found.verdicts.iter().map(|verdict| row(verdict, found)).collect()
}

fn row(verdict: &VerdictResult, found: &Certification) -> VerdictRow {
    VerdictRow {
        title: verdict.title.clone(),
        finding: Finding::new(verdict.outcome.holds(), &verdict.word, &verdict.word, &verdict.word),
        overall: verdict.overall,
        words: verdict.words.clone(),
        criterion: verdict.criterion.clone(),
        reasons: verdict.reasons.iter().map(|reason| super::in_symbols(reason, found)).collect(),
        judged_by: verdict.judged_by.clone(),
        clause: verdict.clause.clone(),
        source: verdict.source.clone(),
        notes: verdict.notes.clone(),
    }
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
