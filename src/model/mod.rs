//! The reference vehicle model: a four-axle bogie vehicle at constant speed on a canted, curved,
//! irregular track.
//!
//! Small displacements, 31 degrees of freedom and four spin speeds, non-linear contact and
//! suspension; equations in `docs/model.md`. Inputs: a [`Vehicle`], its [`Profile`], a
//! [`TrackTable`] and a speed. Output: a [`Record`].

#![allow(
    clippy::inline_always,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod contact;
pub mod equations;
mod input;
pub mod integrate;
mod masses;
mod parameters;
mod profile;
mod record;
mod spline;
pub mod state;
mod track;

pub use contact::Contact;
pub use integrate::{Failure, FailureKind};
pub use parameters::{Admissible, PARAMETERS, Parameter, Vehicle, VehicleFault, parameter};
pub use profile::{Geometry, Profile, ProfileTable};
pub use record::{BEFORE, BEHIND, CHANNELS, Record, SAMPLING_RATE, Setup, Window, simulate, start};
pub use track::{Track, TrackTable};

/// Gravity in m/s^2.
pub const G: f64 = 9.81;
