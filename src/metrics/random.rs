//! Random numbers that are the same on every machine.

/// Generator of Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA
/// 2014.
#[derive(Clone, Debug)]
pub struct SplitMix64(pub u64);

/// By which the state grows for each number.
pub const INCREMENT: u64 = 0x9E37_79B9_7F4A_7C15;

impl SplitMix64 {
    /// A uniformly distributed 64-bit number.
    pub fn number(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(INCREMENT);
        mixed(self.0)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.number() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Mixes the bits: the finaliser of the generator.
#[must_use]
pub fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}
