//! The validity domain: the range of each section column over the sections used.

use super::sections::Unit;
use crate::check::plan::{DatumKind, Plan, Scalar};
use crate::result::DomainRange;

pub fn domain(plan: &Plan, units: &[Unit]) -> Vec<DomainRange> {
    let mut scopes: Vec<(String, Option<&str>)> = vec![("all".into(), None)];
    scopes.extend(plan.zones.iter().map(|zone| (format!("zone {}", zone.name), Some(zone.name.as_str()))));
    let mut found = Vec::new();
    for (index, datum) in plan.columns.iter().enumerate() {
        let DatumKind::Number(unit) = &datum.kind else { continue };
        for (scope, zone) in &scopes {
            let values: Vec<f64> = units
                .iter()
                .filter(|section| section.fault.is_none() && zone.is_none_or(|zone| section.zone.as_deref() == Some(zone)))
                .filter_map(
                    |section| if let Ok(Scalar::Number(value)) = &section.columns[index] { Some(unit.from_si(*value)) } else { None },
                )
                .collect();
            let (low, high) =
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)));
            if !values.is_empty() {
                found.push(DomainRange {
                    name: datum.title.clone(),
                    unit: unit.text.clone(),
                    scope: scope.clone(),
                    low,
                    high,
                    count: values.len(),
                });
            }
        }
    }
    found
}
