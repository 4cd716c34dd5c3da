//! Where a report came from, and whether it still follows from there.
//!
//! A report carries its results and its protocol. [`carried`] takes them out of it, [`verify`] checks them alone and against the
//! campaign, [`trace`] follows one number back to its rule and its rows. [`statement`] says the same of the files beside the report
//! in a form that other programs read, [`signature`] signs.

pub mod carried;
pub mod compare;
mod pdf;
pub mod results;
pub mod signature;
pub mod statement;
pub mod trace;
pub mod verify;
