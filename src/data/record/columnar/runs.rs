//! Long records: one block after the other, or a stretch of them.

use std::{io, ops::Range, sync::Arc};

use parquet::file::statistics::Statistics;

use super::{
    Column, no_rows,
    open::{At, Opened, Store, footer},
};
use crate::data::{
    cells::names,
    faults::Faults,
    hash::{Hasher, sha256},
    prelude::*,
    record::{
        Wanted, decoded,
        held::Held,
        known::{Known, KnownFile},
        stored::Stored,
        stretch::{Block, Run, Stretch, axis_of, values},
    },
    text::unreadable,
};

/// Calls `each` with the wanted columns, batch by batch in the order of the file.
pub fn stream(
    at: At<'_>,
    shown: &str,
    wanted: &[Wanted],
    known: &Known,
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    let (mut opened, sha256) = open(at, shown, known)?;
    let mut columns = opened.find(wanted)?;
    if opened.layout.rows() == 0 {
        return Err(no_rows(shown).into());
    }
    let mut faults = Faults::new(shown);
    for rows in opened.layout.groups() {
        opened.rows(rows, &mut columns, &mut faults, &mut |columns, first_row| {
            let rows = columns.first().map_or(0, |column| column.values.len());
            each(&Block { first_row, rows, columns, bytes: (0, 0) });
            columns.iter_mut().for_each(|column| column.values.clear());
        })?;
        if !faults.is_empty() {
            return Err(faults.into_vec());
        }
    }
    Ok(opened.run(columns, sha256))
}

/// The rows whose axis lies in a range. Row groups whose statistics exclude the range are not
/// decoded; of the others, the blocks that lie in it, once for all stretches that follow each other
/// along the run.
pub fn stretch(
    at: At<'_>,
    shown: &str,
    wanted: &[Wanted],
    (axis, range): (&str, &Range<f64>),
    known: &Known,
) -> Result<(Run, Stretch), Vec<Problem>> {
    let (mut opened, sha256) = open(at, shown, known)?;
    let mut columns = opened.find(wanted)?;
    let place = axis_of(&columns, axis, shown)?;
    let axis = &columns[place];
    let mut faults = Faults::new(shown);
    let mut parts = Vec::new();
    for rows in opened.layout.groups() {
        if opened.without(rows.start, axis, range) {
            continue;
        }
        for block in blocks(rows) {
            let inside = opened.inside(&block, axis, range, known, &mut faults)?;
            if !faults.is_empty() {
                return Err(faults.into_vec());
            }
            parts.extend(inside.map(|part| (block, part)));
        }
    }
    let mut stretch = Stretch::new(range.clone(), place, &columns);
    stretch.reserve(parts.iter().map(|(_, part)| part.len()).sum());
    for (block, part) in parts {
        let first = block.start + part.start;
        if let Some(numbers) = opened.numbers(block, &columns, known) {
            let part: Vec<&[f64]> = numbers.iter().map(|column| &column[part.clone()]).collect();
            stretch.add(&part, first);
            continue;
        }
        // Not all numbers of the block are sound: those outside the range do not concern the
        // stretch.
        let part = first..first + part.len();
        opened.rows(part, &mut columns, &mut faults, &mut |columns, first_row| {
            stretch.add(&values(columns), first_row);
            columns.iter_mut().for_each(|column| column.values.clear());
        })?;
        if !faults.is_empty() {
            return Err(faults.into_vec());
        }
    }
    Ok((opened.run(columns, sha256), stretch))
}

/// A row group in parts of at most so many rows as a block has.
fn blocks(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    rows.clone().step_by(decoded::ROWS).map(move |start| start..rows.end.min(start + decoded::ROWS))
}

impl Opened<'_> {
    /// What is known of the file and the columns that were read.
    pub fn run(&self, columns: Vec<Column>, sha256: String) -> Run {
        let (rows, bytes) = (self.layout.rows(), self.store.size());
        Run { channels: names(&self.layout.headings), rows, columns, sha256, bytes }
    }

    /// The numbers of columns in a block; `None` if not all are sound.
    fn numbers(
        &mut self,
        rows: Range<usize>,
        columns: &[Column],
        known: &Known,
    ) -> Option<Vec<Arc<Vec<f64>>>> {
        let positions: Vec<usize> = columns.iter().map(|column| column.position).collect();
        let place = (self.store.name().to_path_buf(), rows.start);
        let numbers = known.held.decoded.get(place, &positions, |lacking| {
            let lacks = |column: &&Column| lacking.contains(&column.position);
            self.block(rows, &columns.iter().filter(lacks).cloned().collect::<Vec<_>>())
        });
        numbers.into_iter().collect()
    }

    /// From the first to the last row of a block, counted from its start, whose axis lies in a
    /// range.
    fn inside(
        &mut self,
        rows: &Range<usize>,
        axis: &Column,
        range: &Range<f64>,
        known: &Known,
        faults: &mut Faults<'_>,
    ) -> Result<Option<Range<usize>>, Problem> {
        let inside = |value: &f64| *value >= range.start && *value <= range.end;
        let ends = |values: &[f64]| {
            Some(values.iter().position(inside)?..values.iter().rposition(inside)? + 1)
        };
        if let Some(numbers) = self.numbers(rows.clone(), std::slice::from_ref(axis), known) {
            return Ok(numbers.first().and_then(|values| ends(values)));
        }
        let mut alone = [axis.empty()];
        self.rows(rows.clone(), &mut alone, faults, &mut |_, _| {})?;
        Ok(ends(&alone[0].values))
    }

    /// Whether the statistics of the group of a row say that no value of a column lies in a range
    /// of SI units. They are trusted.
    fn without(&self, row: usize, column: &Column, range: &Range<f64>) -> bool {
        let chunk = self.layout.chunk(self.layout.group_of(row), column.position);
        let ends = match chunk.and_then(|chunk| chunk.statistics()) {
            Some(Statistics::Double(of)) => of.min_opt().copied().zip(of.max_opt().copied()),
            Some(Statistics::Float(of)) => {
                of.min_opt().map(|min| f64::from(*min)).zip(of.max_opt().map(|max| f64::from(*max)))
            }
            _ => None,
        };
        let factor = column.unit.factor;
        ends.is_some_and(|(min, max)| max * factor < range.start || min * factor > range.end)
    }
}

/// The file and its hash. A small file is read once, and kept for the stretches that follow. A
/// larger one is read to its end for the hash, and the row groups that are needed once more.
fn open<'a>(at: At<'_>, shown: &'a str, known: &Known) -> Result<(Opened<'a>, String), Problem> {
    let path = match at {
        At::Disk(path) => path,
        At::Object(stored) => return open_object(stored, shown, known),
    };
    let store = Store::disk(path, shown, Some(known.held.clone()))?;
    let compute = || {
        if Held::takes_whole(store.size()) {
            let whole = disk::read(path, store.size())?;
            let file = KnownFile { sha256: sha256(&whole), bytes: whole.len() as u64, index: None };
            known.held.keep(path, 0, whole.into());
            return Ok(file);
        }
        let mut hash = Hasher::default();
        let bytes = hash.add_all(&mut disk::open(path)?)?;
        Ok(KnownFile { sha256: hash.finish(), bytes, index: None })
    };
    let file = known.or(|_| true, compute).map_err(unreadable::<io::Error>(shown))?;
    Ok((Opened::again(store, shown, &known.held)?, file.sha256.clone()))
}

/// An object, and a hash that stands for it. Its bytes are not all read: the hash is that of its
/// size, of its version in the store and of its footer, which has the place, the size and the
/// extremes of each part.
pub fn open_object<'a>(
    stored: &Stored,
    shown: &'a str,
    known: &Known,
) -> Result<(Opened<'a>, String), Problem> {
    let object = &stored.object;
    let mut store = Store::at(At::Object(stored), shown)?;
    let compute = || {
        let mut hash = Hasher::default();
        hash.add(format!("{}\n{}\n", object.size(), object.version()).as_bytes());
        hash.add(&footer(&mut store, shown)?);
        Ok(KnownFile { sha256: hash.finish(), bytes: object.size(), index: None })
    };
    let file = known.or(|_| true, compute)?;
    Ok((Opened::again(store, shown, &known.held)?, file.sha256.clone()))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Float64Array, RecordBatch};
    use parquet::arrow::ArrowWriter;
    use parquet::file::properties::WriterProperties;

    use super::*;
    use crate::data::record::decoded::ROWS;
    use crate::data::record::{Record, RecordSource};
    use crate::units::Dimension;

    const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0, 0]);

    /// Rows of the file: some row groups, and some blocks in the largest of them.
    const LENGTH: usize = 100_000;

    fn force(row: usize) -> f64 {
        (row as f64 * 0.01).sin()
    }

    /// A file with row groups of so many rows, and its stretches from one time to another [s]; a
    /// row is 5 ms.
    struct File {
        path: PathBuf,
        known: Known,
        _folder: tempfile::TempDir,
    }

    impl File {
        fn new(group: usize, time: impl Fn(usize) -> f64, force: impl Fn(usize) -> f64) -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("r.parquet");
            let array = |value: &dyn Fn(usize) -> f64| {
                Arc::new(Float64Array::from_iter_values((0..LENGTH).map(value))) as ArrayRef
            };
            let columns = [
                ("time [s]", array(&time)),
                ("Y [kN]", array(&force)),
                ("Q [kN]", array(&|row| -force(row))),
            ];
            let batch = RecordBatch::try_from_iter(columns).expect("columns of one length");
            let properties =
                WriterProperties::builder().set_max_row_group_row_count(Some(group)).build();
            let mut bytes = Vec::new();
            let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))
                .expect("a writer");
            writer.write(&batch).expect("written");
            writer.close().expect("closed");
            std::fs::write(&path, bytes).expect("written");
            Self { path, known: Known::default(), _folder: folder }
        }

        fn sound(group: usize) -> Self {
            Self::new(group, |row| row as f64 * 0.005, force)
        }

        fn stretch(&self, from: f64, to: f64, names: &[&str]) -> Result<Record, Vec<Problem>> {
            let of = |name: &&str| Wanted::new(*name, FORCE);
            let wanted: Vec<Wanted> = [Wanted::new("time", Dimension::TIME)]
                .into_iter()
                .chain(names.iter().map(of))
                .collect();
            RecordSource::at(&self.path, "r.parquet").stretch(
                &wanted,
                "time",
                from..to,
                &self.known,
            )
        }

        /// Columns of blocks that were decoded.
        fn made(&self) -> usize {
            self.known.held.decoded.made()
        }
    }

    #[test]
    fn a_row_group_is_decoded_once_for_all_sections() {
        let file = File::sound(20_000);
        // 100 s are a row group; a section each 2 s, with what is beside it.
        for section in 0..240 {
            let from = 2.0 * f64::from(section);
            let record = file.stretch(from, from + 10.0, &["Y"]).expect("inside");
            assert!((2000..=2001).contains(&record.rows), "{} rows", record.rows);
        }
        assert_eq!(file.made(), 5 * 2, "five row groups of two columns");
        file.stretch(0.0, 10.0, &["Q", "Y"]).expect("inside");
        assert_eq!(file.made(), 5 * 2 + 1, "a column that was not asked for before");
    }

    #[test]
    fn a_stretch_is_the_same_in_row_groups_of_any_length() {
        let files = [7_000, 20_000, 60_000, LENGTH].map(File::sound);
        for (from, to) in [
            (0.0, 3.0),
            (95.0, 105.0),
            (160.0, 170.0),
            (320.0, 330.0),
            (20.0, 470.0),
            (490.0, 600.0),
        ] {
            let [one, others @ ..] =
                files.each_ref().map(|file| file.stretch(from, to, &["Y", "Q"]).expect("inside"));
            let rows: Vec<usize> =
                (0..LENGTH).filter(|row| (from..=to).contains(&(*row as f64 * 0.005))).collect();
            assert_eq!((one.first_row, one.rows), (rows[0], rows.len()));
            for (at, row) in rows.iter().enumerate() {
                assert_eq!(one.columns[1].values[at], force(*row) * 1000.0);
                assert_eq!(one.columns[2].values[at], -force(*row) * 1000.0);
            }
            for other in others {
                assert_eq!(
                    (one.columns.as_slice(), one.first_row),
                    (other.columns.as_slice(), other.first_row)
                );
            }
        }
        let whole = &files[3];
        assert_eq!(whole.made(), 3 * LENGTH.div_ceil(ROWS), "a long row group is parted");
    }

    /// Only rows of the stretch concern it; the axis must be sound wherever it is looked at.
    #[test]
    fn a_fault_beside_a_stretch_does_not_concern_it() {
        let time = |row: usize| row as f64 * 0.005;
        let file = File::new(20_000, time, |row| if row == 10_000 { f64::NAN } else { force(row) });
        for _ in 0..2 {
            let good = file.stretch(60.0, 70.0, &["Y"]).expect("inside");
            assert_eq!((good.rows, good.columns[1].values[0]), (2001, force(12_000) * 1000.0));
            assert!(file.stretch(45.0, 55.0, &[]).is_ok());
            let fault = file.stretch(45.0, 55.0, &["Y"]).expect_err("no number");
            assert_eq!(
                (fault[0].code, fault[0].at.as_ref().map(ToString::to_string)),
                ("not-finite", Some("r.parquet:10001:10".into()))
            );
        }
        let file = File::new(20_000, |row| if row == 10_000 { f64::NAN } else { time(row) }, force);
        assert_eq!(file.stretch(60.0, 70.0, &["Y"]).expect_err("no number")[0].code, "not-finite");
        assert!(file.stretch(160.0, 170.0, &["Y"]).is_ok());
    }

    #[test]
    fn the_axis_is_searched_in_all_blocks_of_a_row_group() {
        let back = |row: usize| {
            if row < 70_000 { row as f64 * 0.005 } else { (row - 70_000) as f64 * 0.005 }
        };
        let file = File::new(LENGTH, back, force);
        assert_eq!(
            file.stretch(10.0, 20.0, &["Y"]).expect_err("twice")[0].code,
            "axis-not-increasing"
        );
        assert!(file.stretch(200.0, 210.0, &["Y"]).is_ok());
    }
}
