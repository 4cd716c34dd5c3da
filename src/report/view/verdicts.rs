//! The verdicts with a name: a table, and a box for each that a person decides.

use super::View;
use crate::report::document::{Cell, Column, Finding, Row, Run, Table, Text, Tone, cells};
use crate::report::number;
use crate::result::{Certification, Outcome, Verdict, VerdictResult};

/// In place of the reasons of the overall verdict, in the table beside it.
const TOO_FEW: &str = "too few usable sections, see the reasons of the verdict";

/// All verdicts with a name; a short table has not all of their reasons.
pub(super) fn table(view: &View<'_>, short: bool) -> Table {
    let found = view.found;
    let together = lacks(found).map(|(_, together)| together);
    let above = together.filter(|together| merged(&found.reasons, found).contains(together));
    let text = |reason: String| {
        view.symbols.text(if above.as_ref() == Some(&reason) { TOO_FEW } else { &reason })
    };
    let row = |verdict: &VerdictResult| {
        let title = verdict.title.clone() + if verdict.overall { " (overall)" } else { "" };
        let places = [&verdict.clause, &verdict.source].into_iter().flatten();
        let rule = std::iter::once(Text::from(&verdict.criterion))
            .chain(places.map(|place| Run::Quiet(place.clone()).into()));
        let reasons = merged(&verdict.reasons, found);
        let says = reasons.into_iter().chain(verdict.notes.clone()).map(text).collect();
        let finding = finding(verdict.outcome, &verdict.word);
        let tone = finding.tone;
        Row::from(cells![
            Cell::text(title).strong(),
            finding,
            Cell::text(Text::lines(rule)),
            Cell::text(first_of(says, short))
        ])
        .toned(tone)
    };
    let columns = vec![
        Column::text("Verdict").wide(1.2),
        Column::text("Result").wide(0.75),
        Column::text("Rule").wide(1.6),
        Column::text("Reasons and remarks").wide(2.4),
    ];
    Table::new("Verdicts", columns, found.verdicts.iter().map(row)).class("").size(8.0)
}

/// Reasons and remarks, a line each: all, or the first and how many more there are.
fn first_of(mut lines: Vec<Text>, short: bool) -> Text {
    /// Reasons of a verdict in a table on paper; the others would fill pages of it.
    const SHOWN: usize = 1;
    let more = lines.len() - SHOWN.min(lines.len());
    if short && more > 1 {
        lines.truncate(SHOWN);
        lines.push(format!("and {more} more; see the chapter Quantities").into());
    }
    Text::lines(lines)
}

/// What a verdict came to: one that a person still has to give is no lack of data.
pub(super) fn finding(outcome: Outcome, word: &str) -> Finding {
    match outcome {
        Outcome::Open => {
            Finding { tone: Tone::Open, sign: TO_BE_JUDGED.0, word: TO_BE_JUDGED.1.into() }
        }
        _ => Finding::new(outcome.holds(), word, word, word),
    }
}

/// Sign and word of a judgement that is open.
const TO_BE_JUDGED: (&str, &str) = ("\u{25cb}", "to be judged");

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
pub(super) fn reasons(view: &View<'_>) -> Vec<Text> {
    merged(&view.found.reasons, view.found).iter().map(|one| view.symbols.text(one)).collect()
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
            _ => number::raised(&in_symbols(reason, found)),
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

/// Replaces the id of a quantity at the start of a sentence by its symbol.
fn in_symbols(reason: &str, found: &Certification) -> String {
    let of = reason.split_once(": ").and_then(|(id, says)| {
        Some((found.quantities.iter().find(|quantity| quantity.id == id)?, says))
    });
    of.map_or_else(
        || reason.to_owned(),
        |(quantity, says)| format!("{}: {says}", super::symbol(&quantity.symbol)),
    )
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
