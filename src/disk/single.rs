//! One file, whole or not at all.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{Op, Writer, create, names, pass, remove_file, rename, sync_folder};

/// How files begin that are on their way to their place.
const BEGINS: &str = ".fishplate-";
/// How they end.
const ENDS: &str = ".tmp";
/// Names that are tried before it is given up: each is taken only where a run with the same number left one.
const MOST_NAMES: usize = 100;

/// Writes a file under another name in the same folder, which must exist, and renames it. On return it is on the disk.
///
/// # Errors
/// What the system says; the file is then as it was before.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = folder_of(path);
    sweep(folder);
    put(path, folder, bytes, true)?;
    sync_folder(folder)
}

/// As [`write_whole`], for what may be lost when the power goes: a cache.
///
/// # Errors
/// As [`write_whole`].
pub fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    put(path, folder_of(path), bytes, false)
}

/// Writes a file that must not exist; a secret one only its owner can read. On return it is on the disk.
///
/// # Errors
/// What the system says; there is then no file.
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
/// What the system says.
pub fn remove(path: &Path) -> io::Result<()> {
    remove_file(path)
}

fn folder_of(path: &Path) -> &Path {
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

/// A new file that no other run takes for left behind.
fn begin(folder: &Path) -> io::Result<(Writer, PathBuf)> {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    for _ in 0..MOST_NAMES {
        let name = format!("{BEGINS}{}-{}{ENDS}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path = folder.join(name);
        match create(&path) {
            Ok(file) if held(&file) => return Ok((file, path)),
            // Swept away before it was held.
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Holds a file that was just made, so that it is not swept away; whether it still has a name.
fn held(file: &Writer) -> bool {
    match file.file.try_lock() {
        Ok(()) => linked(file),
        Err(std::fs::TryLockError::WouldBlock) => false,
        // A file system without locks.
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

/// Removes what runs that were ended left behind. Nothing depends on it.
fn sweep(folder: &Path) {
    for name in names(folder).unwrap_or_default() {
        let Some(name) = name.to_str().filter(|name| name.starts_with(BEGINS) && name.ends_with(ENDS)) else { continue };
        let path = folder.join(name);
        // Who writes it holds it.
        if super::is_file(&path).unwrap_or(false)
            && let Ok(file) = std::fs::File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = remove_file(&path);
        }
    }
}
