//! Random selections, reproducible from a seed on every machine.

use super::case::Case;
use crate::metrics::random::SplitMix64;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random(SplitMix64);

impl Random {
    /// Streams of different numbers are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = SplitMix64(seed ^ stream.wrapping_mul(0xd134_2543_de82_ef95));
        random.number();
        Self(random)
    }

    /// A uniformly distributed number below `n` (Lemire's multiplication; its bias is below n /
    /// 2^64).
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.number()) * n as u128) >> 64) as usize
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
