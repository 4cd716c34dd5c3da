//! Checks limits: statistic, bound, factors, conditions and scope.

use super::evaluate::{number, words};
use super::groups::Grouped;
use super::plan::Scope as LimitScope;
use super::prelude::*;
use super::resolve::LIMITS_NOT_VALUES;
use super::values::Values;
use super::{overlap, printed};
use crate::catalog::Best;
use crate::metrics::rounded;
use crate::result::{Direction, Reason};
use crate::syntax::phrase::Limit as Written;

/// What all limits of a quantity have in common.
struct Common<'a> {
    block: &'a Block,
    /// Unit of the compared values and the text that decides their dimension; `None` where the
    /// values have an error.
    unit: Option<(&'a Unit, &'a Span)>,
    /// Best value and the text that decides it, where it is known.
    best: Option<&'a (Best, Span)>,
    /// Names of the statistics that have a limit.
    names: Vec<String>,
}

impl Checker<'_> {
    /// Behind a number that is not from a checked source: against the standard, if the protocol
    /// names its source.
    pub fn to_be_confirmed(&self) -> &'static str {
        let named = self.blocks_of("protocol").any(|block| block.field("source").is_some());
        if named { ", to be confirmed against the standard" } else { ", to be confirmed" }
    }

    /// The limits of a quantity. Where the values have an error (no `unit`), everything but the
    /// dimension is checked.
    pub fn limits(
        &mut self,
        block: &Block,
        unit: Option<(&Unit, &Span)>,
        best: Option<&(Best, Span)>,
        grouped: Grouped,
    ) -> Option<Vec<Limit>> {
        let fields: Vec<&Field> = block.fields_named("limit").collect();
        // First pass, without messages: the names that other limits can refer to.
        let mut names = Vec::new();
        for field in &fields {
            if let Some(limit) = from_pest::limit(&field.value, &mut Problems::default()) {
                names.push(self.with_statistic(limit.statistic, limit.estimate).0.node);
            }
        }
        let common = Common { block, unit, best, names };
        self.grouped = grouped;
        let found: Vec<Option<Vec<Limit>>> =
            fields.iter().map(|field| self.limit(&field.value, &common)).collect();
        let ok = found.iter().all(Option::is_some);
        let mut limits: Vec<Limit> = found.into_iter().flatten().flatten().collect();
        say_unconfirmed(&mut limits, self.to_be_confirmed());
        let zone = self.zone.clone();
        overlap::find(&limits, zone.as_ref(), block, self.problems);
        if ok {
            self.references(&limits);
            self.amounts(&limits, common.unit.map(|(unit, _)| unit));
        }
        ok.then_some(limits)
    }

    /// The limits of a field: one, or one for every zone.
    fn limit(&mut self, text: &Text, common: &Common<'_>) -> Option<Vec<Limit>> {
        let written = from_pest::limit(text, self.problems)?;
        let (statistic, estimate) = self.with_statistic(written.statistic, written.estimate);
        let written = Written { statistic, estimate, ..written };
        let dimension = common.unit.map(|(unit, _)| unit.dimension);
        let unconfirmed = self.values.open(&common.block.own_name());
        let scope = self.scope_of(&written.scope);
        let mut limits = Vec::new();
        for (scope, zone) in self.zone_by_zone(scope) {
            self.unconfirmed = unconfirmed;
            let estimate =
                self.estimate(&written.statistic, &written.estimate, dimension, zone.as_deref());
            limits.push(self.limit_of(&written, &estimate?, scope?, zone, common)?);
        }
        Some(limits)
    }

    fn limit_of(
        &mut self,
        written: &Written,
        estimate: &Estimate,
        applies: LimitScope,
        zone: Option<String>,
        common: &Common<'_>,
    ) -> Option<Limit> {
        let text = &written.statistic.text;
        let dimension =
            estimate.unit.as_ref().or(common.unit.map(|(unit, _)| unit)).map(|unit| unit.dimension);
        let others: Vec<String> =
            common.names.iter().filter(|name| **name != written.statistic.node).cloned().collect();
        let scope = || Scope {
            // A limit of every single value may depend on its section; a limit of a statistic has
            // one bound.
            section: matches!(estimate.kind, EstimateKind::Each),
            ..Scope::zone(zone.as_deref())
        };
        let values = common.unit.map(|(unit, _)| unit.dimension);
        let mut of_bound = scope();
        of_bound.limits = Some((dimension.unwrap_or(Dimension::ONE), others.clone()));
        of_bound.own_values = values;
        let bound = if of_bound.section {
            (of_bound.value, of_bound.pair) = (values, self.grouped.sides);
            let expr = self.expr(&written.bound, &mut of_bound);
            expr.map(|expr| OfGroup { expr, taken: of_bound.others })
        } else {
            self.of_group(&written.bound, None, &of_bound)
        };
        let direction = match (written.at_least, written.at_most) {
            (true, _) => Direction::AtLeast,
            (_, true) => Direction::AtMost,
            _ => Direction::Magnitude,
        };
        let bound = bound.and_then(|bound| {
            let of = estimate.unit.as_ref().zip(Some(&text.span)).or(common.unit);
            if applies.is_all() {
                self.of_own_values(estimate, &bound, common.block);
            }
            let signed = matches!(common.best, Some((Best::Near(best), _)) if *best == 0.0);
            if signed && direction == Direction::Magnitude {
                self.signed_estimate(estimate, &written.statistic);
            }
            let expr = self.suitable_bound(bound.expr, written.at_least, of, common)?;
            self.share_above_one(estimate, &expr)?;
            Some(OfGroup { expr: self.on_its_side(expr, written, estimate, common)?, ..bound })
        });
        let factors = all(written.factors.iter().map(|(factor, condition)| {
            let factor =
                self.expr(factor, &mut scope()).and_then(|factor| self.plain_factor(factor));
            factor.zip(self.condition(condition, &mut scope()))
        }));
        let only_when = written.only_when.as_ref();
        let only_when = if_written(
            only_when.map(|when| self.condition(when, &mut Scope::zone(zone.as_deref()))),
        );
        let words = self.with_values(&normalised(&text.text[written.statistic.range.end..]));
        let printed = printed::naming_limit(&words, &others);
        Some(Limit {
            estimate: estimate.clone(),
            direction,
            bound: bound?,
            factors: factors?,
            only_when: only_when?,
            scope: applies,
            words,
            printed,
            unconfirmed: self.unconfirmed,
            span: text.span.clone(),
        })
    }

    /// The words of a limit with parameters replaced by their values: `2/3 of std` for `share of
    /// std`.
    pub fn with_values(&self, words: &str) -> String {
        let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let mut out = String::new();
        let mut rest = words;
        while !rest.is_empty() {
            let name = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
            if name == 0 {
                let next = rest.find(is_name).unwrap_or(rest.len());
                out.push_str(&rest[..next]);
                rest = &rest[next..];
                continue;
            }
            let word = &rest[..name];
            // After a number, the name is a unit.
            let unit = out.trim_end().ends_with(|c: char| c.is_ascii_digit());
            match self.names.parameters.get(word).filter(|_| !unit) {
                Some(parameter)
                    if parameter.value_words.contains([' ', '+'])
                        && matches!(parameter.ty, Type::Number(Dimension::ONE)) =>
                {
                    out.push_str(&format!("({})", parameter.value_words));
                }
                Some(parameter) => out.push_str(&parameter.value_words),
                None => out.push_str(word),
            }
            rest = &rest[name..];
        }
        out
    }

    fn suitable_bound(
        &mut self,
        bound: Expr,
        at_least: bool,
        of: Option<(&Unit, &Span)>,
        common: &Common<'_>,
    ) -> Option<Expr> {
        let found = self.number_type(&bound)?;
        if let Some((unit, from)) = of.filter(|(unit, _)| unit.dimension != found) {
            let wanted = unit.dimension.in_words();
            let of_values = common.unit.is_some_and(|(of, _)| of == unit);
            let what = if of_values {
                format!("the values of `{}` are", common.block.name_text())
            } else {
                "this estimate is".into()
            };
            let help = if unit.text == "-" {
                "write the limit without unit".into()
            } else {
                Unit::meant(bound.span.text(), unit.dimension)
                    .unwrap_or_else(|| format!("write the limit in {unit}"))
            };
            return self.refuse(
                problem!(
                    "unit-mismatch",
                    &bound,
                    "{what} {wanted}, this limit is {}",
                    found.in_words()
                )
                .label(found.in_words())
                .also(from, wanted)
                .help(help),
            );
        }
        match bound.kind {
            Kind::Constant(Scalar::Number(value)) if value <= 0.0 && !at_least => {
                self.refuse(problem!(
                    "out-of-range",
                    &bound,
                    "a limit must be above zero; `{}` is not",
                    words(&bound)
                ))
            }
            _ => Some(bound),
        }
    }

    /// Checks that the limit admits the best value and excludes worse ones.
    fn on_its_side(
        &mut self,
        bound: Expr,
        written: &Written,
        estimate: &Estimate,
        common: &Common<'_>,
    ) -> Option<Expr> {
        let scatter = estimate.of_scatter;
        let of_values = matches!(estimate.kind, EstimateKind::Each)
            || estimate.statistic().is_some()
            || estimate.weighted().is_some();
        let (best, from) = match common.best {
            _ if scatter => (Best::Least(0.0), None),
            Some((best, from)) if of_values => (*best, Some(from)),
            _ => return Some(bound),
        };
        let constant =
            if let Kind::Constant(Scalar::Number(value)) = bound.kind { Some(value) } else { None };
        let keeps_best = |value: f64| {
            if written.at_least { best.value() >= value } else { best.value().abs() <= value }
        };
        let wrong = match (best, written.at_least) {
            (Best::Least(_), true) | (Best::Greatest(_), false) => true,
            _ => constant.is_some_and(|value| !keeps_best(value)),
        };
        if !wrong {
            return Some(bound);
        }
        let (name, words) = (&written.statistic.node, words(&bound));
        let is = best.in_words();
        let of = if scatter {
            format!("the {}", estimate.title)
        } else {
            format!("the values of `{}`", common.block.name_text())
        };
        let problem = problem!(
            "wrong-side",
            &written.statistic.to(&written.bound, ()),
            "this limit is on the wrong side: for {of}, the best value is {is}"
        );
        let problem = problem.also_if(from, format!("best value {is}"));
        self.refuse(problem.help(match (best, written.at_least) {
            (Best::Greatest(best), true) => {
                format!("no value is above {best}, so the limit must not be either")
            }
            (Best::Greatest(_), false) => format!("write `limit {name} at least {words}`"),
            (Best::Least(_), _) => {
                format!("write `limit {name} {words}`: values up to it are accepted")
            }
            (Best::Near(0.0), true) if constant.is_some_and(|value| value > 0.0) => {
                format!("write `limit {name} {words}`: magnitudes up to it are accepted")
            }
            (Best::Near(best), at_least) => {
                let side = if at_least { "not above" } else { "not below" };
                format!("the limit must admit the best value: write a limit {side} {best}")
            }
        }))
    }

    fn plain_factor(&mut self, factor: Expr) -> Option<Expr> {
        let dimension = self.number_type(&factor)?;
        if dimension == Dimension::ONE {
            return Some(factor);
        }
        self.refuse(problem!(
            "unit-mismatch",
            &factor,
            "a factor must be a plain number, this is {}",
            factor.ty.in_words()
        ))
    }

    /// A limit that refers to other limits and is a constant must be above zero.
    fn amounts(&mut self, limits: &[Limit], unit: Option<&Unit>) {
        for limit in limits.iter().filter(|limit| limit.direction != Direction::AtLeast) {
            let names = referred(&limit.bound.expr);
            let Some((name, place)) = names.first() else { continue };
            let value = number(&limit.bound.expr, &Others { limits, of: limit, depth: 0 });
            let Some(value) = value.ok().filter(|value| *value <= 0.0) else { continue };
            let shown = unit.map_or_else(
                || value.to_string(),
                |unit| format!("{}{}", rounded(unit.from_si(value)), unit.suffix()),
            );
            let help = format!(
                "in a limit, `{name}` stands for the limit of the {name}, not for its value"
            );
            self.tell(
                problem!(
                    "out-of-range",
                    &limit.bound.expr,
                    "a limit must be above zero; `{}` is {shown}",
                    words(&limit.bound.expr)
                )
                .also(place, "a limit")
                .help(help),
            );
        }
    }

    /// Every limit that a limit refers to must apply to the same sections. A limit must not depend
    /// on itself.
    fn references(&mut self, limits: &[Limit]) {
        let refers = |limit: &Limit| referred(&limit.bound.expr);
        let target = |limit: &Limit, name: &str| {
            limits.iter().position(|other| {
                other.estimate.name == name && same_sections(&other.scope, &limit.scope)
            })
        };
        for limit in limits {
            for (name, span) in refers(limit) {
                if target(limit, &name).is_none() {
                    let other = limits.iter().find(|other| other.estimate.name == name);
                    self.tell(
                        problem!(
                            "no-such-limit",
                            &span,
                            "no limit of `{name}` applies to the same sections"
                        )
                        .also_if(
                            other.map(|other| &other.span),
                            "this one applies to other sections",
                        ),
                    );
                }
            }
        }
        let next: Vec<Vec<usize>> = limits
            .iter()
            .map(|limit| refers(limit).iter().filter_map(|(name, _)| target(limit, name)).collect())
            .collect();
        let mut told: Vec<&Span> = Vec::new();
        for (index, limit) in limits.iter().enumerate() {
            let Some(way) = way_back(index, &next) else { continue };
            if told.contains(&&limit.span) {
                continue;
            }
            let others: Vec<&Span> = way.iter().map(|&other| &limits[other].span).collect();
            let mut problem = error("limit-loop", "this limit depends on itself", &limit.span);
            for other in &others {
                problem = problem.also(other, "through this one");
            }
            told.extend(others);
            told.push(&limit.span);
            self.tell(problem.help(LIMITS_NOT_VALUES));
        }
    }
}

/// Says so behind each limit with a number that is to be confirmed, and behind each that refers to
/// such a limit.
fn say_unconfirmed(limits: &mut [Limit], words: &str) {
    // As often as there are limits, since one may refer to another by way of all others.
    for _ in 0..limits.len() {
        let sources: Vec<String> = limits
            .iter()
            .filter(|limit| limit.unconfirmed)
            .map(|limit| limit.estimate.name.clone())
            .collect();
        for limit in limits.iter_mut() {
            let names = referred(&limit.bound.expr);
            limit.unconfirmed |= names.iter().any(|(name, _)| sources.contains(name));
        }
    }
    for limit in limits.iter_mut().filter(|limit| limit.unconfirmed) {
        limit.words += words;
        limit.printed += words;
    }
}

/// Limits that others refer to, where they are constants.
struct Others<'a> {
    limits: &'a [Limit],
    of: &'a Limit,
    depth: usize,
}

impl Values for Others<'_> {
    fn limit_of(&self, statistic: &str) -> Result<f64, Reason> {
        let unknown = || Reason::LimitUnknown { estimate: statistic.into() };
        let mut found = self.limits.iter().filter(|limit| {
            limit.estimate.name == statistic && same_sections(&limit.scope, &self.of.scope)
        });
        // With several limits, or a factor or condition, the value depends on the vehicle.
        let (Some(limit), None) = (found.next(), found.next()) else { return Err(unknown()) };
        if self.depth > self.limits.len() || !limit.factors.is_empty() || limit.only_when.is_some()
        {
            return Err(unknown());
        }
        number(&limit.bound.expr, &Others { limits: self.limits, of: limit, depth: self.depth + 1 })
    }
}

/// Whether a limit of the first scope also applies to the rows of the second.
fn same_sections(a: &LimitScope, b: &LimitScope) -> bool {
    a.is_all() || a.same(b)
}

/// The limits on a path from one limit back to itself, if there is one.
fn way_back(from: usize, next: &[Vec<usize>]) -> Option<Vec<usize>> {
    let mut before: Vec<Option<usize>> = vec![None; next.len()];
    let mut open = vec![from];
    while let Some(at) = open.pop() {
        for &to in &next[at] {
            if to == from {
                let mut way = Vec::new();
                let mut step = at;
                while step != from {
                    way.push(step);
                    step = before[step]?;
                }
                way.reverse();
                return Some(way);
            }
            if before[to].is_none() {
                before[to] = Some(at);
                open.push(to);
            }
        }
    }
    None
}

/// The statistics whose limits an expression refers to, with their places.
fn referred(expr: &Expr) -> Vec<(String, Span)> {
    let mut names = Vec::new();
    expr.visit(&mut |part| {
        if let Kind::LimitOf(name) = &part.kind {
            names.push((name.clone(), part.span.span.clone()));
        }
    });
    names
}
