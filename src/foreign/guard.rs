//! What readers of binary files answer that is no table: a panic of a reader of another project, a
//! file that is damaged, and one that unpacks to too much.

use std::fmt::Display;

use super::load::{Budget, most_unpacked};
use super::{Input, Read};
use crate::data::record::guarded;
use crate::problem::Problem;

/// Calls a reader of another project.
///
/// # Errors
/// `format-damaged` if it panics: its authors did not expect the content.
pub fn call(
    input: &Input<'_>,
    reader: impl FnOnce(&Input<'_>) -> Result<Read, Vec<Problem>>,
) -> Result<Read, Vec<Problem>> {
    guarded(|| Ok(reader(input))).unwrap_or_else(|why| Err(input.damaged("the file", why).into()))
}

/// Why a part of a file is not read.
pub enum Failure {
    /// It is not as its format prescribes.
    Damaged(String),
    /// It unpacks to more than [`most_unpacked`].
    Unpacked,
    Problem(Problem),
}

impl From<String> for Failure {
    fn from(why: String) -> Self {
        Self::Damaged(why)
    }
}

impl From<&str> for Failure {
    fn from(why: &str) -> Self {
        Self::Damaged(why.into())
    }
}

impl From<Problem> for Failure {
    fn from(problem: Problem) -> Self {
        Self::Problem(problem)
    }
}

/// Words of readers for what they do not know; a file with it may be sound.
const UNKNOWN: [&str; 4] =
    ["unsupported", "not supported", "not yet implemented", "disabled feature"];

/// Longest reason of a reader in a message.
const LONGEST_REASON: usize = 200;

impl<'a> Input<'a> {
    /// Counts the values of the file.
    pub fn budget(&self) -> Budget<'a> {
        Budget::new(self.bytes.len(), self.shown)
    }

    /// A file that is not as its format prescribes, at a place in it, or that has what a reader does
    /// not know.
    pub fn damaged(&self, place: &str, why: impl Display) -> Problem {
        let why = why.to_string();
        let why: String = why
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .take(LONGEST_REASON)
            .collect();
        let (shown, title) = (self.shown, self.format.title());
        let lower = why.to_lowercase();
        if UNKNOWN.iter().any(|word| lower.contains(word)) {
            let says = format!("`{shown}`, {title}, has what is not read, at {place}: {why}");
            let help =
                "save it in another way, for example without compression, or as Parquet or CSV";
            return Problem::error("format-not-read", says).help(help);
        }
        let says = format!("`{shown}`, {title} is damaged or not complete, at {place}: {why}");
        Problem::error("format-damaged", says).help(
            "copy or export the file again; if it opens in its own program, export it there as CSV",
        )
    }

    /// The problem of a part of the file, at a place in it.
    pub fn failed(&self, place: &str, failure: Failure) -> Problem {
        match failure {
            Failure::Damaged(why) => self.damaged(place, why),
            Failure::Problem(problem) => problem,
            Failure::Unpacked => {
                let says = format!(
                    "{place} of `{}` unpacks to more than {} MB, the maximum for a file of its size",
                    self.shown,
                    most_unpacked(self.bytes.len()) >> 20
                );
                Problem::error("too-many-values", says)
                    .help("export it again with fewer channels, or without compression")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Format, Options, Want};
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        let (bytes, options) = (bytes::Bytes::new(), Options::default());
        let (format, want) = (Format::Mdf4, Want::Values);
        let input = Input { bytes: &bytes, shown: "f", options: &options, format, want };
        let found = call(&input, |_| panic!("index out of bounds"));
        assert!(found.is_err_and(|problems| problems[0].code == "format-damaged"));
        assert!(call(&input, |_| Ok(Read::default())).is_ok());
    }
}
