//! The verdicts with a name: a table, and a box for each that a person decides.

use serde::Serialize;

use super::Finding;
use crate::report::number;
use crate::result::{Certification, Outcome, Verdict, VerdictResult};

/// A verdict with its reasons in symbols.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct VerdictRow {
    pub finding: Finding,
    #[serde(flatten)]
    pub verdict: VerdictResult,
}

/// In place of the reasons of the overall verdict, in the table beside it.
const TOO_FEW: &str = "too few usable sections, see the reasons of the verdict";

pub(super) fn rows(found: &Certification) -> Vec<VerdictRow> {
    let together = lacks(found).map(|(_, together)| together);
    let above = together.filter(|together| reasons(found).contains(together));
    let short =
        |reason: String| if above.as_ref() == Some(&reason) { TOO_FEW.to_owned() } else { reason };
    let row = |verdict: &VerdictResult| VerdictRow {
        finding: finding(verdict.outcome, &verdict.word),
        verdict: VerdictResult {
            reasons: merged(&verdict.reasons, found).into_iter().map(short).collect(),
            ..verdict.clone()
        },
    };
    found.verdicts.iter().map(row).collect()
}

/// What a verdict came to: one that a person still has to give is no lack of data.
pub(super) fn finding(outcome: Outcome, word: &str) -> Finding {
    match outcome {
        Outcome::Open => {
            Finding { class: "open", sign: TO_BE_JUDGED.0, word: TO_BE_JUDGED.1.into() }
        }
        _ => Finding::new(outcome.holds(), word, word, word),
    }
}

/// Sign and word of a judgement that is open.
pub(super) const TO_BE_JUDGED: (&str, &str) = ("\u{25cb}", "to be judged");

/// What the overall verdict came to. One that is not assessable only since a judgement is open, its
/// own or one that it is about, is open.
pub(super) fn overall(found: &Certification) -> Option<Outcome> {
    let open = found.verdict == Verdict::NotAssessable
        && found.verdicts.iter().any(|verdict| verdict.outcome == Outcome::Open);
    if open && !lacks_data(found) {
        return Some(Outcome::Open);
    }
    found.verdicts.iter().find(|verdict| verdict.overall).map(|verdict| verdict.outcome)
}

/// Whether a verdict is not assessable for another reason than an open judgement.
fn lacks_data(found: &Certification) -> bool {
    let judged: Vec<&str> =
        found.verdicts.iter().filter_map(|verdict| verdict.judged_by.as_deref()).collect();
    let of_judgement = |reason: &String| {
        judged.iter().any(|person| own(reason, found).ends_with(&format!("judged by {person}")))
    };
    let lacking = found.verdicts.iter().filter(|verdict| verdict.outcome == Outcome::NotAssessable);
    lacking
        .flat_map(|verdict| &verdict.reasons)
        .chain(&found.reasons)
        .any(|reason| !of_judgement(reason))
}

/// The reasons of the overall verdict.
pub(super) fn reasons(found: &Certification) -> Vec<String> {
    merged(&found.reasons, found)
}

/// Reasons in symbols. Zones with too few sections are one reason, also where a verdict has it from
/// others.
fn merged(reasons: &[String], found: &Certification) -> Vec<String> {
    let lacks = lacks(found);
    let mut all: Vec<String> = Vec::new();
    for reason in reasons {
        let shown = match &lacks {
            Some((each, together)) if each.iter().any(|lack| lack == own(reason, found)) => {
                together.clone()
            }
            _ => number::raised(&super::in_symbols(reason, found)),
        };
        if !all.contains(&shown) {
            all.push(shown);
        }
    }
    all
}

/// The reason without the titles of the verdicts that it comes through.
fn own<'a>(reason: &'a str, found: &Certification) -> &'a str {
    let mut rest = reason;
    let through = |rest: &'a str| {
        found
            .verdicts
            .iter()
            .find_map(|verdict| rest.strip_prefix(verdict.title.as_str())?.strip_prefix(": "))
    };
    while let Some(inner) = through(rest) {
        rest = inner;
    }
    rest
}

/// The reasons of zones with too few sections, and one sentence for them, if there are several that
/// it can stand for.
fn lacks(found: &Certification) -> Option<(Vec<String>, String)> {
    let short: Vec<_> = found.zones.iter().filter_map(|zone| Some((zone, zone.lack()?))).collect();
    let (first, _) = short.first()?;
    if short.len() < 2
        || short.iter().any(|(zone, _)| zone.minimum != first.minimum || zone.used != zone.sites)
    {
        return None;
    }
    let each: Vec<String> =
        short.iter().map(|(zone, _)| format!("zone {} has {}", zone.zone, zone.used)).collect();
    let together = format!(
        "too few usable sections: {}; at least {} required in each",
        each.join(", "),
        first.minimum
    );
    Some((short.into_iter().map(|(_, lack)| lack).collect(), together))
}

/// Title of the overall verdict, if it has a name.
pub(super) fn title(found: &Certification) -> Option<String> {
    found.verdicts.iter().find(|verdict| verdict.overall).map(|verdict| verdict.title.clone())
}

/// What is said of an overall verdict with words of its own: the protocol says what it means.
pub(super) fn sentence(found: &Certification) -> &'static str {
    match found.verdict {
        _ if overall(found) == Some(Outcome::Open) => {
            "The verdict is open: a person has yet to judge. The numbers are in this report."
        }
        Verdict::Validated => {
            "The rule of the verdict is met, for the domain stated in this report."
        }
        Verdict::NotValidated => "The rule of the verdict is not met.",
        Verdict::NotAssessable
            if found.verdicts.iter().any(|verdict| verdict.outcome == Outcome::Open) =>
        {
            "The verdict cannot be given: data that it requires are missing. Judgements are open as well."
        }
        Verdict::NotAssessable => "The verdict cannot be given: data that it requires are missing.",
    }
}
