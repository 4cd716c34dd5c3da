//! Single sections against the limits of pools, and evaluated campaigns with less.

use super::evaluated::Evaluated;
use crate::check::plan::{EstimateKind, Plan};
use crate::result::{Reason, VehicleValue};
use crate::run::estimate::{Grouped, Part, Rows, parts};
use crate::run::limit::{Judging, applying};
use crate::run::sections::{Known, Unit, Vehicle};
use crate::run::values::SectionValues;

/// A value of a section against the limit of an estimate.
#[derive(Clone, Debug)]
pub struct SectionRatio {
    /// Index into the plan's quantities.
    pub quantity: usize,
    /// Index into the limits of the quantity; `None` of a quantity without one, of which the value
    /// itself stands here.
    pub limit: Option<usize>,
    pub section: String,
    /// The largest of |value| / limit of the section's values.
    pub ratio: f64,
}

impl Evaluated {
    /// Names of the sections, and why one is not used.
    pub fn sections(&self) -> impl Iterator<Item = (&str, Option<&Reason>)> {
        self.units.iter().map(|unit| (unit.name.as_str(), unit.fault.as_ref()))
    }

    /// The same with some sections only; the others are not used.
    #[must_use]
    pub fn with_sections(&self, keeps: &dyn Fn(&str) -> bool) -> Self {
        let mut some = self.clone();
        let units = some.units.iter_mut().filter(|unit| !keeps(&unit.name));
        units.for_each(|unit| unit.refuse(Reason::LeftOut, false));
        some
    }

    /// The same with the values of one quantity only.
    #[must_use]
    pub fn with_quantity(&self, quantity: usize) -> Self {
        let mut some = self.clone();
        for values in &mut some.values {
            let others = values.rows.iter_mut().enumerate().filter(|(at, _)| *at != quantity);
            others.for_each(|(_, rows)| rows.clear());
        }
        some
    }

    /// Each limit's ratios of single sections: what is pooled is taken against the limit of the
    /// pool.
    pub fn section_ratios(&self, plan: &Plan) -> Vec<SectionRatio> {
        let used: Vec<(&Unit, &SectionValues)> =
            self.units.iter().zip(&self.values).filter(|(unit, _)| unit.fault.is_none()).collect();
        let rows = Rows::of_all(plan, &self.facts, &used);
        let table: Vec<_> = rows.iter().map(Rows::usable).collect();
        let mut found = Vec::new();
        for (index, quantity) in plan.quantities.iter().enumerate() {
            let members = &rows[index].members;
            if quantity.limits.is_empty() {
                for member in members {
                    largest(
                        &mut found,
                        index,
                        None,
                        &member.unit.name,
                        quantity.unit.from_si(member.row.value).abs(),
                    );
                }
            }
            let judging = Judging {
                plan,
                facts: &self.facts,
                quantity,
                members,
                table: &table,
                too_few: &[],
            };
            for (at, limit) in quantity.limits.iter().enumerate() {
                // An estimate in a unit of its own is no value of a section.
                if limit
                    .estimate
                    .unit
                    .as_ref()
                    .is_some_and(|unit| unit.dimension != quantity.unit.dimension)
                {
                    continue;
                }
                let each = matches!(limit.estimate.kind, EstimateKind::Each);
                for part in
                    parts(plan, Grouped::values(quantity), &limit.scope, members, &self.facts)
                {
                    let inside = part
                        .members(&self.facts, members)
                        .map(|inside| applying(limit, &self.facts, inside));
                    let Ok(Ok(Some(inside))) = inside else { continue };
                    let of_vehicle = |vehicle: &Vehicle| {
                        judging.bound(limit, &part, &inside, &Known::vehicle(vehicle))
                    };
                    let pooled =
                        self.facts.agreed(&inside, of_vehicle, |value| VehicleValue::Si { value });
                    for member in &inside {
                        let bound = match each {
                            true => {
                                let part = Part::of_section(plan, limit, member.unit);
                                judging.bound(
                                    limit,
                                    &part,
                                    &[*member],
                                    &member.unit.known(&self.facts),
                                )
                            }
                            false => pooled.clone(),
                        };
                        if let Some(ratio) = bound
                            .ok()
                            .and_then(|bound| ratio(member.row.value, bound, limit.at_least))
                        {
                            largest(&mut found, index, Some(at), &member.unit.name, ratio);
                        }
                    }
                }
            }
        }
        found
    }
}

fn ratio(value: f64, bound: f64, at_least: bool) -> Option<f64> {
    let ratio = if at_least { bound / value } else { value.abs() / bound };
    (ratio.is_finite() && ratio >= 0.0).then_some(ratio)
}

fn largest(
    found: &mut Vec<SectionRatio>,
    quantity: usize,
    limit: Option<usize>,
    section: &str,
    ratio: f64,
) {
    // Rows of a quantity stand section by section, so its entry is among the last ones.
    let same = |one: &&mut SectionRatio| {
        one.quantity == quantity && one.limit == limit && one.section == section
    };
    match found
        .iter_mut()
        .rev()
        .take_while(|one| one.quantity == quantity && one.limit == limit)
        .find(same)
    {
        Some(one) => one.ratio = one.ratio.max(ratio),
        None => found.push(SectionRatio { quantity, limit, section: section.to_string(), ratio }),
    }
}
