//! Long records: one block after the other, or a stretch of them.

use std::ops::Range;
use std::sync::Arc;

use parquet::file::statistics::Statistics;

use super::open::{At, Opened, Store, footer};
use super::{Column, no_rows};
use crate::data::faults::Faults;
use crate::data::hash::{Hasher, sha256};
use crate::data::record::decoded::{self, Place};
use crate::data::record::held::Held;
use crate::data::record::known::{Known, KnownFile};
use crate::data::record::stretch::{Block, Run, Stretch, axis_of, values};
use crate::data::record::{Origin, Record, Stored, Wanted};
use crate::data::text::unreadable;
use crate::disk;
use crate::problem::Problem;

/// Calls `each` with the wanted columns, batch by batch in the order of the file.
pub(crate) fn stream(
    at: At<'_>,
    shown: &str,
    wanted: &[Wanted],
    known: &Known,
    each: &mut dyn FnMut(&Block<'_>),
) -> Result<Run, Vec<Problem>> {
    let (mut opened, sha256) = open(at, shown, known)?;
    let mut columns = opened.find(wanted)?;
    if opened.layout.rows() == 0 {
        return Err(vec![no_rows(shown)]);
    }
    let mut faults = Faults::new(shown);
    for group in 0..opened.layout.groups() {
        let done = opened.group(group, &mut columns, &mut faults, &mut |columns, first_row| {
            each(&Block {
                first_row,
                rows: columns.first().map_or(0, |column| column.values.len()),
                columns,
                bytes: (0, 0),
            });
            columns.iter_mut().for_each(|column| column.values.clear());
        });
        done.map_err(|problem| vec![problem])?;
        if !faults.is_empty() {
            return Err(faults.into_vec());
        }
    }
    let channels = opened.layout.headings().iter().map(|heading| heading.name.clone()).collect();
    Ok(Run { channels, rows: opened.layout.rows(), columns, sha256, bytes: opened.store.size() })
}

/// The rows whose axis lies in a range. Row groups whose statistics exclude the range are not
/// decoded; of the others, the blocks that lie in it, once for all stretches that follow each other
/// along the run.
pub(crate) fn stretch(
    at: At<'_>,
    shown: &str,
    wanted: &[Wanted],
    (axis, range): (&str, &Range<f64>),
    known: &Known,
) -> Result<Record, Vec<Problem>> {
    let (mut opened, sha256) = open(at, shown, known)?;
    let mut columns = opened.find(wanted)?;
    let place = axis_of(&columns, axis, shown)?;
    let mut faults = Faults::new(shown);
    let mut parts = Vec::new();
    for group in 0..opened.layout.groups() {
        if opened.without(group, &columns[place], range) {
            continue;
        }
        for rows in blocks(opened.layout.rows_of(group)) {
            match opened.inside(group, &rows, &columns[place], range, known, &mut faults) {
                Ok(Some(part)) if faults.is_empty() => parts.push((group, rows, part)),
                Ok(None) if faults.is_empty() => {}
                Ok(_) => return Err(faults.into_vec()),
                Err(problem) => return Err(vec![problem]),
            }
        }
    }
    let mut stretch = Stretch::new(range.clone(), place, &columns);
    stretch.reserve(parts.iter().map(|(_, _, part)| part.len()).sum());
    for (group, rows, part) in parts {
        let first = rows.start + part.start;
        if let Some(numbers) = opened.numbers(group, &rows, &columns, known) {
            stretch.add(
                &numbers.iter().map(|column| &column[part.clone()]).collect::<Vec<_>>(),
                first,
            );
            continue;
        }
        // Not all numbers of the block are sound: those outside the range do not concern the
        // stretch.
        let part = first..first + part.len();
        let done =
            opened.rows_in(group, part, &mut columns, &mut faults, &mut |columns, first_row| {
                stretch.add(&values(columns), first_row);
                columns.iter_mut().for_each(|column| column.values.clear());
            });
        done.map_err(|problem| vec![problem])?;
        if !faults.is_empty() {
            return Err(faults.into_vec());
        }
    }
    let channels = opened.layout.headings().iter().map(|heading| heading.name.clone()).collect();
    let run =
        Run { channels, rows: opened.layout.rows(), columns, sha256, bytes: opened.store.size() };
    let from = match at {
        At::Disk(path) => Origin::File(path.to_path_buf()),
        At::Object(stored) => Origin::Object(stored.clone()),
    };
    stretch.record(run, from, shown)
}

/// A row group in parts of at most so many rows as a block has.
fn blocks(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    rows.clone().step_by(decoded::ROWS).map(move |start| start..rows.end.min(start + decoded::ROWS))
}

impl Opened<'_> {
    /// The numbers of columns in a block; `None` if not all are sound.
    fn numbers(
        &mut self,
        group: usize,
        rows: &Range<usize>,
        columns: &[Column],
        known: &Known,
    ) -> Option<Vec<Arc<Vec<f64>>>> {
        let positions: Vec<usize> = columns.iter().map(|column| column.position).collect();
        let place = Place::new(self.store.name(), rows.start);
        let numbers = known.held.decoded.get(place, &positions, |lacking| {
            let of = |position: &usize| {
                columns.iter().find(|column| column.position == *position).cloned()
            };
            self.block(group, rows.clone(), &lacking.iter().filter_map(of).collect::<Vec<_>>())
        });
        numbers.into_iter().collect()
    }

    /// From the first to the last row of a block, counted from its start, whose axis lies in a
    /// range.
    fn inside(
        &mut self,
        group: usize,
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
        if let Some(numbers) = self.numbers(group, rows, std::slice::from_ref(axis), known) {
            return Ok(numbers.first().and_then(|values| ends(values)));
        }
        let mut alone = [Column { values: Vec::new(), ..axis.clone() }];
        self.rows_in(group, rows.clone(), &mut alone, faults, &mut |_, _| {})?;
        Ok(ends(&alone[0].values))
    }

    /// Whether the statistics of a group say that no value of a column lies in a range of SI units.
    /// They are trusted.
    fn without(&self, group: usize, column: &Column, range: &Range<f64>) -> bool {
        let statistics = self.layout.leaf(column.position).and_then(|leaf| {
            self.layout.metadata.metadata().row_group(group).column(leaf).statistics()
        });
        let ends = match statistics {
            Some(Statistics::Double(of)) => of.min_opt().copied().zip(of.max_opt().copied()),
            Some(Statistics::Float(of)) => of
                .min_opt()
                .copied()
                .zip(of.max_opt().copied())
                .map(|(min, max)| (min.into(), max.into())),
            _ => None,
        };
        let factor = column.unit.factor;
        ends.is_some_and(|(min, max)| max * factor < range.start || min * factor > range.end)
    }
}

/// The file and its hash. A small file is read once, and kept for the stretches that follow. A
/// larger one is read to its end for the hash, and the row groups that are needed once more.
fn open<'a>(
    at: At<'_>,
    shown: &'a str,
    known: &Known,
) -> Result<(Opened<'a>, String), Vec<Problem>> {
    let one = |problem: Problem| vec![problem];
    let path = match at {
        At::Disk(path) => path,
        At::Object(stored) => return open_object(stored, shown, known).map_err(one),
    };
    let store = Store::held(path, shown, &known.held).map_err(one)?;
    let compute = || {
        if Held::takes_whole(store.size()) {
            let whole = disk::read(path, store.size())?;
            let file = KnownFile { sha256: sha256(&whole), bytes: whole.len() as u64, index: None };
            known.held.keep(path, 0, whole.into());
            return Ok(file);
        }
        let mut hash = Hasher::default();
        let mut file = disk::open(path)?;
        let bytes = hash.add_all(&mut file)?;
        Ok(KnownFile { sha256: hash.finish(), bytes, index: None })
    };
    let file = known
        .or(|_| true, compute)
        .map_err(|error: std::io::Error| one(unreadable(shown, &error)))?;
    let opened = Opened::again(store, shown, &known.held).map_err(one)?;
    Ok((opened, file.sha256.clone()))
}

/// An object, and a hash that stands for it. Its bytes are not all read: the hash is that of its
/// size, of its version in the store and of its footer, which has the place, the size and the
/// extremes of each part.
pub(super) fn open_object<'a>(
    stored: &Stored,
    shown: &'a str,
    known: &Known,
) -> Result<(Opened<'a>, String), Problem> {
    let mut store = Store::at(At::Object(stored), shown)?;
    let file = known.or(
        |_| true,
        || {
            let mut hash = Hasher::default();
            hash.add(format!("{}\n{}\n", stored.object.size(), stored.object.version()).as_bytes());
            hash.add(&footer(&mut store, shown)?);
            Ok(KnownFile { sha256: hash.finish(), bytes: stored.object.size(), index: None })
        },
    )?;
    Ok((Opened::again(store, shown, &known.held)?, file.sha256.clone()))
}
