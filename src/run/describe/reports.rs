//! Estimates without a limit: of the values of a quantity, and of the data of the sections used.

use crate::check::plan::{EstimateKind, Plan, Report};
use crate::graph::{Graph, NodeId, Operation};
use crate::result::{Count, Reason, Reported};
use crate::run::estimate::{Group, Grouped, Member, Part, count_independent, parts};
use crate::run::limit::{Estimated, Judging, rule_place};
use crate::run::sections::{Facts, Unit};
use crate::run::values::Row;
use crate::units;

/// Stands for a section that is counted by itself.
static SECTION: Row = Row::single(0, 0, None, (0.0, 0));

/// What is reported of a quantity, group by group.
pub fn of_quantity(graph: &Graph, nodes: &[NodeId], judging: &Judging<'_>) -> Vec<Reported> {
    let judging = *judging;
    let of = |&node: &NodeId| match &graph.nodes[node].operation {
        Operation::Report(report) => {
            let unit = report.estimate.unit.as_ref().unwrap_or(&judging.quantity.unit);
            let groups = judging.of_report(report);
            groups
                .into_iter()
                .map(|group| reported(judging.plan, report, unit, &group, Count::Values))
                .collect()
        }
        _ => Vec::new(),
    };
    nodes.iter().flat_map(of).collect()
}

/// What is reported of the sections used, group by group.
pub fn of_sections<'a>(
    plan: &Plan,
    facts: &Facts,
    used: impl Iterator<Item = &'a Unit>,
) -> Vec<Reported> {
    let members: Vec<Member<'_>> =
        used.map(|unit| Member { unit, signal: "", row: &SECTION }).collect();
    let none = units::Unit::one();
    let of = |report: &Report| -> Vec<Reported> {
        let one = |part: Part<'_>| {
            let inside = part.members(facts, &members);
            let value = match (&inside, &report.estimate.kind) {
                (Err(reason), _) => Err(reason.clone()),
                (Ok(inside), _) if inside.is_empty() => Err(Reason::NoSectionUsed { group: None }),
                (Ok(inside), EstimateKind::Of(of)) => {
                    Group { plan, facts, positions: &[], members: inside, table: &[] }
                        .number(of)
                        .map(Some)
                }
                (Ok(_), EstimateKind::Each) => Ok(None),
            };
            let unit = report.estimate.unit.as_ref().unwrap_or(&none);
            reported(
                plan,
                report,
                unit,
                &Estimated { value, ..Estimated::empty(part, inside.unwrap_or_default()) },
                Count::Sections,
            )
        };
        parts(plan, Grouped::sections(), &report.scope, &members, facts)
            .into_iter()
            .map(one)
            .collect()
    };
    plan.sections.reports.iter().flat_map(of).collect()
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
