//! Limits in the bounds of others: `limit of std`, `limit of std of Q_max`.

use std::sync::Arc;

use super::{
    estimates::bare,
    evaluate::{number, words},
    plan::Scope as LimitScope,
    prelude::*,
    scope::Bounded,
    values::Values,
};
use crate::metrics::rounded;
use crate::result::{Direction, OUTCOME, Reason};

/// What stands before the name of an estimate for its limit.
pub const LIMIT: &str = "limit";

/// The limits of a quantity, and the unit of its values where these have no error.
#[derive(Debug)]
pub struct Limited {
    pub id: String,
    pub unit: Option<Unit>,
    pub limits: Vec<Limit>,
}

impl Checker<'_> {
    /// Whether `word of std` is the limit of std.
    pub fn is_limit(word: &Phrase, scope: &Scope) -> bool {
        matches!(&word.node, Node::Path(path) if path == LIMIT) && !scope.samples
    }

    /// The limit of an estimate of the same quantity, or of another one.
    pub fn limit_named(&mut self, of: &Phrase, span: &Origin, scope: &Scope) -> Option<Expr> {
        let Some(Bounded { quantity, .. }) = scope.limits.clone() else {
            let says = "a limit can be named in the bound of another one only";
            return self.refuse(error("no-such-limit", says, span));
        };
        let (estimate, other) = match &of.node {
            Node::Reduced(estimate, of) => match self.other_quantity(of, scope) {
                None => return self.no_such_quantity(of, span),
                found => (estimate.as_ref(), found),
            },
            _ => (of, None),
        };
        let block = match other {
            Some((_, at)) => self.blocks.get(at)?.clone(),
            None => self.blocks_of("quantity").find(|block| block.own_name() == quantity)?.clone(),
        };
        let own = scope.values().or(scope.value).map(|of| (of, self.grouped.clone()));
        let (dimension, grouped) = if other.is_some() { self.values_of(&block)? } else { own? };
        let (told, unconfirmed) = (self.problems.0.len(), self.unconfirmed);
        let before = std::mem::replace(&mut self.grouped, grouped);
        let found = self.limited_estimate(&block, estimate, dimension, scope.zone.as_deref());
        self.problems.0.truncate(told);
        (self.grouped, self.unconfirmed) = (before, unconfirmed);
        let Some(found) = found else {
            let (name, of) = (estimate.words(), block.name_text());
            let says = format!("`{of}` has no limit of `{name}` that is one number");
            let limits = block.fields_named("limit");
            let limits =
                limits.filter_map(|field| from_pest::limit(&field.value, &mut Problems::default()));
            let known: Vec<String> = limits.map(|limit| limit.statistic.node).collect();
            let problem = error("no-such-limit", says, span).also(&block, "this quantity");
            return self.refuse(problem.suggest(&name, &known));
        };
        let found = found?;
        let dimension = found.unit.as_ref().map_or(dimension, |unit| unit.dimension);
        let of = other.map(|(at, _)| (at, block.own_name()));
        let kind = Kind::LimitOf(LimitName { estimate: found.name, of });
        Some(Expr::number(kind, dimension, span))
    }

    /// The estimate that a limit of a quantity is of; `Some(None)` where it has an error.
    fn limited_estimate(
        &mut self,
        block: &Block,
        wanted: &Phrase,
        values: Dimension,
        zone: Option<&str>,
    ) -> Option<Option<Estimate>> {
        let (_, wanted) = self.with_statistic(wanted.with(wanted.words()), wanted.clone());
        block.fields_named("limit").find_map(|field| {
            let limit = from_pest::limit(&field.value, self.problems)?;
            let (name, estimate) = self.with_statistic(limit.statistic, limit.estimate);
            let same = estimate == wanted || bare(&name.node) == bare(&wanted.words());
            (same && limit.lower.is_none())
                .then(|| self.estimate(&name, &estimate, Some(values), zone))
        })
    }

    /// Whether a value in a bound, by its name alone, is what once stood for the limit of this name.
    pub fn like_a_limit(&mut self, name: &str, span: &Origin, scope: &Scope) -> bool {
        let limits = scope.limits.as_ref();
        let like = limits.is_some_and(|known| known.estimates.iter().any(|of| of == name));
        if like {
            self.bare_statistic(name, span, scope);
        }
        like
    }

    /// Reports a statistic by itself in a bound, where it is no value or could be taken for a limit.
    pub fn bare_statistic(&mut self, name: &str, span: &Origin, scope: &Scope) -> Option<Expr> {
        let limits = scope.limits.as_ref()?;
        let limited = limits.estimates.iter().any(|of| of == name);
        let says = match (limited, scope.group.is_some()) {
            (true, _) => format!("in a bound, `{name}` can be read as its limit and as its value"),
            (false, true) => return None,
            (false, false) => {
                format!("`{name}` is of all values, and this bound is of a single one")
            }
        };
        let help = match scope.group {
            Some(_) => format!(
                "the limit is `limit of {name}`; the value has a name of its own: an `estimate`"
            ),
            None => format!("a limit is written `limit of {name}`"),
        };
        self.refuse(error("bare-statistic", says, span).help(help))
    }

    /// Every limit that a limit refers to must apply to the same sections. A limit must not depend
    /// on itself. One that is a constant by way of others must be above zero.
    pub fn references(&mut self) {
        let all = std::mem::take(&mut self.limited);
        let all =
            All(all.iter().flat_map(|of| of.limits.iter().map(move |limit| (of, limit))).collect());
        let mut next: Vec<Vec<usize>> = vec![Vec::new(); all.0.len()];
        for (at, (_, limit)) in all.0.iter().enumerate() {
            for (name, span) in referred(&limit.bound.expr) {
                let named: Vec<usize> = all.named(at, &name).collect();
                match named.iter().find(|to| all.same_sections(**to, at)) {
                    Some(to) => next[at].push(*to),
                    None if named.is_empty() => {}
                    None => self.tell(
                        problem!(
                            "no-such-limit",
                            &span,
                            "no limit of `{name}` applies to the same sections"
                        )
                        .also(&all.0[named[0]].1.span, "this one applies to other sections"),
                    ),
                }
            }
            self.amount(&all, at);
        }
        let mut told: Vec<&Span> = Vec::new();
        for (index, (_, limit)) in all.0.iter().enumerate() {
            let Some(way) = way_back(index, &next) else { continue };
            if told.contains(&&limit.span) {
                continue;
            }
            let others: Vec<&Span> = way.iter().map(|&other| &all.0[other].1.span).collect();
            let mut problem = error("limit-loop", "this limit depends on itself", &limit.span);
            for other in &others {
                problem = problem.also(other, "through this one");
            }
            told.extend(others);
            told.push(&limit.span);
            self.tell(problem.help("state one of them as a number"));
        }
    }

    fn amount(&mut self, all: &All<'_>, at: usize) {
        let (of, limit) = all.0[at];
        let names = referred(&limit.bound.expr);
        let (Some((name, place)), true) = (names.first(), limit.direction == Direction::Magnitude)
        else {
            return;
        };
        let value = number(&limit.bound.expr, &Others { all, of: at, depth: 0 });
        let Some(value) = value.ok().filter(|value| *value <= 0.0) else { return };
        let unit = limit.estimate.unit.as_ref().or(of.unit.as_ref());
        let shown = unit.map_or_else(
            || value.to_string(),
            |unit| format!("{}{}", rounded(unit.from_si(value)), unit.suffix()),
        );
        self.tell(
            problem!(
                "out-of-range",
                &limit.bound.expr,
                "a limit must be above zero; `{}` is {shown}",
                words(&limit.bound.expr)
            )
            .also(place, format!("the limit of {name}")),
        );
    }
}

/// Says so behind each limit with a number that is to be confirmed, and behind each that refers to
/// such a limit.
pub fn say_unconfirmed(quantities: &mut [Quantity], words: &str) {
    let mut open = true;
    while std::mem::take(&mut open) {
        let sources: Vec<(String, String)> = quantities
            .iter()
            .flat_map(|quantity| quantity.limits.iter().map(move |limit| (quantity, limit)))
            .filter(|(_, limit)| limit.unconfirmed)
            .map(|(quantity, limit)| (quantity.id.clone(), limit.estimate.name.clone()))
            .collect();
        for quantity in quantities.iter_mut() {
            let id = quantity.id.clone();
            let is_open = |(name, _): &(LimitName, Span)| {
                let of = name.of.as_ref().map_or(&id, |(_, of)| of);
                sources.iter().any(|(source, limit)| source == of && *limit == name.estimate)
            };
            for limit in quantity.limits.iter_mut().filter(|limit| !limit.unconfirmed) {
                if referred(&limit.bound.expr).iter().any(is_open) {
                    Arc::make_mut(limit).unconfirmed = true;
                    open = true;
                }
            }
        }
    }
    let limits = quantities.iter_mut().flat_map(|quantity| &mut quantity.limits);
    for limit in limits.filter(|limit| limit.unconfirmed && limit.estimate.name != OUTCOME) {
        let limit = Arc::make_mut(limit);
        limit.words += words;
        limit.printed += words;
    }
}

/// The limits of all quantities, each with its quantity.
struct All<'a>(Vec<(&'a Limited, &'a Limit)>);

impl All<'_> {
    /// The limits of a name that the limit `from` can refer to.
    fn named<'n>(&'n self, from: usize, name: &'n LimitName) -> impl Iterator<Item = usize> + 'n {
        let id = name.of.as_ref().map_or(&self.0[from].0.id, |(_, id)| id);
        let is = move |(of, limit): &(&Limited, &Limit)| {
            of.id == *id && limit.estimate.name == name.estimate
        };
        self.0.iter().enumerate().filter(move |(_, one)| is(one)).map(|(at, _)| at)
    }

    /// Whether a limit also applies to the rows of another.
    fn same_sections(&self, at: usize, other: usize) -> bool {
        let scope = |at: usize| -> &LimitScope { &self.0[at].1.scope };
        scope(at).is_all() || scope(at).same(scope(other))
    }
}

/// Limits that others refer to, where they are constants.
struct Others<'a> {
    all: &'a All<'a>,
    of: usize,
    depth: usize,
}

impl Values for Others<'_> {
    fn limit_of(&self, name: &LimitName) -> Result<f64, Reason> {
        let unknown = || Reason::LimitUnknown { estimate: name.to_string() };
        let all = self.all;
        let mut found = all.named(self.of, name).filter(|at| all.same_sections(*at, self.of));
        // With several limits, or a factor or condition, the value depends on the vehicle.
        let (Some(of), None) = (found.next(), found.next()) else { return Err(unknown()) };
        let limit = all.0[of].1;
        let varies = !limit.factors.is_empty() || limit.only_when.is_some();
        if self.depth > all.0.len() || varies {
            return Err(unknown());
        }
        number(&limit.bound.expr, &Others { all, of, depth: self.depth + 1 })
    }
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

/// The limits that an expression refers to, with their places.
fn referred(expr: &Expr) -> Vec<(LimitName, Span)> {
    let mut names = Vec::new();
    expr.visit(&mut |part| {
        if let Kind::LimitOf(name) = &part.kind {
            names.push((name.clone(), part.span.span.clone()));
        }
    });
    names
}
