//! Numbers as texts have them: with a decimal point or comma, an exponent of E or D.

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// NaN where the cell says so.
    Number(f64),
    Empty,
    /// A number with marks between its thousands, as a decimal mark that is known makes it.
    Thousands(f64),
    /// A place on a line in metres, written as kilometres and metres: `130+0663.25`.
    Chainage(f64),
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
        _ => match (thousands(text, decimal), chainage(text, decimal)) {
            (Some(number), _) => Cell::Thousands(number),
            (None, Some(metres)) => Cell::Chainage(metres),
            (None, None) => Cell::Other,
        },
    }
}

fn finite(number: f64) -> Cell {
    // 1e999 is infinite.
    if number.is_infinite() { Cell::NotFinite } else { Cell::Number(number) }
}

/// `1.234,5`, `1 234,5`, `1'234.5`, `1.234`: groups of three digits with a mark that is not the
/// decimal mark.
fn thousands(text: &str, decimal: char) -> Option<f64> {
    let size = text.trim_start_matches(['-', '+']);
    let (whole, fraction) = size.split_once(decimal).unwrap_or((size, "0"));
    let mark = whole.chars().find(|c| !c.is_ascii_digit())?;
    if !matches!(mark, '.' | ',' | '\'' | '’' | ' ' | '\u{a0}' | '\u{202f}') || mark == decimal {
        return None;
    }
    let groups: Vec<&str> = whole.split(mark).collect();
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let grouped = (1..=3).contains(&groups[0].len())
        && !groups[0].starts_with('0')
        && groups.iter().all(|group| digits(group))
        && groups[1..].iter().all(|group| group.len() == 3)
        && digits(fraction);
    let number = || format!("{}.{fraction}", groups.concat()).parse::<f64>().ok();
    let size = grouped.then(number).flatten()?;
    Some(if text.starts_with('-') { -size } else { size })
}

/// `130+0663.25`: kilometres and metres, which have three digits at least.
fn chainage(text: &str, decimal: char) -> Option<f64> {
    let (kilometres, metres) = text.split_once('+')?;
    let (whole, fraction) = metres.split_once(decimal).unwrap_or((metres, "0"));
    let digits = |text: &str, count: std::ops::RangeInclusive<usize>| {
        count.contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_digit())
    };
    let known = digits(kilometres, 1..=4) && digits(whole, 3..=4) && digits(fraction, 1..=9);
    let metres = format!("{whole}.{fraction}").parse::<f64>().ok().filter(|_| known)?;
    Some(1000.0 * kilometres.parse::<f64>().ok()? + metres)
}

/// Whether the mark in the numbers of a column can stand between thousands as well: `990`, `1.004`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Marks {
    /// A number below 1000 without a mark.
    small: bool,
    /// The row of the first number with three digits after its mark.
    grouped: Option<usize>,
    /// A number that tells what the mark is.
    decided: bool,
}

impl Marks {
    /// Looks at the number in a row.
    pub fn see(&mut self, row: usize, word: &str, decimal: char) {
        if self.decided || word.is_empty() {
            return;
        }
        let word = word.trim_start_matches(['-', '+']);
        // A missing value says nothing of marks.
        if !word.starts_with(|first: char| first.is_ascii_digit()) {
            return;
        }
        let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        match word.split_once(decimal) {
            None if word.len() <= 3 && digits(word) => self.small = true,
            Some((whole, fraction))
                if (1..=3).contains(&whole.len())
                    && !whole.starts_with('0')
                    && fraction.len() == 3
                    && digits(whole)
                    && digits(fraction) =>
            {
                self.grouped.get_or_insert(row);
            }
            _ => self.decided = true,
        }
    }

    /// The row of a number that can be read in both ways.
    pub fn unclear(&self) -> Option<usize> {
        self.grouped.filter(|_| self.small && !self.decided)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A missing value says nothing of the mark; a number of four digits does.
    #[test]
    fn marks_are_unclear_until_a_number_tells() {
        let unclear = |words: &[&str]| {
            let mut marks = Marks::default();
            words.iter().enumerate().for_each(|(row, word)| marks.see(row, word, '.'));
            marks.unclear()
        };
        assert_eq!(unclear(&["990", "1.004"]), Some(1));
        assert_eq!(unclear(&["990", "NaN", "n/a", "1.004"]), Some(3));
        assert_eq!(unclear(&["990", "1.004", "0.5"]), None);
        assert_eq!(unclear(&["990", "1004", "1.004"]), None);
    }

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
    fn places_on_a_line_are_in_metres() {
        assert_eq!(read("130+0663.25", '.'), Cell::Chainage(130_663.25));
        assert_eq!(read("7+012,5", ','), Cell::Chainage(7012.5));
        for text in ["1+2", "+1+234", "1+234+5", "a+234", "1+23456"] {
            assert_eq!(read(text, '.'), Cell::Other, "{text}");
        }
    }

    #[test]
    fn thousands_are_not_guessed() {
        for (text, decimal, number) in [
            ("1.234,5", ',', 1234.5),
            ("1,234.5", '.', 1234.5),
            ("1 234,56", ',', 1234.56),
            ("-1'234.5", '.', -1234.5),
            ("1.234.567", ',', 1_234_567.0),
            ("1,234,567", '.', 1_234_567.0),
            ("1.004", ',', 1004.0),
        ] {
            assert_eq!(read(text, decimal), Cell::Thousands(number), "{text}");
        }
        for (text, decimal) in [("1.23,5", ','), ("12345.6,7", '.'), ("0.500", ',')] {
            assert_eq!(read(text, decimal), Cell::Other, "{text}");
        }
    }
}
