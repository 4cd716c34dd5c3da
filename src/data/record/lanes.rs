//! The innermost loops of reading, for any processor and for those with AVX2. Both give the same.

use std::ops::Range;

/// Bytes compared at a time.
pub(super) const CHUNK: usize = 64;
use super::number;

/// How the bytes of a record are looked at.
pub(super) trait Lanes: Copy {
    /// A bit for each byte that ends a cell; the first byte is the lowest bit.
    fn ends(self, chunk: &[u8; CHUNK]) -> u64;

    /// The finite number in a cell; `None` if it is not one.
    fn number(self, text: &[u8], cell: Range<usize>) -> Option<f64>;
}

/// Eight bytes at a time, for any processor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words;

impl Lanes for Words {
    #[inline(always)]
    fn ends(self, chunk: &[u8; CHUNK]) -> u64 {
        // The first loop is vectorised; the product in the second one combines eight flags into one
        // byte.
        let mut flags = [0; CHUNK];
        for (flag, byte) in flags.iter_mut().zip(chunk) {
            *flag = u8::from(matches!(byte, b',' | b'\n' | b'"'));
        }
        let (eights, _) = flags.as_chunks::<8>();
        eights.iter().rev().fold(0, |bits, eight| {
            bits << 8 | u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56
        })
    }

    #[inline(always)]
    fn number(self, text: &[u8], cell: Range<usize>) -> Option<f64> {
        number::read(text, cell)
    }
}

/// Work that is compiled for each kind of lanes.
pub(super) trait Work {
    type Output;
    fn run(self, lanes: impl Lanes) -> Self::Output;
}

/// Does the work with the fastest lanes of this processor.
pub(super) fn fastest<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        struct Vectorised<W>(pulp::x86::V3, W);
        impl<W: Work> pulp::NullaryFnOnce for Vectorised<W> {
            type Output = W::Output;
            #[inline(always)]
            fn call(self) -> W::Output {
                self.1.run(self.0)
            }
        }
        return simd.vectorize(Vectorised(simd, work));
    }
    work.run(Words)
}

/// Repeats a block of a test with all lanes that this processor has.
#[cfg(test)]
macro_rules! each {
    ($lanes:ident => $block:block) => {
        let $lanes = crate::data::record::lanes::Words;
        $block
        #[cfg(target_arch = "x86_64")]
        if let Some($lanes) = pulp::x86::V3::try_new() {
            $block
        }
    };
}
#[cfg(test)]
pub(super) use each;
