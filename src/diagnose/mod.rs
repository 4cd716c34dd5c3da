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
pub mod checks;
pub mod describe;
pub mod fit;
mod held_out;
pub mod inputs;
pub mod iterate;
pub mod levels;
pub mod linearise;
pub mod observe;
pub mod preflight;
pub mod run;
pub mod score;
pub mod search;
pub mod settings;

pub use campaign::{Outcome, Really, diagnose, effect_of_truth, write_improved};
pub use observe::cache::Cache;
