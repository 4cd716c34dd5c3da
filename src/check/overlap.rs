//! Finds two limits that would both apply to one statistic of a quantity in one zone.

use super::plan::{DatumKind, Expr, Kind, Limit, Operator, Scalar, Scope};
use crate::problem::{Problem, Problems};
use crate::syntax::document::Block;

pub(super) fn find(limits: &[Limit], zones: &[String], block: &Block, problems: &mut Problems) {
    for (index, limit) in limits.iter().enumerate() {
        for other in &limits[..index] {
            if other.statistic != limit.statistic
                || other.at_least != limit.at_least
                || exclusive(other.only_when.as_ref(), limit.only_when.as_ref())
            {
                continue;
            }
            let Some(place) = shared(&other.scope, &limit.scope, zones) else { continue };
            problems.push(
                Problem::error(
                    "limits-overlap",
                    format!("two limits of the {} apply to `{}`{place}", limit.statistic.title(limit.ddof), block.name_text()),
                )
                .at(&limit.span)
                .also(&other.span, "also applies")
                .help("give them different zones (`for zones ...`) or conditions that exclude each other (`only when ...`)"),
            );
        }
    }
}

/// Where both scopes apply, in words; `None` if nowhere.
fn shared(a: &Scope, b: &Scope, zones: &[String]) -> Option<String> {
    let of = |scope: &Scope| match scope {
        Scope::Zones(names) => Some(names.clone()),
        Scope::EachZone => Some(zones.to_vec()),
        Scope::All | Scope::Where(..) => None,
    };
    match (a, b, of(a), of(b)) {
        (Scope::Where(x, _), Scope::Where(y, _), _, _) => (!exclusive(Some(x), Some(y))).then(|| " in the same sections".into()),
        (_, _, Some(x), Some(y)) => {
            let both: Vec<&str> = x.iter().filter(|zone| y.contains(zone)).map(String::as_str).collect();
            (!both.is_empty()).then(|| format!(" in zone {}", both.join(", ")))
        }
        (_, _, Some(x), None) | (_, _, None, Some(x)) => Some(format!(" in zone {}", x.join(", "))),
        _ => Some(String::new()),
    }
}

/// Whether two conditions are known to exclude each other: some part of one contradicts some part of the other in every combination of cases.
fn exclusive(a: Option<&Expr>, b: Option<&Expr>) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return false };
    let (Some(a), Some(b)) = (cases(a, false), cases(b, false)) else { return false };
    a.iter().all(|x| b.iter().all(|y| x.iter().any(|p| y.iter().any(|q| contradict(p, q)))))
}

/// A condition that is true or false by itself.
#[derive(Clone, Debug)]
struct Atom {
    what: String,
    test: Test,
}

#[derive(Clone, Debug)]
enum Test {
    Word(String, bool),
    Flag(bool),
    Number(Operator, f64),
}

/// Alternatives of conjunctions; `None` where there are too many to look at.
fn cases(expr: &Expr, negated: bool) -> Option<Vec<Vec<Atom>>> {
    match &expr.kind {
        Kind::Not(inner) => cases(inner, !negated),
        Kind::Binary(operator @ (Operator::And | Operator::Or), left, right) => {
            let (left, right) = (cases(left, negated)?, cases(right, negated)?);
            if (*operator == Operator::Or) != negated {
                return Some(left.into_iter().chain(right).collect());
            }
            let both: Vec<Vec<Atom>> = left.iter().flat_map(|a| right.iter().map(move |b| a.iter().chain(b).cloned().collect())).collect();
            (both.len() <= 64).then_some(both)
        }
        Kind::Binary(operator, left, right) => {
            let atom = match (&right.kind, operator) {
                (Kind::Constant(Scalar::Word(word)), Operator::Is | Operator::IsNot) => {
                    Test::Word(word.clone(), (*operator == Operator::Is) != negated)
                }
                (Kind::Constant(Scalar::Flag(flag)), Operator::Is | Operator::IsNot) => {
                    Test::Flag(((*operator == Operator::Is) == *flag) != negated)
                }
                (Kind::Constant(Scalar::Number(number)), operator) => {
                    Test::Number(if negated { opposite(*operator)? } else { *operator }, *number)
                }
                _ => return Some(vec![vec![]]),
            };
            Some(vec![vec![Atom { what: what(left)?, test: atom }]])
        }
        _ => Some(vec![what(expr).map(|what| Atom { what, test: Test::Flag(!negated) }).into_iter().collect()]),
    }
}

fn what(expr: &Expr) -> Option<String> {
    match &expr.kind {
        Kind::Vehicle(index) => Some(format!("vehicle {index}")),
        Kind::Column(index) => Some(format!("column {index}")),
        _ => None,
    }
}

fn opposite(operator: Operator) -> Option<Operator> {
    Some(match operator {
        Operator::Less => Operator::GreaterEqual,
        Operator::LessEqual => Operator::Greater,
        Operator::Greater => Operator::LessEqual,
        Operator::GreaterEqual => Operator::Less,
        Operator::Is => Operator::IsNot,
        Operator::IsNot => Operator::Is,
        _ => return None,
    })
}

fn contradict(a: &Atom, b: &Atom) -> bool {
    if a.what != b.what {
        return false;
    }
    match (&a.test, &b.test) {
        (Test::Word(x, true), Test::Word(y, true)) => x != y,
        (Test::Word(x, p), Test::Word(y, q)) => p != q && x == y,
        (Test::Flag(p), Test::Flag(q)) => p != q,
        (Test::Number(p, x), Test::Number(q, y)) => apart(*p, *x, *q, *y) || apart(*q, *y, *p, *x),
        _ => false,
    }
}

/// Whether nothing lies both below the first bound and above the second.
fn apart(below: Operator, x: f64, above: Operator, y: f64) -> bool {
    match (below, above) {
        (Operator::Less, Operator::Greater | Operator::GreaterEqual) | (Operator::LessEqual, Operator::Greater) => x <= y,
        (Operator::LessEqual, Operator::GreaterEqual) => x < y,
        (Operator::Is, Operator::Greater) => x <= y,
        (Operator::Is, Operator::GreaterEqual) => x < y,
        (Operator::Is, Operator::Less) => x >= y,
        (Operator::Is, Operator::LessEqual) => x > y,
        (Operator::Is, Operator::Is) => x != y,
        (Operator::Is, Operator::IsNot) => x == y,
        _ => false,
    }
}

/// The words a datum can be, for zones given as numbers or words.
pub(super) fn datum_words(kind: &DatumKind) -> Vec<String> {
    match kind {
        DatumKind::Words(words) => words.clone(),
        _ => Vec::new(),
    }
}
