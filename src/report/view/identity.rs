//! Identification of the report: the items that an assessor expects; missing ones are listed as not
//! stated.

use super::View;
use crate::report::document::*;
use crate::result::{
    Certification, Departed, ReportItem, StatedValue, confirmation::Signed, report::stated,
};

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
        row("7.8.2.1 n)", "Deviations from the standard", &deviations(found, Departed::Standard)),
        row("7.8.2.1 n)", "Deviations from the protocol", &deviations(found, Departed::Protocol)),
        row(
            "7.8.2.1 l)",
            "Scope of the results",
            "The results relate only to the test item and to the records listed under Provenance.",
        ),
        row("7.8.3.1 b)", "Statement of conformity", super::wording::sentence(found)),
    ]);
    let about = "The items follow the checklist of ISO/IEC 17025:2017, clause 7.8. An item that the campaign does not state is listed as “not stated”.";
    let table = Table::new("Items of the report")
        .short("Clause")
        .names_row(false)
        .text("Item")
        .wide(0.5)
        .names_row(true)
        .text("Statement")
        .wide(1.0)
        .rows(rows)
        .class("");
    let mut blocks = vec![Block::text(about), table.into()];
    blocks.extend(values(found));
    let title = "Identification of the report";
    Chapter::new("identity", title, blocks).called("Identification")
}

/// The values that a user answers for, and who confirmed them.
fn values(found: &Certification) -> Vec<Block> {
    let row = |value: &StatedValue, signed: Option<&Signed>| {
        let title = (!value.title.is_empty()).then(|| Text::from(&value.title));
        let why = value.why.as_deref().unwrap_or("A value set in place of the default.");
        let lines = [Text::from(Run::Code(value.name.clone()))].into_iter().chain(title);
        let confirmed = match signed {
            Some(Signed { by, date }) => Cell::text(format!("{by}, {date}")),
            None => Cell::text(Run::Emphasis("not confirmed".into())),
        };
        cells![
            Cell::text(Text::lines(lines.chain([Run::Quiet(why.to_owned()).into()]))),
            Cell::formula(value.in_words()),
            Cell::or_missing(value.clause.as_deref()),
            confirmed
        ]
    };
    let open = found.provisional.iter().map(|value| row(value, None));
    let confirmed = found.confirmed.iter().map(|one| row(&one.value, Some(&one.signed)));
    let rows: Vec<_> = open.chain(confirmed).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let about = "The protocol does not have these values from a checked source, or they were set in place of its own. The verdict is provisional until each is confirmed for this edition of the protocol (“confirmed” in campaign.yaml).";
    let caption = "Values to be confirmed";
    vec![
        Block::heading(caption),
        Block::text(about),
        Table::new(caption)
            .text("Value of")
            .wide(1.6)
            .text("Value")
            .wide(1.0)
            .text("Clause or source")
            .wide(1.0)
            .text("Confirmed by")
            .wide(0.7)
            .rows(rows)
            .class("")
            .size(8.0)
            .into(),
    ]
}

/// A clause number without line breaks, if there is one.
fn unbroken(clause: &str) -> Option<String> {
    (!clause.is_empty()).then(|| clause.replace(' ', "\u{a0}"))
}

fn deviations(found: &Certification, from: Departed) -> String {
    let of = found.deviations.iter().filter(|one| one.from == from);
    let says: Vec<String> = of.map(|one| one.what.text().into()).collect();
    match from {
        _ if !says.is_empty() => says.join(" "),
        Departed::Standard => "None that the protocol states.".to_owned(),
        Departed::Protocol => "None.".to_owned(),
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
