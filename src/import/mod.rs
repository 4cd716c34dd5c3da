//! Imports records of other systems: from a mapping and its files to a campaign.
//!
//! | file | content |
//! |---|---|
//! | `mapping/` | the mapping: read, checked, compared with the needs of a protocol |
//! | `check` | the campaign before its records are read: what `certify` would refuse |
//! | `process/` | from a file to the record of a section |
//! | `runs`, `drift` | whole runs; the drift of the distance along them |
//! | `write` | the campaign, with an account of what was done |
//! | `draft/` | a mapping proposed from the files themselves |

#![allow(clippy::cast_precision_loss)]

pub mod check;
pub mod draft;
mod drift;
pub mod mapping;
pub mod process;
mod runs;
pub mod write;

use rayon::prelude::*;

use crate::data::RecordKind;
use crate::data::origin::ImportedRecord;
use crate::data::record::Format;
use crate::data::write::Outputs;
use crate::disk;
use crate::foreign::{self, File};
use crate::problem::{Problem, Problems};
use crate::run::needs::Needs;
use mapping::{Mapping, Side};
use process::{Made, Recording, record};
use write::{SourceFile, account, add_campaign, record_bytes};

/// Files that are read together: each worker holds one file and its records.
const AT_A_TIME: usize = 16;
/// Bytes of files that are read together, but for a file that is larger itself: two of the largest.
/// Their numbers and records take up to six times as much memory, on any number of cores.
const TOGETHER: u64 = 512 << 20;

/// What all records are made with.
#[derive(Clone, Copy)]
struct Import<'a> {
    mapping: &'a Mapping,
    needs: Option<&'a Needs>,
    format: Format,
    /// Called after each record.
    progress: &'a (dyn Fn(&str) + Sync),
}

/// What the records were made of. After a fault, nothing more is written; the rest is read for its
/// faults.
#[derive(Default)]
struct Imported {
    sources: Vec<SourceFile>,
    accounts: Vec<ImportedRecord>,
    faults: Problems,
    warnings: Problems,
}

impl Imported {
    /// Adds the record that was written last, and its file.
    fn add(&mut self, made: Made, source: &SourceFile, outputs: &Outputs) {
        self.accounts.push(account(&made, source, outputs));
        self.warnings.add(made.warnings);
        if !self.sources.contains(source) {
            self.sources.push(source.clone());
        }
    }
}

/// Reads all records and adds the campaign to the outputs; nothing is in place before these are
/// committed.
///
/// `progress` is called after each record.
///
/// # Errors
/// Those of the files and of [`record`], of all sections; of writing.
pub fn import(
    mapping: &Mapping,
    needs: Option<&Needs>,
    format: Format,
    outputs: &mut Outputs,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Problems, Problems> {
    let import = Import { mapping, needs, format, progress };
    let Imported { sources, mut accounts, faults, warnings } = match mapping.runs {
        Some(_) => runs::import(import, outputs)?,
        None => sections(import, outputs)?,
    };
    if faults.any_error() {
        return Err(few(faults));
    }
    // Both sides one after the other, in the order of the sections or runs.
    let names = &mapping.sections.names;
    accounts.sort_by_key(|account| {
        let number = names.iter().position(|name| name.value == account.section);
        (account.side != RecordKind::Measurement.key(), number)
    });
    add_campaign(outputs, mapping, format, &sources, accounts)?;
    Ok(few(warnings))
}

/// Sections that are read from one file.
struct Job<'a> {
    side: &'a Side,
    path: String,
    sections: Vec<&'a str>,
}

/// Makes the records of all sections.
fn sections(import: Import<'_>, outputs: &mut Outputs) -> Result<Imported, Problem> {
    let Import { mapping, format, .. } = import;
    let mut jobs: Vec<Job<'_>> = Vec::new();
    for side in &mapping.sides {
        for name in &mapping.sections.names {
            let path = mapping.sections.fill(&side.files.value, &name.value);
            match jobs.iter_mut().find(|job| job.side.kind == side.kind && job.path == path) {
                Some(job) => job.sections.push(&name.value),
                None => jobs.push(Job { side, path, sections: vec![&name.value] }),
            }
        }
    }
    let mut all = Imported::default();
    let mut rest = jobs.as_slice();
    while !rest.is_empty() {
        let (some, later) = rest.split_at(import.together(rest));
        rest = later;
        let done: Vec<_> = some.par_iter().map(|job| import.work(job)).collect();
        for job in done {
            let (source, records) = match job {
                Ok(done) => done,
                Err(problems) => {
                    all.faults.add(problems);
                    continue;
                }
            };
            for record in records {
                match record {
                    Ok((made, bytes)) if !all.faults.any_error() => {
                        let ending = format.ending();
                        let inside = mapping::record_path(made.kind, &made.section, ending);
                        outputs.add(&inside, &bytes)?;
                        all.add(made, &source, outputs);
                    }
                    Ok(_) => {}
                    Err(problems) => all.faults.add(problems),
                }
            }
        }
    }
    Ok(all)
}

/// A record without its columns, and its bytes.
type Written = (Made, Vec<u8>);

/// The record of a section, or why it cannot be imported.
type OfSection = Result<Written, Vec<Problem>>;

impl Import<'_> {
    /// Number of the first files that are read together.
    fn together(self, jobs: &[Job<'_>]) -> usize {
        // What cannot be looked at is told when it is read.
        let size = |job: &Job<'_>| {
            let place = self.mapping.paths.place(&job.path, &job.side.files.span).ok();
            place.and_then(|place| disk::size(&place.path).ok()).unwrap_or(0)
        };
        let mut bytes = 0;
        let fits = |job: &&Job<'_>| {
            bytes += size(job);
            bytes <= TOGETHER
        };
        jobs.iter().take(AT_A_TIME).take_while(fits).count().max(1)
    }

    /// The records of the sections in a file.
    fn work(self, job: &Job<'_>) -> Result<(SourceFile, Vec<OfSection>), Vec<Problem>> {
        let file = self.file(job.side, &job.path)?;
        let written = |section: &&str| -> OfSection {
            let made = self.record(job.side, section, &file, None)?;
            let bytes = record_bytes(&made.columns, self.format)?;
            Ok((Made { columns: Vec::new(), ..made }, bytes))
        };
        let records = job.sections.iter().map(|section| {
            let record = written(section);
            (self.progress)(section);
            record
        });
        let records = records.collect();
        Ok((SourceFile::new(&job.path, &file.0), records))
    }

    /// A file that the mapping names, and its name in messages. Problems of the file as a whole are
    /// shown where it is named.
    fn file(self, side: &Side, written: &str) -> Result<(File, String), Vec<Problem>> {
        let place = self.mapping.paths.place(written, &side.files.span)?;
        let read = foreign::read(&place.path, &place.shown, &side.format);
        let file = read.map_err(|problems| {
            problems.into_iter().map(|problem| problem.or_at(&side.files.span)).collect::<Vec<_>>()
        })?;
        Ok((file, place.shown))
    }

    /// The record of a section or run.
    fn record(
        self,
        side: &Side,
        section: &str,
        file: &(File, String),
        store: Option<&std::sync::Arc<process::Store>>,
    ) -> Result<Made, Vec<Problem>> {
        record(&Recording::new((self.mapping, side), self.needs, section, file, store)?)
    }
}

/// Most problems reported; the same fault is usually in every section.
const MOST_TOLD: usize = 20;

/// The same fault of several sections once, each with its place.
fn few(problems: Problems) -> Problems {
    let mut told = Problems::default();
    let mut more = 0;
    for problem in problems.0 {
        let place = |problem: &Problem| {
            problem.at.as_ref().map(|at| (at.source.name.clone(), at.start, at.end))
        };
        let same = |known: &Problem| {
            known.code == problem.code && known.at.is_some() && place(known) == place(&problem)
        };
        if told.0.len() >= MOST_TOLD || told.0.iter().any(same) {
            more += 1;
        } else {
            told.push(problem);
        }
    }
    if more > 0 {
        let says = format!("{more} more of other sections, most of the same kind");
        let kind = if told.any_error() { Problem::error } else { Problem::warning };
        told.push(kind("more-problems", says));
    }
    told
}
