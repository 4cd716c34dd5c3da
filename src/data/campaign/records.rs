//! Where the records of a campaign are: one folder or several of each kind, a file for each
//! section.

use std::{collections::HashSet, io, path::Path, sync::Arc};

use super::{
    Campaign,
    layout::Edited,
    members::{self, RecordFolder, RecordKind, WhichRecord},
    opening::{Changed, ReadFile},
    runs::RunStretch,
};
use crate::data::{
    folder::{check_file_name, names_in},
    place::CampaignPath,
    prelude::*,
    record::{Format, Record, RecordSource, Wanted},
    table::Cell,
    text::{other_format, unreadable},
};
use crate::problem::nearest;

/// Most comparisons of names with names that are made to suggest what was meant for missing records
/// of a campaign.
const MOST_COMPARISONS: usize = 1_000_000;

impl Campaign {
    /// The names of the measured records.
    pub(super) fn measured(&self) -> Result<Vec<Cell>, Problem> {
        let which = RecordKind::Measurement.into();
        let measured = self.found(which)?;
        if measured.in_store() {
            let says = "the measured records are in a store, which is not listed: the campaign must name its sections";
            let help = "add `sections: sections.csv`, a table with a row for each section";
            return Err(error("key-missing", says, &measured.folder.span).help(help));
        }
        let (place, span) = self.record_folder(which)?;
        let cells = |names: Vec<String>| {
            names.into_iter().map(|name| Spanned::new(name, span.clone())).collect()
        };
        let inside = format!("{}/", place.inside);
        let kept = self.folder.memory().records.keys();
        let kept = kept.filter_map(|name| Some(name.strip_prefix(&inside)?.to_string()));
        let names: Vec<String> = kept.collect();
        if !names.is_empty() {
            return Ok(cells(names));
        }
        self.none_in_memory(&inside, span)?;
        let entries = disk::names(&place.path).map_err(|why| {
            let problem = match disk::missing(&why) {
                true => no_folder(&place.shown, span),
                false => {
                    problem!("folder-unreadable", span, "`{}` cannot be read: {why}", place.shown)
                }
            };
            problem.suggest(&place.inside, folders_beside(&place))
        })?;
        let entries: Vec<String> =
            entries.into_iter().filter_map(|name| name.into_string().ok()).collect();
        let mut names: Vec<String> = entries
            .iter()
            .filter_map(|name| Format::stem(name))
            .filter(|name| !name.starts_with('.'))
            .map(str::to_string)
            .collect();
        if names.is_empty() {
            let other =
                |name: &String| other_format(Path::new(name), &format!("{}/{name}", place.inside));
            let problem = entries.iter().find_map(other);
            return Err(problem
                .unwrap_or_else(|| {
                    problem!("no-records", "there is no CSV or Parquet file in `{}`", place.shown)
                })
                .at(span));
        }
        names.sort();
        // Both formats of a section are told when it is read.
        names.dedup();
        Ok(cells(names))
    }

    /// Names of measured records that the table of sections does not name, as far as the records
    /// can be listed; of runs, which hold sections, none.
    pub fn outside_table(&self) -> Vec<String> {
        if self.sections.is_none() || !self.runs().is_empty() {
            return Vec::new();
        }
        let named: HashSet<&str> = self.names.iter().map(|cell| cell.value.as_str()).collect();
        let measured = self.measured().unwrap_or_default().into_iter().map(|cell| cell.value);
        measured.filter(|name| !named.contains(name.as_str())).collect()
    }

    pub(super) fn record_folder(
        &self,
        which: WhichRecord,
    ) -> Result<(CampaignPath, &Span), Problem> {
        let found = self.found(which)?;
        let RecordFolder { folder: Spanned { value: written, span }, place, .. } = found;
        if found.in_store() {
            return Err(problem!(
                "record-in-store",
                span,
                "`{written}` is in a store, and a folder of the campaign is needed here"
            )
            .help("copy the records to the campaign's folder"));
        }
        if let Some(place) = place.get() {
            return Ok((place.clone(), span));
        }
        let found = self.folder.place(written, span)?;
        Ok((place.get_or_init(|| found).clone(), span))
    }

    fn found(&self, which: WhichRecord) -> Result<&RecordFolder, Problem> {
        self.folder_of(which).ok_or_else(|| {
            let key = which.kind.key();
            problem!(
                "key-missing",
                &self.tree.start(),
                "the campaign has no `{key}`: the folder of its records"
            )
        })
    }

    fn folder_of(&self, which: WhichRecord) -> Option<&RecordFolder> {
        self.folders_of(which.kind).nth(which.number)
    }

    fn folders_of(&self, kind: RecordKind) -> impl Iterator<Item = &RecordFolder> {
        self.record_folders.iter().filter(move |folder| folder.kind == kind)
    }

    /// Every record of a section of one kind, one at least: that there is none is told when it is
    /// read.
    pub fn records(&self, kind: RecordKind) -> Vec<WhichRecord> {
        let count = self.folders_of(kind).count().max(1);
        (0..count).map(|number| WhichRecord { kind, number }).collect()
    }

    /// The name of a record, where there are several of its kind.
    pub fn record_name(&self, which: WhichRecord) -> Option<&Arc<str>> {
        self.folder_of(which)?.name.as_ref()
    }

    /// What the campaign calls a record, also if it is the only one of its kind.
    pub fn record_called(&self, which: WhichRecord) -> Option<&Arc<str>> {
        self.folder_of(which)?.called.as_ref()
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
        let at = self.tree.span_or_start(kind.key());
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
    pub fn record_place(&self, kind: RecordKind, section: &Cell) -> Result<CampaignPath, Problem> {
        self.record_source(kind, section)?.file(&section.span)
    }

    /// As [`Campaign::source_of`], of a record that must be a file.
    ///
    /// # Errors
    /// `record-in-memory`; as [`Campaign::source_of`].
    pub fn place_of(&self, which: WhichRecord, section: &Cell) -> Result<CampaignPath, Problem> {
        self.source_of(which, section)?.file(&section.span)
    }

    /// Where a record of a section is, which must exist.
    ///
    /// # Errors
    /// `key-missing`, `folder-missing`, `path-outside`, `file-missing` (with the nearest name in
    /// that folder), `two-formats`; of an object as [`Campaign::run_source`].
    pub fn source_of(&self, which: WhichRecord, section: &Cell) -> Result<RecordSource, Problem> {
        let Spanned { value: name, span } = section;
        check_file_name(name, span)?;
        if let Some(run) = self.run_of(section) {
            return self.run_source(run, which.kind);
        }
        let found = self.found(which)?;
        if found.in_store() {
            return found.object(name).map(RecordSource::Object);
        }
        let (folder, folder_span) = self.record_folder(which)?;
        let inside = folder.below(name);
        if let Some(frame) = self.folder.memory().records.get(&inside) {
            return Ok(RecordSource::Memory(Arc::clone(frame)));
        }
        self.none_in_memory(&inside, span)?;
        let told = |inside: &str, why: io::Error| unreadable(inside)(why).at(span);
        let [csv, parquet] = Format::ALL.map(|format| {
            let place = self.folder.place(&format.file(&inside), span)?;
            let there = disk::is_file(&place.path).map_err(|why| told(&place.inside, why))?;
            Ok::<_, Problem>((place, there))
        });
        let (csv, parquet) = (csv?, parquet?);
        let place = match (csv, parquet) {
            ((place, true), (_, false)) | ((_, false), (place, true)) => {
                return Ok(RecordSource::File(place));
            }
            ((place, false), (_, false)) => place,
            ((csv, true), (parquet, true)) => {
                let (csv, parquet) = (csv.inside, parquet.inside);
                let problem = problem!(
                    "two-formats",
                    span,
                    "`{csv}` and `{parquet}` are both the record of section {name}"
                );
                return Err(problem.help("remove one of them, or move it to another folder"));
            }
        };
        if !disk::is_folder(&folder.path).map_err(|why| told(&folder.inside, why))? {
            let problem = no_folder(&folder.inside, folder_span);
            return Err(problem.suggest(&folder.inside, folders_beside(&folder)));
        }
        let others = found.strangers.get_or_init(|| self.strangers(&folder.path));
        let in_other_format = |other: &String| {
            let path = Path::new(other);
            let same = path.file_stem().is_some_and(|stem| stem == name.as_str());
            other_format(path, &format!("{}/{other}", folder.inside)).filter(|_| same)
        };
        if let Some(problem) = others.iter().find_map(in_other_format) {
            return Err(problem.at(span));
        }
        let problem = problem!(
            "file-missing",
            span,
            "there is no file `{}` or `{}`",
            place.inside,
            Format::Parquet.file(name)
        );
        if others.len().saturating_mul(self.names.len()) > MOST_COMPARISONS {
            return Err(problem);
        }
        let near = |format: Format| nearest(&format.file(name), others.iter().map(String::as_str));
        let help =
            Format::ALL.into_iter().find_map(near).map(|near| format!("did you mean `{near}`?"));
        Err(problem.help_if(help))
    }

    /// # Errors
    /// `file-missing`: the campaign has no folder in which a record could be looked for.
    pub(super) fn none_in_memory(&self, name: &str, at: &Span) -> Result<(), Problem> {
        if self.folder.on_disk() {
            return Ok(());
        }
        let problem = problem!("file-missing", at, "there is no record `{name}` in memory");
        Err(problem.suggest(name, self.folder.memory().records.keys()))
    }

    /// Files of a folder but the records of sections: the record of another section is not what was
    /// meant.
    fn strangers(&self, folder: &Path) -> Vec<String> {
        let sections: HashSet<&str> = self.names.iter().map(|name| name.value.as_str()).collect();
        let mut names = names_in(folder);
        names.retain(|name| !Format::stem(name).is_some_and(|name| sections.contains(name)));
        names
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
        part: Option<&RunStretch>,
    ) -> Result<(Record, ReadFile), Vec<Problem>> {
        let source = self.source_of(which, section)?;
        let offset = self.offset_of(which.kind, section)?;
        let moved = offset.map_or(0.0, |(_, offset)| offset);
        let mut record = match part.zip(self.run_of(section)) {
            Some((part, run)) => {
                let range = part.from - moved..part.to - moved;
                source.stretch(wanted, &part.axis, range, run.known(which.kind))?
            }
            None => source.read(wanted)?,
        };
        if let Some((axis, offset)) = offset
            && let Some(along) = record.columns.iter_mut().find(|column| column.name == axis)
        {
            along.values.iter_mut().for_each(|value| *value += offset);
        }
        let (path, sha256) = (source.inside().to_string(), record.sha256.clone());
        let changed = match &source {
            RecordSource::File(_) => self.changed(which.kind, &path, &sha256),
            RecordSource::Object(_) | RecordSource::Memory(_) => None,
        };
        let file = ReadFile { path, sha256, bytes: record.bytes as u64, changed };
        Ok((record, file))
    }

    /// How a record differs from the one that an import wrote; `None` if it does not, or no import
    /// wrote records of its kind.
    pub fn changed(&self, kind: RecordKind, path: &str, sha256: &str) -> Option<Changed> {
        let mut written = self.origin.as_ref()?.imported_records(kind.key()).peekable();
        written.peek()?;
        let written = written.find(|record| record.path == path);
        // The format may have changed since.
        let same = |edited: &&Edited| Format::stem(&edited.record.value) == Format::stem(path);
        let reason = || self.edited.iter().find(same).map(|edited| edited.reason.clone());
        let changed = || Changed { imported: written.is_some(), reason: reason() };
        written.is_none_or(|record| record.sha256 != sha256).then(changed)
    }
}

/// Synchronisation of both sides.
impl Campaign {
    /// As [`Self::offset`], of the measurement; other records are not moved.
    pub(in crate::data) fn offset_of(
        &self,
        kind: RecordKind,
        section: &Cell,
    ) -> Result<Option<(&'static str, f64)>, Problem> {
        match kind {
            RecordKind::Measurement => self.offset(section),
            RecordKind::Simulation | RecordKind::Track => Ok(None),
        }
    }

    /// What is added to the axis of a section's measurement: the axis and the offset in SI. `None`
    /// where the table has no column `offset` or the cell is empty.
    ///
    /// # Errors
    /// Of the column or the cell; an offset that is neither a length nor a time.
    pub fn offset(&self, section: &Cell) -> Result<Option<(&'static str, f64)>, Problem> {
        let table = self.sections.as_ref();
        let Some((table, column)) = table.and_then(|table| Some((table, table.column(OFFSET)?)))
        else {
            return Ok(None);
        };
        let heading = &table.columns[column];
        let unit = heading.unit(None)?;
        let Some((axis, _)) = AXES.iter().find(|(_, dimension)| *dimension == unit.dimension)
        else {
            return Err(problem!(
                "unit-mismatch",
                &heading.span,
                "the offset is in {unit}, which is {}; it is added to a distance or a time",
                unit.dimension.in_words()
            ));
        };
        let cell = table.row_named(&section.value).and_then(|row| table.cell(row, column));
        let Some(Spanned { value, span }) = cell.filter(|cell| !cell.value.is_empty()) else {
            return Ok(None);
        };
        match value.parse::<f64>() {
            Ok(offset) if offset.is_finite() => Ok(Some((axis, unit.to_si(offset)))),
            _ => Err(problem!("not-a-number", span, "`{OFFSET}`: `{value}` is not a number")),
        }
    }

    /// The sections with an offset: the name, the axis and the offset in SI.
    pub fn offsets(&self) -> impl Iterator<Item = (&str, &str, f64)> {
        self.names.iter().filter_map(|name| {
            let offset = self.offset(name).ok().flatten();
            let (axis, offset) = offset.filter(|(_, offset)| *offset != 0.0)?;
            Some((name.value.as_str(), axis, offset))
        })
    }
}

/// The column of the section table with what is added to the axis of the measurement.
pub const OFFSET: &str = "offset";
/// The axes of records with their dimensions.
const AXES: [(&str, Dimension); 2] = [("distance", Dimension::LENGTH), ("time", Dimension::TIME)];

fn no_folder(inside: &str, at: &Span) -> Problem {
    problem!("folder-missing", at, "there is no folder `{inside}`")
}

/// The folders beside one that does not exist, by their paths inside the campaign.
fn folders_beside(missing: &CampaignPath) -> Vec<String> {
    let Some(beside) = missing.path.parent() else { return Vec::new() };
    let inside = missing.inside.rfind('/').map_or("", |at| &missing.inside[..=at]);
    let mut names = names_in(beside);
    names.retain(|name| disk::is_folder(&beside.join(name)).unwrap_or(false));
    names.into_iter().map(|name| format!("{inside}{name}")).collect()
}
