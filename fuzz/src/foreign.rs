//! Texts of other systems, and mappings.

use fishplate::foreign::{self, Format, Options};
use fishplate::import::mapping;
use fishplate::problem::Problems;
use fishplate::source::Source;

use super::promise;
use super::records::{folder, write};

/// A text of any dialect. The channels of a table have as many values as it has rows, no value is infinite, and the
/// outline names the same channels. The binary formats are read by other crates, behind a guard that catches what they do
/// with bad input; `tests/foreign` tries them.
pub fn foreign(input: &[u8]) {
    let path = folder().join("foreign.txt");
    write(&path, input);
    for form in [None, Some(Format::Csv), Some(Format::Ascii)] {
        let options = Options { form, ..Options::default() };
        let file = match foreign::read(&path, "foreign.txt", &options) {
            Ok(file) => file,
            Err(problems) => {
                assert!(!problems.is_empty(), "refused without a word");
                promise::told(&problems);
                continue;
            }
        };
        for channel in file.tables.iter().flat_map(|table| &table.channels) {
            assert!(channel.values.iter().all(|value| !value.is_infinite()), "{}", channel.name);
        }
        for table in &file.tables {
            assert!(table.channels.iter().all(|channel| channel.values.len() == table.rows), "{}", table.name);
        }
    }
}

/// A mapping. It is read and checked; no record is opened.
pub fn mapping(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let mut problems = Problems::default();
    let read = mapping::read(&Source::new("mapping.yaml", text), &folder(), &mut problems);
    promise::told(&problems.0);
    assert!(read.is_some() || problems.any_error(), "refused without a word");
}
