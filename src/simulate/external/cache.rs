//! Records that were made before, by what they were made from.

use std::path::{Path, PathBuf};

use crate::data::hash::sha256;
use crate::data::write::write_whole;
use crate::problem::Problem;

/// Where records of other simulators are kept between runs; or nowhere.
#[derive(Clone, Debug, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// A cache in a folder, which is made.
    ///
    /// # Errors
    /// `write-failed`: it cannot be made.
    pub fn at(folder: &Path) -> Result<Self, Problem> {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
        std::fs::create_dir_all(&folder)
            .map_err(|error| Problem::error("write-failed", format!("the cache `{}` cannot be made: {error}", folder.display())))?;
        Ok(Self { folder: Some(folder) })
    }

    /// Keeps nothing.
    #[must_use]
    pub fn none() -> Self {
        Self { folder: None }
    }

    /// The cache that is used unless another is named: `fishplate-cache` in the system's folder for temporary files.
    ///
    /// # Errors
    /// `write-failed`: it cannot be made, or belongs to another user, who could put records there.
    pub fn temporary() -> Result<Self, Problem> {
        let cache = Self::at(&std::env::temp_dir().join("fishplate-cache"))?;
        #[cfg(unix)]
        if let Some(folder) = &cache.folder {
            use std::os::unix::fs::MetadataExt;
            let owner = std::fs::metadata(folder).map(|meta| meta.uid());
            if owner.is_ok_and(|owner| owner != rustix::process::getuid().as_raw()) {
                let says = format!("the cache `{}` belongs to another user", folder.display());
                return Err(Problem::error("write-failed", says).help("name a folder with `--cache DIR`, or keep none with `--no-cache`"));
            }
        }
        Ok(cache)
    }

    /// The file of a key, whether it is there or not.
    pub(super) fn file(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(key.get(..2)?).join(format!("{key}.csv")))
    }

    /// Keeps a record, whole or not at all.
    pub(super) fn keep(&self, key: &str, bytes: &[u8]) -> Result<(), Problem> {
        self.file(key).map_or(Ok(()), |path| write_whole(&path, bytes))
    }
}

/// What a record depends on, gathered into a key.
#[derive(Clone, Debug, Default)]
pub(super) struct Key {
    text: String,
}

impl Key {
    /// Adds a part; no two lists of parts give the same text.
    pub fn add(&mut self, what: &str, value: &str) {
        self.text += &format!("{what}:{}:{value}\n", value.len());
    }

    /// Adds the content of a file.
    ///
    /// # Errors
    /// `file-unreadable`.
    pub fn add_file(&mut self, what: &str, path: &Path) -> Result<(), Problem> {
        let bytes = std::fs::read(path)
            .map_err(|error| Problem::error("file-unreadable", format!("`{}` cannot be read: {error}", path.display())))?;
        self.add(what, &sha256(&bytes));
        Ok(())
    }

    /// 64 hexadecimal digits.
    pub fn finish(&self) -> String {
        sha256(self.text.as_bytes())
    }
}
