//! Writes one file completely or not at all.

use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering},
};

use super::{
    Kind, Op, Writer, create, is_link, kind, names, pass, real, remove_file, rename, sync_folder,
};

/// Prefix of temporary files.
const BEGINS: &str = ".fishplate-";
/// Suffix of temporary files.
const ENDS: &str = ".tmp";
/// Number of temporary names tried; a name is taken only if a run with the same process number left
/// one.
const MOST_NAMES: usize = 100;

/// Writes a file under a temporary name in the same folder, which must exist, and renames it. On
/// return it is on the disk. A symbolic link stays: its target is written. A device or a pipe stays
/// too: the bytes go into it.
///
/// # Errors
/// The system's error; the file is then unchanged.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if matches!(kind(path)?, Some(Kind::Other)) {
        pass(Op::Create, path)?;
        return fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let target =
        if is_link(path)? { Some(real(path)?.ok_or(io::ErrorKind::NotFound)?) } else { None };
    replace(target.as_deref().unwrap_or(path), bytes)
}

/// As [`write_whole`], for a name that the user did not give: what is there is replaced, also if it
/// is a symbolic link or a device.
///
/// # Errors
/// As [`write_whole`].
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = folder_of(path);
    sweep(folder);
    put(path, folder, bytes, true)?;
    sync_folder(folder)
}

/// As [`write_whole`], for files that may be lost in a power failure, such as a cache.
///
/// # Errors
/// As [`write_whole`].
pub fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, folder_of(path), bytes, false)
}

/// Writes a file that must not exist; only the owner can read a secret one. On return it is on the
/// disk.
///
/// # Errors
/// The system's error; there is then no file.
pub fn create_new(path: &Path, bytes: &[u8], secret: bool) -> io::Result<()> {
    pass(Op::Create, path)?;
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, if secret { 0o600 } else { 0o644 });
    #[cfg(not(unix))]
    let _ = secret;
    let mut file = options.open(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    written.inspect_err(|_| {
        let _ = remove_file(path);
    })
}

/// Removes a file.
///
/// # Errors
/// The system's error.
pub fn remove(path: &Path) -> io::Result<()> {
    remove_file(path)
}

/// The folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn put(path: &Path, folder: &Path, bytes: &[u8], sync: bool) -> io::Result<()> {
    let (mut file, temporary) = begin(folder)?;
    let written = file.write(bytes).and_then(|()| if sync { file.sync() } else { Ok(()) });
    let placed = written.and_then(|()| rename(&temporary, path));
    if placed.is_err() {
        let _ = remove_file(&temporary);
    }
    placed
}

/// Creates a temporary file and locks it, so that no other run removes it.
fn begin(folder: &Path) -> io::Result<(Writer, PathBuf)> {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    for _ in 0..MOST_NAMES {
        let name = format!(
            "{BEGINS}{}-{}{ENDS}",
            std::process::id(),
            NEXT.fetch_add(1, Ordering::Relaxed)
        );
        let path = folder.join(name);
        match create(&path) {
            Ok(file) if held(&file) => return Ok((file, path)),
            // Another run removed it before it was locked.
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Locks a new file, so that it is not removed; returns whether it still has a name.
fn held(file: &Writer) -> bool {
    match file.file.try_lock() {
        Ok(()) => linked(file),
        Err(std::fs::TryLockError::WouldBlock) => false,
        // The file system does not support locks.
        Err(std::fs::TryLockError::Error(_)) => true,
    }
}

#[cfg(unix)]
fn linked(file: &Writer) -> bool {
    use std::os::unix::fs::MetadataExt;
    file.file.metadata().map_or(true, |meta| meta.nlink() > 0)
}

#[cfg(not(unix))]
fn linked(_: &Writer) -> bool {
    true
}

/// Removes temporary files of interrupted runs. Failure has no consequence.
fn sweep(folder: &Path) {
    for name in names(folder).unwrap_or_default() {
        let Some(name) =
            name.to_str().filter(|name| name.starts_with(BEGINS) && name.ends_with(ENDS))
        else {
            continue;
        };
        let path = folder.join(name);
        // The writer of a file has it locked.
        if super::is_file(&path).unwrap_or(false)
            && let Ok(file) = std::fs::File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = remove_file(&path);
        }
    }
}
