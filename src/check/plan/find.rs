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
    pub prefer: Option<OfSection>,
    /// Section data, in an order in which each needs only those before it.
    pub data: Vec<DerivedDatum>,
    pub conditions: Vec<FindCondition>,
}

/// An expression over section data and values of signals.
#[derive(Clone, Debug)]
pub struct OfSection {
    pub expr: Expr,
    pub inputs: Vec<Input>,
    pub words: String,
}

/// A section datum that follows from others, or from the signals of a found section.
#[derive(Clone, Debug)]
pub struct DerivedDatum {
    /// Index into [`Plan::columns`](super::Plan::columns).
    pub column: usize,
    pub of: OfSection,
}

/// A condition that a found section satisfies.
#[derive(Clone, Debug)]
pub struct FindCondition {
    pub name: String,
    pub title: String,
    pub require: OfSection,
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
