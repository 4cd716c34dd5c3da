//! A row that is not as it should be: read with patience, and told what is wrong.

use super::rows::Sink;
use crate::data::cells::{self, StrayQuote};
use crate::data::faults::Faults;
use crate::problem::Problem;
use crate::source::{Source, Span};

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
            Err((code, says)) => {
                faults.push(|| Problem::error(code, format!("`{}`: {says}", sink.name)).at(&line.span().part(cell.place.clone())))
            }
        }
    }
}
