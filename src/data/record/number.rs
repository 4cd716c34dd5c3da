//! Plain decimal numbers such as `-12.34`, eight bytes at a time.
//!
//! Nearly all numbers of a record have no exponent and few enough digits that, read as an integer,
//! they fit the 53 bits of a double. The integer and the divisor, a power of ten, are then exact,
//! and the quotient, rounded once, is the double nearest to the decimal (Clinger, "How to read
//! floating point numbers accurately", PLDI 1990). All other numbers use a general parser.

use std::ops::Range;

/// Maximum number of digits before or after the point.
const MOST: usize = 8;
/// Signed, since conversion of signed integers to double is a single instruction.
const TENS: [i64; MOST + 1] =
    [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// The finite number in a cell; `None` if it is not one.
#[inline]
pub(super) fn read(text: &[u8], cell: Range<usize>) -> Option<f64> {
    plain(text, cell.clone()).or_else(|| general(text, cell))
}

#[cold]
fn general(text: &[u8], cell: Range<usize>) -> Option<f64> {
    fast_float2::parse(text.get(cell)?).ok().filter(|number: &f64| number.is_finite())
}

/// The number in a cell if it has a plain form, few digits, and is not close to either end of the
/// text.
#[inline]
fn plain(text: &[u8], cell: Range<usize>) -> Option<f64> {
    let sign = usize::from(text.get(cell.start) == Some(&b'-'));
    let start = cell.start + sign;
    let head = eight_bytes(text, start)? ^ every(b'0');
    let tail = eight_bytes(text, cell.end.checked_sub(MOST)?)? ^ every(b'0');
    let whole = first(head, b'.' ^ b'0');
    let decimals = cell.end.checked_sub(start + whole + 1);
    let (digits, decimals) = match decimals {
        None => (number(high_end(head, cell.end.checked_sub(start)?)?)?, 0),
        Some(decimals @ 1..MOST) if whole + decimals <= MOST => {
            // The digits before the point from the head, those after it from the tail.
            let after = u64::MAX << (8 * (MOST - decimals));
            let before = head << (8 * (MOST - decimals - whole));
            (number(tail & after | before & !after)?, decimals)
        }
        // At most fifteen digits, less than 2^53.
        Some(decimals @ 1..=MOST) if whole < MOST => (
            number(high_end(head, whole)?)? * TENS[decimals]
                + number(tail & u64::MAX << (8 * (MOST - decimals)))?,
            decimals,
        ),
        Some(_) => return None,
    };
    let size = digits as f64 / TENS[decimals] as f64;
    // Without a branch, which could not be predicted.
    Some(f64::from_bits(size.to_bits() | (sign as u64) << 63))
}

/// The first character is the lowest byte.
#[inline]
fn eight_bytes(text: &[u8], at: usize) -> Option<u64> {
    text.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// A word with this byte in every place.
const fn every(byte: u8) -> u64 {
    u64::from_le_bytes([byte; MOST])
}

/// Index of the first occurrence of a byte among eight; 8 if there is none.
#[inline]
fn first(bytes: u64, byte: u8) -> usize {
    let others = bytes ^ every(byte);
    // The borrow of a zero byte sets its high bit, and affects only later bytes.
    let zeros = others.wrapping_sub(every(1)) & !others & every(0x80);
    zeros.trailing_zeros() as usize / 8
}

/// Moves the first `count` of eight bytes to the high end, filled with zeros; `None` for a count of
/// 0.
#[inline]
fn high_end(digits: u64, count: usize) -> Option<u64> {
    if (1..=MOST).contains(&count) { Some(digits << (8 * (MOST - count))) } else { None }
}

/// The number formed by eight digits from 0 to 9; `None` if a byte is larger than 9.
#[inline]
fn number(digits: u64) -> Option<i64> {
    // 10 + 0x76 is the smallest sum that sets the high bit; a sum with a carry has it set before.
    if (digits.wrapping_add(every(0x76)) | digits) & every(0x80) != 0 {
        return None;
    }
    // Combines neighbours to numbers of two, four and eight digits.
    let digits = (digits * 10 + (digits >> 8)) & 0x00ff_00ff_00ff_00ff;
    let digits = (digits * 100 + (digits >> 16)) & 0x0000_ffff_0000_ffff;
    Some(((digits * 10_000 + (digits >> 32)) & 0xffff_ffff) as i64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lanes::{Lanes, each};
    use super::*;

    /// In the middle of other cells.
    fn plain_in_a_row(text: &str) -> Option<f64> {
        let row = format!("0.98765432109876,{text},0.98765432109876");
        plain(row.as_bytes(), 17..17 + text.len())
    }

    #[test]
    fn what_is_plain() {
        for (text, number) in [
            ("-12.34", -12.34),
            ("7", 7.0),
            ("007.50", 7.5),
            (".5", 0.5),
            ("1234567.8", 1_234_567.8),
            ("-12345678", -12_345_678.0),
            ("9999999.12345678", 9_999_999.123_456_78),
        ] {
            assert_eq!(plain_in_a_row(text), Some(number), "{text}");
        }
        assert!(plain_in_a_row("-0.00").is_some_and(|zero| zero == 0.0 && zero.is_sign_negative()));
        for text in [
            "",
            "-",
            ".",
            "-.",
            "--1",
            "+1",
            "1e3",
            "1.5e-3",
            "1.2.3",
            "1 ",
            " 1",
            "\"1\"",
            "inf",
            "1\u{b2}",
            "1:",
            "1/",
            "12345678x9",
            "1234x.5",
            "x.5",
            "1.x",
        ] {
            assert_eq!(plain_in_a_row(text), None, "{text}");
        }
        assert_eq!(plain(b"1,2", 0..1), None, "at an end of the text");
        for text in ["123456789", "0.123456789", "12345678.9", ".12345678", "12."] {
            assert_eq!(plain_in_a_row(text), None, "{text}");
            assert_eq!(read(text.as_bytes(), 0..text.len()), text.parse().ok(), "{text}");
        }
        assert_eq!(read(b"1e999,", 0..5), None);
    }

    /// What the lanes of this processor read, they read as the standard library does.
    #[test]
    fn any_lanes_read_the_same() {
        let long = [
            "9007199254740992",
            "9007199254740993",
            "0.123456789012345",
            "-0.01806157",
            "123456789.123456",
            ".5",
            "5.",
            "1e-5",
        ];
        let faults = [
            "",
            "-",
            ".",
            "-.",
            "--1",
            "1.2.3",
            "1:5",
            "1/5",
            "12345678901234567x",
            "0x1",
            "1,",
            "inf",
            "nan",
            "1 ",
        ];
        each!(lanes => {
            for text in long.into_iter().chain(["9007199254740993.5", "12345678901234567", "0.00000000000000001"]) {
                let row = format!("0.98765432109876,{text},0.98765432109876");
                assert_eq!(lanes.number(row.as_bytes(), 17..17 + text.len()), text.parse().ok(), "{text}");
            }
            for text in faults {
                let row = format!("0.98765432109876,{text},0.98765432109876");
                assert_eq!(lanes.number(row.as_bytes(), 17..17 + text.len()), None, "{text}");
            }
        });
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        /// As the standard library, which rounds correctly.
        #[test]
        fn lanes_are_right_to_the_last_bit(text in "-?[0-9]{0,10}(\\.[0-9]{0,16})?") {
            let row = format!("0.98765432109876,{text},0.98765432109876");
            let expected = text.parse::<f64>().ok().map(f64::to_bits);
            each!(lanes => {
                prop_assert_eq!(lanes.number(row.as_bytes(), 17..17 + text.len()).map(f64::to_bits), expected);
            });
        }

        /// The standard library rounds correctly.
        #[test]
        fn to_the_last_bit_as_the_standard_library(text in "-?[0-9]{0,9}(\\.[0-9]{1,9})?") {
            match plain_in_a_row(&text) {
                Some(number) => prop_assert_eq!(number.to_bits(), text.parse::<f64>().expect("a number").to_bits()),
                None => prop_assert!(text.trim_start_matches('-').is_empty() || text.split('.').any(|digits| digits.len() > 7)),
            }
        }

        #[test]
        fn any_bytes_are_survived(bytes in prop::collection::vec(prop::sample::select(b"0123456789-+.,e\n\r \xff\x80:/".to_vec()), 0..32), from in 0..32_usize, to in 0..34_usize) {
            each!(lanes => {
                if let Some(number) = lanes.number(&bytes, from..to) {
                    let text = std::str::from_utf8(&bytes[from..to]).expect("digits");
                    prop_assert_eq!(text.parse::<f64>().ok().map(f64::to_bits), Some(number.to_bits()));
                }
            });
        }
    }
}
