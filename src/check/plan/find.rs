//! How sections are found in the runs of a campaign, and how many of them are kept.

use super::{Expr, Input};
use crate::source::Span;

/// How sections are found in runs.
#[derive(Clone, Debug)]
pub struct Find {
    /// Distance between two places that are tried; SI of the axis.
    pub step: f64,
    /// The length of a section; without it, the minimum length of its zone.
    pub length: Option<Expr>,
    /// What is highest in the section that is taken of several that overlap; without it, the first
    /// is taken.
    pub prefer: Option<OfSignals>,
    /// Section data, in an order in which each needs only those before it.
    pub data: Vec<FoundDatum>,
    pub conditions: Vec<FindCondition>,
}

/// An expression over values of signals and section data.
#[derive(Clone, Debug)]
pub struct OfSignals {
    pub expr: Expr,
    pub inputs: Vec<Input>,
    pub words: String,
}

/// A section datum that is taken from the signals of the section.
#[derive(Clone, Debug)]
pub struct FoundDatum {
    /// Index into [`Plan::columns`](super::Plan::columns).
    pub column: usize,
    pub of: OfSignals,
}

/// A condition that a found section satisfies.
#[derive(Clone, Debug)]
pub struct FindCondition {
    pub name: String,
    pub title: String,
    pub require: OfSignals,
    /// How far before and behind the section its signals are looked at too; SI of the axis.
    pub lead: f64,
    pub tail: f64,
    pub span: Span,
}

/// A reduction of the sections to those that keep the scatter.
#[derive(Clone, Debug)]
pub struct Keep {
    pub most: usize,
    /// Indices into [`Plan::columns`](super::Plan::columns): so many of each combination of their
    /// words.
    pub each: Vec<usize>,
    pub words: String,
}
