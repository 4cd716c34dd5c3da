//! A number with its unit in a data file: `54.5 kN`, `1.2e7 N/m`, `0.35`.

use super::{Dimension, SYMBOLS, Unit};

/// A number read in an expected unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Read {
    /// In SI.
    pub si: f64,
    /// Whether the text states the unit; otherwise the expected one is assumed.
    pub unit_stated: bool,
}

/// Why a text is not a number of the expected dimension, and a proposed correction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    pub says: String,
    pub help: Option<String>,
}

/// Reads a finite number. A unit may follow, also in brackets; otherwise the expected unit is
/// assumed.
///
/// # Errors
/// Not a number, a decimal comma, an unknown unit, a unit of another dimension.
pub fn read(text: &str, expected: &Unit) -> Result<Read, Refused> {
    let text = text.trim();
    let refused = |says: String, help: Option<String>| Refused { says, help };
    let (number, unit) = split(text, expected)?;
    if unit.is_empty() {
        return Ok(Read { si: expected.to_si(number), unit_stated: false });
    }
    let unit = Unit::parse(unit).map_err(|unknown| {
        let near = unknown.near.map(|near| format!("did you mean `{near}`?"));
        refused(
            format!("`{}` is not a known unit", unknown.word),
            near.or_else(|| Some(format!("it is expected in {expected}"))),
        )
    })?;
    if unit.dimension != expected.dimension {
        let says = format!(
            "`{text}` is {}, not {}{}",
            unit.dimension.in_words(),
            expected.dimension.in_words(),
            place(expected)
        );
        return Err(refused(says, weight(number, &unit, expected)));
    }
    Ok(Read { si: unit.to_si(number), unit_stated: true })
}

/// A finite number, and the text of its unit, which may stand in brackets or be missing.
///
/// # Errors
/// Not a number, a decimal comma.
pub fn split<'a>(text: &'a str, expected: &Unit) -> Result<(f64, &'a str), Refused> {
    let text = text.trim();
    let end = number_end(text);
    let number = text[..end].parse::<f64>().ok().filter(|number| number.is_finite());
    let Some(number) = number.filter(|_| !text[end..].starts_with([',', '.'])) else {
        return Err(match decimal_comma(text) {
            Some(mended) => Refused {
                says: format!("`{text}` has a decimal comma; numbers are written with a point"),
                help: Some(format!("write `{mended}`")),
            },
            None => {
                Refused { says: format!("`{text}` is not a number{}", place(expected)), help: None }
            }
        });
    };
    let unit = text[end..].trim();
    let bare = unit.strip_prefix('[').and_then(|inner| inner.strip_suffix(']'));
    Ok((number, bare.unwrap_or(unit)))
}

/// A number with so many significant digits; a zero has no sign.
pub fn significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value) + 0.0
}

/// ` (in kN)`, or nothing for a dimensionless number.
fn place(expected: &Unit) -> String {
    if expected.text == "-" { String::new() } else { format!(" (in {expected})") }
}

/// Units of the given dimension in which a number lies in a range (in SI): candidates for a unit
/// that was omitted.
pub fn units_within(number: f64, like: &Unit, range: (f64, f64)) -> Vec<&'static str> {
    let within = |factor: f64| (range.0..=range.1).contains(&(number * factor));
    let alike = SYMBOLS
        .iter()
        .filter(|known| known.dimension == like.dimension && known.factor != like.factor);
    alike.filter(|known| within(known.factor)).map(|known| known.symbol).collect()
}

/// Help for a mass given instead of a force: its weight.
fn weight(number: f64, unit: &Unit, expected: &Unit) -> Option<String> {
    let gravity = SYMBOLS.iter().find(|known| known.symbol == "gn")?;
    let mass: Dimension = expected.dimension / gravity.dimension;
    (unit.dimension == mass).then(|| {
        let force = expected.from_si(unit.to_si(number) * gravity.factor);
        format!("a mass of {number} {unit} weighs {force:.5} {expected}; write the force with its unit if that is meant")
    })
}

/// End of the number at the start of a text: sign, digits with one point, exponent.
pub fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits =
        |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let from = end + 1 + sign(end + 1);
        if digits(from) > 0 {
            end = from + digits(from);
        }
    }
    end
}

/// Replaces `54,5 kN` by `54.5 kN`, if that is a number.
fn decimal_comma(text: &str) -> Option<String> {
    let (before, after) = text.split_once(',')?;
    let mended = format!("{before}.{after}");
    let number = &mended[..number_end(&mended)];
    (number.len() > before.len() + 1 && number.parse::<f64>().is_ok()).then_some(mended)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, unit: &str) -> Result<Read, Refused> {
        read(text, &Unit::parse(unit).expect("a unit"))
    }

    #[test]
    fn numbers_with_and_without_a_unit() {
        let stated = |si| Ok(Read { si, unit_stated: true });
        assert_eq!(of("54.5", "kN"), Ok(Read { si: 54_500.0, unit_stated: false }));
        assert_eq!(of("54.5 kN", "kN"), stated(54_500.0));
        assert_eq!(of(" 54546N ", "kN"), stated(54_546.0));
        assert_eq!(of("54.5 [kN]", "kN"), stated(54_500.0));
        assert_eq!(of("-1.2e+7 N/m", "N/m"), stated(-1.2e7));
        assert_eq!(of("5e3 N", "kN"), stated(5e3));
        assert_eq!(of("120 km/h", "m/s"), stated(120.0 * (1e3 / 3600.0)));
        assert_eq!(of("2.5 %", "-"), stated(0.025));
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for (text, says, help) in [
            ("", "`` is not a number (in kN)", None),
            ("none", "`none` is not a number (in kN)", None),
            ("nan", "`nan` is not a number (in kN)", None),
            ("1e999", "`1e999` is not a number (in kN)", None),
            ("5.4.5", "`5.4.5` is not a number (in kN)", None),
            (
                "54,5 kN",
                "`54,5 kN` has a decimal comma; numbers are written with a point",
                Some("write `54.5 kN`"),
            ),
            ("54.5 kn", "`kn` is not a known unit", Some("did you mean `kN`?")),
            ("54.5 xyz", "`xyz` is not a known unit", Some("it is expected in kN")),
        ] {
            let refused = of(text, "kN").expect_err(text);
            assert_eq!((refused.says.as_str(), refused.help.as_deref()), (says, help), "{text}");
        }
    }

    #[test]
    fn a_mass_is_not_a_force() {
        assert_eq!(of("abc", "-").expect_err("no number").says, "`abc` is not a number");
        let refused = of("5.56 t", "kN").expect_err("another dimension");
        assert!(refused.says.starts_with("`5.56 t` is "), "{}", refused.says);
        assert_eq!(
            refused.help.as_deref(),
            Some(
                "a mass of 5.56 t weighs 54.52497 kN; write the force with its unit if that is meant"
            )
        );
        assert_eq!(of("5 m", "kN").expect_err("another dimension").help, None);
    }

    #[test]
    fn a_forgotten_unit_is_found() {
        let unit = Unit::parse("kN").expect("a unit");
        assert_eq!(units_within(54_546.0, &unit, (10e3, 200e3)), ["N"]);
        assert_eq!(units_within(5.5, &unit, (10e3, 200e3)), Vec::<&str>::new());
    }
}
