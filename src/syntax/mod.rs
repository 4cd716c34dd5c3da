//! From text to [`document::Document`], and back.

pub mod document;
pub mod from_pest;
pub mod keys;
pub mod phrase;
mod layout;
mod lines;
mod print_text;
mod print_yaml;
mod read_text;
mod rules;
pub mod schema;
mod split;

pub use layout::in_order;
pub use print_text::print_text;
pub use print_yaml::print_yaml;
pub use read_text::read_text;

/// TEMP until YAML lands
pub fn read(source: &std::sync::Arc<crate::source::Source>, problems: &mut crate::problem::Problems) -> document::Document { read_text(source, problems) }
