//! A certification as a document: one view of the result, printed as PDF and as HTML.
//!
//! [`view::view`] rounds, sorts and formulates; the templates only place its data.

pub mod attached;
pub mod blind;
pub mod brief;
pub mod comparison;
mod detectable;
pub mod diagnosis;
pub mod estimates;
pub mod figure;
pub mod findings;
pub mod found;
pub mod html;
pub mod number;
pub mod pdf;
pub mod sides;
pub mod study;
pub mod tables;
#[cfg_attr(not(feature = "typeset"), path = "no_typesetter.rs")]
pub mod typst;
pub mod view;
pub mod visible;
