//! Finds two limits that apply to the same statistic of a quantity in the same section.

use super::{conditions::impossible, plan::Scope, prelude::*};

/// `zone`: the expression of the zone of a section, where there are zones.
pub fn find(limits: &[Limit], zone: Option<&Expr>, block: &Block, problems: &mut Problems) {
    let mut said = Vec::new();
    for (index, limit) in limits.iter().enumerate() {
        for other in &limits[..index] {
            // The limits made by `for each zone` count as one. A pair that meets in several zones
            // is reported once.
            let pair = (other.span.start, limit.span.start);
            let alike = other.estimate.name == limit.estimate.name
                && other.direction == limit.direction
                && other.scope.each == limit.scope.each;
            if other.span == limit.span || !alike || said.contains(&pair) {
                continue;
            }
            let (a, b) = (scope_condition(&other.scope, zone), scope_condition(&limit.scope, zone));
            let conditions: Vec<(&Expr, bool)> =
                [other.only_when.as_ref(), limit.only_when.as_ref(), a.as_ref(), b.as_ref()]
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
                problem!("limits-overlap", &limit.span, "two limits of `{}` apply to `{}`{place}", limit.estimate.name, block.name_text())
                .also(&other.span, "also applies")
                .help(format!(
                    "give them different zones (`for zones ...`) or conditions that exclude each other (`only when ...`); one that a \
                     variant inherits goes away by `limit {} {}` in its `remove` block",
                    block.name_text(),
                    limit.estimate.name
                )),
            );
        }
    }
}

/// The condition on the section under which the limit applies; `None` for all sections.
fn scope_condition(scope: &Scope, zone: Option<&Expr>) -> Option<Expr> {
    let joined = |operator: Operator, a: Expr, b: Expr| {
        let span = a.span.clone();
        Expr::flag(operator, a, b, &span)
    };
    let is = |zone: &Expr, name: &String| {
        let word = Expr {
            kind: Kind::Constant(Scalar::Word(name.clone())),
            ty: zone.ty.clone(),
            span: zone.span.clone(),
        };
        joined(Operator::Is, zone.clone(), word)
    };
    let zones = zone.and_then(|zone| {
        scope.zones.iter().map(|name| is(zone, name)).reduce(|a, b| joined(Operator::Or, a, b))
    });
    let condition = scope.condition.as_ref().map(|(condition, _)| condition.clone());
    match (zones, condition) {
        (Some(zones), Some(condition)) => Some(joined(Operator::And, zones, condition)),
        (zones, condition) => zones.or(condition),
    }
}

/// Where both limits apply, in words.
fn shared(a: &Scope, b: &Scope) -> String {
    if a.is_all() && b.is_all() {
        return String::new();
    }
    let zones: Vec<&str> = match (a.zones.as_slice(), b.zones.as_slice()) {
        (x, []) | ([], x) => x.iter().map(String::as_str).collect(),
        (x, y) => x.iter().filter(|zone| y.contains(zone)).map(String::as_str).collect(),
    };
    match zones.as_slice() {
        [] => " in the same sections".into(),
        [one] => format!(" in zone {one}"),
        more => format!(" in zones {}", more.join(", ")),
    }
}
