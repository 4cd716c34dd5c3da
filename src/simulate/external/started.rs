//! Processes that a program started and that left its group: found by a variable that they inherit.
//!
//! A group is ended as one, but whoever calls `setsid` is in another. The variable stays with all that a call starts,
//! unless they take it out on purpose. Only Linux shows the variables of other processes.

use std::sync::atomic::{AtomicUsize, Ordering};

/// The variable.
pub(super) const NAME: &str = "FISHPLATE_CALL";

/// What the variable says: one value for each call of this process.
#[derive(Debug)]
pub(super) struct Mark(String);

impl Mark {
    pub fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        Self(format!("{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed)))
    }

    pub fn value(&self) -> &str {
        &self.0
    }
}

/// Rounds of looking for processes: each ends what the ones before had started meanwhile.
#[cfg(target_os = "linux")]
const ROUNDS: usize = 16;

/// Ends all processes with a mark.
#[cfg(target_os = "linux")]
pub(super) fn end(mark: &Mark) {
    use crate::disk::{names, process_variables};
    let wanted = format!("{NAME}={}", mark.value());
    for _ in 0..ROUNDS {
        let mut found = false;
        for name in names(std::path::Path::new("/proc")).unwrap_or_default() {
            let Some(id) = name.to_str().and_then(|name| name.parse::<i32>().ok()) else { continue };
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
pub(super) fn end(_: &Mark) {}
