//! Description of the gap: cells, sums of forces, trends, spectra.

pub(super) mod cells;
pub(super) mod fold;
pub(super) mod invariants;
pub mod locate;
pub(super) mod shapes;
pub mod trends;
