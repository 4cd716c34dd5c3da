//! How the numbers of a column are written as text, so that a record that was converted and
//! converted back is the same text.

/// Digits with which every double is written uniquely.
const UNIQUE: usize = 17;

/// The form of all numbers of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// The same number of decimals: `12.50`.
    Decimals(usize),
    /// At most so many significant digits, without zeros at the end, with an exponent for small and
    /// large numbers: `%.6g` of C.
    Significant(usize),
    /// The fewest digits that give the same double again, as Python writes numbers: `12.5`, `1.0`,
    /// `1e-05`.
    Shortest,
}

impl Digits {
    /// Most decimals or digits: those of the smallest double.
    pub const MOST: usize = 324;

    /// Key and value in the metadata of a field.
    pub fn metadata(self) -> (&'static str, String) {
        match self {
            Self::Decimals(count) => ("decimals", count.to_string()),
            Self::Significant(count) => ("digits", count.to_string()),
            Self::Shortest => ("digits", "shortest".to_string()),
        }
    }

    /// From the metadata of a field, by their key.
    pub fn read<'a>(value: impl Fn(&str) -> Option<&'a str>) -> Option<Self> {
        let count = |key: &str| value(key)?.parse().ok().filter(|count| *count <= Self::MOST);
        if let Some(count) = count("decimals") {
            return Some(Self::Decimals(count));
        }
        match value("digits")? {
            "shortest" => Some(Self::Shortest),
            _ => count("digits").filter(|count| *count > 0).map(Self::Significant),
        }
    }

    pub fn write(self, value: f64) -> String {
        match self {
            Self::Decimals(count) => format!("{value:.count$}"),
            Self::Significant(count) => {
                let (mantissa, exponent) = split(&format!("{value:.*e}", count - 1));
                match (count - 1).checked_add_signed(-exponent) {
                    Some(decimals) if exponent >= -4 => {
                        without_zeros(&format!("{value:.decimals$}"))
                    }
                    _ => scientific(&without_zeros(&mantissa), exponent),
                }
            }
            Self::Shortest => {
                let (mantissa, exponent) = split(&format!("{value:e}"));
                let text = format!("{value}");
                match exponent {
                    -4..16 if text.contains('.') => text,
                    -4..16 => text + ".0",
                    _ => scientific(&mantissa, exponent),
                }
            }
        }
    }

    /// In this form if that is the same double, else with the digits that make it so. A column can
    /// be said to have fewer than it has.
    pub fn exact(form: Option<Self>, value: f64) -> String {
        let same =
            |text: &String| text.parse().is_ok_and(|again: f64| again.to_bits() == value.to_bits());
        let plain = value == 0.0 || (1e-5..1e16).contains(&value.abs());
        let shortest = || if plain { format!("{value}") } else { format!("{value:e}") };
        form.map(|form| form.write(value)).filter(same).unwrap_or_else(shortest)
    }

    /// Number of significant digits of a number as it is written.
    pub fn significant(text: &str) -> usize {
        let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
        let digits = mantissa
            .trim_start_matches(['-', '+', '0', '.'])
            .bytes()
            .filter(u8::is_ascii_digit)
            .count();
        digits.clamp(1, UNIQUE)
    }
}

/// Mantissa and exponent of `1.5e-7`.
fn split(text: &str) -> (String, isize) {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    (mantissa.to_string(), exponent.parse().unwrap_or(0))
}

fn without_zeros(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text.to_string()
    }
}

/// With a sign and two digits at least in the exponent.
fn scientific(mantissa: &str, exponent: isize) -> String {
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.unsigned_abs())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As `'%.6g' % value` and `repr(value)` of Python 3.11.
    #[test]
    fn as_python_writes_them() {
        for (value, six, shortest) in [
            (0.0, "0", "0.0"),
            (-0.0, "-0", "-0.0"),
            (30.25, "30.25", "30.25"),
            (100_000.0, "100000", "100000.0"),
            (999_999.5, "1e+06", "999999.5"),
            (1_234_567.0, "1.23457e+06", "1234567.0"),
            (5.70776e-6, "5.70776e-06", "5.70776e-06"),
            (1e-4, "0.0001", "0.0001"),
            (0.000_123_456_789, "0.000123457", "0.000123456789"),
            (9.999_999e-5, "0.0001", "9.999999e-05"),
            (-1e16, "-1e+16", "-1e+16"),
            (1e300, "1e+300", "1e+300"),
            (0.1 + 0.2, "0.3", "0.30000000000000004"),
        ] {
            assert_eq!(
                (
                    Digits::Significant(6).write(value).as_str(),
                    Digits::Shortest.write(value).as_str()
                ),
                (six, shortest)
            );
        }
        assert_eq!(Digits::Decimals(2).write(12.5), "12.50");
        assert_eq!(["5.70776e-06", "0.0120", "-100", "0"].map(Digits::significant), [6, 3, 3, 1]);
    }

    proptest! {
        #[test]
        fn no_number_changes(value in prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL, count in 1..20_usize) {
            for form in [None, Some(Digits::Decimals(count)), Some(Digits::Significant(count)), Some(Digits::Shortest)] {
                let again: f64 = Digits::exact(form, value).parse().expect("a number");
                prop_assert_eq!(again.to_bits(), value.to_bits());
                let kept = form.and_then(|form| {
                    let (key, value) = form.metadata();
                    Digits::read(|asked| (asked == key).then_some(value.as_str()))
                });
                prop_assert_eq!(kept, form);
            }
            prop_assert_eq!(Digits::Shortest.write(value).parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
        }
    }
}
