//! Runs of a campaign: one record of each kind over a long stretch, of which sections are parts.

use std::{path::Path, sync::Arc};

use super::{
    Campaign,
    members::RecordKind,
    opening::{Opening, Reader},
};
use crate::data::{
    cells::name_and_unit_text,
    folder::{check_file_name, names_in},
    prelude::*,
    record::{Format, Held, Known, RecordSource},
    table::{Cell, Table},
    text::unreadable,
};
use crate::store;
use crate::yaml::Words;

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
        "measurement" measurement (run_file): Option<Spanned<String>>,
        "simulation" simulation (run_file): Option<Spanned<String>>,
        "track" track (run_file): Option<Spanned<String>>,
        "drift" drift: OnDrift = OnDrift::Tell,
    }
}

/// The runs of a campaign by their names.
///
/// Problems: `wrong-kind`, `no-records`, `name-invalid`, `unknown-key`, `unknown-choice`,
/// `format-not-read`, and those of [`Folder::place`](crate::data::folder::Folder::place).
pub fn runs(reader: &mut Reader<'_, '_>, _: &Key, node: &Node) -> Option<Vec<Run>> {
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
            let problem = node.is_not(&format!("the run `{}`", name.value), "a map of its files");
            reader.tell(problem.help(EXAMPLE));
        } else {
            runs.extend(run(reader, name, (key, node), &held));
        }
    }
    Some(runs)
}

fn run(
    reader: &mut Reader<'_, '_>,
    name: Spanned<String>,
    (key, node): (&Key, &Node),
    held: &Held,
) -> Option<Run> {
    let before = reader.problems.errors();
    let written = Written::from_node(reader, key, node)?;
    let files = [written.measurement, written.simulation, written.track];
    let free = |(key, _): &&(Key, Node)| !Written::KEYS.contains(&key.text.as_str());
    let fact = |(key, node): &(Key, Node)| {
        let value = Spanned::from_node(reader, key, node)?;
        let (name, unit) = name_and_unit_text(&key.text);
        Some(RunFact { name, unit, value })
    };
    let facts = node.entries().iter().filter(free).filter_map(fact).collect();
    if files.iter().all(Option::is_none) && reader.problems.errors() == before {
        let problem = problem!("no-records", &node.span, "the run `{}` names no file", name.value);
        reader.tell(problem.help("name its files: `measurement`, `simulation`, `track`"));
    }
    let known = std::array::from_fn(|_| Known::with(held));
    let correct_drift = written.drift == OnDrift::Correct;
    (reader.problems.errors() == before).then_some(Run { name, files, known, facts, correct_drift })
}

/// A file of a run: inside the campaign, or an object in a store. Of an object only Parquet can be
/// read in parts.
fn run_file(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Spanned<String>> {
    let written: Spanned<String> = Spanned::from_node(reader, key, node)?;
    let Spanned { value, span } = &written;
    if !store::is_url(value) {
        let place = reader.with.folder.place(value, span);
        reader.keep(place)?;
    } else if Format::of(Path::new(value)) != Format::Parquet {
        let ending = Format::Parquet.ending();
        let problem = problem!(
            "format-not-read",
            span,
            "`{value}` is in a store and does not end in `.{ending}`"
        );
        reader.tell(problem.help("write it as Parquet, or copy it to the campaign's folder"));
        return None;
    }
    Some(written)
}

/// Every run that the table of sections names is there.
///
/// Problems: `unknown-run`, `no-runs`.
pub fn check_column(table: &Table, runs: &[Run], problems: &mut Problems) {
    let Some(column) = table.column(RUN_COLUMN).filter(|_| !runs.is_empty()) else { return };
    let names = || runs.iter().map(|run| run.name.value.as_str());
    for cell in table.rows.iter().filter_map(|row| row.get(column)) {
        let name = cell.value.trim();
        if !name.is_empty() && names().all(|known| known != name) {
            problems.push(
                problem!("unknown-run", &cell.span, "the campaign has no run `{name}`")
                    .suggest(name, names()),
            );
        }
    }
}

/// The part of a run that is read for a section: what the axis is called, and from where to where,
/// SI.
#[derive(Clone, Debug, PartialEq)]
pub struct RunStretch {
    pub axis: String,
    pub from: f64,
    pub to: f64,
}

impl RunStretch {
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
        let Some(Spanned { value: file, span }) = run.file(kind) else {
            return Err(problem!(
                "key-missing",
                &run.name.span,
                "the run `{}` has no `{}`",
                run.name.value,
                kind.key()
            ));
        };
        let known = run.known(kind);
        if store::is_url(file) {
            return known.stored(file, span).map(RecordSource::Object);
        }
        let place = match known.place.get() {
            Some(place) => place.clone(),
            None => self.folder.place(file, span)?,
        };
        let inside = &place.inside;
        if let Some(frame) = self.folder.memory().records.get(inside) {
            return Ok(RecordSource::Memory(Arc::clone(frame)));
        }
        self.none_in_memory(inside, span)?;
        let there = || disk::is_file(&place.path).map_err(unreadable(inside));
        if known.place.get().is_some() || there().map_err(|problem| problem.at(span))? {
            known.place.get_or_init(|| place.clone());
            return Ok(RecordSource::File(place));
        }
        let problem = problem!("file-missing", span, "there is no file `{inside}`");
        let others = place.path.parent().map(names_in).unwrap_or_default();
        let folder = file.rfind('/').map_or("", |at| &file[..=at]);
        Err(problem.suggest(file, others.into_iter().map(|name| format!("{folder}{name}"))))
    }

    /// The campaign with a table of sections that was not read from a file of it.
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
        Err(error("section-in-run", says, &self.runs_span())
            .help("`fishplate sections CAMPAIGN --cut FOLDER` writes a campaign with such files"))
    }

    /// The place of the runs in `campaign.yaml`.
    pub fn runs_span(&self) -> Span {
        self.tree.entry(RUNS).map_or_else(|| self.tree.start(), |(key, _)| key.span.clone())
    }
}
