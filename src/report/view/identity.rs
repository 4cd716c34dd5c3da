//! Identification of the report: the items that an assessor expects; missing ones are listed as not
//! stated.

use serde::Serialize;

use super::Fact;
use crate::result::report::stated;
use crate::result::{Certification, ReportItem};

/// Printed for an item that the campaign does not state.
const NOT_STATED: &str = "not stated";

/// Items of the cover and the page header.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ReportHead {
    /// `Report R-17, revision B`; empty if no number is stated.
    pub line: String,
    /// The date of issue, `2026-03-31`; `None` if it is not stated.
    pub issued: Option<String>,
    /// Items on the cover.
    pub cover: Vec<Fact>,
}

/// A row of the checklist.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct IdentityRow {
    /// Clause of ISO/IEC 17025:2017; empty for an item without a clause.
    pub clause: String,
    pub title: String,
    pub value: String,
    pub stated: bool,
}

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

pub(super) fn head(items: &[ReportItem]) -> ReportHead {
    let line = match (stated(items, &["number"]), stated(items, &["revision"])) {
        (Some(number), Some(revision)) => format!("Report {number}, revision {revision}"),
        (Some(number), None) => format!("Report {number}"),
        (None, Some(revision)) => format!("Revision {revision}"),
        (None, None) => String::new(),
    };
    let item = |path: &&[&str]| {
        let found = items.iter().find(|item| item.path == *path)?;
        Some(Fact {
            name: found.title.clone(),
            value: found.value.clone().unwrap_or_else(|| NOT_STATED.to_owned()),
        })
    };
    ReportHead {
        line,
        issued: stated(items, &["dates", "issue"]).map(str::to_owned),
        cover: COVER.iter().filter_map(item).collect(),
    }
}

/// The checklist: items stated by the campaign, and items known to the program.
pub(super) fn checklist(found: &Certification) -> Vec<IdentityRow> {
    let row = |clause: &str, title: &str, value: &str| IdentityRow {
        clause: unbroken(clause),
        title: title.to_owned(),
        value: value.to_owned(),
        stated: true,
    };
    let protocol = &found.protocol;
    let method = match &protocol.edition {
        Some(edition) => format!(
            "{} ({edition}); protocol “{}”, printed in this report",
            protocol.title, protocol.name
        ),
        None => format!("{}; protocol “{}”, printed in this report", protocol.title, protocol.name),
    };
    let mut rows = vec![row("7.8.2.1 a)", "Title", &super::title(found))];
    rows.extend(found.campaign.report.iter().map(|item| IdentityRow {
        clause: unbroken(item.clause.as_deref().unwrap_or_default()),
        title: item.title.clone(),
        value: item.value.clone().unwrap_or_else(|| NOT_STATED.to_owned()),
        stated: item.value.is_some(),
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
    rows
}

/// A clause number without line breaks.
fn unbroken(clause: &str) -> String {
    clause.replace(' ', "\u{a0}")
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
    if parts.is_empty() {
        "None from the protocol.".to_owned()
    } else {
        format!("{}; see chapter Protocol.", parts.join("; "))
    }
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
        let line = |number, revision| {
            head(&[item(&["number"], number), item(&["revision"], revision)]).line
        };
        assert_eq!(line(Some("7"), Some("B")), "Report 7, revision B");
        assert_eq!(line(Some("7"), None), "Report 7");
        assert_eq!(line(None, None), "");
        assert_eq!(head(&[item(&["dates", "issue"], None)]).issued, None);
        assert_eq!(head(&[item(&["dates", "issue"], None)]).cover[0].value, NOT_STATED);
    }
}
