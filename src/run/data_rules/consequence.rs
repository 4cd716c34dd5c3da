//! What a finding or a check that is not met means for a section and the verdict.

use std::collections::HashMap;

use crate::check::plan::{OnFault, Plan};
use crate::problem::{Problem, Problems};
use crate::result::{Consequence, Finding, Reason, Remark, Sections};
use crate::run::sections::requirements::{asked, not_stated, of_check};
use crate::run::sections::{Facts, Unit};
use crate::run::values::{SectionValues, margin_note};

/// The consequence of a finding, from the rule's `otherwise`. For `stop`, the run ends elsewhere.
pub fn consequence(otherwise: OnFault) -> Consequence {
    match otherwise {
        OnFault::Note => Consequence::Note,
        OnFault::NotUsed => Consequence::NotUsed,
        OnFault::NotAssessable | OnFault::Stop => Consequence::NotAssessable,
    }
}

/// Transfers results of the records to the sections: faults and section checks.
///
/// # Errors
/// `section-check` for each check that is not met and has `otherwise stop`.
pub fn take_over(
    plan: &Plan,
    facts: &Facts,
    units: &mut [Unit],
    values: &[SectionValues],
    copies: &[Finding],
    notes: &mut Vec<Remark>,
) -> Result<(), Problems> {
    let mut stop = Problems::default();
    let mut of_section: HashMap<&str, Vec<&Finding>> = HashMap::new();
    for copy in copies {
        of_section.entry(copy.first.section.as_deref().unwrap_or_default()).or_default().push(copy);
    }
    for (unit, values) in units.iter_mut().zip(values) {
        for (check, rule) in
            values.checks.iter().zip(&plan.checks).filter(|(check, _)| check.holds == Some(false))
        {
            let reason = of_check(check);
            match rule.otherwise {
                OnFault::NotUsed | OnFault::NotAssessable => unit.refuse(reason, false),
                OnFault::Note => {
                    notes.push(Remark::OfSection { section: unit.name.clone(), reason })
                }
                OnFault::Stop => {
                    let says = format!("section {}: {}", unit.name, reason.text());
                    stop.push(Problem::error("section-check", says).at(&rule.span));
                }
            }
        }
        let name = unit.name.clone();
        for finding in values
            .findings
            .iter()
            .chain(of_section.get(name.as_str()).into_iter().flatten().copied())
        {
            if finding.consequence == Consequence::NotUsed {
                let finding = Box::new(finding.first.data.clone());
                unit.refuse(Reason::Finding { finding }, false);
            }
            let rule = plan.plausibility.iter().find(|rule| rule.name == finding.code);
            if let Some(rule) = rule.filter(|rule| rule.otherwise == OnFault::Stop) {
                let says = format!("section {name}: {}", finding.first.text());
                stop.push(Problem::error("not-plausible", says).at(&rule.span));
            }
        }
        unit.covered = unit.extent.or(values.extent);
        unit.checks.extend(values.checks.iter().cloned());
        if let Some(fault) = &values.fault {
            unit.refuse(fault.clone(), true);
        }
    }
    notes.extend(unchecked(plan, facts, units));
    let used =
        units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()).map(|(_, values)| values);
    notes.extend(margin_note(used));
    if stop.any_error() { Err(stop) } else { Ok(()) }
}

/// One note for each requirement that could not be checked in sections that are used nevertheless.
fn unchecked(plan: &Plan, facts: &Facts, units: &[Unit]) -> Vec<Remark> {
    let mut found: Vec<(&str, &Reason, Vec<&str>)> = Vec::new();
    for unit in units.iter().filter(|unit| unit.fault.is_none()) {
        for check in unit.checks.iter().filter(|check| check.holds.is_none()) {
            // A datum missing from the vehicle file is reported by a finding.
            if asked(plan, unit, check)
                .is_some_and(|rule| !not_stated(rule, facts.of(unit)).is_empty())
            {
                continue;
            }
            match found
                .iter_mut()
                .find(|(title, says, _)| *title == check.title && **says == check.says)
            {
                Some((_, _, names)) => names.push(&unit.name),
                None => found.push((&check.title, &check.says, vec![&unit.name])),
            }
        }
    }
    let remark = |(title, says, names): (&str, &Reason, Vec<&str>)| Remark::Unchecked {
        check: title.into(),
        reason: says.clone(),
        sections: Sections::of(&names, units.len()),
    };
    found.into_iter().map(remark).collect()
}
