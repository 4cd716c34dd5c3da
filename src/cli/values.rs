//! Values on the command line: counts, and lists such as `2, 4, 6`, `10..30 step 5 Hz`, or `a, b;
//! c, d` for values that contain commas.

use std::num::NonZeroUsize;

/// Values of a list or of a range, as text; those of a range include its unit.
///
/// # Errors
/// The list is empty, or the range is not valid.
pub fn values(text: &str) -> Result<Vec<String>, String> {
    let Some((from, rest)) = text.split_once("..").filter(|_| !text.contains(';')) else {
        let comma = if text.contains(';') { ';' } else { ',' };
        let values: Vec<String> = text
            .split(comma)
            .map(|value| value.trim().to_owned())
            .filter(|value| !value.is_empty())
            .collect();
        return if values.is_empty() { Err("no value is given".into()) } else { Ok(values) };
    };
    let (to, step) = rest.split_once("step").ok_or("a range has the form `FROM..TO step STEP`")?;
    let (from, to, step) = (with_unit(from)?, with_unit(to)?, with_unit(step)?);
    let mut units: Vec<&str> =
        [from.1, to.1, step.1].into_iter().filter(|unit| !unit.is_empty()).collect();
    units.dedup();
    if units.len() > 1 {
        return Err(format!(
            "the values of a range must have the same unit, not {}",
            units.join(" and ")
        ));
    }
    let count = (to.0 - from.0) / step.0;
    if !(step.0 != 0.0 && (0.0..MOST).contains(&(count + 1e-9))) {
        return Err(format!(
            "a range must go from its first value to its last in at most {MOST} steps"
        ));
    }
    let unit = units.first().map_or(String::new(), |unit| format!(" {unit}"));
    // Rounds to decimal digits, since sums of binary fractions are not exact.
    let shown = |value: f64| {
        format!("{:.10}", value).trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    Ok((0..=(count + 1e-9) as usize)
        .map(|at| format!("{}{unit}", shown(from.0 + at as f64 * step.0)))
        .collect())
}

/// Maximum number of values of a range.
const MOST: f64 = 200.0;

/// Splits `20 Hz` into number and unit.
fn with_unit(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    // The longest prefix that is a number: `1e3 m` is a thousand metres.
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
    let number = |end: usize| {
        text[..end]
            .trim_end()
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite())
            .map(|number| (number, end))
    };
    let found = ends.filter(|&end| !text[..end].ends_with(char::is_alphabetic)).find_map(number);
    found
        .map(|(number, end)| (number, text[end..].trim()))
        .ok_or_else(|| format!("`{text}` is not a number with or without a unit"))
}

/// Plain numbers.
///
/// # Errors
/// As [`values`]; a value that is not a number.
pub fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |value: &String| match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(match with_unit(value) {
            Ok((number, unit)) if !unit.is_empty() => {
                format!("`{value}` has a unit; write `{number}`")
            }
            _ => format!("`{value}` is not a number"),
        }),
    };
    values(text)?.iter().map(number).collect()
}

/// A count of at least one.
///
/// # Errors
/// Another text.
pub fn from_one(text: &str) -> Result<NonZeroUsize, String> {
    text.trim().parse().map_err(|_| "expected a whole number from 1".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges() {
        let of = |text: &str| values(text).map(|values| values.join("|"));
        assert_eq!(of("2, 4,6"), Ok("2|4|6".into()));
        assert_eq!(of("n-1, n"), Ok("n-1|n".into()));
        assert_eq!(of("larger of |p1|, |p99|; |p99|;"), Ok("larger of |p1|, |p99|||p99|".into()));
        assert_eq!(of("10..30 step 10 Hz"), Ok("10 Hz|20 Hz|30 Hz".into()));
        assert_eq!(of("0.1..0.4 step 0.1"), Ok("0.1|0.2|0.3|0.4".into()));
        assert_eq!(of("-2..2 step 2"), Ok("-2|0|2".into()));
        assert_eq!(of("1e1m..2e1 m step 10"), Ok("10 m|20 m".into()));
        assert_eq!(numbers("-5, 5"), Ok(vec![-5.0, 5.0]));
        for wrong in [
            "",
            "1..2",
            "1..2 step 0",
            "3..1 step 1",
            "1 Hz..2 s step 1",
            "x..2 step 1",
            "1..1e9 step 1",
        ] {
            assert!(values(wrong).is_err(), "{wrong}");
        }
        assert!(numbers("1, x").is_err());
        assert_eq!(numbers("-5 m, 5 m"), Err("`-5 m` has a unit; write `-5`".into()));
    }
}
