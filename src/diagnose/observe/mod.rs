//! Measurement and simulation as features.

pub mod bench;
pub mod cache;
pub(super) mod columns;
pub mod covariates;
pub(super) mod faults;
pub mod increments;
pub mod layout;
pub mod observations;
pub mod observed;
pub mod scatter;
pub mod strata;
