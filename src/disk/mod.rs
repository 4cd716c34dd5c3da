//! Access to the file system: every read, write, rename, sync and removal goes through this module.
//!
//! A test can therefore let any single operation fail, or end the program there, and check the
//! result ([`faults`]). A test of the layers forbids `std::fs` everywhere else.
//!
//! | file | content |
//! |---|---|
//! | `mod` | single operations |
//! | `faults` | test hook |
//! | `single` | one file, completely or not at all |
//! | `set` | sets of files with one commit point |
//! | `journal` | files that a set replaces, written before the commit point |

pub mod faults;
mod journal;
mod set;
mod single;

use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, ErrorKind, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use faults::{Op, pass, passed};
pub use set::{SIGNATURE, Set, SetKind, UNFINISHED};
pub use single::{create_new, folder_of, keep, remove, replace, write_whole};
pub use tempfile::TempDir as Scratch;

/// Kind of the object at a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A plain file and its size in bytes.
    File(u64),
    Folder,
    /// A pipe, a device, a socket.
    Other,
}

/// The kind of the object at a path, following symbolic links; `None` if nothing exists.
///
/// # Errors
/// The system's error, except for a path that does not exist.
pub fn kind(path: &Path) -> io::Result<Option<Kind>> {
    let meta = looked(path, fs::metadata)?;
    Ok(meta.map(|meta| match meta.file_type() {
        kind if kind.is_file() => Kind::File(meta.len()),
        kind if kind.is_dir() => Kind::Folder,
        _ => Kind::Other,
    }))
}

/// What the system says of a path; `None` if nothing exists.
fn looked<'a, T>(
    path: &'a Path,
    look: impl Fn(&'a Path) -> io::Result<T>,
) -> io::Result<Option<T>> {
    pass(Op::Look, path)?;
    match look(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if missing(&error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether an error means that nothing exists at the path.
pub fn missing(error: &io::Error) -> bool {
    // A name that is too long or contains NUL cannot exist.
    matches!(
        error.kind(),
        ErrorKind::NotFound
            | ErrorKind::NotADirectory
            | ErrorKind::InvalidFilename
            | ErrorKind::InvalidInput
    )
}

/// Whether a plain file exists.
///
/// # Errors
/// As [`kind`].
pub fn is_file(path: &Path) -> io::Result<bool> {
    Ok(matches!(kind(path)?, Some(Kind::File(_))))
}

/// Whether a plain file exists, or the system gives an error; the error is then reported when the
/// file is read.
pub fn may_be_file(path: &Path) -> bool {
    is_file(path).unwrap_or(true)
}

/// Whether anything exists, or the system gives an error.
pub fn may_exist(path: &Path) -> bool {
    kind(path).map_or(true, |kind| kind.is_some())
}

/// Whether a folder exists.
///
/// # Errors
/// As [`kind`].
pub fn is_folder(path: &Path) -> io::Result<bool> {
    Ok(matches!(kind(path)?, Some(Kind::Folder)))
}

/// Whether a path is a symbolic link, with or without a target.
///
/// # Errors
/// As [`kind`].
pub fn is_link(path: &Path) -> io::Result<bool> {
    Ok(looked(path, fs::symlink_metadata)?.is_some_and(|meta| meta.is_symlink()))
}

/// The absolute path without symbolic links; `None` if nothing exists.
///
/// # Errors
/// As [`kind`].
pub fn real(path: &Path) -> io::Result<Option<PathBuf>> {
    looked(path, dunce::canonicalize)
}

/// The user who owns a file or folder.
///
/// # Errors
/// The system's error.
#[cfg(unix)]
pub fn owner(path: &Path) -> io::Result<u32> {
    use std::os::unix::fs::MetadataExt;
    pass(Op::Look, path)?;
    fs::metadata(path).map(|meta| meta.uid())
}

/// The names in a folder, sorted.
///
/// # Errors
/// The system's error.
pub fn names(folder: &Path) -> io::Result<Vec<OsString>> {
    pass(Op::List, folder)?;
    let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name()));
    let mut names = names.collect::<io::Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// A file open for reading.
#[derive(Debug)]
pub struct Reader {
    file: File,
    path: PathBuf,
}

/// Opens a file for reading. The caller must exclude other kinds before: reading a pipe could block
/// for ever.
///
/// # Errors
/// The system's error.
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

impl Seek for Reader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// The size of a plain file. Other kinds are refused before they are opened, since reading a pipe
/// could block for ever.
///
/// # Errors
/// Not a plain file; the system's error.
pub fn size(path: &Path) -> io::Result<u64> {
    match kind(path)? {
        Some(Kind::File(size)) => Ok(size),
        Some(Kind::Folder) => Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder")),
        Some(Kind::Other) => Err(io::Error::other("it is not a plain file")),
        None => Err(ErrorKind::NotFound.into()),
    }
}

/// Reads a plain file.
///
/// # Errors
/// Not a plain file; more than `limit` bytes (`FileTooLarge`); the system's error.
pub fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let size = size(path)?;
    let too_large =
        || io::Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MB", limit >> 20));
    if size > limit {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    reserve(&mut bytes, usize::try_from(size).unwrap_or(usize::MAX).saturating_add(1), path)?;
    let file = open(path)?.file;
    pass(Op::Read, path)?;
    // The system's file, which needs no cleared memory to read into.
    file.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(too_large()) } else { Ok(bytes) }
}

/// What the system says of a process: `environ`, its variables, each terminated by a zero; `stat`.
///
/// # Errors
/// The process has ended, or belongs to another user.
#[cfg(target_os = "linux")]
pub fn of_process(id: i32, what: &str) -> io::Result<Vec<u8>> {
    let path = PathBuf::from(format!("/proc/{id}/{what}"));
    let mut bytes = Vec::new();
    open(&path)?.take(LARGEST_VARIABLES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Maximum size of the environment variables of a process in bytes, which is the limit of Linux.
#[cfg(target_os = "linux")]
const LARGEST_VARIABLES: u64 = 4 << 20;

/// Reserves memory for more elements; an error instead of an abort.
///
/// # Errors
/// `OutOfMemory`.
pub fn reserve<T>(of: &mut Vec<T>, more: usize, path: &Path) -> io::Result<()> {
    pass(Op::Reserve, path)?;
    of.try_reserve_exact(more)
        .map_err(|_| io::Error::new(ErrorKind::OutOfMemory, "there is not enough memory"))
}

/// A new file open for writing.
#[derive(Debug)]
pub(crate) struct Writer {
    file: File,
    path: PathBuf,
}

/// Creates a file that does not exist yet.
fn create(path: &Path) -> io::Result<Writer> {
    pass(Op::Create, path)?;
    Ok(Writer {
        file: File::options().write(true).create_new(true).open(path)?,
        path: path.to_path_buf(),
    })
}

impl Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err((error, torn)) = passed(Op::Write, &self.path, None) {
            // For tests: half of the bytes are written, as in a power failure.
            if torn {
                let _ = self.file.write_all(&bytes[..bytes.len() / 2]);
            }
            return Err(error);
        }
        self.file.write_all(bytes)
    }

    /// On return the bytes are on the disk.
    fn sync(&self) -> io::Result<()> {
        pass(Op::Sync, &self.path)?;
        self.file.sync_all()
    }
}

/// Threads that wait for the disk at the same time. More save little: on a local disk a wait is
/// about as short as a thread takes to begin.
const WAITING: usize = 4;

/// On return the bytes of all files are on the disk.
fn sync_together(files: &[Writer]) -> io::Result<()> {
    files.iter().try_for_each(|file| pass(Op::Sync, &file.path))?;
    let wait = |part: &[Writer]| part.iter().try_for_each(|file| file.file.sync_all());
    std::thread::scope(|scope| {
        let mut parts = files.chunks(files.len().div_ceil(WAITING).max(1));
        let own = parts.next().unwrap_or_default();
        let others: Vec<_> = parts
            .map(|part| (part, std::thread::Builder::new().spawn_scoped(scope, move || wait(part))))
            .collect();
        let ended = others.into_iter().map(|(part, thread)| match thread {
            Ok(thread) => thread.join().unwrap_or_else(|_| {
                Err(io::Error::other("a thread that waited for the disk ended"))
            }),
            // There are no more threads: this one waits.
            Err(_) => wait(part),
        });
        let first = wait(own);
        ended.fold(first, io::Result::and)
    })
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

/// Creates a folder and its parents; the created ones are added to `made`, outermost first.
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
    match is_folder(folder)? {
        true => Ok(()),
        false => Err(io::Error::new(ErrorKind::NotADirectory, "it is not a folder")),
    }
}

/// Creates a folder and its parents.
///
/// # Errors
/// The system's error; the path exists and is not a folder.
pub fn make_folder(folder: &Path) -> io::Result<()> {
    make_folders(folder, &mut Vec::new())
}

/// On return the names in the folder are on the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    pass(Op::Sync, folder)?;
    #[cfg(unix)]
    match File::open(folder)?.sync_all() {
        // Some network file systems do not support syncing a folder.
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => {}
        other => return other,
    }
    Ok(())
}

/// A lock on a folder against other runs that write there; released when dropped.
#[derive(Debug)]
struct Hold(
    #[cfg(unix)]
    #[expect(dead_code, reason = "open is what holds the lock")]
    File,
);

/// Locks a folder; `None` if the system does not support it.
fn hold(folder: &Path) -> io::Result<Option<Hold>> {
    pass(Op::Lock, folder)?;
    #[cfg(unix)]
    {
        let file = File::open(folder)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Hold(file))),
            Err(fs::TryLockError::WouldBlock) => {
                Err(io::Error::new(ErrorKind::ResourceBusy, "another run is writing there"))
            }
            // The file system does not support locks.
            Err(fs::TryLockError::Error(_)) => Ok(None),
        }
    }
    #[cfg(not(unix))]
    Ok(None)
}

/// A temporary folder, removed when dropped.
///
/// # Errors
/// The system's error.
pub fn scratch() -> io::Result<tempfile::TempDir> {
    pass(Op::Scratch, Path::new(""))?;
    tempfile::Builder::new().prefix("fishplate-").tempdir()
}

/// A temporary folder inside another one, removed when dropped.
///
/// # Errors
/// The system's error.
pub fn scratch_in(folder: &Path) -> io::Result<tempfile::TempDir> {
    pass(Op::Scratch, folder)?;
    tempfile::Builder::new().prefix("fishplate-").tempdir_in(folder)
}

/// A temporary file without a name, written and read at any place; removed when dropped.
#[derive(Debug)]
pub struct ScratchFile(File);

impl ScratchFile {
    /// An empty file on the disk of a folder.
    ///
    /// # Errors
    /// The system's error.
    pub fn new(folder: &Path) -> io::Result<Self> {
        pass(Op::Scratch, folder)?;
        tempfile::tempfile_in(folder).map(Self)
    }

    /// Writes bytes from a place on.
    ///
    /// # Errors
    /// The system's error.
    pub fn write_at(&mut self, start: u64, bytes: &[u8]) -> io::Result<()> {
        pass(Op::Write, Path::new(""))?;
        self.0.seek(SeekFrom::Start(start))?;
        self.0.write_all(bytes)
    }

    /// Fills the bytes from a place on.
    ///
    /// # Errors
    /// The system's error; `UnexpectedEof`.
    pub fn read_at(&mut self, start: u64, bytes: &mut [u8]) -> io::Result<()> {
        pass(Op::Read, Path::new(""))?;
        self.0.seek(SeekFrom::Start(start))?;
        self.0.read_exact(bytes)
    }
}

/// A temporary file without a name, removed when dropped.
///
/// # Errors
/// The system's error.
pub fn scratch_file() -> io::Result<File> {
    pass(Op::Scratch, Path::new(""))?;
    tempfile::tempfile()
}
