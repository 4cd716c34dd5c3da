//! Sections of the campaign: their data, and why one is not used.

use std::collections::HashMap;

use super::{
    facts::{Facts, item, scalar, told},
    unit::Unit,
};
use crate::data::{
    campaign::Run,
    qualified,
    sites::{originals, site_text, sites},
    table::{Cell, Table},
};
use crate::result::SectionResult;
use crate::run::prelude::*;
use crate::units::Unit as OfMeasure;

/// The sections of all campaigns, one campaign after the other.
pub fn units(
    plan: &Plan,
    campaigns: Campaigns<'_>,
    facts: &Facts,
    problems: &mut Problems,
) -> Vec<Unit> {
    let mut all: Vec<Unit> = Vec::new();
    // Sections of different campaigns are of one site only if the column `site` says so.
    let mut sites: Vec<(String, usize, String)> = Vec::new();
    let mut vehicles = 0;
    for (number, campaign) in campaigns.iter().enumerate() {
        let (before, called) = (all.len(), campaigns.name_of(number));
        let states = states(campaign, problems);
        for mut unit in of_campaign(plan, campaign, problems) {
            unit.campaign = number;
            unit.vehicle = vehicles + states.get(unit.cell.value.as_str()).copied().unwrap_or(0);
            unit.site += before;
            unit.original = unit.original.map(|original| original + before);
            if campaigns.pooled() {
                unit.name = qualified(called, &unit.name);
                unit.site_name = qualified(called, &unit.site_name);
                unit.campaign_name = called.map(str::to_string);
                let named =
                    campaign.sections.as_ref().and_then(|table| site_text(table, &unit.cell.value));
                if let Some(text) = named {
                    match sites.iter().find(|(known, ..)| known == text) {
                        Some((_, site, name)) => {
                            (unit.site, unit.site_name) = (*site, name.clone())
                        }
                        None => sites.push((text.to_string(), unit.site, unit.site_name.clone())),
                    }
                }
            }
            unit.compute(plan, facts);
            all.push(unit);
        }
        vehicles += campaign.vehicles.len();
    }
    all
}

/// The column of the section table that says in which state the vehicle was, where there is a
/// vehicle file for each.
pub const STATE: &str = "state";

/// For each section the number of its vehicle.
///
/// Problems: `missing-column`, `missing-state`, `unknown-state`, `no-sections`.
fn states<'a>(campaign: &'a Campaign, problems: &mut Problems) -> HashMap<&'a str, usize> {
    let names: Vec<&str> =
        campaign.vehicles.iter().filter_map(|vehicle| vehicle.state.as_deref()).collect();
    let mut found = HashMap::new();
    let Some(node) = campaign.tree.get("vehicle").filter(|_| !names.is_empty()) else {
        return found;
    };
    let Some(table) = &campaign.sections else {
        let says = "the campaign has a vehicle file for each state, and no table of sections that says which is of which state";
        problems.push(
            Problem::error("no-sections", says)
                .at(&node.span)
                .help("name it in campaign.yaml: `sections: sections.csv`"),
        );
        return found;
    };
    let Some(column) = table.column(STATE) else {
        let says = format!(
            "the table of sections has no column `{STATE}`, and there is a vehicle file for each state"
        );
        let header = table.columns[0].span.to(&table.columns[table.columns.len() - 1].span);
        let known = table.columns.iter().map(|column| column.name.as_str());
        problems.push(
            Problem::error("missing-column", says)
                .at(&header)
                .also(&node.span, "the states")
                .suggest(STATE, known),
        );
        return found;
    };
    for row in 0..table.rows.len() {
        let (Some(name), Some(cell)) = (campaign.names.get(row), table.cell(row, column)) else {
            continue;
        };
        let state = cell.value.trim();
        match names.iter().position(|known| *known == state) {
            Some(number) => drop(found.insert(name.value.as_str(), number)),
            None => {
                let problem = match state {
                    "" => Problem::error(
                        "missing-state",
                        format!("section {} has no state", name.value),
                    ),
                    other => Problem::error(
                        "unknown-state",
                        format!(
                            "section {}: there is no vehicle file for the state `{other}`",
                            name.value
                        ),
                    ),
                };
                let problem = problem
                    .at(&cell.span)
                    .also(&node.span, "the states")
                    .suggest(state, names.iter().copied());
                problems.push(problem);
            }
        }
    }
    found
}

/// Reads the sections with the columns that the protocol declares.
fn of_campaign(plan: &Plan, campaign: &Campaign, problems: &mut Problems) -> Vec<Unit> {
    if plan.sections.whole_records {
        return campaign
            .names
            .iter()
            .enumerate()
            .map(|(site, name)| whole_record(plan, campaign, name, site))
            .collect();
    }
    let Some(table) = &campaign.sections else {
        problems.push(
            Problem::error("no-sections", "the campaign has no table of sections, and the protocol evaluates sections")
                .at(&campaign.tree.span.part(0..0))
                .help(match campaign.runs().is_empty() {
                    true => "name it in campaign.yaml: `sections: sections.csv`; or use a protocol with `use whole records`",
                    false => "it has runs: use a protocol with `use found sections`, or write a table with a column `run`",
                }),
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
        range: None,
        optional: None,
        computed: false,
        span: plan.axis.span.clone(),
    };
    let (start, end) = (extent_datum("start"), extent_datum("end"));
    computed_of_runs(plan, campaign, problems);
    let mut missing = false;
    // What is stated of every run needs no column.
    let of_runs = |datum: &&Datum| {
        table.column(&datum.key).is_some()
            || !table
                .names()
                .all(|name| campaign.run_of(name).is_some_and(|run| run.fact(&datum.key).is_some()))
    };
    for datum in plan.columns.iter().filter(of_runs).chain([&start, &end]) {
        missing |= column_missing(datum, (table, "table of sections"), problems);
    }
    if missing {
        return Vec::new();
    }
    let (sites, originals) = (sites(table, problems), originals(table));
    let mut units = Vec::new();
    for row in 0..table.rows.len() {
        let file = campaign.inside(&table.columns[0].span.source.name);
        let row = Row {
            table,
            row,
            campaign: &campaign.short_name.value,
            file,
            run: campaign.run_of(&campaign.names[row]),
        };
        let columns: Vec<Result<Scalar, CellFault>> =
            plan.columns.iter().map(|datum| row.cell(datum)).collect();
        let ill_formed = columns.iter().find_map(|cell| {
            cell.as_ref().err().filter(|fault| fault.ill_formed).map(|fault| fault.reason.clone())
        });
        let columns: Vec<Result<Scalar, Reason>> =
            columns.into_iter().map(|cell| cell.map_err(|fault| fault.reason)).collect();
        let name = &campaign.names[row.row];
        let site = sites[row.row];
        let mut unit = Unit {
            zone: plan.sections.zone.and_then(|zone| match &columns[zone] {
                Ok(Scalar::Word(word)) => Some(word.clone()),
                _ => None,
            }),
            site_name: campaign.names[site].value.clone(),
            original: originals[row.row],
            span: Some(name.span.clone()),
            ..Unit::new(name, site, columns)
        };
        match (row.cell(&start), row.cell(&end)) {
            (Ok(Scalar::Number(start)), Ok(Scalar::Number(end))) if start < end => {
                unit.extent = Some((start, end))
            }
            (Ok(_), Ok(_)) => {
                let (file, row) = row.place();
                unit.refuse(Reason::StartNotBeforeEnd { file, row }, true);
            }
            (Err(fault), _) | (_, Err(fault)) => unit.refuse(fault.reason, true),
        }
        if let Some(reason) = ill_formed {
            unit.refuse(reason, true);
        }
        units.push(unit);
    }
    units
}

fn whole_record(plan: &Plan, campaign: &Campaign, name: &Cell, site: usize) -> Unit {
    let called = |datum: &Datum| {
        (datum.kind == DatumKind::Campaign).then(|| Scalar::Word(campaign.short_name.value.clone()))
    };
    let columns = plan
        .columns
        .iter()
        .map(|datum| {
            called(datum).or_else(|| datum.default.clone()).ok_or_else(|| {
                told(datum, Reason::UnknownOfWholeRecord { column: datum.name.clone() })
            })
        })
        .collect();
    Unit::new(name, site, columns)
}

/// What the campaign says of a run, as a datum of every section in it.
///
/// # Errors
/// It says nothing, or something that is no such datum.
pub fn of_run(datum: &Datum, run: &Run, campaign: &str) -> Result<Scalar, Reason> {
    if datum.kind == DatumKind::Campaign {
        return Ok(Scalar::Word(campaign.to_string()));
    }
    let (column, run_name) = (datum.key.clone(), run.name.value.clone());
    let Some(fact) = run.fact(&datum.key) else {
        let absent = || told(datum, Reason::NotStatedOfRun { column, run: run_name });
        return datum.default.clone().ok_or_else(absent);
    };
    let kind = match (&datum.kind, &fact.unit) {
        (DatumKind::Number(expected), Some(unit)) => match OfMeasure::parse(unit) {
            Ok(unit) if unit.dimension == expected.dimension => DatumKind::Number(unit),
            _ => {
                return Err(Reason::WrongUnitOfRun { column, run: run_name, unit: unit.clone() });
            }
        },
        (kind, _) => kind.clone(),
    };
    scalar(&kind, &fact.value.value).map_err(|says| Reason::WrongDataOfRun {
        column,
        run: run_name,
        says,
    })
}

fn stated_twice(datum: &Datum, called: &str) -> Problem {
    let says = format!("the protocol computes `{}`, and the {called} states it", datum.key);
    Problem::error("computed-column", says).also(&datum.span, "computed here")
}

/// Reports what is stated of runs although the protocol computes it.
///
/// Problems: `computed-column`.
pub fn computed_of_runs(plan: &Plan, campaign: &Campaign, problems: &mut Problems) {
    for datum in plan.columns.iter().filter(|datum| datum.computed) {
        for fact in campaign.runs().iter().filter_map(|run| run.fact(&datum.key)) {
            problems.push(
                stated_twice(datum, "campaign")
                    .at(&fact.value.span)
                    .help("remove the line, or rename it"),
            );
        }
    }
}

/// Reports a declared column that is missing or has a unit of another dimension.
pub fn column_missing(
    datum: &Datum,
    (table, called): (&Table, &str),
    problems: &mut Problems,
) -> bool {
    if datum.kind == DatumKind::Campaign {
        return false;
    }
    let Some(index) = table.column(&datum.key) else {
        if datum.computed || datum.default.is_some() || datum.optional.is_some() {
            return false;
        }
        let known: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        problems.push(
            Problem::error("missing-column", format!("the {called} has no column `{}`", datum.key))
                .at(&table.columns[0].span.to(&table.columns[table.columns.len() - 1].span))
                .also(&datum.span, "the protocol needs it")
                .suggest(&datum.key, known),
        );
        return true;
    };
    let column = &table.columns[index];
    if datum.computed {
        problems.push(
            stated_twice(datum, called).at(&column.span).help("remove the column, or rename it"),
        );
        return true;
    }
    let DatumKind::Number(unit) = &datum.kind else { return false };
    match column.unit(Some(unit.dimension)) {
        Ok(_) => false,
        Err(problem) => {
            problems.push(problem.also(&datum.span, format!("declared in {unit}")));
            true
        }
    }
}

/// A row of a table with section data.
pub struct Row<'a> {
    pub table: &'a Table,
    pub row: usize,
    /// What the campaign is called.
    pub campaign: &'a str,
    /// Path of the table inside the campaign.
    pub file: &'a str,
    /// The run that the section is cut from.
    pub run: Option<&'a Run>,
}

/// Why a cell has no value. An empty cell is a fault only if a rule needs it; a cell that cannot be
/// read is always a fault.
pub struct CellFault {
    pub reason: Reason,
    pub ill_formed: bool,
}

impl Row<'_> {
    pub fn cell(&self, datum: &Datum) -> Result<Scalar, CellFault> {
        if datum.kind == DatumKind::Campaign {
            return Ok(Scalar::Word(self.campaign.to_string()));
        }
        let nothing =
            |reason: Reason| datum.default.clone().ok_or(CellFault { reason, ill_formed: false });
        let column = datum.key.clone();
        let Some(index) = self.table.column(&datum.key) else {
            if let Some(run) = self.run.filter(|run| run.fact(&datum.key).is_some()) {
                return of_run(datum, run, self.campaign)
                    .map_err(|reason| CellFault { reason, ill_formed: true });
            }
            return nothing(told(datum, Reason::NoColumn { column }));
        };
        let text = self.table.cell(self.row, index).map_or("", |cell| cell.value.trim());
        let (file, row) = self.place();
        if text.is_empty() {
            return nothing(Reason::EmptyCell { column, file, row });
        }
        // Cells are in the unit of the column header, whose dimension was checked.
        let of_column = match (&datum.kind, self.table.columns[index].unit(None)) {
            (DatumKind::Number(_), Ok(unit)) => DatumKind::Number(unit),
            (kind, _) => kind.clone(),
        };
        scalar(&of_column, text).map_err(|says| CellFault {
            reason: Reason::WrongCell { column, says, file, row },
            ill_formed: true,
        })
    }

    /// File and row.
    fn place(&self) -> (String, usize) {
        let line = self.table.cell(self.row, 0).map_or(self.row + 2, |cell| cell.span.line());
        (self.file.to_owned(), line)
    }
}

/// The sections as results have them.
pub fn results(plan: &Plan, facts: &Facts, units: &[Unit]) -> Vec<SectionResult> {
    let axis = &plan.axis.unit;
    let of = |unit: &Unit| {
        let (start, end) = unit.covered.or(unit.extent).unwrap_or((0.0, 0.0));
        SectionResult {
            site: units.get(unit.site).unwrap_or(unit).name.clone(),
            section: unit.name.clone(),
            campaign: unit.campaign_name.clone(),
            vehicle: facts.of(unit).of.clone(),
            zone: unit.zone.clone(),
            used: unit.fault.is_none(),
            reason: unit.fault.clone(),
            length: axis.from_si(end - start),
            start: axis.from_si(start),
            end: axis.from_si(end),
            axis_unit: axis.text.clone(),
            columns: plan
                .columns
                .iter()
                .zip(&unit.columns)
                .map(|(datum, value)| item(datum, value.as_ref().ok()))
                .collect(),
            checks: unit.checks.clone(),
        }
    };
    units.iter().map(of).collect()
}
