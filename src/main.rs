//! The `fishplate` program.

use std::process::ExitCode;

/// Signals of sections are large blocks that live briefly. The allocator of glibc often gives them
/// back to the system, which clears them for the next section: `certify` then takes an eighth more
/// processor time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    fishplate::cli::run().into()
}
