//! A campaign folder: description, vehicle, sections, and the places of the records.
//!
//! Only the keys of the folder layout are defined here; all others are facts, which are printed or
//! requested by name.

mod confirmed;
mod facts;
mod files;
mod layout;
mod members;
mod opening;
mod records;
mod runs;
mod tolerances;
mod uncertainty;

use std::{path::Path, sync::Arc};

pub use confirmed::Confirmed;
pub use facts::Fact;
pub use files::Inputs;
pub use layout::POINT_KEY;
pub use members::{RecordKind, WhichRecord};
pub use opening::{Changed, ReadFile};
pub use records::OFFSET;
pub use runs::{OnDrift, RUN_COLUMN, RUNS, Run, RunFact, RunStretch};
pub use uncertainty::{Size, UNCERTAINTY, Uncertainty};

pub use super::folder::Memory;
use super::{
    folder::{Folder, check_file_name},
    identification::{Report, Stated},
    origin::Origin,
    place::CampaignPath,
    record::Format,
    table::{Cell, Table},
};
use crate::data::prelude::*;
use layout::{Edited, Layout};
use members::RecordFolder;
use opening::{Opening, Reader};

/// The file that makes a folder a campaign.
pub const CAMPAIGN_FILE: &str = "campaign.yaml";

/// A value that the campaign sets for a parameter of the protocol.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: Key,
    pub value: Node,
}

/// A vehicle file.
#[derive(Clone, Debug)]
pub struct VehicleState {
    /// Where there is a file for each state.
    pub state: Option<String>,
    pub data: Node,
}

#[derive(Clone, Debug)]
pub struct Campaign {
    pub name: String,
    /// What it is called where it stands beside others; the name if it has none.
    pub short_name: Spanned<String>,
    pub source: Arc<Source>,
    /// The whole of `campaign.yaml`.
    pub tree: Node,
    pub facts: Vec<Fact>,
    pub parameters: Vec<Parameter>,
    /// Values of the protocol that were confirmed.
    pub confirmed: Vec<Confirmed>,
    /// Of the channels.
    pub uncertainties: Vec<Uncertainty>,
    /// Contents of the block `report`.
    pub report: Vec<Stated>,
    /// Name or path of the default protocol.
    pub protocol: Option<Spanned<String>>,
    /// Origin of the simulated records, if they were written by a program.
    pub origin: Option<Origin>,
    /// Records that were changed after their import.
    edited: Vec<Edited>,
    /// The whole vehicle file; an empty map if the campaign has none. Of several states the first:
    /// who needs one vehicle asks [`Campaign::one_vehicle`].
    pub vehicle: Node,
    /// The vehicle in each of its states, at least one.
    pub vehicles: Vec<VehicleState>,
    /// Absent if the campaign has no section table; every measured record is then evaluated as a
    /// whole.
    pub sections: Option<Table>,
    /// Wanted operation, a point in each row; absent if the campaign does not say.
    pub application: Option<Table>,
    /// The names of the sections in the order of the table, or of the measured records, sorted.
    pub names: Vec<Cell>,
    /// `campaign.yaml`, the vehicle file, the section table and the table of wanted operation, if
    /// present.
    pub files: Vec<ReadFile>,
    /// Files of its own protocol and of those that this one extends, as paths inside it; see
    /// [`Campaign::with_protocols`].
    protocols: Vec<String>,
    folder: Folder,
    record_folders: Vec<RecordFolder>,
    runs: Vec<Run>,
}

impl Campaign {
    /// Opens a campaign by its folder or its `campaign.yaml`. Records are read later.
    ///
    /// Problems: those of `read_text`, `yaml::load` and [`Table::parse`]; `folder-missing`,
    /// `path-outside`, `path-invalid`, `key-missing`, `wrong-kind`, `no-records`.
    pub fn open(path: &Path, problems: &mut Problems) -> Option<Self> {
        let named = path.file_name().is_some_and(|name| name == CAMPAIGN_FILE)
            && !disk::is_folder(path).unwrap_or(false);
        let folder = if named { disk::folder_of(path) } else { path };
        let folder = problems.value(Folder::open(folder))?;
        Self::in_folder(folder, path, problems)
    }

    /// Opens a campaign that is in memory, or in a folder with some of its files and records
    /// replaced by those in memory.
    ///
    /// Problems: as [`Campaign::open`].
    pub fn with_memory(
        folder: Option<&Path>,
        memory: Memory,
        problems: &mut Problems,
    ) -> Option<Self> {
        let at = match folder {
            Some(folder) => problems.value(Folder::open(folder))?,
            None => Folder::nowhere(),
        };
        Self::in_folder(at.with(memory), folder.unwrap_or(Path::new("the campaign")), problems)
    }

    /// The same campaign with some of its files and records replaced by those in memory.
    ///
    /// Problems: as [`Campaign::open`].
    pub fn replaced(&self, with: Memory, problems: &mut Problems) -> Option<Self> {
        let mut memory = self.folder.memory().clone();
        memory.texts.extend(with.texts);
        memory.records.extend(with.records);
        Self::in_folder(self.folder.clone().with(memory), self.folder.shown(), problems)
    }

    fn in_folder(folder: Folder, path: &Path, problems: &mut Problems) -> Option<Self> {
        let before = problems.errors();
        let nowhere = Source::new(path.display().to_string(), "").whole();
        let place = problems.value(folder.place(CAMPAIGN_FILE, &nowhere))?;
        let on_disk = !folder.memory().texts.contains_key(CAMPAIGN_FILE);
        if on_disk && disk::is_folder(&folder.real().join(disk::UNFINISHED)).unwrap_or(false) {
            let problem = problem!(
                "unfinished-set",
                "`{}` is incomplete: the run that wrote this campaign was interrupted",
                path.display()
            );
            problems.push(problem.help("repeat that run, with the same `--out`"));
            return None;
        }
        // Anything else that is not a plain file is reported when it is read.
        if on_disk && matches!(disk::kind(&place.path), Ok(None)) {
            let problem = problem!("file-missing", "there is no file `{}`", place.shown);
            problems.push(problem.help("a campaign is a folder with a file `campaign.yaml`"));
            return None;
        }
        let with = Opening { folder, files: Vec::new(), tree: None };
        let mut reader = Reader { with, problems };
        let (source, tree) = reader.yaml(&place, None)?;
        let mut campaign = Self::of_tree(reader, source, tree)?;
        campaign.find_names(problems);
        (problems.errors() == before).then_some(campaign)
    }

    /// A campaign that is not written yet: the tree of its `campaign.yaml`, whose parts may stand
    /// in other files, and its small files. `names`: those of its records, of which none is read,
    /// for a campaign without a table of sections and without runs.
    ///
    /// Problems: as [`Campaign::open`].
    pub fn not_written(
        tree: Node,
        memory: Memory,
        names: Vec<Cell>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let before = problems.errors();
        let folder = Folder::nowhere().with(memory);
        let with = Opening { folder, files: Vec::new(), tree: None };
        let reader = Reader { with, problems };
        let mut campaign = Self::of_tree(reader, Arc::clone(&tree.span.source), tree)?;
        if campaign.sections.is_none() && campaign.runs.is_empty() {
            campaign.names = names;
        } else {
            campaign.find_names(problems);
        }
        (problems.errors() == before).then_some(campaign)
    }

    /// Everything that `campaign.yaml` and its tables say; the names of the sections are not known
    /// yet.
    fn of_tree(reader: Reader<'_, '_>, source: Arc<Source>, tree: Node) -> Option<Self> {
        let before = reader.problems.errors();
        let Opening { folder, files, .. } = reader.with;
        let with = Opening { folder, files, tree: Some(&tree) };
        let mut reader = Reader { with, problems: reader.problems };
        let layout: Layout = reader.file(&tree)?;
        let Reader { with: Opening { folder, files, .. }, problems } = reader;
        let report = layout.report.map(|node| Report::read(&node, Layout::KEYS, problems));
        let runs = layout.runs.unwrap_or_default();
        if let Some(table) = &layout.sections {
            runs::check_column(table, &runs, problems);
        }
        check_edited(&layout.edited, layout.origin.as_ref(), problems);
        let (facts, uncertainties) =
            (facts::facts(&tree), layout.uncertainties.unwrap_or_default());
        tolerances::check_tolerances(&uncertainties, &facts, problems);
        let name = layout.name.map(|name| name.value).unwrap_or_default();
        let mut vehicles = layout.vehicles.unwrap_or_default();
        if vehicles.is_empty() {
            let data = Node { value: Value::Map(Vec::new()), ..tree.clone() };
            vehicles.push(VehicleState { state: None, data });
        }
        let record_folders = [layout.measurement, layout.simulation, layout.track];
        let short_name = layout.short_name;
        let campaign = Self {
            short_name: short_name
                .unwrap_or_else(|| Spanned::new(name.clone(), tree.span_or_start("name"))),
            name,
            facts,
            parameters: layout.parameters.unwrap_or_default(),
            confirmed: layout.confirmed.unwrap_or_default(),
            uncertainties,
            report: report.unwrap_or_default().0,
            protocol: layout.protocol,
            origin: layout.origin,
            edited: layout.edited,
            vehicle: vehicles[0].data.clone(),
            vehicles,
            names: Vec::new(),
            sections: layout.sections,
            application: layout.application,
            source,
            files,
            protocols: Vec::new(),
            folder,
            record_folders: record_folders.into_iter().flatten().flatten().collect(),
            runs,
            tree,
        };
        (problems.errors() == before).then_some(campaign)
    }

    fn find_names(&mut self, problems: &mut Problems) {
        self.names = match &self.sections {
            Some(table) => table.names().cloned().collect(),
            None if !self.runs.is_empty() => self.runs.iter().map(|run| run.name.clone()).collect(),
            None => problems.value(self.measured()).unwrap_or_default(),
        };
        for name in &self.names {
            problems.value(check_file_name(&name.value, &name.span));
        }
    }

    /// # Errors
    /// `several-vehicles`: who asks needs one vehicle, and the campaign has one for each state.
    pub fn one_vehicle(&self) -> Result<(), Problem> {
        let names: Vec<&str> =
            self.vehicles.iter().filter_map(|vehicle| vehicle.state.as_deref()).collect();
        if names.len() < 2 {
            return Ok(());
        }
        let says = format!(
            "the campaign has a vehicle file for each state ({}), and one vehicle is needed here",
            names.join(", ")
        );
        let help = "name one file in a copy of campaign.yaml, with the sections of that state: `vehicle: vehicle.yaml`";
        Err(error("several-vehicles", says, &self.tree.span_or_start("vehicle")).help(help))
    }

    /// The folder of the campaign, without symbolic links.
    pub fn folder(&self) -> &Path {
        self.folder.real()
    }

    /// Whether the campaign has a folder.
    pub fn on_disk(&self) -> bool {
        self.folder.on_disk()
    }

    /// A small text file of the campaign, and the SHA-256 of its bytes.
    ///
    /// # Errors
    /// As [`read_text`](super::text::read_text).
    pub fn read_text(&self, place: &CampaignPath) -> Result<Arc<Source>, Problem> {
        self.folder.read_text(place).map(|(source, ..)| source)
    }

    /// The path inside the campaign of a file that a message names by the folder as it was given.
    pub fn inside<'a>(&self, shown: &'a str) -> &'a str {
        self.folder.inside(shown)
    }

    /// The place of a file named by the campaign or its vehicle; it need not exist.
    ///
    /// # Errors
    /// `path-outside`, `path-invalid`.
    pub fn place(&self, written: &Spanned<String>) -> Result<CampaignPath, Problem> {
        self.folder.place(&written.value, &written.span)
    }
}

/// Records that are said to be edited must be ones that the import wrote, where it wrote some of
/// their side.
fn check_edited(edited: &[Edited], origin: Option<&Origin>, problems: &mut Problems) {
    for Spanned { value, span } in edited.iter().map(|edited| &edited.record) {
        let side = value.split('/').next().unwrap_or_default();
        let records = origin.into_iter().flat_map(|origin| origin.imported_records(side));
        let known: Vec<&str> = records.map(|record| record.path.as_str()).collect();
        if !known.is_empty() && !known.iter().any(|one| Format::stem(one) == Format::stem(value)) {
            let problem = problem!("unknown-record", span, "no import wrote a record `{value}`");
            problems.push(problem.suggest(value, known));
        }
    }
}
