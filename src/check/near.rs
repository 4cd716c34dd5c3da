//! Conditions of nearness: `a near b within c` as a comparison, and the two numbers that it
//! compares.

use super::{
    expressions::{origin, unlike},
    functions::function,
    prelude::*,
};

/// The two numbers that a condition compares: the value, and its target or bound.
#[derive(Clone, Debug)]
pub struct Near {
    pub holds: Expr,
    pub found: Expr,
    pub expected: Expr,
    pub relation: Relation,
}

impl Checker<'_> {
    /// `a near b within c` means `|a - b| <= c`. If `c` is a plain number and `a` is not, `c` is a
    /// share of `|b|`. `a near b within a factor of c` means equal signs and a ratio of magnitudes
    /// from `1/c` to `c`.
    pub fn near(&mut self, phrase: &Phrase, scope: &mut Scope) -> Option<Near> {
        let Node::Near { value, target, tolerance, by_factor } = &phrase.node else { return None };
        let (value, target, tolerance) =
            (self.expr(value, scope), self.expr(target, scope), self.expr(tolerance, scope));
        let (found, expected, tolerance) = (value?, target?, tolerance?);
        let span = origin(phrase);
        let make = |kind: Kind, ty: Type| Expr { kind, ty, span: span.clone() };
        let pair = |operator, a: &Expr, b: &Expr, ty: Type| {
            make(Kind::Binary(operator, Box::new(a.clone()), Box::new(b.clone())), ty)
        };
        let (a, b, c) = (
            self.number_type(&found)?,
            self.number_type(&expected)?,
            self.number_type(&tolerance)?,
        );
        if a != b {
            return self.refuse(unlike("compared", &found, &expected));
        }
        if (*by_factor && c != Dimension::ONE) || (!by_factor && c != a && c != Dimension::ONE) {
            let wanted = if *by_factor {
                Dimension::ONE.in_words()
            } else {
                format!("{}, or a share such as `10 %`", a.in_words())
            };
            return self.refuse(problem!(
                "unit-mismatch",
                &tolerance.span,
                "expected a tolerance that is {wanted}; this is {}",
                c.in_words()
            ));
        }
        let magnitude = function("magnitude")?;
        let number = Type::Number(a);
        let size = |of: &Expr| make(Kind::Call(magnitude, vec![of.clone()]), number.clone());
        if *by_factor {
            if let Kind::Constant(Scalar::Number(factor)) = tolerance.kind
                && factor < 1.0
            {
                return self.refuse(error(
                    "out-of-range",
                    "the factor must be 1 or more",
                    &tolerance.span,
                ));
            }
            let times = |of: &Expr| pair(Operator::Multiply, &tolerance, &size(of), number.clone());
            let zero = make(Kind::Constant(Scalar::Number(0.0)), number.clone());
            let product = pair(Operator::Multiply, &found, &expected, number.clone());
            let same_sign = pair(Operator::Greater, &product, &zero, Type::Flag);
            let not_above = pair(Operator::LessEqual, &size(&found), &times(&expected), Type::Flag);
            let not_below = pair(Operator::LessEqual, &size(&expected), &times(&found), Type::Flag);
            let sizes = pair(Operator::And, &not_above, &not_below, Type::Flag);
            return Some(Near {
                holds: pair(Operator::And, &same_sign, &sizes, Type::Flag),
                found,
                expected,
                relation: Relation::WithinFactor,
            });
        }
        let off = size(&pair(Operator::Subtract, &found, &expected, number.clone()));
        let room = if c == a {
            tolerance
        } else {
            pair(Operator::Multiply, &tolerance, &size(&expected), number.clone())
        };
        let holds = pair(Operator::LessEqual, &off, &room, Type::Flag);
        Some(Near { holds, found, expected, relation: Relation::Within(room) })
    }

    /// A condition and the comparisons of which it consists: `a near b within c`, `a <= b`, or
    /// several of the latter joined by `and`. Nothing where it has other parts.
    pub fn compared(&mut self, phrase: &Phrase, scope: &mut Scope) -> Option<(Expr, Vec<Near>)> {
        if let Node::Near { .. } = &phrase.node {
            return self.near(phrase, scope).map(|near| (near.holds.clone(), vec![near]));
        }
        let holds = self.expr(phrase, scope)?;
        let mut found = Vec::new();
        let whole = bounds(&holds, &mut found);
        Some((holds, if whole { found } else { Vec::new() }))
    }
}

/// Adds the comparisons with bounds that `and` joins; whether the condition has no other parts.
fn bounds(condition: &Expr, found: &mut Vec<Near>) -> bool {
    match &condition.kind {
        Kind::Binary(Operator::And, left, right) => bounds(left, found) && bounds(right, found),
        Kind::Binary(
            operator @ (Operator::Less
            | Operator::LessEqual
            | Operator::Greater
            | Operator::GreaterEqual),
            left,
            right,
        ) => {
            // `0.02 m/s^2 <= rms`: the number of the protocol is the bound on either side.
            let is_bound = |side: &Expr| matches!(side.kind, Kind::Constant(_));
            let turned = is_bound(left) && !is_bound(right);
            let (value, bound) = if turned { (right, left) } else { (left, right) };
            let less = matches!(operator, Operator::Less | Operator::LessEqual);
            found.push(Near {
                holds: condition.clone(),
                found: (**value).clone(),
                expected: (**bound).clone(),
                relation: if less == turned { Relation::AtLeast } else { Relation::AtMost },
            });
            true
        }
        _ => false,
    }
}
