//! Values of a column: in memory, or in a file without a name, in which those of a long run wait
//! until they are written.

use std::borrow::Cow;
use std::io;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use crate::disk::ScratchFile;
use crate::problem::Problem;

/// Bytes of a number in the file.
const WIDTH: usize = size_of::<f64>();
/// Rows that are looked at or written at a time: 80 s at 200 Hz, as in a row group of a Parquet
/// record.
pub const BLOCK: usize = 1 << 14;

/// The file, and where the next column begins in it.
#[derive(Debug)]
pub struct Store(Mutex<(ScratchFile, u64)>);

impl Store {
    /// A store in an empty file.
    pub fn new(file: ScratchFile) -> Arc<Self> {
        Arc::new(Self(Mutex::new((file, 0))))
    }

    fn add(&self, values: &[f64]) -> io::Result<u64> {
        let (file, end) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let start = *end;
        for some in values.chunks(BLOCK) {
            let bytes: Vec<u8> = some.iter().flat_map(|value| value.to_le_bytes()).collect();
            file.write_at(*end, &bytes)?;
            *end += bytes.len() as u64;
        }
        Ok(start)
    }

    fn read(&self, start: u64, count: usize) -> io::Result<Vec<f64>> {
        let (file, _) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut values = Vec::with_capacity(count);
        let mut bytes = vec![0; WIDTH * count.min(BLOCK)];
        while values.len() < count {
            let some = &mut bytes[..WIDTH * (count - values.len()).min(BLOCK)];
            file.read_at(start + (WIDTH * values.len()) as u64, some)?;
            values.extend(some.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)));
        }
        Ok(values)
    }
}

/// The values of a column.
#[derive(Clone, Debug)]
pub enum Values {
    Held(Vec<f64>),
    Stored { store: Arc<Store>, start: u64, rows: usize, reversed: bool },
}

impl Values {
    /// Puts the values into the store, if there is one.
    ///
    /// # Errors
    /// `write-failed`.
    pub fn keep(values: Vec<f64>, store: Option<&Arc<Store>>) -> Result<Self, Problem> {
        let Some(store) = store else { return Ok(Self::Held(values)) };
        let start = store.add(&values).map_err(|error| failed(&error))?;
        Ok(Self::Stored { store: Arc::clone(store), start, rows: values.len(), reversed: false })
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Held(values) => values.len(),
            Self::Stored { rows, .. } => *rows,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of some rows; of a range beyond the end those that are there.
    ///
    /// # Errors
    /// `write-failed`: the file without a name cannot be read.
    pub fn part(&self, range: Range<usize>) -> Result<Cow<'_, [f64]>, Problem> {
        let range = range.start.min(self.len())..range.end.min(self.len());
        match self {
            Self::Held(values) => Ok(Cow::Borrowed(&values[range])),
            Self::Stored { store, start, reversed, .. } => {
                let from = start + (WIDTH * range.start) as u64;
                let mut values = store.read(from, range.len()).map_err(|error| failed(&error))?;
                if *reversed {
                    values.iter_mut().for_each(|value| *value = -*value);
                }
                Ok(Cow::Owned(values))
            }
        }
    }

    /// All values.
    ///
    /// # Errors
    /// As [`Values::part`].
    pub fn all(&self) -> Result<Cow<'_, [f64]>, Problem> {
        self.part(0..self.len())
    }

    /// Row of the first value that is not finite, and the number of them.
    ///
    /// # Errors
    /// As [`Values::part`].
    pub fn missing(&self) -> Result<Option<(usize, usize)>, Problem> {
        let mut found = None;
        for start in (0..self.len()).step_by(BLOCK) {
            for (row, value) in self.part(start..start + BLOCK)?.iter().enumerate() {
                if !value.is_finite() {
                    found.get_or_insert((start + row, 0)).1 += 1;
                }
            }
        }
        Ok(found)
    }

    /// Gives all values the opposite sign.
    pub fn reverse(&mut self) {
        match self {
            Self::Held(values) => values.iter_mut().for_each(|value| *value = -*value),
            Self::Stored { reversed, .. } => *reversed = !*reversed,
        }
    }

    /// Leaves only these rows.
    pub fn cut(&mut self, range: Range<usize>) {
        match self {
            Self::Held(values) => *values = values[range].to_vec(),
            Self::Stored { start, rows, .. } => {
                *start += (WIDTH * range.start) as u64;
                *rows = range.len();
            }
        }
    }
}

fn failed(error: &io::Error) -> Problem {
    let says = format!(
        "the values of a run cannot be kept in a temporary file of the output folder: {error}"
    );
    Problem::error("write-failed", says).help("it needs 16 bytes for each value of both records")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is stored is the same as what is held, for ranges over the borders of blocks as well.
    #[test]
    fn stored_values_are_those_held() {
        let count = 2 * BLOCK + 77;
        let mut values: Vec<f64> = (0..count).map(|at| (at as f64 * 0.37).sin()).collect();
        (values[3], values[BLOCK + 1]) = (-0.0, f64::NAN);
        let store = Store::new(ScratchFile::new(&std::env::temp_dir()).expect("a file"));
        let other = Values::keep(vec![1.0; 10], Some(&store)).expect("stored");
        let mut stored = Values::keep(values.clone(), Some(&store)).expect("stored");
        let mut held = Values::keep(values, None).expect("held");
        let bits = |values: &Values, range: Range<usize>| -> Vec<u64> {
            values.part(range).expect("read").iter().map(|value| value.to_bits()).collect()
        };
        for range in [0..count, 5..6, BLOCK - 1..BLOCK + 2, count - 3..count + 9, 7..7] {
            assert_eq!(bits(&stored, range.clone()), bits(&held, range));
        }
        assert_eq!(
            (stored.missing().expect("read"), held.missing().expect("read")),
            (Some((BLOCK + 1, 1)), Some((BLOCK + 1, 1)))
        );
        for values in [&mut stored, &mut held] {
            values.reverse();
            values.cut(3..BLOCK);
        }
        assert_eq!((bits(&stored, 0..count), stored.len()), (bits(&held, 0..count), BLOCK - 3));
        assert_eq!(
            (bits(&other, 9..10), other.missing().expect("read")),
            (vec![1.0_f64.to_bits()], None)
        );
    }
}
