//! Files on which the records of a program depend.

use std::path::{Path, PathBuf};

use super::{cache::Key, read::Program, words::Word};
use crate::data::Campaign;
use crate::disk;
use crate::problem::Problem;
use crate::source::Spanned;

/// Path of the vehicle file, if the campaign names one.
pub fn vehicle_file(campaign: &Campaign) -> Result<Option<PathBuf>, Problem> {
    let Some(node) = campaign.tree.get("vehicle") else { return Ok(None) };
    let written =
        Spanned::new(node.scalar_text().unwrap_or_default().to_string(), node.span.clone());
    Ok(Some(absolute(&campaign.place(&written)?.path)))
}

/// Hash of the common inputs of all records of a program: its description, the files named in the
/// command and the description, the vehicle file and the files that it names.
pub fn basis(
    campaign: &Campaign,
    program: &Program,
    vehicle: Option<&Path>,
) -> Result<Key, Problem> {
    let mut key = Key::default();
    key.add("simulator", &program.source.text);
    for file in program
        .command
        .iter()
        .filter_map(Word::plain)
        .map(|word| program.folder.join(word))
        .filter(|path| disk::may_be_file(path))
    {
        key.add_file("program", &file)?;
    }
    if let Some(python) = &program.python {
        key.add_file("function", &python.file)?;
    }
    for file in &program.inputs {
        key.add_file("input", file)?;
    }
    if let Some(vehicle) = vehicle {
        key.add_file("vehicle", vehicle)?;
        for place in campaign.vehicle_files()? {
            key.add("file", &place.inside);
            key.add_file("content", &place.path)?;
        }
    }
    Ok(key)
}

pub fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}
