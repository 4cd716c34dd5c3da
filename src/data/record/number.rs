//! Short decimal numbers, eight bytes at a time.
//!
//! Nearly every cell of a record is a sign, a few digits and a point: `-12.34`. Reading one byte after the other costs a branch that
//! cannot be foreseen for each; here the whole cell is one machine word. Everything else goes to `fast-float2`.
//!
//! Source of the digit sum: J. Leitch's and D. Lemire's "parsing eight digits", as in `fast_float`; the division is exact by
//! W. D. Clinger, "How to read floating point numbers accurately" (1990): digits below 2^53, a power of ten below 10^22.

/// Each byte of a word.
const EACH: u64 = 0x0101_0101_0101_0101;
const HIGH: u64 = 0x80 * EACH;
const TENS: [f64; 8] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

/// The finite number at the start of the bytes, and its length.
#[inline(always)]
pub(super) fn leading(bytes: &[u8]) -> Option<(f64, usize)> {
    match short(bytes) {
        Some(found) => Some(found),
        None => long(bytes),
    }
}

#[cold]
#[inline(never)]
fn long(bytes: &[u8]) -> Option<(f64, usize)> {
    fast_float2::parse_partial::<f64, _>(bytes).ok().filter(|(number, _)| number.is_finite())
}

/// How many bytes there are before the first comma, quote or line end.
#[inline]
pub(super) fn until_separator(bytes: &[u8]) -> usize {
    let mut at = 0;
    while let Some(word) = word(bytes, at) {
        // Commas, quotes and line ends are all below `-`, and little else is.
        let low = below_minus(word);
        if low == 0 {
            at += 8;
            continue;
        }
        at += first(low);
        if bytes.get(at).is_some_and(|byte| is_separator(*byte)) {
            return at;
        }
        at += 1;
    }
    at + bytes[at..].iter().position(|byte| is_separator(*byte)).unwrap_or(bytes.len() - at)
}

fn is_separator(byte: u8) -> bool {
    matches!(byte, b',' | b'\n' | b'"' | b'\r')
}

#[inline]
fn word(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..at + 8)?.try_into().ok().map(u64::from_le_bytes)
}

/// The high bit of the first byte below `-` and perhaps of bytes after it; none if there is no such byte.
#[inline]
fn below_minus(word: u64) -> u64 {
    word.wrapping_sub(EACH * b'-' as u64) & !word & HIGH
}

#[inline]
fn first(bits: u64) -> usize {
    (bits.trailing_zeros() / 8) as usize
}

/// At most eight digits and a point, then a byte below `-`.
#[inline(always)]
fn short(bytes: &[u8]) -> Option<(f64, usize)> {
    let negative = bytes.first() == Some(&b'-');
    let sign = usize::from(negative);
    let word = word(bytes, sign)?;
    let low = below_minus(word);
    let length = if low != 0 {
        first(low)
    } else if bytes.get(sign + 8).is_none_or(|byte| *byte < b'-') {
        8
    } else {
        return None;
    };
    // The lowest set bit of the classical test for a zero byte is exact.
    let no_point = word ^ (EACH * b'.' as u64);
    let points = no_point.wrapping_sub(EACH) & !no_point & HIGH;
    let point = if points == 0 { length } else { first(points).min(length) };
    let digits = length - usize::from(point < length);
    if digits == 0 {
        return None;
    }
    // The point is closed up, the digits become 0 to 9, and move to the high end, with zeros before them.
    let before = if point == 8 { u64::MAX } else { (1 << (8 * point)) - 1 };
    let closed = if point < length { (word & before) | ((word >> 8) & !before) } else { word };
    let figures = (closed ^ (EACH * b'0' as u64)) << (64 - 8 * digits);
    // Anything but a digit is above 9.
    if (figures | figures.wrapping_add(EACH * 0x76)) & HIGH != 0 {
        return None;
    }
    let pairs = figures.wrapping_mul(10).wrapping_add(figures >> 8);
    let even = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(0x000f_4240_0000_0064);
    let odd = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(0x0000_2710_0000_0001);
    let whole = (even.wrapping_add(odd) >> 32) as u32;
    let size = f64::from(whole) / TENS.get(digits - point.min(digits))?;
    // Signs come and go as they like: a branch on them would be guessed wrong half of the time.
    Some((f64::from_bits(size.to_bits() | u64::from(negative) << 63), sign + length))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn same(text: &str) {
        let bytes = text.as_bytes();
        let slow = fast_float2::parse_partial::<f64, _>(bytes).ok().filter(|(number, _)| number.is_finite());
        let bits = |found: Option<(f64, usize)>| found.map(|(number, length)| (number.to_bits(), length));
        assert_eq!(bits(leading(bytes)), bits(slow), "{text:?}");
        // Whatever the short way takes must be what the long way finds, to the last bit and byte.
        if let Some(found) = short(bytes) {
            assert_eq!(bits(Some(found)), bits(slow), "{text:?}");
        }
    }

    #[test]
    fn every_form_a_cell_can_have() {
        for cell in [
            "0",
            "-0",
            "-0.0",
            "7",
            "12",
            "1.5",
            "-12.34",
            ".5",
            "-.5",
            "5.",
            "12345678",
            "1234567.8",
            "1.2345678",
            "-1234.567",
            "00000001",
            "123456789",
            "1.23456789",
            "1e5",
            "-1e-5",
            "1.5E3",
            "",
            "-",
            ".",
            "-.",
            "--1",
            "+1",
            "1.2.3",
            "1..2",
            "nan",
            "inf",
            "1e999",
            "1_0",
            "0x10",
            "12a",
            "１",
            "1\u{e9}",
        ] {
            for after in ["", ",", ",1.5,2.5,3.5", "\n", "\n1.5,2.5,3.5", "\r\n1.5,2.5", " ,1.5,2.5,3", "\",1.5,2.5,", ";1.5;2.5;3"] {
                same(&format!("{cell}{after}"));
            }
        }
    }

    #[test]
    fn separators() {
        for (text, length) in
            [("abc,1", 3), ("", 0), ("a b (c)+d*e#f,1", 13), ("abcdefghijk", 11), ("abcdefghijklmnop\nxxxxxxxxxx", 16), ("12345678,", 8)]
        {
            assert_eq!(until_separator(text.as_bytes()), length, "{text}");
        }
    }

    proptest! {
        #[test]
        fn numbers_with_few_decimals(number in -1e5..1e5f64, decimals in 0..6usize, after in "[,\n\r][0-9.,]{0,9}") {
            same(&format!("{number:.decimals$}{after}"));
        }

        #[test]
        fn any_bytes(text in r#"[0-9.\-+e, \n"a]{0,20}"#) {
            same(&text);
            prop_assert_eq!(until_separator(text.as_bytes()), text.find([',', '"', '\n', '\r']).unwrap_or(text.len()));
        }
    }
}
