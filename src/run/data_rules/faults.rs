//! Faults of sections that end a run.

use indexmap::IndexMap;

use crate::check::plan::{OnFault, Plan};
use crate::problem::{Problem, Problems};
use crate::run::sections::Unit;
use crate::run::values::SectionValues;

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
