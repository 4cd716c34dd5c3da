//! Measurement and simulation as features.

pub mod bench;
pub mod cache;
pub(super) mod columns;
pub(super) mod faults;
pub mod features;
pub mod increments;
pub mod observations;
pub mod scatter;
