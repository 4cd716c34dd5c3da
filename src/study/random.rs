//! Random selections, reproducible from a seed on every machine.

use super::case::Case;

/// A stream of random numbers: SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number
/// generators", 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Streams of different numbers are independent.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = Self(seed ^ stream.wrapping_mul(0xd134_2543_de82_ef95));
        random.number();
        random
    }

    /// A uniformly distributed 64-bit number.
    pub fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A uniformly distributed number below `n` (Lemire's multiplication; its bias is below n /
    /// 2^64).
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.number()) * n as u128) >> 64) as usize
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
