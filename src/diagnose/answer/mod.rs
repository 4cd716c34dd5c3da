//! The answer: causes with their intervals and rivals, how far the gap shrinks, in words and pictures.

pub(super) mod apart;
pub mod causes;
pub(super) mod detectable;
pub(super) mod pictures;
pub(super) mod rivals;
pub mod shrink;
pub mod steady;
pub(super) mod words;
