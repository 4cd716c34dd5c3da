//! Output files, written completely or not at all.

mod columnar;
mod digits;
mod format;

pub use columnar::{FileColumn, Layout, Values, parquet, parquet_in_groups, properties};
pub use digits::Digits;
pub use format::{
    Entry, OutColumn, campaign_yaml, campaign_yaml_with, csv, csv_header, csv_rows, in_format,
    record, record_csv, table_csv, yaml_text,
};

use std::{
    io,
    path::{Path, PathBuf},
};

use crate::disk::{self, ScratchFile, Set, SetKind};
use crate::problem::{Problem, problem};

/// Writes a file under a temporary name in the same folder, then renames it. The folder is created
/// if missing.
///
/// # Errors
/// `write-failed`; the file is then unchanged.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    written(path, bytes, disk::write_whole)
}

/// As [`write_whole`], for a name that the user did not give: a symbolic link there is replaced, not
/// followed.
///
/// # Errors
/// As [`write_whole`].
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    written(path, bytes, disk::replace)
}

/// As [`write_whole`], for files that may be lost in a power failure, such as a cache.
///
/// # Errors
/// As [`write_whole`].
pub fn keep(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    written(path, bytes, disk::keep)
}

fn written(
    path: &Path,
    bytes: &[u8],
    how: fn(&Path, &[u8]) -> io::Result<()>,
) -> Result<(), Problem> {
    if path.file_name().is_none() {
        return Err(failed(path)("this is not a file name"));
    }
    let done =
        disk::make_folder(disk::folder_of(path)).and_then(|()| match disk::is_folder(path)? {
            true => Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")),
            false => how(path, bytes),
        });
    done.map_err(failed(path))
}

fn failed<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Problem {
    move |why| problem!("write-failed", "`{}` cannot be written: {why}", path.display())
}

/// A set of files: none is in its place before all are on the disk, and a previous set is removed
/// from its places first.
///
/// If dropped without [`Outputs::commit`], nothing is changed.
#[derive(Debug)]
pub struct Outputs {
    folder: PathBuf,
    set: Set,
}

impl Outputs {
    /// A report in a folder, which is created when the first file is added.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self::of(SetKind::Report, folder)
    }

    /// A set of a kind.
    pub fn of(kind: SetKind, folder: impl Into<PathBuf>) -> Self {
        let folder = folder.into();
        Self { set: Set::new(&folder, kind), folder }
    }

    /// The same in a folder that does not outlive the run.
    pub fn for_this_run(mut self) -> Self {
        self.set.unsynced();
        self
    }

    /// Adds a file by its path in the folder, such as `tables/values.csv`.
    ///
    /// # Errors
    /// `write-failed`, `path-outside`.
    pub fn add(&mut self, inside: &str, bytes: &[u8]) -> Result<(), Problem> {
        self.set.add(inside, bytes).map_err(|error| self.not_added(inside, error))
    }

    /// Adds a file that is written in parts.
    ///
    /// # Errors
    /// As [`Outputs::add`]; that of `fill`.
    pub fn add_in_parts(
        &mut self,
        inside: &str,
        fill: impl FnOnce(&mut (dyn io::Write + Send)) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let mut file = self.set.open(inside).map_err(|error| self.not_added(inside, error))?;
        fill(&mut file)?;
        self.set.close(file).map_err(|error| self.not_added(inside, error))
    }

    /// The files that were added, in this order, with their SHA-256.
    pub fn hashes(&self) -> impl DoubleEndedIterator<Item = (&str, &str)> {
        self.set.hashes()
    }

    /// A temporary file without a name on the disk of the folder, for what does not fit into the
    /// memory.
    ///
    /// # Errors
    /// `write-failed`.
    pub fn scratch_file(&mut self) -> Result<ScratchFile, Problem> {
        self.set.scratch_file().map_err(failed(&self.folder))
    }

    fn not_added(&self, inside: &str, error: io::Error) -> Problem {
        if error.kind() != io::ErrorKind::InvalidInput {
            return failed(&self.set.path(inside))(error);
        }
        problem!(
            "path-outside",
            "`{inside}` is not a path inside the output folder, or is given twice"
        )
    }

    /// A warning if the set of an interrupted run was completed.
    pub fn mended(&self) -> Option<Problem> {
        let says = format!(
            "an earlier run was interrupted while it wrote to `{}`; its files were put into place",
            self.folder.display()
        );
        self.set.mended().then(|| Problem::warning("unfinished-set", says))
    }

    /// Puts every file into its place, and removes files of the previous set that are not in this
    /// one.
    ///
    /// # Errors
    /// `write-failed`; the previous set is then complete.
    pub fn commit(self) -> Result<(), Problem> {
        let Self { folder, set } = self;
        set.commit().map_err(failed(&folder))
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn all_or_nothing() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let out = temp.path().join("a/b");
        {
            let mut outputs = Outputs::new(&out);
            outputs.add("one.txt", b"1").expect("added");
            outputs.add("sub/two.txt", b"2").expect("added");
            assert!(!out.join("one.txt").exists());
        }
        assert!(names(temp.path()).is_empty());

        fs::create_dir_all(out.join("two.txt")).expect("made");
        let mut outputs = Outputs::new(&out);
        outputs.add("one.txt", b"1").expect("added");
        outputs.add("two.txt", b"2").expect("added");
        assert_eq!(outputs.commit().map_err(|problem| problem.code), Err("write-failed"));
        assert_eq!(names(&out), ["two.txt"]);

        fs::remove_dir(out.join("two.txt")).expect("removed");
        write_whole(&out.join("one.txt"), b"old").expect("written");
        let mut outputs = Outputs::new(&out);
        outputs.add("one.txt", b"new").expect("added");
        outputs.add("two.txt", b"2").expect("added");
        outputs.commit().expect("committed");
        assert_eq!(names(&out), [".fishplate-report.sha256", "one.txt", "two.txt"]);
        assert_eq!(fs::read(out.join("one.txt")).expect("read"), b"new");
    }

    #[test]
    fn outputs_stay_in_their_folder() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let mut outputs = Outputs::new(temp.path());
        for bad in ["", "..", "../x", "/x", "a/../../x"] {
            assert_eq!(
                outputs.add(bad, b"").map_err(|problem| problem.code),
                Err("path-outside"),
                "{bad}"
            );
        }
        fs::write(temp.path().join("file"), b"").expect("written");
        outputs.add("file/x", b"").expect("beside its place");
        assert_eq!(outputs.commit().map_err(|problem| problem.code), Err("write-failed"));
        assert_eq!(names(temp.path()), ["file"]);
    }
}
