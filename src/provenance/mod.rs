//! Provenance of a report, and verification.
//!
//! A report contains its results and its protocol. [`carried`] extracts them, [`verify`] checks
//! them alone and against the campaign, [`trace`] traces one number to its rule and its rows.
//! [`statement`] describes the files of a report in a standard format, and [`signature`] signs
//! files.

mod before;
pub mod carried;
pub mod check;
pub mod compare;
mod files;
mod pdf;
pub mod signature;
pub mod statement;
pub mod trace;
pub mod verify;
