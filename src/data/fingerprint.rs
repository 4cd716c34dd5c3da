//! Hashes of the present files of a campaign, for comparison with a report.

use std::path::Path;

use super::{folder::Folder, hash::Hasher, text::unreadable};
use crate::data::prelude::*;
use crate::disk::{self, Kind};

/// SHA-256 and size of a file named by its path inside a campaign; `None` if there is no such file.
///
/// # Errors
/// `folder-missing`, `path-outside`, `path-invalid`, `file-unreadable`.
pub fn fingerprint(campaign: &Path, inside: &str) -> Result<Option<(String, u64)>, Problem> {
    let place = Folder::open(campaign)?.place(inside, &Source::new("", "").whole())?;
    of_file(&place.path, inside)
}

/// The same of any file; `shown` is its name in messages.
///
/// # Errors
/// `file-unreadable`.
pub fn of_file(path: &Path, shown: &str) -> Result<Option<(String, u64)>, Problem> {
    match disk::kind(path).map_err(unreadable(shown))? {
        Some(Kind::File(_)) => {}
        Some(_) => return Err(unreadable(shown)("it is not a plain file")),
        None => return Ok(None),
    }
    let mut hash = Hasher::default();
    let read = disk::open(path).and_then(|mut file| hash.add_all(&mut file));
    let bytes = read.map_err(unreadable(shown))?;
    Ok(Some((hash.finish(), bytes)))
}
