//! Import of whole runs: both records of a run are made together, since a drift between them
//! concerns both.

use super::mapping::{self, Side};
use super::process::{Made, Store};
use super::write::{SourceFile, write_record};
use super::{Import, Imported, drift};
use crate::data::RecordKind;
use crate::data::write::Outputs;
use crate::problem::{Problem, error};

/// Makes the records of all runs. One file is in memory at a time; what is made of it waits in a
/// file without a name.
///
/// # Errors
/// `write-failed`. Faults of the records are in [`Imported::faults`].
pub fn import(import: Import<'_>, outputs: &mut Outputs) -> Result<Imported, Problem> {
    let Import { mapping, format, .. } = import;
    let mut all = Imported::default();
    for name in &mapping.sections.names {
        let run = &name.value;
        let store = Store::new(outputs.scratch_file()?);
        let of_side = |side: &Side| -> Result<(Made, SourceFile), Vec<Problem>> {
            let written = mapping.sections.fill(&side.files.value, run);
            let file = import.file(side, &written)?;
            let made = import.record(side, run, &file, Some(&store))?;
            Ok((made, SourceFile::new(&written, &file.0)))
        };
        let mut made: Vec<(Made, SourceFile)> = Vec::new();
        let kinds = [RecordKind::Measurement, RecordKind::Simulation];
        for side in kinds.into_iter().filter_map(|kind| mapping.side(kind)) {
            match of_side(side) {
                Ok(one) => made.push(one),
                Err(problems) => all.faults.add(problems),
            }
            (import.progress)(run);
        }
        if all.faults.any_error() {
            continue;
        }
        let asked = mapping.side(RecordKind::Measurement).and_then(|side| side.drift.as_ref());
        if let (Some(asked), [(measured, _), rest @ ..]) = (asked, &mut made[..]) {
            let done = match rest {
                [(simulated, _)] => drift::drift(asked, measured, simulated),
                _ => {
                    let says = "a drift is one against the simulation, which is not imported";
                    Err(error("no-drift", says, &asked.span)
                        .help("import both sides, or remove `drift`"))
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
            all.add(made, &source, outputs);
        }
    }
    Ok(all)
}
