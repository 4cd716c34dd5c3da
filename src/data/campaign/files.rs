//! Files that a campaign is read from, but its records.

use std::path::{Path, PathBuf};

use super::{CAMPAIGN_FILE, Campaign, RecordKind, Run};
use crate::data::folder::Place;
use crate::data::text::unreadable;
use crate::disk;
use crate::problem::Problem;

/// A file that was read, and its fingerprint.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// Inside the campaign, with `/`.
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
}

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
        let real = |place: &Place| {
            disk::real(&place.path).ok().flatten().unwrap_or_else(|| place.path.clone())
        };
        let all = RecordKind::ALL.into_iter().flat_map(|kind| self.records(kind));
        let folders = all.filter_map(|which| Some(real(&self.record_folder(which).ok()?.0)));
        let named = self
            .files
            .iter()
            .filter_map(|file| self.folder.place(&file.path, &self.tree.span.part(0..0)).ok());
        let of_run = |run: &Run| {
            let files =
                RecordKind::ALL.map(|kind| self.run_source(run, kind)?.file(&run.name.span));
            files.into_iter().filter_map(Result::ok).collect::<Vec<_>>()
        };
        let of_runs: Vec<Place> = self.runs.iter().flat_map(of_run).collect();
        let folder = self.folder.real().to_path_buf();
        let beside = |place: &Place| {
            real(place).parent().map(Path::to_path_buf).filter(|beside| *beside != folder)
        };
        let mut folders: Vec<PathBuf> = folders.chain(of_runs.iter().filter_map(beside)).collect();
        folders.dedup();
        let files = named.chain(self.vehicle_files().unwrap_or_default()).chain(of_runs);
        Inputs { files: files.map(|place| real(&place)).collect(), folder, folders }
    }

    /// The same campaign, of which protocols that its own one extends are known: paths inside the
    /// campaign. A copy of it takes them along.
    #[must_use]
    pub fn with_protocols(mut self, inside: Vec<String>) -> Self {
        self.protocols = inside;
        self
    }

    /// Files of protocols that the campaign brings along; a shipped one is a name.
    fn protocol_files(&self) -> Vec<Place> {
        let named = self
            .protocol
            .iter()
            .map(|protocol| &protocol.value)
            .chain(&self.protocols)
            .filter(|_| self.folder.on_disk());
        let mut found: Vec<Place> = Vec::new();
        for place in
            named.filter_map(|path| self.folder.place(path, &self.tree.span.part(0..0)).ok())
        {
            if disk::is_file(&place.path).is_ok_and(|there| there) && !found.contains(&place) {
                found.push(place);
            }
        }
        found
    }

    /// Every file that the campaign is read from but its records, with its path inside.
    ///
    /// # Errors
    /// A name leads outside.
    pub fn plain_files(&self) -> Result<Vec<String>, Problem> {
        let mut inside: Vec<String> = self.files.iter().map(|file| file.path.clone()).collect();
        for place in self.vehicle_files()?.into_iter().chain(self.protocol_files()) {
            if !inside.contains(&place.inside) {
                inside.push(place.inside);
            }
        }
        Ok(inside)
    }

    /// Every file that the campaign names but its `campaign.yaml` and the records of one kind, with
    /// its path inside and its bytes: what a copy of the campaign needs.
    ///
    /// # Errors
    /// A file cannot be read, or lies outside.
    pub fn other_files(&self, but: RecordKind) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        let mut inside: Vec<String> = self
            .files
            .iter()
            .map(|file| file.path.clone())
            .filter(|path| path != CAMPAIGN_FILE)
            .collect();
        let others = RecordKind::ALL.into_iter().filter(|kind| *kind != but && self.has(*kind));
        for which in others.flat_map(|kind| self.records(kind)) {
            for name in &self.names {
                let place = self.place_of(which, name)?;
                // Sections of one run have one file.
                if !inside.contains(&place.inside) {
                    inside.push(place.inside);
                }
            }
        }
        for place in self.vehicle_files()?.into_iter().chain(self.protocol_files()) {
            if !inside.contains(&place.inside) {
                inside.push(place.inside);
            }
        }
        let read = |inside: String| {
            let place = self.folder.place(&inside, &self.tree.span.part(0..0))?;
            let bytes = self.folder.read_any(&place)?;
            Ok((inside, bytes))
        };
        inside.into_iter().map(read).collect()
    }

    /// Files that the vehicle names, as far as they are there.
    ///
    /// # Errors
    /// A name leads outside.
    pub fn vehicle_files(&self) -> Result<Vec<Place>, Problem> {
        if !self.folder.on_disk() {
            return Ok(Vec::new());
        }
        let mut named = vec!["profile.csv".to_string(), "profile_worn.csv".to_string()];
        let maps = self
            .vehicles
            .iter()
            .flat_map(|vehicle| vehicle.data.entries())
            .flat_map(|(_, node)| node.entries());
        named.extend(
            maps.filter_map(|(_, node)| Some(node.scalar_text()?.to_string()))
                .filter(|text| text.ends_with(".csv")),
        );
        let mut found: Vec<Place> = Vec::new();
        for written in named {
            let place = self.folder.place(&written, &self.tree.span.part(0..0))?;
            let unreadable = |error| unreadable(&place.shown, &error);
            if disk::is_file(&place.path).map_err(unreadable)? && !found.contains(&place) {
                found.push(place);
            }
        }
        Ok(found)
    }
}
