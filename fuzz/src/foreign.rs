//! Files of other systems, and mappings.

use std::path::Path;

use fishplate::foreign::{self, File, Format, Options};
use fishplate::import::mapping::{self, Paths};
use fishplate::problem::Problems;
use fishplate::source::Source;

use super::promise;
use super::records::{folder, write};

/// A text of any dialect. The channels of a table have as many values as it has rows, and no value
/// is infinite.
pub fn foreign(input: &[u8]) {
    let path = folder().join("foreign.txt");
    write(&path, input);
    for form in [None, Some(Format::Csv), Some(Format::Ascii)] {
        if let Some(file) = read(&path, "foreign.txt", form) {
            for channel in file.tables.iter().flat_map(|table| &table.channels) {
                assert!(
                    channel.values.iter().all(|value| !value.is_infinite()),
                    "{}",
                    channel.name
                );
            }
        }
    }
}

pub fn mdf4(input: &[u8]) {
    binary("x.mf4", input);
}

pub fn mat(input: &[u8]) {
    binary("x.mat", input);
}

pub fn xlsx(input: &[u8]) {
    binary("x.xlsx", input);
}

pub fn tdms(input: &[u8]) {
    binary("x.tdms", input);
}

/// Parquet and Arrow files of other systems.
pub fn columnar(input: &[u8]) {
    binary("x.parquet", input);
}

/// A file of a binary format. Its channels have as many values as their table has rows, and not
/// more than the file may unpack to. The outline names the same channels.
fn binary(name: &str, input: &[u8]) {
    let path = folder().join(name);
    write(&path, input);
    let Some(file) = read(&path, name, None) else { return };
    let values: usize = file
        .tables
        .iter()
        .flat_map(|table| &table.channels)
        .map(|channel| channel.values.len())
        .sum();
    assert!(values <= input.len() * 100 + (64 << 20), "{values} values");
    let Ok(outline) = foreign::outline(&path, name, &Options::default()) else {
        panic!("there is no outline")
    };
    let names = |file: &File| -> Vec<Vec<String>> {
        file.tables
            .iter()
            .map(|table| table.channels.iter().map(|channel| channel.name.clone()).collect())
            .collect()
    };
    assert_eq!(names(&outline), names(&file));
}

fn read(path: &Path, name: &str, form: Option<Format>) -> Option<File> {
    match foreign::read(path, name, &Options { form, ..Options::default() }) {
        Ok(file) => {
            for table in &file.tables {
                assert!(
                    table.channels.iter().all(|channel| channel.values.len() == table.rows),
                    "{}",
                    table.name
                );
            }
            Some(file)
        }
        Err(problems) => {
            assert!(!problems.is_empty(), "refused without a word");
            promise::told(&problems);
            None
        }
    }
}

/// A mapping. It is read and checked; no record is opened.
pub fn mapping(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let mut problems = Problems::default();
    let paths = Paths::inside(&folder()).expect("a folder");
    let read = mapping::read(&Source::new("mapping.yaml", text), paths, &mut problems);
    promise::told(&problems.0);
    assert!(read.is_some() || problems.any_error(), "refused without a word");
}
