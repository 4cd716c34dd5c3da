//! Identification of effects: candidates, fits, guards.

pub(super) mod beside;
pub mod candidates;
pub mod choose;
pub(super) mod converge;
pub mod fit;
pub mod ground;
pub mod guards;
pub mod joint;
pub mod lack;
pub(super) mod masks;
pub mod place;
pub mod sets;
pub(super) mod settle;
pub mod stability;
pub(super) mod suspects;
