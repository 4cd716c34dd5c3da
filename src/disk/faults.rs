//! The hook by which tests let operations fail. A program that nobody tests never sets it: each operation then costs
//! one look at a flag.

use std::fmt::Debug;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Operations that can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Metadata, or a path without its links.
    Look,
    /// The names in a folder.
    List,
    Open,
    Read,
    Create,
    Write,
    /// Of a file or a folder.
    Sync,
    Rename,
    Remove,
    MakeFolder,
    Lock,
    /// Files for this run alone.
    Scratch,
    /// Room in memory for a file.
    Reserve,
}

/// One operation that is about to be done.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    pub op: Op,
    pub path: &'a Path,
    /// Where a rename leads.
    pub to: Option<&'a Path>,
}

/// What becomes of it.
#[derive(Debug)]
pub enum Fate {
    Done,
    /// Nothing is done.
    Fails(io::Error),
    /// A write stops half-way; all else is not done.
    Torn(io::Error),
}

/// Decides over operations.
pub trait Faults: Debug + Send + Sync {
    fn fate(&self, call: Call<'_>) -> Fate;
}

static ARMED: AtomicBool = AtomicBool::new(false);
static HOOK: Mutex<Option<Arc<dyn Faults>>> = Mutex::new(None);

/// Sets the hook, or takes it away. For tests; it holds for the whole process.
#[doc(hidden)]
pub fn set(hook: Option<Arc<dyn Faults>>) {
    ARMED.store(hook.is_some(), Ordering::SeqCst);
    *HOOK.lock().unwrap_or_else(PoisonError::into_inner) = hook;
}

pub(super) fn pass(op: Op, path: &Path) -> io::Result<()> {
    passed(op, path, None).map_err(|(error, _)| error)
}

/// The error, and whether a write stops half-way.
pub(super) fn passed(op: Op, path: &Path, to: Option<&Path>) -> Result<(), (io::Error, bool)> {
    if !ARMED.load(Ordering::Relaxed) {
        return Ok(());
    }
    let hook = HOOK.lock().unwrap_or_else(PoisonError::into_inner).clone();
    match hook.map_or(Fate::Done, |hook| hook.fate(Call { op, path, to })) {
        Fate::Done => Ok(()),
        Fate::Fails(error) => Err((error, false)),
        Fate::Torn(error) => Err((error, true)),
    }
}
