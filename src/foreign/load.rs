//! The bytes of a file, and the limits of what is read from it.

use std::path::Path;

use crate::data::text::read_file;
use crate::problem::Problem;

/// Maximum size of a file in bytes: a text of a hundred channels at 1 kHz for five minutes, or a
/// binary file of ten. A worker holds the file, its numbers, and the record that is made of them: up
/// to six times as much.
const LARGEST: u64 = 256 << 20;

/// Maximum number of values of a file: 512 MB of numbers, a hundred channels at 1 kHz for 11
/// minutes. A compressed file can hold more than its size suggests.
pub const MOST_VALUES: usize = 1 << 26;

/// Maximum number of channels of a file; a large measuring system has some thousands.
pub const MOST_CHANNELS: usize = 100_000;

/// All bytes of a plain file.
pub fn bytes(path: &Path, shown: &str) -> Result<Vec<u8>, Problem> {
    read_file(path, shown, LARGEST).map_err(|problem| match problem.code {
        "file-too-large" => problem
            .help("export it in parts or as Parquet, or leave out channels that are not needed"),
        _ => problem,
    })
}

/// Bytes that any file may hold when it is unpacked, and the multiple of its size that it may hold
/// beyond. Records compress by less than 20; deflate packs zeros by 1000. A file beyond that is a
/// mistake or an attack, and its memory stays bounded.
const ALWAYS_UNPACKED: usize = 64 << 20;
const MOST_EXPANSION: usize = 100;

/// Bytes that a file of this size may hold when it is unpacked.
pub fn most_unpacked(size: usize) -> usize {
    size.saturating_mul(MOST_EXPANSION).saturating_add(ALWAYS_UNPACKED).min(8 * MOST_VALUES)
}

/// Counts the values of a file, which can be many more than its bytes suggest.
#[derive(Debug)]
pub struct Budget<'a> {
    shown: &'a str,
    most: usize,
    values: usize,
    channels: usize,
}

impl<'a> Budget<'a> {
    /// For a file of this size in bytes.
    pub fn new(size: usize, shown: &'a str) -> Self {
        Self { shown, most: most_unpacked(size) / 8, values: 0, channels: 0 }
    }

    /// Adds channels of so many values each; the place is for the message.
    ///
    /// # Errors
    /// `too-many-values`.
    pub fn take(&mut self, channels: usize, rows: usize, place: &str) -> Result<(), Problem> {
        self.channels = self.channels.saturating_add(channels);
        if self.channels > MOST_CHANNELS {
            return Err(self.exceeded(place, &format!("{MOST_CHANNELS} channels")));
        }
        self.add(channels.saturating_mul(rows), place)
    }

    /// Adds values of channels that are counted already.
    ///
    /// # Errors
    /// `too-many-values`.
    pub fn add(&mut self, values: usize, place: &str) -> Result<(), Problem> {
        self.values = self.values.saturating_add(values);
        if self.values > self.most {
            let most = self.most >> 20;
            return Err(self.exceeded(
                place,
                &format!("{most} million values, the maximum for a file of its size"),
            ));
        }
        Ok(())
    }

    fn exceeded(&self, place: &str, most: &str) -> Problem {
        let says = format!("{place} of `{}` declares more than {most}", self.shown);
        Problem::error("too-many-values", says)
            .help("check whether the file is damaged; else export it in parts, with fewer channels")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declared_sizes_are_counted_without_overflow() {
        let mut budget = Budget::new(1000, "f");
        assert!(budget.take(24, 1794, "table").is_ok());
        assert_eq!(
            budget.take(2, usize::MAX, "table").map_err(|problem| problem.code),
            Err("too-many-values")
        );
        assert!(budget.take(1, 1, "table").is_err());
        assert!(Budget::new(1000, "f").take(MOST_CHANNELS + 1, 0, "table").is_err());
        // A text of empty cells has eight bytes of numbers for each byte of the file.
        let mut largest = Budget::new(usize::try_from(LARGEST).expect("fits"), "f");
        assert!(largest.take(1, MOST_VALUES, "table").is_ok());
        assert!(largest.add(1, "table").is_err());
    }
}
