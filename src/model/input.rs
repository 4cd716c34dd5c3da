//! The track under all bodies of a vehicle at one time.

use super::{
    contact::Wheels,
    track::{Hint, Irregularity, Line},
};

/// The track frame of one body relative to that of another.
#[derive(Clone, Copy, Debug, Default)]
pub struct Offset {
    pub e: f64,
    pub phi: f64,
    pub theta: f64,
}

impl Offset {
    /// Frame p at `sp` relative to frame q at `sq`.
    #[inline(always)]
    pub fn new(p: &Line, sp: f64, q: &Line, sq: f64) -> Self {
        Self { e: p.y - q.y - q.theta * (sp - sq), phi: p.cant - q.cant, theta: p.theta - q.theta }
    }
}

/// The track under all bodies at one time.
#[derive(Clone, Debug, Default)]
pub struct Input {
    pub car: Line,
    pub bogie: [Line; 2],
    pub bogie_offset: [Offset; 2],
    pub wheelset: [Line; 4],
    pub wheelset_offset: [Offset; 4],
    pub irregularity: [Irregularity; 4],
    /// Deviation of the radius under the wheels and its rate, in m and m/s.
    pub roundness: [Wheels; 2],
}

/// Intervals of the last track lookups.
#[derive(Clone, Debug, Default)]
pub struct Hints(pub [Hint; 7]);
