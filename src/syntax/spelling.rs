//! The spelling of phrases in canonical text: blanks about signs, commas before joining words, signs
//! and numbers of which there are several forms.
//!
//! Units stay as they are written: `400 mm/s^2` is not made `0.4 m/s^2`.

use super::{document::Text, from_pest::is_word_of_language, layout, meaning::same_meaning};
use crate::source::Source;
use crate::units::Unit;

/// Fields with phrases of the grammar. In others, a sign may be a part of a name.
const SPELLED: [&str; 36] = [
    "alias",
    "at",
    "axis",
    "default",
    "difference",
    "filter",
    "found",
    "holds",
    "in",
    "is",
    "lead",
    "length",
    "limit",
    "margin",
    "members",
    "metric",
    "minimum",
    "minimum length",
    "minimum pairs",
    "minimum sections",
    "minimum signals",
    "of",
    "one of",
    "over",
    "prefer",
    "range",
    "report",
    "require",
    "slope",
    "step",
    "tail",
    "time",
    "unless",
    "validated",
    "value",
    "where",
];

/// A phrase of a field on one line, spelled as the language reference spells it. A spelling that
/// would change the meaning, or whose meaning cannot be read, stays.
pub fn spelled(kind: &str, key: &str, text: &str) -> String {
    let written = layout::phrase(text);
    // A choice such as `n-1` is no expression.
    let word = key == "default" && written.starts_with(|c: char| c.is_alphabetic());
    if kind == "remove" || !SPELLED.contains(&key) || word {
        return written;
    }
    let spelled = Speller::spell(&tokens(&written), key);
    let read = |text: &str| Text {
        span: Source::new("", text).whole(),
        text: text.to_owned(),
        exact: true,
    };
    if spelled != written && same_meaning(kind, key, &read(&written), &read(&spelled)) {
        spelled
    } else {
        written
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sort {
    Number,
    /// A name, a word of the language, or a unit.
    Word,
    Quoted,
    Sign,
}

#[derive(Clone, Copy, Debug)]
struct Token<'a> {
    sort: Sort,
    text: &'a str,
    /// Whether a blank is written before it.
    apart: bool,
}

fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let apart = first == ' ';
        at += usize::from(apart);
        let rest = &text[at..];
        let of_word = |c: char| {
            c.is_alphanumeric() && !matches!(c, '²' | '³')
                || matches!(c, '_' | '{' | '}' | '.' | '%' | '°' | '‰')
        };
        let (sort, length) = match rest.chars().next() {
            None => break,
            Some('"') => {
                let mut quotes = layout::Quotes::default();
                let end = rest.find(|c| {
                    quotes.pass(c);
                    !quotes.inside
                });
                (Sort::Quoted, end.map_or(rest.len(), |end| end + 1))
            }
            Some(c) if c.is_ascii_digit() => match crate::units::number_end(rest) {
                // `1R` is a position and `4a` a zone.
                end if rest[end..].starts_with(of_word) && unit_at(&rest[end..]).is_none() => {
                    (Sort::Word, rest.find(|c| !of_word(c)).unwrap_or(rest.len()))
                }
                end => (Sort::Number, end),
            },
            Some(c) if of_word(c) => (Sort::Word, word_end(rest, of_word)),
            Some(_) if rest.starts_with("<=") || rest.starts_with(">=") => (Sort::Sign, 2),
            Some(c) => (Sort::Sign, c.len_utf8()),
        };
        found.push(Token { sort, text: &rest[..length], apart });
        at += length;
    }
    found
}

/// The end of a word; a hyphen between letters belongs to it.
fn word_end(text: &str, of_word: impl Fn(char) -> bool) -> usize {
    let mut end = 0;
    loop {
        end += text[end..].find(|c| !of_word(c)).unwrap_or(text.len() - end);
        let next = text[end..].strip_prefix('-').and_then(|rest| rest.chars().next());
        if !next.is_some_and(char::is_alphabetic) {
            return end;
        }
        end += 1;
    }
}

/// The unit at the start of a text, without its signs.
fn unit_at(text: &str) -> Option<&str> {
    let end = text.find(|c: char| !(c.is_alphanumeric() || matches!(c, '%' | '°' | '‰')));
    let word = &text[..end.unwrap_or(text.len())];
    is_unit(word).then_some(word)
}

fn is_unit(word: &str) -> bool {
    Unit::parse(word).is_ok()
}

/// The part of a phrase that is written so far.
#[derive(Debug)]
struct Speller {
    out: String,
    /// For each parenthesis that is open, and for the whole, how many bars are open in it.
    bars: Vec<usize>,
    before: Sort,
    /// Whether a value ends here, which a sign joins to the next one.
    value: bool,
    /// Whether the next token stands without a blank: behind `(`, or the sign of a number.
    tight: bool,
}

impl Speller {
    fn spell(tokens: &[Token<'_>], key: &str) -> String {
        let mut speller = Self {
            out: String::new(),
            bars: vec![0],
            before: Sort::Sign,
            value: false,
            tight: true,
        };
        for (index, token) in tokens.iter().enumerate() {
            // The bound of `mean -3 kN` and of `between -3 kN` has a sign of its own.
            let bound = index == 1 || index > 1 && tokens[index - 1].text == "between";
            speller.value &= !(key == "limit" && bound && token.text == "-");
            speller.add(*token, tokens.get(index + 1));
        }
        speller.out
    }

    fn add(&mut self, token: Token<'_>, next: Option<&Token<'_>>) {
        self.join(token);
        let sign = if token.sort == Sort::Sign { token.text } else { "" };
        // `2/3`, `Q0/kN`, `kN*m`: numbers, and units behind a name or a number.
        let ratio = next.is_some_and(|next| match next.sort {
            Sort::Number => self.before == Sort::Number && sign == "/",
            Sort::Word => {
                is_unit(next.text)
                    && self.before != Sort::Sign
                    && (sign == "/" || !token.apart && self.before == Sort::Word)
            }
            _ => false,
        });
        let closes = sign == "|" && self.value && self.bars.last().is_some_and(|open| *open > 0);
        let glued = match sign {
            ")" | "," | ";" | ":" | "^" | "²" | "³" => true,
            "|" => closes,
            // A call stands at its parenthesis.
            "(" => self.value && self.before == Sort::Word && !token.apart,
            "/" | "*" | "·" => ratio,
            _ => false,
        };
        if !(glued || self.tight) {
            self.out.push(' ');
        }
        self.out.push_str(&match sign {
            "≤" => "<=".into(),
            "≥" => ">=".into(),
            "·" => "*".into(),
            "−" => "-".into(),
            "²" => "^2".into(),
            "³" => "^3".into(),
            _ if token.sort == Sort::Number => short(token.text),
            _ => token.text.to_owned(),
        });
        match sign {
            "(" => self.bars.push(0),
            ")" if self.bars.len() > 1 => drop(self.bars.pop()),
            "|" => {
                if let Some(open) = self.bars.last_mut() {
                    *open = if closes { *open - 1 } else { *open + 1 };
                }
            }
            _ => {}
        }
        self.tight = match sign {
            "(" | "^" => true,
            "|" => !closes,
            "-" | "−" => !self.value,
            "/" | "*" | "·" => glued,
            _ => false,
        };
        self.before = token.sort;
        self.value = match token.sort {
            Sort::Sign => closes || matches!(sign, ")" | "²" | "³"),
            Sort::Word => !joins(token.text),
            Sort::Number | Sort::Quoted => true,
        };
    }

    /// A comma stands before some joining words, and none before others.
    fn join(&mut self, token: Token<'_>) {
        if self.bars.len() > 1 || token.sort != Sort::Word || self.out.is_empty() {
            return;
        }
        let comma = self.out.ends_with(',');
        match token.text {
            "doubled" | "times" | "otherwise" | "then" if !comma => self.out.push(','),
            "only" | "for" if comma => drop(self.out.pop()),
            _ => {}
        }
    }
}

/// Whether a word joins values and is none.
fn joins(word: &str) -> bool {
    const VALUES: [&str; 4] = ["true", "false", "simulated", "measured"];
    const MORE: [&str; 5] = ["where", "over", "by", "in", "most"];
    is_word_of_language(word) && !VALUES.contains(&word) || MORE.contains(&word)
}

/// A number without zeros at the end of its decimals: `1` for `1.0`.
fn short(number: &str) -> String {
    if !number.contains('.') || number.contains(['e', 'E']) {
        return number.to_owned();
    }
    number.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_spelling_for_one_meaning() {
        for (kind, key, written, wanted) in [
            ("quantity", "of", "Y  at wheelsets 1,3", "Y at wheelsets 1, 3"),
            ("quantity", "of", "{ch} at wheelsets 1,3", "{ch} at wheelsets 1, 3"),
            ("quantity", "limit", "std 1.0 kN", "std 1 kN"),
            ("quantity", "limit", "std 9kN,only when a is b", "std 9 kN only when a is b"),
            ("quantity", "limit", "std 9 kN doubled when soft", "std 9 kN, doubled when soft"),
            (
                "quantity",
                "limit",
                "each 9 kN when v>120 km/h,8 kN when v ≥ 100km/h otherwise 7 kN",
                "each 9 kN when v > 120 km/h, 8 kN when v >= 100 km/h, otherwise 7 kN",
            ),
            ("quantity", "limit", "(mean+3*std) 12 kN", "(mean + 3 * std) 12 kN"),
            ("quantity", "limit", "mean at least -3 kN", "mean at least -3 kN"),
            ("quantity", "limit", "mean -3 kN", "mean -3 kN"),
            ("quantity", "limit", "mean between - 3 kN and -1kN", "mean between -3 kN and -1 kN"),
            ("quantity", "limit", "std 4 kN*(1+0.010*Q0 / kN)", "std 4 kN * (1 + 0.01 * Q0/kN)"),
            ("quantity", "limit", "mean 2 / 3 of std", "mean 2/3 of std"),
            ("quantity", "difference", "|simulated|-|measured|", "|simulated| - |measured|"),
            ("quantity", "value", "larger of |p0.15|,|p99.85|", "larger of |p0.15|, |p99.85|"),
            ("quantity", "value", "- p0.15", "-p0.15"),
            ("quantity", "filter", "LP20 then low-pass 2.50 Hz", "LP20, then low-pass 2.5 Hz"),
            ("quantity", "metric", "sprague-geers magnitude", "sprague-geers magnitude"),
            ("signal", "is", "||a|-b|*sqrt( c )", "||a| - b| * sqrt(c)"),
            ("signal", "is", "a/b - c²", "a / b - c^2"),
            ("channel", "in", "m/s²", "m/s^2"),
            ("define", "is", "1 kN*m", "1 kN*m"),
            // Not read as an expression: these stay.
            ("verdict", "standard deviation", "n-1", "n-1"),
            ("protocol", "extends", "en14363-2016-annex-t", "en14363-2016-annex-t"),
            ("place", "members", "1.0,2", "1.0,2"),
            ("quantity", "of", "Y + ,Q", "Y + ,Q"),
        ] {
            assert_eq!(spelled(kind, key, written), wanted);
            assert_eq!(spelled(kind, key, wanted), wanted, "again");
        }
    }
}
