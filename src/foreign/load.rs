//! The bytes of a file, and the limits of what is read from it.

use std::io::Read;
use std::path::Path;

use crate::disk::{self, Kind};
use crate::problem::Problem;

/// Maximum size of a file in bytes, as for a record of a campaign.
const LARGEST: u64 = 1 << 30;

/// Maximum number of values of a file: 2 GB of numbers, a hundred channels at 1 kHz for 45 minutes.
/// A compressed file can hold more than its size suggests.
pub(super) const MOST_VALUES: usize = 1 << 28;

/// Maximum number of channels of a file; a large measuring system has some thousands.
pub(super) const MOST_CHANNELS: usize = 100_000;

/// All bytes of a plain file.
pub(super) fn bytes(path: &Path, shown: &str) -> Result<Vec<u8>, Vec<Problem>> {
    let unreadable = |why: &dyn std::fmt::Display| {
        vec![Problem::error("file-unreadable", format!("`{shown}` {} {why}", crate::data::text::UNREADABLE))]
    };
    let too_large = |size: u64| {
        let says = format!("`{shown}` has {} MB; the maximum is {} MB", size >> 20, LARGEST >> 20);
        vec![Problem::error("file-too-large", says).help("export it in parts, or leave out channels that are not needed")]
    };
    // Other kinds are refused before they are opened, since reading a pipe could block for ever.
    let size = match disk::kind(path).map_err(|error| unreadable(&error))? {
        None => return Err(vec![Problem::error("file-missing", format!("there is no file `{shown}`"))]),
        Some(Kind::Folder) => return Err(unreadable(&"it is a folder")),
        Some(Kind::Other) => return Err(unreadable(&"it is not a plain file")),
        Some(Kind::File(size)) if size > LARGEST => return Err(too_large(size)),
        Some(Kind::File(size)) => size,
    };
    let mut bytes = Vec::new();
    let wanted = usize::try_from(size).unwrap_or(usize::MAX).saturating_add(1);
    disk::reserve(&mut bytes, wanted, path).map_err(|error| unreadable(&error))?;
    let file = disk::open(path).map_err(|error| unreadable(&error))?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    match bytes.len() as u64 {
        0 => Err(vec![Problem::error("file-empty", format!("`{shown}` is empty"))]),
        grown if grown > LARGEST => Err(too_large(grown)),
        _ => Ok(bytes),
    }
}

/// Counts the values of a file.
#[derive(Debug, Default)]
pub(super) struct Budget {
    values: usize,
    channels: usize,
}

impl Budget {
    /// Adds channels of so many values each.
    pub fn take(&mut self, channels: usize, rows: usize, shown: &str) -> Result<(), Problem> {
        let values = channels.checked_mul(rows).and_then(|more| self.values.checked_add(more));
        self.channels = self.channels.saturating_add(channels);
        self.values = values.unwrap_or(usize::MAX);
        if self.channels > MOST_CHANNELS {
            let says = format!("`{shown}` has more than {MOST_CHANNELS} channels");
            return Err(Problem::error("too-many-values", says).help("export only the channels that are needed"));
        }
        if self.values > MOST_VALUES {
            let says = format!("`{shown}` has more than {} million values", MOST_VALUES >> 20);
            return Err(Problem::error("too-many-values", says).help("export it in parts, or leave out channels that are not needed"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declared_sizes_are_counted_without_overflow() {
        let mut budget = Budget::default();
        assert!(budget.take(24, 1794, "f").is_ok());
        assert_eq!(budget.take(2, usize::MAX, "f").map_err(|problem| problem.code), Err("too-many-values"));
        assert!(budget.take(1, 1, "f").is_err());
        assert!(Budget::default().take(MOST_CHANNELS + 1, 0, "f").is_err());
    }
}
