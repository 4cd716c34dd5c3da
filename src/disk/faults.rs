//! Test hook that lets file operations fail. Without a hook, each operation costs one read of a
//! flag.

use std::{
    fmt::Debug,
    io,
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

/// Operations that can fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Reading metadata, or resolving links.
    Look,
    /// Reading the names in a folder.
    List,
    Open,
    Read,
    Create,
    Write,
    /// Syncing a file or a folder.
    Sync,
    Rename,
    Remove,
    MakeFolder,
    Lock,
    /// Creating temporary files.
    Scratch,
    /// Reserving memory for a file.
    Reserve,
}

/// An operation that is about to be performed.
#[derive(Clone, Copy, Debug)]
pub struct Call<'a> {
    pub op: Op,
    pub path: &'a Path,
    /// Target of a rename.
    pub to: Option<&'a Path>,
}

/// Result of an operation.
#[derive(Debug)]
pub enum Fate {
    Done,
    /// It is not performed.
    Fails(io::Error),
    /// A write stops half-way; any other operation is not performed.
    Torn(io::Error),
}

/// Decides the result of operations.
pub trait Faults: Debug + Send + Sync {
    fn fate(&self, call: Call<'_>) -> Fate;
}

static ARMED: AtomicBool = AtomicBool::new(false);
static HOOK: Mutex<Option<Arc<dyn Faults>>> = Mutex::new(None);

/// Sets or removes the hook of the process. For tests.
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
