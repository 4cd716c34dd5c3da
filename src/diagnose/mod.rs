//! Diagnosis: where simulation and measurement differ, which effect causes it, how far the gap shrinks once it is added.

#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_possible_wrap)]

mod apart;
pub mod bench;
mod beside;
mod cache;
mod campaign;
pub mod candidates;
pub mod causes;
mod cells;
mod columns;
mod converge;
pub mod covariance;
pub mod declared;
mod detectable;
mod faults;
pub mod features;
pub mod fit;
mod fold;
pub mod ground;
pub mod guards;
mod invariants;
pub mod lack;
pub mod locate;
mod masks;
pub mod observe;
mod pictures;
pub mod place;
pub mod recorded;
mod rivals;
pub mod run;
pub mod scatter;
pub mod score;
pub mod search;
pub mod sensitivity;
pub mod settings;
mod settle;
mod shapes;
pub mod shrink;
pub mod stability;
pub mod standing;
pub mod steady;
mod suspects;
pub mod trends;
pub mod whiten;
mod words;

pub use cache::Cache;
pub use campaign::{Outcome, Really, diagnose, effect_of_truth, write_improved};
