//! Identification of the report: the items that an assessor expects; missing ones are listed as not
//! stated.

use super::View;
use crate::report::document::*;
use crate::result::report::stated;
use crate::result::{Certification, Finding, FindingData, Occurrence, ReportItem};

/// Printed for an item that the campaign does not state.
const NOT_STATED: &str = "not stated";

/// Items on the cover, in its order.
const COVER: [&[&str]; 7] = [
    &["number"],
    &["revision"],
    &["dates", "issue"],
    &["customer"],
    &["laboratory"],
    &["test item", "description"],
    &["test item", "vehicle number"],
];

/// `Report R-17, revision B`; empty if no number is stated.
pub fn line(items: &[ReportItem]) -> String {
    match (stated(items, &["number"]), stated(items, &["revision"])) {
        (Some(number), Some(revision)) => format!("Report {number}, revision {revision}"),
        (Some(number), None) => format!("Report {number}"),
        (None, Some(revision)) => format!("Revision {revision}"),
        (None, None) => String::new(),
    }
}

/// The date of issue, if it is stated.
pub fn issued(items: &[ReportItem]) -> Option<String> {
    stated(items, &["dates", "issue"]).map(str::to_owned)
}

/// Items on the cover.
pub fn on_cover(items: &[ReportItem]) -> Vec<Fact> {
    let item = |path: &&[&str]| {
        let found = items.iter().find(|item| item.path == *path)?;
        Some(Fact::new(&found.title, found.value.as_deref().unwrap_or(NOT_STATED)))
    };
    COVER.iter().filter_map(item).collect()
}

/// The checklist: items stated by the campaign, and items known to the program.
pub fn chapter(view: &View<'_>) -> Chapter {
    let found = view.found;
    let row = |clause: &str, title: &str, value: &str| {
        cells![Cell::or_missing(unbroken(clause)), Cell::text(title).strong(), Cell::text(value)]
    };
    let protocol = &found.protocol;
    let edition =
        protocol.edition.as_ref().map_or_else(String::new, |edition| format!(" ({edition})"));
    let method = format!(
        "{}{edition}; protocol “{}”, printed in this report",
        protocol.title, protocol.name
    );
    let mut rows = vec![row("7.8.2.1 a)", "Title", &super::title(view))];
    rows.extend(found.campaign.report.iter().map(|item| {
        let value = item
            .value
            .as_ref()
            .map_or_else(|| Cell::text(Run::Emphasis(NOT_STATED.into())), Cell::from);
        let clause = Cell::or_missing(item.clause.as_deref().and_then(unbroken));
        cells![clause, Cell::text(&item.title).strong(), value]
    }));
    rows.extend([
        row("7.8.2.1 f)", "Method", &method),
        row("7.8.2.1 n)", "Deviations from the method", &deviations(found)),
        row(
            "7.8.2.1 l)",
            "Scope of the results",
            "The results relate only to the test item and to the records listed under Provenance.",
        ),
        row("7.8.3.1 b)", "Statement of conformity", super::wording::sentence(found)),
    ]);
    let columns = vec![
        Column::short("Clause").names_row(false),
        Column::text("Item").wide(0.5).names_row(true),
        Column::text("Statement").wide(1.0),
    ];
    let about = "The items follow the checklist of ISO/IEC 17025:2017, clause 7.8. An item that the campaign does not state is listed as “not stated”.";
    let table = Table::new("Items of the report", columns, rows).class("");
    let title = "Identification of the report";
    Chapter::new("identity", title, vec![Block::text(about), table.into()]).called("Identification")
}

/// A clause number without line breaks, if there is one.
fn unbroken(clause: &str) -> Option<String> {
    (!clause.is_empty()).then(|| clause.replace(' ', "\u{a0}"))
}

/// A record that was edited, and why.
fn edited(place: &Occurrence) -> Option<String> {
    match &place.data {
        FindingData::RecordChanged { file, reason: Some(reason), .. } => {
            Some(format!("{file} ({reason})"))
        }
        _ => None,
    }
}

fn deviations(found: &Certification) -> String {
    let protocol = &found.protocol;
    let changed: Vec<String> = protocol
        .parameters
        .iter()
        .filter(|parameter| parameter.value != parameter.default)
        .map(|parameter| {
            format!("{} = {} (default {})", parameter.name, parameter.value, parameter.default)
        })
        .collect();
    let mut parts = Vec::new();
    match protocol.deviations.len() {
        0 => {}
        1 => parts.push("1 rule differs from the parent protocol".to_owned()),
        many => parts.push(format!("{many} rules differ from the parent protocol")),
    }
    if !changed.is_empty() {
        parts.push(format!("parameters changed: {}", changed.join(", ")));
    }
    let edited: Vec<String> =
        found.findings.iter().flat_map(Finding::places).filter_map(edited).collect();
    let mut said = Vec::new();
    if !parts.is_empty() {
        said.push(format!("{}; see chapter Protocol.", parts.join("; ")));
    }
    if !edited.is_empty() {
        said.push(format!("Records edited after the import: {}.", edited.join("; ")));
    }
    if said.is_empty() { "None from the protocol.".to_owned() } else { said.join(" ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(path: &[&str], value: Option<&str>) -> ReportItem {
        let path = path.iter().map(ToString::to_string).collect();
        ReportItem { path, title: "Title".into(), clause: None, value: value.map(str::to_owned) }
    }

    #[test]
    fn the_head_says_what_is_stated_and_no_more() {
        let line =
            |number, revision| line(&[item(&["number"], number), item(&["revision"], revision)]);
        assert_eq!(line(Some("7"), Some("B")), "Report 7, revision B");
        assert_eq!(line(Some("7"), None), "Report 7");
        assert_eq!(line(None, None), "");
        let unstated = [item(&["dates", "issue"], None)];
        assert_eq!(issued(&unstated), None);
        assert_eq!(on_cover(&unstated)[0].value.letters(), NOT_STATED);
    }
}
