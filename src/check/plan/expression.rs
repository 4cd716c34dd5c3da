//! Checked expressions.

use std::ops::Deref;
use std::sync::Arc;

use super::Scalar;
use crate::catalog::Function;
use crate::source::Span;
use crate::units::Dimension;

/// Where an expression is written, and its words. In YAML, the place of a part of a field is not
/// always known, but its words are.
#[derive(Clone, Debug)]
pub struct Origin {
    pub span: Span,
    pub words: Arc<str>,
}

impl Deref for Origin {
    type Target = Span;
    fn deref(&self) -> &Span {
        &self.span
    }
}

/// A typed expression over numbers, words and conditions.
#[derive(Clone, Debug)]
pub struct Expr {
    pub kind: Kind,
    pub ty: Type,
    pub span: Origin,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    Number(Dimension),
    /// One of these words; empty for a word by itself.
    Word(Vec<String>),
    Flag,
}

#[derive(Clone, Debug)]
pub enum Kind {
    Constant(Scalar),
    /// Index into [`Plan::vehicle`](super::Plan::vehicle).
    Vehicle(usize),
    /// Index into [`Plan::columns`](super::Plan::columns).
    Column(usize),
    /// Start, end or length of the section on the axis.
    Start,
    End,
    /// A value taken from a signal or from a group: index into the list stored with the expression.
    Input(usize),
    Simulated,
    Measured,
    /// The limit of another statistic of the same quantity and scope.
    LimitOf(String),
    Negative(Box<Expr>),
    Not(Box<Expr>),
    Power(Box<Expr>, i8),
    Binary(Operator, Box<Expr>, Box<Expr>),
    Call(&'static Function, Vec<Expr>),
    /// The value of the first condition that holds, else the last value.
    Cases(Vec<(Expr, Expr)>, Option<Box<Expr>>),
}

impl Expr {
    /// Visits every part, the whole expression first.
    pub fn visit(&self, see: &mut impl FnMut(&Expr)) {
        see(self);
        match &self.kind {
            Kind::Negative(inner) | Kind::Not(inner) | Kind::Power(inner, _) => inner.visit(see),
            Kind::Binary(_, left, right) => {
                left.visit(see);
                right.visit(see);
            }
            Kind::Call(_, arguments) => arguments.iter().for_each(|argument| argument.visit(see)),
            Kind::Cases(arms, otherwise) => {
                for (value, condition) in arms {
                    value.visit(see);
                    condition.visit(see);
                }
                if let Some(value) = otherwise {
                    value.visit(see);
                }
            }
            _ => {}
        }
    }
}

pub use crate::syntax::phrase::Operator;
