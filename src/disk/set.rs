//! Files that belong together, with one commit point.
//!
//! The files are written into a folder of their own inside the output folder, each synced, with a journal of what they
//! replace. One rename of that folder is the commit point. Then the files of the set before go out of their places, and
//! the new ones in; a run that ended in between is finished by the next one. A set never stands mixed with the one
//! before it: while files change places, only old ones are there, then only new ones.

use std::collections::HashSet;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::journal::{JOURNAL, Journal, plain};
use super::{
    Hold, Kind, create, hold, is_file, is_folder, is_link, kind, make_folders, names, read, remove_file, remove_folder, rename, sync_folder,
};

/// Beginning of the names that this module keeps in an output folder.
const OWN: &str = ".fishplate-";
/// Files of a set before the commit point; after it, nothing that is needed.
const NEW: &str = ".fishplate-new";
/// Files of a set after the commit point.
pub const UNFINISHED: &str = ".fishplate-unfinished";
/// Largest manifest and journal in bytes: a hundred thousand files.
const LARGEST_LIST: u64 = 32 << 20;

/// What the files of a set are together: a set takes the place of one of its own kind, and of no other.
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
    /// Lists the files of the last set in the form of `sha256sum`: the next one takes away what it does not replace.
    pub fn manifest(self) -> &'static str {
        match self {
            Self::Report => ".fishplate-report.sha256",
            Self::Campaign => ".fishplate-campaign.sha256",
            Self::Manual => ".fishplate-manual.sha256",
        }
    }
}

/// Files for one folder. Dropped without [`Set::commit`], nothing is changed.
#[derive(Debug)]
pub struct Set {
    folder: PathBuf,
    kind: SetKind,
    /// Whether the files are to outlive a loss of power.
    synced: bool,
    /// Paths of the files, by number.
    paths: Vec<String>,
    hashes: Vec<String>,
    /// Folders that did not exist before, outermost first.
    made: Vec<PathBuf>,
    held: Option<Hold>,
    begun: bool,
    mended: bool,
}

impl Set {
    /// A set in a folder, which is made when the first file is added.
    pub fn new(folder: impl Into<PathBuf>, kind: SetKind) -> Self {
        let folder: PathBuf = folder.into();
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
        Self {
            folder,
            kind,
            synced: true,
            paths: Vec::new(),
            hashes: Vec::new(),
            made: Vec::new(),
            held: None,
            begun: false,
            mended: false,
        }
    }

    /// Nothing of it needs to outlive the run: no time is spent on syncing.
    pub fn unsynced(&mut self) {
        self.synced = false;
    }

    /// Whether a set was finished here that a run before left unfinished.
    pub fn mended(&self) -> bool {
        self.mended
    }

    /// Where a file goes.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.folder.join(inside)
    }

    fn begin(&mut self) -> io::Result<()> {
        if self.begun {
            return Ok(());
        }
        make_folders(&self.folder, &mut self.made)?;
        self.held = hold(&self.folder)?;
        if is_folder(&self.folder.join(UNFINISHED))? {
            finish(&self.folder)?;
            self.mended = true;
        }
        clear(&self.folder.join(NEW))?;
        super::pass(super::Op::MakeFolder, &self.folder.join(NEW))?;
        std::fs::create_dir(self.folder.join(NEW))?;
        self.begun = true;
        Ok(())
    }

    /// Adds a file by its path in the folder, with `/`. Its bytes are on the disk on return, not in their place.
    ///
    /// # Errors
    /// What the system says; `InvalidInput` for a path that leads out.
    pub fn add(&mut self, inside: &str, bytes: &[u8]) -> io::Result<()> {
        if !plain(inside) || inside.starts_with(OWN) || self.paths.iter().any(|path| path == inside) {
            return Err(ErrorKind::InvalidInput.into());
        }
        self.begin()?;
        self.stage(inside, bytes)?;
        self.hashes.push(Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect());
        Ok(())
    }

    fn stage(&mut self, inside: &str, bytes: &[u8]) -> io::Result<()> {
        self.write(&self.paths.len().to_string(), bytes)?;
        self.paths.push(inside.to_string());
        Ok(())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = create(&self.folder.join(NEW).join(name))?;
        file.write(bytes)?;
        if self.synced { file.sync() } else { Ok(()) }
    }

    /// Puts every file into its place and takes away files of the set before that this one does not have.
    ///
    /// # Errors
    /// What the system says. The folder then holds the set before, whole; where not even that could be restored, the
    /// error says so, and the next set that is written there finishes this one.
    pub fn commit(mut self) -> io::Result<()> {
        self.begin()?;
        for path in &self.paths {
            if is_folder(&self.folder.join(path))? {
                return Err(io::Error::new(ErrorKind::IsADirectory, format!("`{path}` is a folder")));
            }
        }
        let manifest: String = self.hashes.iter().zip(&self.paths).map(|(hash, path)| format!("{hash}  {path}\n")).collect();
        let new: HashSet<&str> = self.paths.iter().map(String::as_str).collect();
        let mut removes = before(&self.folder, self.kind.manifest())?;
        removes.retain(|path| !new.contains(path.as_str()));
        self.stage(self.kind.manifest(), manifest.as_bytes())?;
        let journal = Journal { installs: self.paths.clone(), removes };
        self.write(JOURNAL, journal.text().as_bytes())?;
        let (staged, unfinished) = (self.folder.join(NEW), self.folder.join(UNFINISHED));
        sync_folder(&staged)?;
        rename(&staged, &unfinished)?;
        // From here on a run that is ended is finished by the next one.
        let mut done = Done::default();
        let placed = sync_folder(&self.folder).and_then(|()| place(&self.folder, &journal, &mut done));
        if let Err(error) = placed {
            return Err(match done.undo(&self.folder) {
                Ok(()) => error,
                Err(_) => io::Error::new(
                    error.kind(),
                    format!("{error}; the folder is left unfinished, which the next run that writes there mends"),
                ),
            });
        }
        // The new set is whole. What is left of the old one lies where the next run clears it, if this one cannot.
        if rename(&unfinished, &staged).is_ok() {
            let _ = clear(&staged);
        }
        remove_empty(&self.folder, &journal.removes);
        self.made.clear();
        self.begun = false;
        Ok(())
    }
}

impl Drop for Set {
    fn drop(&mut self) {
        if self.begun {
            let _ = clear(&self.folder.join(NEW));
        }
        // Only empty folders go; what someone else put there meanwhile stays.
        self.made.iter().rev().for_each(|folder| drop(remove_folder(folder)));
    }
}

/// Paths of the set before, as its manifest lists them, that are there and are plain files of this folder.
fn before(folder: &Path, manifest: &str) -> io::Result<Vec<String>> {
    if kind(&folder.join(manifest))?.is_none() {
        return Ok(Vec::new());
    }
    let bytes = read(&folder.join(manifest), LARGEST_LIST)?;
    let mut found = Vec::new();
    for path in String::from_utf8_lossy(&bytes).lines().filter_map(|line| Some(line.split_once("  ")?.1)) {
        // The list lies where anybody may write: what it names must lie in this folder, not behind a link.
        if plain(path) && !path.starts_with(OWN) && !behind_link(folder, path)? && is_file(&folder.join(path))? {
            found.push(path.to_string());
        }
    }
    Ok(found)
}

fn behind_link(folder: &Path, path: &str) -> io::Result<bool> {
    let mut at = folder.to_path_buf();
    for part in path.split('/') {
        at.push(part);
        if is_link(&at)? {
            return Ok(true);
        }
    }
    Ok(false)
}

/// What was moved, so that it can be moved back.
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

    /// The set before, in its places again.
    fn undo(self, folder: &Path) -> io::Result<()> {
        for (from, to) in self.moved.iter().rev() {
            rename(to, from)?;
        }
        self.made.iter().rev().for_each(|folder| drop(remove_folder(folder)));
        // Where this fails, the names are right all the same, and the next run can only find one set or the other.
        let _ = sync_folder(folder);
        rename(&folder.join(UNFINISHED), &folder.join(NEW))
    }
}

/// Old files out, then new ones in.
fn place(folder: &Path, journal: &Journal, done: &mut Done) -> io::Result<()> {
    let unfinished = folder.join(UNFINISHED);
    for (number, path) in journal.removes.iter().chain(&journal.installs).enumerate() {
        if matches!(kind(&folder.join(path))?, Some(Kind::File(_) | Kind::Other)) || is_link(&folder.join(path))? {
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

/// Finishes a set after its commit point: what is not in its place yet goes there.
fn finish(folder: &Path) -> io::Result<()> {
    let unfinished = folder.join(UNFINISHED);
    let unreadable = |error: io::Error| {
        let says = format!("an unfinished set of files lies there, in `{UNFINISHED}`, and {error}; look at it and remove it");
        io::Error::new(ErrorKind::InvalidData, says)
    };
    let bytes = read(&unfinished.join(JOURNAL), LARGEST_LIST).map_err(unreadable)?;
    let journal = Journal::read(&String::from_utf8_lossy(&bytes)).map_err(unreadable)?;
    for path in &journal.removes {
        if is_file(&folder.join(path))? && !behind_link(folder, path)? {
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

/// Removes a folder of this module with the files in it, if it is there.
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

/// Removes folders of files that were taken away, as far as nothing is left in them.
fn remove_empty(folder: &Path, removed: &[String]) {
    for path in removed {
        for above in Path::new(path).ancestors().skip(1).take_while(|above| !above.as_os_str().is_empty()) {
            if remove_folder(&folder.join(above)).is_err() {
                break;
            }
        }
    }
}
