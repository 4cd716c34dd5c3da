//! Sections of the campaign: their data, the requirements on them, and why one is not used.

use super::facts::{Facts, Known, item, scalar, trimmed};
use super::pairs::SectionValues;
use super::signal::Extent;
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Datum, DatumKind, OnFault, Plan, Scalar};
use crate::data::Campaign;
use crate::data::table::Cell;
use crate::problem::{Problem, Problems};
use crate::result::{CheckResult, SectionResult};
use crate::source::Span;
use crate::units::Unit as OfMeasure;

/// A section, or a whole record where there are none.
#[derive(Debug)]
pub struct Unit {
    pub name: String,
    /// The name where it is written, which is also that of its records.
    pub cell: Cell,
    pub zone: Option<String>,
    /// `None` for a whole record.
    pub extent: Option<Extent>,
    /// What a report says it covers: the section, or the measured record.
    pub covered: Option<Extent>,
    /// One for each [`Plan::columns`].
    pub columns: Vec<Result<Scalar, String>>,
    pub checks: Vec<CheckResult>,
    /// Why it is not used.
    pub fault: Option<String>,
    /// The fault lies in the data, not in a requirement.
    pub faulty: bool,
    /// Row of the table of sections.
    pub span: Option<Span>,
}

impl Unit {
    pub fn known<'a>(&'a self, facts: &'a Facts) -> Known<'a> {
        Known { columns: Some(&self.columns), extent: self.extent, ..Known::vehicle(facts) }
    }

    fn refuse(&mut self, reason: String, faulty: bool) {
        if self.fault.is_none() {
            self.fault = Some(reason);
            self.faulty = faulty;
        }
    }
}

/// Reads the sections as the protocol declares their columns.
pub fn units(plan: &Plan, campaign: &Campaign, problems: &mut Problems) -> Vec<Unit> {
    if plan.sections.whole_records {
        return campaign.names.iter().map(|name| whole_record(plan, name)).collect();
    }
    let Some(table) = &campaign.sections else {
        problems.push(
            Problem::error("no-sections", "the campaign has no table of sections, and the protocol evaluates sections")
                .help("name it in campaign.yaml: `sections: sections.csv`; or use a protocol with `use whole records`"),
        );
        return Vec::new();
    };
    let axis = OfMeasure::clone(&plan.axis.unit);
    let extent_datum = |name: &str| Datum {
        name: name.into(),
        title: name.into(),
        key: name.into(),
        kind: DatumKind::Number(axis.clone()),
        default: None,
        span: plan.columns.first().map_or_else(|| crate::source::Source::new("", "").whole(), |datum| datum.span.clone()),
    };
    let (start, end) = (extent_datum("start"), extent_datum("end"));
    let mut missing = false;
    for datum in plan.columns.iter().chain([&start, &end]) {
        missing |= column_missing(datum, table, problems);
    }
    if missing {
        return Vec::new();
    }
    let mut units = Vec::new();
    for row in 0..table.rows.len() {
        let columns: Vec<Result<Scalar, String>> = plan.columns.iter().map(|datum| cell(datum, table, row)).collect();
        let ends = [cell(&start, table, row), cell(&end, table, row)];
        let mut unit = Unit {
            name: campaign.names[row].value.clone(),
            cell: campaign.names[row].clone(),
            zone: plan.sections.zone.and_then(|zone| match &columns[zone] {
                Ok(Scalar::Word(word)) => Some(word.clone()),
                _ => None,
            }),
            extent: None,
            covered: None,
            columns,
            checks: Vec::new(),
            fault: None,
            faulty: false,
            span: Some(campaign.names[row].span.clone()),
        };
        match ends {
            [Ok(Scalar::Number(start)), Ok(Scalar::Number(end))] if start < end => unit.extent = Some((start, end)),
            [Ok(_), Ok(_)] => unit.refuse("its start is not before its end".into(), true),
            [Err(reason), _] | [_, Err(reason)] => unit.refuse(reason, true),
        }
        units.push(unit);
    }
    units
}

fn whole_record(plan: &Plan, name: &Cell) -> Unit {
    let columns = plan
        .columns
        .iter()
        .map(|datum| datum.default.clone().ok_or_else(|| format!("`{}` is not known of a whole record", datum.name)))
        .collect();
    Unit {
        name: name.value.clone(),
        cell: name.clone(),
        zone: None,
        extent: None,
        covered: None,
        columns,
        checks: Vec::new(),
        fault: None,
        faulty: false,
        span: None,
    }
}

/// A column that the protocol declares must be there, in a unit of its dimension.
fn column_missing(datum: &Datum, table: &crate::data::table::Table, problems: &mut Problems) -> bool {
    let Some(index) = table.column(&datum.key) else {
        if datum.default.is_some() {
            return false;
        }
        let known: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        problems.push(
            Problem::error("missing-column", format!("the table of sections has no column `{}`", datum.key))
                .at(&table.columns[0].span.to(&table.columns[table.columns.len() - 1].span))
                .also(&datum.span, "the protocol needs it")
                .suggest(&datum.key, known),
        );
        return true;
    };
    let column = &table.columns[index];
    let DatumKind::Number(unit) = &datum.kind else { return false };
    match column.unit(Some(unit.dimension)) {
        Ok(_) => false,
        Err(problem) => {
            problems.push(problem.also(&datum.span, format!("declared in {unit}")));
            true
        }
    }
}

fn cell(datum: &Datum, table: &crate::data::table::Table, row: usize) -> Result<Scalar, String> {
    let Some(index) = table.column(&datum.key) else {
        return datum.default.clone().ok_or_else(|| format!("there is no column `{}`", datum.key));
    };
    let text = table.cell(row, index).map_or("", |cell| cell.value.trim());
    if text.is_empty() {
        return datum.default.clone().ok_or_else(|| format!("`{}` is empty", datum.key));
    }
    // Cells are in the unit of the column's header, which was found to be of the right dimension.
    let of_column = match (&datum.kind, table.columns[index].unit(None)) {
        (DatumKind::Number(_), Ok(unit)) => DatumKind::Number(unit),
        (kind, _) => kind.clone(),
    };
    scalar(&of_column, text).map_err(|says| format!("`{}`: {says}", datum.key))
}

/// Requirements that need no record: the protocol's selection, the zone's condition, the length.
pub fn check_data(plan: &Plan, facts: &Facts, units: &mut [Unit]) {
    for unit in units.iter_mut() {
        let mut verdicts: Vec<CheckResult> = Vec::new();
        if let Some(index) = plan.sections.zone {
            if let Err(reason) = &unit.columns[index] {
                let reason = reason.clone();
                unit.refuse(reason, true);
            }
        }
        let known = unit.known(facts);
        if let Some(only) = &plan.sections.only {
            verdicts.push(outcome("selection", "Selection of sections", flag(only, &known), &plan.sections.only_words));
        }
        if let Some(zone) = unit.zone.as_ref().and_then(|name| plan.zones.iter().find(|zone| zone.name == *name)) {
            if let Some(condition) = &zone.condition {
                let title = format!("Zone {}", zone.name);
                verdicts.push(outcome("zone", &title, flag(condition, &known), &zone.condition_words));
            }
            if let (Some(minimum), Some((start, end))) = (&zone.minimum_length, unit.extent) {
                let unit = &plan.axis.unit;
                let check = number(minimum, &known).map(|minimum| {
                    // A length written with two decimals may fall short of the minimum by rounding alone.
                    let holds = end - start >= minimum * (1.0 - 1e-9);
                    (
                        holds,
                        format!("length {} {unit}, at least {} {unit}", trimmed(unit.from_si(end - start)), trimmed(unit.from_si(minimum))),
                    )
                });
                verdicts.push(match check {
                    Ok((holds, says)) => CheckResult { name: "length".into(), title: "Minimum length".into(), holds: Some(holds), says },
                    Err(says) => CheckResult { name: "length".into(), title: "Minimum length".into(), holds: None, says },
                });
            }
        }
        for check in verdicts {
            if check.holds != Some(true) {
                let reason = if check.name == "zone" {
                    format!("contradicts its zone: {}", check.says)
                } else {
                    format!("{}: {}", check.title.to_lowercase(), check.says)
                };
                unit.refuse(reason, false);
            }
            unit.checks.push(check);
        }
    }
}

fn outcome(name: &str, title: &str, holds: Result<bool, String>, words: &str) -> CheckResult {
    match holds {
        Ok(true) => CheckResult { name: name.into(), title: title.into(), holds: Some(true), says: words.to_string() },
        Ok(false) => CheckResult { name: name.into(), title: title.into(), holds: Some(false), says: format!("not satisfied: {words}") },
        Err(reason) => CheckResult { name: name.into(), title: title.into(), holds: None, says: reason },
    }
}

/// Results of the records back to the sections: faults, and the protocol's own checks.
pub fn take_over(plan: &Plan, units: &mut [Unit], values: &[SectionValues], notes: &mut Vec<String>) -> Result<(), Problems> {
    let mut stop = Problems::default();
    for (unit, values) in units.iter_mut().zip(values) {
        for (check, rule) in values.checks.iter().zip(&plan.checks) {
            if check.holds == Some(false) {
                match rule.otherwise {
                    OnFault::NotUsed => unit.refuse(format!("{}: {}", check.title.to_lowercase(), check.says), false),
                    OnFault::Note => notes.push(format!("section {}: {}: {}", unit.name, check.title.to_lowercase(), check.says)),
                    OnFault::Stop => stop.push(
                        Problem::error("section-check", format!("section {}: {}: {}", unit.name, check.title.to_lowercase(), check.says))
                            .at(&rule.span),
                    ),
                }
            }
        }
        unit.covered = unit.extent.or(values.extent);
        unit.checks.extend(values.checks.iter().cloned());
        if let Some(fault) = &values.fault {
            unit.refuse(fault.clone(), true);
        }
    }
    notes.extend(unchecked(units));
    notes.extend(super::pairs::margin_note(values));
    if stop.any_error() { Err(stop) } else { Ok(()) }
}

/// One note for each requirement that could not be checked on sections that are used all the same.
fn unchecked(units: &[Unit]) -> Vec<String> {
    let mut found: Vec<(&str, &str, Vec<&str>)> = Vec::new();
    for unit in units.iter().filter(|unit| unit.fault.is_none()) {
        for check in unit.checks.iter().filter(|check| check.holds.is_none()) {
            match found.iter_mut().find(|(title, says, _)| *title == check.title && *says == check.says) {
                Some((_, _, names)) => names.push(&unit.name),
                None => found.push((&check.title, &check.says, vec![&unit.name])),
            }
        }
    }
    let sentence = |(title, says, names): (&str, &str, Vec<&str>)| {
        let of = if names.len() == units.len() { "all sections".to_string() } else { format!("section {}", names.join(", ")) };
        format!("{title}: {says} ({of})")
    };
    found.into_iter().map(sentence).collect()
}

pub fn results(plan: &Plan, units: Vec<Unit>) -> Vec<SectionResult> {
    let axis = &plan.axis.unit;
    units
        .into_iter()
        .map(|unit| {
            let (start, end) = unit.covered.or(unit.extent).unwrap_or((0.0, 0.0));
            SectionResult {
                section: unit.name,
                zone: unit.zone,
                used: unit.fault.is_none(),
                reason: unit.fault,
                length: axis.from_si(end - start),
                start: axis.from_si(start),
                end: axis.from_si(end),
                axis_unit: axis.text.clone(),
                columns: plan.columns.iter().zip(&unit.columns).map(|(datum, value)| item(datum, value.as_ref().ok())).collect(),
                checks: unit.checks,
            }
        })
        .collect()
}
