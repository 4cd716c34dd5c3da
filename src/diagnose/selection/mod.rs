//! Which effects are named: the search with simulation of the fitted sizes, and the checks of every
//! member.

pub(super) mod calibration;
pub(super) mod converge;
pub(super) mod converging;
pub(super) mod further;
pub mod guards;
pub mod lack;
pub(super) mod masks;
pub mod place;
pub(super) mod settle;
pub mod stability;
pub(super) mod suspects;
pub mod tolerances;
