//! Common inputs of the subcommands that evaluate a protocol on a campaign.

use std::num::NonZeroUsize;
use std::path::Path;

use super::output::Ended;
use super::places::check_folder;
use crate::certify::Opened;
pub use crate::prepare::{compiled_for, prepare, prepare_all, with_protocols};
use crate::problem::{Problem, Problems};

/// Maximum number of records processed in parallel. Each takes a thread, and memory for its text
/// and signals. The value exceeds the number of cores of the machines the program is used on.
const MOST_JOBS: usize = 256;

/// Starts the requested number of threads.
///
/// # Errors
/// The number exceeds [`MOST_JOBS`].
pub fn start_jobs(jobs: Option<NonZeroUsize>) -> Result<(), Ended> {
    let Some(jobs) = jobs.map(NonZeroUsize::get) else { return Ok(()) };
    if jobs > MOST_JOBS {
        let says = format!("`--jobs {jobs}` exceeds the maximum of {MOST_JOBS}");
        return Err(Problem::error("jobs", says).help("omit it to use one per core").into());
    }
    // Fails only if the thread pool exists already, which is not the case here.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(jobs).build_global();
    Ok(())
}

/// Refuses an output folder if files of one of the campaigns would be overwritten.
pub fn check_outputs(out: &Path, names: &[&str], opened: Option<&Opened>, problems: &mut Problems) {
    for campaign in opened.iter().flat_map(|opened| &opened.campaigns) {
        problems.add(check_folder(out, names, campaign).err());
    }
}
