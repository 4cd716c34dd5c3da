//! Compares the estimates of a quantity with its limits.

use super::{
    against::{against, spans},
    bound::{OfGroup, applies},
    factors::factors,
};
use crate::catalog::Statistic;
use crate::metrics::statistics::{Divisor, mean, standard_deviation};
use crate::result::{
    Direction, EdgeResult, LimitNotMet, Outside, RegressionFigure, RulePlace, Sample, Scope,
    StatisticResult, VehicleValue,
};
use crate::run::{
    estimate::{Group, Member, RowGroup, TooFew, count_independent},
    prelude::*,
    sections::{Facts, Known, Unit as Section, Vehicle},
    values::Row,
};
use crate::source::Span;
use crate::units::Unit;

/// A group of rows and its estimate.
#[derive(Debug)]
pub struct Estimated<'a> {
    pub part: RowGroup<'a>,
    pub members: Vec<Member<'a>>,
    /// In SI; `None` for limits of each value.
    pub value: Result<Option<f64>, Reason>,
    pub interval: Option<(f64, f64)>,
    pub regression: Option<RegressionFigure>,
    /// In SI.
    pub divided_at: Option<f64>,
    /// Regressors that are read outside their data.
    pub outside: Vec<Outside>,
}

impl<'a> Estimated<'a> {
    /// Nothing but a value, or why there is none.
    pub fn plain(
        part: RowGroup<'a>,
        members: Vec<Member<'a>>,
        value: Result<Option<f64>, Reason>,
    ) -> Self {
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

/// An estimate compared with its limit, and the reason for the verdict where the limit is not met.
#[derive(Debug)]
pub struct Compared<'a> {
    pub result: StatisticResult,
    pub fails: Option<Reason>,
    /// Where each value has a limit: the row, its limit (SI), and the share.
    pub own: Vec<(&'a Row, f64, Option<f64>)>,
}

impl Compared<'_> {
    /// The comparisons of an estimate with both edges of a limit as one: that with the edge of which
    /// more is used, or which is not met.
    fn between(lower: Self, upper: Self) -> Self {
        let edges: Vec<EdgeResult> =
            [&lower, &upper].iter().flat_map(|one| one.result.compared()).collect();
        let bounds = |one: &Self| -> Vec<f64> { one.own.iter().map(|own| own.1).collect() };
        let each = bounds(&lower).into_iter().zip(bounds(&upper));
        let mut pairs = each.chain(edges[0].limit.zip(edges[1].limit));
        let crossed = pairs.any(|(low, high)| low > high);
        let marginal = lower.result.marginal || upper.result.marginal;
        let use_of = |one: &Self| match one.result.holds {
            Some(holds) => (!holds, one.result.normalised.unwrap_or(f64::INFINITY)),
            None => (true, f64::INFINITY),
        };
        let (mut worse, other) =
            if use_of(&lower) > use_of(&upper) { (lower, upper) } else { (upper, lower) };
        worse.own.extend(other.own);
        (worse.result.edges, worse.result.marginal) = (edges, marginal);
        if crossed {
            (worse.result.holds, worse.fails) = (None, None);
            worse.result.reason = Some(no_limit(Reason::EdgesCrossed));
        }
        worse
    }
}

/// Rows and rules of one quantity.
#[derive(Clone, Copy, Debug)]
pub struct Judging<'a> {
    pub quantity: &'a Quantity,
    /// All its rows.
    pub rows: Group<'a>,
    /// Groups with fewer pairs than the protocol requires.
    pub too_few: &'a [TooFew],
}

/// Whether a limit applies to the vehicles of some rows.
fn applies_to(limit: &Limit, facts: &Facts, members: &[Member<'_>]) -> Result<bool, Reason> {
    let shown = |applies| VehicleValue::Applies { applies };
    facts.agreed(members, |vehicle| applies(limit, vehicle), shown)
}

/// The rows of a group that a limit applies to: every value by itself has a vehicle of its own.
///
/// # Errors
/// It cannot be told, or differs between the vehicles of a group that has one estimate.
pub fn applying<'m>(
    limit: &Limit,
    facts: &Facts,
    mut members: Vec<Member<'m>>,
) -> Result<Option<Vec<Member<'m>>>, Reason> {
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
    /// The estimates and limits of the quantity, group by group.
    pub fn compared(&self) -> Vec<Compared<'a>> {
        let mut limits = self.quantity.limits.iter();
        let mut all = Vec::new();
        while let Some(limit) = limits.next() {
            let found = self.with_limit(limit);
            match if limit.is_lower_edge() { limits.next() } else { None } {
                Some(upper) => {
                    let edges = found.into_iter().zip(self.with_limit(upper));
                    all.extend(edges.map(|(lower, upper)| Compared::between(lower, upper)));
                }
                None => all.extend(found),
            }
        }
        all
    }

    /// The estimates of a limit, group by group; none where the limit does not apply to this
    /// vehicle.
    fn with_limit(&self, limit: &'a Limit) -> Vec<Compared<'a>> {
        let facts = self.rows.facts;
        match applies_to(limit, facts, &[]) {
            Ok(false) => return Vec::new(),
            Err(reason) if facts.vehicles.len() == 1 => {
                let mut result = self.empty(limit, Scope::default(), &[]);
                result.reason = Some(unknown_whether(reason));
                return vec![Compared { result, fails: None, own: Vec::new() }];
            }
            // Of several vehicles, those of each group decide.
            _ => {}
        }
        let parts = self.rows.parts(&limit.scope).into_iter();
        let estimated = parts.filter_map(|part| self.of_part(limit, part));
        estimated.map(|group| self.of_group(limit, &group)).collect()
    }

    /// `None` of a group whose vehicle the limit does not apply to.
    fn of_part(&self, limit: &Limit, part: RowGroup<'a>) -> Option<Estimated<'a>> {
        let members = part.members.clone();
        match members.map(|members| applying(limit, self.rows.facts, members)) {
            Ok(Ok(members)) => Some(self.estimated(&limit.estimate, part, members?)),
            Ok(Err(reason)) => {
                Some(Estimated::plain(part, Vec::new(), Err(unknown_whether(reason))))
            }
            Err(reason) => Some(Estimated::plain(part, Vec::new(), Err(reason))),
        }
    }

    /// An estimate of each of its groups, without a limit.
    pub fn of_report(&self, report: &'a Report) -> Vec<Estimated<'a>> {
        let of_part = |part: RowGroup<'a>| match part.members.clone() {
            Ok(members) => self.estimated(&report.estimate, part, members),
            Err(reason) => Estimated::plain(part, Vec::new(), Err(reason)),
        };
        self.rows.parts(&report.scope).into_iter().map(of_part).collect()
    }

    fn estimated(
        &self,
        estimate: &Estimate,
        part: RowGroup<'a>,
        members: Vec<Member<'a>>,
    ) -> Estimated<'a> {
        if members.is_empty() {
            return Estimated::plain(part, members, Err(Reason::NoValueInGroup));
        }
        if let Some(reason) = self.too_few.iter().find_map(|few| few.reason(&members)) {
            return Estimated::plain(part, members, Err(reason));
        }
        let EstimateKind::Of(of) = &estimate.kind else {
            return Estimated::plain(part, members, Ok(None));
        };
        let group = self.rows.with(&members);
        let interval = match estimate.statistic() {
            Some((Statistic::Named(entry), _)) => entry.interval,
            _ => None,
        };
        let interval = interval.and_then(|interval| interval(&group.values(), &group.units()));
        let (regression, divided_at) =
            (group.figure(of, &self.quantity.unit), group.divided_at(of));
        let (value, outside) = (group.number(of).map(Some), group.outside(of));
        Estimated { part, members, value, interval, regression, divided_at, outside }
    }

    fn empty(&self, limit: &Limit, scope: Scope, members: &[Member<'_>]) -> StatisticResult {
        StatisticResult {
            name: limit.estimate.name.clone().into(),
            title: limit.estimate.title.clone(),
            group: if scope.keys.is_empty() { Vec::new() } else { scope.owned_members() },
            scope,
            count: members.len(),
            n: count_independent(self.rows.plan, members),
            unit: self.unit(limit).text.clone(),
            value: None,
            interval: None,
            marginal: false,
            limit: None,
            direction: limit.direction,
            edges: Vec::new(),
            normalised: None,
            sample: self.sample(members),
            regression: None,
            divided_at: None,
            outside: Vec::new(),
            beyond: None,
            holds: None,
            factors: Vec::new(),
            limit_text: limit.words.clone(),
            limit_printed: limit.printed.clone(),
            reason: None,
            rule: rule_place(&limit.span),
        }
    }

    fn sample(&self, members: &[Member<'_>]) -> Sample {
        let values: Vec<f64> =
            members.iter().map(|member| self.quantity.unit.from_si(member.row.value)).collect();
        Sample { mean: mean(&values), std: standard_deviation(&values, Divisor::Sample) }
    }

    fn of_group(&self, limit: &Limit, group: &Estimated<'a>) -> Compared<'a> {
        let Group { plan, facts, .. } = self.rows;
        let mut result = self.empty(limit, group.part.scope(), &group.members);
        result.factors = factors(plan, &facts.among(&group.members), limit);
        result.regression = group.regression.clone().map(Box::new);
        result.divided_at = group.divided_at.map(|value| self.quantity.unit.from_si(value));
        result.outside.clone_from(&group.outside);
        let mut own = Vec::new();
        let outcome = match &group.value {
            Err(reason) => Err(reason.clone()),
            Ok(None) => self.each(limit, &group.members, &mut result, &mut own),
            Ok(Some(value)) => self.compare_number(limit, group, *value, &mut result),
        };
        let mut fails = None;
        match outcome {
            Ok(holds) => {
                result.holds = Some(holds);
                fails = (!holds).then(|| not_met(self.quantity, limit, &result));
            }
            Err(reason) => result.reason = Some(reason),
        }
        Compared { result, fails, own }
    }

    /// The unit in which the estimate and its limit are printed.
    pub fn unit<'u>(&self, limit: &'u Limit) -> &'u Unit
    where
        'a: 'u,
    {
        limit.estimate.unit.as_ref().unwrap_or(&self.quantity.unit)
    }

    /// Compares one number with one limit.
    fn compare_number(
        &self,
        limit: &Limit,
        group: &Estimated<'_>,
        value: f64,
        result: &mut StatisticResult,
    ) -> Result<bool, Reason> {
        let show = |value: f64| self.unit(limit).from_si(value);
        result.value = Some(show(value));
        let beyond = match &limit.estimate.kind {
            EstimateKind::Of(of) => self.rows.with(&group.members).beyond(of, value),
            EstimateKind::Each => None,
        };
        let of_values = |_: &_| self.unit(limit).dimension == self.quantity.unit.dimension;
        result.beyond = beyond.filter(of_values).map(|(low, high)| (show(low), show(high)));
        result.interval = group.interval.map(|(low, high)| (show(low), show(high)));
        let bound = self.common_bound(limit, &group.part, &group.members).map_err(no_limit)?;
        result.limit = Some(show(bound));
        let (normalised, holds) = against(value, bound, limit.direction);
        result.normalised = normalised;
        result.marginal =
            group.interval.is_some_and(|interval| spans(interval, bound, limit.direction));
        Ok(holds)
    }

    /// Compares every row with its own limit; the worst row decides.
    fn each(
        &self,
        limit: &Limit,
        members: &[Member<'a>],
        result: &mut StatisticResult,
        own: &mut Vec<(&'a Row, f64, Option<f64>)>,
    ) -> Result<bool, Reason> {
        let mut worst: Option<((bool, f64, f64), f64, f64)> = None;
        let mut all_hold = true;
        for member in members {
            let bound = self
                .own_bound(limit, member.unit, &[*member])
                .map_err(|reason| no_limit(reason).about(Subject::Section, &member.unit.name))?;
            let value = member.row.value;
            let (normalised, holds) = against(value, bound, limit.direction);
            own.push((member.row, bound, normalised));
            all_hold &= holds;
            let badness = limit.direction.badness(value, bound, holds);
            if worst.is_none_or(|worst| badness > worst.0) {
                worst = Some((badness, value, bound));
            }
        }
        let ((_, share, _), value, bound) = worst.ok_or(Reason::NoValue)?;
        result.value = Some(self.quantity.unit.from_si(value));
        result.limit = Some(self.quantity.unit.from_si(bound));
        result.normalised = share.is_finite().then_some(share);
        Ok(all_hold)
    }

    /// The limit of a group with one estimate, SI: the same for all its vehicles.
    ///
    /// # Errors
    /// It has no value, or one that differs from vehicle to vehicle.
    pub fn common_bound(
        &self,
        limit: &Limit,
        part: &RowGroup<'_>,
        members: &[Member<'_>],
    ) -> Result<f64, Reason> {
        let (unit, facts) = (self.unit(limit), self.rows.facts);
        let of_vehicle =
            |vehicle: &Vehicle| self.bound(limit, part, members, &Known::vehicle(vehicle));
        let found = facts.agreed(members, of_vehicle, |bound| VehicleValue::Amount {
            value: unit.from_si(bound),
            unit: unit.text.clone(),
        });
        found.map_err(|reason| match facts.vehicles.len() {
            1 => reason,
            _ => Reason::GiveEachItsOwn { reason: Box::new(reason), campaigns: facts.by_campaign },
        })
    }

    /// The limit of a value of one section, SI. If it refers to that of another statistic, the
    /// latter is taken for the section's zone.
    ///
    /// # Errors
    /// It has no value.
    pub fn own_bound(
        &self,
        limit: &Limit,
        section: &Section,
        members: &[Member<'_>],
    ) -> Result<f64, Reason> {
        let part = RowGroup::of_section(self.rows.plan, limit, section);
        self.bound(limit, &part, members, &section.known(self.rows.facts))
    }

    /// The limit of one value or group, SI, with what names stand for there.
    ///
    /// # Errors
    /// It has no value.
    pub fn bound(
        &self,
        limit: &Limit,
        part: &RowGroup<'_>,
        members: &[Member<'_>],
        known: &Known<'_>,
    ) -> Result<f64, Reason> {
        let group = self.rows.with(members);
        OfGroup::new(self.quantity, part, group, known).bound(limit)
    }
}

/// The place of a rule, with the name of its file only, as folders differ between machines.
pub fn rule_place(span: &Span) -> RulePlace {
    RulePlace { file: span.source.file_name(), line: span.line() }
}

/// Why a limit is not met.
fn not_met(quantity: &Quantity, limit: &Limit, result: &StatisticResult) -> Reason {
    let reason = Reason::LimitNotMet(LimitNotMet {
        estimate: result.title.clone(),
        scope: result.scope.told(),
        value: result.value,
        limit: result.limit,
        unit: result.unit.clone(),
        at_least: limit.direction == Direction::AtLeast,
    });
    reason.about(Subject::Quantity, &quantity.id)
}

fn no_limit(reason: Reason) -> Reason {
    Reason::NoLimit { reason: Box::new(reason) }
}

fn unknown_whether(reason: Reason) -> Reason {
    Reason::LimitApplicationUnknown { reason: Box::new(reason) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A limit that is not met, in words.
    fn told(value: f64, limit: f64, at_least: bool) -> String {
        let unit = "kN".to_owned();
        let (estimate, scope) = ("mean".to_owned(), Some("zone 1".to_owned()));
        let (value, limit) = (Some(value), Some(limit));
        Reason::LimitNotMet(LimitNotMet { estimate, scope, value, limit, unit, at_least })
            .text()
            .to_string()
    }

    #[test]
    fn the_excess_is_told_as_far_as_it_says_something() {
        let exceeds = |value: f64, how: &str| {
            assert_eq!(told(value, 10.0, false), format!("mean (zone 1) {how}"));
        };
        exceeds(13.04, "13.0 kN exceeds the limit 10.0 kN by 30 %");
        exceeds(10.5, "10.5 kN exceeds the limit 10.0 kN by 5.0 %");
        exceeds(10.004, "10.004 kN exceeds the limit 10.000 kN by less than 0.1 %");
        exceeds(-12.34, "\u{2212}12.3 kN exceeds in magnitude the limit 10.0 kN by 23 %");
        exceeds(250.0, "250 kN exceeds the limit 10.0 kN, 25 times the limit");
        assert_eq!(told(3.0, 0.0, false), "mean (zone 1) 3.00 kN exceeds the limit 0 kN");
        assert_eq!(told(3.0, 5.0, true), "mean (zone 1) 3.00 kN is below the limit 5.00 kN");
    }
}
