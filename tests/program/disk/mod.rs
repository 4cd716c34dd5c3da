//! Every operation on the disk fails once, or is the last one before the program ends: what is left
//! is what was there before, whole, or what was asked for, whole; or it is told. In the manner of
//! SQLite ("How SQLite Is Tested", 3.2 and 3.3: I/O error and crash testing).

use crate::common::campaign;
mod commands;
mod injector;
use crate::common::program;
mod real;
mod sets;

use std::process::Command;

/// Runs the rest of a test in a process of its own: a fault holds for the whole process, and
/// messages of runs that are meant to fail need not be seen. In that process it is true.
fn alone(test: &str) -> bool {
    const SET: &str = "FISHPLATE_TEST_ALONE";
    if std::env::var_os(SET).is_some() {
        return true;
    }
    let (this, test) = (std::env::current_exe().expect("a path"), format!("disk::{test}"));
    // In memory, where syncing takes no time.
    let memory = std::path::Path::new("/dev/shm");
    let place = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
    let ran = Command::new(this)
        .env("TMPDIR", place)
        .args(["--exact", test.as_str(), "--nocapture", "--test-threads", "1"])
        .env(SET, "1")
        .output()
        .expect("it starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (said, told) = (text(&ran.stdout), text(&ran.stderr));
    assert!(
        said.contains("1 passed") && ran.status.success(),
        "{said}\n{}",
        &told[told.len().saturating_sub(4000)..]
    );
    told.lines().filter(|line| line.contains("points")).for_each(|line| eprintln!("{line}"));
    false
}
