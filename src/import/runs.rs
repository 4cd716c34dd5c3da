//! Import of whole runs: both records of a run are made together, since a drift between them
//! concerns both.

use std::sync::Arc;

use super::mapping::{self, Mapping};
use super::process::{Made, Of, Store, record};
use super::write::{SourceFile, account, write_record};
use super::{drift, file_of_side};
use crate::data::RecordKind;
use crate::data::origin::ImportedRecord;
use crate::data::record::Format;
use crate::data::write::Outputs;
use crate::problem::{Problem, Problems};
use crate::run::needs::Needs;

/// What the import of all records gives.
#[derive(Default)]
pub struct Imported {
    pub sources: Vec<SourceFile>,
    /// Both sides one after the other, in the order of the runs.
    pub accounts: Vec<ImportedRecord>,
    pub faults: Problems,
    pub warnings: Problems,
}

/// Makes the records of all runs. One file is in memory at a time; what is made of it waits in a
/// file without a name.
///
/// # Errors
/// `write-failed`. Faults of the records are in [`Imported::faults`]; after one, nothing more is
/// written.
pub fn import(
    mapping: &Mapping,
    needs: Option<&Needs>,
    format: Format,
    outputs: &mut Outputs,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Imported, Problem> {
    let mut all = Imported::default();
    for name in &mapping.sections.names {
        let store = Store::new(outputs.scratch_file()?);
        let mut made: Vec<(Made, SourceFile)> = Vec::new();
        for side in [RecordKind::Measurement, RecordKind::Simulation]
            .into_iter()
            .filter_map(|kind| mapping.side(kind))
        {
            match of_side(mapping, side, needs, &name.value, &store) {
                Ok(one) => made.push(one),
                Err(problems) => all.faults.add(problems),
            }
            progress(&name.value);
        }
        if all.faults.any_error() {
            continue;
        }
        let asked = mapping.side(RecordKind::Measurement).and_then(|side| side.drift.as_ref());
        if let (Some(asked), [(measured, _), rest @ ..]) = (asked, &mut made[..]) {
            let done = match rest {
                [(simulated, _)] => drift::drift(asked, measured, simulated),
                _ => {
                    let problem = Problem::error(
                        "no-drift",
                        "a drift is one against the simulation, which is not imported",
                    );
                    Err(problem.at(&asked.span).help("import both sides, or remove `drift`"))
                }
            };
            if let Err(problem) = done {
                all.faults.push(problem);
                continue;
            }
        }
        for (made, source) in made {
            let inside = mapping::record_path(made.kind, &made.section, format.ending());
            outputs.add_in_parts(&inside, |sink| {
                write_record(&made.columns, format, Some(&store), sink)
            })?;
            all.accounts.push(account(&made, &source));
            all.warnings.add(made.warnings);
            if !all.sources.contains(&source) {
                all.sources.push(source);
            }
        }
    }
    all.accounts.sort_by_key(|account| account.side != RecordKind::Measurement.key());
    Ok(all)
}

fn of_side(
    mapping: &Mapping,
    side: &mapping::Side,
    needs: Option<&Needs>,
    run: &str,
    store: &Arc<Store>,
) -> Result<(Made, SourceFile), Vec<Problem>> {
    let written = mapping.sections.fill(&side.files.value, run);
    let (file, shown) = file_of_side(mapping, side, &written)?;
    let made = record(&Of {
        mapping,
        side,
        needs,
        section: run,
        file: &file,
        store: Some(store),
        shown: &shown,
    })?;
    Ok((made, SourceFile::new(&written, &file)))
}
