//! Records as texts: block by block, whole, or a stretch of them by an index of their rows.

use std::{
    io::{BufRead, BufReader, Read, Seek, SeekFrom},
    ops::Range,
    path::Path,
};

use super::{
    Column, Wanted,
    columnar::MAGIC,
    fault, find_columns, header_fault,
    known::{Index, Known, KnownFile, Mark},
    listed_headings, rows,
    stretch::{Block, Run, Stretch, axis_of, values},
};
use crate::data::{
    cells::{self, Heading, names},
    faults::Faults,
    hash::Hasher,
    prelude::*,
    text::{self, LONGEST_LINE, decode_from, long_line, open_text, read_line_of, unreadable},
};

/// Bytes of text read at a time, and so what is read at least for a stretch: about 1200 rows of 24
/// channels, 6 s at 200 Hz. Larger blocks are not read faster.
const BLOCK: usize = 1 << 18;

/// The headings of a record.
pub fn headings(path: &Path, shown: &str) -> Result<Vec<Heading>, Vec<Problem>> {
    Ok(Text::open(path, shown)?.headings)
}

/// The wanted columns of a record.
pub fn read(path: &Path, shown: &str, wanted: &[Wanted]) -> Result<Run, Vec<Problem>> {
    text::record_size(path, shown)?;
    let mut all: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
    let mut run = stream(path, shown, wanted, &mut |block| {
        for (all, column) in all.iter_mut().zip(block.columns) {
            all.extend_from_slice(&column.values);
        }
    })?;
    run.columns.iter_mut().zip(all).for_each(|(column, values)| column.values = values);
    Ok(run)
}

/// Calls `each` with the wanted columns, block by block in the order of the file, up to the first
/// block with a fault.
fn stream(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    let mut text = Text::open(path, shown)?;
    let mut columns = text.find(wanted)?;
    let mut faults = Faults::new(shown);
    let rows = text.blocks(&mut columns, &mut faults, each)?;
    if rows == 0 {
        faults.push(|| no_rows(shown));
    }
    faults.finish(()).map_err(|problems| {
        header_fault::repeated(path, shown).map_or(problems, |problem| vec![problem])
    })?;
    let columns = columns.iter().map(Column::empty).collect();
    let (channels, sha256) = (names(&text.headings), text.hash.finish());
    Ok(Run { channels, rows, columns, sha256, bytes: text.bytes })
}

/// The same, and what is known of the file then, with the index of an axis, one of the wanted
/// columns.
pub fn stream_indexed(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    axis: &str,
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<(Run, KnownFile), Vec<Problem>> {
    let mut marks = Vec::new();
    let run = stream(path, shown, wanted, &mut |block| {
        let column = block.columns.iter().find(|column| column.name == axis);
        marks.extend(column.map(|column| Mark::of(block.first_row, block.bytes, column)));
        each(block);
    })?;
    axis_of(&run.columns, axis, shown)?;
    let index = Index { axis: axis.to_string(), rows: run.rows, marks };
    let known = KnownFile { sha256: run.sha256.clone(), bytes: run.bytes, index: Some(index) };
    Ok((run, known))
}

/// The rows whose axis lies in a range. Without an index, the file is read once to its end for it;
/// only the axis is then parsed.
pub fn stretch(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    (axis, range): (&str, &Range<f64>),
    known: &Known,
) -> Result<(Run, Stretch), Vec<Problem>> {
    let has_index = |file: &KnownFile| file.index.as_ref().is_some_and(|index| index.axis == axis);
    let build = || -> Result<KnownFile, Vec<Problem>> {
        let only: Vec<Wanted> =
            wanted.iter().filter(|wanted| wanted.name == axis).cloned().collect();
        Ok(stream_indexed(path, shown, &only, axis, &mut |_| {})?.1)
    };
    let known = known.or(has_index, build)?;
    let index = known.index.as_ref().ok_or_else(|| no_rows(shown))?;
    let mut text = Text::open(path, shown)?;
    let mut columns = text.find(wanted)?;
    let mut stretch = Stretch::new(range.clone(), axis_of(&columns, axis, shown)?, &columns);
    for mark in index.marks.iter().filter(|mark| mark.touches(range)) {
        let mut faults = Faults::new(shown);
        text.part(mark, &mut columns, &mut faults)?;
        faults.finish(())?;
        stretch.add(&values(&columns), mark.first_row);
    }
    let (channels, sha256) = (names(&text.headings), known.sha256.clone());
    Ok((Run { channels, rows: index.rows, columns, sha256, bytes: known.bytes }, stretch))
}

/// The place of a sample, from 0, or of its cell in a column. The file is read again.
pub fn place(path: &Path, shown: &str, row: usize, column: Option<&Column>) -> Option<Span> {
    // There are no blank lines between rows, so sample 0 is in line 2.
    let line = open_text(path, shown).ok()?.lines().nth(row + 1)?.ok()?;
    let whole = Source::excerpt(shown, line.as_str(), row + 2).whole();
    let cell = column.and_then(|column| cells::split(&line).ok()?.into_iter().nth(column.position));
    Some(cell.map_or(whole.clone(), |cell| whole.part(cell.place)))
}

pub fn no_rows(shown: &str) -> Problem {
    problem!("no-rows", "`{shown}` has a header and no samples")
}

/// An open text, of which the header was read.
struct Text<'a> {
    shown: &'a str,
    file: BufReader<disk::Reader>,
    headings: Vec<Heading>,
    /// Of what was read so far.
    hash: Hasher,
    bytes: u64,
    buffer: Vec<u8>,
}

impl<'a> Text<'a> {
    fn open(path: &Path, shown: &'a str) -> Result<Self, Vec<Problem>> {
        let mut file = open_text(path, shown)?;
        not_parquet(&mut file, shown)?;
        let first = read_line_of(&mut file, shown)?;
        let headings = listed_headings(decode_from(&first, shown, 1, 0)?, shown)?;
        let mut hash = Hasher::default();
        hash.add(&first);
        Ok(Self { shown, file, headings, hash, bytes: first.len() as u64, buffer: Vec::new() })
    }

    /// The wanted columns. If some are not found, their units may stand elsewhere.
    fn find(&mut self, wanted: &[Wanted]) -> Result<Vec<Column>, Vec<Problem>> {
        find_columns(&self.headings, wanted, self.shown).map_err(|problems| {
            let second = read_line_of(&mut self.file, self.shown).unwrap_or_default();
            let row = std::str::from_utf8(&second).unwrap_or_default().trim_end();
            let elsewhere = header_fault::units_elsewhere(row, &self.headings, self.shown);
            elsewhere.map_or(problems, |problem| vec![problem])
        })
    }

    /// Reads the rows in blocks that end with a line; returns their number.
    fn blocks(
        &mut self,
        columns: &mut [Column],
        faults: &mut Faults<'_>,
        each: &mut dyn FnMut(&Block<'_>),
    ) -> Result<usize, Problem> {
        let (shown, width) = (self.shown, self.headings.len());
        let mut first_row = 0;
        loop {
            let kept = self.buffer.len();
            let mut part = (&mut self.file).take(BLOCK as u64);
            let read = part.read_to_end(&mut self.buffer).map_err(unreadable(shown))?;
            self.hash.add(&self.buffer[kept..]);
            self.bytes += read as u64;
            let ended = read < BLOCK;
            let end = if ended {
                self.buffer.len()
            } else {
                whole_lines(&self.buffer, first_row, shown)?
            };
            let from = self.bytes - self.buffer.len() as u64;
            let text = decode_from(&self.buffer[..end], shown, first_row + 2, from)?;
            let rows = rows::read(text, width, columns, (shown, first_row), faults)?;
            if rows > 0 && faults.is_empty() {
                each(&Block { first_row, rows, columns, bytes: (from, from + end as u64) });
            }
            first_row += rows;
            self.buffer.drain(..end);
            if ended {
                return Ok(first_row);
            }
        }
    }

    /// Reads the rows of a mark.
    fn part(
        &mut self,
        mark: &Mark,
        columns: &mut [Column],
        faults: &mut Faults<'_>,
    ) -> Result<(), Problem> {
        let (shown, buffer) = (self.shown, &mut self.buffer);
        buffer.clear();
        self.file
            .seek(SeekFrom::Start(mark.from))
            .and_then(|_| (&mut self.file).take(mark.to - mark.from).read_to_end(buffer))
            .map_err(unreadable(shown))?;
        let text = decode_from(buffer, shown, mark.first_row + 2, mark.from)?;
        rows::read(text, self.headings.len(), columns, (shown, mark.first_row), faults)?;
        Ok(())
    }
}

/// Refuses a Parquet file with the name of a text.
fn not_parquet(file: &mut BufReader<disk::Reader>, shown: &str) -> Result<(), Problem> {
    let mut both = || -> std::io::Result<bool> {
        if !file.fill_buf()?.starts_with(MAGIC) {
            return Ok(false);
        }
        let mut end = [0; MAGIC.len()];
        file.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
        file.read_exact(&mut end)?;
        file.rewind()?;
        Ok(end == *MAGIC)
    };
    if both().map_err(unreadable(shown))? {
        let problem = problem!("format-mislabelled", "`{shown}` is a Parquet file");
        return Err(problem.help("its name must end in `.parquet`"));
    }
    Ok(())
}

/// Bytes of the whole lines of a part of a text that is not its end. Some lines are left for the
/// next block: the last one may be cut off, blank lines at the end of the file are not rows, and
/// whether the last number of the file is cut off is told by the lines before it.
fn whole_lines(bytes: &[u8], first_row: usize, shown: &str) -> Result<usize, Problem> {
    let full = bytes.trim_ascii_end().len();
    let last = memchr::memrchr(b'\n', &bytes[..full]).map_or(0, |end| end + 1);
    let rest = &bytes[last..];
    if rest.len() <= LONGEST_LINE {
        let mut ends = memchr::memrchr_iter(b'\n', &bytes[..full]);
        return Ok(ends.nth(fault::BEFORE).map_or(0, |end| end + 1));
    }
    let line = first_row + 2 + memchr::memchr_iter(b'\n', &bytes[..last]).count();
    if rest.iter().take(LONGEST_LINE).any(|byte| *byte == b'\n') {
        return Err(problem!(
            "blank-line",
            &Source::excerpt(shown, "", line + 1).whole(),
            "blank lines from line {} of `{shown}` on",
            line + 1
        ));
    }
    Err(long_line(rest, line, shown))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;
    use std::fs;

    use super::*;
    use crate::data::record::{RecordSource, read_record};
    use crate::units::Dimension;

    fn wanted() -> Vec<Wanted> {
        vec![
            Wanted::new("x", Dimension::LENGTH),
            Wanted { name: "F".into(), dimension: None, required: true },
        ]
    }

    /// 60 000 rows: a few blocks.
    fn written(folder: &Path, change: impl Fn(usize, &mut String)) -> std::path::PathBuf {
        let mut text = String::from("x [m],F [kN],other [m]\n");
        for row in 0..60_000 {
            let mut line = format!("{:.1},{},0.000000\n", row as f64 * 0.1, row % 977);
            change(row, &mut line);
            let _ = write!(text, "{line}");
        }
        let path = folder.join("run.csv");
        fs::write(&path, text).expect("written");
        path
    }

    #[test]
    fn a_stretch_is_that_of_the_whole_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), |_, _| {});
        let whole = read_record(&path, "run.csv", &wanted()).expect("read");
        let known = Known::default();
        for range in [0.0..5.0, 100.0..300.0, 2_500.0..2_501.0, 5_990.0..7_000.0, -5.0..9_000.0] {
            let part = RecordSource::at(&path, "run.csv")
                .stretch(&wanted(), "x", range.clone(), &known)
                .expect("inside");
            let rows: Vec<usize> = (0..whole.rows)
                .filter(|&row| {
                    range.contains(&whole.columns[0].values[row])
                        || whole.columns[0].values[row] == range.end
                })
                .collect();
            assert_eq!((part.first_row, part.rows), (rows[0], rows.len()));
            for (one, other) in part.columns.iter().zip(&whole.columns) {
                assert_eq!(one.values, other.values[rows[0]..rows[0] + rows.len()]);
            }
            assert_eq!((&part.sha256, part.bytes), (&whole.sha256, whole.bytes));
        }
        let none = RecordSource::at(&path, "run.csv")
            .stretch(&wanted(), "x", 7_000.0..8_000.0, &known)
            .expect_err("outside");
        assert_eq!(none[0].code, "outside-record");
        let file = known.or(|_| true, || Err(())).expect("kept");
        let index = file.index.as_ref().expect("an index");
        assert!(index.rows == 60_000 && index.marks.len() >= 4, "{}", index.marks.len());
    }

    /// As of Parquet, what is wrong in other columns far from the stretch does not concern it; the
    /// axis must be sound everywhere.
    #[test]
    fn faults_have_the_rows_of_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = written(folder.path(), |row, line| {
            if row == 40_000 {
                *line = line.replacen("0,", "0,x", 1);
            }
        });
        let known = Known::default();
        assert!(
            RecordSource::at(&path, "run.csv").stretch(&wanted(), "x", 10.0..50.0, &known).is_ok()
        );
        let fault = RecordSource::at(&path, "run.csv")
            .stretch(&wanted(), "x", 3_990.0..4_010.0, &known)
            .expect_err("no number");
        assert!(
            fault[0].says.contains("40002") || fault[0].render(false).contains("40002"),
            "{}",
            fault[0].render(false)
        );
        let path = written(folder.path(), |row, line| {
            if row == 50_000 {
                *line = "15.0,1,1\n".into();
            }
        });
        let fault = RecordSource::at(&path, "run.csv")
            .stretch(&wanted(), "x", 10.0..50.0, &Known::default())
            .expect_err("twice");
        assert_eq!(fault[0].code, "axis-not-increasing");
        let path = written(folder.path(), |row, line| {
            if row == 50_000 {
                *line = "abc,1,1\n".into();
            }
        });
        let fault = RecordSource::at(&path, "run.csv")
            .stretch(&wanted(), "x", 10.0..50.0, &Known::default())
            .expect_err("no number");
        assert_eq!(fault[0].code, "not-a-number");
    }
}
