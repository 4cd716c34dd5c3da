//! Results of quantities from the rows of the sections.

use std::collections::HashMap;

use crate::check::plan::{Chosen, Evaluation, Pairing, Plan, Quantity, Records};
use crate::result::{
    Figures, OUTCOME, PairValue, QuantityResult, Reason, StatisticName, StatisticResult,
};
use crate::run::describe::{reports, spreads};
use crate::run::estimate::{Group, Member, Rows, Used, count_independent};
use crate::run::limit::{Compared, Judging, rule_place};
use crate::run::sections::Facts;
use crate::run::values::Row;

/// The results of some quantities, given by index, each with a reason for each limit that is not
/// met.
pub fn of_quantities(
    plan: &Plan,
    facts: &Facts,
    used: &Used<'_>,
    which: impl IntoIterator<Item = usize>,
) -> Vec<(QuantityResult, Vec<Reason>)> {
    of_rows(plan, facts, &Rows::of_all(plan, facts, used), Tells::All, which)
}

/// What a result tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tells {
    /// Values, limits and reports.
    All,
    /// What its limits come to.
    Limits,
}

/// The same from the rows of all quantities.
pub fn of_rows(
    plan: &Plan,
    facts: &Facts,
    all: &[Rows<'_>],
    tells: Tells,
    which: impl IntoIterator<Item = usize>,
) -> Vec<(QuantityResult, Vec<Reason>)> {
    let table: Vec<_> = all.iter().map(Rows::usable).collect();
    let of_quantity = |at: usize| {
        let (quantity, Rows { members, too_few, reason }) = (&plan.quantities[at], &all[at]);
        let rows = Group { plan, facts, quantity: Some(quantity), members, table: &table };
        quantity_result(&Judging { quantity, rows, too_few }, tells, reason.clone())
    };
    which.into_iter().map(of_quantity).collect()
}

/// Of several outcomes of a quantity the word of the one that applies.
fn outcome(quantity: &Quantity, statistics: &[StatisticResult]) -> Option<String> {
    let name = StatisticName::from(OUTCOME.to_owned());
    let of = statistics.iter().find(|one| !quantity.outcomes.is_empty() && one.name == name)?;
    quantity.outcomes.get((of.value? as usize).checked_sub(1)?).cloned()
}

/// The result, and a reason for each limit that is not met.
fn quantity_result(
    judging: &Judging<'_>,
    tells: Tells,
    reason: Option<Reason>,
) -> (QuantityResult, Vec<Reason>) {
    let (quantity, Group { plan, members, .. }) = (judging.quantity, judging.rows);
    let (mut statistics, mut fails) = (Vec::new(), Vec::new());
    // The limit of each row that has one of its own, and the share; of several the largest share.
    let mut limits: HashMap<*const Row, (f64, Option<f64>)> = HashMap::new();
    for Compared { result, fails: reason, own } in judging.compared() {
        statistics.push(result);
        fails.extend(reason);
        for (row, limit, share) in own {
            let known = limits.entry(std::ptr::from_ref(row)).or_insert((limit, share));
            let size = |share: Option<f64>| share.unwrap_or(f64::INFINITY);
            if size(share) > size(known.1) {
                *known = (limit, share);
            }
        }
    }
    let undefined: Vec<Reason> = statistics
        .iter()
        .filter(|statistic| statistic.holds.is_none())
        .map(|statistic| Reason::OfEstimate {
            title: statistic.title.clone(),
            scope: statistic.scope.told(),
            reason: Box::new(statistic.reason.clone().unwrap_or(Reason::NoValue)),
        })
        .collect();
    // What is not assessed hides nothing that cannot be.
    let undefined =
        undefined.iter().find(|reason| !reason.is_of_optional()).or(undefined.first()).cloned();
    let met = statistics.iter().all(|statistic| statistic.holds == Some(true));
    let reason = reason.or(undefined).or_else(|| if met { judging.fails_alone() } else { None });
    let fails_beside = || {
        let not_assessed = reason.as_ref().is_some_and(Reason::is_of_optional);
        (not_assessed && statistics.iter().any(|one| one.holds == Some(false))).then_some(false)
    };
    let holds = if reason.is_none() { Some(met) } else { fails_beside() };
    let show = |value: f64| quantity.unit.from_si(value);
    let limit_of = |member: &Member<'_>| limits.get(&std::ptr::from_ref(member.row));
    let value = |member: &Member<'_>| PairValue {
        campaign: member.unit.campaign_name.clone(),
        section: member.unit.name.clone(),
        zone: member.unit.zone.clone(),
        signal: member.signal.to_string(),
        taken: quantity.evaluation.value_in_words(member.row.which),
        record: member.row.record.clone(),
        simulated: member.row.simulated.map(show),
        measured: member.row.measured.map(show),
        difference: show(member.row.value),
        samples: member.row.samples,
        limit: limit_of(member).map(|(limit, _)| show(*limit)),
        ratio: limit_of(member).and_then(|(_, share)| *share),
    };
    let values: Vec<PairValue> = match tells {
        Tells::All => members.iter().map(value).collect(),
        Tells::Limits => Vec::new(),
    };
    let result = QuantityResult {
        outcome: outcome(quantity, &statistics),
        id: quantity.id.clone(),
        title: quantity.title.clone(),
        symbol: quantity.symbol.clone(),
        unit: quantity.unit.text.clone(),
        pairs: 0,
        figures: Figures::default(),
        groups: None,
        of: quantity.words.of.clone(),
        filter: quantity.words.filter.clone(),
        processing: quantity.words.processing.clone(),
        comparison: quantity.words.comparison.clone(),
        clause: quantity.clause.clone(),
        source: quantity.source.clone(),
        notes: quantity.notes.clone(),
        has_sides: quantity.evaluation.has_sides(),
        from: match quantity.evaluation.as_ref() {
            Evaluation::Values { records: Records::Of(of), .. } => Some(of.side.in_words().into()),
            _ => None,
        },
        among: match quantity.evaluation.as_ref() {
            Evaluation::Values { records: Records::Spread { of, .. }, .. } => {
                Some(of.side.in_words().into())
            }
            other => other.pairing().and_then(Pairing::within).map(|side| side.in_words().into()),
        },
        against: match quantity.evaluation.pairing() {
            Some(Pairing::Each(first, Chosen { record: Some(index), side }))
                if first.side == side =>
            {
                Some(plan.records[index].title.clone())
            }
            Some(pairing) if pairing.within().is_some() => Some("Other record".into()),
            _ => None,
        },
        repeats: quantity.evaluation.of_repeats(),
        spread: match quantity.evaluation.as_ref() {
            Evaluation::Values { records: Records::Spread { center, .. }, .. } => {
                spreads::spread(*center, &values)
            }
            _ => None,
        },
        statistics,
        reported: match tells {
            Tells::All => reports::of_quantity(judging),
            Tells::Limits => Vec::new(),
        },
        n: count_independent(plan, members),
        values,
        holds,
        reason,
        rule: rule_place(&quantity.span),
    };
    (result.completed(), fails)
}
