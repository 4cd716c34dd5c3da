//! Compares the estimates of a quantity with its limits.

use super::factors::factors;
use crate::catalog::Statistic;
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Estimate, EstimateKind, Limit, Plan, Quantity, Report, Scalar};
use crate::check::values::Values;
use crate::graph::{Graph, LimitNodes, Operation, QuantityNodes};
use crate::metrics::statistics::{Divisor, mean, standard_deviation};
use crate::result::{Outside, RegressionFigure, RulePlace, Sample, Scope, StatisticResult};
use crate::run::estimate::{
    Closeness, Group, Grouped, Member, Part, Table, TooFew, count_independent, parts,
};
use crate::run::sections::{Facts, Known, Vehicle};
use crate::source::Span;
use crate::units::Unit;

/// Relative tolerance for rounding of units and sums. A value equal to its limit meets the limit.
const EQUAL: f64 = 1e-12;

/// A group of rows and its estimate.
#[derive(Debug)]
pub struct Estimated<'a> {
    pub part: Part<'a>,
    pub members: Vec<Member<'a>>,
    /// In SI; `None` for limits of each value.
    pub value: Result<Option<f64>, String>,
    pub interval: Option<(f64, f64)>,
    pub regression: Option<RegressionFigure>,
    /// In SI.
    pub divided_at: Option<f64>,
    /// Regressors that are read outside their data.
    pub outside: Vec<Outside>,
}

impl<'a> Estimated<'a> {
    /// Of a group without an estimate.
    pub fn empty(part: Part<'a>, members: Vec<Member<'a>>) -> Self {
        let value = Err("no value is available".into());
        Self {
            part,
            members,
            value,
            interval: None,
            regression: None,
            divided_at: None,
            outside: Vec::new(),
        }
    }
}

/// An estimate compared with its limit, and the sentence for the verdict where the limit is not
/// met.
#[derive(Debug)]
pub struct Compared {
    pub result: StatisticResult,
    pub fails: Option<String>,
}

/// Rows and rules of one quantity.
#[derive(Clone, Copy, Debug)]
pub struct Judging<'a> {
    pub plan: &'a Plan,
    pub facts: &'a Facts,
    pub quantity: &'a Quantity,
    pub members: &'a [Member<'a>],
    pub table: &'a Table<'a>,
    /// Groups with fewer pairs than the protocol requires.
    pub too_few: &'a [TooFew],
}

fn applies(limit: &Limit, vehicle: &Vehicle) -> Result<bool, String> {
    limit.only_when.as_ref().map_or(Ok(true), |condition| flag(condition, &Known::vehicle(vehicle)))
}

/// Whether a limit applies to the vehicles of some rows.
fn applies_to(limit: &Limit, facts: &Facts, members: &[Member<'_>]) -> Result<bool, String> {
    let words = |applies: &bool| if *applies { "applies" } else { "does not apply" }.to_string();
    facts.agreed(members, |vehicle| applies(limit, vehicle), words)
}

/// The rows of a group that a limit applies to: every value by itself has a vehicle of its own.
///
/// # Errors
/// It cannot be told, or differs between the vehicles of a group that has one estimate.
pub fn applying<'m>(
    limit: &Limit,
    facts: &Facts,
    mut members: Vec<Member<'m>>,
) -> Result<Option<Vec<Member<'m>>>, String> {
    if !matches!(limit.estimate.kind, EstimateKind::Each) || members.is_empty() {
        return Ok(applies_to(limit, facts, &members)?.then_some(members));
    }
    for vehicle in facts.among(&members) {
        if !applies(limit, vehicle)? {
            members.retain(|member| !std::ptr::eq(facts.of(member.unit), vehicle));
        }
    }
    Ok((!members.is_empty()).then_some(members))
}

impl<'a> Judging<'a> {
    /// The estimates of a limit, group by group; empty where the limit does not apply to this
    /// vehicle.
    ///
    /// # Errors
    /// It cannot be determined whether the limit applies.
    pub fn estimate(&self, limit: &'a Limit) -> Result<Vec<Estimated<'a>>, String> {
        match applies_to(limit, self.facts, &[]) {
            Ok(false) => return Ok(Vec::new()),
            Err(reason) if self.facts.vehicles.len() == 1 => return Err(reason),
            // Of several vehicles, those of each group decide.
            _ => {}
        }
        let parts = parts(
            self.plan,
            Grouped::values(self.quantity),
            &limit.scope,
            self.members,
            self.facts,
        );
        Ok(parts.into_iter().filter_map(|part| self.of_part(limit, part)).collect())
    }

    fn group<'g>(&'g self, members: &'g [Member<'g>]) -> Group<'g> {
        Group {
            plan: self.plan,
            facts: self.facts,
            positions: &self.quantity.positions,
            members,
            table: self.table,
        }
    }

    /// `None` of a group whose vehicle the limit does not apply to.
    fn of_part(&self, limit: &Limit, part: Part<'a>) -> Option<Estimated<'a>> {
        let none = |reason: String| Estimated {
            value: Err(reason),
            ..Estimated::empty(part.clone(), Vec::new())
        };
        let members = match part
            .members(self.facts, self.members)
            .map(|members| applying(limit, self.facts, members))
        {
            Ok(Ok(Some(members))) => members,
            Ok(Ok(None)) => return None,
            Ok(Err(reason)) => {
                return Some(none(format!(
                    "it cannot be determined whether the limit applies: {reason}"
                )));
            }
            Err(reason) => return Some(none(reason)),
        };
        Some(self.estimated(&limit.estimate, part, members))
    }

    /// An estimate of each of its groups, without a limit.
    pub fn of_report(&self, report: &'a Report) -> Vec<Estimated<'a>> {
        let parts = parts(
            self.plan,
            Grouped::values(self.quantity),
            &report.scope,
            self.members,
            self.facts,
        );
        let of_part = |part: Part<'a>| match part.members(self.facts, self.members) {
            Ok(members) => self.estimated(&report.estimate, part, members),
            Err(reason) => Estimated { value: Err(reason), ..Estimated::empty(part, Vec::new()) },
        };
        parts.into_iter().map(of_part).collect()
    }

    fn estimated(
        &self,
        estimate: &Estimate,
        part: Part<'a>,
        members: Vec<Member<'a>>,
    ) -> Estimated<'a> {
        if members.is_empty() {
            return Estimated::empty(part, members);
        }
        if let Some(reason) = self.too_few.iter().find_map(|few| few.reason(&members)) {
            return Estimated { value: Err(reason), ..Estimated::empty(part, members) };
        }
        let group = self.group(&members);
        let (value, interval, regression, divided_at, outside) = match &estimate.kind {
            EstimateKind::Each => (Ok(None), None, None, None, Vec::new()),
            EstimateKind::Of(of) => {
                let entry = match estimate.statistic() {
                    Some((Statistic::Named(entry), _)) => Some(entry),
                    _ => None,
                };
                let interval = entry.and_then(|entry| entry.interval);
                let interval =
                    interval.and_then(|interval| interval(&group.values(), &group.units()));
                let divided_at = group.divided_at(of);
                (
                    group.number(of).map(Some),
                    interval,
                    group.figure(of, &self.quantity.unit),
                    divided_at,
                    group.outside(of),
                )
            }
        };
        Estimated { part, members, value, interval, regression, divided_at, outside }
    }

    /// Compares the estimates with the limit, group by group.
    pub fn against(
        &self,
        limit: &'a Limit,
        estimated: Result<Vec<Estimated<'a>>, String>,
    ) -> Vec<Compared> {
        match estimated {
            Ok(groups) => groups.iter().map(|group| self.of_group(limit, group)).collect(),
            Err(reason) => {
                let mut result = self.empty(limit, Scope::default(), &[]);
                result.reason =
                    Some(format!("it cannot be determined whether the limit applies: {reason}"));
                vec![Compared { result, fails: None }]
            }
        }
    }

    fn empty(&self, limit: &'a Limit, scope: Scope, members: &[Member<'_>]) -> StatisticResult {
        StatisticResult {
            name: limit.estimate.name.clone().into(),
            title: limit.estimate.title.clone(),
            group: if scope.keys.is_empty() { Vec::new() } else { scope.owned_members() },
            scope,
            count: members.len(),
            n: count_independent(self.plan, members),
            unit: self.unit(limit).text.clone(),
            value: None,
            interval: None,
            marginal: false,
            limit: None,
            normalised: None,
            sample: self.sample(members),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            holds: None,
            factors: Vec::new(),
            limit_text: limit.words.clone(),
            reason: None,
            rule: rule_place(&limit.span),
        }
    }

    fn sample(&self, members: &[Member<'_>]) -> Sample {
        let values: Vec<f64> =
            members.iter().map(|member| self.quantity.unit.from_si(member.row.value)).collect();
        Sample { mean: mean(&values), std: standard_deviation(&values, Divisor::Sample) }
    }

    fn of_group(&self, limit: &'a Limit, group: &Estimated<'a>) -> Compared {
        let mut result = self.empty(limit, group.part.scope(), &group.members);
        result.factors = factors(self.plan, &self.facts.among(&group.members), limit);
        result.regression = group.regression.clone().map(Box::new);
        result.divided_at = group.divided_at.map(|value| self.quantity.unit.from_si(value));
        result.outside.clone_from(&group.outside);
        let outcome = match &group.value {
            Err(reason) => Err(reason.clone()),
            Ok(None) => self.each(limit, &group.members, &mut result),
            Ok(Some(value)) => self.one(limit, group, *value, &mut result),
        };
        let mut fails = None;
        match outcome {
            Ok(holds) => {
                result.holds = Some(holds);
                fails = (!holds).then(|| sentence(self.quantity, limit, &result));
            }
            Err(reason) => result.reason = Some(reason),
        }
        Compared { result, fails }
    }

    /// The unit in which the estimate and its limit are printed.
    pub fn unit<'u>(&self, limit: &'u Limit) -> &'u Unit
    where
        'a: 'u,
    {
        limit.estimate.unit.as_ref().unwrap_or(&self.quantity.unit)
    }

    /// Compares one number with one limit.
    fn one(
        &self,
        limit: &'a Limit,
        group: &Estimated<'a>,
        value: f64,
        result: &mut StatisticResult,
    ) -> Result<bool, String> {
        let show = |value: f64| self.unit(limit).from_si(value);
        result.value = Some(show(value));
        result.interval = group.interval.map(|(low, high)| (show(low), show(high)));
        let bound = self
            .common_bound(limit, &group.part, &group.members)
            .map_err(|reason| no_limit(&reason))?;
        result.limit = Some(show(bound));
        let (normalised, holds) = against(value, bound, limit.at_least);
        result.normalised = normalised;
        result.marginal =
            group.interval.is_some_and(|interval| spans(interval, bound, limit.at_least));
        Ok(holds)
    }

    /// Compares every row with its own limit; the worst row decides.
    fn each(
        &self,
        limit: &'a Limit,
        members: &[Member<'_>],
        result: &mut StatisticResult,
    ) -> Result<bool, String> {
        let mut worst: Option<(bool, f64, f64, f64)> = None;
        let mut all_hold = true;
        for member in members {
            let unit = member.unit;
            // If this limit refers to that of another statistic, the latter is taken for the
            // section's zone.
            let part = Part::of_section(self.plan, limit, unit);
            let bound = self
                .bound(limit, &part, &[*member], &unit.known(self.facts))
                .map_err(|reason| format!("section {}: {}", unit.name, no_limit(&reason)))?;
            let value = member.row.value;
            let (normalised, holds) = against(value, bound, limit.at_least);
            all_hold &= holds;
            // A value that fails is worse than any that passes, also where no share can be
            // computed.
            let share = normalised.unwrap_or(if holds { 0.0 } else { f64::INFINITY });
            if worst.is_none_or(|(held, before, _, _)| (!holds, share) > (!held, before)) {
                worst = Some((holds, share, value, bound));
            }
        }
        let (_, share, value, bound) = worst.ok_or("there is no value")?;
        result.value = Some(self.quantity.unit.from_si(value));
        result.limit = Some(self.quantity.unit.from_si(bound));
        result.normalised = share.is_finite().then_some(share);
        Ok(all_hold)
    }

    /// The limit of a group with one estimate, SI: the same for all its vehicles.
    pub fn common_bound(
        &self,
        limit: &Limit,
        part: &Part<'_>,
        members: &[Member<'_>],
    ) -> Result<f64, String> {
        let unit = self.unit(limit);
        let of_vehicle =
            |vehicle: &Vehicle| self.bound(limit, part, members, &Known::vehicle(vehicle));
        let found = self.facts.agreed(members, of_vehicle, |bound| {
            format!("{}{}", significant(unit.from_si(*bound), 4), unit.suffix())
        });
        found.map_err(|reason| {
            if self.facts.vehicles.len() > 1 {
                format!(
                    "{reason}; give each its own: `for each {}`",
                    if self.facts.by_campaign { "campaign" } else { "state" }
                )
            } else {
                reason
            }
        })
    }

    /// The limit of one value or group, SI, with what names stand for there.
    pub fn bound(
        &self,
        limit: &Limit,
        part: &Part<'_>,
        members: &[Member<'_>],
        known: &Known<'_>,
    ) -> Result<f64, String> {
        let group = self.group(members);
        Bounds { quantity: self.quantity, part, group, known }.of(limit, 0)
    }
}

/// The place of a rule, with the name of its file only, as folders differ between machines.
pub fn rule_place(span: &Span) -> RulePlace {
    RulePlace { file: span.source.file_name(), line: span.line() }
}

/// The sentence of a limit that is not met: `Y_qst: mean 4.33 kN exceeds the limit 3.33 kN by 30
/// %`.
fn sentence(quantity: &Quantity, limit: &Limit, result: &StatisticResult) -> String {
    let scope = if result.scope.is_all() { String::new() } else { format!(" ({})", result.scope) };
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

/// The excess as text, such as ` by 30 %`; empty where the ratio is not meaningful.
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

/// Value and limit with three significant digits, or with more if the rounded texts would be equal
/// or in the wrong order.
fn apart(value: f64, bound: f64) -> (String, String) {
    let read = |text: &str| text.replace('\u{2212}', "-").parse::<f64>().unwrap_or(f64::NAN).abs();
    let shown = |digits: usize| (significant(value, digits), significant(bound, digits));
    let right = |(a, b): &(String, String)| {
        (read(a) > read(b)) == (value.abs() > bound.abs()) && read(a) != read(b)
    };
    (LEAST_DIGITS..MOST_DIGITS).map(shown).find(right).unwrap_or_else(|| shown(MOST_DIGITS))
}

/// Significant digits of a value in a sentence; more are used close to the limit.
const LEAST_DIGITS: usize = 3;
const MOST_DIGITS: usize = 12;
/// Smaller numbers have a power of ten: zeros are hard to count.
const SMALLEST: f64 = 1e-4;

fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    if value.abs() < SMALLEST {
        return format!("{value:.*e}", digits - 1).replace('-', "\u{2212}");
    }
    let decimals = (digits as f64 - 1.0 - value.abs().log10().floor()).clamp(0.0, 17.0) as usize;
    format!("{value:.decimals$}").replace('-', "\u{2212}")
}

/// Whether an interval contains values on both sides of a limit, so that the data do not decide.
/// For a limited magnitude, minus the limit counts as well.
fn spans((low, high): (f64, f64), bound: f64, at_least: bool) -> bool {
    let inside = |bound: f64| low < bound && bound < high;
    inside(bound) || !at_least && inside(-bound)
}

fn no_limit(reason: &str) -> String {
    format!("its limit cannot be evaluated: {reason}")
}

/// Share of the limit used, and whether the limit is met. For "at least", the share is limit /
/// value.
fn against(value: f64, bound: f64, at_least: bool) -> (Option<f64>, bool) {
    let room = EQUAL * bound.abs();
    if at_least {
        return ((value > 0.0 && bound >= 0.0).then(|| bound / value), value >= bound - room);
    }
    ((bound > 0.0).then(|| value.abs() / bound), value.abs() <= bound + room)
}

/// Limits in SI, for one group of one quantity.
#[derive(Debug)]
pub struct Bounds<'a> {
    pub quantity: &'a Quantity,
    pub part: &'a Part<'a>,
    /// Data of its sections can be used in the limit.
    pub group: Group<'a>,
    pub known: &'a Known<'a>,
}

impl Bounds<'_> {
    /// The limit with its factors. A reference to another statistic means the limit of that
    /// statistic, with its factors.
    pub fn of(&self, limit: &Limit, depth: usize) -> Result<f64, String> {
        if depth > self.quantity.limits.len() {
            return Err("it depends on itself".into());
        }
        let taken = self.group.taken(&limit.bound);
        let names = Named { bounds: self, depth, taken: &taken };
        let mut value = number(&limit.bound.expr, &names)?;
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

    /// The limit of another statistic: one for just this group has priority over one for all.
    fn of_statistic(&self, name: &str, depth: usize) -> Result<f64, String> {
        let mut found: Option<(Closeness, &Limit)> = None;
        for limit in self.quantity.limits.iter().filter(|limit| limit.estimate.name == name) {
            let Some(closeness) = self.part.covered_by(&limit.scope) else { continue };
            if applies(limit, self.known.vehicle)?
                && found.is_none_or(|(before, _)| closeness > before)
            {
                found = Some((closeness, limit));
            }
        }
        let (_, limit) = found.ok_or_else(|| format!("{name} has no limit here"))?;
        self.of(limit, depth)
    }
}

/// Values of the names in a limit.
struct Named<'a> {
    bounds: &'a Bounds<'a>,
    depth: usize,
    /// The numbers that the limit takes from the group.
    taken: &'a [Result<f64, String>],
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
        self.taken.get(index).cloned().unwrap_or_else(|| self.bounds.known.input(index))
    }

    fn sides(&self) -> Result<(f64, f64), String> {
        self.bounds.known.sides()
    }

    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        self.bounds.of_statistic(statistic, self.depth + 1)
    }
}

/// Evaluates the estimates and limits of a quantity, group by group.
pub fn compared(graph: &Graph, nodes: &QuantityNodes, judging: &Judging<'_>) -> Vec<Compared> {
    let of_limit = |nodes: &LimitNodes| match (
        &graph.nodes[nodes.estimate].operation,
        &graph.nodes[nodes.limit].operation,
    ) {
        (Operation::Estimate(estimate), Operation::Limit(limit)) => {
            let judging = *judging;
            judging.against(limit, judging.estimate(estimate))
        }
        _ => Vec::new(),
    };
    nodes.limits.iter().flat_map(of_limit).collect()
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
