//! Findings about the vehicle data: assumed units, and limits with factors that depend on these
//! data.

use super::facts::{Facts, Known, Vehicle, is_dimensioned, vehicle_item};
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Expr, Kind, Limit, Operator, Plan};
use crate::result::{Finding, LimitFactor, QuantityResult};

/// Code of the finding about units that the vehicle file does not state.
const UNIT_ASSUMED: &str = "unit-assumed";
/// Code of the finding about limits with factors that depend on vehicle data.
const LIMIT_FACTOR: &str = "limit-factor";

/// Findings about the vehicle data; none of them changes the verdict.
pub fn findings(plan: &Plan, facts: &Facts, quantities: &[QuantityResult]) -> Vec<Finding> {
    facts
        .vehicles
        .iter()
        .filter_map(|vehicle| assumed(plan, vehicle))
        .chain(multiplied(quantities))
        .collect()
}

/// One finding for all numbers without a unit whose size depends on one.
fn assumed(plan: &Plan, vehicle: &Vehicle) -> Option<Finding> {
    let bare: Vec<String> = plan
        .vehicle
        .iter()
        .zip(vehicle.data.iter().zip(&vehicle.assumed))
        .filter(|(datum, (_, assumed))| **assumed && is_dimensioned(&datum.kind))
        .map(|(datum, (value, _))| {
            let item = vehicle_item(datum, value);
            format!(
                "{} = {}{}",
                datum.key,
                item.value,
                item.unit.map_or(String::new(), |unit| format!(" {unit}"))
            )
        })
        .collect();
    (!bare.is_empty()).then(|| {
        let of = vehicle.of.as_ref().map_or_else(String::new, |of| format!(" of {of}"));
        let says = format!(
            "the vehicle file{of} states no unit; read in the unit of the protocol: {}",
            bare.join(", ")
        );
        Finding::note(UNIT_ASSUMED, says)
    })
}

/// One finding for each factor and its reason, with the quantities whose limits it multiplies.
fn multiplied(quantities: &[QuantityResult]) -> Vec<Finding> {
    let mut found: Vec<(&LimitFactor, Vec<&str>)> = Vec::new();
    for quantity in quantities {
        for factor in quantity.statistics.iter().flat_map(|statistic| &statistic.factors) {
            match found.iter_mut().find(|(known, _)| *known == factor) {
                Some((_, of)) if of.last() == Some(&quantity.id.as_str()) => {}
                Some((_, of)) => of.push(&quantity.id),
                None => found.push((factor, vec![&quantity.id])),
            }
        }
    }
    let finding = |(factor, of): (&LimitFactor, Vec<&str>)| {
        let says = format!(
            "the limits of {} are {}, because {}",
            of.join(", "),
            times(factor.by),
            factor.because
        );
        Finding { value: Some(factor.by), ..Finding::note(LIMIT_FACTOR, says) }
    };
    found.into_iter().map(finding).collect()
}

fn times(by: f64) -> String {
    if by == 2.0 { "doubled".into() } else { format!("multiplied by {by}") }
}

/// The factors of a limit that apply because of vehicle data alone, each with its reason.
pub fn factors(plan: &Plan, vehicles: &[&Vehicle], limit: &Limit) -> Vec<LimitFactor> {
    let mut found: Vec<LimitFactor> = Vec::new();
    for vehicle in vehicles {
        for factor in of_vehicle(plan, vehicle, limit) {
            if !found.contains(&factor) {
                found.push(factor);
            }
        }
    }
    found
}

fn of_vehicle(plan: &Plan, vehicle: &Vehicle, limit: &Limit) -> Vec<LimitFactor> {
    let known = Known::vehicle(vehicle);
    let of = |(factor, condition): &(Expr, Expr)| {
        let on = flag(condition, &known).ok()?;
        let by = number(factor, &known).ok()?;
        let mut because = Vec::new();
        reasons(plan, vehicle, condition, true, &mut because);
        (on && !because.is_empty()).then(|| LimitFactor { by, because: because.join(" and ") })
    };
    limit.factors.iter().filter_map(of).collect()
}

/// The parts of a condition that decide its result, in words: `vehicle category is freight`.
fn reasons(
    plan: &Plan,
    vehicle: &Vehicle,
    condition: &Expr,
    wanted: bool,
    found: &mut Vec<String>,
) {
    match &condition.kind {
        Kind::Not(inner) => reasons(plan, vehicle, inner, !wanted, found),
        Kind::Binary(Operator::And | Operator::Or, a, b) => {
            for side in [a, b] {
                if flag(side, &Known::vehicle(vehicle)) == Ok(wanted) {
                    reasons(plan, vehicle, side, wanted, found);
                }
            }
        }
        _ => {
            let mut read = Vec::new();
            vehicle_data(condition, &mut read);
            for index in read {
                let item = vehicle_item(&plan.vehicle[index], &vehicle.data[index]);
                let unit = item
                    .unit
                    .filter(|unit| unit != "-")
                    .map_or(String::new(), |unit| format!(" {unit}"));
                let says = format!("{} is {}{unit}", item.name.to_lowercase(), item.value);
                if !found.contains(&says) {
                    found.push(says);
                }
            }
        }
    }
}

/// Vehicle data that an expression uses, in the order of their occurrence.
fn vehicle_data(expr: &Expr, found: &mut Vec<usize>) {
    expr.visit(&mut |part| {
        if let Kind::Vehicle(index) = part.kind {
            found.push(index);
        }
    });
}
