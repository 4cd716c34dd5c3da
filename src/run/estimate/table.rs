//! The table of values: one row for each section, position and record or pair of records.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::check::plan::{Independent, Plan, Scalar};
use crate::run::sections::Unit;

/// One value of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Index into the quantity's positions.
    pub position: usize,
    /// Index into the quantity's values, of which several may apply.
    pub which: usize,
    /// The record, where the campaign has several of a side.
    pub record: Option<Arc<str>>,
    /// The values compared, where rows compare numbers, SI.
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    /// The value that estimates use, SI: a difference, a metric, or the value of one record.
    pub value: f64,
    /// Number of samples or windows.
    pub samples: usize,
}

/// A row with its section.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    pub unit: &'a Unit,
    /// Name of its position.
    pub signal: &'a str,
    pub row: &'a Row,
}

/// The rows of every quantity, or the reason why they cannot be used.
pub type Table<'a> = [Result<&'a [Member<'a>], String>];

/// The index of the independent unit of each member.
pub fn independent(plan: &Plan, members: &[Member<'_>]) -> Vec<usize> {
    let mut names: Vec<String> = Vec::new();
    let mut of_column = |unit: &Unit, index: usize| {
        let name = match &unit.columns[index] {
            Ok(Scalar::Word(word)) => word.clone(),
            Ok(Scalar::Number(number)) => format!("{number:e}"),
            Ok(Scalar::Flag(flag)) => flag.to_string(),
            // A section that does not state its unit counts as part of its site.
            Err(_) => format!("site {}", unit.site),
        };
        names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        })
    };
    let mut sections: Vec<String> = Vec::new();
    let one = |member: &Member<'_>| match plan.independent {
        Independent::Site => member.unit.site,
        Independent::Section => {
            sections.iter().position(|known| *known == member.unit.name).unwrap_or_else(|| {
                sections.push(member.unit.name.clone());
                sections.len() - 1
            })
        }
        Independent::Column(index) => of_column(member.unit, index),
    };
    members.iter().map(one).collect()
}

/// Number of independent units of the members.
pub fn count_independent(plan: &Plan, members: &[Member<'_>]) -> usize {
    independent(plan, members).into_iter().collect::<BTreeSet<_>>().len()
}
