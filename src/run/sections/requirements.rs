//! Requirements on the data of sections, which need no record.

use indexmap::IndexMap;

use super::{
    facts::{Facts, Known, Vehicle, item},
    unit::Unit,
};
use crate::check::{
    possible::{Possible, possible},
    values::{Values, Watched},
};
use crate::result::{CheckResult, DataItem, Datum, SELECTION, Sections};
use crate::run::prelude::*;

/// Relative tolerance for a minimum length, for the rounding of section ends written with two
/// decimals.
const ROUNDING: f64 = 1e-9;

/// Requirements that need no record: selection of sections, condition of the zone, length.
pub fn check_data(plan: &Plan, facts: &Facts, units: &mut [Unit]) {
    for unit in units.iter_mut() {
        if let Some(index) = plan.sections.zone
            && let Err(reason) = &unit.columns[index]
        {
            let reason = reason.clone();
            unit.refuse(reason, true);
        }
        let zone = unit.zone.as_ref();
        let zone = zone.and_then(|name| plan.zones.iter().find(|zone| zone.name == *name));
        let known = unit.known(facts);
        let SectionRules { only, only_words, .. } = &plan.sections;
        let selection = (SELECTION, "Selection of sections".to_string());
        let mut checks: Vec<CheckResult> = Vec::new();
        checks.extend(condition(plan, &known, selection, (only, only_words)));
        if let Some(zone) = zone {
            let name = ("zone", format!("Zone {}", zone.name));
            checks.extend(condition(plan, &known, name, (&zone.condition, &zone.condition_words)));
            checks.extend(length(plan, &known, zone));
        }
        for check in checks {
            // A datum missing from the vehicle file, or an optional one, is not a fault of the
            // section. The section is used, and a finding reports it.
            let untold = check.name == "length" && check.holds.is_none() && {
                let minimum = zone.and_then(|zone| zone.minimum_length.as_ref());
                check.says.is_of_optional()
                    || minimum
                        .is_some_and(|minimum| !not_stated(minimum, facts.of(unit)).is_empty())
            };
            if check.holds != Some(true) && !untold {
                let zone = unit.zone.clone().unwrap_or_default();
                let reason = match (check.name.as_str(), check.holds) {
                    ("zone", Some(_)) => {
                        Reason::ZoneNotMet { zone, reason: Box::new(check.says.clone()) }
                    }
                    ("zone", None) => {
                        Reason::ZoneUnknown { zone, reason: Box::new(check.says.clone()) }
                    }
                    _ => of_check(&check),
                };
                unit.refuse(reason, false);
            }
            unit.checks.push(check);
        }
    }
}

/// A condition on the section's data, reported with the data that it uses.
fn condition(
    plan: &Plan,
    known: &Known<'_>,
    (name, title): (&str, String),
    (condition, words): (&Option<Expr>, &str),
) -> Option<CheckResult> {
    let watched = Watched::new(known);
    let found = flag(condition.as_ref()?, &watched);
    let read = |index: usize| {
        let value = known.column(index).ok();
        let DataItem { name, value, unit, .. } = item(&plan.columns[index], value.as_ref());
        Datum { name: name.to_lowercase(), value, unit }
    };
    let (holds, says) = met(found, words, || watched.columns().into_iter().map(read).collect());
    Some(CheckResult { name: name.into(), title, holds, says })
}

/// Whether a condition holds, and why; `found` are the data that it reads.
pub fn met(
    holds: Result<bool, Reason>,
    condition: &str,
    found: impl FnOnce() -> Vec<Datum>,
) -> (Option<bool>, Reason) {
    match holds {
        Ok(holds) => {
            let condition = condition.to_owned();
            (Some(holds), Reason::Condition { holds, condition, found: found() })
        }
        Err(reason) => (None, reason),
    }
}

/// Why a section does not meet a check.
pub fn of_check(check: &CheckResult) -> Reason {
    check.says.clone().about(Subject::Check, check.title.to_lowercase())
}

fn length(plan: &Plan, known: &Known<'_>, zone: &Zone) -> Option<CheckResult> {
    let (minimum, (start, end)) = (zone.minimum_length.as_ref()?, known.extent?);
    let axis = &plan.axis.unit;
    let (length, unit) = (axis.from_si(end - start), axis.text.clone());
    // A length written with two decimals may be below the minimum by rounding only.
    let reaches = |minimum: f64| end - start >= minimum * (1.0 - ROUNDING);
    let (holds, says) = match number(minimum, known) {
        Ok(minimum) => {
            let (holds, minimum) = (reaches(minimum), axis.from_si(minimum));
            (Some(holds), Reason::Length { length, minimum, unit })
        }
        // Long enough or too short for every value of the unknown names, or not decided.
        Err(reason) => match possible(minimum, known) {
            Possible::Number(_, most) if reaches(most) => {
                (Some(true), Reason::LongEnough { length, most: axis.from_si(most), unit })
            }
            Possible::Number(least, _) if least.is_finite() && !reaches(least) => {
                (Some(false), Reason::Length { length, minimum: axis.from_si(least), unit })
            }
            _ => (None, Reason::NotChecked { reason: Box::new(reason) }),
        },
    };
    Some(CheckResult { name: "length".into(), title: "Minimum length".into(), holds, says })
}

/// Vehicle data that an expression depends on and that the vehicle file does not state.
pub fn not_stated(expr: &Expr, vehicle: &Vehicle) -> Vec<usize> {
    let mut found = Vec::new();
    expr.visit(&mut |part| match part.kind {
        Kind::Vehicle(index) if vehicle.data[index].is_err() && !found.contains(&index) => {
            found.push(index)
        }
        _ => {}
    });
    found
}

/// A requirement that could not be checked in sections that are used nevertheless.
#[derive(Debug)]
pub struct Unchecked<'a> {
    pub title: &'a str,
    pub says: &'a Reason,
    pub sections: Sections,
    /// Whether the protocol requires it: not if it needs something optional.
    pub required: bool,
}

/// All of them, in the order of the sections.
pub fn unchecked<'a>(plan: &Plan, units: &'a [Unit]) -> Vec<Unchecked<'a>> {
    let mut found: IndexMap<(&str, String), (&CheckResult, Vec<&str>)> = IndexMap::new();
    for unit in units.iter().filter(|unit| unit.fault.is_none()) {
        for check in unit.checks.iter().filter(|check| check.holds.is_none()) {
            let key = (check.title.as_str(), check.says.text().into());
            found.entry(key).or_insert((check, Vec::new())).1.push(&unit.name);
        }
    }
    let one = |(check, names): (&'a CheckResult, Vec<&str>)| Unchecked {
        title: &check.title,
        says: match &check.says {
            Reason::NotChecked { reason } => reason,
            other => other,
        },
        sections: Sections::of(&names, units.len()),
        required: plan.checks.iter().all(|rule| rule.name != check.name || rule.required)
            && !check.says.is_of_optional(),
    };
    found.into_values().map(one).collect()
}
