//! What is known of conditions without a campaign: whether they exclude each other, and whether one
//! of them always holds.

use super::{evaluate::shape, prelude::*};

/// Largest number of combinations of tests that are examined.
const MOST: usize = 256;

/// Whether these conditions can certainly never hold together. With `false` beside it, a condition
/// is taken as not satisfied.
pub fn impossible(conditions: &[(&Expr, bool)]) -> bool {
    let mut all: Vec<Vec<Test>> = vec![Vec::new()];
    for (condition, holds) in conditions {
        let Some(alternatives) = alternatives(condition, !holds) else { continue };
        // A condition that is left out weakens the rest: a contradiction without it is a
        // contradiction with it.
        if all.len() * alternatives.len() <= MOST {
            all = product(&all, &alternatives);
        }
    }
    all.iter().all(|together| contradictory(together))
}

fn product(left: &[Vec<Test>], right: &[Vec<Test>]) -> Vec<Vec<Test>> {
    left.iter()
        .flat_map(|a| right.iter().map(move |b| a.iter().chain(b).cloned().collect()))
        .collect()
}

/// A test of one value. The value is identified by the structure of its expression.
#[derive(Clone, Debug)]
struct Test {
    what: String,
    is: Is,
}

#[derive(Clone, Debug)]
enum Is {
    /// The value is one of these words.
    Words(Vec<String>),
    /// This word, or any other, of which not all are known.
    Name(bool, String),
    Flag(bool),
    Number(Operator, f64),
}

/// A condition as alternatives, each a list of tests that hold together; `None` where there are too
/// many.
fn alternatives(expr: &Expr, negated: bool) -> Option<Vec<Vec<Test>>> {
    match &expr.kind {
        Kind::Constant(Scalar::Flag(flag)) => {
            Some(if *flag == negated { Vec::new() } else { vec![Vec::new()] })
        }
        Kind::Not(inner) => alternatives(inner, !negated),
        Kind::Binary(operator @ (Operator::And | Operator::Or), left, right) => {
            let (left, right) = (alternatives(left, negated)?, alternatives(right, negated)?);
            if (*operator == Operator::Or) != negated {
                return Some(left.into_iter().chain(right).collect());
            }
            (left.len() * right.len() <= MOST).then(|| product(&left, &right))
        }
        Kind::Binary(operator, left, right) => {
            Some(vec![test(*operator, left, right, negated).into_iter().collect()])
        }
        _ => Some(vec![vec![Test { what: shape(expr), is: Is::Flag(!negated) }]]),
    }
}

/// `None` where the condition gives no test of a single value.
fn test(operator: Operator, left: &Expr, right: &Expr, negated: bool) -> Option<Test> {
    let (what, constant, operator) = match (&left.kind, &right.kind) {
        (_, Kind::Constant(constant)) => (left, constant, operator),
        (Kind::Constant(constant), _) => (right, constant, turned(operator)),
        _ => return None,
    };
    let operator = if negated { opposite(operator)? } else { operator };
    let is = match (constant, &what.ty) {
        (Scalar::Word(word), Type::Word(words)) if words.is_empty() => {
            Is::Name(operator == Operator::Is, word.clone())
        }
        (Scalar::Word(word), Type::Word(words)) => Is::Words(
            words
                .iter()
                .filter(|other| (*other == word) == (operator == Operator::Is))
                .cloned()
                .collect(),
        ),
        (Scalar::Flag(flag), _) => Is::Flag((operator == Operator::Is) == *flag),
        (Scalar::Number(number), _) => Is::Number(operator, *number),
        _ => return None,
    };
    Some(Test { what: shape(what), is })
}

/// `a < x` as `x > a`.
fn turned(operator: Operator) -> Operator {
    match operator {
        Operator::Less => Operator::Greater,
        Operator::LessEqual => Operator::GreaterEqual,
        Operator::Greater => Operator::Less,
        Operator::GreaterEqual => Operator::LessEqual,
        same => same,
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

fn contradictory(together: &[Test]) -> bool {
    together.iter().enumerate().any(|(index, test)| {
        let same = || together[index..].iter().filter(|other| other.what == test.what);
        match &test.is {
            Is::Words(words) => !words.iter().any(|word| {
                same().all(|other| !matches!(&other.is, Is::Words(words) if !words.contains(word)))
            }),
            Is::Name(is, name) => same().any(|other| match &other.is {
                Is::Name(other_is, other) => {
                    (*is && *other_is && name != other) || (is != other_is && name == other)
                }
                _ => false,
            }),
            Is::Flag(flag) => {
                same().any(|other| matches!(other.is, Is::Flag(other) if other != *flag))
            }
            Is::Number(operator, number) => same().any(|other| match other.is {
                Is::Number(o, n) => {
                    apart(*operator, *number, o, n) || apart(o, n, *operator, *number)
                }
                _ => false,
            }),
        }
    })
}

/// Whether nothing satisfies both `x below a` and `x above b`.
fn apart(below: Operator, a: f64, above: Operator, b: f64) -> bool {
    match (below, above) {
        (Operator::Less, Operator::Greater | Operator::GreaterEqual)
        | (Operator::LessEqual, Operator::Greater) => a <= b,
        (Operator::LessEqual, Operator::GreaterEqual) => a < b,
        (Operator::Is, Operator::Greater) => a <= b,
        (Operator::Is, Operator::GreaterEqual) => a < b,
        (Operator::Is, Operator::Less) => a >= b,
        (Operator::Is, Operator::LessEqual) => a > b,
        (Operator::Is, Operator::Is) => a != b,
        (Operator::Is, Operator::IsNot) => a == b,
        _ => false,
    }
}
