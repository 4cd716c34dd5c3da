//! A comparison of protocols as a document: chapters of text, tables and figures, printed as PDF
//! and HTML from the same data.

mod agreement;
mod sensitivity;
pub mod tables;
mod verdicts;

use crate::report::figure;
use crate::report::number;
use crate::report::study::{Document, Item, Table};
use crate::report::view::{self, Fact, Finding};
use crate::result::comparison::{Comparison, Sensitivity};
use crate::result::{CampaignInfo, FileHash, Identification, Kind, ProtocolInfo, VerdictWords};

/// The comparison as printed in both reports.
pub fn document(found: &Comparison) -> Document {
    let (headline, sentence) = opening(found);
    let mut chapters = vec![verdicts::verdicts(found), verdicts::applicability(found)];
    chapters.extend(sensitivity::chapter(found));
    chapters.extend(agreement::chapter(found));
    chapters.extend(verdicts::differences(found));
    chapters.push(verdicts::ratios(found));
    chapters.push(verdicts::compared(found));
    let facts = [
        ("Protocols", found.protocols.len().to_string()),
        ("Campaigns", found.campaigns.len().to_string()),
        (
            "Records read",
            format!("{} of {} asked for", found.work.records_read, found.work.records_asked),
        ),
        (
            "Filters run",
            format!("{} of {} asked for", found.work.filters_run, found.work.filters_asked),
        ),
    ];
    let mut symbols: Vec<String> = found.ratios.iter().map(|ratio| ratio.symbol.clone()).collect();
    symbols.sort_unstable();
    symbols.dedup();
    Document {
        title: "Protocols side by side".into(),
        kind: "Comparison of protocols".into(),
        program: concat!("Fishplate ", env!("CARGO_PKG_VERSION")).to_owned(),
        headline,
        sentence,
        key_facts: facts.map(|(name, value)| Fact { name: name.into(), value }).to_vec(),
        symbols,
        campaign: view::campaign(&inputs(found)),
        protocol: view::protocol_view(&rules(found)),
        chapters,
    }
}

/// Campaigns on which the protocols have different verdicts.
fn opening(found: &Comparison) -> (Finding, String) {
    let differs = |campaign: &str| {
        let mut cells =
            found.verdicts.iter().filter(|cell| cell.campaign == campaign).map(|cell| cell.holds);
        let first = cells.next();
        cells.any(|holds| Some(holds) != first)
    };
    let apart: Vec<&str> =
        found.campaigns.iter().map(|one| one.name.as_str()).filter(|name| differs(name)).collect();
    let (all, different) = (found.campaigns.len(), apart.len());
    let of = format!("{different} of {all} campaign{}", if all == 1 { "" } else { "s" });
    if found.protocols.len() < 2 {
        return (
            Finding::new(None, "", "", "One protocol"),
            "The metrics of one protocol, their applicability and sensitivity.".into(),
        );
    }
    match different {
        0 => (
            Finding { class: "open", sign: "–", word: "The verdicts agree".into() },
            format!(
                "On {} the protocols have the same verdict.",
                if all == 1 { "the campaign" } else { "every campaign" }
            ),
        ),
        _ => (
            Finding::new(None, "", "", "The verdicts differ"),
            format!("On {of} the protocols have different verdicts: {}.", apart.join("; ")),
        ),
    }
}

/// All campaigns as one list of files.
fn inputs(found: &Comparison) -> CampaignInfo {
    let file = |campaign: &str, file: &FileHash| FileHash {
        path: format!("{campaign}/{}", file.path),
        ..file.clone()
    };
    let of = |one: &crate::result::comparison::OnCampaign| {
        one.files.iter().map(|known| file(&one.name, known)).collect::<Vec<_>>()
    };
    CampaignInfo {
        name: found.campaigns.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join("; "),
        members: Vec::new(),
        files: found.campaigns.iter().flat_map(of).collect(),
        vehicle: Vec::new(),
        facts: Vec::new(),
        origin: None,
        report: Identification::default(),
    }
}

/// All protocols in the place of one.
fn rules(found: &Comparison) -> ProtocolInfo {
    ProtocolInfo {
        name: found.protocols.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", "),
        title: found.protocols.iter().map(|one| one.title.as_str()).collect::<Vec<_>>().join("; "),
        sha256: found.work.sha256.clone(),
        edition: None,
        source: None,
        scope: None,
        notes: Vec::new(),
        files: found.protocols.iter().flat_map(|one| one.files.clone()).collect(),
        deviations: Vec::new(),
        parameters: Vec::new(),
        filters: Vec::new(),
        channels: Vec::new(),
        graph_nodes: found.work.operations,
        graph_svg: String::new(),
        verdict_rule: String::new(),
        verdict_words: VerdictWords::of(Kind::Validation),
    }
}

/// All figures of a comparison by their names in the document.
pub fn figures(found: &Comparison) -> Vec<(String, String)> {
    sensitivity::disturbances(found)
        .into_iter()
        .enumerate()
        .map(|(at, (name, curves))| {
            (format!("sensitivity-{at}"), figure::sensitivity(name, &curves))
        })
        .collect()
}

fn table(caption: &str, head: Vec<crate::report::study::Head>, rows: Vec<Vec<String>>) -> Item {
    let rows =
        rows.into_iter().map(|row| row.iter().map(|cell| number::raised(cell)).collect()).collect();
    Item::Table { table: Table { caption: caption.into(), head, rows } }
}

fn three(value: Option<f64>) -> String {
    value.map_or_else(|| number::NONE.to_owned(), |value| number::significant(value, 3))
}

/// A metric with its protocol, where there are several.
fn metric(one: &Sensitivity, found: &Comparison) -> String {
    if found.protocols.len() > 1 {
        format!("{}: {}", one.protocol, one.metric)
    } else {
        one.metric.clone()
    }
}
