//! Where the records of a campaign are: one folder or several of each kind, a file for each
//! section.

use std::collections::HashSet;
use std::io;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Campaign, Part, ReadFile};
use crate::data::folder::{Place, check_file_name, names_in};
use crate::data::members::{self, RecordFolder, WhichRecord};
use crate::data::record::{Format, Record, RecordSource, Wanted};
use crate::data::table::Cell;
use crate::data::text::{other_format, unreadable};
use crate::disk;
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::units::Dimension;

/// The kinds of records that a campaign has, each in a folder of its own with a file per section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum RecordKind {
    Measurement,
    Simulation,
    Track,
}

impl RecordKind {
    pub const ALL: [Self; 3] = [Self::Measurement, Self::Simulation, Self::Track];

    /// The key in `campaign.yaml`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Measurement => "measurement",
            Self::Simulation => "simulation",
            Self::Track => "track",
        }
    }
}

/// Most comparisons of names with names that are made to suggest what was meant for missing records
/// of a campaign.
const MOST_COMPARISONS: usize = 1_000_000;

impl Campaign {
    /// The names of the measured records.
    pub(super) fn measured(&self) -> Result<Vec<Cell>, Problem> {
        let measured = self.found(RecordKind::Measurement.into())?;
        if measured.in_store() {
            let says = "the measured records are in a store, which is not listed: the campaign must name its sections";
            let help = "add `sections: sections.csv`, a table with a row for each section";
            return Err(Problem::error("key-missing", says).at(&measured.folder.span).help(help));
        }
        let (place, span) = self.record_folder(RecordKind::Measurement.into())?;
        let inside = format!("{}/", place.inside);
        let kept =
            self.folder.memory().records.keys().filter_map(|name| name.strip_prefix(&inside));
        let names: Vec<Cell> =
            kept.map(|name| Spanned::new(name.to_string(), span.clone())).collect();
        if !names.is_empty() {
            return Ok(names);
        }
        self.none_in_memory(&inside, span)?;
        let nearest = |problem: Problem| {
            problem.suggest(&place.inside, Self::folders_beside(&place).iter().map(String::as_str))
        };
        let entries = disk::names(&place.path)
            .map_err(|error| nearest(no_folder(&error, &place.shown).at(span)))?;
        let mut names: Vec<String> = entries
            .iter()
            .filter_map(|name| Some(Format::stem(name.to_str()?)?.to_string()))
            .filter(|name| !name.starts_with('.'))
            .collect();
        if names.is_empty() {
            let others: Vec<String> =
                entries.into_iter().filter_map(|name| name.into_string().ok()).collect();
            if let Some(problem) = others
                .iter()
                .find_map(|name| other_format(Path::new(name), &format!("{}/{name}", place.inside)))
            {
                return Err(problem.at(span));
            }
            return Err(Problem::error(
                "no-records",
                format!("there is no CSV or Parquet file in `{}`", place.shown),
            )
            .at(span));
        }
        names.sort();
        // Both formats of a section are told when it is read.
        names.dedup();
        Ok(names.into_iter().map(|name| Spanned::new(name, span.clone())).collect())
    }

    pub(super) fn record_folder(&self, which: WhichRecord) -> Result<(Place, &Span), Problem> {
        let found = self.found(which)?;
        let RecordFolder { folder: written, place, .. } = found;
        if found.in_store() {
            let says = format!(
                "`{}` is in a store, and a folder of the campaign is needed here",
                written.value
            );
            return Err(Problem::error("record-in-store", says)
                .at(&written.span)
                .help("copy the records to the campaign's folder"));
        }
        if let Some(place) = place.get() {
            return Ok((place.clone(), &written.span));
        }
        let found = self.folder.place(&written.value, &written.span)?;
        Ok((place.get_or_init(|| found).clone(), &written.span))
    }

    fn found(&self, which: WhichRecord) -> Result<&RecordFolder, Problem> {
        let key = which.kind.key();
        self.folders_of(which.kind).nth(which.number).ok_or_else(|| {
            let says = format!("the campaign has no `{key}`: the folder of its records");
            Problem::error("key-missing", says).at(&self.tree.span.part(0..0))
        })
    }

    fn folders_of(&self, kind: RecordKind) -> impl Iterator<Item = &RecordFolder> {
        self.record_folders.iter().filter(move |folder| folder.kind == kind)
    }

    /// Every record of a section of one kind, one at least: that there is none is told when it is
    /// read.
    pub fn records(&self, kind: RecordKind) -> Vec<WhichRecord> {
        (0..self.folders_of(kind).count().max(1))
            .map(|number| WhichRecord { kind, number })
            .collect()
    }

    /// The name of a record, where there are several of its kind.
    pub fn record_name(&self, which: WhichRecord) -> Option<&Arc<str>> {
        self.folders_of(which.kind).nth(which.number)?.name.as_ref()
    }

    /// What the campaign calls a record, also if it is the only one of its kind.
    pub fn record_called(&self, which: WhichRecord) -> Option<&Arc<str>> {
        self.folders_of(which.kind).nth(which.number)?.called.as_ref()
    }

    /// `simulation`, and of several `simulation simpack`.
    pub fn record_in_words(&self, which: WhichRecord) -> String {
        let key = which.kind.key();
        self.record_name(which).map_or_else(|| key.to_string(), |name| format!("{key} {name}"))
    }

    /// As [`Self::only_one`], of simulation and measurement.
    pub fn one_of_each(&self) -> Result<(), Problem> {
        self.only_one(RecordKind::Simulation)?;
        self.only_one(RecordKind::Measurement)
    }

    /// # Errors
    /// `several-records`: who asks needs one record of a kind, and there are several.
    pub fn only_one(&self, kind: RecordKind) -> Result<(), Problem> {
        let folders: Vec<&RecordFolder> = self.folders_of(kind).collect();
        let at = self
            .tree
            .get(kind.key())
            .map_or_else(|| self.tree.span.part(0..0), |node| node.span.clone());
        if folders.len() > 1 { Err(members::several(kind, &folders, &at)) } else { Ok(()) }
    }

    /// Whether the campaign names a folder for records of a kind.
    pub fn has(&self, kind: RecordKind) -> bool {
        self.folders_of(kind).next().is_some() || self.runs.iter().any(|run| run.has(kind))
    }

    /// Where the record of a section is, the only one of its kind, which must exist.
    ///
    /// # Errors
    /// `several-records`; as [`Campaign::source_of`].
    pub fn record_source(&self, kind: RecordKind, section: &Cell) -> Result<RecordSource, Problem> {
        self.only_one(kind)?;
        self.source_of(kind.into(), section)
    }

    /// As [`Campaign::record_source`], of a record that must be a file.
    ///
    /// # Errors
    /// `record-in-memory`; as [`Campaign::record_source`].
    pub fn record_place(&self, kind: RecordKind, section: &Cell) -> Result<Place, Problem> {
        self.record_source(kind, section)?.file(&section.span)
    }

    /// As [`Campaign::source_of`], of a record that must be a file.
    ///
    /// # Errors
    /// `record-in-memory`; as [`Campaign::source_of`].
    pub fn place_of(&self, which: WhichRecord, section: &Cell) -> Result<Place, Problem> {
        self.source_of(which, section)?.file(&section.span)
    }

    /// Where a record of a section is, which must exist.
    ///
    /// # Errors
    /// `key-missing`, `folder-missing`, `path-outside`, `file-missing` (with the nearest name in
    /// that folder), `two-formats`; of an object as [`Campaign::run_source`].
    pub fn source_of(&self, which: WhichRecord, section: &Cell) -> Result<RecordSource, Problem> {
        check_file_name(&section.value, &section.span)?;
        if let Some(run) = self.run_of(section) {
            return self.run_source(run, which.kind);
        }
        let found = self.found(which)?;
        if found.in_store() {
            return found.object(&section.value).map(RecordSource::Object);
        }
        let (folder, span) = self.record_folder(which)?;
        let name = folder.below(&section.value);
        if let Some(frame) = self.folder.memory().records.get(&name) {
            return Ok(RecordSource::Memory(Arc::clone(frame)));
        }
        self.none_in_memory(&name, &section.span)?;
        let unreadable =
            |inside: &str, error: io::Error| unreadable(inside, &error).at(&section.span);
        let [csv, parquet] = Format::ALL.map(|format| {
            let place = self.folder.place(&format!("{name}.{}", format.ending()), &section.span)?;
            let there =
                disk::is_file(&place.path).map_err(|error| unreadable(&place.inside, error))?;
            Ok((place, there))
        });
        let place = match (csv?, parquet?) {
            ((place, true), (_, false)) | ((_, false), (place, true)) => {
                return Ok(RecordSource::File(place));
            }
            ((place, false), (_, false)) => place,
            ((csv, true), (parquet, true)) => {
                let says = format!(
                    "`{}` and `{}` are both the record of section {}",
                    csv.inside, parquet.inside, section.value
                );
                let problem = Problem::error("two-formats", says).at(&section.span);
                return Err(problem.help("remove one of them, or move it to another folder"));
            }
        };
        if !disk::is_folder(&folder.path).map_err(|error| unreadable(&folder.inside, error))? {
            let problem =
                Problem::error("folder-missing", format!("there is no folder `{}`", folder.inside))
                    .at(span);
            return Err(problem.suggest(
                &folder.inside,
                Self::folders_beside(&folder).iter().map(String::as_str),
            ));
        }
        let others = found.strangers.get_or_init(|| self.strangers(&folder.path));
        let in_other_format = |name: &String| {
            let same =
                Path::new(name).file_stem().and_then(|stem| stem.to_str()) == Some(&section.value);
            other_format(Path::new(name), &format!("{}/{name}", folder.inside)).filter(|_| same)
        };
        if let Some(problem) = others.iter().find_map(in_other_format) {
            return Err(problem.at(&section.span));
        }
        let problem = Problem::error(
            "file-missing",
            format!(
                "there is no file `{}` or `{}.{}`",
                place.inside,
                section.value,
                Format::Parquet.ending()
            ),
        )
        .at(&section.span);
        if others.len().saturating_mul(self.names.len()) > MOST_COMPARISONS {
            return Err(problem);
        }
        let near = |format: Format| {
            let name = format!("{}.{}", section.value, format.ending());
            crate::problem::nearest(&name, others.iter().map(String::as_str)).map(str::to_string)
        };
        match Format::ALL.into_iter().find_map(near) {
            Some(near) => Err(problem.help(format!("did you mean `{near}`?"))),
            None => Err(problem),
        }
    }

    /// # Errors
    /// `file-missing`: the campaign has no folder in which a record could be looked for.
    pub(super) fn none_in_memory(&self, name: &str, at: &Span) -> Result<(), Problem> {
        if self.folder.on_disk() {
            return Ok(());
        }
        let problem =
            Problem::error("file-missing", format!("there is no record `{name}` in memory")).at(at);
        Err(problem.suggest(name, self.folder.memory().records.keys().map(String::as_str)))
    }

    /// The folders beside one that does not exist, by their paths inside the campaign.
    fn folders_beside(missing: &Place) -> Vec<String> {
        let Some(beside) = missing.path.parent() else { return Vec::new() };
        let inside = missing
            .inside
            .rsplit_once('/')
            .map_or(String::new(), |(folder, _)| format!("{folder}/"));
        names_in(beside)
            .into_iter()
            .filter(|name| disk::is_folder(&beside.join(name)).unwrap_or(false))
            .map(|name| format!("{inside}{name}"))
            .collect()
    }

    /// Files of a folder but the records of sections: the record of another section is not what was
    /// meant.
    fn strangers(&self, folder: &Path) -> Vec<String> {
        let sections: HashSet<&str> = self.names.iter().map(|name| name.value.as_str()).collect();
        names_in(folder)
            .into_iter()
            .filter(|name| !Format::stem(name).is_some_and(|name| sections.contains(name)))
            .collect()
    }

    /// Reads the wanted columns of a section's record; of a section that is cut from a run, only
    /// this part of it. Its faults go into results, which must be the same wherever the campaign
    /// lies: they name the record by its path inside the campaign.
    ///
    /// # Errors
    /// As [`Campaign::source_of`] and [`RecordSource::read`].
    pub fn read(
        &self,
        which: WhichRecord,
        section: &Cell,
        wanted: &[Wanted],
        part: Option<&Part>,
    ) -> Result<(Record, ReadFile), Vec<Problem>> {
        let source = self.source_of(which, section)?;
        let offset = match which.kind {
            RecordKind::Measurement => self.offset(section)?,
            RecordKind::Simulation | RecordKind::Track => None,
        };
        let moved = offset.as_ref().map_or(0.0, |(_, offset)| *offset);
        let mut record = match part.zip(self.run_of(section)) {
            Some((part, run)) => {
                let range = part.from - moved..part.to - moved;
                source.stretch(wanted, &part.axis, range, run.known(which.kind))?
            }
            None => source.read(wanted)?,
        };
        if let Some((axis, offset)) = offset {
            let along = record.columns.iter_mut().find(|column| column.name == axis);
            along
                .into_iter()
                .flat_map(|column| &mut column.values)
                .for_each(|value| *value += offset);
        }
        let file = ReadFile {
            path: source.inside().to_string(),
            sha256: record.sha256.clone(),
            bytes: record.bytes as u64,
        };
        Ok((record, file))
    }
}

/// Synchronisation of both sides.
impl Campaign {
    /// What is added to the axis of a section's measurement: the axis and the offset in SI. `None`
    /// where the table has no column `offset` or the cell is empty.
    ///
    /// # Errors
    /// Of the column or the cell; an offset that is neither a length nor a time.
    pub fn offset(&self, section: &Cell) -> Result<Option<(&'static str, f64)>, Problem> {
        let Some((table, column)) =
            self.sections.as_ref().and_then(|table| Some((table, table.column(OFFSET)?)))
        else {
            return Ok(None);
        };
        let heading = &table.columns[column];
        let unit = heading.unit(None)?;
        let Some((axis, _)) = AXES.iter().find(|(_, dimension)| *dimension == unit.dimension)
        else {
            let says = format!(
                "the offset is in {unit}, which is {}; it is added to a distance or a time",
                unit.dimension.in_words()
            );
            return Err(Problem::error("unit-mismatch", says).at(&heading.span));
        };
        let Some(cell) = table
            .row_named(&section.value)
            .and_then(|row| table.cell(row, column))
            .filter(|cell| !cell.value.is_empty())
        else {
            return Ok(None);
        };
        match cell.value.parse::<f64>() {
            Ok(offset) if offset.is_finite() => Ok(Some((axis, unit.to_si(offset)))),
            _ => Err(Problem::error(
                "not-a-number",
                format!("`{OFFSET}`: `{}` is not a number", cell.value),
            )
            .at(&cell.span)),
        }
    }

    /// The sections with an offset: the name, the axis and the offset in SI.
    pub fn offsets(&self) -> impl Iterator<Item = (&str, &str, f64)> {
        self.names.iter().filter_map(|name| {
            let (axis, offset) =
                self.offset(name).ok().flatten().filter(|(_, offset)| *offset != 0.0)?;
            Some((name.value.as_str(), axis, offset))
        })
    }
}

/// The column of the section table with what is added to the axis of the measurement.
pub const OFFSET: &str = "offset";
/// The axes of records with their dimensions.
const AXES: [(&str, Dimension); 2] = [("distance", Dimension::LENGTH), ("time", Dimension::TIME)];

fn no_folder(error: &std::io::Error, shown: &str) -> Problem {
    match disk::missing(error) {
        true => Problem::error("folder-missing", format!("there is no folder `{shown}`")),
        false => Problem::error("folder-unreadable", format!("`{shown}` cannot be read: {error}")),
    }
}
