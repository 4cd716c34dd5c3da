//! Factors of limits that apply because of vehicle data, each with its reason.

use crate::check::evaluate::{flag, number};
use crate::check::plan::{Expr, Kind, Limit, Operator, Plan};
use crate::result::LimitFactor;
use crate::run::sections::{Known, Vehicle, vehicle_item};

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
            condition.visit(&mut |part| {
                if let Kind::Vehicle(index) = part.kind {
                    read.push(index);
                }
            });
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
