//! The project itself: structure, documentation, fuzzing.

mod docs;
mod fuzz;
mod layering;
