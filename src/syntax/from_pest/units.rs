//! Units in phrases. The grammar cannot look into the table of units: what follows a number and is
//! in the table is marked before a phrase is parsed.

use crate::units::{SYMBOLS, number_end};

/// Stands for each byte of a unit, so that all places stay as they are.
const MARK: u8 = 1;

/// The text with marks in place of each unit that follows a number: `m/s^2` in `2.5 m/s^2`.
pub(super) fn marked(text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let mut at = 0;
    while let Some(digit) = text[at..].find(|c: char| c.is_ascii_digit()) {
        let number = at + digit;
        let end = number + number_end(&text[number..]);
        let unit = end + text[end..].len() - text[end..].trim_start().len();
        let in_name = text[..number].ends_with(|c: char| is_word(c) || c == '.');
        at = if in_name { end } else { unit + unit_end(&text[unit..]) };
        bytes[unit.min(at)..at].fill(MARK);
    }
    String::from_utf8(bytes).unwrap_or_else(|_| text.to_string())
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The end of the unit at the start of a text: known symbols with their powers, without blanks. 0 if
/// there is none.
fn unit_end(text: &str) -> usize {
    let (mut end, mut from) = (0, if text.starts_with("1/") { 2 } else { 0 });
    loop {
        let word = |c: char| is_word(c) || "µΩ°%‰".contains(c);
        let symbol =
            &text[from..from + text[from..].find(|c| !word(c)).unwrap_or(text.len() - from)];
        let is_symbol = !symbol.starts_with(|c: char| c.is_ascii_digit())
            && SYMBOLS.iter().any(|known| known.symbol == symbol);
        if !is_symbol {
            return end;
        }
        end = from + symbol.len();
        end += power(&text[end..]);
        match text[end..].chars().next().filter(|c| matches!(c, '/' | '*' | '·')) {
            Some(operator) => from = end + operator.len_utf8(),
            None => return end,
        }
    }
}

/// The length of the power at the start of a text: `^-2`, `²`, `^1.5`, `^(1/3)`.
fn power(text: &str) -> usize {
    if text.starts_with(['²', '³']) {
        return '²'.len_utf8();
    }
    let Some(exponent) = text.strip_prefix('^') else { return 0 };
    let sign = usize::from(exponent.starts_with('-'));
    let number = number_end(&exponent[sign..]);
    if exponent[sign..].starts_with(|c: char| c.is_ascii_digit()) {
        return 1 + sign + number;
    }
    let within = |c: char| c.is_ascii_digit() || matches!(c, '-' | '/' | '.' | ' ');
    let fraction = exponent.strip_prefix('(').map(|inner| inner.trim_start_matches(within));
    match fraction.filter(|rest| rest.starts_with(')')) {
        Some(rest) => text.len() - rest.len() + 1,
        None => 0,
    }
}
