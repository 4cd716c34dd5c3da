//! Imports records of other systems: from a mapping and its files to a campaign.
//!
//! | file | content |
//! |---|---|
//! | `mapping/` | the mapping: read, checked, compared with the needs of a protocol |
//! | `check` | the campaign before its records are read: what `certify` would refuse |
//! | `process/` | from a file to the record of a section |
//! | `runs`, `drift` | whole runs; the drift of the distance along them |
//! | `write` | the campaign, with an account of what was done |
//! | `exchanged` | after the import: channels that agree better with another one |
//! | `draft/` | a mapping proposed from the files themselves |

#![allow(clippy::cast_precision_loss)]

pub mod check;
pub mod draft;
mod drift;
pub mod exchanged;
pub mod mapping;
pub mod process;
mod runs;
pub mod write;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::data::RecordKind;
use crate::data::origin::ImportedRecord;
use crate::data::record::Format;
use crate::data::write::Outputs;
use crate::foreign::{self, File};
use crate::problem::{Problem, Problems};
use crate::run::needs::Needs;
use mapping::{Mapping, Side};
use process::{Made, Of, record};
use write::{SourceFile, account, add_campaign, record_bytes};

/// Files that are read together: each worker holds one file and its records.
const AT_A_TIME: usize = 16;

/// Sections that are read from one file.
struct Job<'a> {
    side: &'a Side,
    path: String,
    sections: Vec<&'a str>,
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
    if mapping.runs.is_some() {
        let runs::Imported { sources, accounts, faults, warnings } =
            runs::import(mapping, needs, format, outputs, progress)?;
        if faults.any_error() {
            return Err(few(faults));
        }
        add_campaign(outputs, mapping, format, &sources, accounts)?;
        return Ok(few(warnings));
    }
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
    let (mut faults, mut warnings) = (Problems::default(), Problems::default());
    let mut sources: Vec<SourceFile> = Vec::new();
    let mut accounts: BTreeMap<(RecordKind, usize), ImportedRecord> = BTreeMap::new();
    for some in jobs.chunks(AT_A_TIME) {
        let done: Vec<Done> =
            some.par_iter().map(|job| work(job, mapping, needs, format, progress)).collect();
        for job in done {
            let Done { source, texts, problems } = job;
            faults.add(problems);
            let Some(source) = source else { continue };
            for (made, text) in texts {
                // After a fault nothing is written; the rest is read for its faults.
                if !faults.any_error() {
                    let inside = mapping::record_path(made.kind, &made.section, format.ending());
                    outputs.add(&inside, &text)?;
                }
                let number = mapping
                    .sections
                    .names
                    .iter()
                    .position(|name| name.value == made.section)
                    .unwrap_or(0);
                accounts.insert((made.kind, number), account(&made, &source));
                warnings.add(made.warnings);
            }
            if !sources.contains(&source) {
                sources.push(source);
            }
        }
    }
    if faults.any_error() {
        return Err(few(faults));
    }
    add_campaign(outputs, mapping, format, &sources, accounts.into_values().collect())?;
    Ok(few(warnings))
}

struct Done {
    source: Option<SourceFile>,
    texts: Vec<(Made, Vec<u8>)>,
    problems: Vec<Problem>,
}

fn work(
    job: &Job<'_>,
    mapping: &Mapping,
    needs: Option<&Needs>,
    format: Format,
    progress: &(dyn Fn(&str) + Sync),
) -> Done {
    let mut done = Done { source: None, texts: Vec::new(), problems: Vec::new() };
    let (file, shown) = match file_of_side(mapping, job.side, &job.path) {
        Ok(read) => read,
        Err(problems) => return Done { problems, ..done },
    };
    for section in &job.sections {
        let of =
            Of { mapping, side: job.side, needs, section, file: &file, store: None, shown: &shown };
        match record(&of) {
            Ok(made) => match record_bytes(&made.columns, format) {
                Ok(text) => done.texts.push((Made { columns: Vec::new(), ..made }, text)),
                Err(problem) => done.problems.push(problem),
            },
            Err(problems) => done.problems.extend(problems),
        }
        progress(section);
    }
    done.source = Some(SourceFile::new(&job.path, &file));
    done
}

/// A file that the mapping names, and its name in messages. Problems of the file as a whole are
/// shown where it is named.
fn file_of_side(
    mapping: &Mapping,
    side: &Side,
    written: &str,
) -> Result<(File, String), Vec<Problem>> {
    let (path, shown) = mapping.place(written);
    let placed = |problems: Vec<Problem>| {
        problems.into_iter().map(|problem| problem.or_at(&side.files.span)).collect::<Vec<_>>()
    };
    Ok((foreign::read(&path, &shown, &side.format).map_err(placed)?, shown))
}

/// Most problems reported; the same fault is usually in every section.
const MOST_TOLD: usize = 20;

/// The same fault of several sections once, each with its place.
fn few(problems: Problems) -> Problems {
    let mut told = Problems::default();
    let mut more = 0;
    for problem in problems.0 {
        let same = |known: &Problem| {
            let place = |problem: &Problem| {
                problem.at.as_ref().map(|at| (at.source.name.clone(), at.start, at.end))
            };
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
        let error = told.any_error();
        told.push(if error {
            Problem::error("more-problems", says)
        } else {
            Problem::warning("more-problems", says)
        });
    }
    told
}
