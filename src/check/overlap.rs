//! Finds two limits that would both apply to one statistic of a quantity in one section.

use super::conditions::impossible;
use super::plan::{Expr, Kind, Limit, Operator, Scalar, Scope, Type};
use crate::problem::{Problem, Problems};
use crate::syntax::document::Block;

/// `zone`: the expression for the zone of a section, where there are zones.
pub(super) fn find(limits: &[Limit], zone: Option<&Expr>, block: &Block, problems: &mut Problems) {
    let mut said = Vec::new();
    for (index, limit) in limits.iter().enumerate() {
        for other in &limits[..index] {
            // The parts of one `for each zone` are one limit; a pair of limits that meet in several zones is named once.
            let pair = (other.span.start, limit.span.start);
            if other.span == limit.span || other.statistic != limit.statistic || other.at_least != limit.at_least || said.contains(&pair) {
                continue;
            }
            let (a, b) = (scope_condition(&other.scope, zone), scope_condition(&limit.scope, zone));
            let conditions: Vec<(&Expr, bool)> = [other.only_when.as_ref(), limit.only_when.as_ref(), a.as_ref(), b.as_ref()]
                .into_iter()
                .flatten()
                .map(|condition| (condition, true))
                .collect();
            if impossible(&conditions) {
                continue;
            }
            said.push(pair);
            let place = shared(&other.scope, &limit.scope);
            problems.push(
                Problem::error(
                    "limits-overlap",
                    format!("two limits of `{}` apply to `{}`{place}", limit.statistic.name(), block.name_text()),
                )
                .at(&limit.span)
                .also(&other.span, "also applies")
                .help(format!(
                    "give them different zones (`for zones ...`) or conditions that exclude each other (`only when ...`); one that a \
                     variant inherits goes away by `limit {} {}` in its `remove` block",
                    block.name_text(),
                    limit.statistic.name()
                )),
            );
        }
    }
}

/// What the section must satisfy for the limit to apply; `None` for all sections.
fn scope_condition(scope: &Scope, zone: Option<&Expr>) -> Option<Expr> {
    match scope {
        Scope::All => None,
        Scope::Where(condition, _) => Some((**condition).clone()),
        Scope::Zones(names) => {
            let zone = zone?;
            let is = |name: &String| Expr {
                kind: Kind::Binary(
                    Operator::Is,
                    Box::new(zone.clone()),
                    Box::new(Expr { kind: Kind::Constant(Scalar::Word(name.clone())), ty: zone.ty.clone(), span: zone.span.clone() }),
                ),
                ty: Type::Flag,
                span: zone.span.clone(),
            };
            names.iter().map(is).reduce(|a, b| Expr {
                kind: Kind::Binary(Operator::Or, Box::new(a), Box::new(b)),
                ty: Type::Flag,
                span: zone.span.clone(),
            })
        }
    }
}

/// Where both apply, in words.
fn shared(a: &Scope, b: &Scope) -> String {
    let zones: Vec<&str> = match (a, b) {
        (Scope::Zones(x), Scope::Zones(y)) => x.iter().filter(|zone| y.contains(zone)).map(String::as_str).collect(),
        (Scope::Zones(x), _) | (_, Scope::Zones(x)) => x.iter().map(String::as_str).collect(),
        (Scope::Where(..), _) | (_, Scope::Where(..)) => return " in the same sections".into(),
        _ => return String::new(),
    };
    match zones.as_slice() {
        [] => " in the same sections".into(),
        [one] => format!(" in zone {one}"),
        more => format!(" in zones {}", more.join(", ")),
    }
}
