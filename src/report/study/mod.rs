//! A study as a document: chapters of text, tables and figures, printed as PDF and HTML from the
//! same data.

mod document;
mod parameters;
mod sections;
mod sync;
pub mod tables;

pub use document::{Chapter, Document, Head, Item, Table};

use crate::report::figure;
use crate::report::number;
use crate::report::view::{self, Fact, Finding};
use crate::result::study::{Found, QuantitySpread, Share, Study};
use crate::result::{Verdict, VerdictWords};

/// The study as printed in both reports.
pub fn document(study: &Study) -> Document {
    let words = &study.protocol.verdict_words;
    let (title, opening, mut chapters) = match &study.found {
        Found::Sections(found) => (
            "Selection of sections",
            sections::opening(found, words),
            sections::chapters(found, words),
        ),
        Found::Sync(found) => {
            ("Synchronisation", sync::opening(found, words), sync::chapters(found, words))
        }
        Found::Parameters(found) => (
            "Parameters of the protocol",
            parameters::opening(found, words),
            parameters::chapters(found, words),
        ),
    };
    if !study.notes.is_empty() {
        chapters.push(Chapter {
            id: "remarks".into(),
            title: "Remarks".into(),
            items: vec![Item::List { entries: study.notes.clone() }],
        });
    }
    chapters.push(settings(study));
    Document {
        title: format!("{title}: {}", study.campaign.name),
        kind: format!("Robustness of the verdict: {}", title.to_lowercase()),
        program: concat!("Fishplate ", env!("CARGO_PKG_VERSION")).to_owned(),
        headline: opening.headline,
        sentence: opening.sentence,
        key_facts: opening.facts,
        symbols: symbols(&study.found),
        campaign: view::campaign(&study.campaign),
        protocol: view::protocol_view(&study.protocol),
        chapters,
    }
}

/// Symbols of the quantities, without repetition.
fn symbols(found: &Found) -> Vec<String> {
    let all: Vec<&String> = match found {
        Found::Sections(found) => {
            found.quantities.iter().map(|quantity| &quantity.symbol).collect()
        }
        Found::Sync(found) => {
            found.offsets.iter().flat_map(|at| &at.selected).map(|one| &one.symbol).collect()
        }
        Found::Parameters(found) => found.base.statistics.iter().map(|one| &one.symbol).collect(),
    };
    all.into_iter().collect::<indexmap::IndexSet<_>>().into_iter().cloned().collect()
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
        Some(verdict) => Finding { class: "open", sign: "–", word: unchanged(verdict) },
        None => Finding::new(None, "", "", otherwise),
    }
}

/// Content of the cover.
struct Opening {
    headline: Finding,
    sentence: String,
    facts: Vec<Fact>,
}

fn settings(study: &Study) -> Chapter {
    let row = |parameter: &crate::result::ParameterInfo| {
        [&parameter.name, &parameter.title, &parameter.value, &parameter.default, &parameter.set_by]
            .map(Clone::clone)
            .to_vec()
    };
    let table = Table {
        caption: "Parameters of the protocol, values used and defaults".into(),
        head: vec![
            Head::short("Name"),
            Head::text("Meaning"),
            Head::short("Used"),
            Head::short("Default"),
            Head::short("Set by"),
        ],
        rows: study.protocol.parameters.iter().map(row).collect(),
    };
    Chapter {
        id: "protocol".into(),
        title: "Protocol".into(),
        items: vec![
            Item::Text { text: study.protocol.verdict_rule.clone() },
            Item::Table { table },
        ],
    }
}

/// All figures of a study by their names in the document.
pub fn figures(study: &Study) -> Vec<(String, String)> {
    let words = &study.protocol.verdict_words;
    match &study.found {
        Found::Sections(found) => boxes(&found.quantities, BOXES),
        Found::Sync(found) => {
            let mut drawn = vec![
                ("selection".into(), figure::selection(found)),
                ("shares".into(), figure::shares(found, words)),
            ];
            for (at, offset) in found.offsets.iter().enumerate() {
                drawn.extend(boxes(&offset.quantities, &format!("{BOXES}-{at}")));
            }
            drawn
        }
        Found::Parameters(found) => vec![("choices".into(), figure::choices(found, words))],
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
