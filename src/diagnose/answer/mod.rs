//! The answer: causes with their intervals and rivals, the reduction of the gap, text and figures.

pub(super) mod apart;
pub mod causes;
pub mod decrease;
pub(super) mod detectable;
pub(super) mod pictures;
pub(super) mod rivals;
pub mod verdict;
pub(super) mod words;
