//! Vehicle data under the names of the protocol, values of names in expressions during a run, and the
//! nodes of the graph that a section needs by them.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::unit::Unit;
use crate::check::{
    evaluate::{evaluate, words},
    values::Values,
};
use crate::data::campaign::VehicleState;
use crate::result::DataItem;
use crate::run::prelude::*;
use crate::units::{self, Dimension, number::Refused};
use crate::yaml::Value;

/// Values of one vehicle, one for each [`Plan::vehicle`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Vehicle {
    /// Which one it is, where there are several: the campaign, its state.
    pub of: Option<String>,
    /// An error states why a datum that may be absent has no value.
    pub data: Vec<Result<Scalar, Reason>>,
    /// For each datum, whether it is a number without a unit in the vehicle file.
    pub assumed: Vec<bool>,
}

/// The vehicles of a run, to which `Unit::vehicle` refers; at least one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Facts {
    pub vehicles: Vec<Vehicle>,
    /// Whether campaigns tell vehicles apart, and not only states.
    pub by_campaign: bool,
}

impl Facts {
    /// Reads every vehicle datum that the protocol declares. A missing or ill-formed one is a
    /// problem.
    pub fn read(plan: &Plan, campaigns: Campaigns<'_>, problems: &mut Problems) -> Self {
        let mut vehicles = Vec::new();
        for (number, campaign) in campaigns.iter().enumerate() {
            for vehicle in &campaign.vehicles {
                let read = |datum| {
                    vehicle_datum(datum, vehicle, problems)
                        .unwrap_or((Ok(Scalar::Number(0.0)), false))
                };
                let (data, assumed) = plan.vehicle.iter().map(read).unzip();
                vehicles.push(Vehicle {
                    of: campaigns.vehicle_name(number, vehicle),
                    data,
                    assumed,
                });
            }
        }
        Self { vehicles, by_campaign: campaigns.pooled() }
    }

    pub fn of(&self, unit: &Unit) -> &Vehicle {
        &self.vehicles[unit.vehicle]
    }

    /// The vehicle data as printed in a report.
    pub fn items(&self, plan: &Plan) -> Vec<DataItem> {
        self.vehicles.iter().flat_map(|vehicle| vehicle.items(plan)).collect()
    }
}

impl Unit {
    /// The values of names in the section.
    pub fn known<'a>(&'a self, facts: &'a Facts) -> Known<'a> {
        Known {
            columns: Some(&self.columns),
            extent: self.extent,
            ..Known::vehicle(facts.of(self))
        }
    }

    /// Puts in the data that the protocol computes.
    pub fn compute(&mut self, plan: &Plan, facts: &Facts) {
        let known = Known { extent: self.extent, ..Known::vehicle(facts.of(self)) };
        compute(plan, &mut self.columns, &known);
    }
}

impl Vehicle {
    /// The values as a report prints them.
    fn items(&self, plan: &Plan) -> Vec<DataItem> {
        let data = plan.vehicle.iter().zip(&self.data).zip(&self.assumed);
        data.map(|((datum, value), assumed)| DataItem {
            unit_assumed: *assumed && is_dimensioned(&datum.kind),
            of: self.of.clone(),
            ..vehicle_item(datum, value)
        })
        .collect()
    }

    /// A reason with the vehicle that it is of, where there are several.
    pub fn told(&self, reason: Reason) -> Reason {
        match &self.of {
            Some(of) => reason.about(Subject::Vehicle, of),
            None => reason,
        }
    }
}

/// Whether the size of such a number depends on its unit.
pub fn is_dimensioned(kind: &DatumKind) -> bool {
    matches!(kind, DatumKind::Number(unit) if unit.dimension != Dimension::ONE)
}

/// A value as printed in a report, in the unit declared in the protocol.
pub fn item(datum: &Datum, value: Option<&Scalar>) -> DataItem {
    let unit = if let DatumKind::Number(unit) = &datum.kind { Some(unit) } else { None };
    let value = match value {
        Some(Scalar::Number(value)) => trimmed(unit.map_or(*value, |unit| unit.from_si(*value))),
        Some(Scalar::Word(word)) => word.clone(),
        Some(Scalar::Flag(flag)) => flag.to_string(),
        None => String::new(),
    };
    DataItem {
        name: datum.title.clone(),
        value,
        unit: unit.map(|unit| unit.text.clone()),
        used: true,
        ..DataItem::default()
    }
}

/// The reason why there is no value, of a datum that may be absent.
pub fn told(datum: &Datum, absent: Reason) -> Reason {
    match datum.optional {
        Some(optional) => optional.told(absent),
        None => absent,
    }
}

/// The reason why a datum of the vehicle that may be absent has no value.
pub fn absent(datum: &Datum) -> Reason {
    told(datum, Reason::VehicleDataNotStated { key: datum.key.clone() })
}

/// Printed in place of a value that the vehicle file does not state.
pub const NOT_STATED: &str = "not stated";

/// As [`item`], for vehicle data; a value that is not stated is marked so.
pub fn vehicle_item(datum: &Datum, value: &Result<Scalar, Reason>) -> DataItem {
    match value {
        Ok(value) => item(datum, Some(value)),
        Err(_) => DataItem { value: NOT_STATED.into(), unit: None, ..item(datum, None) },
    }
}

/// A number without rounding errors of unit conversion: `56.3`, not `56.300000000000004`.
pub fn trimmed(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn vehicle_datum(
    datum: &Datum,
    vehicle: &VehicleState,
    problems: &mut Problems,
) -> Option<(Result<Scalar, Reason>, bool)> {
    let Some(node) = vehicle.data.lookup(&datum.key) else {
        if let Some(default) = &datum.default {
            return Some((Ok(default.clone()), false));
        }
        if datum.optional.is_some() {
            return Some((Err(absent(datum)), false));
        }
        let known: Vec<&str> =
            vehicle.data.entries().iter().map(|(key, _)| key.text.as_str()).collect();
        problems.push(
            Problem::error(
                "missing-vehicle-data",
                format!("the vehicle file has no `{}` ({})", datum.key, datum.title),
            )
            .at(&vehicle.data.span.part(0..0))
            .also(&datum.span, "the protocol needs it")
            .suggest(&datum.key, known),
        );
        return None;
    };
    if node.value == Value::Null {
        let problem =
            Problem::error("vehicle-data", format!("`{}` has no value", datum.key)).at(&node.span);
        problems.push(problem.also(&datum.span, "declared here").help(format!(
            "{}: write its value{}",
            datum.title,
            with_unit(&datum.kind)
        )));
        return None;
    }
    let text = node.scalar_text().unwrap_or("").trim();
    let read = match &datum.kind {
        DatumKind::Number(unit) => {
            units::number::read(text, unit).map(|read| (Scalar::Number(read.si), !read.unit_stated))
        }
        kind => scalar(kind, text)
            .map(|value| (value, false))
            .map_err(|says| Refused { says, help: None }),
    };
    let refused = match read {
        Ok((value, assumed)) => match out_of_range(datum, &value, assumed) {
            None => return Some((Ok(value), assumed)),
            Some(refused) => refused,
        },
        Err(refused) => refused,
    };
    let problem =
        Problem::error("vehicle-data", format!("`{}`: {}", datum.key, refused.says)).at(&node.span);
    let problem = problem
        .also(datum.range.as_ref().map_or(&datum.span, |range| &range.span), "declared here");
    problems.push(problem.help_if(refused.help));
    None
}

/// ` with its unit, such as kN`, or the possible words.
fn with_unit(kind: &DatumKind) -> String {
    match kind {
        DatumKind::Number(unit) if unit.text != "-" => format!(" with its unit, such as {unit}"),
        DatumKind::Words(words) => format!(", one of {}", words.join(", ")),
        DatumKind::Flag => ", true or false".into(),
        DatumKind::Number(_) | DatumKind::AnyWord | DatumKind::Campaign => String::new(),
    }
}

/// Why a number is not allowed. If its unit was assumed, the help names a unit in which the number
/// would be allowed.
fn out_of_range(datum: &Datum, value: &Scalar, assumed: bool) -> Option<Refused> {
    let (Some(range), Scalar::Number(si), DatumKind::Number(unit)) =
        (&datum.range, value, &datum.kind)
    else {
        return None;
    };
    if (range.low..=range.high).contains(si) {
        return None;
    }
    let number = unit.from_si(*si);
    let shown = trimmed(number);
    let says =
        format!("{shown}{} is outside the range of the protocol, {}", unit.suffix(), range.words);
    let other = if assumed {
        units::number::units_within(number, unit, (range.low, range.high))
    } else {
        Vec::new()
    };
    let help = match other.first() {
        Some(other) => format!(
            "a number without a unit is read in {unit}; write `{shown} {other}` if that is meant"
        ),
        None => format!("{}: give its value with the unit", datum.title),
    };
    Some(Refused { says, help: Some(help) })
}

/// Converts a text to a value of the declared kind; numbers are in the declared unit.
pub fn scalar(kind: &DatumKind, text: &str) -> Result<Scalar, String> {
    match kind {
        DatumKind::Number(unit) => match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Scalar::Number(unit.to_si(number))),
            _ if text.contains(',') => {
                Err(format!("`{text}` has a decimal comma; numbers are written with a point"))
            }
            _ => Err(format!("`{text}` is not a number (in {unit})")),
        },
        DatumKind::AnyWord | DatumKind::Campaign => Ok(Scalar::Word(text.to_string())),
        DatumKind::Flag => match text {
            "true" => Ok(Scalar::Flag(true)),
            "false" => Ok(Scalar::Flag(false)),
            _ => Err(format!("`{text}` is neither true nor false")),
        },
        DatumKind::Words(words) => {
            if words.iter().any(|word| word == text) {
                return Ok(Scalar::Word(text.to_string()));
            }
            // A zone written as 1.0 is zone 1.
            let number = text
                .parse::<f64>()
                .ok()
                .and_then(|number| words.iter().find(|word| word.parse() == Ok(number)));
            match (number, crate::problem::nearest(text, words.iter().map(String::as_str))) {
                (Some(word), _) => Ok(Scalar::Word(word.clone())),
                (None, Some(near)) => Err(format!(
                    "`{text}` is not one of {}; did you mean `{near}`?",
                    words.join(", ")
                )),
                (None, None) => Err(format!("`{text}` is not one of {}", words.join(", "))),
            }
        }
    }
}

/// Values of the names in one section. Where a value is not known, the reason is given.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    pub vehicle: &'a Vehicle,
    pub columns: Option<&'a [Result<Scalar, Reason>]>,
    pub extent: Option<(f64, f64)>,
    pub inputs: &'a [Result<f64, Reason>],
    pub sides: Option<(f64, f64)>,
    /// That a limit may refer to.
    pub limits: Option<&'a (dyn Limits + Sync)>,
    /// See [`Values::rounding`].
    pub rounding: f64,
}

/// Puts in the section data that the protocol computes from others. Where one cannot be computed,
/// it has the reason.
pub fn compute(plan: &Plan, columns: &mut [Result<Scalar, Reason>], known: &Known<'_>) {
    for datum in &plan.sections.computed {
        let known = Known { columns: Some(columns), ..*known };
        columns[datum.column] = evaluate(&datum.of.expr, &known);
    }
}

/// Limits that other limits refer to.
pub trait Limits: std::fmt::Debug {
    /// The limit of this name, SI.
    ///
    /// # Errors
    /// There is none, or it has no value.
    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason>;
}

impl<'a> Known<'a> {
    pub fn vehicle(vehicle: &'a Vehicle) -> Self {
        Self {
            vehicle,
            columns: None,
            extent: None,
            inputs: &[],
            sides: None,
            limits: None,
            rounding: 0.0,
        }
    }
}

impl Values for Known<'_> {
    fn vehicle(&self, index: usize) -> Result<Scalar, Reason> {
        self.vehicle.data[index].clone()
    }

    fn column(&self, index: usize) -> Result<Scalar, Reason> {
        match self.columns {
            Some(columns) => columns[index].clone(),
            None => Err(Reason::DiffersBetweenSections),
        }
    }

    fn extent(&self) -> Result<(f64, f64), Reason> {
        self.extent.ok_or(Reason::NoSectionHere)
    }

    fn input(&self, index: usize) -> Result<f64, Reason> {
        self.inputs.get(index).cloned().unwrap_or(Err(Reason::NoSignalHere))
    }

    fn sides(&self) -> Result<(f64, f64), Reason> {
        self.sides.ok_or(Reason::NoPairHere)
    }

    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason> {
        let unknown = || Reason::LimitUnknown { estimate: name.to_string() };
        self.limits.ok_or_else(unknown)?.limit_of(name)
    }

    fn rounding(&self) -> f64 {
        self.rounding
    }
}

/// All nodes that the requested ones need in one section; of the cases of a signal, only the one
/// that applies.
pub fn needed(
    graph: &Graph,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
) -> Result<BTreeSet<NodeId>, Reason> {
    let mut needed = BTreeSet::new();
    let mut open: Vec<NodeId> = wanted.iter().copied().collect();
    while let Some(id) = open.pop() {
        if !needed.insert(id) {
            continue;
        }
        let node = &graph.nodes[id];
        match &node.operation {
            Operation::Select(conditions) => {
                open.push(node.inputs[chosen(conditions, &node.inputs, known)?])
            }
            _ => open.extend(&node.inputs),
        }
    }
    Ok(needed)
}

/// The input of a `Select` that applies in this section.
pub fn chosen(conditions: &[Expr], inputs: &[NodeId], known: &Known<'_>) -> Result<usize, Reason> {
    for (index, condition) in conditions.iter().enumerate() {
        if flag(condition, known)? {
            return Ok(index);
        }
    }
    if inputs.len() > conditions.len() {
        return Ok(inputs.len() - 1);
    }
    Err(Reason::NoCaseOfSignal { expression: conditions.first().map_or(String::new(), words) })
}
