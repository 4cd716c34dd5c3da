//! Numbers in sentences.

/// A number with some significant digits, without zeros at its end.
pub fn digits(value: f64, digits: usize) -> f64 {
    let rounded = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A number with some decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}")
}

/// Significant digits of a value in a sentence about a limit; more are used close to the limit.
const LEAST_DIGITS: usize = 3;
const MOST_DIGITS: usize = 12;
/// Smaller numbers have a power of ten: zeros are hard to count.
const SMALLEST: f64 = 1e-4;

/// A value beside another one, with three significant digits, or with more if the rounded texts
/// would be equal or in the wrong order.
pub fn apart(value: f64, other: f64) -> String {
    let read = |text: String| text.replace('\u{2212}', "-").parse::<f64>().unwrap_or(f64::NAN);
    let right = |digits: &usize| {
        let [a, b] = [value, other].map(|value| read(significant(value, *digits)).abs());
        (a > b) == (value.abs() > other.abs()) && a != b
    };
    significant(value, (LEAST_DIGITS..MOST_DIGITS).find(right).unwrap_or(MOST_DIGITS))
}

/// A number with some significant digits, zeros at its end included.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    if value.abs() < SMALLEST {
        return format!("{value:.*e}", digits - 1).replace('-', "\u{2212}");
    }
    let decimals = (digits as f64 - 1.0 - value.abs().log10().floor()).clamp(0.0, 17.0) as usize;
    format!("{value:.decimals$}").replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_sentence_differ_where_the_values_do() {
        let both = |value: f64, bound: f64| (apart(value, bound), apart(bound, value));
        assert_eq!(both(0.06090123, 0.046_666_67), ("0.0609".into(), "0.0467".into()));
        assert_eq!(both(5.0001, 5.0), ("5.0001".into(), "5.0000".into()));
        assert_eq!(both(-12.34, 10.0), ("\u{2212}12.3".into(), "10.0".into()));
    }

    #[test]
    fn small_and_large_numbers_are_easy_to_read() {
        assert_eq!(digits(56.300000000000004, 12), 56.3);
        assert_eq!(significant(2.5e-5, 3), "2.50e\u{2212}5");
        assert_eq!(digits(-0.0, 3).to_string(), "0");
    }
}
