//! The `fishplate` program.

use std::process::ExitCode;

use mimalloc::MiMalloc;

/// Each section allocates and frees some megabytes. The allocator of glibc gives them back to the system each time and gets them
/// cleared again, which took a quarter of the processor time of `reduce` (docs/performance.md).
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    fishplate::cli::run().into()
}
