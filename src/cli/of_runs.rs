//! Campaigns of which each section must have records of its own, also where sections are parts of
//! runs.

use super::kit::*;
use crate::data::cut::cut;
use crate::disk::{self, Scratch};

/// A campaign with a file for each section and kind of record.
#[derive(Debug)]
pub struct WithFiles {
    pub campaign: Campaign,
    /// The folder of a copy, which is removed when this is dropped.
    _copy: Option<Scratch>,
}

impl WithFiles {
    /// The campaign itself; if its sections are parts of runs, a copy for which they were cut.
    pub fn of(campaign: Campaign, problems: &mut Problems) -> Option<Self> {
        let campaign = with_protocols(campaign);
        if campaign.runs().is_empty() {
            return Some(Self { campaign, _copy: None });
        }
        if problems.any_error() {
            return None;
        }
        let folder = problems.value(disk::scratch().map_err(|error| {
            Problem::error("write-failed", format!("no temporary folder can be made: {error}"))
        }))?;
        let mut outputs = Outputs::of(SetKind::Campaign, folder.path()).for_this_run();
        cut(&campaign, Format::Parquet, &mut outputs)
            .map_err(|found| problems.0.extend(found))
            .ok()?;
        problems.value(outputs.commit())?;
        Some(Self {
            campaign: with_protocols(Campaign::open(folder.path(), problems)?),
            _copy: Some(folder),
        })
    }

    /// Opens a campaign; the protocol finds sections in its runs if there is no table of sections.
    /// `places` checks the output folders before anything is cut.
    pub fn open(
        folder: &Path,
        protocol: Option<&str>,
        places: &dyn Fn(&Campaign) -> Result<(), Problem>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let campaign = Campaign::open(folder, problems)?;
        problems.value(places(&campaign))?;
        if campaign.runs().is_empty() {
            return Self::of(campaign, problems);
        }
        Self::of(prepare(folder, protocol, &[], problems)?.1, problems)
    }
}
