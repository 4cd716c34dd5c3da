//! Stretches of a long text, found by an index of its rows.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use super::known::{Index, Known, KnownFile, Mark};
use super::stretch::{Block, Run, Stretch, axis_of, text, values};
use super::{Origin, Record, Wanted, find_columns, header, rows};
use crate::data::text::{decode_from, open_text, read_line_of, unreadable};
use crate::problem::Problem;

/// As [`super::stream`] of a text; the index of an axis, one of the wanted columns, is kept in
/// passing.
pub fn stream(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    (axis, known): (&str, &Known),
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    let mut marks = Vec::new();
    let run = text(path, shown, wanted, &mut |block| {
        let column = block.columns.iter().find(|column| column.name == axis);
        marks.extend(column.map(|column| Mark::of(block.first_row, block.bytes, column)));
        each(block);
    })?;
    axis_of(&run.columns, axis, shown)?;
    let index = Index { axis: axis.to_string(), rows: run.rows, marks };
    known.keep(KnownFile { sha256: run.sha256.clone(), bytes: run.bytes, index: Some(index) });
    Ok(run)
}

/// The rows whose axis lies in a range. Without an index, the file is read once to its end for it;
/// only the axis is then parsed.
pub fn stretch(
    path: &Path,
    shown: &str,
    wanted: &[Wanted],
    (axis, range): (&str, &Range<f64>),
    known: &Known,
) -> Result<Record, Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let has_index = |file: &KnownFile| file.index.as_ref().is_some_and(|index| index.axis == axis);
    let build = || -> Result<KnownFile, Vec<Problem>> {
        let only: Vec<Wanted> =
            wanted.iter().filter(|wanted| wanted.name == axis).cloned().collect();
        let found = Known::default();
        stream(path, shown, &only, (axis, &found), &mut |_| {})?;
        let missing = || one(Problem::error("no-rows", format!("`{shown}` has no rows")));
        found.taken().ok_or_else(missing)
    };
    let known = known.or(has_index, build)?;
    let Some(index) = &known.index else {
        return Err(one(Problem::error("no-rows", format!("`{shown}` has no rows"))));
    };
    let mut file = open_text(path, shown).map_err(one)?;
    let first = read_line_of(&mut file, shown).map_err(one)?;
    let (headings, _) = header(decode_from(&first, shown, 1).map_err(one)?, shown)?;
    let mut columns = find_columns(&headings, wanted, shown)?;
    let at = axis_of(&columns, axis, shown)?;
    let mut stretch = Stretch::new(range.clone(), at, &columns);
    let mut buffer = Vec::new();
    for mark in index.marks.iter().filter(|mark| mark.touches(range)) {
        buffer.clear();
        let read = file
            .seek(SeekFrom::Start(mark.from))
            .and_then(|_| (&mut file).take(mark.to - mark.from).read_to_end(&mut buffer));
        read.map_err(|error| one(unreadable(shown, &error)))?;
        let text = decode_from(&buffer, shown, mark.first_row + 2).map_err(one)?;
        rows::read(
            text,
            0,
            headings.len(),
            &mut columns,
            rows::Part { shown, before: mark.first_row },
            None,
        )?;
        stretch.add(&values(&columns), mark.first_row);
    }
    columns.iter_mut().for_each(|column| column.values = Vec::new());
    let channels = headings.into_iter().map(|heading| heading.name).collect();
    stretch.record(
        Run {
            channels,
            rows: index.rows,
            columns,
            sha256: known.sha256.clone(),
            bytes: known.bytes,
        },
        Origin::File(path.to_path_buf()),
        shown,
    )
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;
    use std::fs;

    use super::*;
    use crate::data::record::read_stretch;
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
        let whole = crate::data::record::read_record(&path, "run.csv", &wanted()).expect("read");
        let known = Known::default();
        for range in [0.0..5.0, 100.0..300.0, 2_500.0..2_501.0, 5_990.0..7_000.0, -5.0..9_000.0] {
            let part = read_stretch(&path, "run.csv", &wanted(), "x", range.clone(), &known)
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
        let none = read_stretch(&path, "run.csv", &wanted(), "x", 7_000.0..8_000.0, &known)
            .expect_err("outside");
        assert_eq!(none[0].code, "outside-record");
        let index = known.taken().and_then(|file| file.index).expect("an index");
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
        assert!(read_stretch(&path, "run.csv", &wanted(), "x", 10.0..50.0, &known).is_ok());
        let fault = read_stretch(&path, "run.csv", &wanted(), "x", 3_990.0..4_010.0, &known)
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
        let fault = read_stretch(&path, "run.csv", &wanted(), "x", 10.0..50.0, &Known::default())
            .expect_err("twice");
        assert_eq!(fault[0].code, "axis-not-increasing");
        let path = written(folder.path(), |row, line| {
            if row == 50_000 {
                *line = "abc,1,1\n".into();
            }
        });
        let fault = read_stretch(&path, "run.csv", &wanted(), "x", 10.0..50.0, &Known::default())
            .expect_err("no number");
        assert_eq!(fault[0].code, "not-a-number");
    }
}
