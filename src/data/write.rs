//! Every file the program makes: whole or not at all.

mod format;

pub use format::{Entry, OutColumn, campaign_yaml, record_csv, table_csv};

use std::fs;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

use tempfile::NamedTempFile;

use crate::problem::Problem;

/// Writes a file under a temporary name in the same folder, then renames it. The folder is made if missing.
///
/// # Errors
/// `write-failed`; the file is then as it was before.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = path.file_name().and_then(|name| name.to_str()).ok_or_else(|| failed(path, &"this is no file name"))?;
    let mut outputs = Outputs::new(folder);
    outputs.add(name, bytes)?;
    outputs.commit()
}

fn failed(path: &Path, why: &dyn std::fmt::Display) -> Problem {
    Problem::error("write-failed", format!("`{}` cannot be written: {why}", path.display()))
}

/// Files that belong together: all are written beside their places first, and put into place at the end.
///
/// Dropped without [`Outputs::commit`], nothing is left behind.
#[derive(Debug)]
pub struct Outputs {
    folder: PathBuf,
    written: Vec<(NamedTempFile, PathBuf)>,
    /// Folders that did not exist before, outermost first.
    made: Vec<PathBuf>,
}

impl Outputs {
    /// Outputs in a folder, which is made when the first file is added.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), written: Vec::new(), made: Vec::new() }
    }

    /// Adds a file, named by its path in the folder such as `tables/values.csv`.
    ///
    /// # Errors
    /// `write-failed`, `path-outside`.
    pub fn add(&mut self, inside: &str, bytes: &[u8]) -> Result<(), Problem> {
        let plain = Path::new(inside).components().all(|part| matches!(part, Component::Normal(_)));
        if inside.is_empty() || !plain {
            return Err(Problem::error("path-outside", format!("`{inside}` is no path inside the output folder")));
        }
        let path = self.folder.join(inside);
        let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf();
        self.make(&folder).map_err(|error| failed(&path, &error))?;
        let temporary = temporary(&folder, bytes).map_err(|error| failed(&path, &error))?;
        self.written.push((temporary, path));
        Ok(())
    }

    fn make(&mut self, folder: &Path) -> std::io::Result<()> {
        let missing: Vec<PathBuf> =
            folder.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists()).map(Path::to_path_buf).collect();
        self.made.extend(missing.into_iter().rev());
        fs::create_dir_all(folder)
    }

    /// Puts every file into its place. If one cannot be, those already put into new places are taken away again.
    ///
    /// # Errors
    /// `write-failed`.
    pub fn commit(mut self) -> Result<(), Problem> {
        let mut new = Vec::new();
        // What is most likely to fail is found before anything is renamed.
        if let Some((_, path)) = self.written.iter().find(|(_, path)| path.is_dir()) {
            return Err(failed(path, &"it is a folder"));
        }
        for (temporary, path) in std::mem::take(&mut self.written) {
            let existed = path.exists();
            if let Err(error) = temporary.persist(&path) {
                new.iter().for_each(|path: &PathBuf| drop(fs::remove_file(path)));
                return Err(failed(&path, &error.error));
            }
            if !existed {
                new.push(path);
            }
        }
        self.made.clear();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        self.written.clear();
        // Only empty folders go; what someone else put there meanwhile stays.
        self.made.iter().rev().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

fn temporary(folder: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".fishplate-");
    // Temporary files are private by default; an output has the permissions any new file gets.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.flush()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
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
        assert_eq!(names(&out), ["one.txt", "two.txt"]);
        assert_eq!(fs::read(out.join("one.txt")).expect("read"), b"new");
    }

    #[test]
    fn outputs_stay_in_their_folder() {
        let temp = tempfile::tempdir().expect("a temporary folder");
        let mut outputs = Outputs::new(temp.path());
        for bad in ["", "..", "../x", "/x", "a/../../x"] {
            assert_eq!(outputs.add(bad, b"").map_err(|problem| problem.code), Err("path-outside"), "{bad}");
        }
        fs::write(temp.path().join("file"), b"").expect("written");
        assert_eq!(outputs.add("file/x", b"").map_err(|problem| problem.code), Err("write-failed"));
    }
}
