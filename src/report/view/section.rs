//! The sections by zone, their requirements, and the validity domain.

use indexmap::IndexSet;
use serde::Serialize;

use super::{Finding, name};
use crate::report::number;
use crate::result::{Certification, DomainRange, SectionResult, ZoneResult};

/// Number of checks side by side that fit a page.
const CHECKS_ABREAST: usize = 4;

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ZoneView {
    pub zone: String,
    pub title: String,
    pub condition: String,
    pub used: String,
    pub given: String,
    pub minimum: String,
    pub holds: Finding,
}

/// The sections of one zone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SectionTable {
    pub zone: Option<String>,
    /// `Zone 1: Straight track`; `Sections` where there are no zones.
    pub title: String,
    pub condition: String,
    /// Unit of start, end and length.
    pub axis_unit: String,
    pub columns: Vec<ColumnHead>,
    pub rows: Vec<SectionRow>,
    /// Requirements, up to four side by side; empty if the protocol has none.
    pub checks: Vec<CheckTable>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ColumnHead {
    pub title: String,
    pub unit: String,
    /// All values are numbers: aligned to the right.
    pub numeric: bool,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SectionRow {
    pub section: String,
    pub start: String,
    pub end: String,
    pub length: String,
    /// One text per column.
    pub values: Vec<String>,
    pub used: Finding,
    pub reason: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckTable {
    pub titles: Vec<String>,
    pub rows: Vec<CheckRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckRow {
    pub section: String,
    /// One per title; `None` where the requirement does not apply to the section.
    pub cells: Vec<Option<CheckCell>>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckCell {
    pub holds: Finding,
    pub says: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DomainView {
    pub name: String,
    pub unit: String,
    pub rows: Vec<DomainRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DomainRow {
    pub scope: String,
    pub low: String,
    pub high: String,
    pub count: String,
}

pub(super) fn zones(found: &Certification) -> Vec<ZoneView> {
    found
        .zones
        .iter()
        .map(|zone| ZoneView {
            zone: name(&zone.zone),
            title: zone.title.clone(),
            condition: number::formula(&zone.condition),
            used: zone.used.to_string(),
            given: zone.given.to_string(),
            minimum: zone.minimum.to_string(),
            holds: Finding::of(Some(zone.holds)),
        })
        .collect()
}

pub(super) fn tables(found: &Certification) -> Vec<SectionTable> {
    let mut zones: IndexSet<Option<&str>> =
        found.zones.iter().map(|zone| Some(zone.zone.as_str())).collect();
    zones.extend(found.sections.iter().filter_map(|section| section.zone.as_deref()).map(Some));
    zones.insert(None);
    zones
        .into_iter()
        .filter_map(|zone| {
            let sections: Vec<&SectionResult> =
                found.sections.iter().filter(|section| section.zone.as_deref() == zone).collect();
            let known = found.zones.iter().find(|known| Some(known.zone.as_str()) == zone);
            (!sections.is_empty()).then(|| table(zone, known, &sections))
        })
        .collect()
}

/// Section data that were found have more digits than they are worth: of a number as long as this,
/// three decimals are printed.
fn short(text: String) -> String {
    /// Decimals from which on a number is not one that was written by hand.
    const MANY: usize = 5;
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    match text.parse::<f64>() {
        // A small number, such as a curvature, keeps its digits.
        Ok(value) if decimals >= MANY && value.abs() >= 1.0 => {
            format!("{value:.3}").trim_end_matches('0').trim_end_matches('.').to_string()
        }
        _ => text,
    }
}

fn table(
    zone: Option<&str>,
    known: Option<&ZoneResult>,
    sections: &[&SectionResult],
) -> SectionTable {
    let names: IndexSet<&str> = sections
        .iter()
        .flat_map(|section| &section.columns)
        .map(|column| column.name.as_str())
        .collect();
    let text = |section: &SectionResult, name: &str| {
        section
            .columns
            .iter()
            .find(|column| column.name == name)
            .map(|column| column.value.trim().to_owned())
    };
    let columns = names
        .iter()
        .map(|name| ColumnHead {
            title: (*name).to_owned(),
            unit: sections
                .iter()
                .flat_map(|section| &section.columns)
                .find(|column| column.name == *name)
                .and_then(|column| column.unit.as_deref())
                .filter(|unit| *unit != "-")
                .map(number::unit)
                .unwrap_or_default(),
            numeric: sections
                .iter()
                .filter_map(|section| text(section, name))
                .filter(|text| !text.is_empty())
                .all(|text| number::is_number(&text)),
        })
        .collect();
    let axis_unit = sections.first().map(|section| section.axis_unit.as_str()).unwrap_or_default();
    let decimals = number::decimals(axis_unit, []);
    SectionTable {
        zone: zone.map(name),
        title: match (zone, known) {
            (Some(zone), Some(known)) if !known.title.is_empty() && known.title != zone => {
                format!("Zone {zone}: {}", known.title)
            }
            (Some(zone), _) => format!("Zone {zone}"),
            (None, _) => "Sections".to_owned(),
        },
        condition: known.map(|zone| number::formula(&zone.condition)).unwrap_or_default(),
        axis_unit: number::unit(axis_unit),
        columns,
        rows: sections
            .iter()
            .map(|section| SectionRow {
                section: name(&section.section),
                start: number::fixed(section.start, decimals),
                end: number::fixed(section.end, decimals),
                length: number::fixed(section.length, decimals),
                values: names
                    .iter()
                    .map(|name| {
                        text(section, name).filter(|text| !text.is_empty()).map_or_else(
                            || number::NONE.to_owned(),
                            |text| number::in_text(&short(text)),
                        )
                    })
                    .collect(),
                used: Finding::new(Some(section.used), "used", "not used", ""),
                reason: section.reason.as_deref().map(number::raised),
            })
            .collect(),
        checks: checks(sections),
    }
}

fn checks(sections: &[&SectionResult]) -> Vec<CheckTable> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for check in sections.iter().flat_map(|section| &section.checks) {
        if !names.iter().any(|(name, _)| *name == check.name) {
            names.push((
                &check.name,
                if check.title.is_empty() { &check.name } else { &check.title },
            ));
        }
    }
    names
        .chunks(CHECKS_ABREAST)
        .map(|names| CheckTable {
            titles: names.iter().map(|(_, title)| (*title).to_owned()).collect(),
            rows: sections
                .iter()
                .map(|section| CheckRow {
                    section: name(&section.section),
                    cells: names
                        .iter()
                        .map(|(name, _)| {
                            let check = section.checks.iter().find(|check| check.name == *name)?;
                            Some(CheckCell {
                                holds: Finding::of(check.holds),
                                says: number::formula(&check.says),
                            })
                        })
                        .collect(),
                })
                .collect(),
        })
        .collect()
}

/// Ranges grouped by condition; scopes in order of occurrence.
pub(super) fn domain(found: &Certification) -> Vec<DomainView> {
    let names: IndexSet<(&str, &str)> =
        found.domain.iter().map(|range| (range.name.as_str(), range.unit.as_str())).collect();
    names
        .into_iter()
        .map(|(name, unit)| DomainView {
            name: name.to_owned(),
            unit: number::unit(unit),
            rows: found
                .domain
                .iter()
                .filter(|range| range.name == name && range.unit == unit)
                .map(domain_row)
                .collect(),
        })
        .collect()
}

fn domain_row(range: &DomainRange) -> DomainRow {
    DomainRow {
        scope: range.scope.to_string(),
        low: number::significant(range.low, 6),
        high: number::significant(range.high, 6),
        count: range.count.to_string(),
    }
}
