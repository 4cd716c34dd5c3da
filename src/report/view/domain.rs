//! The validity domain: ranges of the conditions over the sections used, and wanted operation.

use indexmap::IndexSet;

use super::{View, application};
use crate::report::{document::*, number};
use crate::result::{Certification, DomainRange};

/// Zones that have a column each in a table on paper.
const ABREAST: usize = 6;

/// Digits of the ends of a range.
const DIGITS: usize = 6;

/// Ranges of the test conditions, and wanted operation against the hull of the sections.
pub fn chapter(view: &View<'_>) -> Option<Chapter> {
    let (found, title) = (view.found, view.words.domain);
    if found.domain.is_empty() && found.application.is_empty() {
        return None;
    }
    let says =
        format!("Ranges of the test conditions over the sections used. {}", view.words.outside);
    let mut blocks = vec![Block::text(says)];
    if !found.domain.is_empty() {
        let alt = format!(
            "Range of {} conditions over the sections used; the numbers are in the table of this chapter.",
            found.domain.len()
        );
        let caption = format!("{title}: range of the conditions over the sections used");
        blocks.push(Figure::new("domain", caption, alt, 170).into());
        blocks.extend(ranges(found));
    }
    blocks.extend(found.application.iter().enumerate().flat_map(application::blocks));
    Some(Chapter::new("domain", title, blocks))
}

/// On paper, conditions as rows and zones as columns if there are few zones, else a list.
fn ranges(found: &Certification) -> Vec<Block> {
    let mut scopes: Vec<String> = found.domain.iter().map(scope).collect();
    scopes.sort_unstable();
    scopes.dedup();
    let list = list(&found.domain).into();
    if scopes.len() > ABREAST {
        return vec![list];
    }
    vec![Block::on_paper([matrix(&found.domain, &scopes).into()]), Block::on_screen([list])]
}

const CAPTION: &str = "Range of each condition, and the number of sections with a value";

fn list(all: &[DomainRange]) -> Table {
    let end = |value: f64| Cell::number(value, Format::Significant(DIGITS));
    let rows = conditions(all).into_iter().flat_map(|condition| {
        all.iter().filter(move |range| named(range) == condition).map(|range| {
            cells![
                Cell::from(&range.name).strong(),
                number::unit(&range.unit),
                scope(range),
                end(range.low),
                end(range.high),
                range.count
            ]
        })
    });
    Table::new(CAPTION)
        .text("Condition")
        .wide(2.0)
        .once()
        .short("Unit")
        .once()
        .text("Sections")
        .wide(1.0)
        .numbers(["Lowest", "Highest", "n"])
        .rows(rows)
        .size(8.5)
}

fn matrix(all: &[DomainRange], scopes: &[String]) -> Table {
    let row = |condition: (&str, &str)| {
        let cell = |wanted: &String| {
            let range =
                all.iter().find(|range| named(range) == condition && scope(range) == *wanted)?;
            let end = |value: f64| number::significant(value, DIGITS);
            let ends = Text::from(format!("{} to {}", end(range.low), end(range.high)));
            Some(ends.then(Run::Break(())).then(Run::Quiet(format!("n = {}", range.count))))
        };
        let mut row = cells![Cell::from(condition.0).strong(), number::unit(condition.1)];
        row.extend(scopes.iter().map(|scope| Cell::or_missing(cell(scope))));
        row
    };
    Table::new(CAPTION)
        .text("Condition")
        .wide(1.2)
        .short("Unit")
        .each(scopes, |table, scope| table.number(scope).wide(1.0).only(Medium::Paper))
        .rows(conditions(all).into_iter().map(row))
        .size(8.0)
}

fn named(range: &DomainRange) -> (&str, &str) {
    (&range.name, &range.unit)
}

/// Conditions in order of occurrence.
fn conditions(all: &[DomainRange]) -> IndexSet<(&str, &str)> {
    all.iter().map(named).collect()
}

fn scope(range: &DomainRange) -> String {
    range.scope.to_string()
}
