//! Estimates without a limit: of the values of a quantity, and of the data of the sections used.

use std::sync::Arc;

use crate::result::{Count, Reported};
use crate::run::{
    estimate::{Group, Member, count_independent},
    limit::{Estimated, Judging, rule_place},
    prelude::*,
    sections::{Facts, Unit},
    values::Row,
};
use crate::units;

/// Stands for a section that is counted by itself.
static SECTION: Row = Row::single(0, 0, None, (0.0, 0));

/// What is reported of a quantity, group by group.
pub fn of_quantity(judging: &Judging<'_>) -> Vec<Reported> {
    let of = |report: &Arc<Report>| {
        let unit = report.estimate.unit.as_ref().unwrap_or(&judging.quantity.unit);
        let groups = judging.of_report(report).into_iter();
        groups
            .map(|group| reported(judging.rows.plan, report, unit, &group, Count::Values))
            .collect::<Vec<_>>()
    };
    judging.quantity.reports.iter().flat_map(of).collect()
}

/// What is reported of the sections used, group by group.
pub fn of_sections<'a>(
    plan: &Plan,
    facts: &Facts,
    used: impl Iterator<Item = &'a Unit>,
) -> Vec<Reported> {
    let members: Vec<Member<'_>> =
        used.map(|unit| Member { unit, signal: "", row: &SECTION }).collect();
    let all = Group { plan, facts, quantity: None, members: &members, table: &[] };
    let none = units::Unit::one();
    let mut found = Vec::new();
    for report in &plan.sections.reports {
        let unit = report.estimate.unit.as_ref().unwrap_or(&none);
        for part in all.parts(&report.scope) {
            let (inside, value) = match (part.members.clone(), &report.estimate.kind) {
                (Err(reason), _) => (Vec::new(), Err(reason)),
                (Ok(inside), _) if inside.is_empty() => {
                    (inside, Err(Reason::NoSectionUsed { group: None }))
                }
                (Ok(inside), EstimateKind::Of(of)) => {
                    let value = all.with(&inside).number(of).map(Some);
                    (inside, value)
                }
                (Ok(inside), EstimateKind::Each) => (inside, Ok(None)),
            };
            let group = Estimated::plain(part, inside, value);
            found.push(reported(plan, report, unit, &group, Count::Sections));
        }
    }
    found
}

fn reported(
    plan: &Plan,
    report: &Report,
    unit: &units::Unit,
    group: &Estimated<'_>,
    count: fn(usize) -> Count,
) -> Reported {
    let show = |value: f64| unit.from_si(value);
    let mut scope = group.part.scope();
    let (value, reason) = match &group.value {
        Ok(value) => (value.map(show), None),
        Err(reason) => (None, Some(reason.clone())),
    };
    Reported {
        name: report.estimate.name.clone().into(),
        title: report.estimate.title.clone(),
        keys: scope.owned_members(),
        condition: scope.condition.take(),
        scope,
        count: count(group.members.len()),
        n: count_independent(plan, &group.members),
        unit: unit.text.clone(),
        value,
        low: group.interval.map(|(low, _)| show(low)),
        high: group.interval.map(|(_, high)| show(high)),
        reason,
        rule: rule_place(&report.span),
    }
}
