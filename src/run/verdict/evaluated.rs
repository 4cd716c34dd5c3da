//! A campaign with every section evaluated: what verdicts are given on.

use super::judge::{self, Judged, Told};
use super::quantities;
use crate::check::plan::{EstimateKind, Plan};
use crate::problem::Problems;
use crate::result::study::Reduction;
use crate::result::{
    Consequence, DomainResult, FileHash, Finding, QuantityResult, Reason, Remark, VehicleValue,
};
use crate::run::data_rules::{
    changed, copies, matching, nothing_usable, over_sections, stop_on_fault, take_over,
};
use crate::run::describe::domain;
use crate::run::estimate::{Group, Rows, used};
use crate::run::limit::pool::{self, Pool};
use crate::run::limit::{Judging, applying, keep};
use crate::run::sections::{Basis, Facts, Known, Unit, Vehicle};
use crate::run::values::{Offset, SectionValues};

/// The values of sections by their numbers, `None` where they are missing.
pub fn all_values(
    basis: &Basis,
    sections: impl IntoIterator<Item = (usize, SectionValues)>,
) -> Vec<Option<SectionValues>> {
    let mut values: Vec<Option<SectionValues>> = vec![None; basis.units.len()];
    for (number, of_section) in sections {
        if let Some(place) = values.get_mut(number) {
            *place = Some(of_section);
        }
    }
    values
}

/// A campaign with every section evaluated, before limits are applied.
#[derive(Clone, Debug)]
pub struct Evaluated {
    pub facts: Facts,
    pub units: Vec<Unit>,
    pub values: Vec<SectionValues>,
    pub findings: Vec<Finding>,
    /// Wanted operation against what the sections used cover.
    pub application: Vec<DomainResult>,
    /// Remarks that do not change the verdict.
    pub notes: Vec<Remark>,
    pub reduction: Option<Reduction>,
    /// Sections whose values are missing.
    pub missing: Option<Reason>,
    /// Records in the order of the sections.
    pub files: Vec<FileHash>,
}

impl Basis {
    /// The values of all sections, `None` where they are missing.
    ///
    /// # Errors
    /// No section can be used; a section is faulty or does not meet a check, and the protocol
    /// states `stop`.
    pub fn evaluated(
        &self,
        plan: &Plan,
        values: Vec<Option<SectionValues>>,
    ) -> Result<Evaluated, Problems> {
        let (mut units, mut notes) = (self.units.clone(), self.notes.clone());
        let mut missing = Vec::new();
        for (unit, _) in units.iter_mut().zip(&values).filter(|(_, values)| values.is_none()) {
            unit.refuse(Reason::ValuesMissing, false);
            missing.push(unit.name.clone());
        }
        let missing = (!missing.is_empty())
            .then_some(Reason::ValuesOfSectionsMissing { sections: missing, total: units.len() });
        let values: Vec<SectionValues> =
            values.into_iter().map(Option::unwrap_or_default).collect();
        let mut copies = copies::find(plan, &units, &values);
        copies.extend(matching::find(plan, &units, &values));
        take_over(plan, &mut units, &values, &copies, &mut notes)?;
        stop_on_fault(plan, &units, &values)?;
        let pooled = over_sections::find(plan, &units, &values);
        let reduction = keep::keep(plan, &self.facts, &mut units, &values);
        let values = without_unused_originals(plan, &units, values);
        let findings: Vec<Finding> = values
            .iter()
            .flat_map(|values| values.findings.iter().cloned())
            .chain(copies)
            .chain(pooled)
            .collect();
        // Sections excluded by a plausibility rule state the reason in the findings of a report.
        let refused_by_finding =
            findings.iter().any(|finding| finding.consequence == Consequence::NotUsed);
        let needed = !refused_by_finding && missing.is_none();
        if needed && units.iter().all(|unit| unit.fault.is_some()) {
            return Err(nothing_usable(&units, values));
        }
        let application = domain::compared(plan, &self.facts, &units, &self.wanted);
        let files: Vec<FileHash> =
            values.iter().flat_map(|values| values.files.iter().cloned()).collect();
        let findings = findings
            .into_iter()
            .chain(domain::findings(&application))
            .chain(changed::findings(&files))
            .collect();
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
}

/// A repeat whose original is not used cannot be compared: quantities of repeats have no rows in
/// it.
fn without_unused_originals(
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

impl Evaluated {
    /// Results of quantities and verdicts over all usable sections.
    pub fn judge(&self, plan: &Plan) -> Judged {
        let barred =
            self.missing.iter().cloned().chain(domain::barred(&self.application)).collect();
        let told = Told { findings: &self.findings, barred };
        judge::judge(plan, &self.facts, (&self.units, &self.values), told)
    }

    /// The result of one quantity, given by index, and a reason for each limit that is not met.
    pub fn judge_quantity(&self, plan: &Plan, index: usize) -> (QuantityResult, Vec<Reason>) {
        let used = used(&self.units, &self.values);
        quantities::of_quantities(plan, &self.facts, &used, [index]).swap_remove(0)
    }

    /// The same with other values of the sections. Those are used that are used here, as far as
    /// they have values. What is found of the data stands: they are not asked about again.
    pub fn in_trial(&self, plan: &Plan, values: Vec<SectionValues>) -> Self {
        let mut units = self.units.clone();
        for (unit, values) in units.iter_mut().zip(&values) {
            if let Some(fault) = &values.fault {
                unit.refuse(fault.clone(), true);
            }
        }
        Self {
            facts: self.facts.clone(),
            values: without_unused_originals(plan, &units, values),
            units,
            findings: self.findings.clone(),
            application: self.application.clone(),
            notes: Vec::new(),
            reduction: self.reduction.clone(),
            missing: None,
            files: Vec::new(),
        }
    }

    /// All values and limits that the verdict depends on.
    pub fn pool(&self, plan: &Plan) -> Pool {
        pool::pool(plan, &self.facts, &self.units, &self.values)
    }

    /// Each section with its estimated shift (SI of the axis), where it was requested.
    pub fn offsets(&self) -> impl Iterator<Item = (&str, Option<&str>, Option<&Offset>)> {
        self.units.iter().zip(&self.values).map(|(unit, values)| {
            (unit.name.as_str(), unit.zone.as_deref(), values.offset.as_ref())
        })
    }
}

/// A value of a section against the limit of an estimate.
#[derive(Clone, Debug)]
pub struct SectionRatio {
    /// Index into the plan's quantities.
    pub quantity: usize,
    /// Index into the limits of the quantity; `None` of a quantity without one, of which the value
    /// itself stands here.
    pub limit: Option<usize>,
    pub section: String,
    /// Of the section's worst value.
    pub score: Score,
}

/// The share of the limit, infinite where there is none, and then how far the value is below the
/// limit, as a share of it. Of a metric without a limit, the distance from its best value.
pub type Score = (f64, f64);

impl Evaluated {
    /// Names of the sections, and why one is not used.
    pub fn sections(&self) -> impl Iterator<Item = (&str, Option<&Reason>)> {
        self.units.iter().map(|unit| (unit.name.as_str(), unit.fault.as_ref()))
    }

    /// Names of the sections that are used.
    pub fn used(&self) -> impl Iterator<Item = &str> {
        self.sections().filter(|(_, fault)| fault.is_none()).map(|(name, _)| name)
    }

    /// The same with some sections only; the others are not used.
    pub fn with_sections(&self, keeps: &dyn Fn(&str) -> bool) -> Self {
        let mut some = self.clone();
        let units = some.units.iter_mut().filter(|unit| !keeps(&unit.name));
        units.for_each(|unit| unit.refuse(Reason::LeftOut, false));
        some
    }

    /// The same with the values of one quantity only.
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
        let (facts, used) = (&self.facts, used(&self.units, &self.values));
        let all = Rows::of_all(plan, facts, &used);
        let table: Vec<_> = all.iter().map(Rows::usable).collect();
        let mut found = Vec::new();
        for (index, quantity) in plan.quantities.iter().enumerate() {
            let members = &all[index].members;
            if quantity.limits.is_empty() {
                let best = quantity.unit.from_si(quantity.best.unwrap_or_default());
                for member in members {
                    let off = (quantity.unit.from_si(member.row.value) - best).abs();
                    worst(&mut found, index, None, &member.unit.name, (off, 0.0));
                }
            }
            let rows = Group { plan, facts, quantity: Some(quantity), members, table: &table };
            let judging = Judging { quantity, rows, too_few: &[] };
            for (at, limit) in quantity.limits.iter().enumerate() {
                // An estimate in a unit of its own is no value of a section.
                if judging.unit(limit).dimension != quantity.unit.dimension {
                    continue;
                }
                let each = matches!(limit.estimate.kind, EstimateKind::Each);
                for part in rows.parts(&limit.scope) {
                    let inside =
                        part.members.clone().and_then(|inside| applying(limit, facts, inside));
                    let Ok(Some(inside)) = inside else { continue };
                    let of_vehicle = |vehicle: &Vehicle| {
                        judging.bound(limit, &part, &inside, &Known::vehicle(vehicle))
                    };
                    let shown = |value| VehicleValue::Si { value };
                    let pooled = facts.agreed(&inside, of_vehicle, shown).ok();
                    for member in &inside {
                        let bound = match each {
                            true => judging.own_bound(limit, member.unit, &[*member]).ok(),
                            false => pooled,
                        };
                        let value = member.row.value;
                        let score = |bound: f64| match limit.direction.share(value, bound) {
                            Some(share) => (share, 0.0),
                            None => (f64::INFINITY, 1.0 - value / bound),
                        };
                        if let Some(score) = bound.map(score) {
                            worst(&mut found, index, Some(at), &member.unit.name, score);
                        }
                    }
                }
            }
        }
        found
    }
}

fn worst(
    found: &mut Vec<SectionRatio>,
    quantity: usize,
    limit: Option<usize>,
    section: &str,
    score: Score,
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
        Some(one) if score > one.score => one.score = score,
        Some(_) => {}
        None => found.push(SectionRatio { quantity, limit, section: section.to_string(), score }),
    }
}
