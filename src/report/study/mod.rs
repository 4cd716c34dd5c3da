//! A study as a document: chapters of text, tables and figures, printed as PDF and HTML from the
//! same data.

mod margin;
mod parameters;
mod sections;
mod sync;

use std::fmt::Display;

use crate::report::{
    document::*,
    figure, number,
    view::{self, Opening},
};
use crate::result::{
    ParameterInfo, Scope, Verdict, VerdictWords,
    margin::Margin,
    study::{QuantitySpread, Share, Study, StudyResult},
};

/// What was varied.
fn subject(study: &Study) -> &'static str {
    match &study.found {
        StudyResult::Sections(_) => "Selection of sections",
        StudyResult::Sync(_) => "Synchronisation",
        StudyResult::Parameters(_) => "Parameters of the protocol",
        StudyResult::Margin(_) => "Margin of the verdict",
    }
}

/// What was varied, and the campaign.
pub fn title(study: &Study) -> String {
    format!("{}: {}", subject(study), study.campaign.name)
}

/// What the study came to.
pub fn opening(study: &Study) -> Opening {
    let words = &study.protocol.verdict_words;
    match &study.found {
        StudyResult::Sections(found) => sections::opening(found, words),
        StudyResult::Sync(found) => sync::opening(found, words),
        StudyResult::Parameters(found) => parameters::opening(found, words),
        StudyResult::Margin(found) => margin::opening(found, words),
    }
}

/// The study as printed in both reports.
pub fn document(study: &Study) -> Document {
    let words = &study.protocol.verdict_words;
    let mut chapters = match &study.found {
        StudyResult::Sections(found) => sections::chapters(found, words),
        StudyResult::Sync(found) => sync::chapters(found, words),
        StudyResult::Parameters(found) => parameters::chapters(found, words),
        StudyResult::Margin(found) => margin::chapters(found, words),
    };
    if !study.notes.is_empty() {
        let notes = study.notes.iter().map(|note| note.text().to_string());
        chapters.push(Chapter::new("remarks", "Remarks", vec![Block::list(notes)]));
    }
    chapters.push(settings(study));
    let over = format!("Robustness of the verdict: {}", subject(study).to_lowercase());
    let inputs = (&study.campaign, &study.protocol);
    view::study((title(study), &over), opening(study), inputs, chapters)
}

/// An unchanged verdict as a headline; only one that holds gets the positive sign. `otherwise` if
/// `verdict` is `None`.
fn stays(verdict: Option<Verdict>, words: &VerdictWords, otherwise: &str) -> Finding {
    let unchanged = |verdict| format!("Verdict unchanged: {}", words.word(verdict));
    match verdict {
        Some(Verdict::Validated) => {
            Finding::new(Some(true), &unchanged(Verdict::Validated), "", "")
        }
        // Neither positive nor negative: that a verdict does not depend on a choice is no statement
        // on the model.
        Some(verdict) => Finding::neutral(unchanged(verdict)),
        None => Finding::new(None, "", "", otherwise),
    }
}

fn settings(study: &Study) -> Chapter {
    let row = |parameter: &ParameterInfo| -> Vec<Cell> {
        cells![
            parameter.name,
            parameter.title,
            parameter.value,
            parameter.default,
            parameter.set_by
        ]
    };
    let caption = "Parameters of the protocol, values used and defaults";
    let table = Table::new(caption)
        .name("Name")
        .text("Meaning")
        .short("Used")
        .short("Default")
        .short("Set by")
        .rows(study.protocol.parameters.iter().map(row));
    let rule = Block::text(&study.protocol.verdict_rule);
    Chapter::new("protocol", "Protocol", vec![rule, table.into()])
}

/// A statistic with its scope, unless that is all.
fn scoped(statistic: impl Display, scope: &Scope) -> String {
    format!("{statistic}{}", scope.suffix())
}

/// All figures of a study by their names in the document.
pub fn figures(study: &Study) -> Vec<(String, String)> {
    let words = &study.protocol.verdict_words;
    match &study.found {
        StudyResult::Sections(found) => boxes(&found.quantities, BOXES),
        StudyResult::Sync(found) => {
            let mut drawn = vec![
                ("selection".into(), figure::selection(found)),
                ("shares".into(), figure::shares(found, words)),
            ];
            for (at, offset) in found.offsets.iter().enumerate() {
                drawn.extend(boxes(&offset.quantities, &format!("{BOXES}-{at}")));
            }
            drawn
        }
        StudyResult::Parameters(found) => vec![("choices".into(), figure::choices(found, words))],
        StudyResult::Margin(found) => {
            let label = |of: &Margin| [margin::name(of), margin::range(of)];
            vec![("margins".into(), figure::margins(found, words, &label))]
        }
    }
}

/// Name of the box plots.
const BOXES: &str = "boxes";

/// The box plots of each kind of statistic.
fn boxes(quantities: &[QuantitySpread], name: &str) -> Vec<(String, String)> {
    let one = |(of, _): (figure::boxes::Of, usize)| {
        (format!("{name}-{}", of.name()), figure::boxes::boxes(quantities, of))
    };
    figure::boxes::drawn(quantities).into_iter().map(one).collect()
}

/// `93.84 %`, with enough decimals that a share below 1 is not printed as all, nor one above 0 as
/// none.
fn percent(share: f64) -> String {
    let decimals = (2..=6).find(|decimals| {
        let shown: f64 = format!("{:.decimals$}", 100.0 * share).parse().unwrap_or(0.0);
        (share <= 0.0 || shown > 0.0) && (share >= 1.0 || shown < 100.0)
    });
    format!("{} %", number::fixed(100.0 * share, decimals.unwrap_or(6)))
}

/// The share, with its interval if it is estimated.
fn share(share: &Share) -> String {
    share_with(share.share, share.interval)
}

fn share_with(share: f64, interval: Option<(f64, f64)>) -> String {
    match interval {
        None => percent(share),
        Some((low, high)) => format!("{} ({} to {})", percent(share), percent(low), percent(high)),
    }
}
