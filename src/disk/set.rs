//! Sets of files with one commit point.
//!
//! The files are written to a folder inside the output folder, with a journal of the files they
//! replace, and synced together. One rename of that folder is the commit point. Then the files of
//! the previous set are removed from their places, and the new ones installed. A run that was
//! interrupted in between is completed by the next one. Old and new files are never mixed: first
//! only old files are in place, then only new ones.

use std::{
    collections::HashSet,
    io::{self, ErrorKind, Write},
    path::{Path, PathBuf},
};

use super::{
    Hold, Kind, ScratchFile, Writer, create, hold, is_file, is_folder, is_link,
    journal::{JOURNAL, Journal, plain},
    kind, make_folders, names, read, remove_file, remove_folder, rename, sync_folder,
    sync_together,
};
use crate::hash::{Hasher, sha256};

/// Prefix of the names that this module uses in an output folder.
const OWN: &str = ".fishplate-";
/// Folder of a set before the commit point; after it, its contents are not needed.
const NEW: &str = ".fishplate-new";
/// Folder of a set after the commit point.
pub const UNFINISHED: &str = ".fishplate-unfinished";
/// How the name of a signature ends that lies beside its file.
pub const SIGNATURE: &str = ".minisig";
/// Largest file before, in bytes, that is compared with the one in its place; its signature goes if
/// it is larger.
const LARGEST_SIGNED: u64 = 512 << 20;
/// Most files of a set that are open until they are synced together. A sync may take some
/// milliseconds, whatever the size of the file, and several at the same time are hardly longer than
/// one.
const AT_ONCE: usize = 16;
/// Largest manifest and journal in bytes: a hundred thousand files.
const LARGEST_LIST: u64 = 32 << 20;

/// Kind of a set. A set replaces only a set of its own kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// A report with its numbers.
    Report,
    /// A campaign.
    Campaign,
    /// Manual pages.
    Manual,
}

impl SetKind {
    /// Lists the files of the last set in the format of `sha256sum`; the next set removes those
    /// that it does not replace.
    pub fn manifest(self) -> &'static str {
        match self {
            Self::Report => ".fishplate-report.sha256",
            Self::Campaign => ".fishplate-campaign.sha256",
            Self::Manual => ".fishplate-manual.sha256",
        }
    }
}

/// A set of files for one folder. If dropped without [`Set::commit`], nothing is changed.
#[derive(Debug)]
pub struct Set {
    folder: PathBuf,
    kind: SetKind,
    /// Whether the files must survive a power failure.
    synced: bool,
    /// Paths of the files, by number.
    paths: Vec<String>,
    hashes: Vec<String>,
    /// Files that are written and not yet synced.
    loose: Vec<Writer>,
    /// Folders created for the set, outermost first.
    made: Vec<PathBuf>,
    held: Option<Hold>,
    begun: bool,
    mended: bool,
}

impl Set {
    /// A set for a folder, which is created when the first file is added.
    pub fn new(folder: impl Into<PathBuf>, kind: SetKind) -> Self {
        let folder: PathBuf = folder.into();
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
        Self {
            folder,
            kind,
            synced: true,
            paths: Vec::new(),
            hashes: Vec::new(),
            loose: Vec::new(),
            made: Vec::new(),
            held: None,
            begun: false,
            mended: false,
        }
    }

    /// Disables syncing, for sets that need not survive the run.
    pub fn unsynced(&mut self) {
        self.synced = false;
    }

    /// Whether the set of an interrupted run was completed.
    pub fn mended(&self) -> bool {
        self.mended
    }

    /// The final path of a file.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.folder.join(inside)
    }

    fn begin(&mut self) -> io::Result<()> {
        if self.begun {
            return Ok(());
        }
        make_folders(&self.folder, &mut self.made)?;
        self.held = hold(&self.folder)?;
        if is_link(&self.folder.join(UNFINISHED))? || is_folder(&self.folder.join(UNFINISHED))? {
            finish(&self.folder)?;
            self.mended = true;
        }
        clear(&self.folder.join(NEW))?;
        super::pass(super::Op::MakeFolder, &self.folder.join(NEW))?;
        std::fs::create_dir(self.folder.join(NEW))?;
        self.begun = true;
        Ok(())
    }

    /// Adds a file by its path in the folder, with `/`. On return its bytes are written, but not in
    /// their place.
    ///
    /// # Errors
    /// The system's error; `InvalidInput` for a path outside the folder.
    pub fn add(&mut self, inside: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = self.open(inside)?;
        file.write_all(bytes)?;
        self.close(file)
    }

    /// Begins a file that is written in parts; only one is open at a time.
    ///
    /// # Errors
    /// As [`Set::add`].
    pub fn open(&mut self, inside: &str) -> io::Result<Open> {
        if !plain(inside) || inside.starts_with(OWN) || self.paths.iter().any(|path| path == inside)
        {
            return Err(ErrorKind::InvalidInput.into());
        }
        self.begin()?;
        let file = create(&self.folder.join(NEW).join(self.paths.len().to_string()))?;
        Ok(Open { inside: inside.to_string(), file, hash: Hasher::default() })
    }

    /// Ends a file. On return its bytes are written, but not in their place.
    ///
    /// # Errors
    /// The system's error.
    pub fn close(&mut self, open: Open) -> io::Result<()> {
        self.paths.push(open.inside);
        self.hashes.push(open.hash.finish());
        self.written(open.file)
    }

    /// A file is complete; it is synced with others, before the commit point.
    fn written(&mut self, file: Writer) -> io::Result<()> {
        if self.synced {
            self.loose.push(file);
        }
        if self.loose.len() >= AT_ONCE { self.sync() } else { Ok(()) }
    }

    /// On return the bytes of all files are on the disk.
    fn sync(&mut self) -> io::Result<()> {
        sync_together(&std::mem::take(&mut self.loose))
    }

    /// The files that were added, with their SHA-256.
    pub fn hashes(&self) -> impl DoubleEndedIterator<Item = (&str, &str)> {
        self.paths.iter().map(String::as_str).zip(self.hashes.iter().map(String::as_str))
    }

    /// A temporary file without a name, on the disk of the folder.
    ///
    /// # Errors
    /// The system's error.
    pub fn scratch_file(&mut self) -> io::Result<ScratchFile> {
        self.begin()?;
        ScratchFile::new(&self.folder.join(NEW))
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = create(&self.folder.join(NEW).join(name))?;
        file.write(bytes)?;
        self.written(file)
    }

    /// Moves every file to its place, and removes files of the previous set that this one does not
    /// have.
    ///
    /// # Errors
    /// The system's error. The folder then contains the complete previous set. If this could not be
    /// restored, the error says so, and the next set written there completes this one.
    pub fn commit(mut self) -> io::Result<()> {
        self.begin()?;
        for path in &self.paths {
            not_behind_link(&self.folder, path)?;
            if is_folder(&self.folder.join(path))? {
                let says = format!("`{path}` is a folder");
                return Err(io::Error::new(ErrorKind::IsADirectory, says));
            }
        }
        let lines = self.hashes.iter().zip(&self.paths);
        let manifest: String = lines.map(|(hash, path)| format!("{hash}  {path}\n")).collect();
        let new: HashSet<&str> = self.paths.iter().map(String::as_str).collect();
        let mut removes = before(&self.folder, self.kind.manifest())?;
        removes.retain(|path| !new.contains(path.as_str()));
        removes.extend(self.outdated_signatures(&removes, &new)?);
        self.write(&self.paths.len().to_string(), manifest.as_bytes())?;
        self.paths.push(self.kind.manifest().to_string());
        let journal = Journal { installs: self.paths.clone(), removes };
        self.write(JOURNAL, journal.text().as_bytes())?;
        self.sync()?;
        let (staged, unfinished) = (self.folder.join(NEW), self.folder.join(UNFINISHED));
        sync_folder(&staged)?;
        rename(&staged, &unfinished)?;
        // From here on an interrupted run is completed by the next one.
        let mut done = Done::default();
        let placed =
            sync_folder(&self.folder).and_then(|()| place(&self.folder, &journal, &mut done));
        if let Err(error) = placed {
            if done.undo(&self.folder).is_ok() {
                return Err(error);
            }
            let says = format!(
                "{error}; the folder is incomplete, and the next run that writes there completes it"
            );
            return Err(io::Error::new(error.kind(), says));
        }
        // The new set is complete. The rest of the old one is in a folder that the next run removes
        // if this one cannot.
        if rename(&unfinished, &staged).is_ok() {
            let _ = clear(&staged);
        }
        remove_empty(&self.folder, &journal.removes);
        self.made.clear();
        self.begun = false;
        Ok(())
    }

    /// Signatures of files of the set before that change or go: they are those of nothing that is
    /// still there. The manifest does not list them where they were made later.
    fn outdated_signatures(
        &self,
        removes: &[String],
        new: &HashSet<&str>,
    ) -> io::Result<Vec<String>> {
        let changed = |path: &str, hash: Option<&String>| {
            let before = || read(&self.folder.join(path), LARGEST_SIGNED).ok();
            hash.is_none_or(|hash| before().is_none_or(|bytes| *hash != sha256(&bytes)))
        };
        let written = self.paths.iter().zip(&self.hashes).map(|(path, hash)| (path, Some(hash)));
        let mut outdated = Vec::new();
        for (path, hash) in written.chain(removes.iter().map(|path| (path, None))) {
            let signature = format!("{path}{SIGNATURE}");
            let listed = new.contains(signature.as_str()) || removes.contains(&signature);
            if !listed && in_place(&self.folder, &signature)? && changed(path, hash) {
                outdated.push(signature);
            }
        }
        Ok(outdated)
    }
}

/// A file of a set while it is written.
#[derive(Debug)]
pub struct Open {
    inside: String,
    file: Writer,
    hash: Hasher,
}

impl Write for Open {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)?;
        self.hash.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Set {
    fn drop(&mut self) {
        self.loose.clear();
        if self.begun {
            let _ = clear(&self.folder.join(NEW));
        }
        // Only empty folders are removed; files of others are kept.
        self.made.iter().rev().for_each(|folder| drop(remove_folder(folder)));
    }
}

/// Paths of the previous set, from its manifest, that are plain files inside this folder.
fn before(folder: &Path, manifest: &str) -> io::Result<Vec<String>> {
    if kind(&folder.join(manifest))?.is_none() {
        return Ok(Vec::new());
    }
    let bytes = read(&folder.join(manifest), LARGEST_LIST)?;
    let mut found = Vec::new();
    let text = String::from_utf8_lossy(&bytes);
    for path in text.lines().filter_map(|line| Some(line.split_once("  ")?.1)) {
        // The manifest may have been edited: its paths must be inside this folder and not behind a
        // link.
        if plain(path) && !path.starts_with(OWN) && in_place(folder, path)? {
            found.push(path.to_string());
        }
    }
    Ok(found)
}

/// The symbolic link that leads to a path in the folder, if there is one. The last name may be a
/// link itself, which can be renamed and removed like a file.
fn link_above(folder: &Path, path: &str) -> io::Result<Option<PathBuf>> {
    let above: Vec<PathBuf> =
        Path::new(path).ancestors().skip(1).map(|above| folder.join(above)).collect();
    // The folder itself is the user's choice.
    for at in above.iter().rev().skip(1) {
        if is_link(at)? {
            return Ok(Some(at.clone()));
        }
    }
    Ok(None)
}

/// Refuses a path that leads through a symbolic link: what it names may be anywhere.
fn not_behind_link(folder: &Path, path: &str) -> io::Result<()> {
    let Some(link) = link_above(folder, path)? else { return Ok(()) };
    let says = format!("`{}` is a symbolic link, which is not followed", link.display());
    Err(io::Error::new(ErrorKind::NotADirectory, says))
}

/// Whether a path is that of a file or a link in the folder, not behind a link.
fn in_place(folder: &Path, path: &str) -> io::Result<bool> {
    let at = folder.join(path);
    Ok((is_link(&at)? || is_file(&at)?) && link_above(folder, path)?.is_none())
}

/// Files that were moved, so that the moves can be undone.
#[derive(Debug, Default)]
struct Done {
    /// From, to.
    moved: Vec<(PathBuf, PathBuf)>,
    made: Vec<PathBuf>,
}

impl Done {
    fn rename(&mut self, from: PathBuf, to: PathBuf) -> io::Result<()> {
        rename(&from, &to)?;
        self.moved.push((from, to));
        Ok(())
    }

    /// Restores the previous set.
    fn undo(self, folder: &Path) -> io::Result<()> {
        for (from, to) in self.moved.iter().rev() {
            rename(to, from)?;
        }
        self.made.iter().rev().for_each(|folder| drop(remove_folder(folder)));
        // If this fails, the names are still correct, and the next run finds one complete set.
        let _ = sync_folder(folder);
        rename(&folder.join(UNFINISHED), &folder.join(NEW))
    }
}

/// Removes old files, then installs new ones.
fn place(folder: &Path, journal: &Journal, done: &mut Done) -> io::Result<()> {
    let unfinished = folder.join(UNFINISHED);
    for (number, path) in journal.removes.iter().chain(&journal.installs).enumerate() {
        if matches!(kind(&folder.join(path))?, Some(Kind::File(_) | Kind::Other))
            || is_link(&folder.join(path))?
        {
            done.rename(folder.join(path), unfinished.join(format!("old-{number}")))?;
        }
    }
    let mut folders = HashSet::from([folder.to_path_buf()]);
    for (number, path) in journal.installs.iter().enumerate() {
        let to = folder.join(path);
        let parent = to.parent().unwrap_or(folder).to_path_buf();
        make_folders(&parent, &mut done.made)?;
        done.rename(unfinished.join(number.to_string()), to)?;
        folders.insert(parent);
    }
    let mut folders: Vec<PathBuf> = folders.into_iter().collect();
    folders.sort();
    folders.iter().try_for_each(|folder| sync_folder(folder))
}

/// Completes a set after its commit point.
fn finish(folder: &Path) -> io::Result<()> {
    let unfinished = folder.join(UNFINISHED);
    let unreadable = |error: io::Error| {
        let says = format!(
            "the folder contains an incomplete set of files in `{UNFINISHED}`, and {error}; inspect and remove it"
        );
        io::Error::new(ErrorKind::InvalidData, says)
    };
    let inside = format!("{UNFINISHED}/{JOURNAL}");
    not_behind_link(folder, &inside)
        .and_then(|()| not_link(&unfinished.join(JOURNAL)))
        .map_err(unreadable)?;
    let bytes = read(&unfinished.join(JOURNAL), LARGEST_LIST).map_err(unreadable)?;
    let journal = Journal::read(&String::from_utf8_lossy(&bytes)).map_err(unreadable)?;
    for (number, path) in journal.installs.iter().enumerate() {
        not_behind_link(folder, path)
            .and_then(|()| not_link(&unfinished.join(number.to_string())))
            .map_err(unreadable)?;
    }
    for path in &journal.removes {
        if in_place(folder, path)? {
            remove_file(&folder.join(path))?;
        }
    }
    for (number, path) in journal.installs.iter().enumerate() {
        let from = unfinished.join(number.to_string());
        if is_file(&from)? {
            let to = folder.join(path);
            make_folders(to.parent().unwrap_or(folder), &mut Vec::new())?;
            rename(&from, &to)?;
        }
    }
    sync_folder(folder)?;
    clear(&folder.join(NEW))?;
    rename(&unfinished, &folder.join(NEW))?;
    remove_empty(folder, &journal.removes);
    Ok(())
}

fn not_link(path: &Path) -> io::Result<()> {
    match is_link(path)? {
        true => Err(io::Error::other(format!("`{}` is a symbolic link", path.display()))),
        false => Ok(()),
    }
}

/// Removes a folder of this module with its files, if it exists.
fn clear(folder: &Path) -> io::Result<()> {
    if is_link(folder)? {
        return remove_file(folder);
    }
    if !is_folder(folder)? {
        return Ok(());
    }
    names(folder)?.iter().try_for_each(|name| remove_file(&folder.join(name)))?;
    remove_folder(folder)
}

/// Removes the folders of removed files if they are empty.
fn remove_empty(folder: &Path, removed: &[String]) {
    for path in removed.iter().filter(|path| matches!(link_above(folder, path), Ok(None))) {
        for above in
            Path::new(path).ancestors().skip(1).take_while(|above| !above.as_os_str().is_empty())
        {
            if remove_folder(&folder.join(above)).is_err() {
                break;
            }
        }
    }
}
