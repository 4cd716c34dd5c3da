//! Whole campaigns: by one protocol, by several, and one value by itself.

pub mod several;
pub mod single;
mod whole;

pub use whole::{Outcome, Reduced, Settings, evaluate, evaluated, judge, reduce, run};
