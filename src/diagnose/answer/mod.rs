//! The answer: causes with their intervals and rivals, the reduction of the gap, text and figures.

pub(super) mod apart;
pub mod causes;
pub(super) mod detectable;
pub(super) mod pictures;
pub(super) mod rivals;
pub mod shrink;
pub mod steady;
pub mod verdict;
pub(super) mod words;
