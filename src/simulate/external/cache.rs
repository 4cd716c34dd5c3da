//! Cache of records of external simulators, keyed by their inputs.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

use crate::data::{hash::sha256, text::LARGEST_RECORD, write::keep};
use crate::disk;
use crate::problem::Problem;

/// Folder of the cached records, if any.
#[derive(Clone, Debug, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
    /// Entries whose checksum does not match.
    damaged: Arc<Mutex<Vec<PathBuf>>>,
}

/// Start of the last line of an entry; the checksum of key and record follows.
const SEAL: &str = "# fishplate record, SHA-256 ";

impl Cache {
    /// A cache in a folder, which is created.
    ///
    /// # Errors
    /// `write-failed`: it cannot be created.
    pub fn at(folder: &Path) -> Result<Self, Problem> {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_path_buf());
        disk::make_folder(&folder).map_err(|error| {
            Problem::error(
                "write-failed",
                format!("the cache `{}` cannot be created: {error}", folder.display()),
            )
        })?;
        Ok(Self { folder: Some(folder), damaged: Arc::default() })
    }

    /// A cache that stores nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// The default cache: `fishplate-cache` in the system's temporary folder.
    ///
    /// # Errors
    /// `write-failed`: it cannot be created, or belongs to another user, who could change its
    /// records.
    pub fn temporary() -> Result<Self, Problem> {
        let cache = Self::at(&std::env::temp_dir().join("fishplate-cache"))?;
        #[cfg(unix)]
        if let Some(folder) = &cache.folder
            && !disk::owner(folder).is_ok_and(|owner| owner == rustix::process::getuid().as_raw())
        {
            let says = format!("the cache `{}` belongs to another user", folder.display());
            return Err(Problem::error("write-failed", says)
                .help("give a folder with `--cache DIR`, or use none with `--no-cache`"));
        }
        Ok(cache)
    }

    /// A temporary folder inside, for who sees this folder only.
    ///
    /// # Errors
    /// The system's error.
    pub(super) fn scratch(&self) -> std::io::Result<disk::Scratch> {
        self.folder.as_deref().map_or_else(disk::scratch, disk::scratch_in)
    }

    /// The path of an entry, whether it exists or not.
    fn file(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(key.get(..2)?).join(format!("{key}.csv")))
    }

    /// The record of a key; nothing if there is none or its checksum does not match.
    pub(super) fn get(&self, key: &str) -> Option<Vec<u8>> {
        let path = self.file(key)?;
        let bytes = match disk::kind(&path) {
            Ok(None) => return None,
            Ok(Some(_)) => disk::read(&path, LARGEST_RECORD).ok(),
            Err(_) => None,
        };
        let record = bytes.and_then(|bytes| {
            let end = memchr::memmem::rfind(&bytes, SEAL.as_bytes())?;
            let found =
                bytes[end + SEAL.len()..].trim_ascii_end() == seal(key, &bytes[..end]).as_bytes();
            found.then(|| bytes[..end].to_vec())
        });
        if record.is_none() {
            self.is_damaged(key);
        }
        record
    }

    /// Marks the entry of a key as damaged.
    pub(super) fn is_damaged(&self, key: &str) {
        if let (Some(path), Ok(mut damaged)) = (self.file(key), self.damaged.lock()) {
            damaged.push(path);
        }
    }

    /// A warning of damaged entries; their records were simulated again.
    pub(super) fn warning(&self) -> Option<Problem> {
        let mut damaged = self.damaged.lock().ok()?;
        let first = damaged.iter().min()?.display().to_string();
        let says = match damaged.len() {
            1 => format!("the cache entry `{first}` is damaged; its record was simulated again"),
            count => format!(
                "{count} cache entries are damaged, among them `{first}`; their records were simulated again"
            ),
        };
        damaged.clear();
        Some(Problem::warning("cache-damaged", says))
    }

    /// Stores a record, completely or not at all.
    pub(super) fn keep(&self, key: &str, bytes: &[u8]) -> Result<(), Problem> {
        let Some(path) = self.file(key) else { return Ok(()) };
        let sealed = [bytes, SEAL.as_bytes(), seal(key, bytes).as_bytes(), b"\n"].concat();
        keep(&path, &sealed)
    }
}

/// Checksum of key and record, so that an entry under a wrong key is detected as well.
fn seal(key: &str, bytes: &[u8]) -> String {
    sha256(&[key.as_bytes(), b"\n", bytes].concat())
}

/// Hash of all inputs of a record.
#[derive(Clone, Debug, Default)]
pub struct Key {
    text: String,
}

impl Key {
    /// Adds a part; different lists of parts give different texts.
    pub fn add(&mut self, what: &str, value: &str) {
        self.text += &format!("{what}:{}:{value}\n", value.len());
    }

    /// Adds the content of a file.
    ///
    /// # Errors
    /// `file-unreadable`.
    pub fn add_file(&mut self, what: &str, path: &Path) -> Result<(), Problem> {
        let bytes = disk::read(path, LARGEST_RECORD).map_err(|error| {
            Problem::error(
                "file-unreadable",
                format!("`{}` cannot be read: {error}", path.display()),
            )
        })?;
        self.add(what, &sha256(&bytes));
        Ok(())
    }

    /// 64 hexadecimal digits.
    pub fn finish(&self) -> String {
        sha256(self.text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_what_was_kept_or_nothing() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::at(temp.path()).expect("made");
        let keys = ["aa".repeat(32), "ab".repeat(32)];
        assert_eq!((cache.get(&keys[0]), cache.warning()), (None, None));
        for key in &keys {
            cache.keep(key, format!("record of {key}\n").as_bytes()).expect("kept");
            assert_eq!(cache.get(key), Some(format!("record of {key}\n").into_bytes()));
        }
        assert_eq!(cache.warning(), None);
        let paths = keys.each_ref().map(|key| cache.file(key).expect("a path"));
        let first = std::fs::read(&paths[0]).expect("read");

        // Every byte changed, and every length except the full one.
        for at in 0..first.len() - 1 {
            let mut bytes = first.clone();
            bytes[at] ^= 1;
            std::fs::write(&paths[0], &bytes).expect("written");
            assert_eq!(cache.get(&keys[0]), None, "byte {at}");
            std::fs::write(&paths[0], &first[..at]).expect("written");
            assert_eq!(cache.get(&keys[0]), None, "{at} bytes");
        }
        // Another record, itself undamaged.
        std::fs::copy(&paths[1], &paths[0]).expect("copied");
        assert_eq!(cache.get(&keys[0]), None);
        let warning = cache.warning().expect("told");
        assert!(
            warning.code == "cache-damaged" && warning.says.contains("cache entries are damaged"),
            "{}",
            warning.says
        );
        assert_eq!(cache.warning(), None);
    }

    /// Pipes and devices could block or have no end.
    #[cfg(unix)]
    #[test]
    fn only_plain_files_are_read() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::at(temp.path()).expect("made");
        let key = "aa".repeat(32);
        let path = cache.file(&key).expect("a path");
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::os::unix::fs::symlink("/dev/zero", &path).expect("linked");
        assert_eq!(cache.get(&key), None);
        assert!(cache.warning().is_some());
        std::fs::remove_file(&path).expect("removed");
        let made = std::process::Command::new("mkfifo").arg(&path).status().expect("mkfifo runs");
        assert!(made.success());
        assert_eq!(cache.get(&key), None);
        cache.keep(&key, b"x").expect("takes the place of the pipe");
        assert_eq!(cache.get(&key), Some(b"x".to_vec()));
        std::fs::remove_file(&path).expect("removed");
        std::fs::create_dir(&path).expect("made");
        assert_eq!(cache.get(&key), None);
        assert!(cache.keep(&key, b"x").is_err());
    }
}
