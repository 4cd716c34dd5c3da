//! Results as documents: each is printed as PDF and as HTML.
//!
//! [`view::document`] and its like round, sort and formulate; the templates only place a
//! [`document::Document`].

pub mod attached;
pub mod blind;
pub mod brief;
pub mod comparison;
mod detectable;
pub mod diagnosis;
pub mod document;
pub mod estimates;
pub mod figure;
pub mod findings;
pub mod found;
pub mod html;
pub mod impact;
pub mod number;
pub mod pdf;
pub mod rules;
pub mod sides;
pub mod study;
pub mod tables;
#[cfg_attr(not(feature = "typeset"), path = "no_typesetter.rs")]
pub mod typst;
pub mod view;
pub mod visible;
