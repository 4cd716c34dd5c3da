//! The verdicts with a name: a table, and a box for each that a person decides.

use super::View;
use crate::report::{document::*, number};
use crate::result::{Certification, InDraws, Outcome, Reason, ShortZone, Verdict, VerdictResult};

/// All verdicts with a name; a short table has not all of their reasons.
pub fn table(view: &View<'_>, short: bool) -> Table {
    let found = view.found;
    let above = lacks(found).filter(|lack| merged(&found.reasons, found).contains(lack));
    let reason = |reason: Reason| {
        // The reasons of the overall verdict stand beside the table.
        let reason = if above.as_ref() == Some(&reason) { Reason::SeeVerdict } else { reason };
        view.symbols.text(&told(&reason))
    };
    let row = |verdict: &VerdictResult| {
        let title = verdict.title.clone() + if verdict.overall { " (overall)" } else { "" };
        let places = [&verdict.clause, &verdict.source].into_iter().flatten();
        let of_this = |one: &&InDraws| {
            one.verdict.as_ref() == Some(&verdict.name) && one.holds() == Some(true)
        };
        let own = found.drawn.iter().filter(of_this);
        let rule =
            std::iter::once(Text::from(&verdict.criterion))
                .chain(own.map(|drawn| {
                    Run::Quiet(Reason::InDraws(drawn.clone()).text().to_string()).into()
                }))
                .chain(places.map(|place| Run::Quiet(place.clone()).into()));
        let notes = verdict.notes.iter().map(|note| view.symbols.text(note));
        let says = merged(&verdict.reasons, found).into_iter().map(reason).chain(notes).collect();
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
    Table::new("Verdicts")
        .text("Verdict")
        .wide(1.2)
        .text("Result")
        .wide(0.75)
        .text("Rule")
        .wide(1.6)
        .text("Reasons and remarks")
        .wide(2.4)
        .rows(found.verdicts.iter().map(row))
        .class("")
        .size(8.0)
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
pub fn finding(outcome: Outcome, word: &str) -> Finding {
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
pub fn overall(found: &Certification) -> Option<Outcome> {
    let open = found.verdict == Verdict::NotAssessable
        && found.verdicts.iter().any(|verdict| verdict.outcome == Outcome::Open);
    if open && !lacks_data(found) {
        return Some(Outcome::Open);
    }
    found.verdicts.iter().find(|verdict| verdict.overall).map(|verdict| verdict.outcome)
}

/// Whether a verdict is not assessable for another reason than an open judgement.
fn lacks_data(found: &Certification) -> bool {
    let lacking = found.verdicts.iter().filter(|verdict| verdict.outcome == Outcome::NotAssessable);
    lacking
        .flat_map(|verdict| &verdict.reasons)
        .chain(&found.reasons)
        .any(|reason| !matches!(reason.root(), Reason::ToBeJudged { .. }))
}

/// The reasons of the overall verdict.
pub fn reasons(view: &View<'_>) -> Vec<Text> {
    let reasons = merged(&view.found.reasons, view.found);
    reasons.iter().map(|reason| view.symbols.text(&told(reason))).collect()
}

/// Reasons in symbols. Zones with too few sections are one reason, also where a verdict has it from
/// others.
fn merged(reasons: &[Reason], found: &Certification) -> Vec<Reason> {
    let lacks = lacks(found);
    let called = |id: &str| {
        let quantity = found.quantities.iter().find(|quantity| quantity.id == id);
        quantity.map_or_else(|| id.to_owned(), |quantity| super::symbol(&quantity.symbol))
    };
    let mut all: Vec<Reason> = Vec::new();
    for reason in reasons {
        let shown = match (&lacks, reason.root()) {
            (Some(together), Reason::ZoneTooSmall { .. }) => together.clone(),
            _ => reason.naming(called),
        };
        if !all.contains(&shown) {
            all.push(shown);
        }
    }
    all
}

/// One reason for zones with too few sections, if there are several that it can stand for.
fn lacks(found: &Certification) -> Option<Reason> {
    let short: Vec<_> = found.zones.iter().filter(|zone| !zone.holds).collect();
    let minimum = short.first()?.minimum;
    if short.len() < 2
        || short.iter().any(|zone| zone.minimum != minimum || zone.used != zone.sites)
    {
        return None;
    }
    let zones =
        short.iter().map(|zone| ShortZone { zone: zone.zone.clone(), used: zone.used }).collect();
    Some(Reason::ZonesTooSmall { zones, minimum })
}

/// A reason for print.
fn told(reason: &Reason) -> String {
    number::raised(reason.text())
}

/// What is said of an overall verdict with words of its own: the protocol says what it means.
pub fn sentence(found: &Certification) -> &'static str {
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
