//! Statistics over all pairs, limits, and the verdict.

use super::facts::{Facts, Known};
use super::pairs::{PairSi, SectionValues};
use super::sections::Unit;
use crate::catalog::Statistic;
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Evaluation, Limit, Plan, Quantity, Rule, Scope};
use crate::metrics::percentile::{Method, percentile};
use crate::result::{PairValue, QuantityResult, StatisticResult, Verdict, ZoneResult};

#[derive(Debug)]
pub struct Judged {
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    pub quantities: Vec<QuantityResult>,
    pub zones: Vec<ZoneResult>,
}

/// A value equal to its limit passes; this much room is for the rounding of units and sums.
const EQUAL: f64 = 1e-12;

pub fn judge(plan: &Plan, facts: &Facts, units: &[Unit], values: &[SectionValues]) -> Judged {
    let used: Vec<(&Unit, &SectionValues)> = units.iter().zip(values).filter(|(unit, _)| unit.fault.is_none()).collect();
    let mut missing = Vec::new();
    let zones: Vec<ZoneResult> = plan.zones.iter().map(|zone| zone_result(zone, units)).collect();
    for zone in zones.iter().filter(|zone| !zone.holds) {
        missing.push(format!(
            "zone {} has {} usable section{}, {} are needed",
            zone.zone,
            zone.used,
            if zone.used == 1 { "" } else { "s" },
            zone.minimum
        ));
    }
    if used.len() < plan.sections.minimum {
        missing.push(format!("{} usable sections, {} are needed", used.len(), plan.sections.minimum));
    }
    let quantities: Vec<QuantityResult> =
        plan.quantities.iter().enumerate().map(|(index, quantity)| quantity_result(plan, facts, quantity, index, &used)).collect();
    for quantity in &quantities {
        if let Some(reason) = &quantity.reason {
            missing.push(format!("{}: {reason}", quantity.id));
        }
    }
    if !missing.is_empty() {
        return Judged { verdict: Verdict::NotAssessable, reasons: missing, quantities, zones };
    }
    let mut reasons = Vec::new();
    for quantity in &quantities {
        for statistic in quantity.statistics.iter().filter(|statistic| statistic.holds == Some(false)) {
            let over = statistic.normalised.map_or(String::new(), |share| format!(" ({share:.2} of the limit)"));
            let scope = if statistic.scope == "all" { String::new() } else { format!(", {}", statistic.scope) };
            reasons.push(format!("{}: {}{scope} exceeds its limit{over}", quantity.id, statistic.title));
        }
    }
    let holding = quantities.iter().filter(|quantity| quantity.holds == Some(true)).count();
    let limits_holding =
        quantities.iter().flat_map(|quantity| &quantity.statistics).filter(|statistic| statistic.holds == Some(true)).count();
    let validated = match plan.verdict.rule {
        Rule::EveryLimit => reasons.is_empty(),
        Rule::AtLeastQuantities(count) => holding >= count,
        Rule::AtLeastLimits(count) => limits_holding >= count,
    };
    if validated {
        return Judged { verdict: Verdict::Validated, reasons: Vec::new(), quantities, zones };
    }
    if let Rule::AtLeastQuantities(count) | Rule::AtLeastLimits(count) = plan.verdict.rule {
        reasons.insert(
            0,
            format!(
                "{} hold, at least {count} are needed",
                if matches!(plan.verdict.rule, Rule::AtLeastLimits(_)) { limits_holding } else { holding }
            ),
        );
    }
    Judged { verdict: Verdict::NotValidated, reasons, quantities, zones }
}

fn zone_result(zone: &crate::check::plan::Zone, units: &[Unit]) -> ZoneResult {
    let given: Vec<&Unit> = units.iter().filter(|unit| unit.zone.as_deref() == Some(zone.name.as_str())).collect();
    let used = given.iter().filter(|unit| unit.fault.is_none()).count();
    ZoneResult {
        zone: zone.name.clone(),
        title: zone.title.clone(),
        condition: zone.condition_words.clone(),
        used,
        given: given.len(),
        minimum: zone.minimum_sections,
        holds: used >= zone.minimum_sections,
    }
}

/// One pair with the section it is of.
type Member<'a> = (&'a Unit, &'a str, PairSi);

fn quantity_result(plan: &Plan, facts: &Facts, quantity: &Quantity, index: usize, used: &[(&Unit, &SectionValues)]) -> QuantityResult {
    let mut members: Vec<Member<'_>> = Vec::new();
    let mut signals = vec![false; quantity.signals.len()];
    for (unit, values) in used {
        for (number, pair) in values.pairs.get(index).into_iter().flatten().enumerate() {
            if let Some(pair) = pair {
                signals[number] = true;
                members.push((unit, &quantity.signals[number].0, *pair));
            }
        }
    }
    let recorded = signals.iter().filter(|recorded| **recorded).count();
    let reason = if recorded < quantity.minimum_signals {
        Some(format!("{recorded} signal{} recorded, {} are needed", if recorded == 1 { "" } else { "s" }, quantity.minimum_signals))
    } else if members.len() < quantity.minimum_pairs {
        Some(format!("{} pairs of section and signal, {} are needed", members.len(), quantity.minimum_pairs))
    } else {
        None
    };
    let statistics = statistics(plan, facts, quantity, &members);
    let undefined = statistics
        .iter()
        .find(|statistic| statistic.holds.is_none())
        .and_then(|statistic| statistic.reason.clone().map(|reason| format!("{}: {reason}", statistic.title)));
    let reason = reason.or(undefined);
    let holds = if reason.is_some() { None } else { Some(statistics.iter().all(|statistic| statistic.holds == Some(true))) };
    let show = |value: f64| quantity.unit.from_si(value);
    QuantityResult {
        id: quantity.id.clone(),
        title: quantity.title.clone(),
        symbol: quantity.symbol.clone(),
        unit: quantity.unit.text.clone(),
        of: quantity.words.of.clone(),
        filter: quantity.words.filter.clone(),
        processing: quantity.words.processing.clone(),
        comparison: quantity.words.comparison.clone(),
        clause: quantity.clause.clone(),
        source: quantity.source.clone(),
        notes: quantity.notes.clone(),
        has_sides: matches!(quantity.evaluation, Evaluation::Sides { .. }),
        statistics,
        values: members
            .iter()
            .map(|(unit, signal, pair)| PairValue {
                section: unit.name.clone(),
                zone: unit.zone.clone(),
                signal: (*signal).to_string(),
                simulated: pair.simulated.map(show),
                measured: pair.measured.map(show),
                difference: show(pair.difference),
                samples: pair.samples,
            })
            .collect(),
        holds,
        reason,
    }
}

/// The limits of a quantity in an order in which each comes after those it refers to, and their results in the protocol's order.
fn statistics(plan: &Plan, facts: &Facts, quantity: &Quantity, members: &[Member<'_>]) -> Vec<StatisticResult> {
    let mut groups: Vec<(usize, String, Vec<Member<'_>>)> = Vec::new();
    for (index, limit) in quantity.limits.iter().enumerate() {
        let applies = limit.only_when.as_ref().map_or(Ok(true), |condition| flag(condition, &Known::vehicle(facts)));
        if applies == Ok(false) {
            continue;
        }
        for (scope, members) in scoped(plan, facts, limit, members) {
            groups.push((index, scope, members));
        }
    }
    groups.into_iter().map(|(index, scope, members)| statistic(facts, quantity, &quantity.limits[index], scope, &members)).collect()
}

fn scoped<'a>(plan: &Plan, facts: &Facts, limit: &Limit, members: &[Member<'a>]) -> Vec<(String, Vec<Member<'a>>)> {
    let of_zone = |zone: &str| members.iter().filter(|(unit, _, _)| unit.zone.as_deref() == Some(zone)).copied().collect::<Vec<_>>();
    match &limit.scope {
        Scope::All => vec![("all".into(), members.to_vec())],
        Scope::EachZone => plan.zones.iter().map(|zone| (format!("zone {}", zone.name), of_zone(&zone.name))).collect(),
        Scope::Zones(zones) => {
            let word = if zones.len() == 1 { "zone" } else { "zones" };
            let inside =
                members.iter().filter(|(unit, _, _)| unit.zone.as_ref().is_some_and(|zone| zones.contains(zone))).copied().collect();
            vec![(format!("{word} {}", zones.join(", ")), inside)]
        }
        Scope::Where(condition, words) => {
            let inside = members.iter().filter(|(unit, _, _)| flag(condition, &unit.known(facts)) == Ok(true)).copied().collect();
            vec![(words.clone(), inside)]
        }
    }
}

fn statistic(facts: &Facts, quantity: &Quantity, limit: &Limit, scope: String, members: &[Member<'_>]) -> StatisticResult {
    let differences: Vec<f64> = members.iter().map(|(_, _, pair)| pair.difference).collect();
    let show = |value: f64| quantity.unit.from_si(value);
    let mut result = StatisticResult {
        name: limit.statistic.name(),
        title: limit.statistic.title(limit.ddof),
        scope,
        count: differences.len(),
        unit: quantity.unit.text.clone(),
        value: None,
        interval: None,
        limit: None,
        normalised: None,
        holds: None,
        limit_text: limit.words.clone(),
        reason: None,
    };
    if limit.statistic == Statistic::Each {
        return each(facts, quantity, limit, members, result);
    }
    let value = match limit.statistic {
        Statistic::Percentile(percent) => percentile(&differences, percent, Method::Linear).ok(),
        Statistic::Named(entry) => (entry.run)(&differences, limit.ddof),
        Statistic::Each => None,
    };
    let Some(value) = value else {
        result.reason = Some(format!("not defined for {} value{}", differences.len(), if differences.len() == 1 { "" } else { "s" }));
        return result;
    };
    result.value = Some(show(value));
    if let Statistic::Named(entry) = limit.statistic {
        result.interval = entry.interval.and_then(|interval| interval(&differences)).map(|(low, high)| (show(low), show(high)));
    }
    match bound(facts, quantity, limit, &Known::vehicle(facts), 0) {
        Ok(bound) => {
            result.limit = Some(show(bound));
            let (normalised, holds) = against(value, bound, limit.at_least);
            result.normalised = normalised;
            result.holds = Some(holds);
        }
        Err(reason) => result.reason = Some(format!("its limit has no value: {reason}")),
    }
    result
}

/// Every pair against its own limit: the worst stands for all.
fn each(facts: &Facts, quantity: &Quantity, limit: &Limit, members: &[Member<'_>], mut result: StatisticResult) -> StatisticResult {
    let mut worst: Option<(f64, f64, f64)> = None;
    let mut holds = true;
    for (unit, _, pair) in members {
        let bound = match bound(facts, quantity, limit, &unit.known(facts), 0) {
            Ok(bound) => bound,
            Err(reason) => {
                result.reason = Some(format!("the limit of section {} has no value: {reason}", unit.name));
                return result;
            }
        };
        let (normalised, within) = against(pair.difference, bound, limit.at_least);
        holds &= within;
        let share = normalised.unwrap_or(f64::INFINITY);
        if worst.is_none_or(|(before, _, _)| share > before) {
            worst = Some((share, pair.difference, bound));
        }
    }
    let Some((share, value, bound)) = worst else {
        result.reason = Some("there is no value".into());
        return result;
    };
    result.value = Some(quantity.unit.from_si(value));
    result.limit = Some(quantity.unit.from_si(bound));
    result.normalised = share.is_finite().then_some(share);
    result.holds = Some(holds);
    result
}

/// Share of the limit used, and whether it holds. With "at least", the limit over the value.
fn against(value: f64, bound: f64, at_least: bool) -> (Option<f64>, bool) {
    if at_least {
        let normalised = (value > 0.0).then(|| bound / value);
        return (normalised, value >= bound * (1.0 - EQUAL));
    }
    let normalised = (bound > 0.0).then(|| value.abs() / bound);
    (normalised, value.abs() <= bound * (1.0 + EQUAL))
}

/// The limit in SI with its factors; a reference to another statistic is that statistic's limit, factors included.
fn bound(facts: &Facts, quantity: &Quantity, limit: &Limit, known: &Known<'_>, depth: usize) -> Result<f64, String> {
    if depth > quantity.limits.len() {
        return Err("it depends on itself".into());
    }
    let mut others = Vec::new();
    for other in quantity.limits.iter().filter(|other| other.statistic != limit.statistic) {
        let applies = other.only_when.as_ref().map_or(Ok(true), |condition| flag(condition, &Known::vehicle(facts)));
        let same_scope = matches!(other.scope, Scope::All) || words_of(&other.scope) == words_of(&limit.scope);
        if applies != Ok(false) && same_scope && !others.iter().any(|(name, _)| *name == other.statistic.name()) {
            if let Ok(value) = self::bound(facts, quantity, other, known, depth + 1) {
                others.push((other.statistic.name(), value));
            }
        }
    }
    let inner = Known { facts: known.facts, columns: known.columns, extent: known.extent, inputs: &[], sides: None, limits: &others };
    let mut value = number(&limit.bound, &inner)?;
    for (factor, condition) in &limit.factors {
        if flag(condition, &inner)? {
            value *= number(factor, &inner)?;
        }
    }
    Ok(value)
}

fn words_of(scope: &Scope) -> String {
    match scope {
        Scope::All => "all".into(),
        Scope::EachZone => "each zone".into(),
        Scope::Zones(zones) => zones.join(","),
        Scope::Where(_, words) => words.clone(),
    }
}
