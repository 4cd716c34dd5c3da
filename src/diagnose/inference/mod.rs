//! Inference over sets of effects: one model error of simulated responses, one joint evidence, one search.

pub mod joint;
pub mod sets;
