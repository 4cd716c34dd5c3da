//! Checks limits: statistic, bound, factors, conditions and scope.

use super::{
    evaluate::{number, words},
    groups::Grouped,
    overlap,
    plan::Scope as LimitScope,
    prelude::*,
    printed,
    references::Limited,
    scope::Bounded,
    values::Nothing,
};
use crate::catalog::Best;
use crate::result::Direction;
use crate::syntax::phrase::Limit as Written;

/// What all limits of a quantity have in common.
struct Common<'a> {
    block: &'a Block,
    /// Unit of the compared values and the text that decides their dimension; `None` where the
    /// values have an error.
    unit: Option<(&'a Unit, &'a Span)>,
    /// Best value and the text that decides it, where it is known.
    best: Option<&'a (Best, Span)>,
    /// What its bounds can refer to.
    bounded: Bounded,
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
        // First pass, without messages: what has a limit.
        let mut names = Vec::new();
        for field in &fields {
            if let Some(limit) = from_pest::limit(&field.value, &mut Problems::default()) {
                names.push(self.with_statistic(limit.statistic, limit.estimate).0.node);
            }
        }
        let bounded = Bounded { quantity: block.own_name(), estimates: names };
        let common = Common { block, unit, best, bounded };
        self.grouped = grouped;
        let found: Vec<Option<Vec<Limit>>> =
            fields.iter().map(|field| self.limit(&field.value, &common)).collect();
        let ok = found.iter().all(Option::is_some);
        let limits: Vec<Limit> = found.into_iter().flatten().flatten().collect();
        let zone = self.zone.clone();
        overlap::find(&limits, zone.as_ref(), block, self.problems);
        if ok {
            let (id, unit) = (block.own_name(), common.unit.map(|(unit, _)| unit.clone()));
            self.limited.push(Limited { id, unit, limits: limits.clone() });
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
            let (estimate, scope) = (estimate?, scope?);
            let Some(lower) = written.lower.clone() else {
                limits.push(self.limit_of(&written, &estimate, scope, zone, common)?);
                continue;
            };
            let lower = Written { bound: lower, at_least: true, ..written.clone() };
            let upper = Written { at_most: true, ..written.clone() };
            for edge in [lower, upper] {
                let (scope, zone) = (scope.clone(), zone.clone());
                limits.push(self.limit_of(&edge, &estimate, scope, zone, common)?);
            }
            let edges = limits.last_chunk().map(|[lower, upper]| [&lower.bound, &upper.bound]);
            let constant = edges.map(|edges| edges.map(|edge| number(&edge.expr, &Nothing)));
            if let (Some([Ok(low), Ok(high)]), Some([lower, upper])) = (constant, edges)
                && low >= high
            {
                let says = "the lower edge is not below the upper one";
                let problem = error("empty-range", says, &lower.expr);
                return self.refuse(problem.also(&upper.expr, "the upper edge"));
            }
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
        let scope = || Scope {
            // A limit of every single value may depend on its section; a limit of a statistic has
            // one bound.
            section: matches!(estimate.kind, EstimateKind::Each),
            ..Scope::zone(zone.as_deref())
        };
        let values = common.unit.map(|(unit, _)| unit.dimension);
        let mut names = match scope() {
            each if each.section => Scope { value: values, pair: self.grouped.sides, ..each },
            pooled => pooled.of_group(values),
        };
        names.limits = Some(common.bounded.clone());
        let bound = self.expr(&written.bound, &mut names).map(|expr| {
            let taken = names.group.map_or(names.others, |group| group.taken);
            OfGroup { expr, taken }
        });
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
            let any_sign = direction != Direction::Magnitude || written.lower.is_some();
            let expr = self.suitable_bound(bound.expr, any_sign, of, common)?;
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
        let printed = printed::naming_limit(&words);
        Some(Limit {
            estimate: estimate.clone(),
            direction,
            edge: written.lower.is_some(),
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

    /// The words of a limit with parameters replaced by their values: `2/3 of limit of std` for
    /// `share of limit of std`.
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
        any_sign: bool,
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
            Kind::Constant(Scalar::Number(value)) if value <= 0.0 && !any_sign => {
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
        let keeps_best = |value: f64| match (written.at_least, written.lower.is_some()) {
            (true, _) => best.value() >= value,
            (false, true) => best.value() <= value,
            (false, false) => best.value().abs() <= value,
        };
        let wrong = match (best, written.at_least) {
            _ if written.lower.is_some() => constant.is_some_and(|value| !keeps_best(value)),
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
            _ if written.lower.is_some() => "the best value must lie between the edges".into(),
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
}
