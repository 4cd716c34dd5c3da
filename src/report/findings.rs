//! Plausibility findings for print: a row for each, with its places.

use indexmap::IndexSet;

use super::{
    document::{Cell, Symbols, Table, Tone},
    number,
};
use crate::report::document::cells;
use crate::result::{Consequence, Finding, Occurrence};
use crate::words;

/// A finding with its places.
struct Row {
    code: String,
    /// `Y_1R, measurement`; empty if it concerns a section or the campaign.
    subject: String,
    /// `S01, S02 and 30 more`; empty if it concerns the campaign.
    sections: String,
    /// What is found in the first place, as a sentence.
    says: String,
    /// The likely causes; empty if none is known.
    causes: String,
    /// `noted`, `section not used`, `not assessable`.
    consequence: &'static str,
    tone: Tone,
}

/// Number of names that are given before the rest is counted.
const NAMED: usize = 4;

/// All findings as a table.
pub fn table(findings: &[Finding]) -> Table {
    let row = |row: Row| {
        cells![
            row.code,
            row.subject,
            row.sections,
            Symbols::default().text(&row.says),
            row.causes,
            Cell::from(row.consequence).toned(row.tone)
        ]
    };
    let rows = findings.iter().map(Row::of).map(row);
    Table::new("Findings on the data")
        .name("Rule")
        .wide(0.9)
        .name("Channel")
        .wide(0.8)
        .sparse()
        .name("Sections")
        .wide(0.8)
        .sparse()
        .text("Finding")
        .wide(2.2)
        .text("Likely cause")
        .wide(1.9)
        .sparse()
        .text("Consequence")
        .wide(0.8)
        .rows(rows)
        .size(7.5)
}

impl Row {
    fn of(finding: &Finding) -> Self {
        let named = |part: fn(&Occurrence) -> Option<&String>| {
            let names: IndexSet<&String> = finding.places().iter().filter_map(part).collect();
            let shown = if names.len() <= NAMED + 1 { names.len() } else { NAMED };
            let list: Vec<&str> = names.iter().take(shown).map(|name| name.as_str()).collect();
            match (names.len() - shown) as u64 {
                0 => list.join(", "),
                more => format!("{} and {} more", list.join(", "), number::count(more)),
            }
        };
        let subject = [named(|at| at.channel.as_ref()), named(|at| at.record.as_ref())];
        let mut also: IndexSet<&str> = finding.with_explained().filter_map(Finding::rule).collect();
        also.shift_remove(finding.rule().unwrap_or_default());
        let also: Vec<&str> = also.into_iter().collect();
        let also = match also.as_slice() {
            [] => String::new(),
            all => format!("; hence also: {}", all.join(", ")),
        };
        let consequence = finding.with_explained().map(|one| one.consequence).max();
        let consequence = consequence.unwrap_or(finding.consequence);
        let causes: Vec<String> =
            finding.causes.iter().map(|cause| words::text(cause).into()).collect();
        let subject: Vec<String> = subject.into_iter().filter(|part| !part.is_empty()).collect();
        Self {
            code: finding.code.clone(),
            subject: subject.join(", "),
            sections: named(|at| at.section.as_ref()),
            says: number::raised(finding.first.text()) + &also,
            causes: causes.join("; "),
            consequence: consequence.in_words(),
            tone: if consequence == Consequence::Note { Tone::Open } else { Tone::Bad },
        }
    }
}

/// Where it is, each with the value found: `S01 Y_1R measurement 5.3; S02 ...`.
pub fn places(finding: &Finding) -> String {
    let place = |at: &Occurrence| {
        let names = [&at.campaign, &at.section, &at.channel, &at.record];
        let names = names.into_iter().flatten().cloned();
        names.chain(at.value.map(|value| value.to_string())).collect::<Vec<_>>().join(" ")
    };
    finding.places().iter().map(place).collect::<Vec<_>>().join("; ")
}

/// A finding as one line of text.
pub fn line(finding: &Finding) -> String {
    let row = Row::of(finding);
    let about: Vec<&str> = [&row.subject, &row.sections]
        .into_iter()
        .map(String::as_str)
        .filter(|part| !part.is_empty())
        .collect();
    let about = if about.is_empty() { String::new() } else { format!("{}: ", about.join(", ")) };
    let cause = if row.causes.is_empty() {
        String::new()
    } else {
        format!(" (likely cause: {})", row.causes)
    };
    format!("{about}{}{cause} [{}; {}]", row.says, row.code, row.consequence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::{Channels, FindingData};

    fn finding(section: Option<&str>, rule: &str) -> Finding {
        let data = FindingData::Copies {
            rule: rule.into(),
            channels: Channels::of(&["Y_1R"]),
            copied: None,
            record: None,
            section: section.map(str::to_string),
        };
        let first = Occurrence {
            section: section.map(str::to_string),
            channel: Some("Y_1R".into()),
            ..data.into()
        };
        Finding::note("copies", first)
    }

    #[test]
    fn the_same_in_many_sections_is_one_row() {
        let mut all: Vec<Finding> =
            (1..=7).map(|at| finding(Some(&format!("S0{at}")), "Copies")).collect();
        all.push(finding(None, "Others"));
        let joined = Finding::joined(all);
        assert_eq!(joined.len(), 2);
        let says = "Y_1R repeats the samples of the same channels";
        assert_eq!(
            line(&joined[0]),
            format!(
                "Y_1R, S01, S02, S03, S04 and 3 more: Copies: {says} of section S01 [copies; noted]"
            )
        );
        assert_eq!(line(&joined[1]), format!("Y_1R: Others: {says} [copies; noted]"));
    }
}
