//! The smallest change of a limit that gives another verdict.

use std::sync::Arc;

use super::verdicts::decided;
use crate::certify::Compiled;
use crate::check::{
    diff,
    plan::{Expr, Kind, LimitName, Plan, Quantity, Scalar, Type},
};
use crate::result::{
    Direction, EdgeResult, Outcome, QuantityResult, RulePlace, StatisticResult, impact::Margin,
};
use crate::run::{Evaluated, Given, Judged, overall};
use crate::source::Span;
use crate::units::Dimension;

/// How far beyond a value a limit is put to see whether the verdict is then another one, as a share:
/// far above the rounding of numbers (2e-16) and below any digit that is printed.
const BEYOND: f64 = 1e-9;

/// A limit as it is written, which may be one for each of several zones.
#[derive(Debug)]
pub struct Written {
    pub rule: String,
    pub changed: bool,
    pub quantity: usize,
    span: Span,
    /// Of a limit between two edges, which of them.
    edge: Option<Direction>,
}

/// The limits of a protocol. `changed` gives the name of those that differ from the old one.
pub fn limits(compiled: &Compiled, changed: impl Fn(&Span) -> Option<String>) -> Vec<Written> {
    let mut found: Vec<Written> = Vec::new();
    let blocks = compiled.family.merged.blocks.iter();
    for block in blocks.filter(|block| block.kind.text == "quantity") {
        let named = |quantity: &Quantity| quantity.id == block.name_text();
        let Some(quantity) = compiled.plan.quantities.iter().position(named) else { continue };
        for field in block.fields_named("limit") {
            let span = field.value.span.clone();
            let new = changed(&span);
            let (changed, rule) =
                (new.is_some(), new.unwrap_or_else(|| diff::rule_of(block, field)));
            let limits = &compiled.plan.quantities[quantity].limits;
            let between = limits.iter().any(|one| one.edge && same_place(&one.span, &span));
            let edges = match between {
                true => vec![
                    (", lower edge", Some(Direction::AtLeast)),
                    (", upper edge", Some(Direction::AtMost)),
                ],
                false => vec![("", None)],
            };
            found.extend(edges.into_iter().map(|(which, edge)| {
                let (rule, span) = (format!("{rule}{which}"), span.clone());
                Written { rule, changed, quantity, span, edge }
            }));
        }
    }
    found
}

impl Written {
    /// Where the protocol states it.
    pub fn place(&self) -> RulePlace {
        RulePlace { file: self.span.source.file_name().to_string(), line: self.span.line() }
    }

    /// What is judged by it.
    pub fn rows<'a>(
        &'a self,
        quantities: &'a [QuantityResult],
    ) -> impl Iterator<Item = (&'a StatisticResult, EdgeResult)> {
        let place = self.place();
        let rows = quantities[self.quantity].statistics.iter().filter(move |one| one.rule == place);
        let edges = rows.flat_map(|one| one.compared().into_iter().map(move |edge| (one, edge)));
        edges.filter(|(_, edge)| self.edge.is_none_or(|of| of == edge.direction))
    }
}

pub fn same_place(a: &Span, b: &Span) -> bool {
    (a.start, a.end) == (b.start, b.end) && a.source.name == b.source.name && a.text() == b.text()
}

/// A campaign that was judged.
#[derive(Clone, Copy, Debug)]
pub struct Found<'a> {
    pub plan: &'a Plan,
    pub evaluated: &'a Evaluated,
    pub judged: &'a Judged,
}

impl Found<'_> {
    /// The limit beyond which the verdict is another one, the others unchanged; `None` if it is the
    /// same with any.
    ///
    /// A verdict changes with a limit only where a value meets it. So each value of the quantity is
    /// tried as the limit, the nearest first, as a factor of the limit in force; the verdict beyond
    /// it is judged and not assumed.
    pub fn margin(&self, limit: &Written) -> Option<Margin> {
        let result = &self.judged.quantities[limit.quantity];
        let now = decided(self.plan, self.judged);
        // Of several groups, the limit of the one that is nearest to it.
        let distance = |ratio: Option<f64>| ratio.map_or(f64::INFINITY, |ratio| ratio.ln().abs());
        let in_force = limit.rows(&self.judged.quantities);
        let limits =
            in_force.filter_map(|(one, edge)| Some((edge.limit?, &one.unit, edge.normalised)));
        let (value, unit, _) = limits.min_by(|a, b| distance(a.2).total_cmp(&distance(b.2)))?;
        let mut factors: Vec<f64> = result
            .statistics
            .iter()
            .flat_map(StatisticResult::compared)
            .filter_map(|one| Some((one.value? / one.limit?).abs()))
            .filter(|factor| factor.is_finite() && *factor > 0.0)
            .collect();
        factors.sort_by(|a, b| a.ln().abs().total_cmp(&b.ln().abs()));
        let flips = |factor: &f64| {
            let beyond = [factor * (1.0 - BEYOND), factor * (1.0 + BEYOND)];
            beyond.into_iter().any(|factor| self.with(limit, factor) != now)
        };
        let factor = factors.into_iter().find(flips)?;
        Some(Margin {
            rule: limit.rule.clone(),
            changed: limit.changed,
            value,
            flips_at: value * factor,
            unit: unit.clone(),
        })
    }

    /// The verdict with a limit times a factor. Limits that are shares of it change with it.
    fn with(&self, limit: &Written, factor: f64) -> Outcome {
        let mut plan = self.plan.clone();
        for own in &mut plan.quantities[limit.quantity].limits {
            if same_place(&own.span, &limit.span)
                && limit.edge.is_none_or(|edge| edge == own.direction)
            {
                let place = &own.bound.expr.span;
                let by =
                    Expr::number(Kind::Constant(Scalar::Number(factor)), Dimension::ONE, place);
                let always = Expr {
                    kind: Kind::Constant(Scalar::Flag(true)),
                    ty: Type::Flag,
                    span: place.clone(),
                };
                Arc::make_mut(own).factors.push((by, always));
            }
        }
        let mut quantities: Vec<QuantityResult> = self.judged.quantities.clone();
        let mut all = self.judged.fails.clone();
        let of_another =
            |part: &Expr| matches!(&part.kind, Kind::LimitOf(LimitName { of: Some(_), .. }));
        for (at, quantity) in plan.quantities.iter().enumerate() {
            let refers = quantity.limits.iter().any(|limit| limit.bound.expr.any(&of_another));
            if at == limit.quantity || refers {
                (quantities[at], all[at]) = self.evaluated.judge_quantity(&plan, at);
            }
        }
        let barred = self.judged.barred.clone();
        overall(&plan, &Given { barred, quantities: &quantities, fails: all, sample: None })
    }
}
