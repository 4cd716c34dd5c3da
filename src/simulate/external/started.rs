//! Processes that a program started and that left its process group, found by an inherited
//! environment variable and by what started them.
//!
//! A process group is terminated as a whole, but a process that calls `setsid` leaves it. The
//! variable remains in all child processes unless they remove it. One that removes it is found while
//! the process that started it is running; not found is one that removes it, leaves the group, and
//! loses that process. Only Linux shows other processes.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Name of the variable.
pub const NAME: &str = "FISHPLATE_CALL";

/// Value of the variable, different for each call of this process.
#[derive(Debug)]
pub struct Mark(String);

impl Mark {
    pub fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        Self(format!("{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed)))
    }

    pub fn value(&self) -> &str {
        &self.0
    }
}

/// Number of search rounds: each terminates processes started during the previous ones.
#[cfg(target_os = "linux")]
const ROUNDS: usize = 16;

/// Terminates all processes that have a mark, and those that these or the first process started.
#[cfg(target_os = "linux")]
pub fn end(mark: &Mark, first: u32) {
    use rustix::process::{Pid, Signal, kill_process};
    let wanted = format!("{NAME}={}", mark.value());
    for _ in 0..ROUNDS {
        let all = processes();
        let mut ours: Vec<i32> = i32::try_from(first).into_iter().collect();
        ours.extend(all.iter().filter(|(id, _)| has(*id, wanted.as_bytes())).map(|(id, _)| id));
        let mut at = 0;
        while let Some(above) = ours.get(at).copied() {
            let below = all.iter().filter(|(_, parent)| *parent == above).map(|(id, _)| *id);
            let new: Vec<i32> = below.filter(|id| !ours.contains(id)).collect();
            ours.extend(new);
            at += 1;
        }
        // The first one is ended by whoever started it.
        let others: Vec<Pid> = ours.iter().skip(1).filter_map(|id| Pid::from_raw(*id)).collect();
        if others.is_empty() {
            return;
        }
        for id in others {
            let _ = kill_process(id, Signal::KILL);
        }
    }
}

/// Whether a process that is running has a variable.
#[cfg(target_os = "linux")]
fn has(id: i32, wanted: &[u8]) -> bool {
    let variables = crate::disk::of_process(id, "environ").unwrap_or_default();
    variables.split(|byte| *byte == 0).any(|variable| variable == wanted)
}

/// The processes that are running, each with the one that started it.
#[cfg(target_os = "linux")]
fn processes() -> Vec<(i32, i32)> {
    let names = crate::disk::names(std::path::Path::new("/proc")).unwrap_or_default();
    let process = |name: &std::ffi::OsString| {
        let id = name.to_str()?.parse().ok()?;
        let stat = crate::disk::of_process(id, "stat").ok()?;
        // `7 (name) S 1 ...`; the name may contain anything.
        let behind = memchr::memrchr(b')', &stat)?;
        let mut words = std::str::from_utf8(stat.get(behind + 1..)?).ok()?.split_whitespace();
        let (state, parent) = (words.next()?, words.next()?.parse().ok()?);
        (state != "Z").then_some((id, parent))
    };
    names.iter().filter_map(process).collect()
}

#[cfg(not(target_os = "linux"))]
pub fn end(_: &Mark, _: u32) {}
