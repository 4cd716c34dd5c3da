//! Common layout of both printed forms: canonical order, blanks inside phrases, line breaks of long
//! values.

use super::{
    document::{Block, Document, Field},
    keys::{self, KINDS, Kind, Sort},
};

/// Preferred largest width of a printed line, in columns.
pub const WIDTH: usize = 110;

/// The document with blocks in the order of [`KINDS`] and fields in the order of the keys of their
/// kind. The sort is stable.
pub fn in_order(document: &Document) -> Document {
    let mut document = document.clone();
    let place = |kind: &Kind| KINDS.iter().position(|known| known.group == kind.group);
    document
        .blocks
        .sort_by_key(|block| keys::of_block(block).and_then(place).unwrap_or(usize::MAX));
    for block in &mut document.blocks {
        if let Some(kind) = keys::of_block(block) {
            block
                .fields
                .sort_by_key(|field| rank(kind.keys.iter().map(|key| key.word), &field.key.text));
        }
    }
    document
}

/// Index of a word in a table; words that are not in it come last.
fn rank<'a>(table: impl Iterator<Item = &'a str>, word: &str) -> usize {
    table.into_iter().position(|known| known == word).unwrap_or(usize::MAX)
}

pub fn sort(kind: Option<&Kind>, field: &Field) -> Sort {
    kind.and_then(|kind| kind.key(&field.key.text)).map_or(Sort::Phrase, |key| key.sort)
}

/// Whether a block has only its first line.
pub fn is_bare(block: &Block) -> bool {
    block.fields.is_empty() && block.comments.after.is_empty()
}

/// Blanks between words. Any other one, such as a no-break space, is an error that a change of form
/// must keep.
fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\r' | '\n')
}

/// A phrase on one line, with single blanks outside quotes.
pub fn phrase(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut quoted = Quotes::default();
    for c in text.trim_matches(is_blank).chars() {
        let inside = quoted.inside;
        quoted.pass(c);
        if matches!(c, '\n' | '\r') || is_blank(c) && !inside {
            // A line break inside quotes separates words like a blank.
            if !out.ends_with(' ') {
                out.push(' ');
            }
        } else {
            out.push(c);
        }
    }
    out
}

/// Tracks whether a place in a phrase is inside quotes, and in how many parentheses.
#[derive(Debug, Default)]
pub struct Quotes {
    pub inside: bool,
    escaped: bool,
    depth: usize,
}

impl Quotes {
    pub fn pass(&mut self, c: char) {
        if self.escaped {
            self.escaped = false;
        } else if c == '"' {
            self.inside = !self.inside;
        } else if self.inside {
            self.escaped = c == '\\';
        } else if c == '(' {
            self.depth += 1;
        } else if c == ')' {
            self.depth = self.depth.saturating_sub(1);
        }
    }

    /// Whether the place is inside quotes or parentheses.
    pub fn open(&self) -> bool {
        self.inside || self.depth > 0
    }
}

/// Breaks a phrase with single blanks into lines of at most `width` characters where possible,
/// after commas and before joining words. Cases that do not fit on one line have a line each.
/// Joined by blanks, the lines give the phrase again.
pub fn wrap_phrase(phrase: &str, width: usize) -> Vec<String> {
    if columns(phrase) <= width {
        return vec![phrase.to_owned()];
    }
    arms(phrase).iter().flat_map(|arm| wrap_arm(arm, width)).collect()
}

/// The cases of a phrase as it is written, each `... when ...,`; the whole phrase if it has none.
pub fn cases(text: &str) -> Vec<String> {
    arms(&phrase(text))
}

/// The lines of a phrase with comments beside its cases: each case begins a line, with the index of
/// its case.
pub fn wrap_cases(phrase: &str, width: usize) -> Vec<(Option<usize>, String)> {
    let lines = |(case, arm): (usize, &String)| {
        let lines = wrap_arm(arm, width).into_iter().enumerate();
        lines.map(|(line, text)| ((line == 0).then_some(case), text)).collect::<Vec<_>>()
    };
    arms(phrase).iter().enumerate().flat_map(lines).collect()
}

/// The cases of a phrase, each `... when ...,`; the whole phrase if it has none.
fn arms(phrase: &str) -> Vec<String> {
    let mut arms: Vec<String> = Vec::new();
    let mut quotes = Quotes::default();
    let (mut conditional, mut over) = (false, true);
    for word in phrase.split(' ') {
        let outside = !quotes.open();
        match arms.last_mut() {
            Some(arm) if !over => {
                arm.push(' ');
                arm.push_str(word);
            }
            _ => {
                arms.push(word.to_owned());
                conditional = false;
            }
        }
        conditional |= outside && word == "when";
        word.chars().for_each(|c| quotes.pass(c));
        over = conditional && !quotes.open() && word.ends_with(',');
    }
    arms
}

/// Text in parentheses stays together if it fits on a line.
fn wrap_arm(phrase: &str, width: usize) -> Vec<String> {
    let mut segments: Vec<String> = Vec::new();
    let mut quotes = Quotes::default();
    let mut start = 0;
    for word in phrase.split(' ') {
        let joins = matches!(word, "and" | "or" | "when" | "otherwise" | "then");
        match segments.last_mut() {
            Some(last) if quotes.open() || !(last.ends_with(',') || joins) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => segments.push(word.to_owned()),
        }
        for (at, c) in word.char_indices() {
            quotes.pass(c);
            // If parentheses are too long for a line, the inner ones are tried.
            let opens = c == '(' && !quotes.inside && quotes.depth == 1;
            if opens && !parens_fit(&phrase[start + at..], width) {
                quotes.depth = 0;
            }
        }
        start += word.len() + 1;
    }
    fill(segments, width)
}

/// Whether the parentheses at the start of a text have at most `width` columns.
fn parens_fit(text: &str, width: usize) -> bool {
    let mut quotes = Quotes::default();
    text.chars().take(width).any(|c| {
        quotes.pass(c);
        quotes.depth == 0
    })
}

/// Breaks prose at single blanks. Joined by blanks, the lines give the prose again.
pub fn wrap_prose(text: &str, width: usize) -> Vec<String> {
    let mut segments: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match segments.last_mut() {
            // Two blanks in a row, or a line break next to a blank, are kept together.
            Some(last)
                if word.is_empty()
                    || word.starts_with(char::is_whitespace)
                    || last.ends_with(char::is_whitespace)
                    || last.is_empty() =>
            {
                last.push(' ');
                last.push_str(word);
            }
            _ => segments.push(word.to_owned()),
        }
    }
    fill(segments, width)
}

/// Puts as many segments on each line as fit.
fn fill(segments: Vec<String>, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for segment in segments {
        match lines.last_mut() {
            Some(line) if columns(line) + 1 + columns(&segment) <= width => {
                line.push(' ');
                line.push_str(&segment);
            }
            _ => lines.push(segment),
        }
    }
    lines
}

pub fn columns(text: &str) -> usize {
    text.chars().count()
}

/// A document that is printed line by line.
#[derive(Debug, Default)]
pub struct Page {
    pub text: String,
}

impl Page {
    /// Comments on lines of their own.
    pub fn comments(&mut self, indent: usize, comments: &[String]) {
        comments.iter().for_each(|text| self.line(indent, &comment(text), None));
    }

    /// A line with the comment beside it.
    pub fn line(&mut self, indent: usize, text: &str, beside: Option<&str>) {
        self.text.extend(std::iter::repeat_n(' ', indent));
        self.text.push_str(text);
        if let Some(beside) = beside {
            self.text.push_str("  ");
            self.text.push_str(&comment(beside));
        }
        self.text.push('\n');
    }

    /// A blank line, except at the top and after another blank line.
    pub fn blank(&mut self) {
        if !self.text.is_empty() && !self.text.ends_with("\n\n") {
            self.text.push('\n');
        }
    }
}

/// A comment for its own line or the end of a line. Characters that YAML does not allow (YAML
/// 1.2.2, section 5.1) are replaced in both forms.
fn comment(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' | '\r' => ' ',
        '\t' => c,
        '\u{feff}' | '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
        c if c.is_control() => '\u{fffd}',
        c => c,
    };
    let text: String = text.chars().map(shown).collect();
    match text.chars().next() {
        None | Some('#') => format!("#{text}"),
        Some(_) => format!("# {text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_are_single_outside_quotes_only() {
        assert_eq!(phrase("std  9\n   kN of \"a  b\" "), "std 9 kN of \"a  b\"");
        assert_eq!(phrase("1.1 *\u{c}x  \u{a0}y"), "1.1 *\u{c}x \u{a0}y");
    }

    #[test]
    fn a_long_phrase_breaks_at_commas_and_joining_words() {
        let lines =
            wrap_phrase("low-pass 20 Hz, order 4 when a is \"x, y\" and b, otherwise none", 24);
        assert_eq!(
            lines,
            ["low-pass 20 Hz, order 4", "when a is \"x, y\" and b,", "otherwise none"]
        );
    }

    #[test]
    fn cases_have_a_line_each() {
        let lines =
            wrap_phrase("larger of a, b when c, d when (e, f) or g, otherwise larger of h, i", 30);
        assert_eq!(
            lines,
            ["larger of a, b when c,", "d when (e, f) or g,", "otherwise larger of h, i"]
        );
    }

    #[test]
    fn parentheses_stay_together_where_they_fit() {
        let lines = wrap_phrase(
            "a, b in (Y, side and wheel), (Q, (x, y)), (much, too, long, for, one, line)",
            22,
        );
        assert_eq!(
            lines,
            [
                "a,",
                "b in (Y, side and wheel),",
                "(Q, (x, y)), (much,",
                "too, long, for, one,",
                "line)"
            ]
        );
    }

    #[test]
    fn prose_joins_again() {
        for text in ["a b  c d", " a ", "", "a \n b", "one two three"] {
            assert_eq!(wrap_prose(text, 1).join(" "), text);
        }
    }
}
