//! `certify`: evaluates a protocol on a campaign and writes the report.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::inputs::{Pool, prepare_all, progress_bar, start_jobs};
use super::output::{Console, Exit};
use super::places::{REPORT, check_folder};
use super::report::Report;
use super::values::from_one;
use crate::certify::certify;
use crate::data::Campaigns;
use crate::problem::{Problems, plain};
use crate::result::Certification;

#[derive(Debug, Args)]
pub struct Certify {
    /// Folder of the campaign; several are evaluated as one.
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Path of a protocol, or name of a shipped one [default: the one in campaign.yaml, else
    /// en14363-2016-annex-t]
    #[arg(long, short)]
    protocol: Option<String>,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    report: Report,
    /// Number of records processed in parallel [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Certify {
    pub fn run(self, console: &Console) -> Exit {
        if let Err(exit) = start_jobs(self.jobs, console) {
            return exit;
        }
        let mut problems = Problems::default();
        let prepared =
            prepare_all(&self.campaigns, self.protocol.as_deref(), &self.set, &mut problems);
        for campaign in prepared.iter().flat_map(|pool| &pool.campaigns) {
            if let Err(problem) = check_folder(&self.report.out, REPORT, campaign) {
                problems.push(problem);
            }
        }
        console.problems(&problems);
        let Some(Pool { compiled, campaigns, found: searched, .. }) =
            prepared.filter(|_| !problems.any_error())
        else {
            return Exit::Wrong;
        };
        let key = match self.report.key(console) {
            Ok(key) => key,
            Err(exit) => return exit,
        };
        let bar = progress_bar(console, Campaigns::from(&campaigns).sections());
        let found = certify(&compiled, &campaigns, self.report.settings(), &|section| {
            bar.set_message(plain(section));
            bar.inc(1);
        });
        bar.finish_and_clear();
        match found {
            Ok(found) => self.report.write(
                &Certification { found: searched, ..found },
                key.as_ref(),
                console,
            ),
            Err(problems) => {
                console.problems(&problems);
                Exit::Wrong
            }
        }
    }
}
