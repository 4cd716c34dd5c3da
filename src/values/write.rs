//! The bytes of a file of values: a Parquet table, with all else in the metadata of the file.

use std::error::Error;

use parquet::{arrow::ArrowWriter, file::metadata::KeyValue};
use serde_json::json;

use super::{FORM, Values, rows::table, seal};
use crate::check::plan::Plan;
use crate::data::write::properties;
use crate::problem::{Problem, problem};

/// Keys of the metadata. What the file is, as JSON; the other contents are packed.
pub const ABOUT: &str = "fishplate.values";
pub const HEAD: &str = "fishplate.head";
pub const SECTIONS: &str = "fishplate.sections";
pub const MARKS: &str = "fishplate.marks";
pub const TRACES: &str = "fishplate.traces";
const SEAL: &str = "fishplate.seal";

/// The bytes of a file. The same values give the same bytes.
///
/// # Errors
/// `write-failed`.
pub fn write(plan: &Plan, values: &Values) -> Result<Vec<u8>, Problem> {
    let written = || -> Result<Vec<u8>, Box<dyn Error>> {
        let table = table(plan, values)?;
        let mut bytes = Vec::new();
        let mut writer = ArrowWriter::try_new(
            &mut bytes,
            table.schema(),
            Some(properties()?.set_created_by("fishplate".into()).build()),
        )?;
        writer.write(&table)?;
        for (key, value) in metadata(values)? {
            writer.append_key_value_metadata(KeyValue::new(key.to_string(), value));
        }
        writer.close()?;
        seal::close(&mut bytes);
        Ok(bytes)
    };
    written()
        .map_err(|error| problem!("write-failed", "values cannot be written as Parquet: {error}"))
}

/// The seal is the last.
fn metadata(values: &Values) -> serde_json::Result<[(&'static str, String); 6]> {
    let first = values.head.rules.files.first();
    let names: Vec<&str> = values.head.about.names().collect();
    let about = json!({
        "form": FORM,
        "program": values.program,
        "protocol": first.map(|(name, _)| name),
        "campaigns": names,
        "shard": format!("{}/{}", values.shard.number, values.shard.of),
        "sections": values.sections.len(),
        "of": values.head.basis.units().len(),
    });
    let mut marks: Vec<u8> = Vec::new();
    for print in values.sections.iter().flat_map(|(_, of_section)| &of_section.prints) {
        marks.extend((print.marks.len() as u32).to_le_bytes());
        print.marks.iter().for_each(|mark| marks.extend(mark.to_le_bytes()));
    }
    Ok([
        (ABOUT, about.to_string()),
        (HEAD, seal::packed(&serde_json::to_vec(&values.head)?)),
        (SECTIONS, seal::packed(&serde_json::to_vec(&values.sections)?)),
        // Hashes do not become shorter.
        (MARKS, seal::stored(&marks)),
        (TRACES, seal::packed(&serde_json::to_vec(&values.traces)?)),
        (SEAL, seal::blank()),
    ])
}
