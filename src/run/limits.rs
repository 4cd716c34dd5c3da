//! Statistics over the pairs of a quantity, and their limits.

use std::collections::BTreeSet;

use super::facts::{Facts, Known};
use super::pairs::PairSi;
use super::sections::Unit;
use super::told::factors;
use crate::catalog::Statistic;
use crate::check::evaluate::{Values, flag, number};
use crate::check::plan::{Limit, Plan, Quantity, Scalar, Scope};
use crate::metrics::percentile::{Method, percentile};
use crate::result::{RulePlace, StatisticResult};
use crate::source::Span;

/// A value equal to its limit passes; this much room is for the rounding of units and sums.
const EQUAL: f64 = 1e-12;

/// One pair with the section and the signal it is of.
pub type Member<'a> = (&'a Unit, &'a str, PairSi);

/// A statistic against its limit, and the sentence for the verdict where it does not hold.
#[derive(Debug)]
pub struct Compared {
    pub result: StatisticResult,
    pub fails: Option<String>,
}

/// Every limit that applies to this vehicle, once for each of its scopes, in the protocol's order.
pub fn compare(plan: &Plan, facts: &Facts, quantity: &Quantity, members: &[Member<'_>]) -> Vec<Compared> {
    let mut all = Vec::new();
    for limit in &quantity.limits {
        match applies(limit, facts) {
            Ok(false) => {}
            Ok(true) => all.extend(
                parts(plan, quantity, limit, members).into_iter().map(|part| of_part(plan, facts, quantity, limit, &part, members)),
            ),
            Err(reason) => {
                let mut result = empty(quantity, limit, "all".into(), &[]);
                result.reason = Some(format!("it cannot be determined whether the limit applies: {reason}"));
                all.push(Compared { result, fails: None });
            }
        }
    }
    all
}

pub fn applies(limit: &Limit, facts: &Facts) -> Result<bool, String> {
    limit.only_when.as_ref().map_or(Ok(true), |condition| flag(condition, &Known::vehicle(facts)))
}

/// What a statistic is taken over.
#[derive(Clone, Debug)]
pub enum Part<'a> {
    All,
    Zones(Vec<String>),
    Where(&'a Scope),
}

/// A limit of zones that need no section and have none is left out; so is that of zones that the quantity leaves out by its own
/// condition, unless it leaves out all.
pub fn parts<'a>(plan: &Plan, quantity: &Quantity, limit: &'a Limit, members: &[Member<'_>]) -> Vec<Part<'a>> {
    let selective = quantity.only.is_some() && !members.is_empty();
    let needed = |name: &str| !selective && plan.zones.iter().any(|zone| zone.name == name && zone.minimum_sections > 0);
    let filled = |zone: &str| members.iter().any(|(unit, _, _)| unit.zone.as_deref() == Some(zone));
    match &limit.scope {
        Scope::All => vec![Part::All],
        Scope::Zones(zones) if !zones.iter().any(|zone| needed(zone) || filled(zone)) => Vec::new(),
        Scope::Zones(zones) => vec![Part::Zones(zones.clone())],
        scope @ Scope::Where(..) => vec![Part::Where(scope)],
    }
}

impl Part<'_> {
    /// What a limit of a single value is about: the zone of its section.
    pub fn of_section(plan: &Plan, unit: &Unit) -> Self {
        unit.zone.as_ref().filter(|_| !plan.zones.is_empty()).map_or(Part::All, |zone| Part::Zones(vec![zone.clone()]))
    }

    pub fn in_words(&self) -> String {
        match self {
            Self::All => "all".into(),
            Self::Zones(zones) => format!("{} {}", if zones.len() == 1 { "zone" } else { "zones" }, zones.join(", ")),
            Self::Where(Scope::Where(_, words)) => words.clone(),
            Self::Where(_) => String::new(),
        }
    }

    pub fn has(&self, unit: &Unit, facts: &Facts) -> Result<bool, String> {
        match self {
            Self::All => Ok(true),
            Self::Zones(zones) => Ok(unit.zone.as_ref().is_some_and(|zone| zones.contains(zone))),
            Self::Where(Scope::Where(condition, _)) => flag(condition, &unit.known(facts))
                .map_err(|reason| format!("it cannot be determined whether section {} belongs to this group: {reason}", unit.name)),
            Self::Where(_) => Ok(false),
        }
    }

    /// Whether a limit of this scope is the limit of the part too; how closely it was meant for it.
    fn covered_by(&self, scope: &Scope) -> Option<Closeness> {
        match (scope, self) {
            (Scope::All, Self::All) => Some(Closeness::Same),
            (Scope::All, _) => Some(Closeness::General),
            (Scope::Zones(of), Self::Zones(zones)) if zones.iter().all(|zone| of.contains(zone)) => Some(Closeness::Same),
            (Scope::Where(_, a), Self::Where(Scope::Where(_, b))) if a == b => Some(Closeness::Same),
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Closeness {
    General,
    Same,
}

/// Where a rule stands, by the name of its file: folders differ from one machine to the next.
pub fn rule_place(span: &Span) -> RulePlace {
    RulePlace { file: span.source.file_name(), line: span.line() }
}

fn empty(quantity: &Quantity, limit: &Limit, scope: String, members: &[Member<'_>]) -> StatisticResult {
    StatisticResult {
        name: limit.statistic.name(),
        title: limit.statistic.title(limit.ddof),
        scope,
        count: members.len(),
        n: independent(members),
        unit: quantity.unit.text.clone(),
        value: None,
        interval: None,
        marginal: false,
        limit: None,
        normalised: None,
        holds: None,
        factors: Vec::new(),
        limit_text: limit.words.clone(),
        reason: None,
        rule: rule_place(&limit.span),
    }
}

fn of_part(plan: &Plan, facts: &Facts, quantity: &Quantity, limit: &Limit, part: &Part<'_>, members: &[Member<'_>]) -> Compared {
    let mut inside = Vec::new();
    for member in members {
        match part.has(member.0, facts) {
            Ok(true) => inside.push(*member),
            Ok(false) => {}
            Err(reason) => {
                let mut result = empty(quantity, limit, part.in_words(), &[]);
                result.reason = Some(reason);
                return Compared { result, fails: None };
            }
        }
    }
    let mut result = empty(quantity, limit, part.in_words(), &inside);
    result.factors = factors(plan, facts, limit);
    let outcome = if inside.is_empty() {
        Err("no value is available".into())
    } else if limit.statistic == Statistic::Each {
        each(plan, facts, quantity, limit, &inside, &mut result)
    } else {
        pooled(facts, quantity, limit, part, &inside, &mut result)
    };
    let mut fails = None;
    match outcome {
        Ok(holds) => {
            result.holds = Some(holds);
            fails = (!holds).then(|| sentence(quantity, limit, &result));
        }
        Err(reason) => result.reason = Some(reason),
    }
    Compared { result, fails }
}

/// `Y_qst: mean 4.33 kN exceeds the limit 3.33 kN by 30 %`
fn sentence(quantity: &Quantity, limit: &Limit, result: &StatisticResult) -> String {
    let scope = if result.scope == "all" { String::new() } else { format!(" ({})", result.scope) };
    let unit = if result.unit == "-" { String::new() } else { format!(" {}", result.unit) };
    let (Some(value), Some(bound)) = (result.value, result.limit) else {
        return format!("{}: {}{scope} does not meet its limit", quantity.id, result.title);
    };
    let (shown, shown_bound) = apart(value, bound);
    let what = format!("{}: {}{scope} {shown}{unit}", quantity.id, result.title);
    if limit.at_least {
        return format!("{what} is below the limit {shown_bound}{unit}");
    }
    let of = if value < 0.0 { "exceeds in magnitude the limit" } else { "exceeds the limit" };
    format!("{what} {of} {shown_bound}{unit}{}", excess(value.abs() / bound))
}

/// ` by 30 %`; nothing where the ratio says nothing.
fn excess(ratio: f64) -> String {
    let percent = 100.0 * (ratio - 1.0);
    match percent {
        _ if !percent.is_finite() || percent <= 0.0 => String::new(),
        _ if percent < 0.1 => " by less than 0.1 %".into(),
        _ if percent < 10.0 => format!(" by {percent:.1} %"),
        _ if percent < 1000.0 => format!(" by {percent:.0} %"),
        _ => format!(", {ratio:.0} times the limit"),
    }
}

/// Value and limit with three significant digits, more where they would read the same or compare otherwise than they do.
fn apart(value: f64, bound: f64) -> (String, String) {
    let read = |text: &str| text.replace('\u{2212}', "-").parse::<f64>().unwrap_or(f64::NAN).abs();
    let shown = |digits: usize| (significant(value, digits), significant(bound, digits));
    let right = |(a, b): &(String, String)| (read(a) > read(b)) == (value.abs() > bound.abs()) && read(a) != read(b);
    (LEAST_DIGITS..MOST_DIGITS).map(shown).find(right).unwrap_or_else(|| shown(MOST_DIGITS))
}

/// Significant digits of a value in a sentence, and of one that is close to its limit.
const LEAST_DIGITS: usize = 3;
const MOST_DIGITS: usize = 12;

fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (digits as f64 - 1.0 - value.abs().log10().floor()).clamp(0.0, 17.0) as usize;
    format!("{value:.decimals$}").replace('-', "\u{2212}")
}

/// A statistic over all members against one limit.
fn pooled(
    facts: &Facts,
    quantity: &Quantity,
    limit: &Limit,
    part: &Part<'_>,
    members: &[Member<'_>],
    result: &mut StatisticResult,
) -> Result<bool, String> {
    let differences: Vec<f64> = members.iter().map(|(_, _, pair)| pair.difference).collect();
    let sites: Vec<usize> = members.iter().map(|(unit, _, _)| unit.site).collect();
    let show = |value: f64| quantity.unit.from_si(value);
    let (value, interval) = match limit.statistic {
        Statistic::Percentile(percent) => (percentile(&differences, percent, Method::Linear).ok(), None),
        Statistic::Named(entry) => {
            ((entry.run)(&differences, limit.ddof), entry.interval.and_then(|interval| interval(&differences, &sites)))
        }
        Statistic::Each => (None, None),
    };
    let value = value
        .filter(|value| value.is_finite())
        .ok_or_else(|| format!("not defined for {} value{}", differences.len(), if differences.len() == 1 { "" } else { "s" }))?;
    result.value = Some(show(value));
    result.interval = interval.map(|(low, high)| (show(low), show(high)));
    let bound = Bounds { quantity, part, facts, known: &Known::vehicle(facts) }.of(limit, 0).map_err(|reason| no_limit(&reason))?;
    result.limit = Some(show(bound));
    let (normalised, holds) = against(value, bound, limit.at_least);
    result.normalised = normalised;
    result.marginal = interval.is_some_and(|interval| spans(interval, bound, limit.at_least));
    Ok(holds)
}

/// Whether values on both sides of a limit lie in an interval, so that the data do not decide. Where a magnitude is limited,
/// minus the limit is one, too.
fn spans((low, high): (f64, f64), bound: f64, at_least: bool) -> bool {
    let inside = |bound: f64| low < bound && bound < high;
    inside(bound) || !at_least && inside(-bound)
}

/// How many sites some pairs are of: pairs of one site are not independent of each other.
pub fn independent(members: &[Member<'_>]) -> usize {
    members.iter().map(|(unit, _, _)| unit.site).collect::<BTreeSet<_>>().len()
}

fn no_limit(reason: &str) -> String {
    format!("its limit cannot be evaluated: {reason}")
}

/// Every pair against its own limit: the worst stands for all.
fn each(
    plan: &Plan,
    facts: &Facts,
    quantity: &Quantity,
    limit: &Limit,
    members: &[Member<'_>],
    result: &mut StatisticResult,
) -> Result<bool, String> {
    let mut worst: Option<(bool, f64, f64, f64)> = None;
    let mut all_hold = true;
    for (unit, _, pair) in members {
        // The limit of another statistic, if this one refers to it, is that of the section's zone.
        let part = Part::of_section(plan, unit);
        let bound = Bounds { quantity, part: &part, facts, known: &unit.known(facts) }
            .of(limit, 0)
            .map_err(|reason| format!("section {}: {}", unit.name, no_limit(&reason)))?;
        let (normalised, holds) = against(pair.difference, bound, limit.at_least);
        all_hold &= holds;
        // One that fails is worse than any that holds, also where a share cannot be formed.
        let share = normalised.unwrap_or(if holds { 0.0 } else { f64::INFINITY });
        if worst.is_none_or(|(held, before, _, _)| (!holds, share) > (!held, before)) {
            worst = Some((holds, share, pair.difference, bound));
        }
    }
    let (_, share, value, bound) = worst.ok_or("there is no value")?;
    result.value = Some(quantity.unit.from_si(value));
    result.limit = Some(quantity.unit.from_si(bound));
    result.normalised = share.is_finite().then_some(share);
    Ok(all_hold)
}

/// Share of the limit used, and whether it holds. With "at least", the limit over the value.
fn against(value: f64, bound: f64, at_least: bool) -> (Option<f64>, bool) {
    let room = EQUAL * bound.abs();
    if at_least {
        return ((value > 0.0 && bound >= 0.0).then(|| bound / value), value >= bound - room);
    }
    ((bound > 0.0).then(|| value.abs() / bound), value.abs() <= bound + room)
}

/// Limits in SI, for one part of one quantity.
#[derive(Debug)]
pub struct Bounds<'a> {
    pub quantity: &'a Quantity,
    pub part: &'a Part<'a>,
    pub facts: &'a Facts,
    pub known: &'a Known<'a>,
}

impl Bounds<'_> {
    /// The limit with its factors; a reference to another statistic is that statistic's limit, factors included.
    pub fn of(&self, limit: &Limit, depth: usize) -> Result<f64, String> {
        if depth > self.quantity.limits.len() {
            return Err("it depends on itself".into());
        }
        let names = Named { bounds: self, depth };
        let mut value = number(&limit.bound, &names)?;
        for (factor, condition) in &limit.factors {
            if flag(condition, &names)? {
                value *= number(factor, &names)?;
            }
        }
        if value <= 0.0 && !limit.at_least {
            return Err("it is not above zero".into());
        }
        Ok(value)
    }

    /// The limit of another statistic: that given for just this part before one given for all.
    fn of_statistic(&self, name: &str, depth: usize) -> Result<f64, String> {
        let mut found: Option<(Closeness, &Limit)> = None;
        for limit in self.quantity.limits.iter().filter(|limit| limit.statistic.name() == name) {
            let Some(closeness) = self.part.covered_by(&limit.scope) else { continue };
            if applies(limit, self.facts)? && found.is_none_or(|(before, _)| closeness > before) {
                found = Some((closeness, limit));
            }
        }
        let (_, limit) = found.ok_or_else(|| format!("{name} has no limit here"))?;
        self.of(limit, depth)
    }
}

/// What names stand for in a limit.
struct Named<'a> {
    bounds: &'a Bounds<'a>,
    depth: usize,
}

impl Values for Named<'_> {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        self.bounds.known.vehicle(index)
    }

    fn column(&self, index: usize) -> Result<Scalar, String> {
        self.bounds.known.column(index)
    }

    fn extent(&self) -> Result<(f64, f64), String> {
        self.bounds.known.extent()
    }

    fn input(&self, index: usize) -> Result<f64, String> {
        self.bounds.known.input(index)
    }

    fn sides(&self) -> Result<(f64, f64), String> {
        self.bounds.known.sides()
    }

    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        self.bounds.of_statistic(statistic, self.depth + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_sentence_differ_where_the_values_do() {
        assert_eq!(apart(0.06090123, 0.046_666_67), ("0.0609".into(), "0.0467".into()));
        assert_eq!(apart(5.0001, 5.0), ("5.0001".into(), "5.0000".into()));
        assert_eq!(apart(-12.34, 10.0), ("\u{2212}12.3".into(), "10.0".into()));
        assert_eq!(excess(1.305), " by 30 %");
        assert_eq!(
            (excess(1.0004), excess(1.05), excess(f64::INFINITY)),
            (" by less than 0.1 %".into(), " by 5.0 %".into(), String::new())
        );
        assert_eq!(excess(25.0), ", 25 times the limit");
    }

    #[test]
    fn a_value_equal_to_its_limit_passes() {
        // 0.1 + 0.2 is one unit in the last place above 0.3.
        assert_eq!(against(0.1 + 0.2, 0.3, false), (Some((0.1 + 0.2) / 0.3), true));
        assert_eq!(against(-5.0, 5.0, false), (Some(1.0), true));
        assert!(!against(5.000_001, 5.0, false).1);
        assert_eq!(against(0.9, 0.9, true), (Some(1.0), true));
        assert_eq!(against(-0.2, 0.9, true), (None, false));
        assert_eq!(against(-0.2, -0.2, true), (None, true));
    }

    #[test]
    fn an_interval_with_the_limit_inside_decides_nothing() {
        assert!(spans((0.9, 1.1), 1.0, false));
        assert!(spans((-1.1, -0.9), 1.0, false));
        assert!(spans((-2.0, 2.0), 1.0, false));
        assert!(!spans((-0.9, 0.9), 1.0, false));
        assert!(!spans((1.1, 2.0), 1.0, false));
        assert!(spans((0.8, 0.95), 0.9, true));
        assert!(!spans((-0.95, -0.8), 0.9, true));
    }
}
