//! Factors of limits that apply because of vehicle data, each with its reason.

use crate::result::{Datum, LimitFactor};
use crate::run::{
    prelude::*,
    sections::{Known, Vehicle, vehicle_item},
};

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
        let mut data = Vec::new();
        reasons(plan, vehicle, condition, true, &mut data);
        (on && !data.is_empty())
            .then_some(LimitFactor { by, because: Reason::VehicleData { data } })
    };
    limit.factors.iter().filter_map(of).collect()
}

/// The vehicle data of the parts of a condition that decide its result.
fn reasons(plan: &Plan, vehicle: &Vehicle, condition: &Expr, wanted: bool, found: &mut Vec<Datum>) {
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
                let unit = item.unit.filter(|unit| unit != "-");
                let datum = Datum { name: item.name, value: item.value, unit };
                if !found.contains(&datum) {
                    found.push(datum);
                }
            }
        }
    }
}
