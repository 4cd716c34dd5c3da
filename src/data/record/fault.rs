//! Slow parsing of an irregular row, with a description of its fault.

use super::Column;
use crate::data::{cells, faults::Faults, prelude::*};

/// A line of the file without its line break.
pub struct Line<'a> {
    pub text: &'a str,
    /// From 1.
    pub number: usize,
    /// Whether it is the last line and has no line break.
    pub last: bool,
    pub shown: &'a str,
}

impl Line<'_> {
    /// The problem keeps only this line, not the file.
    fn span(&self) -> Span {
        Source::excerpt(self.shown, self.text, self.number).whole()
    }
}

const CUT_OFF: &str = "the file may have been cut off; export or copy it again";

/// Number of rows before the last one that determine the expected decimals of its last number.
pub const BEFORE: usize = 8;

/// Detects a file that was cut off inside its last number: it ends without a line break, and the
/// number has fewer decimals than those above it, which all have the same number. If these vary,
/// truncation cannot be detected.
pub fn cut_number(rows: &str, ended: bool, line: usize, shown: &str, faults: &mut Faults<'_>) {
    let mut lines = rows.rsplit('\n').take(1 + BEFORE);
    let (false, Some(last)) = (ended, lines.next()) else { return };
    let decimals = |line: &str| {
        let cell = line.trim_end_matches('\r').rsplit(',').next().unwrap_or_default().trim();
        let plain = !cell.contains(['e', 'E', '"']);
        plain.then(|| cell.split_once('.').map_or(0, |(_, decimals)| decimals.len()))
    };
    let before: Vec<Option<usize>> = lines.map(decimals).collect();
    let (Some(&Some(usual)), Some(found)) = (before.first(), decimals(last)) else { return };
    if before.len() == BEFORE && before.iter().all(|count| *count == Some(usual)) && found < usual {
        let start = last.rfind(',').map_or(0, |comma| comma + 1);
        faults.push(|| {
            let says = format!("the file ends without a line break, in a number with {found} decimals where the rows above have {usual}");
            let at = Source::excerpt(shown, last, line).span(start..last.len());
            error("truncated-row", says, &at).help(CUT_OFF)
        });
    }
}

/// Parses a row with quotes or blanks, or reports its fault. After a fault, columns may have
/// different lengths.
pub fn slow_row(
    line: &Line<'_>,
    width: usize,
    columns: &mut [&mut Column],
    faults: &mut Faults<'_>,
) {
    if line.text.trim().is_empty() {
        faults.push(|| error("blank-line", "blank line between the rows", &line.span()));
        return;
    }
    let cells = match cells::split(line.text) {
        Ok(cells) => cells,
        Err(place) => {
            return faults.push(|| cells::stray_quote(&line.span().part(place)));
        }
    };
    if cells.len() < width && line.last {
        return faults.push(|| {
            problem!(
                "truncated-row",
                &line.span(),
                "the file ends inside a row: {} of {width} values",
                cells.len()
            )
            .help(CUT_OFF)
        });
    }
    if cells.len() != width {
        return faults.push(|| cells::ragged(&line.span(), &cells, width));
    }
    for column in columns {
        let cell = &cells[column.position];
        match cells::number(&cell.text) {
            Ok(number) => column.values.push(number * column.unit.factor),
            Err((code, says)) => faults.push(|| {
                problem!(code, &line.span().part(cell.place.clone()), "`{}`: {says}", column.name)
            }),
        }
    }
}
