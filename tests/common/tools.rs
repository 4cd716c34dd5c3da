//! Programs that a test needs and a machine may not have.

use std::io::Write;

/// Counts a test, or a part of one, as skipped: one line on the terminal, whatever the test prints
/// otherwise. `FISHPLATE_INSTALLED` names the programs that must be there, as in continuous
/// integration, which installs them: there a skip is a failure.
///
/// # Panics
/// The program is missing although it must be there.
pub fn skip(missing: &str) {
    let installed = std::env::var("FISHPLATE_INSTALLED").unwrap_or_default();
    assert!(
        !installed.split_whitespace().any(|program| program == missing),
        "{missing} is installed here, and the test did not find it"
    );
    // Not `eprintln`, which the test harness hides where the test passes.
    let _ = writeln!(std::io::stderr().lock(), "skipped: {missing} is missing");
}
