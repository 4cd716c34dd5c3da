//! Runs of a campaign: one record of each kind over a long stretch, of which sections are parts.

use std::path::Path;
use std::sync::Arc;

use super::opening::Opening;
use super::{Campaign, RecordKind};
use crate::data::cells::name_and_unit;
use crate::data::folder::{check_file_name, names_in};
use crate::data::record::{Format, Held, Known, RecordSource};
use crate::data::table::{Cell, Table};
use crate::data::text::unreadable;
use crate::disk;
use crate::problem::{Problem, Problems};
use crate::source::{Span, Spanned};
use crate::store;
use crate::yaml::{FromNode, Key, Node, Reader, Value, Words, fields};

/// The key of the runs in `campaign.yaml`.
pub const RUNS: &str = "runs";
/// The column of the table of sections that says from which run a section is cut.
pub const RUN_COLUMN: &str = "run";
/// What is done with a drift of the distance between both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnDrift {
    Correct,
    Tell,
}

impl Words for OnDrift {
    const CODE: &'static str = "unknown-choice";
    const WORDS: &'static [(&'static str, Self)] =
        &[("correct", Self::Correct), ("tell", Self::Tell)];
}

/// A run: a record of each kind, and what the campaign says of it.
#[derive(Clone, Debug)]
pub struct Run {
    pub name: Spanned<String>,
    /// In the order of [`RecordKind::ALL`].
    files: [Option<Spanned<String>>; 3],
    known: [Known; 3],
    pub facts: Vec<RunFact>,
    /// Whether the shift of the measurement along the run is corrected.
    pub correct_drift: bool,
}

/// What the campaign says of a run: data of every section in it.
#[derive(Clone, Debug)]
pub struct RunFact {
    /// Without the unit.
    pub name: String,
    /// What stands in brackets after the name.
    pub unit: Option<String>,
    pub value: Spanned<String>,
}

impl Run {
    pub fn fact(&self, name: &str) -> Option<&RunFact> {
        self.facts.iter().find(|fact| fact.name == name)
    }

    pub fn has(&self, kind: RecordKind) -> bool {
        self.file(kind).is_some()
    }

    /// What is known of a file, of which each section reads a stretch.
    pub fn known(&self, kind: RecordKind) -> &Known {
        &self.known[kind as usize]
    }

    fn file(&self, kind: RecordKind) -> Option<&Spanned<String>> {
        self.files[kind as usize].as_ref()
    }
}

fields! {
    /// A run as it is written; all other keys are facts.
    struct Written in Opening<'_>: "a run" or Free {
        "measurement" measurement: Option<RunFile>,
        "simulation" simulation: Option<RunFile>,
        "track" track: Option<RunFile>,
        "drift" drift: OnDrift = OnDrift::Tell,
    }
}

/// The runs of a campaign by their names.
///
/// Problems: `wrong-kind`, `no-records`, `name-invalid`, `unknown-key`, `unknown-choice`,
/// `format-not-read`, and those of [`Folder::place`](crate::data::folder::Folder::place).
#[derive(Clone, Debug, Default)]
pub(super) struct Runs(pub Vec<Run>);

impl FromNode<Opening<'_>> for Runs {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, _: &Key, node: &Node) -> Option<Self> {
        const EXAMPLE: &str = "for instance: `runs: {R1: {measurement: R1/measurement.parquet, simulation: R1/simulation.parquet}}`";
        if node.entries().is_empty() {
            let problem = node.is_not(&format!("`{RUNS}`"), "a map of names and runs");
            reader.tell(problem.help(EXAMPLE));
        }
        let held = Held::default();
        let mut runs = Vec::new();
        for (key, node) in node.entries() {
            let name = Spanned::new(key.text.trim().to_string(), key.span.clone());
            if let Err(problem) = check_file_name(&name.value, &name.span) {
                reader.tell(Problem { code: "name-invalid", ..problem });
            } else if !matches!(&node.value, Value::Map(_)) {
                let problem =
                    node.is_not(&format!("the run `{}`", name.value), "a map of its files");
                reader.tell(problem.help(EXAMPLE));
            } else {
                runs.extend(run(reader, name, key, node, &held));
            }
        }
        Some(Self(runs))
    }
}

fn run(
    reader: &mut Reader<'_, Opening<'_>>,
    name: Spanned<String>,
    key: &Key,
    node: &Node,
    held: &Held,
) -> Option<Run> {
    let before = reader.problems.errors();
    let written = Written::from_node(reader, key, node)?;
    let files = [written.measurement, written.simulation, written.track];
    let files = files.map(|file| file.map(|file| file.0));
    let mut facts = Vec::new();
    for (key, _) in
        node.entries().iter().filter(|(key, _)| !Written::KEYS.contains(&key.text.as_str()))
    {
        let Some(value) = reader.optional(node, &key.text) else { continue };
        let (name, unit) = name_and_unit(&key.text);
        let unit = unit.map(|range| key.text[range].trim().to_string());
        facts.push(RunFact { name: name.to_string(), unit, value });
    }
    if files.iter().all(Option::is_none) && reader.problems.errors() == before {
        let says = format!("the run `{}` names no file", name.value);
        let problem = Problem::error("no-records", says).at(&node.span);
        reader.tell(problem.help("name its files: `measurement`, `simulation`, `track`"));
    }
    let known = std::array::from_fn(|_| Known::with(held));
    let correct_drift = written.drift == OnDrift::Correct;
    (reader.problems.errors() == before).then_some(Run { name, files, known, facts, correct_drift })
}

/// A file of a run: inside the campaign, or an object in a store. Of an object only Parquet can be
/// read in parts.
#[derive(Clone, Debug)]
struct RunFile(Spanned<String>);

impl FromNode<Opening<'_>> for RunFile {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        let written: Spanned<String> = Spanned::from_node(reader, key, node)?;
        if !store::is_url(&written.value) {
            let place = reader.with.folder.place(&written.value, &written.span);
            reader.keep(place)?;
        } else if Format::of(Path::new(&written.value)) != Format::Parquet {
            let says = format!(
                "`{}` is in a store and does not end in `.{}`",
                written.value,
                Format::Parquet.ending()
            );
            let problem = Problem::error("format-not-read", says).at(&written.span);
            reader.tell(problem.help("write it as Parquet, or copy it to the campaign's folder"));
            return None;
        }
        Some(Self(written))
    }
}

/// Every run that the table of sections names is there.
///
/// Problems: `unknown-run`, `no-runs`.
pub(super) fn check_column(table: &Table, runs: &[Run], problems: &mut Problems) {
    let Some(column) = table.column(RUN_COLUMN).filter(|_| !runs.is_empty()) else { return };
    for row in 0..table.rows.len() {
        let Some(cell) = table.cell(row, column).filter(|cell| !cell.value.trim().is_empty())
        else {
            continue;
        };
        let names = || runs.iter().map(|run| run.name.value.as_str());
        if !names().any(|name| name == cell.value.trim()) {
            let says = format!("the campaign has no run `{}`", cell.value.trim());
            problems.push(
                Problem::error("unknown-run", says)
                    .at(&cell.span)
                    .suggest(cell.value.trim(), names()),
            );
        }
    }
}

/// The part of a run that is read for a section: what the axis is called, and from where to where,
/// SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    pub axis: String,
    pub from: f64,
    pub to: f64,
}

impl Part {
    /// How much of a run is read on each side of a section, in lengths of the section, if there is
    /// so much: a section of 70 m at 70 km/h then has 7 s on each side, in which filters from 0.4
    /// Hz on settle.
    const BESIDE: f64 = 2.0;

    /// A section with what is read beside it, for filters and for shifts; more if a larger margin
    /// is asked for.
    pub fn around(axis: &str, (start, end): (f64, f64), margin: Option<f64>) -> Self {
        let margin = margin.unwrap_or(0.0).max(Self::BESIDE * (end - start));
        Self { axis: axis.to_string(), from: start - margin, to: end + margin }
    }
}

impl Campaign {
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// The run that a section is part of; without a table of sections, the run of this name as a
    /// whole.
    pub fn run_of(&self, section: &Cell) -> Option<&Run> {
        if self.runs.is_empty() {
            return None;
        }
        let name = match &self.sections {
            None => section.value.as_str(),
            Some(table) => table
                .cell(table.row_named(&section.value)?, table.column(RUN_COLUMN)?)?
                .value
                .trim(),
        };
        self.runs.iter().find(|run| run.name.value == name)
    }

    /// The record of a run, which must exist.
    ///
    /// # Errors
    /// `key-missing`, `path-outside`, `file-missing`; of an object `url-invalid`,
    /// `store-not-allowed`, `store-not-built`, `file-unreadable`.
    pub fn run_source(&self, run: &Run, kind: RecordKind) -> Result<RecordSource, Problem> {
        let Some(file) = run.file(kind) else {
            let says = format!("the run `{}` has no `{}`", run.name.value, kind.key());
            return Err(Problem::error("key-missing", says).at(&run.name.span));
        };
        if store::is_url(&file.value) {
            return run.known(kind).stored(&file.value, &file.span).map(RecordSource::Object);
        }
        let known = run.known(kind);
        let place = known.place().map_or_else(
            || self.folder.place(&file.value, &file.span),
            |place| Ok(place.clone()),
        )?;
        if let Some(frame) = self.folder.memory().records.get(&place.inside) {
            return Ok(RecordSource::Memory(Arc::clone(frame)));
        }
        self.none_in_memory(&place.inside, &file.span)?;
        let unreadable = |error| unreadable(&place.inside, &error).at(&file.span);
        if known.place().is_some() || disk::is_file(&place.path).map_err(unreadable)? {
            known.found(&place);
            return Ok(RecordSource::File(place));
        }
        let problem =
            Problem::error("file-missing", format!("there is no file `{}`", place.inside))
                .at(&file.span);
        let others = place.path.parent().map(names_in).unwrap_or_default();
        let folder =
            file.value.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let others: Vec<String> =
            others.into_iter().map(|name| format!("{folder}{name}")).collect();
        Err(problem.suggest(&file.value, others.iter().map(String::as_str)))
    }

    /// The campaign with a table of sections that was not read from a file of it.
    #[must_use]
    pub fn with_sections(&self, table: Table) -> Self {
        let names = table.names().cloned().collect();
        Self { sections: Some(table), names, ..self.clone() }
    }

    /// # Errors
    /// `section-in-run`: who asks needs a file for each section, and the sections are parts of
    /// runs.
    pub fn file_for_each_section(&self) -> Result<(), Problem> {
        if self.runs.is_empty() {
            return Ok(());
        }
        let says = "the sections of this campaign are parts of runs, and a file for each section is needed here";
        Err(Problem::error("section-in-run", says)
            .at(&self.runs_span())
            .help("`fishplate sections CAMPAIGN --cut FOLDER` writes a campaign with such files"))
    }

    /// The place of the runs in `campaign.yaml`.
    pub fn runs_span(&self) -> Span {
        self.tree.entry(RUNS).map_or_else(|| self.tree.span.part(0..0), |(key, _)| key.span.clone())
    }

    /// The names of the runs, for a protocol that evaluates whole records.
    pub(super) fn run_names(&self) -> Vec<Cell> {
        self.runs.iter().map(|run| run.name.clone()).collect()
    }
}
