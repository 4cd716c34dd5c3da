//! `sections`: writes the sections that a protocol finds in the runs of a campaign.

use std::fmt::Write;

use super::{inputs::compiled_for, kit::*};
use crate::certify::Opened;
use crate::data::cut::cut;
use crate::report::{
    found::{drift_in_words, in_words},
    number::count,
};
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
    pub fn run(self, console: &Console) -> Done {
        start_jobs(self.jobs)?;
        let Opened { compiled, campaigns, .. } = console.read(|problems| {
            let campaigns = std::slice::from_ref(&self.campaign);
            let opened = compiled_for(campaigns, self.protocol.as_deref(), &self.set, problems)?;
            let inputs = opened.campaigns[0].inputs();
            let files: Vec<_> = inputs.files.iter().map(PathBuf::as_path).collect();
            problems.add(self.out.as_ref().and_then(|out| check_file(out, &files).err()));
            if let Some(folder) = &self.cut {
                check_outputs(folder, CAMPAIGN, &opened.campaigns, problems);
            }
            Some(opened)
        })?;
        // A table that the campaign has can be cut by; it is not looked for again.
        let given = campaigns[0].sections.is_some() && self.out.is_none();
        let (campaign, told) = if given {
            (campaigns[0].clone(), None)
        } else {
            let found = find::find(&compiled.plan, &compiled.graph, &campaigns[0], &|_| {})?;
            (found.campaign, Some(found.told))
        };
        let campaign = with_protocols(campaign);
        // The copy is complete beside its folder before the table is written: if one of them cannot
        // be written, neither is.
        let cut_to = |folder: &PathBuf| {
            let mut outputs = Outputs::of(SetKind::Campaign, folder);
            let records = cut(&campaign, Format::from(self.records), &mut outputs);
            records
                .map(|records| (outputs, records))
                .map_err(|found| Ended::wrong_or_unwritten(Problems(found)))
        };
        let copy = self.cut.as_ref().map(cut_to).transpose()?;
        if let (Some(out), Some(table)) = (&self.out, &campaign.sections) {
            console.write(out, table.source.text.as_bytes())?;
        }
        let committed =
            copy.map(|(outputs, records)| console.commit(Ok(outputs)).map(|()| records));
        let records = committed.transpose()?;
        if !console.quiet {
            if let Some(found) = &told {
                console.print(&words(found))?;
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
        Ok(Exit::Done)
    }
}

fn words(found: &FoundSections) -> Lines {
    let mut out = Lines::default();
    out += &in_words(found);
    let unit = &found.axis_unit;
    for run in &found.runs {
        out += "\n";
        let _ = writeln!(
            out,
            "{}: {} to {} {unit}, {} sections",
            run.run, run.start, run.end, run.found
        );
        if let Some(says) = drift_in_words(run, unit) {
            let _ = writeln!(out, "  {says}");
        }
        for rejected in &run.rejected {
            let _ =
                writeln!(out, "  {:>8}  {}", count(rejected.places as u64), rejected.reason.text());
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
                stretch.from,
                stretch.to,
                stretch.reason.text()
            );
        }
    }
    out
}
