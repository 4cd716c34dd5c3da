//! `sections`: writes the sections that a protocol finds in the runs of a campaign.

use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Args;

use super::convert_records::Records;
use super::inputs::{Pool, compiled_for, start_jobs, with_protocols};
use super::output::{Console, Exit};
use super::places::{CAMPAIGN, check_file, check_folder};
use super::values::from_one;
use crate::data::Campaign;
use crate::data::cut::cut;
use crate::data::record::Format;
use crate::data::write::Outputs;
use crate::disk::SetKind;
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
    /// Table of the sections that are found; in the folder of the campaign, `sections:
    /// sections.csv` in campaign.yaml then uses it.
    #[arg(long, short, required_unless_present = "cut")]
    out: Option<PathBuf>,
    /// Folder for a copy of the campaign in which each section has records of its own.
    #[arg(long, value_name = "DIR")]
    cut: Option<PathBuf>,
    /// Format of these records.
    #[arg(long, value_enum, default_value_t, requires = "cut")]
    records: Records,
    /// Set a parameter of the protocol.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Number of threads [default: one per core]
    #[arg(long, short, value_parser = from_one)]
    jobs: Option<NonZeroUsize>,
}

impl Sections {
    pub fn run(self, console: &Console) -> Exit {
        if let Err(exit) = start_jobs(self.jobs, console) {
            return exit;
        }
        let mut problems = Problems::default();
        let pool = compiled_for(
            std::slice::from_ref(&self.campaign),
            self.protocol.as_deref(),
            &self.set,
            &mut problems,
        );
        for campaign in pool.iter().flat_map(|pool| &pool.campaigns) {
            let inputs = campaign.inputs();
            let files: Vec<_> = inputs.files.iter().map(PathBuf::as_path).collect();
            let table = self.out.as_ref().map_or(Ok(()), |out| check_file(out, &files));
            let copy =
                self.cut.as_ref().map_or(Ok(()), |folder| check_folder(folder, CAMPAIGN, campaign));
            [table, copy]
                .into_iter()
                .filter_map(Result::err)
                .for_each(|problem| problems.push(problem));
        }
        console.problems(&problems);
        let Some(Pool { compiled, campaigns, .. }) = pool.filter(|_| !problems.any_error()) else {
            return Exit::Wrong;
        };
        // A table that the campaign has can be cut by; it is not looked for again.
        let given = campaigns[0].sections.is_some() && self.out.is_none();
        let (campaign, told) = if given {
            (campaigns[0].clone(), None)
        } else {
            match find::find(&compiled.plan, &compiled.graph, &campaigns[0], &|_| {}) {
                Ok(found) => (found.campaign, Some(found.told)),
                Err(problems) => {
                    console.problems(&problems);
                    return Exit::Wrong;
                }
            }
        };
        let campaign = with_protocols(campaign);
        // The copy is complete beside its folder before the table is written: if one of them cannot
        // be written, neither is.
        let copy = match self
            .cut
            .as_ref()
            .map(|folder| cut_to(folder, &campaign, Format::from(self.records), console))
            .transpose()
        {
            Ok(copy) => copy,
            Err(exit) => return exit,
        };
        if let (Some(out), Some(table)) = (&self.out, &campaign.sections) {
            let written = console.write(out, table.source.text.as_bytes());
            if written != Exit::Done {
                return written;
            }
        }
        let records = match copy
            .map(|(outputs, records)| console.commit(Ok(outputs)).map(|()| records))
            .transpose()
        {
            Ok(records) => records,
            Err(exit) => return exit,
        };
        if !console.quiet {
            if let Some(found) = &told {
                console.print(&words(found));
            }
            self.out.iter().for_each(|out| console.say(&format!("written: {}", out.display())));
            for (folder, records) in self.cut.iter().zip(records) {
                console.say(&format!(
                    "written: {records} records of {} sections to {}",
                    campaign.names.len(),
                    folder.display()
                ));
            }
        }
        Exit::Done
    }
}

/// The copy with a record for each section, and their number.
fn cut_to(
    folder: &Path,
    campaign: &Campaign,
    format: Format,
    console: &Console,
) -> Result<(Outputs, usize), Exit> {
    let mut outputs = Outputs::of(SetKind::Campaign, folder);
    match cut(campaign, format, &mut outputs) {
        Ok(records) => Ok((outputs, records)),
        Err(problems) => {
            let of_disk = problems.iter().any(|problem| problem.code == "write-failed");
            console.problems(&Problems(problems));
            Err(if of_disk { Exit::Unfinished } else { Exit::Wrong })
        }
    }
}

fn words(found: &FoundSections) -> String {
    let mut out = format!("{}\n", in_words(found));
    let unit = &found.axis_unit;
    for run in &found.runs {
        let _ = writeln!(
            out,
            "\n{}: {} to {} {unit}, {} sections",
            run.run, run.start, run.end, run.found
        );
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
            let _ = writeln!(
                out,
                "  {:>10} to {:>10} {unit}  {}",
                stretch.from, stretch.to, stretch.reason
            );
        }
    }
    out
}
