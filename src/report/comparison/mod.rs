//! A comparison of protocols as a document: chapters of text, tables and figures, printed as PDF
//! and HTML from the same data.

mod agreement;
mod sensitivity;
mod verdicts;

use crate::report::{
    document::*,
    figure,
    view::{self, Opening},
};
use crate::result::{
    CampaignInfo, FileHash, Identification, Kind, ProtocolInfo, VerdictWords,
    comparison::{Compared, Comparison, OnCampaign, Sensitivity},
};

/// Title of every comparison.
pub const TITLE: &str = "Protocols side by side";

/// The comparison as printed in both reports.
pub fn document(found: &Comparison) -> Document {
    let mut chapters = vec![verdicts::verdicts(found), verdicts::applicability(found)];
    chapters.extend(sensitivity::chapter(found));
    chapters.extend(agreement::chapter(found));
    chapters.extend(verdicts::differences(found));
    chapters.push(verdicts::ratios(found));
    chapters.push(verdicts::compared(found));
    let title = (TITLE.into(), "Comparison of protocols");
    let campaigns: Vec<&OnCampaign> = found.campaigns.iter().collect();
    let protocols: Vec<&Compared> = found.protocols.iter().collect();
    let rules = ProtocolInfo {
        sha256: found.work.sha256.clone(),
        graph_nodes: found.work.operations,
        ..rules(&protocols)
    };
    view::study(title, opening(found), (&inputs(&campaigns), &rules), chapters)
}

/// What it came to, and what was done for it.
pub fn opening(found: &Comparison) -> Opening {
    let (headline, sentence) = verdicts_apart(found);
    let work = &found.work;
    let facts = [
        ("Protocols", found.protocols.len().to_string()),
        ("Campaigns", found.campaigns.len().to_string()),
        ("Records read", format!("{} of {} asked for", work.records_read, work.records_asked)),
        ("Filters run", format!("{} of {} asked for", work.filters_run, work.filters_asked)),
    ];
    let facts = facts.map(|(name, value)| Fact::new(name, value)).to_vec();
    Opening { headline, sentence, facts }
}

/// Campaigns on which the protocols have different verdicts.
fn verdicts_apart(found: &Comparison) -> (Finding, String) {
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
            Finding::neutral("The verdicts agree"),
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

/// Names one after the other.
fn joined<T>(all: &[&T], name: impl Fn(&T) -> &str, between: &str) -> String {
    all.iter().map(|one| name(one)).collect::<Vec<_>>().join(between)
}

/// All campaigns as one list of files.
fn inputs(all: &[&OnCampaign]) -> CampaignInfo {
    let file = |campaign: &str, file: &FileHash| FileHash {
        path: format!("{campaign}/{}", file.path),
        ..file.clone()
    };
    let of = |one: &&OnCampaign| {
        one.files.iter().map(|known| file(&one.name, known)).collect::<Vec<_>>()
    };
    campaigns(joined(all, |one| &one.name, "; "), all.iter().flat_map(of).collect())
}

/// Several campaigns in the place of one.
pub fn campaigns(name: String, files: Vec<FileHash>) -> CampaignInfo {
    CampaignInfo {
        name,
        files,
        members: Vec::new(),
        vehicle: Vec::new(),
        facts: Vec::new(),
        outside_table: Vec::new(),
        origin: None,
        report: Identification::default(),
    }
}

/// All protocols in the place of one.
pub fn rules(all: &[&Compared]) -> ProtocolInfo {
    ProtocolInfo {
        name: joined(all, |one| &one.name, ", "),
        title: joined(all, |one| &one.title, "; "),
        sha256: String::new(),
        own: None,
        shipped_edition: None,
        edition: None,
        source: None,
        scope: None,
        notes: Vec::new(),
        files: all.iter().flat_map(|one| one.files.clone()).collect(),
        deviations: Vec::new(),
        parameters: Vec::new(),
        parameters_off_default: Vec::new(),
        filters: Vec::new(),
        channels: Vec::new(),
        graph_nodes: 0,
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

/// The whole comparison as `comparison.json`, ending in a line break.
pub fn json(found: &Comparison) -> String {
    // Serialisation of plain values cannot fail.
    serde_json::to_string_pretty(found).unwrap_or_default() + "\n"
}

/// A number with three digits, and a dash for none.
fn three(value: Option<f64>) -> Cell {
    Cell::number(value, Format::Significant(3))
}

/// A metric with its protocol, where there are several.
fn metric(one: &Sensitivity, found: &Comparison) -> String {
    if found.protocols.len() > 1 {
        format!("{}: {}", one.protocol, one.metric)
    } else {
        one.metric.clone()
    }
}
