//! Hashes of the present files of a campaign, for comparison with a report.

use std::path::Path;

use super::folder::Folder;
use super::hash::Hasher;
use crate::disk::{self, Kind};
use crate::problem::Problem;
use crate::source::Source;

/// SHA-256 and size of a file named by its path inside a campaign; `None` if there is no such file.
///
/// # Errors
/// `folder-missing`, `path-outside`, `path-invalid`, `file-unreadable`.
pub fn fingerprint(campaign: &Path, inside: &str) -> Result<Option<(String, u64)>, Problem> {
    let place = Folder::open(campaign)?.place(inside, &Source::new("", "").whole())?;
    let unreadable = |why: &dyn std::fmt::Display| {
        Problem::error("file-unreadable", format!("`{inside}` cannot be read: {why}"))
    };
    match disk::kind(&place.path) {
        Ok(Some(Kind::File(_))) => {}
        Ok(Some(_)) => return Err(unreadable(&"it is not a plain file")),
        Ok(None) => return Ok(None),
        Err(error) => return Err(unreadable(&error)),
    }
    let mut file = disk::open(&place.path).map_err(|error| unreadable(&error))?;
    let mut hash = Hasher::default();
    let bytes = hash.add_all(&mut file).map_err(|error| unreadable(&error))?;
    Ok(Some((hash.finish(), bytes)))
}
