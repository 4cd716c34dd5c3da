//! Common inputs of the subcommands that evaluate a protocol on a campaign.

use std::{
    error::Error,
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

use super::{
    output::Ended,
    places::{REPORT, check_folder, check_not_input, check_out},
};
use crate::data::Campaign;
pub use crate::prepare::{compiled_for, opened_all, prepare, prepare_all, with_protocols};
use crate::problem::{Problem, Problems};

/// Maximum number of records processed in parallel. Each takes a thread, and memory for its text
/// and signals. The value exceeds the number of cores of the machines the program is used on.
const MOST_JOBS: usize = 256;

/// Number of threads where `--jobs` states none, as the thread pool reads it.
const THREADS: &str = "RAYON_NUM_THREADS";

/// Starts the requested number of threads: `--jobs`, the environment, else one per core.
///
/// # Errors
/// The number exceeds [`MOST_JOBS`]; the system starts no more threads.
pub fn start_jobs(jobs: Option<NonZeroUsize>) -> Result<(), Ended> {
    let stated = std::env::var(THREADS).ok().and_then(|text| text.parse().ok());
    let (jobs, by) = match jobs {
        Some(jobs) => (jobs.get(), format!("`--jobs {jobs}`")),
        None => (stated.unwrap_or(0), format!("`{THREADS}={}`", stated.unwrap_or(0))),
    };
    if jobs > MOST_JOBS {
        let says = format!("{by} exceeds the maximum of {MOST_JOBS}");
        return Err(Problem::error("jobs", says).help("omit it to use one per core").into());
    }
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let jobs = if jobs == 0 { cores.min(MOST_JOBS) } else { jobs };
    let started = rayon::ThreadPoolBuilder::new().num_threads(jobs).build_global();
    // Without a reason of the system, there are threads already.
    match started.err().as_ref().and_then(Error::source) {
        Some(why) => {
            let says = format!("{jobs} threads cannot be started: {why}");
            let problem = Problem::error("jobs", says).help("state fewer: `--jobs 1`");
            Err(Ended::unfinished(problem))
        }
        None => Ok(()),
    }
}

/// Refuses an output folder if files of one of the campaigns would be overwritten.
pub fn check_outputs(out: &Path, names: &[&str], of: &[Campaign], problems: &mut Problems) {
    for campaign in of {
        problems.add(check_folder(out, names, campaign).err());
    }
}

/// Refuses an output folder in which a report would overwrite one of some files.
pub fn check_report(out: &Path, files: &[PathBuf], problems: &mut Problems) {
    let inputs: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    for name in REPORT {
        problems.add(check_not_input(&out.join(name), &inputs).err());
    }
    problems.add(check_out(out).err());
}
