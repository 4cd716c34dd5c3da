//! From text to [`document::Document`], and back.

pub mod document;
pub mod from_pest;
pub mod keys;
pub mod phrase;
pub fn read(source: &std::sync::Arc<crate::source::Source>, _p: &mut crate::problem::Problems) -> document::Document { document::Document { source: source.clone(), blocks: vec![], trailing: vec![] } }
