//! Checks limits: statistic, bound, factors, conditions, and to which sections each applies.

use super::evaluate::{Nothing, Values, number, words};
use super::names::normalised;
use super::plan::{Expr, Kind, Limit, Scalar, Scope as LimitScope, Type};
use super::scalars::{Scope, in_words};
use super::{Checker, overlap};
use crate::catalog::{Best, STATISTICS, Statistic};
use crate::metrics::rounded;
use crate::problem::{Problem, Problems};
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{At, Limit as Written, Scope as WrittenScope};
use crate::units::{Dimension, Unit};

/// What all limits of a quantity have in common.
struct Common<'a> {
    block: &'a Block,
    /// Unit of the compared values and where their dimension comes from, if these were understood.
    unit: Option<(&'a Unit, &'a Span)>,
    /// Which values are good and what says so, where that can be told.
    best: Option<&'a (Best, Span)>,
    /// Statistics that have a limit.
    names: Vec<String>,
}

impl Checker<'_> {
    /// The limits of a quantity; of values that were not understood (no `unit`), all but the dimension is checked.
    pub(super) fn limits(&mut self, block: &Block, unit: Option<(&Unit, &Span)>, best: Option<&(Best, Span)>) -> Option<Vec<Limit>> {
        let fields: Vec<&Field> = block.fields_named("limit").collect();
        // A quiet first look for the names that other limits may refer to.
        let quiet = |field: &&Field| from_pest::limit(&field.value, &mut Problems::default()).map(|limit| limit.statistic.node);
        let common = Common { block, unit, best, names: fields.iter().filter_map(quiet).collect() };
        let mut limits = Vec::new();
        let mut ok = true;
        for field in fields {
            match self.limit(&field.value, &common) {
                Some(found) => limits.extend(found),
                None => ok = false,
            }
        }
        let zone = self.zone.clone();
        overlap::find(&limits, zone.as_ref(), block, self.problems);
        if ok {
            self.references(&limits);
            self.amounts(&limits, common.unit.map(|(unit, _)| unit));
        }
        ok.then_some(limits)
    }

    /// One limit, or one for every zone.
    fn limit(&mut self, text: &Text, common: &Common<'_>) -> Option<Vec<Limit>> {
        let written = from_pest::limit(text, self.problems)?;
        let statistic = self.statistic(&written.statistic, text);
        let scope = self.limit_scope(&written.scope, text);
        let (statistic, scope) = (statistic?, scope?);
        if !matches!(written.scope.node, WrittenScope::EachZone) {
            return Some(vec![self.limit_of(&written, statistic, scope, None, text, common)?]);
        }
        let mut limits = Vec::new();
        for zone in self.zone_names.clone() {
            let scope = LimitScope::Zones(vec![zone.clone()]);
            limits.push(self.limit_of(&written, statistic, scope, Some(zone), text, common)?);
        }
        Some(limits)
    }

    fn statistic(&mut self, written: &At<String>, text: &Text) -> Option<Statistic> {
        let found = Statistic::named(&written.node);
        if found.is_none() {
            let span = text.place(written.range.clone());
            let percent: Option<f64> = written.node.strip_prefix('p').and_then(|percent| percent.parse().ok());
            self.problems.push(match percent {
                Some(percent) => {
                    Problem::error("out-of-range", format!("a percentile lies between 0 and 100, this is {percent}")).at(&span)
                }
                None => {
                    let known = STATISTICS.iter().map(|entry| entry.name).chain(["each"]);
                    Problem::error("unknown-statistic", format!("`{}` is no statistic", written.node))
                        .at(&span)
                        .suggest(&written.node, known)
                }
            });
        }
        found
    }

    fn limit_of(
        &mut self,
        written: &Written,
        statistic: Statistic,
        applies: LimitScope,
        zone: Option<String>,
        text: &Text,
        common: &Common<'_>,
    ) -> Option<Limit> {
        let dimension = common.unit.map(|(unit, _)| unit.dimension);
        let names = common.names.iter().filter(|name| **name != written.statistic.node).cloned().collect();
        let scope = || Scope {
            // Every value by itself may have a limit that depends on its section; a statistic over many has one limit.
            section: statistic == Statistic::Each,
            zone: zone.clone(),
            ..Scope::vehicle()
        };
        let mut of_bound = scope();
        of_bound.limits = Some((dimension.unwrap_or(Dimension::ONE), names));
        let bound = self.expr(&written.bound, text, &mut of_bound).and_then(|bound| self.suitable_bound(bound, written.at_least, common));
        let bound = bound.and_then(|bound| self.on_its_side(bound, written, statistic, text, common));
        let mut factors = Vec::new();
        let mut ok = true;
        for (factor, condition) in &written.factors {
            let factor = self.expr(factor, text, &mut scope()).and_then(|factor| self.plain_factor(factor));
            let condition = self.expr(condition, text, &mut scope()).filter(|condition| self.flag_type(condition).is_some());
            match factor.zip(condition) {
                Some(found) => factors.push(found),
                None => ok = false,
            }
        }
        let only_when = match &written.only_when {
            None => None,
            Some(condition) => {
                let vehicle = Scope { zone: zone.clone(), ..Scope::vehicle() };
                let condition = self.expr(condition, text, &mut { vehicle }).filter(|condition| self.flag_type(condition).is_some());
                ok &= condition.is_some();
                condition
            }
        };
        let bound = bound.filter(|_| ok)?;
        let words = self.with_values(&normalised(&text.text[written.statistic.range.end..]));
        Some(Limit {
            statistic,
            ddof: self.ddof,
            at_least: written.at_least,
            bound,
            factors,
            only_when,
            scope: applies,
            words,
            span: text.span.clone(),
        })
    }

    /// The words of a limit with the values of parameters in place of their names: `2/3 of std`, not `share of std`.
    pub(super) fn with_values(&self, words: &str) -> String {
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
            // Right after a number it is a unit.
            let unit = out.trim_end().ends_with(|c: char| c.is_ascii_digit());
            match self.names.parameters.get(word).filter(|_| !unit) {
                Some(parameter) if parameter.value_words.contains([' ', '+']) && matches!(parameter.ty, Type::Number(Dimension::ONE)) => {
                    out.push_str(&format!("({})", parameter.value_words));
                }
                Some(parameter) => out.push_str(&parameter.value_words),
                None => out.push_str(word),
            }
            rest = &rest[name..];
        }
        out
    }

    fn suitable_bound(&mut self, bound: Expr, at_least: bool, common: &Common<'_>) -> Option<Expr> {
        let found = self.number_type(&bound)?;
        if let Some((unit, from)) = common.unit.filter(|(unit, _)| unit.dimension != found) {
            let wanted = unit.dimension.in_words();
            let says = format!("the values of `{}` are {wanted}, this limit is {}", common.block.name_text(), found.in_words());
            let help = if unit.text == "-" { "write the limit without a unit".into() } else { format!("write the limit in {unit}") };
            self.problems.push(Problem::error("unit-mismatch", says).at(&bound.span).label(found.in_words()).also(from, wanted).help(help));
            return None;
        }
        match bound.kind {
            Kind::Constant(Scalar::Number(value)) if value <= 0.0 && !at_least => {
                let says = format!("a limit is above zero, `{}` is not", words(&bound));
                self.problems.push(Problem::error("out-of-range", says).at(&bound.span));
                None
            }
            _ => Some(bound),
        }
    }

    /// A limit leaves the best value in, and what it keeps out is worse.
    fn on_its_side(&mut self, bound: Expr, written: &Written, statistic: Statistic, text: &Text, common: &Common<'_>) -> Option<Expr> {
        let scatter = statistic.of_scatter();
        let (best, from) = match common.best {
            _ if scatter => (Best::Least(0.0), None),
            Some((best, from)) => (*best, Some(from)),
            None => return Some(bound),
        };
        let constant = if let Kind::Constant(Scalar::Number(value)) = bound.kind { Some(value) } else { None };
        let keeps_best = |value: f64| if written.at_least { best.value() >= value } else { best.value().abs() <= value };
        let wrong = match (best, written.at_least) {
            (Best::Least(_), true) | (Best::Greatest(_), false) => true,
            _ => constant.is_some_and(|value| !keeps_best(value)),
        };
        if !wrong {
            return Some(bound);
        }
        let (name, words) = (&written.statistic.node, words(&bound));
        let (of, is) = if scatter {
            (format!("the {}", statistic.title(self.ddof)), best.in_words())
        } else {
            (format!("the values of `{}`", common.block.name_text()), best.in_words())
        };
        let says = format!("this limit is on the wrong side: of {of}, the best is {is}");
        let problem = Problem::error("wrong-side", says).at(&text.place(written.statistic.range.start..written.bound.range.end));
        let problem = match from {
            Some(from) => problem.also(from, format!("best value {is}")),
            None => problem,
        };
        self.problems.push(match (best, written.at_least) {
            (Best::Greatest(best), true) => problem.help(format!("no value is above {best}: the limit must not be")),
            (Best::Greatest(_), false) => problem.help(format!("write `limit {name} at least {words}`")),
            (Best::Least(_), _) => problem.help(format!("write `limit {name} {words}`: values up to it hold")),
            (Best::Near(best), true) if constant.is_some_and(|value| value > 0.0) && best == 0.0 => {
                problem.help(format!("write `limit {name} {words}`: magnitudes up to it hold"))
            }
            (Best::Near(best), at_least) => {
                let side = if at_least { "not above" } else { "not below" };
                problem.help(format!("the best value must hold too: let the limit be {side} {best}"))
            }
        });
        None
    }

    fn plain_factor(&mut self, factor: Expr) -> Option<Expr> {
        let dimension = self.number_type(&factor)?;
        if dimension == Dimension::ONE {
            return Some(factor);
        }
        self.problems.push(
            Problem::error("unit-mismatch", format!("a factor is a plain number, this is {}", in_words(&factor.ty))).at(&factor.span),
        );
        None
    }

    fn limit_scope(&mut self, scope: &At<WrittenScope>, text: &Text) -> Option<LimitScope> {
        match &scope.node {
            WrittenScope::All => Some(LimitScope::All),
            WrittenScope::EachZone if self.zone_names.is_empty() => {
                self.problems.push(Problem::error("unknown-zone", "the protocol has no zones").at(&text.place(scope.range.clone())));
                None
            }
            WrittenScope::EachZone => Some(LimitScope::All),
            WrittenScope::Zones(zones) => {
                let mut found: Vec<String> = Vec::new();
                let mut ok = true;
                for zone in zones {
                    let place = text.place(zone.range.clone());
                    if !self.zone_names.contains(&zone.node) {
                        let known = self.zone_names.clone();
                        let problem = Problem::error("unknown-zone", format!("there is no zone {}", zone.node)).at(&place);
                        self.problems.push(if known.is_empty() {
                            problem.help("the protocol has no zones")
                        } else {
                            problem.help(format!("zones: {}", known.join(", ")))
                        });
                        ok = false;
                    } else if !found.contains(&zone.node) {
                        found.push(zone.node.clone());
                    }
                }
                ok.then_some(LimitScope::Zones(found))
            }
            WrittenScope::Where(condition) => {
                let words = normalised(&text.text[condition.range.clone()]);
                let condition = self.expr(condition, text, &mut Scope::section())?;
                self.flag_type(&condition)?;
                Some(LimitScope::Where(Box::new(condition), words))
            }
        }
    }

    /// A limit that refers to others and follows from constants must come to something above zero.
    fn amounts(&mut self, limits: &[Limit], unit: Option<&Unit>) {
        for limit in limits.iter().filter(|limit| !limit.at_least) {
            let mut names = Vec::new();
            referred(&limit.bound, &mut names);
            let Some((name, place)) = names.first() else { continue };
            let Ok(value) = number(&limit.bound, &Others { limits, of: limit, depth: 0 }) else { continue };
            if value > 0.0 {
                continue;
            }
            let shown = unit.map_or_else(|| value.to_string(), |unit| format!("{}{}", rounded(unit.from_si(value)), unit.suffix()));
            let says = format!("a limit is above zero, `{}` comes to {shown}", words(&limit.bound));
            let help = format!("in a limit, `{name}` stands for the limit of the {name}, not for the value that is found");
            self.problems.push(Problem::error("out-of-range", says).at(&limit.bound.span).also(place, "a limit").help(help));
        }
    }

    /// Every limit that a limit refers to must be there for the same sections, and none may refer to itself in the end.
    fn references(&mut self, limits: &[Limit]) {
        let refers = |limit: &Limit| {
            let mut names = Vec::new();
            referred(&limit.bound, &mut names);
            names
        };
        let target = |limit: &Limit, name: &str| {
            limits.iter().position(|other| other.statistic.name() == name && same_sections(&other.scope, &limit.scope))
        };
        for limit in limits {
            for (name, span) in refers(limit) {
                if target(limit, &name).is_none() {
                    let problem = Problem::error("no-such-limit", format!("no limit of `{name}` applies to the same sections")).at(&span);
                    let other = limits.iter().find(|other| other.statistic.name() == name);
                    self.problems.push(match other {
                        Some(other) => problem.also(&other.span, "this one applies to others"),
                        None => problem,
                    });
                }
            }
        }
        let next: Vec<Vec<usize>> =
            limits.iter().map(|limit| refers(limit).iter().filter_map(|(name, _)| target(limit, name)).collect()).collect();
        let mut told: Vec<&Span> = Vec::new();
        for (index, limit) in limits.iter().enumerate() {
            let Some(way) = way_back(index, &next) else { continue };
            if told.contains(&&limit.span) {
                continue;
            }
            let others: Vec<&Span> = way.iter().map(|&other| &limits[other].span).collect();
            let mut problem = Problem::error("limit-loop", "this limit depends on itself").at(&limit.span);
            for other in &others {
                problem = problem.also(other, "by way of this one");
            }
            told.extend(others);
            told.push(&limit.span);
            self.problems.push(problem);
        }
    }
}

/// Limits that others refer to, as far as they follow from constants.
struct Others<'a> {
    limits: &'a [Limit],
    of: &'a Limit,
    depth: usize,
}

impl Values for Others<'_> {
    fn vehicle(&self, index: usize) -> Result<Scalar, String> {
        Nothing.vehicle(index)
    }
    fn column(&self, index: usize) -> Result<Scalar, String> {
        Nothing.column(index)
    }
    fn extent(&self) -> Result<(f64, f64), String> {
        Nothing.extent()
    }
    fn input(&self, index: usize) -> Result<f64, String> {
        Nothing.input(index)
    }
    fn sides(&self) -> Result<(f64, f64), String> {
        Nothing.sides()
    }
    fn limit_of(&self, statistic: &str) -> Result<f64, String> {
        let unknown = || format!("the limit of {statistic} is not known here");
        let mut found =
            self.limits.iter().filter(|limit| limit.statistic.name() == statistic && same_sections(&limit.scope, &self.of.scope));
        // Of several, or of one with a factor or a condition, the vehicle decides.
        let (Some(limit), None) = (found.next(), found.next()) else { return Err(unknown()) };
        if self.depth > self.limits.len() || !limit.factors.is_empty() || limit.only_when.is_some() {
            return Err(unknown());
        }
        number(&limit.bound, &Others { limits: self.limits, of: limit, depth: self.depth + 1 })
    }
}

/// Whether a limit of the first scope is one for the sections of the second, too.
fn same_sections(a: &LimitScope, b: &LimitScope) -> bool {
    match (a, b) {
        (LimitScope::All, _) => true,
        (LimitScope::Zones(a), LimitScope::Zones(b)) => a == b,
        (LimitScope::Where(_, a), LimitScope::Where(_, b)) => a == b,
        _ => false,
    }
}

/// The limits between one and itself, if it can be reached from itself.
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

/// The statistics whose limits an expression refers to, and where.
fn referred(expr: &Expr, names: &mut Vec<(String, Span)>) {
    expr.visit(&mut |part| {
        if let Kind::LimitOf(name) = &part.kind {
            names.push((name.clone(), part.span.span.clone()));
        }
    });
}
