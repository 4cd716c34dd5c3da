//! Conditions on samples, and numbers of the samples that satisfy one: `share where Q < 10 kN`.

use std::collections::BTreeSet;

use super::{prelude::*, scope::Reduce};
use crate::catalog::{CROSSINGS, LONGEST_RUN, Reducer, SHARE_OF_SAMPLES, TOTAL};
use crate::syntax::phrase::Counted;

/// What a name in a phrase is; `None` if it is looked for in the parts of the phrase.
type Test<'a> = dyn Fn(&Node) -> Option<bool> + 'a;

impl Checker<'_> {
    /// Whether a phrase among samples is computed sample by sample; all others are numbers, or
    /// conditions on the section.
    pub fn of_samples(&self, phrase: &Phrase, scope: &Scope) -> bool {
        match &phrase.node {
            // Names are told apart later, with their problems.
            Node::Path(_) | Node::PlaceOf(..) | Node::Reduced(..) | Node::Through(..) => true,
            Node::Negative(_) | Node::Magnitude(_) | Node::Power(..) | Node::Call(..) => true,
            Node::Cases(..) | Node::Table { .. } => true,
            Node::Binary(operator, ..) if !is_condition(*operator) => true,
            Node::Binary(Operator::Is | Operator::IsNot, ..) => false,
            Node::Binary(..) | Node::Not(_) | Node::Near { .. } => {
                self.names_samples(phrase, scope)
            }
            _ => false,
        }
    }

    /// Whether an expression has the samples of a signal or of a side: `Q > 2 * mean of Q`.
    fn names_samples(&self, phrase: &Phrase, scope: &Scope) -> bool {
        self.names_some(phrase, &mut BTreeSet::new(), &|node| match node {
            Node::Path(path) if let Some(argument) = scope.argument(path) => {
                Some(matches!(argument.ty, Type::Samples { .. } | Type::SampleFlags { .. }))
            }
            Node::Path(path) if self.is_signal(path) || Side::named(path).is_some() => Some(true),
            Node::Path(path) if self.is_frequency(path) => Some(true),
            Node::PlaceOf(..) | Node::Through(..) => Some(true),
            Node::Reduced(..) => Some(false),
            _ => None,
        })
    }

    /// Whether an expression uses the samples of a side: `simulated - measured`.
    pub fn names_side(&self, phrase: &Phrase) -> bool {
        self.names_some(phrase, &mut BTreeSet::new(), &|node| match node {
            Node::Path(path) if self.is_signal(path) => Some(false),
            Node::Path(path) if Side::named(path).is_some() => Some(true),
            _ => None,
        })
    }

    /// Whether an expression is about single values of a group: `|value|`, `measured`.
    pub fn names_value(&self, phrase: &Phrase) -> bool {
        self.names_some(phrase, &mut BTreeSet::new(), &|node| match node {
            Node::Path(path) if path == "value" || Side::named(path).is_some() => Some(true),
            _ => None,
        })
    }

    fn names_some(&self, phrase: &Phrase, seen: &mut BTreeSet<String>, test: &Test<'_>) -> bool {
        if let Some(found) = test(&phrase.node) {
            return found;
        }
        let define = match &phrase.node {
            Node::Path(name) => Some(name),
            Node::Call(name, _) => Some(&name.node),
            _ => None,
        };
        if let Some(name) = define
            && let Some(define) = self.names.defines.get(name)
            && seen.insert(name.clone())
            && self.names_some(define, seen, test)
        {
            return true;
        }
        phrase.parts().into_iter().any(|part| self.names_some(part, seen, test))
    }

    /// Warns of `0.5 + 0.5 * sign(x)`, which is 1 where x is not negative and else 0.
    pub fn sign_as_condition(&mut self, left: &Phrase, right: &Phrase, span: &Span) {
        let half = |phrase: &Phrase| matches!(&phrase.node, Node::Number(one) if one.value == 0.5);
        let sign =
            |phrase: &Phrase| matches!(&phrase.node, Node::Call(name, _) if name.node == "sign");
        let scaled = |phrase: &Phrase| match &phrase.node {
            Node::Binary(Operator::Multiply, a, b) => half(a) && sign(b) || sign(a) && half(b),
            _ => false,
        };
        if half(left) && scaled(right) || half(right) && scaled(left) {
            let says = "this is a condition written as a number";
            let help = "write the condition: `share where a > b`, `1 when a > b, otherwise 0`";
            self.tell(warning("sign-as-condition", says, span).help(help));
        }
    }

    /// Reports samples that are missing where all are needed.
    pub fn missing_samples<T>(&mut self, expr: &Expr) -> Option<T> {
        let says = "where no condition holds, this has no samples, and all are needed here";
        let help = "end it with `, otherwise ...`, or take a number of the others: `mean of (Y when Q > 60 kN)`";
        self.refuse(error("missing-samples", says, expr).help(help))
    }

    /// `share where Q < 10 kN`, `longest run where ...`, `crossings where ...`: of the samples of a
    /// section.
    pub fn share_of_samples(
        &mut self,
        counted: Counted,
        condition: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Reduce { axis, side, own, metrics } = scope.reduce?;
        let (taken, over) = self.taken_where(counted, axis, span)?;
        let of_both = self.names_side(condition);
        let own = own.filter(|_| metrics && of_both);
        let condition = self.condition(condition, &mut Scope::samples(&scope.at, own))?;
        let condition = self.at_frequencies(condition)?;
        if !matches!(condition.ty, Type::SampleFlags { .. }) {
            let says = "this condition is not about the samples of a signal";
            let help = "name a signal in it: `share where Q < 10 kN`";
            return self.refuse(error("no-samples", says, &condition).help(help));
        }
        if over.is_some() {
            self.of_record(&condition, span)?;
        }
        self.suits_points(taken, &condition, span)?;
        let along = over.as_ref().map_or(condition.along(axis), Expr::dimension);
        let dimension = taken.gives(Dimension::ONE, along);
        let input = if of_both {
            self.only_both(&condition)?;
            Input::own(Taken::OfBoth(taken), InputSide::Own, span)
        } else {
            Input::own(Taken::Reduced(taken), side, span)
        };
        Some(scope.input(Input { signal: Some(condition), over, ..input }, dimension, span))
    }

    /// How a number is taken of the samples that satisfy a condition, and over what.
    fn taken_where(
        &mut self,
        counted: Counted,
        axis: Dimension,
        span: &Origin,
    ) -> Option<(Reducer, Option<Expr>)> {
        match counted {
            Counted::Share => Some((Reducer::Named(&SHARE_OF_SAMPLES), None)),
            Counted::Count => Some((Reducer::Named(&TOTAL), None)),
            Counted::Crossings => Some((Reducer::Named(&CROSSINGS), None)),
            Counted::LongestRun { in_time: true } if axis != Dimension::TIME => {
                let Some(time) = self.time.clone() else {
                    let says = "the protocol has no field `time`";
                    return self.refuse(error("no-time", says, span));
                };
                let (unit, column) = (time.unit, time.column);
                let dimension = unit.dimension;
                let kind = Kind::Channel { channel: column.clone(), column, unit };
                let time = Expr::samples(kind, dimension, Points::Record, span);
                Some((Reducer::Named(&LONGEST_RUN), Some(time)))
            }
            Counted::LongestRun { .. } => Some((Reducer::Named(&LONGEST_RUN), None)),
        }
    }
}

/// Whether an operator gives a condition.
fn is_condition(operator: Operator) -> bool {
    !matches!(operator, Operator::Add | Operator::Subtract | Operator::Multiply | Operator::Divide)
}
