//! What the values of sections are judged with: the same for every part of a campaign, and without
//! any record.

use serde::{Deserialize, Serialize};

use crate::check::plan::Plan;
use crate::problem::Problems;
use crate::result::study::Reduction;
use crate::result::{Consequence, DataItem, Finding};
use crate::run::sections::{Facts, Point, Unit};
use crate::run::values::SectionValues;
use crate::run::{Evaluated, copies, domain, keep, nothing_usable, requirements, stop_on_fault};

/// Sections that a message names before it counts them.
const NAMED: usize = 8;

/// Data read before any record.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Basis {
    pub(in crate::run) facts: Facts,
    pub(in crate::run) units: Vec<Unit>,
    /// Wanted operation, for each domain.
    pub(in crate::run) wanted: Vec<Vec<Point>>,
    pub(in crate::run) notes: Vec<String>,
}

impl Basis {
    /// The sections, in the order of their numbers.
    pub fn units(&self) -> &[Unit] {
        &self.units
    }

    /// The vehicle data that the protocol reads.
    pub fn vehicle(&self, plan: &Plan) -> Vec<DataItem> {
        self.facts.items(plan)
    }

    /// The values of all sections at one shift, `None` where they are missing. If `needed`, at
    /// least one section must be usable. `reduction`: that of the records as they are.
    ///
    /// # Errors
    /// As [`crate::run::run`].
    pub(in crate::run) fn evaluated(
        &self,
        plan: &Plan,
        values: Vec<Option<SectionValues>>,
        needed: bool,
        reduction: Option<&Reduction>,
    ) -> Result<Evaluated, Problems> {
        let (mut units, mut notes) = (self.units.clone(), self.notes.clone());
        let mut missing = Vec::new();
        for (unit, _) in units.iter_mut().zip(&values).filter(|(_, values)| values.is_none()) {
            unit.refuse("its values are missing".into(), false);
            missing.push(unit.name.clone());
        }
        let missing = missing_in_words(&missing, units.len());
        let values: Vec<SectionValues> =
            values.into_iter().map(Option::unwrap_or_default).collect();
        let copies = copies::find(plan, &units, &values);
        requirements::take_over(plan, &self.facts, &mut units, &values, &copies, &mut notes)?;
        stop_on_fault(plan, &units, &values)?;
        let reduction = keep::keep(plan, &self.facts, &mut units, &values, reduction);
        let values = without_unused_originals(plan, &units, values);
        let findings: Vec<Finding> = values
            .iter()
            .flat_map(|values| values.findings.iter().cloned())
            .chain(copies)
            .collect();
        // Sections excluded by a plausibility rule state the reason in the findings of a report.
        let refused_by_finding =
            findings.iter().any(|finding| finding.consequence == Consequence::NotUsed);
        let needed = needed && !refused_by_finding && missing.is_none();
        if needed && units.iter().all(|unit| unit.fault.is_some()) {
            return Err(nothing_usable(&units, values));
        }
        let application = domain::compared(plan, &self.facts, &units, &self.wanted);
        let findings = findings.into_iter().chain(domain::findings(&application)).collect();
        let files = values.iter().flat_map(|values| values.files.iter().cloned()).collect();
        Ok(Evaluated {
            facts: self.facts.clone(),
            units,
            values,
            findings,
            application,
            notes,
            reduction,
            missing,
            files,
        })
    }

    /// Whether it is one of a plan, as a file may claim.
    ///
    /// # Errors
    /// What does not agree, in words.
    pub fn check(&self, plan: &Plan) -> Result<(), String> {
        let vehicle = |data: usize| data == plan.vehicle.len();
        if self.facts.vehicles.is_empty() {
            return Err("it has no vehicle".into());
        }
        if !self.facts.vehicles.iter().all(|of| vehicle(of.data.len()) && vehicle(of.assumed.len()))
        {
            return Err("its vehicle data are not those that the protocol reads".into());
        }
        for unit in &self.units {
            let inside = unit.vehicle < self.facts.vehicles.len()
                && unit.original.is_none_or(|original| original < self.units.len());
            if unit.columns.len() != plan.columns.len() || !inside {
                return Err(format!("its section {} is not one of the protocol", unit.name));
            }
        }
        let of_domain = |(domain, points): (&crate::check::plan::Domain, &Vec<Point>)| {
            points.iter().all(|point| {
                point.values.len() == domain.over.len() && point.group.len() == domain.each.len()
            })
        };
        if self.wanted.len() != plan.domains.len()
            || !plan.domains.iter().zip(&self.wanted).all(of_domain)
        {
            return Err("its wanted operation is not that of the protocol".into());
        }
        Ok(())
    }
}

/// `values of 3 of 412 sections are missing: S01, S02, S03`
fn missing_in_words(names: &[String], of: usize) -> Option<String> {
    if names.is_empty() {
        return None;
    }
    let more = names.len().saturating_sub(NAMED);
    let named = names[..names.len() - more].join(", ");
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    Some(format!("values of {} of {of} sections are missing: {named}{more}", names.len()))
}

/// A repeat whose original is not used cannot be compared: quantities of repeats have no rows in
/// it.
pub fn without_unused_originals(
    plan: &Plan,
    units: &[Unit],
    mut values: Vec<SectionValues>,
) -> Vec<SectionValues> {
    let unused =
        |unit: &Unit| unit.original.is_some_and(|original| units[original].fault.is_some());
    for (_, values) in units.iter().zip(&mut values).filter(|(unit, _)| unused(unit)) {
        let of_quantities = plan.quantities.iter().zip(&mut values.rows);
        of_quantities
            .filter(|(quantity, _)| quantity.evaluation.of_repeats())
            .for_each(|(_, rows)| rows.clear());
    }
    values
}
