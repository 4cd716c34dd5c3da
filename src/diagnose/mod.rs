//! Diagnosis: where simulation and measurement differ, which effect is the cause, and how far the
//! gap decreases with the effect added.

#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

pub mod answer;
mod campaign;
pub mod features;
mod held_out;
pub mod inference;
pub mod inputs;
pub mod levels;
pub mod localisation;
pub mod preflight;
pub mod response;
pub mod run;
pub mod score;
pub mod selection;
pub mod settings;
pub mod uncertainty;

pub use campaign::{Outcome, Really, diagnose, effect_of_truth, write_improved};
pub use features::cache::Cache;
