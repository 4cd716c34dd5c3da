//! `sections`: writes the sections that a protocol finds in the runs of a campaign.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::inputs::{Pool, compiled_for, start_jobs};
use super::output::{Console, Exit};
use super::places::check_file;
use crate::problem::Problems;
use crate::report::found::{drift_in_words, in_words};
use crate::report::number::count;
use crate::result::found::FoundSections;
use crate::run::find;

/// Stretches of rejected places that are printed of each run; the table of a report has all.
const TOLD: usize = 12;

#[derive(Debug, Args)]
pub struct Sections {
    /// Folder of the campaign, which has runs.
    #[arg(value_name = "CAMPAIGN")]
    campaign: PathBuf,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml]
    #[arg(long, short)]
    protocol: Option<String>,
    /// Table of the sections that are found; in the folder of the campaign, `sections: sections.csv` in campaign.yaml then uses it.
    #[arg(long, short)]
    out: PathBuf,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Number of threads [default: one per core]
    #[arg(long, short)]
    jobs: Option<NonZeroUsize>,
}

impl Sections {
    pub fn run(self, console: &Console) -> Exit {
        if let Err(exit) = start_jobs(self.jobs, console) {
            return exit;
        }
        let mut problems = Problems::default();
        let pool = compiled_for(std::slice::from_ref(&self.campaign), self.protocol.as_deref(), &self.set, &mut problems);
        for campaign in pool.iter().flat_map(|pool| &pool.campaigns) {
            let inputs = campaign.inputs();
            let files: Vec<_> = inputs.files.iter().map(PathBuf::as_path).collect();
            if let Err(problem) = check_file(&self.out, &files) {
                problems.push(problem);
            }
        }
        console.problems(&problems);
        let Some(Pool { compiled, campaigns, .. }) = pool.filter(|_| !problems.any_error()) else { return Exit::Wrong };
        let found = match find::find(&compiled.plan, &compiled.graph, &campaigns[0], &|_| {}) {
            Ok(found) => found,
            Err(problems) => {
                console.problems(&problems);
                return Exit::Wrong;
            }
        };
        let Some(table) = &found.campaign.sections else { return Exit::Unfinished };
        let written = console.write(&self.out, table.source.text.as_bytes());
        if written != Exit::Done {
            return written;
        }
        if !console.quiet {
            console.print(&told(&found.told));
            console.say(&format!("written: {}", self.out.display()));
        }
        Exit::Done
    }
}

fn told(found: &FoundSections) -> String {
    let mut out = format!("{}\n", in_words(found));
    let unit = &found.axis_unit;
    for run in &found.runs {
        let _ = writeln!(out, "\n{}: {} to {} {unit}, {} sections", run.run, run.start, run.end, run.found);
        if let Some(says) = drift_in_words(run, unit) {
            let _ = writeln!(out, "  {says}");
        }
        for rejected in &run.rejected {
            let _ = writeln!(out, "  {:>8}  {}", count(rejected.places as u64), rejected.reason);
        }
        let mut longest: Vec<_> = run.stretches.iter().collect();
        longest.sort_by(|a, b| b.places.cmp(&a.places).then(a.from.total_cmp(&b.from)));
        longest.truncate(TOLD);
        longest.sort_by(|a, b| a.from.total_cmp(&b.from));
        let _ = writeln!(out, "  longest stretches without a section:");
        for stretch in longest {
            let _ = writeln!(out, "  {:>10} to {:>10} {unit}  {}", stretch.from, stretch.to, stretch.reason);
        }
    }
    out
}
