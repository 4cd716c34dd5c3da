//! A row that is not as it should be: read with patience, and told what is wrong.

use super::rows::Sink;
use crate::data::cells::{self, StrayQuote};
use crate::problem::Problem;
use crate::source::{Source, Span};

/// Enough to see what is wrong with a file; the rest is counted.
const SHOWN: usize = 5;

/// The first problems of a file and the number of the others.
pub(super) struct Faults<'a> {
    shown: &'a str,
    problems: Vec<Problem>,
    more: usize,
}

impl<'a> Faults<'a> {
    pub fn new(shown: &'a str) -> Self {
        Self { shown, problems: Vec::new(), more: 0 }
    }

    pub fn push(&mut self, problem: impl FnOnce() -> Problem) {
        if self.problems.len() < SHOWN { self.problems.push(problem()) } else { self.more += 1 }
    }

    pub fn finish<T>(mut self, value: T) -> Result<T, Vec<Problem>> {
        match self.more {
            0 if self.problems.is_empty() => return Ok(value),
            0 => {}
            1 => self.problems.push(Problem::error("more-problems", format!("and 1 more problem in `{}`", self.shown))),
            more => self.problems.push(Problem::error("more-problems", format!("and {more} more problems in `{}`", self.shown))),
        }
        Err(self.problems)
    }
}

/// A line of the file without its line break.
pub(super) struct Line<'a> {
    pub text: &'a str,
    /// From 1.
    pub number: usize,
    /// Whether the file ends with it, without a line break.
    pub last: bool,
    pub shown: &'a str,
}

impl Line<'_> {
    /// Only this line is kept with a problem, not the file.
    fn span(&self) -> Span {
        Source::excerpt(self.shown, self.text, self.number).whole()
    }
}

/// Reads a row that holds quotes or blanks, or finds what is wrong with it. Columns may end with different lengths if there is a fault.
pub(super) fn slow_row(line: &Line<'_>, width: usize, sinks: &mut [Sink], faults: &mut Faults<'_>) {
    if line.text.trim().is_empty() {
        faults.push(|| Problem::error("blank-line", "a blank line stands between the rows").at(&line.span()));
        return;
    }
    let cells = match cells::split(line.text) {
        Ok(cells) => cells,
        Err(StrayQuote(place)) => return faults.push(|| cells::stray_quote(&line.span().part(place))),
    };
    if cells.len() < width && line.last {
        return faults.push(|| {
            let says = format!("the file ends inside a row: {} of {} values", cells.len(), width);
            Problem::error("truncated-row", says).at(&line.span()).help("the file may have been cut off; export or copy it again")
        });
    }
    if cells.len() != width {
        return faults.push(|| cells::ragged(&line.span(), &cells, width));
    }
    for sink in sinks {
        let cell = &cells[sink.position];
        match cells::number(&cell.text) {
            Ok(number) => sink.values.push(number * sink.factor),
            Err((code, says)) => faults.push(|| Problem::error(code, says).at(&line.span().part(cell.place.clone()))),
        }
    }
}
