//! Runs of a campaign: one record of each kind over a long stretch, of which sections are parts.

use std::path::Path;
use std::sync::Arc;

use super::{Campaign, RecordKind};
use crate::data::cells::name_and_unit;
use crate::data::folder::Folder;
use crate::data::record::{Format, Held, Known, RecordSource};
use crate::data::table::{Cell, Table};
use crate::disk;
use crate::problem::{Problem, Problems};
use crate::source::{Span, Spanned};
use crate::store;
use crate::yaml::{Node, Value};

/// The key of the runs in `campaign.yaml`.
pub const RUNS: &str = "runs";
/// The column of the table of sections that says from which run a section is cut.
pub const RUN_COLUMN: &str = "run";
/// The key of a run that says what is done with a drift of the distance between both sides, and its
/// words.
const DRIFT: &str = "drift";
pub const CORRECT: &str = "correct";
pub const TELL: &str = "tell";

/// A run: a record of each kind, and what the campaign says of it.
#[derive(Clone, Debug)]
pub struct Run {
    pub name: Spanned<String>,
    files: Vec<(RecordKind, Spanned<String>)>,
    /// Of each file, in the order of [`RecordKind::ALL`].
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
        match kind {
            RecordKind::Measurement => &self.known[0],
            RecordKind::Simulation => &self.known[1],
            RecordKind::Track => &self.known[2],
        }
    }

    fn file(&self, kind: RecordKind) -> Option<&Spanned<String>> {
        self.files.iter().find(|(of, _)| *of == kind).map(|(_, file)| file)
    }
}

/// Reads the runs of a campaign.
///
/// Problems: `wrong-kind`, `no-records`, `name-invalid`, `unknown-key`, `unknown-choice`,
/// `format-not-read`, and those of [`Folder::place`].
pub(super) fn read(tree: &Node, folder: &Folder, problems: &mut Problems) -> Vec<Run> {
    const EXAMPLE: &str = "for instance: `runs: {R1: {measurement: R1/measurement.parquet, simulation: R1/simulation.parquet}}`";
    let Some(node) = tree.get(RUNS) else { return Vec::new() };
    if !matches!(&node.value, Value::Map(runs) if !runs.is_empty()) {
        let says =
            format!("`{RUNS}` must be a map of names and runs; this is {}", node.kind_in_words());
        problems.push(Problem::error("wrong-kind", says).at(&node.span).help(EXAMPLE));
        return Vec::new();
    }
    let (mut runs, held) = (Vec::new(), Held::default());
    for (key, node) in node.entries() {
        let name = Spanned::new(key.text.trim().to_string(), key.span.clone());
        if let Err(problem) = crate::data::folder::check_file_name(&name.value, &name.span) {
            problems.push(Problem { code: "name-invalid", ..problem });
            continue;
        }
        if !matches!(&node.value, Value::Map(_)) {
            let says = format!(
                "the run `{}` must be a map of its files; this is {}",
                name.value,
                node.kind_in_words()
            );
            problems.push(Problem::error("wrong-kind", says).at(&node.span).help(EXAMPLE));
            continue;
        }
        if let Some(run) = one(name, node, (folder, &held), problems) {
            runs.push(run);
        }
    }
    runs
}

fn one(
    name: Spanned<String>,
    node: &Node,
    (folder, held): (&Folder, &Held),
    problems: &mut Problems,
) -> Option<Run> {
    let before = problems.errors();
    let known = std::array::from_fn(|_| Known::with(held));
    let mut run = Run { name, files: Vec::new(), facts: Vec::new(), known, correct_drift: false };
    for (key, value) in node.entries() {
        let Some(text) = value.scalar_text().map(str::trim).filter(|text| !text.is_empty()) else {
            let says = format!(
                "`{}` of a run must be a single value; this is {}",
                key.text,
                value.kind_in_words()
            );
            problems.push(Problem::error("wrong-kind", says).at(&value.span));
            continue;
        };
        let written = Spanned::new(text.to_string(), value.span.clone());
        let known = || RecordKind::ALL.into_iter().map(RecordKind::key).chain([DRIFT]);
        if let Some(kind) = RecordKind::ALL.into_iter().find(|kind| kind.key() == key.text) {
            match check_file(&written, folder) {
                Ok(()) => run.files.push((kind, written)),
                Err(problem) => problems.push(problem),
            }
        } else if key.text == DRIFT {
            match text {
                CORRECT => run.correct_drift = true,
                TELL => {}
                other => {
                    let says = format!("`{DRIFT}` cannot be `{other}`");
                    problems.push(
                        Problem::error("unknown-choice", says)
                            .at(&value.span)
                            .suggest(other, [CORRECT, TELL]),
                    );
                }
            }
        } else if let Some(near) =
            known().find(|known| strsim::damerau_levenshtein(&key.text.to_lowercase(), known) <= 1)
        {
            let problem = Problem::error("unknown-key", format!("a run has no key `{}`", key.text))
                .at(&key.span);
            problems.push(problem.help(format!("did you mean `{near}`?")));
        } else {
            let (name, unit) = name_and_unit(&key.text);
            let unit = unit.map(|range| key.text[range].trim().to_string());
            run.facts.push(RunFact { name: name.to_string(), unit, value: written });
        }
    }
    if run.files.is_empty() && problems.errors() == before {
        let says = format!("the run `{}` names no file", run.name.value);
        problems.push(
            Problem::error("no-records", says)
                .at(&node.span)
                .help("name its files: `measurement`, `simulation`, `track`"),
        );
    }
    (problems.errors() == before).then_some(run)
}

/// A file of a run is inside the campaign, or an object in a store. Of an object only Parquet can
/// be read in parts.
fn check_file(written: &Spanned<String>, folder: &Folder) -> Result<(), Problem> {
    if !store::is_url(&written.value) {
        return folder.place(&written.value, &written.span).map(|_| ());
    }
    if Format::of(Path::new(&written.value)) == Format::Parquet {
        return Ok(());
    }
    let says = format!(
        "`{}` is in a store and does not end in `.{}`",
        written.value,
        Format::Parquet.ending()
    );
    Err(Problem::error("format-not-read", says)
        .at(&written.span)
        .help("write it as Parquet, or copy it to the campaign's folder"))
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
        let unreadable = |error| {
            Problem::error("file-unreadable", format!("`{}` cannot be read: {error}", place.inside))
                .at(&file.span)
        };
        if known.place().is_some() || disk::is_file(&place.path).map_err(unreadable)? {
            known.found(&place);
            return Ok(RecordSource::File(place));
        }
        let problem =
            Problem::error("file-missing", format!("there is no file `{}`", place.inside))
                .at(&file.span);
        let others =
            place.path.parent().and_then(|folder| disk::names(folder).ok()).unwrap_or_default();
        let folder =
            file.value.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let others: Vec<String> = others
            .into_iter()
            .filter_map(|name| Some(format!("{folder}{}", name.to_str()?)))
            .collect();
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
