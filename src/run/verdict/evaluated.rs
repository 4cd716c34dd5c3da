//! A campaign with every section evaluated: what verdicts are given on.

use super::judge::{self, Judged, Told};
use crate::check::plan::Plan;
use crate::graph::Graph;
use crate::problem::Problems;
use crate::result::study::Reduction;
use crate::result::{Consequence, DataItem, DomainResult, FileHash, Finding, Reason, Remark};
use crate::run::data_rules::{copies, nothing_usable, stop_on_fault, take_over};
use crate::run::describe::domain;
use crate::run::limit::keep;
use crate::run::limit::pool::{self, Pool};
use crate::run::sections::{Basis, Facts, Unit};
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
    pub(super) values: Vec<SectionValues>,
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
    /// The values of all sections at one shift, `None` where they are missing. If `needed`, at
    /// least one section must be usable. `reduction`: that of the records as they are.
    ///
    /// # Errors
    /// No section can be used; a section is faulty or does not meet a check, and the protocol
    /// states `stop`.
    pub fn evaluated(
        &self,
        plan: &Plan,
        values: Vec<Option<SectionValues>>,
        needed: bool,
        reduction: Option<&Reduction>,
    ) -> Result<Evaluated, Problems> {
        let (mut units, mut notes) = (self.units.clone(), self.notes.clone());
        let mut missing = Vec::new();
        for (unit, _) in units.iter_mut().zip(&values).filter(|(_, values)| values.is_none()) {
            unit.refuse(Reason::ValuesMissing, false);
            missing.push(unit.name.clone());
        }
        let missing = (!missing.is_empty())
            .then(|| Reason::ValuesOfSectionsMissing { sections: missing, total: units.len() });
        let values: Vec<SectionValues> =
            values.into_iter().map(Option::unwrap_or_default).collect();
        let copies = copies::find(plan, &units, &values);
        take_over(plan, &self.facts, &mut units, &values, &copies, &mut notes)?;
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
    pub fn judge(&self, plan: &Plan, graph: &Graph) -> Judged {
        let barred =
            self.missing.iter().cloned().chain(domain::barred(&self.application)).collect();
        judge::judge(
            plan,
            graph,
            &self.facts,
            &self.units,
            &self.values,
            &Told { findings: &self.findings, barred },
        )
    }

    /// The same with other values of the sections. Those are used that are used here, as far as
    /// they have values. Nothing is found of the data, which are not asked about again.
    #[must_use]
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
            findings: Vec::new(),
            application: Vec::new(),
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

    /// Vehicle data that the protocol reads.
    pub fn vehicle(&self, plan: &Plan) -> Vec<DataItem> {
        self.facts.items(plan)
    }

    /// Each section with its estimated shift (SI of the axis), where it was requested.
    pub fn offsets(&self) -> impl Iterator<Item = (&str, Option<&str>, Option<&Offset>)> {
        self.units.iter().zip(&self.values).map(|(unit, values)| {
            (unit.name.as_str(), unit.zone.as_deref(), values.offset.as_ref())
        })
    }
}
