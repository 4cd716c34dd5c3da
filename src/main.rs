//! The `fishplate` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    fishplate::cli::run().into()
}
