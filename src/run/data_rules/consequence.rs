//! What a finding, a check that is not met or a fault means for a section, the verdict and the run.

use std::collections::HashMap;

use indexmap::IndexMap;

use crate::result::Consequence;
use crate::run::{
    prelude::*,
    sections::{
        Unit,
        requirements::{Unchecked, of_check, unchecked},
    },
    values::{SectionValues, margin_note},
};

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
        let copies = of_section.get(name.as_str()).into_iter().flatten().copied();
        for finding in copies.chain(&values.findings) {
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
    let optional = unchecked(plan, units).into_iter().filter(|one| !one.required);
    notes.extend(optional.map(|Unchecked { title, says, sections, .. }| Remark::Unchecked {
        check: title.into(),
        reason: says.clone(),
        sections,
    }));
    let used =
        units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()).map(|(_, values)| values);
    notes.extend(margin_note(used));
    if stop.any_error() { Err(stop) } else { Ok(()) }
}

/// Ends the run at a fault in one section, where the protocol states `stop`. The problems of the
/// records give the place.
///
/// # Errors
/// `faulty-section`, or the problems of the records.
pub fn stop_on_fault(
    plan: &Plan,
    units: &[Unit],
    values: &[SectionValues],
) -> Result<(), Problems> {
    if plan.sections.faulty != OnFault::Stop {
        return Ok(());
    }
    let mut problems = Problems::default();
    for (index, unit) in units.iter().enumerate().filter(|(_, unit)| unit.faulty) {
        let told = values.get(index).map_or(&[][..], |values| &values.problems);
        for problem in told {
            problems.push(problem.clone());
        }
        let why = unit
            .fault
            .as_ref()
            .filter(|_| told.is_empty())
            .map_or(String::new(), |fault| format!(": {}", fault.text()));
        let says = format!(
            "section {} is faulty, and the protocol states `stop` for faulty sections{why}",
            unit.name
        );
        let problem = Problem::error("faulty-section", says);
        problems.push(match &unit.span {
            Some(span) => problem.at(span),
            None => problem,
        });
    }
    if problems.any_error() { Err(problems) } else { Ok(()) }
}

/// Used if every section is faulty: the problems of the records are more useful than a report
/// without numbers.
pub fn nothing_usable(units: &[Unit], values: Vec<SectionValues>) -> Problems {
    const MOST: usize = 8;
    // A problem that occurs in several sections is shown once, with the number of occurrences.
    let mut told: IndexMap<(&str, String), (Problem, usize)> = IndexMap::new();
    for (unit, values) in units.iter().zip(values) {
        let mut problems = values.problems;
        if problems.is_empty() {
            let says =
                format!("section {}: {}", unit.name, crate::words::or_nothing(unit.fault.as_ref()));
            let problem = Problem::error("section-not-usable", says);
            problems.push(match &unit.span {
                Some(span) => problem.at(span),
                None => problem,
            });
        }
        for problem in problems {
            let key = (problem.code, problem.says.replace(&unit.name, ""));
            told.entry(key).and_modify(|(_, more)| *more += 1).or_insert((problem, 0));
        }
    }
    let left_out = told.len().saturating_sub(MOST);
    let mut all = Problems::default();
    for (problem, more) in told.into_values().take(MOST) {
        let says = if more == 0 {
            problem.says
        } else {
            format!("{}; the same {more} times more", problem.says)
        };
        all.push(Problem { says, ..problem });
    }
    let end = Problem::error("no-usable-section", "no section of the campaign can be used");
    all.push(if left_out == 0 {
        end
    } else {
        end.help(format!("{left_out} more problems are not shown"))
    });
    all
}
