//! Processes that a program started and that left its process group, found by an inherited
//! environment variable.
//!
//! A process group is terminated as a whole, but a process that calls `setsid` leaves it. The
//! variable remains in all child processes unless they remove it. Only Linux shows the variables of
//! other processes.

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

/// Terminates all processes with a mark.
#[cfg(target_os = "linux")]
pub fn end(mark: &Mark) {
    use crate::disk::{names, process_variables};
    let wanted = format!("{NAME}={}", mark.value());
    for _ in 0..ROUNDS {
        let mut found = false;
        for name in names(std::path::Path::new("/proc")).unwrap_or_default() {
            let Some(id) = name.to_str().and_then(|name| name.parse::<i32>().ok()) else {
                continue;
            };
            let Ok(variables) = process_variables(id) else { continue };
            if variables.split(|byte| *byte == 0).any(|variable| variable == wanted.as_bytes())
                && let Some(id) = rustix::process::Pid::from_raw(id)
            {
                found = true;
                let _ = rustix::process::kill_process(id, rustix::process::Signal::KILL);
            }
        }
        if !found {
            return;
        }
    }
}

#[cfg(not(target_os = "linux"))]
pub fn end(_: &Mark) {}
