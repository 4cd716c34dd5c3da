//! Files that a campaign is read from, but its records.

use std::path::{Path, PathBuf};

use indexmap::IndexSet;

use super::{CAMPAIGN_FILE, Campaign, members::RecordKind, runs::Run};
use crate::data::{place::CampaignPath, prelude::*, text::unreadable};

/// What a campaign is read from: absolute paths.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Of the campaign.
    pub folder: PathBuf,
    /// Of its records.
    pub folders: Vec<PathBuf>,
    pub files: Vec<PathBuf>,
}

impl Campaign {
    /// Folders and files that the campaign is read from, as far as they are named, without symbolic
    /// links.
    pub fn inputs(&self) -> Inputs {
        let real = |place: &CampaignPath| {
            disk::real(&place.path).ok().flatten().unwrap_or_else(|| place.path.clone())
        };
        let all = RecordKind::ALL.into_iter().flat_map(|kind| self.records(kind));
        let folders = all.filter_map(|which| Some(real(&self.record_folder(which).ok()?.0)));
        let named = self.files.iter().filter_map(|file| self.inner(&file.path).ok());
        let of_run = |run: &Run| {
            let file = |kind| self.run_source(run, kind)?.file(&run.name.span);
            RecordKind::ALL.map(file).into_iter().filter_map(Result::ok).collect::<Vec<_>>()
        };
        let of_runs: Vec<CampaignPath> = self.runs.iter().flat_map(of_run).collect();
        let folder = self.folder.real().to_path_buf();
        let beside = |place: &CampaignPath| {
            real(place).parent().map(Path::to_path_buf).filter(|beside| *beside != folder)
        };
        let mut folders: Vec<PathBuf> = folders.chain(of_runs.iter().filter_map(beside)).collect();
        folders.dedup();
        let files = named.chain(self.vehicle_files().unwrap_or_default()).chain(of_runs);
        Inputs { files: files.map(|place| real(&place)).collect(), folder, folders }
    }

    /// A file of the campaign by its path inside, at the beginning of `campaign.yaml`.
    pub(in crate::data) fn inner(&self, path: &str) -> Result<CampaignPath, Problem> {
        self.folder.place(path, &self.tree.start())
    }

    /// The same campaign, of which protocols that its own one extends are known: paths inside the
    /// campaign. A copy of it takes them along.
    pub fn with_protocols(mut self, inside: Vec<String>) -> Self {
        self.protocols = inside;
        self
    }

    /// Every file that the campaign is read from but its records, with its path inside and its
    /// bytes.
    ///
    /// # Errors
    /// A name leads outside; a file cannot be read.
    pub fn plain_files(&self) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        self.with_bytes(self.read_files().chain(self.named_files()?))
    }

    /// Every file that the campaign names but its `campaign.yaml` and the records of some kinds, with
    /// its path inside and its bytes: what a copy of the campaign needs.
    ///
    /// # Errors
    /// A file cannot be read, or lies outside.
    pub fn other_files(&self, but: &[RecordKind]) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        let mut records = Vec::new();
        let others =
            RecordKind::ALL.into_iter().filter(|kind| !but.contains(kind) && self.has(*kind));
        for which in others.flat_map(|kind| self.records(kind)) {
            for name in &self.names {
                records.push(self.place_of(which, name)?.inside);
            }
        }
        let read = self.read_files().filter(|path| path != CAMPAIGN_FILE);
        self.with_bytes(read.chain(records).chain(self.named_files()?))
    }

    /// Files that were read when the campaign was opened.
    fn read_files(&self) -> impl Iterator<Item = String> {
        self.files.iter().map(|file| file.path.clone())
    }

    /// Files that the vehicle names, and those of protocols that the campaign brings along; a
    /// shipped one is a name.
    fn named_files(&self) -> Result<Vec<String>, Problem> {
        let own = self.protocol.iter().map(|protocol| &protocol.value);
        let protocols = own.chain(&self.protocols).filter(|_| self.folder.on_disk());
        let there = |place: &CampaignPath| disk::is_file(&place.path).is_ok_and(|there| there);
        let protocols = protocols.filter_map(|path| self.inner(path).ok()).filter(there);
        Ok(self.vehicle_files()?.into_iter().chain(protocols).map(|place| place.inside).collect())
    }

    /// Each file once, although sections of one run have one file.
    fn with_bytes(
        &self,
        inside: impl Iterator<Item = String>,
    ) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        let read = |inside: String| {
            let bytes = self.folder.read_any(&self.inner(&inside)?)?;
            Ok((inside, bytes))
        };
        inside.collect::<IndexSet<_>>().into_iter().map(read).collect()
    }

    /// Files that the vehicle names, as far as they are there.
    ///
    /// # Errors
    /// A name leads outside.
    pub fn vehicle_files(&self) -> Result<Vec<CampaignPath>, Problem> {
        if !self.folder.on_disk() {
            return Ok(Vec::new());
        }
        let maps = self.vehicles.iter().flat_map(|vehicle| vehicle.data.entries());
        let texts =
            maps.flat_map(|(_, node)| node.entries()).filter_map(|(_, node)| node.scalar_text());
        let named = texts.filter(|text| text.ends_with(".csv"));
        let mut found: Vec<CampaignPath> = Vec::new();
        for written in ["profile.csv", "profile_worn.csv"].into_iter().chain(named) {
            let place = self.inner(written)?;
            let there = disk::is_file(&place.path).map_err(unreadable(&place.shown))?;
            if there && !found.contains(&place) {
                found.push(place);
            }
        }
        Ok(found)
    }
}
