//! Computes a verdict again from the values recorded in a result, without the records, to check
//! that it follows from them.

use indexmap::IndexSet;

use super::judge::{Judged, Told, judge};
use crate::check::evaluate::number;
use crate::check::plan::{Datum, Evaluation, Optional, Plan, Records, Scalar};
use crate::graph::{Graph, NodeId};
use crate::result::{
    Certification, Consequence, DataItem, DomainResult, Finding, Reason, SectionResult,
};
use crate::run::describe::domain;
use crate::run::sections::{
    Facts, Known, NOT_STATED, Unit, Vehicle, absent, needed, requirements, scalar,
};
use crate::run::values::{Row, SectionValues};
use crate::source::{Source, Spanned};

/// What follows from the recorded values.
#[derive(Debug)]
pub struct Replayed {
    pub judged: Judged,
    /// Wanted operation against what the sections cover.
    pub application: Vec<DomainResult>,
    /// Inconsistencies of the result, in words.
    pub contradictions: Vec<String>,
}

/// Relative tolerance, of the larger side, between a difference and its two sides. It covers the
/// rounding of unit conversions.
const ROUNDING: f64 = 1e-9;

/// Evaluates recorded values as a run evaluates those it computed.
///
/// # Errors
/// The result does not agree with the protocol, in words.
pub fn replay(plan: &Plan, results: &Certification) -> Result<Replayed, String> {
    let facts = facts(plan, results)?;
    let mut units = units(plan, &facts, results)?;
    let mut values = vec![SectionValues::default(); units.len()];
    let mut contradictions = Vec::new();
    for (index, quantity) in plan.quantities.iter().enumerate() {
        for values in &mut values {
            values.rows.push(Vec::new());
        }
        let found = results.quantities.iter().find(|found| found.id == quantity.id);
        let found = found.ok_or_else(|| format!("the result has no quantity `{}`", quantity.id))?;
        for value in &found.values {
            let place = format!("{} {} {}", quantity.id, value.section, value.signal);
            let unit = units.iter().position(|unit| unit.name == value.section);
            let unit =
                unit.ok_or_else(|| format!("{place}: there is no section `{}`", value.section))?;
            let position =
                quantity.positions.iter().position(|position| position.name == value.signal);
            let position = position
                .ok_or_else(|| format!("{place}: the quantity has no signal `{}`", value.signal))?;
            if units[unit].fault.is_some() {
                contradictions.push(format!("{place}: a value of a section that is not used"));
            }
            let si = |value: f64| quantity.unit.to_si(value);
            let row = Row {
                position,
                which: which(&quantity.evaluation, value.taken.as_deref()),
                record: value.record.clone(),
                simulated: value.simulated.map(si),
                measured: value.measured.map(si),
                value: si(value.difference),
                samples: value.samples,
            };
            if let Some(says) = difference(plan, &facts, &units[unit], index, &row) {
                contradictions.push(format!("{place}: {says}"));
            }
            let rows = &mut values[unit].rows[index];
            if rows.iter().any(|other| {
                (other.position, other.which, &other.record) == (position, row.which, &row.record)
            }) {
                contradictions.push(format!("{place}: two values"));
            }
            rows.push(row);
        }
    }
    for (index, quantity) in plan.quantities.iter().enumerate() {
        let found = results.quantities.iter().find(|found| found.id == quantity.id);
        let reason =
            found.filter(|found| found.values.is_empty()).and_then(|one| one.reason.as_ref());
        let of_rows = |reason: &&Reason| {
            reason.is_of_optional() && !matches!(reason, Reason::OfEstimate { .. })
        };
        if let Some(reason) = reason.filter(of_rows) {
            if !is_declared(plan, reason) {
                contradictions.push(format!("{}: what it lacks is not optional", quantity.id));
            }
            let absent = (index, reason.clone());
            values.iter_mut().for_each(|values| values.impossible.push(absent.clone()));
        }
    }
    contradictions.extend(refused(plan, &facts, &units));
    contradictions.extend(barred(&units, &results.findings));
    for unit in &mut units {
        unit.faulty = unit.fault.is_some();
    }
    let application =
        domain::compared(plan, &facts, &units, &domain::recorded(plan, &results.application)?);
    let told = Told { findings: &results.findings, barred: domain::barred(&application) };
    Ok(Replayed {
        judged: judge(plan, &facts, (&units, &values), told),
        application,
        contradictions,
    })
}

/// Whether the protocol says that what is absent may be.
fn is_declared(plan: &Plan, reason: &Reason) -> bool {
    let assessed = |optional| optional == Some(Optional::NotAssessed);
    let datum = |data: &[Datum], name: &String| {
        data.iter().any(|datum| datum.key == *name && assessed(datum.optional))
    };
    match reason {
        Reason::Optional { reason } => match reason.as_ref() {
            Reason::NotRecorded { channel, .. } => {
                plan.optional.iter().any(|one| one.name == *channel && assessed(Some(one.optional)))
            }
            Reason::NoColumn { column }
            | Reason::UnknownOfWholeRecord { column }
            | Reason::NotStatedOfRun { column, .. } => datum(&plan.columns, column),
            Reason::VehicleDataNotStated { key } => datum(&plan.vehicle, key),
            Reason::ParameterNotStated { parameter } => {
                plan.parameters.iter().any(|one| one.name == *parameter && !one.lacking)
            }
            _ => false,
        },
        Reason::About { reason, .. } => is_declared(plan, reason),
        Reason::Both { first, second } => is_declared(plan, first) && is_declared(plan, second),
        _ => false,
    }
}

/// Which of several values a recorded one is, by its words.
fn which(evaluation: &Evaluation, taken: Option<&str>) -> usize {
    let Evaluation::Values { values, .. } = evaluation else { return 0 };
    (0..values.len())
        .find(|&at| evaluation.value_in_words(at).as_deref() == taken)
        .unwrap_or_default()
}

/// Whose vehicle data there are, in the order of the result.
fn vehicles(results: &Certification) -> IndexSet<&Option<String>> {
    let of_sections = results.sections.iter().map(|section| &section.vehicle);
    of_sections.chain(used(results).map(|item| &item.of)).collect()
}

/// The vehicle data that the protocol reads.
fn used(results: &Certification) -> impl Iterator<Item = &DataItem> {
    results.campaign.vehicle.iter().filter(|item| item.used)
}

fn facts(plan: &Plan, results: &Certification) -> Result<Facts, String> {
    let own = |of: &Option<String>| -> Vec<&str> {
        used(results).filter(|item| item.of == *of).map(|item| item.value.as_str()).collect()
    };
    let vehicles = vehicles(results)
        .into_iter()
        .map(|of| vehicle(plan, of.clone(), &own(of)))
        .collect::<Result<_, _>>()?;
    Ok(Facts {
        vehicles,
        by_campaign: results.sections.iter().any(|section| section.campaign.is_some()),
    })
}

fn vehicle(plan: &Plan, of: Option<String>, data: &[&str]) -> Result<Vehicle, String> {
    if data.len() != plan.vehicle.len() {
        return Err(format!(
            "the protocol reads {} vehicle data, the result has {}",
            plan.vehicle.len(),
            data.len()
        ));
    }
    let read = plan.vehicle.iter().zip(data);
    let vehicle = read.map(|(datum, text)| match *text {
        NOT_STATED if datum.optional.is_some() => Ok(Err(absent(datum))),
        text => {
            scalar(&datum.kind, text).map(Ok).map_err(|says| format!("`{}`: {says}", datum.key))
        }
    });
    let data: Vec<Result<Scalar, Reason>> = vehicle.collect::<Result<_, _>>()?;
    Ok(Vehicle { of, assumed: vec![false; data.len()], data })
}

fn units(plan: &Plan, facts: &Facts, results: &Certification) -> Result<Vec<Unit>, String> {
    let axis = &plan.axis.unit;
    let nowhere = Source::new("results.json", "").whole();
    let place = |name: &str| results.sections.iter().position(|other| other.section == name);
    let vehicles = vehicles(results);
    let is_absent = |item: &DataItem| {
        let all = results.sections.iter().flat_map(|section| &section.columns);
        all.filter(|other| other.name == item.name).all(|other| other.value.is_empty())
    };
    let one = |section: &SectionResult| {
        if section.columns.len() != plan.columns.len() {
            let (asked, found) = (plan.columns.len(), section.columns.len());
            return Err(format!(
                "section {}: the protocol declares {asked} columns, the result has {found}",
                section.section
            ));
        }
        let column = |(datum, item): (&Datum, &DataItem)| -> Result<Scalar, Reason> {
            if item.value.is_empty() {
                let column = datum.key.clone();
                Err(match datum.optional {
                    Some(optional) if is_absent(item) => optional.told(Reason::NoColumn { column }),
                    _ => Reason::EmptyDatum { column },
                })
            } else {
                scalar(&datum.kind, &item.value).map_err(Reason::said)
            }
        };
        let none = || format!("section {}: the result has no data of its vehicle", section.section);
        let cell = Spanned::new(section.section.clone(), nowhere.clone());
        let site = place(&section.site).or_else(|| place(&section.section)).unwrap_or_default();
        let columns = plan.columns.iter().zip(&section.columns).map(column).collect();
        let mut unit = Unit {
            campaign_name: section.campaign.clone(),
            vehicle: vehicles.get_index_of(&section.vehicle).ok_or_else(none)?,
            zone: section.zone.clone(),
            site_name: section.site.clone(),
            extent: (!plan.sections.whole_records)
                .then(|| (axis.to_si(section.start), axis.to_si(section.end))),
            fault: (!section.used)
                .then(|| section.reason.clone().unwrap_or_else(|| Reason::said(""))),
            checks: section.checks.clone(),
            ..Unit::new(&cell, site, columns)
        };
        // Why a computed datum has no value follows from the others. A value is as recorded:
        // numbers are rounded in a result, and one at an edge may come to lie in another class.
        let recorded = unit.columns.clone();
        unit.compute(plan, facts);
        for (own, recorded) in unit.columns.iter_mut().zip(recorded) {
            if own.is_ok() || recorded.is_ok() {
                *own = recorded;
            }
        }
        Ok(unit)
    };
    results.sections.iter().map(one).collect()
}

/// Why a recorded difference does not follow from its two sides.
fn difference(plan: &Plan, facts: &Facts, unit: &Unit, index: usize, row: &Row) -> Option<String> {
    let Evaluation::Values {
        records: Records::Compared { difference, .. } | Records::Spread { difference, .. },
        ..
    } = plan.quantities[index].evaluation.as_ref()
    else {
        return None;
    };
    let (Some(s), Some(m)) = (row.simulated, row.measured) else {
        return Some("a side has no value".into());
    };
    let known = Known { sides: Some((s, m)), ..unit.known(facts) };
    let follows = number(difference, &known).ok()?;
    let far = (follows - row.value).abs();
    let scale = s.abs().max(m.abs()).max(row.value.abs());
    let unit = &plan.quantities[index].unit;
    let shown = |value: f64| format!("{}{}", unit.from_si(value), unit.suffix());
    // NaN counts as a difference.
    (far.is_nan() || far > ROUNDING * scale).then(|| {
        format!(
            "its difference is {}, {} follows from the two sides",
            shown(row.value),
            shown(follows)
        )
    })
}

/// Sections that are used although requirements on their data are not met.
fn refused(plan: &Plan, facts: &Facts, units: &[Unit]) -> Vec<String> {
    let mut again: Vec<Unit> = units.iter().filter(|unit| unit.fault.is_none()).cloned().collect();
    requirements::check_data(plan, facts, &mut again);
    let says = |unit: &Unit| {
        let fault = unit.fault.as_ref()?.text();
        Some(format!("section {} is used: {fault}", unit.name))
    };
    again.iter().filter_map(says).collect()
}

/// Sections that are used although a finding excludes them.
fn barred(units: &[Unit], findings: &[Finding]) -> Vec<String> {
    let says = |unit: &Unit| {
        let mut places = findings
            .iter()
            .flat_map(Finding::with_explained)
            .filter(|finding| finding.consequence == Consequence::NotUsed)
            .flat_map(Finding::places);
        let place = places.find(|place| place.section.as_ref() == Some(&unit.name))?;
        Some(format!("section {} is used: {}", unit.name, place.text()))
    };
    units.iter().filter(|unit| unit.fault.is_none()).filter_map(says).collect()
}

/// The operations by which one value of a result was computed, in order of execution.
///
/// # Errors
/// The result does not agree with the protocol, in words.
pub fn operations(
    plan: &Plan,
    graph: &Graph,
    results: &Certification,
    (quantity, signal): (usize, usize),
    section: &str,
) -> Result<Vec<NodeId>, String> {
    let facts = facts(plan, results)?;
    let units = units(plan, &facts, results)?;
    let unit = units
        .iter()
        .find(|unit| unit.name == section)
        .ok_or_else(|| format!("there is no section `{section}`"))?;
    let wanted = [graph.quantities[quantity].signals[signal].compare].into();
    let needed = needed(graph, &wanted, &unit.known(&facts));
    Ok(needed.map_err(|reason| reason.text())?.into_iter().collect())
}
