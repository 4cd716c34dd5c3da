//! Findings about the vehicle data: assumed units, and limits with factors that depend on these
//! data; what is not assessed.

use crate::result::{DataItem, Datum, LimitFactor, QuantityResult, StatisticResult};
use crate::run::{
    estimate::{Used, absent},
    prelude::*,
    sections::{Facts, Vehicle, is_dimensioned, vehicle_item},
};

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

/// The quantities that are not assessed, or only in part, for want of something optional.
pub fn not_assessed(quantities: &[QuantityResult], used: &Used<'_>) -> Vec<Remark> {
    let of_quantity = |(index, quantity): (usize, &QuantityResult)| {
        let optional = |reason: &&Reason| reason.is_of_optional();
        let of_limit = |one: &StatisticResult| {
            let reason = Box::new(one.reason.clone().filter(Reason::is_of_optional)?);
            Some(Reason::OfEstimate { title: one.title.clone(), scope: None, reason })
        };
        let mut reasons: Vec<Reason> = quantity.statistics.iter().filter_map(of_limit).collect();
        if reasons.is_empty() {
            reasons.extend(quantity.reason.iter().filter(optional).cloned());
            let of_some = || absent(index, used).filter(|_| !quantity.values.is_empty());
            reasons.extend(of_some());
        }
        reasons.dedup();
        let in_part =
            quantity.holds.is_some() || quantity.statistics.iter().any(|one| one.holds.is_some());
        let remark =
            |reason| Remark::NotAssessed { quantity: quantity.id.clone(), in_part, reason };
        reasons.into_iter().map(remark).collect::<Vec<_>>()
    };
    quantities.iter().enumerate().flat_map(of_quantity).collect()
}

/// One finding for all numbers without a unit whose size depends on one.
fn assumed(plan: &Plan, vehicle: &Vehicle) -> Option<Finding> {
    let data: Vec<Datum> = plan
        .vehicle
        .iter()
        .zip(vehicle.data.iter().zip(&vehicle.assumed))
        .filter(|(datum, (_, assumed))| **assumed && is_dimensioned(&datum.kind))
        .map(|(datum, (value, _))| {
            let DataItem { value, unit, .. } = vehicle_item(datum, value);
            Datum { name: datum.key.clone(), value, unit }
        })
        .collect();
    (!data.is_empty()).then(|| {
        let vehicle = vehicle.of.clone();
        Finding::note(UNIT_ASSUMED, FindingData::UnitsAssumed { vehicle, data })
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
        let data = FindingData::FactorOfLimits {
            quantities: of.into_iter().map(Into::into).collect(),
            by: factor.by,
            because: factor.because.clone(),
        };
        Finding::note(LIMIT_FACTOR, Occurrence { value: Some(factor.by), ..data.into() })
    };
    found.into_iter().map(finding).collect()
}
