//! Numbers as texts have them: with a decimal point or comma, an exponent of E or D.

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// NaN where the cell says so.
    Number(f64),
    Empty,
    /// A number with marks between its thousands.
    Thousands,
    NotFinite,
    Other,
}

/// Longest text that is read as a number; a cell can be as long as the file.
const LONGEST: usize = 64;

/// Reads a trimmed cell.
pub fn read(text: &str, decimal: char) -> Cell {
    if text.is_empty() {
        return Cell::Empty;
    }
    if text.len() > LONGEST {
        return Cell::Other;
    }
    let comma = decimal == ',';
    if text.ends_with(|c: char| c.is_ascii_alphabetic() || c == ')') {
        match text.to_ascii_lowercase().trim_start_matches(['-', '+']) {
            "nan" | "nan(ind)" | "1.#ind" | "1.#qnan" | "n/a" | "#n/a" => {
                return Cell::Number(f64::NAN);
            }
            "inf" | "infinity" | "1.#inf" => return Cell::NotFinite,
            _ => {}
        }
    } else if !comma && let Ok(number) = fast_float2::parse::<f64, _>(text) {
        return finite(number);
    }
    let mut plain = [0u8; LONGEST];
    let plain = &mut plain[..text.len()];
    plain.copy_from_slice(text.as_bytes());
    for byte in plain.iter_mut() {
        match *byte {
            b',' if comma => *byte = b'.',
            // Fortran writes the exponent of a double number so.
            b'D' | b'd' => *byte = b'E',
            b'.' if comma => *byte = b',',
            _ => {}
        }
    }
    let numeric =
        plain.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'E' | b'e'));
    // With a comma, a number does not end in it: `1,` is a cell with a separator.
    let open = comma && plain.ends_with(b".");
    match fast_float2::parse::<f64, _>(&*plain) {
        Ok(number) if numeric && !open => finite(number),
        _ if thousands(text, decimal) => Cell::Thousands,
        _ => Cell::Other,
    }
}

fn finite(number: f64) -> Cell {
    // 1e999 is infinite.
    if number.is_infinite() { Cell::NotFinite } else { Cell::Number(number) }
}

/// `1.234,5`, `1 234,5`, `1'234.5`, `1.234.567`: groups of three digits with a mark that is not the
/// decimal mark.
fn thousands(text: &str, decimal: char) -> bool {
    let text = text.trim_start_matches(['-', '+']);
    let (whole, fraction) = match text.split_once(decimal) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (text, None),
    };
    let Some(mark) = whole.chars().find(|c| !c.is_ascii_digit()) else { return false };
    if !matches!(mark, '.' | ',' | '\'' | '’' | ' ' | '\u{a0}' | '\u{202f}') || mark == decimal {
        return false;
    }
    let groups: Vec<&str> = whole.split(mark).collect();
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&groups[0].len())
        && groups.iter().all(|group| digits(group))
        && groups[1..].iter().all(|group| group.len() == 3)
        && (fraction.is_some_and(digits) || groups.len() > 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_kinds() {
        for (text, decimal, value) in [
            ("1.5", '.', 1.5),
            ("-1,5", ',', -1.5),
            ("+3", ',', 3.0),
            ("1.", '.', 1.0),
            (".5", '.', 0.5),
            ("1.25E-03", '.', 1.25e-3),
            ("1,25e3", ',', 1250.0),
            ("2.5D+02", '.', 250.0),
            ("2,5d2", ',', 250.0),
            ("1e-400", '.', 0.0),
        ] {
            assert_eq!(read(text, decimal), Cell::Number(value), "{text}");
        }
        for text in ["NaN", "-nan", "nan", "-NaN(IND)", "#N/A"] {
            assert!(matches!(read(text, '.'), Cell::Number(number) if number.is_nan()), "{text}");
        }
        assert_eq!(read("", '.'), Cell::Empty);
        assert_eq!(
            (read("inf", '.'), read("1e999", '.'), read("-Infinity", ',')),
            (Cell::NotFinite, Cell::NotFinite, Cell::NotFinite)
        );
    }

    #[test]
    fn what_is_not_a_number() {
        for (text, decimal) in [
            ("1,5", '.'),
            ("1.5", ','),
            ("1,", ','),
            ("abc", '.'),
            ("12:30", '.'),
            ("1 2", '.'),
            ("0x1F", '.'),
            ("d", '.'),
        ] {
            assert_eq!(read(text, decimal), Cell::Other, "{text}");
        }
        assert_eq!(read(&"1".repeat(100), '.'), Cell::Other);
    }

    #[test]
    fn thousands_are_not_guessed() {
        for (text, decimal) in [
            ("1.234,5", ','),
            ("1,234.5", '.'),
            ("1 234,56", ','),
            ("-1'234.5", '.'),
            ("1.234.567", ','),
            ("1,234,567", '.'),
        ] {
            assert_eq!(read(text, decimal), Cell::Thousands, "{text}");
        }
        for (text, decimal) in [("1.23,5", ','), ("12345.6,7", '.')] {
            assert_eq!(read(text, decimal), Cell::Other, "{text}");
        }
    }
}
