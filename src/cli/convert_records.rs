//! `convert-records`: a copy of a campaign with its records in another format.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    inputs::{start_jobs, with_protocols},
    output::{Console, Done, Ended, Exit},
    places::{CAMPAIGN, check_folder},
};
use crate::data::{Campaign, conversion::convert, record::Format, write::Outputs};
use crate::disk::SetKind;
use crate::problem::Problems;

/// Format of records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Records {
    /// Text with commas.
    #[default]
    Csv,
    /// Columns, compressed.
    Parquet,
}

impl From<Records> for Format {
    fn from(records: Records) -> Self {
        match records {
            Records::Csv => Self::Csv,
            Records::Parquet => Self::Parquet,
        }
    }
}

#[derive(Debug, Args)]
pub struct ConvertRecords {
    /// Folder of the campaign.
    campaign: PathBuf,
    /// Format of the new records.
    #[arg(long, value_enum)]
    to: Records,
    /// Folder of the copy; created if missing.
    #[arg(long, short)]
    out: PathBuf,
}

impl ConvertRecords {
    pub fn run(self, console: &Console) -> Done {
        start_jobs(None)?;
        let mut problems = Problems::default();
        let campaign = Campaign::open(&self.campaign, &mut problems).map(with_protocols);
        if let Some(campaign) = &campaign {
            problems.add(check_folder(&self.out, CAMPAIGN, campaign).err());
        }
        let campaign = console.sound(campaign, &problems)?;
        let mut outputs = Outputs::of(SetKind::Campaign, &self.out);
        let done = convert(&campaign, self.to.into(), &mut outputs)
            .map_err(|found| Ended::wrong_or_unwritten(Problems(found)))?;
        console.commit(Ok(outputs))?;
        let counted = |count: usize, what: &str| {
            if count == 0 { String::new() } else { format!(", {count} {what}") }
        };
        let others = counted(done.copied, "copied") + &counted(done.missing, "missing");
        console.say(&format!(
            "written: {} records converted{others}, to {}",
            done.converted,
            self.out.display()
        ));
        Ok(Exit::Done)
    }
}
