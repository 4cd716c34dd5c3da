//! A single check of a report, and its outcome.

use crate::problem::{Problem, Problems};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Agrees,
    Differs,
    /// Not checked with what is given, although the report rests on it.
    NotChecked,
    /// Not requested.
    NotAsked,
    /// Requested, but not possible.
    NotPossible,
}

/// Problems as details: the code, what is wrong, and where.
pub fn lines(problems: &Problems) -> Vec<String> {
    let line = |problem: &Problem| match &problem.at {
        Some(at) => format!("{}: {} ({at})", problem.code, problem.says),
        None => format!("{}: {}", problem.code, problem.says),
    };
    problems.0.iter().map(line).collect()
}

/// A single check.
#[derive(Clone, Debug)]
pub struct Check {
    /// `protocol text`, `input files`, ...
    pub name: &'static str,
    pub outcome: Outcome,
    /// The result, one line.
    pub says: String,
    /// All differences, one line each.
    pub details: Vec<String>,
}

impl Check {
    pub fn agrees(name: &'static str, says: impl Into<String>) -> Self {
        Self { name, outcome: Outcome::Agrees, says: says.into(), details: Vec::new() }
    }

    pub fn not_checked(name: &'static str, says: impl Into<String>) -> Self {
        Self { name, outcome: Outcome::NotChecked, says: says.into(), details: Vec::new() }
    }

    pub fn not_asked(name: &'static str, says: impl Into<String>) -> Self {
        Self { name, outcome: Outcome::NotAsked, says: says.into(), details: Vec::new() }
    }

    pub fn not_possible(name: &'static str, says: impl Into<String>) -> Self {
        Self { name, outcome: Outcome::NotPossible, says: says.into(), details: Vec::new() }
    }

    pub fn differs(name: &'static str, says: impl Into<String>, details: Vec<String>) -> Self {
        Self { name, outcome: Outcome::Differs, says: says.into(), details }
    }

    /// Agrees if there are no differences.
    pub fn of(
        name: &'static str,
        agrees: impl Into<String>,
        differs: impl Into<String>,
        details: Vec<String>,
    ) -> Self {
        if details.is_empty() {
            Self::agrees(name, agrees)
        } else {
            Self::differs(name, differs, details)
        }
    }
}
