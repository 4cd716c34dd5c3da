//! Checks of a fitted set: heterogeneity of sizes, what is left by channel and for further
//! candidates, stability.

pub mod channels;
pub mod further;
pub mod heterogeneity;
pub mod stability;
