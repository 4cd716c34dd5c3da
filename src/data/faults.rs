//! The first problems of a file and the number of further ones: a file in a wrong format has one in
//! every row.

use crate::data::prelude::*;

/// Maximum number of problems shown per file.
const SHOWN: usize = 5;

#[derive(Debug)]
pub struct Faults<'a> {
    file: &'a str,
    problems: Vec<Problem>,
    more: usize,
}

impl<'a> Faults<'a> {
    pub fn new(file: &'a str) -> Self {
        Self { file, problems: Vec::new(), more: 0 }
    }

    /// Formats the problem only if it is shown.
    pub fn push(&mut self, problem: impl FnOnce() -> Problem) {
        if self.problems.len() < SHOWN { self.problems.push(problem()) } else { self.more += 1 }
    }

    pub fn is_empty(&self) -> bool {
        self.problems.is_empty()
    }

    pub fn into_vec(mut self) -> Vec<Problem> {
        if self.more > 0 {
            let word = if self.more == 1 { "problem" } else { "problems" };
            self.problems.push(problem!(
                "more-problems",
                "and {} more {word} in `{}`",
                self.more,
                self.file
            ));
        }
        self.problems
    }

    /// The value if there were no problems.
    pub fn finish<T>(self, value: T) -> Result<T, Vec<Problem>> {
        if self.is_empty() { Ok(value) } else { Err(self.into_vec()) }
    }

    pub fn add_to(self, problems: &mut Problems) {
        problems.add(self.into_vec());
    }
}
