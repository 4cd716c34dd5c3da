//! Wanted operation: the application table of the campaign, with section data in place of sections.

use serde::{Deserialize, Serialize};

use super::{
    facts::{Facts, Known, Vehicle, compute},
    units::{Row, column_missing},
};
use crate::data::table::{Cell, Table};
use crate::run::prelude::*;

/// A point of wanted operation in one domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub name: String,
    /// SI, in the order of the coordinates.
    pub values: Vec<f64>,
    /// Words by which groups are told apart, in the order of the domain.
    pub group: Vec<String>,
}

/// For each domain of the plan, the points of the application tables. Every cell that a domain
/// needs must have a value.
pub fn points(
    plan: &Plan,
    campaigns: Campaigns<'_>,
    facts: &Facts,
    problems: &mut Problems,
) -> Vec<Vec<Point>> {
    let Some(first) = plan.domains.first() else { return Vec::new() };
    let tables: Vec<(&Campaign, &Table)> =
        campaigns.iter().filter_map(|one| Some((one, one.application.as_ref()?))).collect();
    if tables.is_empty() {
        problems.push(
            Problem::error("key-missing", format!("the campaign has no `application`, the wanted operation of domain `{}`", first.name))
                .at(&campaigns.get(0).tree.span.part(0..0))
                .also(&first.span, "the protocol needs it")
                .help("name a table in campaign.yaml: `application: application.csv`, with a column `point` and those of the domain"),
        );
        return Vec::new();
    }
    let mut missing = false;
    let read = plan.domains.iter().flat_map(|domain| columns(plan, domain));
    for index in read.collect::<std::collections::BTreeSet<_>>() {
        for (_, table) in &tables {
            missing |= column_missing(
                &plan.columns[index],
                (table, "table of wanted operation"),
                problems,
            );
        }
    }
    if missing {
        return Vec::new();
    }
    let mut of = |domain| {
        tables.iter().flat_map(|table| of_domain(plan, domain, *table, facts, problems)).collect()
    };
    plan.domains.iter().map(&mut of).collect()
}

/// Columns that a domain reads.
pub fn columns(plan: &Plan, domain: &Domain) -> Vec<usize> {
    let mut found = domain.each.clone();
    let see = |part: &Expr, found: &mut Vec<usize>| {
        if let Kind::Column(index) = part.kind {
            found.push(index);
        }
    };
    let coordinates = domain.over.iter();
    coordinates.for_each(|one| one.expr.visit(&mut |part| see(part, &mut found)));
    // And those that they are computed from.
    for datum in plan.sections.computed.iter().rev() {
        if found.contains(&datum.column) {
            datum.of.expr.visit(&mut |part| see(part, &mut found));
        }
    }
    found
}

fn of_domain(
    plan: &Plan,
    domain: &Domain,
    (campaign, table): (&Campaign, &Table),
    facts: &Facts,
    problems: &mut Problems,
) -> Vec<Point> {
    let needed = columns(plan, domain);
    let mut found = Vec::new();
    for (row, name) in table.names().enumerate() {
        let cells = Row {
            table,
            row,
            campaign: &campaign.short_name.value,
            file: campaign.inside(&table.source.name),
            run: None,
        };
        let mut refused = None;
        let mut value = |index: usize| {
            if !needed.contains(&index) {
                return Err(Reason::SectionDataUnknown);
            }
            cells.cell(&plan.columns[index]).map_err(|fault| {
                if fault.ill_formed && refused.is_none() {
                    let cell = table
                        .column(&plan.columns[index].key)
                        .and_then(|column| table.cell(row, column));
                    refused = Some(wrong(cell.unwrap_or(name), &fault.reason));
                }
                fault.reason
            })
        };
        let columns: Vec<Result<Scalar, Reason>> =
            (0..plan.columns.len()).map(&mut value).collect();
        if let Some(problem) = refused {
            problems.push(problem.also(&domain.span, "the domain"));
            continue;
        }
        match point((plan, domain), name, &columns, facts) {
            Ok(point) => found.push(point),
            Err(reason) => problems.push(wrong(name, &reason).also(&domain.span, "the domain")),
        }
    }
    found
}

fn wrong(cell: &Cell, reason: &Reason) -> Problem {
    let says = format!("wanted operation: {}", reason.text());
    Problem::error("wanted-value", says).at(&cell.span)
}

/// A point, which must be the same for every vehicle.
fn point(
    (plan, domain): (&Plan, &Domain),
    name: &Cell,
    columns: &[Result<Scalar, Reason>],
    facts: &Facts,
) -> Result<Point, Reason> {
    let mut of_vehicles =
        facts.vehicles.iter().map(|vehicle| of_vehicle((plan, domain), name, columns, vehicle));
    let first = of_vehicles.next().ok_or(Reason::NoVehicle)??;
    for other in of_vehicles {
        if other? != first {
            return Err(Reason::DependsOnVehicles { vehicles: facts.vehicles.len() });
        }
    }
    Ok(first)
}

fn of_vehicle(
    (plan, domain): (&Plan, &Domain),
    name: &Cell,
    columns: &[Result<Scalar, Reason>],
    vehicle: &Vehicle,
) -> Result<Point, Reason> {
    let mut columns = columns.to_vec();
    compute(plan, &mut columns, &Known::vehicle(vehicle));
    let known = Known { columns: Some(&columns), ..Known::vehicle(vehicle) };
    let values = domain
        .over
        .iter()
        .map(|coordinate| value(&coordinate.expr, &coordinate.name, &known))
        .collect::<Result<_, _>>()?;
    let group = domain.each.iter().map(|index| word(&columns[*index])).collect::<Result<_, _>>()?;
    Ok(Point { name: name.value.clone(), values, group })
}

/// The value of a coordinate, SI.
pub fn value(expr: &Expr, name: &str, known: &Known<'_>) -> Result<f64, Reason> {
    match number(expr, known) {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Reason::NotFiniteNumber.about(Subject::Coordinate, name)),
        Err(reason) => Err(reason.about(Subject::Coordinate, name)),
    }
}

/// A word or flag of the table.
pub fn word(value: &Result<Scalar, Reason>) -> Result<String, Reason> {
    match value.clone()? {
        Scalar::Word(word) => Ok(word),
        Scalar::Flag(flag) => Ok(flag.to_string()),
        Scalar::Number(number) => Ok(number.to_string()),
    }
}
