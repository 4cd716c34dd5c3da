//! Common inputs of the subcommands that evaluate a protocol on a campaign.

use std::num::NonZeroUsize;
use std::sync::Arc;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::{Console, Exit};
pub use crate::prepare::{Pool, Prepared, compiled_for, prepare, prepare_all, with_protocols};
use crate::problem::Problem;

/// Maximum number of records processed in parallel. Each takes a thread, and memory for its text
/// and signals. The value exceeds the number of cores of the machines the program is used on.
const MOST_JOBS: usize = 256;

/// Starts the requested number of threads.
///
/// # Errors
/// The number exceeds [`MOST_JOBS`]; the exit code.
pub fn start_jobs(jobs: Option<NonZeroUsize>, console: &Console) -> Result<(), Exit> {
    let Some(jobs) = jobs.map(NonZeroUsize::get) else { return Ok(()) };
    if jobs > MOST_JOBS {
        let says = format!("`--jobs {jobs}` exceeds the maximum of {MOST_JOBS}");
        return Err(console
            .fail(Problem::error("jobs", says).help("omit it to use one per core"), Exit::Wrong));
    }
    // Fails only if the thread pool exists already, which is not the case here.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(jobs).build_global();
    Ok(())
}

/// A progress bar on a terminal; nothing if the output is redirected.
pub fn progress_bar(console: &Console, steps: usize) -> Arc<ProgressBar> {
    let bar = ProgressBar::new(steps as u64);
    if console.quiet {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    Arc::new(bar)
}
