//! From text to [`document::Document`], and back.

pub mod document;
pub mod keys;
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
