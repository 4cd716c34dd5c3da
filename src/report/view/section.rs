//! The sections by zone, and their requirements.

use indexmap::IndexSet;

use super::{View, name, reports, search};
use crate::report::{document::*, number};
use crate::result::{CheckResult, SectionResult, ZoneResult};

/// Number of checks side by side that fit a page.
const CHECKS_ABREAST: usize = 4;

/// Sections, their use, and the requirements on them; none without sections and zones.
pub fn chapter(view: &View<'_>) -> Option<Chapter> {
    let found = view.found;
    let mut blocks: Vec<Block> = found.found.iter().flat_map(search::search).collect();
    blocks.extend(found.reduction.iter().flat_map(search::reduction));
    if !found.zones.is_empty() {
        blocks.push(zones(&found.zones).into());
    }
    let caption = "Data of the sections used".into();
    blocks.extend(reports::tables(&found.reported, &caption, "Sections"));
    let tables = by_zone(view);
    // One table of all sections needs no heading of its own.
    let several = tables.len() > 1;
    for (zone, sections) in tables {
        blocks.push(of_zone(view, zone, &sections, several));
    }
    let none = found.sections.is_empty() && found.zones.is_empty();
    (!none).then(|| Chapter::new("sections", "Sections", blocks))
}

fn zones(all: &[ZoneResult]) -> Table {
    let row = |zone: &ZoneResult| {
        Row::from(cells![
            Cell::from(name(&zone.zone)).strong(),
            zone.title,
            Cell::formula(&zone.condition),
            zone.given,
            zone.used,
            zone.minimum,
            Finding::of(Some(zone.holds))
        ])
        .in_zone(Some(&name(&zone.zone)))
    };
    Table::new("Test zones: sections used and required")
        .name("Zone")
        .text("Title")
        .wide(1.4)
        .text("Condition")
        .wide(2.0)
        .numbers(["Given", "Used", "Required"])
        .short("Criterion")
        .rows(all.iter().map(row))
        .size(8.5)
}

/// Sections by zone, in the order of the zones; sections without a zone last.
fn by_zone<'a>(view: &View<'a>) -> Vec<(Option<&'a str>, Vec<&'a SectionResult>)> {
    let found = view.found;
    let mut zones: IndexSet<Option<&str>> =
        found.zones.iter().map(|zone| Some(zone.zone.as_str())).collect();
    zones.extend(found.sections.iter().filter_map(|section| section.zone.as_deref()).map(Some));
    zones.insert(None);
    let within = |zone: Option<&'a str>| {
        let sections = found.sections.iter().filter(|section| section.zone.as_deref() == zone);
        (zone, sections.collect::<Vec<_>>())
    };
    zones.into_iter().map(within).filter(|(_, sections)| !sections.is_empty()).collect()
}

fn of_zone(
    view: &View<'_>,
    zone: Option<&str>,
    sections: &[&SectionResult],
    several: bool,
) -> Block {
    let known = view.found.zones.iter().find(|known| Some(known.zone.as_str()) == zone);
    let mut blocks = Vec::new();
    if zone.is_some() || several {
        blocks.push(Block::heading(match (zone, known) {
            (Some(zone), Some(known)) if !known.title.is_empty() && known.title != zone => {
                format!("Zone {zone}: {}", known.title)
            }
            (Some(zone), _) => format!("Zone {zone}"),
            (None, _) => "Sections".to_owned(),
        }));
    }
    let condition = known.map(|known| number::formula(&known.condition)).unwrap_or_default();
    if !condition.is_empty() {
        blocks.push(Block::text(format!("Condition: {condition}")));
    }
    let here = if zone.is_some() { " of this zone" } else { "" };
    blocks.push(table(sections, format!("Sections{here}")).into());
    let caption = format!("Requirements on the sections{here}");
    blocks.extend(checks(sections, &caption).into_iter().map(Block::from));
    Block::Zone(zone.map(name), blocks)
}

fn table(sections: &[&SectionResult], caption: String) -> Table {
    let all = || sections.iter().flat_map(|section| &section.columns);
    let names: IndexSet<&str> = all().map(|column| column.name.as_str()).collect();
    let text = |section: &SectionResult, name: &str| {
        let column = section.columns.iter().find(|column| column.name == name)?;
        Some(column.value.trim().to_owned()).filter(|text| !text.is_empty())
    };
    let head = |table: Table, name: &&str| {
        let mut texts = sections.iter().filter_map(|section| text(section, name));
        let unit = all().find(|column| column.name == **name).and_then(|one| one.unit.as_deref());
        let table = match texts.all(|text| number::is_number(&text)) {
            true => table.number(*name),
            false => table.name(*name).wide(1.0),
        };
        table.unit(unit.unwrap_or_default())
    };
    let axis = sections.first().map(|section| section.axis_unit.as_str()).unwrap_or_default();
    let format = Format::Fixed(number::decimals(axis, []));
    let row = |section: &&SectionResult| {
        let used = Finding::new(Some(section.used), "used", "not used", "");
        let mut cells = vec![Cell::from(name(&section.section)).strong()];
        cells.extend([section.start, section.end, section.length].map(|x| Cell::number(x, format)));
        cells.extend(
            names.iter().map(|name| text(section, name).map_or(Cell::MISSING, Cell::given)),
        );
        Row::from(cells).ending(used, section.reason.as_ref())
    };
    let size = match names.len() {
        0..=5 => 8.5,
        6..=8 => 7.5,
        _ => 6.5,
    };
    Table::new(caption)
        .name("Section")
        .wide(1.3)
        .each(["Start", "End", "Length"], |table, title| table.number(title).unit(axis))
        .each(&names, head)
        .text("Use")
        .wide(2.0)
        .rows(sections.iter().map(row))
        .size(size)
}

/// Requirements, a column each.
fn checks(sections: &[&SectionResult], caption: &str) -> Vec<Table> {
    let all = sections.iter().flat_map(|section| &section.checks);
    let mut known: Vec<&CheckResult> = Vec::new();
    for check in all {
        if !known.iter().any(|other| other.name == check.name) {
            known.push(check);
        }
    }
    let cell = |check: &CheckResult| {
        let mark = Run::Mark(Finding::of(check.holds));
        Text::from(mark).and(format!(" {}", number::formula(check.says.text())))
    };
    let table = |known: &[&CheckResult]| {
        let row = |section: &&SectionResult| {
            let check = |wanted: &&CheckResult| {
                let found = section.checks.iter().find(|check| check.name == wanted.name);
                Cell::or_missing(found.map(cell))
            };
            let section = Cell::from(name(&section.section)).strong();
            std::iter::once(section).chain(known.iter().map(check)).collect::<Vec<_>>()
        };
        let head = |table: Table, check: &&CheckResult| {
            table.text(if check.title.is_empty() { &check.name } else { &check.title }).wide(1.0)
        };
        let table = Table::new(caption).name("Section").wide(0.35).each(known, head);
        table.rows(sections.iter().map(row)).size(7.5)
    };
    known.chunks(CHECKS_ABREAST).map(table).collect()
}
