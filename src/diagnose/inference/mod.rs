//! Joint fits of sets of effects, their evidence, and the search over sets.

pub mod chosen;
pub mod fit;
pub mod joint;
pub mod sets;
