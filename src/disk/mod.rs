//! The only way to the file system: every read, write, rename, sync and removal of a run goes through here.
//!
//! One place, so that a test can let any single operation fail, or let the program end there, and look at what is
//! left ([`faults`]). A test of the layers refuses `std::fs` everywhere else.
//!
//! | file | what |
//! |---|---|
//! | `mod` | single operations |
//! | `faults` | the hook that tests use |
//! | `single` | one file, whole or not at all |
//! | `set` | files that belong together, with one commit point |
//! | `journal` | what a set replaces, as written before the commit point |

pub mod faults;
mod journal;
mod set;
mod single;

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use faults::{Op, pass, passed};
pub use set::{Set, SetKind, UNFINISHED};
pub use single::{create_new, keep, remove, write_whole};

/// What stands at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A plain file and its size in bytes.
    File(u64),
    Folder,
    /// A pipe, a device, a socket.
    Other,
}

/// What stands at a path, symbolic links followed; `None` if there is nothing.
///
/// # Errors
/// What the system says, but for a path that does not exist.
pub fn kind(path: &Path) -> io::Result<Option<Kind>> {
    pass(Op::Look, path)?;
    match fs::metadata(path) {
        Ok(meta) if meta.is_file() => Ok(Some(Kind::File(meta.len()))),
        Ok(meta) if meta.is_dir() => Ok(Some(Kind::Folder)),
        Ok(_) => Ok(Some(Kind::Other)),
        Err(error) if missing(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether an error says that there is nothing at the path.
pub fn missing(error: &io::Error) -> bool {
    // A name that is too long, or holds a NUL, is the name of nothing.
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidFilename | ErrorKind::InvalidInput)
}

/// Whether a plain file is there.
///
/// # Errors
/// As [`kind`].
pub fn is_file(path: &Path) -> io::Result<bool> {
    Ok(matches!(kind(path)?, Some(Kind::File(_))))
}

/// Whether a plain file is there, or the system cannot say: who reads it then tells why.
pub fn may_be_file(path: &Path) -> bool {
    is_file(path).unwrap_or(true)
}

/// Whether something is there, or the system cannot say.
pub fn may_exist(path: &Path) -> bool {
    kind(path).map_or(true, |kind| kind.is_some())
}

/// Whether a folder is there.
///
/// # Errors
/// As [`kind`].
pub fn is_folder(path: &Path) -> io::Result<bool> {
    Ok(matches!(kind(path)?, Some(Kind::Folder)))
}

/// Whether a path is a symbolic link, wherever that leads.
///
/// # Errors
/// As [`kind`].
pub fn is_link(path: &Path) -> io::Result<bool> {
    pass(Op::Look, path)?;
    match fs::symlink_metadata(path) {
        Ok(meta) => Ok(meta.is_symlink()),
        Err(error) if missing(&error) => Ok(false),
        Err(error) => Err(error),
    }
}

/// The absolute path without symbolic links; `None` if there is nothing.
///
/// # Errors
/// As [`kind`].
pub fn real(path: &Path) -> io::Result<Option<PathBuf>> {
    pass(Op::Look, path)?;
    match fs::canonicalize(path) {
        Ok(real) => Ok(Some(real)),
        Err(error) if missing(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// The user who owns a file or folder.
///
/// # Errors
/// What the system says.
#[cfg(unix)]
pub fn owner(path: &Path) -> io::Result<u32> {
    use std::os::unix::fs::MetadataExt;
    pass(Op::Look, path)?;
    fs::metadata(path).map(|meta| meta.uid())
}

/// The names in a folder, sorted.
///
/// # Errors
/// What the system says.
pub fn names(folder: &Path) -> io::Result<Vec<OsString>> {
    pass(Op::List, folder)?;
    let mut names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect::<io::Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// A file open for reading.
#[derive(Debug)]
pub struct Reader {
    file: File,
    path: PathBuf,
}

/// Opens a file for reading. What is no plain file should have been refused before: a pipe would wait for ever.
///
/// # Errors
/// What the system says.
pub fn open(path: &Path) -> io::Result<Reader> {
    pass(Op::Open, path)?;
    Ok(Reader { file: File::open(path)?, path: path.to_path_buf() })
}

impl Read for Reader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        pass(Op::Read, &self.path)?;
        self.file.read(buffer)
    }
}

/// Appends to a buffer what is left of a plain file.
///
/// # Errors
/// It is no plain file, or has more than `limit` bytes (`FileTooLarge`); what the system says.
pub fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let size = match kind(path)? {
        Some(Kind::File(size)) => size,
        Some(Kind::Folder) => return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder")),
        Some(Kind::Other) => return Err(io::Error::other("it is no plain file")),
        None => return Err(ErrorKind::NotFound.into()),
    };
    let too_large = || io::Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MB", limit >> 20));
    if size > limit {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    reserve(&mut bytes, usize::try_from(size).unwrap_or(usize::MAX).saturating_add(1), path)?;
    open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(too_large()) } else { Ok(bytes) }
}

/// The variables of a process, each ended by a zero.
///
/// # Errors
/// It is gone, or belongs to another user.
#[cfg(target_os = "linux")]
pub fn process_variables(id: i32) -> io::Result<Vec<u8>> {
    let path = PathBuf::from(format!("/proc/{id}/environ"));
    let mut bytes = Vec::new();
    open(&path)?.take(LARGEST_VARIABLES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Largest variables of a process in bytes: as much as Linux hands to a program.
#[cfg(target_os = "linux")]
const LARGEST_VARIABLES: u64 = 4 << 20;

/// Room for more elements, or an error in place of the end of the program.
///
/// # Errors
/// `OutOfMemory`.
pub fn reserve<T>(of: &mut Vec<T>, more: usize, path: &Path) -> io::Result<()> {
    pass(Op::Reserve, path)?;
    of.try_reserve_exact(more).map_err(|_| io::Error::new(ErrorKind::OutOfMemory, "there is not enough memory"))
}

/// A new file open for writing.
#[derive(Debug)]
pub(crate) struct Writer {
    file: File,
    path: PathBuf,
}

/// Makes a file that does not exist yet.
fn create(path: &Path) -> io::Result<Writer> {
    pass(Op::Create, path)?;
    Ok(Writer { file: File::options().write(true).create_new(true).open(path)?, path: path.to_path_buf() })
}

impl Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err((error, torn)) = passed(Op::Write, &self.path, None) {
            // Half of it is on the disk, as where the power went.
            if torn {
                let _ = self.file.write_all(&bytes[..bytes.len() / 2]);
            }
            return Err(error);
        }
        self.file.write_all(bytes)
    }

    /// On return the bytes are on the disk, not on their way.
    fn sync(&self) -> io::Result<()> {
        pass(Op::Sync, &self.path)?;
        self.file.sync_all()
    }
}

fn rename(from: &Path, to: &Path) -> io::Result<()> {
    passed(Op::Rename, from, Some(to)).map_err(|(error, _)| error)?;
    fs::rename(from, to)
}

fn remove_file(path: &Path) -> io::Result<()> {
    pass(Op::Remove, path)?;
    fs::remove_file(path)
}

/// Removes a folder if it is empty.
fn remove_folder(path: &Path) -> io::Result<()> {
    pass(Op::Remove, path)?;
    fs::remove_dir(path)
}

/// Makes a folder and those above it; those that did not exist are added to `made`, outermost first.
pub(crate) fn make_folders(folder: &Path, made: &mut Vec<PathBuf>) -> io::Result<()> {
    let mut lacking = Vec::new();
    for above in folder.ancestors().take_while(|above| !above.as_os_str().is_empty()) {
        if kind(above)?.is_some() {
            break;
        }
        lacking.push(above.to_path_buf());
    }
    for folder in lacking.into_iter().rev() {
        pass(Op::MakeFolder, &folder)?;
        match fs::create_dir(&folder) {
            Ok(()) => made.push(folder),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    if is_folder(folder)? { Ok(()) } else { Err(io::Error::new(ErrorKind::NotADirectory, "it is no folder")) }
}

/// Makes a folder and those above it.
///
/// # Errors
/// What the system says; something else is there.
pub fn make_folder(folder: &Path) -> io::Result<()> {
    make_folders(folder, &mut Vec::new())
}

/// On return the names in the folder are on the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    pass(Op::Sync, folder)?;
    #[cfg(unix)]
    match File::open(folder)?.sync_all() {
        // Some network file systems know no such thing.
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => {}
        other => return other,
    }
    Ok(())
}

/// A folder held against other runs that write there. It is let go when it is dropped, or the program ends.
#[derive(Debug)]
struct Hold(
    #[cfg(unix)]
    #[expect(dead_code, reason = "open is what holds the lock")]
    File,
);

/// Holds a folder; `None` where the system cannot.
fn hold(folder: &Path) -> io::Result<Option<Hold>> {
    pass(Op::Lock, folder)?;
    #[cfg(unix)]
    {
        let file = File::open(folder)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Hold(file))),
            Err(fs::TryLockError::WouldBlock) => Err(io::Error::new(ErrorKind::ResourceBusy, "another run is writing there")),
            // A file system without locks.
            Err(fs::TryLockError::Error(_)) => Ok(None),
        }
    }
    #[cfg(not(unix))]
    Ok(None)
}

/// A folder for files of this run alone, gone when it is dropped.
///
/// # Errors
/// What the system says.
pub fn scratch() -> io::Result<tempfile::TempDir> {
    pass(Op::Scratch, Path::new(""))?;
    tempfile::Builder::new().prefix("fishplate-").tempdir()
}

/// A file without a name, gone when it is dropped.
///
/// # Errors
/// What the system says.
pub fn scratch_file() -> io::Result<File> {
    pass(Op::Scratch, Path::new(""))?;
    tempfile::tempfile()
}
