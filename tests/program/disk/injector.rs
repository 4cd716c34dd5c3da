//! Lets one operation fail, or ends the program there.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use fishplate::disk::faults::{self, Call, Fate, Faults, Op};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The operation fails, and no other.
    Once,
    /// From the operation on, nothing new fits on the disk.
    Full,
    /// The operation is not done, or half of it, and none after it; then the power goes.
    Killed,
}

pub const MODES: [Mode; 3] = [Mode::Once, Mode::Full, Mode::Killed];

/// Words of every error that is made here.
pub const INJECTED: &str = "an injected fault";

#[derive(Debug, Default)]
struct State {
    count: usize,
    hit: bool,
    what: String,
    ops: Vec<Op>,
    /// Files that were written and not synced.
    loose: Vec<PathBuf>,
}

#[derive(Debug)]
pub struct Injector {
    /// The operation, from 1; none fails with 0.
    at: usize,
    mode: Mode,
    state: Mutex<State>,
}

impl Faults for Injector {
    fn fate(&self, call: Call<'_>) -> Fate {
        let mut state = self.state.lock().expect("no panic before");
        state.count += 1;
        let fails = |kind: ErrorKind| Fate::Fails(Error::new(kind, INJECTED));
        let now = state.count == self.at;
        let after = self.at > 0 && state.count >= self.at;
        if now {
            state.hit = true;
            state.what = format!("{:?} of {}", call.op, call.path.display());
        }
        match self.mode {
            Mode::Once if now => return fails(ErrorKind::Other),
            Mode::Full
                if after
                    && matches!(call.op, Op::Create | Op::Write | Op::MakeFolder | Op::Scratch) =>
            {
                return fails(ErrorKind::StorageFull);
            }
            Mode::Killed if now && call.op == Op::Write => {
                state.loose.push(call.path.to_path_buf());
                return Fate::Torn(Error::other(INJECTED));
            }
            Mode::Killed if after => return fails(ErrorKind::Other),
            _ => {}
        }
        state.ops.push(call.op);
        match (call.op, call.to) {
            (Op::Write, _) => state.loose.push(call.path.to_path_buf()),
            (Op::Sync, _) => state.loose.retain(|path| path != call.path),
            (Op::Rename, Some(to)) => {
                for path in &mut state.loose {
                    if let Ok(rest) = path.strip_prefix(call.path) {
                        *path = if rest.as_os_str().is_empty() {
                            to.to_path_buf()
                        } else {
                            to.join(rest)
                        };
                    }
                }
            }
            _ => {}
        }
        Fate::Done
    }
}

/// What came of a run.
#[derive(Debug)]
pub struct Run<T> {
    pub gave: T,
    /// Whether the operation was reached.
    pub hit: bool,
    /// Which it was.
    pub what: String,
    /// What was done, in order.
    pub ops: Vec<Op>,
}

/// Runs with a fault at an operation. After a loss of power, half of what was not synced is gone.
pub fn with_fault<T>(at: usize, mode: Mode, run: impl FnOnce() -> T) -> Run<T> {
    let injector = Arc::new(Injector { at, mode, state: Mutex::default() });
    faults::set(Some(injector.clone()));
    let gave = run();
    faults::set(None);
    let mut state = injector.state.lock().expect("no panic before");
    if mode == Mode::Killed && state.hit {
        for path in &state.loose {
            if let Ok(bytes) = fs::read(path) {
                fs::write(path, &bytes[..bytes.len() / 2]).expect("cut");
            }
        }
    }
    Run {
        gave,
        hit: state.hit,
        what: std::mem::take(&mut state.what),
        ops: std::mem::take(&mut state.ops),
    }
}

/// Files below a folder with their bytes, by path; what is on its way to its place is left out.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    crate::disk::program::files(folder)
        .iter()
        .map(|path| {
            (path.strip_prefix(folder).expect("below").to_string_lossy().into_owned(), path)
        })
        .filter(|(name, _)| {
            !name.contains(".fishplate-new")
                && !name.contains(".fishplate-unfinished")
                && !name.ends_with(".tmp")
        })
        .map(|(name, path)| (name, fs::read(path).expect("readable")))
        .collect()
}

/// Whether names show that something is on its way.
pub fn leftovers(folder: &Path) -> Vec<PathBuf> {
    let on_its_way = |path: &&PathBuf| {
        [".fishplate-new", ".fishplate-unfinished", ".tmp"]
            .iter()
            .any(|name| path.to_string_lossy().contains(name))
    };
    let all = crate::disk::program::files(folder);
    all.iter()
        .filter_map(|path| path.strip_prefix(folder).ok())
        .map(Path::to_path_buf)
        .filter(|path| on_its_way(&path))
        .collect()
}
