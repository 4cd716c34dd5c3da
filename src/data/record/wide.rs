//! Cells and numbers of a text with AVX2, sixteen or thirty-two bytes at a time.
//!
//! A number is read without a branch that depends on its digits: records have numbers of changing
//! length, such as `0.04` after `-12.345`, and a mispredicted branch takes as long as three
//! numbers.

use core::arch::x86_64::{__m128i, __m256i};
use std::ops::Range;

use pulp::cast;
use pulp::x86::V3;

use super::lanes::CHUNK;
use super::lanes::Lanes;
use super::number;

/// Maximum length of a number that is read here, with its point and without its sign.
const MOST: usize = 16;
/// From here on, integers are not all exact as a double.
const EXACT: u64 = 1 << 53;

/// For each length of a number: a mask of its bytes at the end of sixteen.
const KEPT: [[u8; MOST]; MOST + 1] = {
    let mut masks = [[0; MOST]; MOST + 1];
    let mut length = 0;
    while length <= MOST {
        let mut at = MOST - length;
        while at < MOST {
            masks[length][at] = 0xff;
            at += 1;
        }
        length += 1;
    }
    masks
};

/// For each place of the point: the order of the bytes that moves what is before it over it.
/// Without a point the order stays.
const CLOSED: [[u8; MOST]; MOST + 1] = {
    /// A byte that becomes zero.
    const ZERO: u8 = 0x80;
    let mut orders = [[0; MOST]; MOST + 1];
    let mut point = 0;
    while point <= MOST {
        let mut at = 0;
        while at < MOST {
            orders[point][at] = match at {
                _ if point == MOST || at > point => at as u8,
                0 => ZERO,
                _ => at as u8 - 1,
            };
            at += 1;
        }
        point += 1;
    }
    orders
};

/// For each place of the point: ten to the power of the number of decimals, exact.
const DIVISORS: [f64; MOST + 1] = {
    let mut divisors = [1.0; MOST + 1];
    let mut point = MOST - 1;
    let mut tens = 1_u64;
    while point > 0 {
        point -= 1;
        tens *= 10;
        divisors[point] = tens as f64;
    }
    divisors
};

impl Lanes for V3 {
    #[inline(always)]
    fn ends(self, chunk: &[u8; CHUNK]) -> u64 {
        let (halves, _) = chunk.as_chunks::<32>();
        let of = |half: &[u8; 32]| {
            let bytes: __m256i = cast(*half);
            let are = |byte: u8| {
                self.avx2._mm256_cmpeq_epi8(bytes, self.avx._mm256_set1_epi8(byte as i8))
            };
            let any = self
                .avx2
                ._mm256_or_si256(self.avx2._mm256_or_si256(are(b','), are(b'\n')), are(b'"'));
            u64::from(self.avx2._mm256_movemask_epi8(any) as u32)
        };
        of(&halves[0]) | of(&halves[1]) << 32
    }

    #[inline(always)]
    fn number(self, text: &[u8], cell: Range<usize>) -> Option<f64> {
        plain(self, text, cell.clone()).or_else(|| number::read(text, cell))
    }
}

/// The number in a cell if it has a plain form and is not close to the start of the text.
///
/// As in [`number`], the digits as an integer and the divisor are exact, so that the quotient is
/// the double nearest to the decimal.
#[inline(always)]
fn plain(simd: V3, text: &[u8], cell: Range<usize>) -> Option<f64> {
    let negative = usize::from(*text.get(cell.start)? == b'-');
    let length = cell.end.wrapping_sub(cell.start + negative);
    let kept: __m128i = cast(*KEPT.get(length)?);
    let tail: __m128i =
        cast(*text.get(cell.end.wrapping_sub(MOST)..cell.end)?.first_chunk::<MOST>()?);
    let (sse2, ssse3) = (simd.sse2, simd.ssse3);
    let all = |byte: u8| sse2._mm_set1_epi8(byte as i8);
    let bytes = sse2._mm_and_si128(sse2._mm_sub_epi8(tail, all(b'0')), kept);
    let points =
        sse2._mm_movemask_epi8(sse2._mm_cmpeq_epi8(bytes, all(b'.'.wrapping_sub(b'0')))) as u32;
    let point = (points | 1 << MOST).trailing_zeros() as usize;
    let digits = ssse3._mm_shuffle_epi8(bytes, cast(*CLOSED.get(point)?));
    let above_nine = sse2._mm_subs_epu8(digits, all(9));
    let good =
        sse2._mm_movemask_epi8(sse2._mm_cmpeq_epi8(above_nine, sse2._mm_setzero_si128())) == 0xffff;
    if !good || length <= usize::from(point < MOST) {
        return None;
    }
    // Combines neighbours to numbers of two, four and eight digits.
    let twos = ssse3._mm_maddubs_epi16(
        digits,
        cast([10_u8, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1, 10, 1]),
    );
    let fours = sse2._mm_madd_epi16(twos, cast([100_i16, 1, 100, 1, 100, 1, 100, 1]));
    let fours = simd.sse4_1._mm_packus_epi32(fours, fours);
    let eights: [u32; 4] =
        cast(sse2._mm_madd_epi16(fours, cast([10_000_i16, 1, 10_000, 1, 10_000, 1, 10_000, 1])));
    let integer = u64::from(eights[0]) * 100_000_000 + u64::from(eights[1]);
    if integer > EXACT {
        return None;
    }
    // Signed, since conversion of signed integers to double is a single instruction.
    let size = integer as i64 as f64 / DIVISORS[point];
    Some(f64::from_bits(size.to_bits() | (negative as u64) << 63))
}
