//! Computes a verdict again from the values recorded in a result, without the records, to check
//! that it follows from them.

use super::judge::{Judged, Told, judge};
use crate::check::evaluate::number;
use crate::check::plan::{Evaluation, Plan, Records, Scalar};
use crate::graph::{Graph, NodeId};
use crate::result::{Consequence, DomainResult, Finding};
use crate::run::describe::domain;
use crate::run::sections::{
    Facts, Known, NOT_STATED, Unit, Vehicle, absent, needed, requirements, scalar,
};
use crate::run::values::{Row, SectionValues};
use crate::source::{Source, Spanned};

/// The part of a result that rules use. All texts are as in the result, in the units that the
/// protocol declares.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// Of each vehicle whose it is, where there are several, and one value for each
    /// [`Plan::vehicle`].
    pub vehicles: Vec<(Option<String>, Vec<String>)>,
    pub sections: Vec<RecordedSection>,
    /// One for each [`Plan::quantities`].
    pub values: Vec<Vec<RecordedValue>>,
    pub findings: Vec<Finding>,
    pub application: Vec<DomainResult>,
}

#[derive(Clone, Debug)]
pub struct RecordedSection {
    pub name: String,
    /// Which of several campaigns and vehicles.
    pub campaign: Option<String>,
    pub vehicle: Option<String>,
    /// The first section of its site; its own name where the result states none.
    pub site: String,
    pub zone: Option<String>,
    /// Why it is not used.
    pub fault: Option<String>,
    /// Start and end in the unit of the axis.
    pub start: f64,
    pub end: f64,
    /// One for each [`Plan::columns`].
    pub columns: Vec<String>,
}

#[derive(Clone, Debug)]
pub struct RecordedValue {
    pub section: String,
    pub signal: String,
    pub record: Option<String>,
    /// Which of several values, in words.
    pub taken: Option<String>,
    /// In the unit of the quantity, as are all values.
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    pub difference: f64,
    pub samples: usize,
}

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
pub fn replay(plan: &Plan, graph: &Graph, recorded: &Recorded) -> Result<Replayed, String> {
    let facts = facts(plan, recorded)?;
    let mut units = units(plan, recorded)?;
    let mut values = vec![SectionValues::default(); units.len()];
    let mut contradictions = Vec::new();
    for (index, quantity) in plan.quantities.iter().enumerate() {
        for values in &mut values {
            values.rows.push(Vec::new());
        }
        for value in recorded.values.get(index).into_iter().flatten() {
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
                record: value.record.as_deref().map(Into::into),
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
    contradictions.extend(refused(plan, &facts, &units));
    contradictions.extend(barred(&units, &recorded.findings));
    for unit in &mut units {
        unit.faulty = unit.fault.is_some();
    }
    let application =
        domain::compared(plan, &facts, &units, &domain::recorded(plan, &recorded.application)?);
    let told = Told { findings: &recorded.findings, barred: domain::barred(&application) };
    Ok(Replayed {
        judged: judge(plan, graph, &facts, &units, &values, &told),
        application,
        contradictions,
    })
}

/// Which of several values a recorded one is, by its words.
fn which(evaluation: &Evaluation, taken: Option<&str>) -> usize {
    let Evaluation::Values { values, .. } = evaluation else { return 0 };
    (0..values.len())
        .find(|&at| evaluation.value_in_words(at).as_deref() == taken)
        .unwrap_or_default()
}

fn facts(plan: &Plan, recorded: &Recorded) -> Result<Facts, String> {
    let vehicles = recorded
        .vehicles
        .iter()
        .map(|(of, data)| vehicle(plan, of.clone(), data))
        .collect::<Result<_, _>>()?;
    Ok(Facts {
        vehicles,
        by_campaign: recorded.sections.iter().any(|section| section.campaign.is_some()),
    })
}

fn vehicle(plan: &Plan, of: Option<String>, data: &[String]) -> Result<Vehicle, String> {
    if data.len() != plan.vehicle.len() {
        return Err(format!(
            "the protocol reads {} vehicle data, the result has {}",
            plan.vehicle.len(),
            data.len()
        ));
    }
    let read = plan.vehicle.iter().zip(data);
    let vehicle = read.map(|(datum, text)| match text.as_str() {
        NOT_STATED if datum.may_be_absent => Ok(Err(absent(datum))),
        text => {
            scalar(&datum.kind, text).map(Ok).map_err(|says| format!("`{}`: {says}", datum.key))
        }
    });
    let data: Vec<Result<Scalar, String>> = vehicle.collect::<Result<_, _>>()?;
    Ok(Vehicle { of, assumed: vec![false; data.len()], data })
}

fn units(plan: &Plan, recorded: &Recorded) -> Result<Vec<Unit>, String> {
    let axis = &plan.axis.unit;
    let nowhere = Source::new("results.json", "").whole();
    let place = |name: &str| recorded.sections.iter().position(|other| other.name == name);
    let vehicle = |of: &Option<String>| recorded.vehicles.iter().position(|(known, _)| known == of);
    let one = |section: &RecordedSection| {
        if section.columns.len() != plan.columns.len() {
            let (asked, found) = (plan.columns.len(), section.columns.len());
            return Err(format!(
                "section {}: the protocol declares {asked} columns, the result has {found}",
                section.name
            ));
        }
        let column =
            |(datum, text): (&crate::check::plan::Datum, &String)| -> Result<Scalar, String> {
                if text.is_empty() {
                    Err(format!("`{}` is empty", datum.key))
                } else {
                    scalar(&datum.kind, text)
                }
            };
        let none = || format!("section {}: the result has no data of its vehicle", section.name);
        let cell = Spanned::new(section.name.clone(), nowhere.clone());
        let site = place(&section.site).or_else(|| place(&section.name)).unwrap_or_default();
        let columns = plan.columns.iter().zip(&section.columns).map(column).collect();
        Ok(Unit {
            campaign_name: section.campaign.clone(),
            vehicle: vehicle(&section.vehicle).ok_or_else(none)?,
            zone: section.zone.clone(),
            site_name: section.site.clone(),
            extent: (!plan.sections.whole_records)
                .then(|| (axis.to_si(section.start), axis.to_si(section.end))),
            fault: section.fault.clone(),
            ..Unit::new(&cell, site, columns)
        })
    };
    recorded.sections.iter().map(one).collect()
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
        unit.fault.as_ref().map(|fault| format!("section {} is used: {fault}", unit.name))
    };
    again.iter().filter_map(says).collect()
}

/// Sections that are used although a finding excludes them.
fn barred(units: &[Unit], findings: &[Finding]) -> Vec<String> {
    let of = |finding: &Finding, unit: &Unit| {
        finding.consequence == Consequence::NotUsed
            && finding.section.as_deref() == Some(&unit.name)
    };
    let says = |unit: &Unit| {
        let finding =
            findings.iter().find(|finding| of(finding, unit)).filter(|_| unit.fault.is_none())?;
        Some(format!("section {} is used: {}", unit.name, finding.says))
    };
    units.iter().filter_map(says).collect()
}

/// The operations by which one value of a result was computed, in order of execution.
///
/// # Errors
/// The result does not agree with the protocol, in words.
pub fn operations(
    plan: &Plan,
    graph: &Graph,
    recorded: &Recorded,
    (quantity, signal): (usize, usize),
    section: &str,
) -> Result<Vec<NodeId>, String> {
    let facts = facts(plan, recorded)?;
    let units = units(plan, recorded)?;
    let unit = units
        .iter()
        .find(|unit| unit.name == section)
        .ok_or_else(|| format!("there is no section `{section}`"))?;
    let wanted = [graph.quantities[quantity].signals[signal].compare].into();
    Ok(needed(graph, &wanted, &unit.known(&facts))?.into_iter().collect())
}
