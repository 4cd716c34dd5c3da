//! Plausibility findings for print: the same finding in several sections is one row.

use super::document::{Cell, Column, Symbols, Table, Tone};
use super::number;
use crate::report::document::cells;
use crate::result::{Consequence, Finding};

/// Findings of one kind about one channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    pub code: String,
    /// `Y_1R, measurement`; empty if it concerns a section or the campaign.
    pub subject: String,
    /// `S01, S02 and 30 more`; empty if it concerns the campaign.
    pub sections: String,
    /// The first finding as a sentence.
    pub says: String,
    /// The likely cause; empty if none is known.
    pub cause: String,
    /// `noted`, `section not used`, `not assessable`.
    pub consequence: &'static str,
    pub tone: Tone,
}

/// Number of sections that are named before the rest is counted.
const NAMED_SECTIONS: usize = 4;

/// Rows in the order of their first finding.
pub fn rows(findings: &[Finding]) -> Vec<Row> {
    let mut groups: Vec<(&Finding, Vec<&str>)> = Vec::new();
    for finding in findings {
        let section = finding.section.as_deref();
        let alike = groups.iter_mut().find(|(first, _)| {
            (&first.code, &first.channel, &first.record, &first.cause, first.consequence)
                == (
                    &finding.code,
                    &finding.channel,
                    &finding.record,
                    &finding.cause,
                    finding.consequence,
                )
                && (first.section.is_some() && section.is_some() || first.data == finding.data)
        });
        match alike {
            Some((_, sections)) => sections.extend(section.filter(|name| !sections.contains(name))),
            None => groups.push((finding, section.into_iter().collect())),
        }
    }
    groups.iter().map(|(first, sections)| row(first, sections)).collect()
}

/// All findings as a table.
pub fn table(findings: &[Finding]) -> Table {
    let row = |row: Row| {
        cells![
            row.code,
            row.subject,
            row.sections,
            Symbols::default().text(&row.says),
            row.cause,
            Cell::from(row.consequence).toned(row.tone)
        ]
    };
    let columns = vec![
        Column::name("Rule").wide(0.9),
        Column::name("Channel").wide(0.8).sparse(),
        Column::name("Sections").wide(0.8).sparse(),
        Column::text("Finding").wide(2.2),
        Column::text("Likely cause").wide(1.9).sparse(),
        Column::text("Consequence").wide(0.8),
    ];
    Table::new("Findings on the data", columns, rows(findings).into_iter().map(row)).size(7.5)
}

fn row(first: &Finding, sections: &[&str]) -> Row {
    let subject = [first.channel.as_deref(), first.record.as_deref()];
    Row {
        code: first.code.clone(),
        subject: subject.into_iter().flatten().collect::<Vec<_>>().join(", "),
        sections: named(sections),
        says: number::raised(&String::from(first.text())),
        cause: first.cause.clone().unwrap_or_default(),
        consequence: first.consequence.in_words(),
        tone: if first.consequence == Consequence::Note { Tone::Open } else { Tone::Bad },
    }
}

fn named(sections: &[&str]) -> String {
    if sections.len() <= NAMED_SECTIONS + 1 {
        return sections.join(", ");
    }
    let more = number::count((sections.len() - NAMED_SECTIONS) as u64);
    format!("{} and {more} more", sections[..NAMED_SECTIONS].join(", "))
}

/// A row as one line of text.
pub fn line(row: &Row) -> String {
    let about: Vec<&str> = [&row.subject, &row.sections]
        .into_iter()
        .map(String::as_str)
        .filter(|part| !part.is_empty())
        .collect();
    let about = if about.is_empty() { String::new() } else { format!("{}: ", about.join(", ")) };
    let cause = if row.cause.is_empty() {
        String::new()
    } else {
        format!(" (likely cause: {})", row.cause)
    };
    format!("{about}{}{cause} [{}; {}]", row.says, row.code, row.consequence)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::FindingData;

    fn finding(section: Option<&str>, says: &str) -> Finding {
        Finding {
            section: section.map(str::to_string),
            channel: Some("Y_1R".into()),
            ..Finding::note("wheel-load", FindingData::Said { says: says.into() })
        }
    }

    #[test]
    fn the_same_in_many_sections_is_one_row() {
        let mut all: Vec<Finding> =
            (1..=7).map(|at| finding(Some(&format!("S0{at}")), &format!("mean {at} kN"))).collect();
        all.push(finding(None, "a fact of the campaign"));
        let rows = rows(&all);
        assert_eq!(rows.len(), 2);
        assert_eq!(
            line(&rows[0]),
            "Y_1R, S01, S02, S03, S04 and 3 more: mean 1 kN [wheel-load; noted]"
        );
        assert_eq!(line(&rows[1]), "Y_1R: a fact of the campaign [wheel-load; noted]");
    }
}
