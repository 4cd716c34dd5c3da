//! Random selections, reproducible from a seed on every machine.

use rayon::prelude::*;

use super::{Settings, case::Case};
use crate::metrics::random::SplitMix64;

/// Selections of a batch, and batches drawn between checks of the width.
const BATCH: usize = 4096;
const ROUND: usize = 8;
/// Largest number of selections drawn.
const MOST_DRAWN: usize = 1 << 22;

/// One of the streams of random numbers of a seed.
#[derive(Clone, Debug)]
pub struct Random(SplitMix64);

impl Random {
    /// Streams of different numbers are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = SplitMix64::new(seed ^ stream.wrapping_mul(0xd134_2543_de82_ef95));
        random.number();
        Self(random)
    }

    /// A uniformly distributed 64-bit number.
    pub fn number(&mut self) -> u64 {
        self.0.number()
    }

    /// A uniformly distributed number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0.below(n)
    }
}

/// A random selection with equal probability: sections of each stratum without replacement.
pub fn draw(case: &Case, random: &mut Random) -> Vec<usize> {
    let mut chosen = Vec::new();
    for stratum in &case.strata {
        let mut members = stratum.members.clone();
        for at in 0..stratum.take {
            let other = at + random.below(members.len() - at);
            members.swap(at, other);
        }
        chosen.extend_from_slice(&members[..stratum.take]);
    }
    chosen.sort_unstable();
    chosen
}

/// What is counted of random selections.
pub trait Count: Send {
    /// Counts a selection.
    fn look(&mut self, selection: Vec<usize>);

    /// Adds what was counted of further selections.
    fn join(&mut self, other: Self);

    /// Width of the widest interval after so many selections.
    fn width(&self, all: u64) -> f64;
}

/// Draws selections until the intervals are as narrow as the settings ask, or there are too many;
/// returns what was counted, and the number of selections.
///
/// Batches are joined in order, so that the result does not depend on the number of threads.
pub fn draw_until<T: Count>(
    case: &Case,
    settings: &Settings,
    none: impl Fn() -> T + Sync,
) -> (T, u64) {
    let batch = |number: usize| {
        let (mut random, mut counted) = (Random::new(settings.seed, number as u64), none());
        (0..BATCH).for_each(|_| counted.look(draw(case, &mut random)));
        counted
    };
    let (mut counted, mut batches) = (none(), 0);
    loop {
        let round: Vec<T> = (batches..batches + ROUND).into_par_iter().map(batch).collect();
        round.into_iter().for_each(|batch| counted.join(batch));
        batches += ROUND;
        let all = batches * BATCH;
        if counted.width(all as u64) <= settings.width || all >= MOST_DRAWN {
            return (counted, all as u64);
        }
    }
}
