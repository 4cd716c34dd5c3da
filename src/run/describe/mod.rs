//! What a report tells beside the verdict: the domain, numbers of data, spreads, curves, findings.

pub mod domain;
pub mod not_asked;
pub mod reports;
pub mod spreads;
pub mod told;
pub mod traces;

pub use told::factors;
pub use traces::Kept;
