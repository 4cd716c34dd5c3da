//! From text to [`document::Document`], and back.

pub mod document;
pub mod keys;
