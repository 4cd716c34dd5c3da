//! The response of the features to every effect of the catalogue.

pub mod candidate;
pub mod ground;
pub mod mask;
pub mod path;
pub mod workshop;
