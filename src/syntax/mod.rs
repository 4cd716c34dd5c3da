//! From text to [`document::Document`] and back: the text form and YAML are two forms of one
//! language.

pub mod document;
pub mod families;
pub mod from_pest;
mod idioms;
pub mod keys;
mod layout;
mod lines;
mod meaning;
mod nesting;
pub mod phrase;
mod print_text;
mod print_yaml;
mod read_text;
mod read_yaml;
mod remarks;
mod rules;
pub mod schema;
mod spelling;
mod split;

use std::{path::Path, sync::Arc};

use crate::problem::Problems;
use crate::source::Source;
use document::Document;

pub use idioms::idiom;
pub use layout::in_order;
pub use meaning::{is_each, same_meaning};
pub use print_text::print_text;
pub use print_yaml::print_yaml;
pub use read_text::read_text;
pub use read_yaml::read_yaml;

/// Whether a file name is that of a protocol in YAML.
pub fn is_yaml(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| {
        extension.eq_ignore_ascii_case("yaml") || extension.eq_ignore_ascii_case("yml")
    })
}

/// Reads a protocol in the form given by its file name: YAML for `.yaml` and `.yml`, the text form
/// otherwise. A document is always returned. If parts are missing, problems state which and why.
pub fn read(source: &Arc<Source>, problems: &mut Problems) -> Document {
    if is_yaml(&source.name) { read_yaml(source, problems) } else { read_text(source, problems) }
}
