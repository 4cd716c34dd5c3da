//! From the rows of all sections to results of quantities and verdicts: the nodes of the graph
//! after the table of values.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use indexmap::IndexMap;

use super::verdicts;
use crate::check::evaluate::flag;
use crate::check::plan::{Chosen, Evaluation, Pairing, Plan, Quantity, Records, Zone};
use crate::result::{
    Consequence, Figures, Finding, OUTCOME, PairValue, QuantityResult, Reason, Reported,
    StatisticName, StatisticResult, Verdict, VerdictResult, ZoneResult,
};
use crate::run::data_rules::changed;
use crate::run::describe::{reports, spreads};
use crate::run::estimate::{Group, Member, Rows, Used, count_independent, used};
use crate::run::limit::{Compared, Judging, rule_place};
use crate::run::sections::requirements::{self, Unchecked};
use crate::run::sections::{Facts, Unit};
use crate::run::values::{Row, SectionValues};

#[derive(Debug)]
pub struct Judged {
    pub verdict: Verdict,
    /// The overall verdict in the words of the protocol, if it states them.
    pub own_word: Option<String>,
    /// Of several outcomes of the overall verdict the one that applies.
    pub outcome: Option<String>,
    pub reasons: Vec<Reason>,
    /// Verdicts with a name.
    pub verdicts: Vec<VerdictResult>,
    pub quantities: Vec<QuantityResult>,
    pub zones: Vec<ZoneResult>,
    /// Numbers of the data of the sections.
    pub reported: Vec<Reported>,
    /// Why no verdict on limits can be given.
    pub barred: Vec<Reason>,
    /// Of each quantity, a reason for each limit that is not met.
    pub fails: Vec<Vec<Reason>>,
}

/// What was told before anything is judged.
#[derive(Debug)]
pub struct Told<'a> {
    pub findings: &'a [Finding],
    /// Why nothing can be assessed, beside findings of plausibility.
    pub barred: Vec<Reason>,
}

/// Results of quantities and verdicts from the values of sections.
pub fn judge(
    plan: &Plan,
    facts: &Facts,
    (units, values): (&[Unit], &[SectionValues]),
    told: Told<'_>,
) -> Judged {
    let used = used(units, values);
    let mut missing: Vec<Reason> = Vec::new();
    let zones: Vec<ZoneResult> = plan.zones.iter().map(|zone| zone_result(zone, units)).collect();
    missing.extend(zones.iter().filter_map(ZoneResult::lack));
    let sites = sites(used.iter().map(|(unit, _)| *unit));
    if sites < plan.sections.minimum {
        let (used, minimum) = (used.len(), plan.sections.minimum);
        missing.push(Reason::TooFewSections { used, sites, minimum });
    }
    missing.extend(without_sections(units));
    missing.extend(too_many_removed(plan, facts, units));
    missing.extend(not_plausible(plan, told.findings, missing.is_empty()));
    missing.extend(changed::reason(told.findings));
    missing.extend(told.barred);
    missing.extend(parameters_not_stated(plan));
    let required = requirements::unchecked(plan, units).into_iter().filter(|one| one.required);
    missing.extend(required.map(|Unchecked { title, says, sections, .. }| {
        Reason::RequiredNotChecked { check: title.into(), reason: Box::new(says.clone()), sections }
    }));
    let (quantities, fails): (Vec<QuantityResult>, Vec<Vec<Reason>>) =
        of_quantities(plan, facts, &used, 0..plan.quantities.len()).into_iter().unzip();
    let given = verdicts::Given { barred: missing, quantities: &quantities, fails };
    let decided = verdicts::decide(plan, &given);
    let verdicts = verdicts::named(plan, &decided);
    let (rule, overall) = (plan.overall(), decided.into_iter().next().unwrap_or_default());
    let verdict = overall.outcome.overall();
    let own_word = rule.has_words().then(|| match verdict {
        Verdict::NotAssessable => verdict.in_words().to_string(),
        _ => overall.word(&rule.words).to_string(),
    });
    let outcome = overall.word.clone();
    let reported = reports::of_sections(plan, facts, used.iter().map(|(unit, _)| *unit));
    let reasons = overall.reasons;
    let verdicts::Given { barred, fails, .. } = given;
    Judged {
        verdict,
        own_word,
        outcome,
        reasons,
        verdicts,
        barred,
        fails,
        quantities,
        zones,
        reported,
    }
}

/// The results of some quantities, given by index, each with a reason for each limit that is not
/// met.
pub fn of_quantities(
    plan: &Plan,
    facts: &Facts,
    used: &Used<'_>,
    which: Range<usize>,
) -> Vec<(QuantityResult, Vec<Reason>)> {
    let all = Rows::of_all(plan, facts, used);
    let table: Vec<_> = all.iter().map(Rows::usable).collect();
    let of_quantity = |at: usize| {
        let (quantity, Rows { members, too_few, reason }) = (&plan.quantities[at], &all[at]);
        let rows = Group { plan, facts, quantity: Some(quantity), members, table: &table };
        quantity_result(&Judging { quantity, rows, too_few }, reason.clone())
    };
    which.map(of_quantity).collect()
}

/// One reason for all parameters that have no value.
fn parameters_not_stated(plan: &Plan) -> Option<Reason> {
    let names = plan.parameters.iter().filter(|one| one.lacking).map(|one| one.name.clone());
    let parameters: Vec<String> = names.collect();
    (!parameters.is_empty()).then_some(Reason::ParametersNotStated { parameters })
}

/// One reason for each of several campaigns of which no section is used: the verdict names it, but
/// nothing of it was assessed.
fn without_sections(units: &[Unit]) -> Vec<Reason> {
    let mut used: IndexMap<&str, bool> = IndexMap::new();
    for unit in units {
        let Some(name) = unit.campaign_name.as_deref() else { continue };
        *used.entry(name).or_default() |= unit.fault.is_none();
    }
    let unused = used.into_iter().filter(|(_, any)| !any);
    unused.map(|(name, _)| Reason::NoSectionOfCampaign { campaign: name.into() }).collect()
}

/// Relative tolerance for the number of sections that a share allows.
const ROUNDING: f64 = 1e-9;

/// More sections are removed than the protocol allows: not used, and neither deselected by it nor
/// left out by a reduction.
fn too_many_removed(plan: &Plan, facts: &Facts, units: &[Unit]) -> Option<Reason> {
    let most = plan.sections.most_removed?;
    let given = |unit: &&Unit| {
        let only = plan.sections.only.as_ref();
        only.is_none_or(|only| flag(only, &unit.known(facts)) != Ok(false))
            && unit.fault.as_ref().is_none_or(|fault| !fault.is_choice())
    };
    let given: Vec<&Unit> = units.iter().filter(given).collect();
    let removed = given.iter().filter(|unit| unit.fault.is_some());
    let removed: Vec<String> = removed.map(|unit| unit.name.clone()).collect();
    let allowed = most * given.len() as f64 * (1.0 + ROUNDING);
    (removed.len() as f64 > allowed).then_some(Reason::TooManyRemoved {
        removed: removed.len(),
        sections: given.len(),
        most: 100.0 * most,
        names: removed,
    })
}

/// Number of different sites of the sections.
fn sites<'a>(units: impl Iterator<Item = &'a Unit>) -> usize {
    units.map(|unit| unit.site).collect::<BTreeSet<_>>().len()
}

/// One reason for each plausibility rule that makes the campaign not assessable. If sections are
/// missing, also one for each rule that excluded sections.
fn not_plausible(plan: &Plan, findings: &[Finding], complete: bool) -> Vec<Reason> {
    let mut reasons: Vec<Reason> = Vec::new();
    for rule in &plan.plausibility {
        let sections = |consequence: Consequence| {
            let own = findings
                .iter()
                .flat_map(Finding::with_explained)
                .filter(|finding| finding.code == rule.name && finding.consequence == consequence);
            let places = own.flat_map(Finding::places);
            places.map(|place| place.section.as_deref()).collect::<BTreeSet<_>>().len()
        };
        let (barred, taken) =
            (sections(Consequence::NotAssessable), sections(Consequence::NotUsed));
        let rule = rule.title.clone();
        let reason = match (barred, taken) {
            (0, taken) if taken > 0 && !complete => Reason::NotUsedFor { rule, sections: taken },
            (0, _) => continue,
            (barred, _) => Reason::Implausible { rule, sections: barred },
        };
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}

fn zone_result(zone: &Zone, units: &[Unit]) -> ZoneResult {
    let given: Vec<&Unit> =
        units.iter().filter(|unit| unit.zone.as_deref() == Some(zone.name.as_str())).collect();
    let used: Vec<&Unit> = given.iter().copied().filter(|unit| unit.fault.is_none()).collect();
    let sites = sites(used.iter().copied());
    ZoneResult {
        zone: zone.name.clone(),
        title: zone.title.clone(),
        condition: zone.condition_words.clone(),
        used: used.len(),
        sites,
        given: given.len(),
        minimum: zone.minimum_sections,
        holds: sites >= zone.minimum_sections,
    }
}

/// Of several outcomes of a quantity the word of the one that applies.
fn outcome(quantity: &Quantity, statistics: &[StatisticResult]) -> Option<String> {
    let name = StatisticName::from(OUTCOME.to_owned());
    let of = statistics.iter().find(|one| !quantity.outcomes.is_empty() && one.name == name)?;
    quantity.outcomes.get((of.value? as usize).checked_sub(1)?).cloned()
}

/// The result, and a reason for each limit that is not met.
fn quantity_result(judging: &Judging<'_>, reason: Option<Reason>) -> (QuantityResult, Vec<Reason>) {
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
    let values: Vec<PairValue> = members.iter().map(value).collect();
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
        reported: reports::of_quantity(judging),
        n: count_independent(plan, members),
        values,
        holds,
        reason,
        rule: rule_place(&quantity.span),
    };
    (result.completed(), fails)
}
