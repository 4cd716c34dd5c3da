//! The joint fit of a set of effects under the allowed difference and the error of their responses,
//! and its evidence.

pub mod fitter;
pub mod joint;
pub mod set;
