//! Number format of the report, common to all tables, figures and pages.
//!
//! A printed number never hides a decision based on it: [`beside`] adds decimals until the printed
//! value and limit compare as they do in full precision.

use std::fmt::Display;

/// Printed for a missing value: an en dash.
pub const NONE: &str = "–";
const MINUS: char = '\u{2212}';

/// Maximum number of decimals; smaller numbers are printed with a power of ten.
const MOST_DECIMALS: usize = 6;

/// Decimals for a column of values in one unit.
///
/// The unit gives the usual number; a column of small values gets more, so that its largest value
/// shows two significant digits.
pub fn decimals(unit: &str, values: impl IntoIterator<Item = f64>) -> usize {
    let usual = match unit {
        "m/s^2" | "m/s²" | "rad" => 4,
        "-" | "" | "g" => 4,
        "kN" | "kN.m" | "kNm" | "m/s" | "mm/s" | "deg" | "°" | "s" | "Hz" => 2,
        "m" | "mm" | "km/h" | "%" | "N.m" | "Nm" | "K" | "°C" => 1,
        "N" | "kg" | "Pa" => 0,
        _ => 3,
    };
    let largest = largest(values);
    if largest == 0.0 {
        return usual;
    }
    let needed = (1.0 - largest.log10().floor()).max(0.0);
    if needed > MOST_DECIMALS as f64 { usual } else { usual.max(needed as usize) }
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().filter(|value| value.is_finite()).map(f64::abs).fold(0.0, f64::max)
}

/// Decimals that show `digits` significant digits of the largest value, for values that are printed
/// side by side.
pub fn decimals_of(values: impl IntoIterator<Item = f64>, digits: usize) -> usize {
    let largest = largest(values);
    if largest == 0.0 {
        0
    } else {
        (digits as f64 - 1.0 - largest.log10().floor()).clamp(0.0, MOST_DECIMALS as f64) as usize
    }
}

/// A number with a fixed number of decimals and a true minus sign; never `−0.00`.
///
/// Very large and very small numbers are printed with a power of ten; a value that is not finite is
/// printed as [`NONE`].
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value.abs() >= 1e9
        || (value != 0.0
            && value.abs() < 0.5 * 10_f64.powi(-(MOST_DECIMALS as i32))
            && decimals >= MOST_DECIMALS)
    {
        return scientific(value);
    }
    signed(&format!("{value:.decimals$}"))
}

/// [`fixed`], or [`NONE`].
pub fn optional(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| NONE.to_owned(), |value| fixed(value, decimals))
}

/// A number with `digits` significant digits, without trailing zeros after the decimal point: for
/// limits, settings, extents.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs().log10().floor();
    if !(-5.0..9.0).contains(&size) {
        return scientific(value);
    }
    let decimals = (digits as f64 - 1.0 - size).max(0.0) as usize;
    signed(trimmed(&format!("{value:.decimals$}")))
}

/// A value that is compared with a limit, with additional decimals until the printed pair compares
/// as the exact pair does: 10.0004 against 10 is not printed as `10.00`.
pub fn beside(value: f64, limit: f64, decimals: usize) -> String {
    let shown =
        |places: usize| format!("{:.places$}", value.abs()).parse::<f64>().unwrap_or(f64::NAN);
    let beyond = value.abs() > limit;
    let places = (decimals..decimals + 12).find(|places| (shown(*places) > limit) == beyond);
    fixed(value, places.unwrap_or(decimals))
}

/// Ratios of a value and its limit beyond this tell no more than that: a least value divided by a
/// number near zero, for instance.
const FAR: f64 = 1000.0;

/// A ratio of a value and its limit, which is met up to 1.
pub fn ratio(value: f64) -> String {
    if value > FAR { format!(">\u{a0}{FAR}") } else { beside(value, 1.0, 2) }
}

/// A count; a large one is printed with a power of ten.
pub fn large(number: f64) -> String {
    if number < 1e12 { count(number as u64) } else { significant(number, 3) }
}

/// A count with narrow no-break spaces between groups of three digits, from five digits on.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A printed number with its unit and no line break between them; a dimensionless number alone.
pub fn with_unit(number: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "-" {
        number.to_owned()
    } else {
        format!("{number}\u{a0}{}", self::unit(unit))
    }
}

/// A unit as printed: `m/s^2` becomes `m/s²`; `-` for a dimensionless number becomes an en dash.
pub fn unit(text: &str) -> String {
    if text.is_empty() || text == "-" {
        return NONE.to_owned();
    }
    // `m^-1` of a computed number is the same unit.
    if let Some(unit) = reciprocal(text).filter(|unit| unit.len() + 2 == text.len()) {
        return format!("{unit}⁻¹");
    }
    let mut printed = String::with_capacity(text.len());
    let mut raised = false;
    for (at, c) in text.char_indices() {
        match c {
            '^' => {
                raised = !is_fraction(&text[at + 1..]);
                if !raised {
                    printed.push(c);
                }
            }
            '-' if raised => printed.push('⁻'),
            '0'..='9' if raised => printed.push(superscript(c)),
            _ => {
                raised = false;
                printed.push(if c == '*' { '·' } else { c });
            }
        }
    }
    printed
}

/// A formula or condition as printed: `|a| - 2 * b >= 0.1 m^-1` becomes `|a| − 2 · b ≥ 0.1 m⁻¹`.
pub fn formula(text: impl Display) -> String {
    raised(text.to_string().replace(" - ", " \u{2212} ").replace(" * ", " · "))
}

/// A sentence with its numbers and units as in the tables: `-2e-5 m/s^2 <= 1 1/m` becomes `−2·10⁻⁵
/// m/s² ≤ 1 m⁻¹`.
pub fn raised(text: impl Display) -> String {
    let text = text.to_string().replace("<=", "≤").replace(">=", "≥");
    let mut printed = String::with_capacity(text.len());
    let mut before = None;
    let mut rest = text.as_str();
    while let Some(letter) = rest.chars().next() {
        let after = &rest[letter.len_utf8()..];
        let starts_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
        let behind_digit = before.is_some_and(|c: char| c.is_ascii_digit());
        let mut taken = letter.len_utf8();
        match letter {
            '^' if starts_number(after.trim_start_matches('-')) && !is_fraction(after) => {
                let exponent = &after[..after
                    .find(|c: char| c != '-' && !c.is_ascii_digit())
                    .unwrap_or(after.len())];
                printed
                    .extend(exponent.chars().map(|c| if c == '-' { '⁻' } else { superscript(c) }));
                taken += exponent.len();
            }
            'e' if behind_digit && after.strip_prefix(['-', MINUS]).is_some_and(starts_number) => {
                let digits = after.trim_start_matches(['-', MINUS]);
                let digits =
                    &digits[..digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len())];
                printed.push_str("·10⁻");
                printed.extend(digits.chars().map(superscript));
                taken += after.find(|c: char| c.is_ascii_digit()).unwrap_or(0) + digits.len();
            }
            ' ' | '\u{a0}' if behind_digit && reciprocal(after).is_some() => {
                let unit = reciprocal(after).unwrap_or_default();
                printed.push(letter);
                printed.push_str(&format!("{unit}⁻¹"));
                taken += 2 + unit.len();
            }
            '-' if starts_number(after)
                && before.is_none_or(|c| matches!(c, ' ' | '\u{a0}' | '(')) =>
            {
                printed.push(MINUS)
            }
            _ => printed.push(letter),
        }
        before = rest[..taken].chars().last();
        rest = &rest[taken..];
    }
    printed
}

/// Whether an exponent has decimals or is a quotient: there are no raised points, so that it stays
/// as it is written, `m/s^1.5`.
fn is_fraction(exponent: &str) -> bool {
    let after = exponent.trim_start_matches(|c: char| c == '-' || c.is_ascii_digit());
    let decimals =
        after.strip_prefix('.').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    exponent.starts_with('(') || decimals
}

/// The unit whose reciprocal a text starts with: `m` of `1/m`, not of `1/m^2`.
fn reciprocal(text: &str) -> Option<&str> {
    let unit = text.strip_prefix("1/")?;
    let end = unit.find(|c: char| !c.is_alphabetic()).unwrap_or(unit.len());
    let after = &unit[end..];
    // A point ends a sentence, or joins units.
    let goes_on = after.strip_prefix('.').is_some_and(|rest| rest.starts_with(char::is_alphabetic));
    (end > 0 && !goes_on && !after.starts_with(['^', '/', '*', '_', '(', '²', '³']))
        .then_some(&unit[..end])
}

/// Decimals from which on a number is not one that was written by hand.
const BY_PROGRAM: usize = 5;

/// A number or a word as a campaign states it. Section data that were found have more digits than
/// they are worth: of a number as long as this, three decimals are printed.
pub fn given(text: &str) -> String {
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    match text.parse::<f64>() {
        // A small number, such as a curvature, keeps its digits.
        Ok(value) if decimals >= BY_PROGRAM && value.abs() >= 1.0 => {
            signed(trimmed(&format!("{value:.3}")))
        }
        _ => in_text(text),
    }
}

/// Text that is a number gets a true minus sign; other text is unchanged.
pub fn in_text(text: &str) -> String {
    if is_number(text) { text.replace('-', "\u{2212}") } else { text.to_owned() }
}

/// Whether a text reads as a finite number.
pub fn is_number(text: &str) -> bool {
    text.trim().replace(MINUS, "-").parse::<f64>().is_ok_and(f64::is_finite)
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let raised: String =
        exponent.chars().map(|c| if c == '-' { '⁻' } else { superscript(c) }).collect();
    format!("{}·10{raised}", signed(trimmed(mantissa)))
}

fn superscript(digit: char) -> char {
    match digit {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        '4'..='9' => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
        other => other,
    }
}

/// Without trailing zeros after the decimal point.
fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// With a true minus sign, but not for a number that rounds to zero.
fn signed(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        Some(rest) => format!("{MINUS}{rest}"),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_get_signs_and_raised_exponents() {
        assert_eq!(
            formula("sign(measured) * (simulated - measured)"),
            "sign(measured) · (simulated \u{2212} measured)"
        );
        assert_eq!(formula("a <= 0.1 m^-1; b >= 2 m/s^2"), "a ≤ 0.1 m⁻¹; b ≥ 2 m/s²");
        assert_eq!(formula("a^b 3-4 ^"), "a^b 3-4 ^");
        assert_eq!(
            raised("-2e-5 m/s^2 (-1 1/m), 1.6e\u{2212}41, 3 1/m."),
            "\u{2212}2·10⁻⁵ m/s² (\u{2212}1 m⁻¹), 1.6·10⁻⁴¹, 3 m⁻¹."
        );
        assert_eq!(
            raised("T-1 2026-04-20, 1 / m, 1/m, 2 1/m^2, S1e"),
            "T-1 2026-04-20, 1 / m, 1/m, 2 1/m², S1e"
        );
        assert_eq!(
            (unit("1/m"), unit("1/m/s"), ratio(3e40), ratio(1.004)),
            ("m⁻¹".into(), "1/m/s".into(), ">\u{a0}1000".into(), "1.004".into())
        );
    }

    #[test]
    fn fixed_numbers_have_a_true_minus_and_no_minus_zero() {
        assert_eq!(fixed(1.005, 1), "1.0");
        assert_eq!(fixed(-1.5, 1), "−1.5");
        assert_eq!(fixed(-1.5, 2), "−1.50");
        assert_eq!(fixed(-0.0, 2), "0.00");
        assert_eq!(fixed(-0.004, 2), "0.00");
        assert_eq!(fixed(-0.006, 2), "−0.01");
        assert_eq!(fixed(12_345.678, 0), "12346");
        assert_eq!(fixed(1e12, 2), "1·10¹²");
        assert_eq!(fixed(-2.5e-9, 6), "−2.5·10⁻⁹");
        assert_eq!(fixed(f64::NAN, 2), "–");
        assert_eq!(fixed(f64::INFINITY, 2), "–");
        assert_eq!(fixed(f64::MIN_POSITIVE, 2), "0.00");
        assert_eq!(optional(None, 2), "–");
    }

    #[test]
    fn decimals_follow_the_unit_and_grow_for_small_columns() {
        assert_eq!(decimals("kN", [1.0, 20.0]), 2);
        assert_eq!(decimals("kN", [0.0031, -0.002]), 4);
        assert_eq!(decimals("kN", []), 2);
        assert_eq!(decimals("kN", [f64::NAN, 0.0]), 2);
        assert_eq!(decimals("kN", [1e-30]), 2);
        assert_eq!(decimals("furlong", [1e300]), 3);
    }

    #[test]
    fn significant_digits_drop_empty_zeros_only() {
        assert_eq!([0.004, -52.9, f64::NAN].map(|size| decimals_of([size, 0.0], 3)), [5, 1, 0]);
        assert_eq!(significant(3.333_333, 4), "3.333");
        assert_eq!(significant(10.0, 4), "10");
        assert_eq!(significant(1200.0, 2), "1200");
        assert_eq!(significant(-0.07, 4), "−0.07");
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(significant(1.5e-7, 3), "1.5·10⁻⁷");
    }

    #[test]
    fn a_value_beside_its_limit_never_seems_to_hold_when_it_does_not() {
        assert_eq!(beside(10.0004, 10.0, 2), "10.0004");
        assert_eq!(beside(-10.0004, 10.0, 2), "−10.0004");
        assert_eq!(beside(10.0, 10.0, 2), "10.00");
        assert_eq!(beside(9.9999, 10.0, 2), "10.00");
        assert_eq!(beside(3.334, 10.0 / 3.0, 2), "3.334");
        assert_eq!(beside(0.066_66, 0.2 / 3.0, 4), "0.06666");
        assert_eq!(beside(f64::NAN, 1.0, 2), "–");
    }

    #[test]
    fn counts_and_units() {
        assert_eq!(count(9_999), "9999");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(unit("m/s^2"), "m/s²");
        assert_eq!(unit("kg*m^-1"), "kg·m⁻¹");
        assert_eq!(unit("-"), "–");
        assert_eq!(with_unit("9.81", "m/s^2"), "9.81\u{a0}m/s²");
        assert_eq!(with_unit("0.35", "-"), "0.35");
        assert_eq!(in_text("-12.5"), "−12.5");
        assert_eq!(in_text("a-b"), "a-b");
        assert!(!is_number("inf") && !is_number("") && !is_number("right"));
    }
}
