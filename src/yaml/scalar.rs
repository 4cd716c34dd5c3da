//! Values of plain scalars by the core schema of YAML 1.2.2, section 10.3.2.

use super::Value;

/// The value of a plain scalar, or a number that is not finite.
pub fn resolve(text: &str) -> Result<Value, f64> {
    Ok(match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::Null,
        "true" | "True" | "TRUE" => Value::Bool(true),
        "false" | "False" | "FALSE" => Value::Bool(false),
        _ => match number(text) {
            Some(number) if number.is_finite() => Value::Number(number),
            Some(number) => return Err(number),
            None => Value::Text(text.to_string()),
        },
    })
}

fn number(text: &str) -> Option<f64> {
    for (mark, radix) in [("0o", 8), ("0x", 16)] {
        if let Some(digits) = text.strip_prefix(mark) {
            // `from_str_radix` accepts a sign; YAML does not.
            let plain = digits.chars().all(|digit| digit.is_digit(radix));
            return plain.then(|| u32::from_str_radix(digits, radix).ok().map(f64::from)).flatten();
        }
    }
    let unsigned = text.strip_prefix(['-', '+']).unwrap_or(text);
    match unsigned {
        ".inf" | ".Inf" | ".INF" => {
            return Some(if text.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY });
        }
        ".nan" | ".NaN" | ".NAN" if unsigned == text => return Some(f64::NAN),
        _ => {}
    }
    // Rust also reads `inf` and `nan`; YAML numbers start with a digit, or with a point and a
    // digit.
    let digits = unsigned.strip_prefix('.').unwrap_or(unsigned);
    digits.starts_with(|digit: char| digit.is_ascii_digit()).then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_core_schema_and_nothing_more() {
        // Examples of YAML 1.2.2, sections 10.3.2 and 10.3.3, and values that YAML 1.1 reads
        // differently.
        for (text, value) in [
            ("0", 0.0),
            ("0o7", 7.0),
            ("0x3A", 58.0),
            ("-19", -19.0),
            ("0.", 0.0),
            ("-0.0", 0.0),
            (".5", 0.5),
            ("+12e03", 12000.0),
            ("-2E+05", -2e5),
            ("0123", 123.0),
        ] {
            assert_eq!(resolve(text), Ok(Value::Number(value)), "{text}");
        }
        for text in [
            "yes", "no", "on", "Off", "inf", "nan", "NaN", "1_000", "1:30", "5 kN", "1.2.3", "0o8",
            "0x", "+", ".", "e5", "-.nan", "0x-1",
        ] {
            assert_eq!(resolve(text), Ok(Value::Text(text.into())), "{text}");
        }
        for text in [".inf", "-.INF", "1e999", ".nan"] {
            assert!(resolve(text).is_err(), "{text}");
        }
        assert_eq!(resolve("True"), Ok(Value::Bool(true)));
        assert_eq!(resolve("~"), Ok(Value::Null));
    }
}
