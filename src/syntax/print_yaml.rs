//! The canonical YAML form.

use super::{
    document::{Block, Document, Field},
    keys::{self, KINDS, Kind, Sort},
    layout::{self, Page, WIDTH, columns},
    spelling::spelled,
};

/// Writes the canonical YAML. Reading it gives the same document in canonical order, and printing
/// that gives the same YAML.
pub fn print_yaml(document: &Document) -> String {
    let document = layout::in_order(document);
    let mut out = Page::default();
    out.comments(0, &document.leading);
    if !document.leading.is_empty() {
        out.blank();
    }
    for kind in KINDS {
        let blocks: Vec<&Block> = document
            .blocks
            .iter()
            .filter(|block| keys::of_block(block).is_some_and(|of| of.group == kind.group))
            .collect();
        if blocks.is_empty() {
            continue;
        }
        out.blank();
        if kind.single {
            blocks.into_iter().for_each(|block| out.single(kind, block));
        } else {
            out.line(0, &format!("{}:", kind.group), None);
            let mut above: Option<&Block> = None;
            for block in blocks {
                if above.is_some_and(|above| {
                    !layout::is_bare(above)
                        || !layout::is_bare(block)
                        || !block.comments.before.is_empty()
                }) {
                    out.blank();
                }
                out.named(kind, block);
                above = Some(block);
            }
        }
    }
    if !document.trailing.is_empty() {
        out.blank();
        out.comments(0, &document.trailing);
    }
    out.text
}

/// The text of a field; a phrase as it is spelled.
fn value(kind: &Kind, field: &Field) -> String {
    match layout::sort(Some(kind), field) {
        Sort::Phrase => spelled(kind.word, &field.key.text, &field.value.text),
        Sort::Text => field.value.text.clone(),
    }
}

impl Page {
    /// A group whose fields are directly below it, as it has a single block.
    fn single(&mut self, kind: &Kind, block: &Block) {
        self.comments(0, &block.comments.before);
        if block.name.is_none() && block.title.is_none() && block.fields.is_empty() {
            self.line(0, &format!("{}: {{}}", kind.group), block.comments.beside.as_deref());
        } else {
            self.line(0, &format!("{}:", kind.group), block.comments.beside.as_deref());
        }
        if let Some(name) = &block.name {
            self.entry(2, "name", Sort::Text, &name.text, None);
        }
        self.body(2, kind, block);
    }

    fn named(&mut self, kind: &Kind, block: &Block) {
        self.comments(2, &block.comments.before);
        let empty = if block.title.is_none() && block.fields.is_empty() { " {}" } else { "" };
        self.line(
            2,
            &format!("{}:{empty}", key(block.name_text())),
            block.comments.beside.as_deref(),
        );
        self.body(4, kind, block);
    }

    fn body(&mut self, indent: usize, kind: &Kind, block: &Block) {
        if let Some(title) = &block.title {
            self.entry(indent, "title", Sort::Text, &title.text, None);
        }
        for fields in block.fields.chunk_by(|one, next| one.key.text == next.key.text) {
            match fields {
                [field] => {
                    self.comments(indent, &field.comments.above());
                    let beside = field.comments.beside.as_deref();
                    self.entry(
                        indent,
                        &field.key.text,
                        layout::sort(Some(kind), field),
                        &value(kind, field),
                        beside,
                    );
                }
                [first, ..] => {
                    self.line(indent, &format!("{}:", first.key.text), None);
                    fields.iter().for_each(|field| self.item(indent + 2, kind, field));
                }
                [] => {}
            }
        }
        self.comments(indent, &block.comments.after);
    }

    fn item(&mut self, indent: usize, kind: &Kind, field: &Field) {
        self.comments(indent, &field.comments.above());
        self.value(
            indent,
            "-",
            layout::sort(Some(kind), field),
            &value(kind, field),
            field.comments.beside.as_deref(),
        );
    }

    fn entry(&mut self, indent: usize, key: &str, sort: Sort, text: &str, beside: Option<&str>) {
        self.value(indent, &format!("{key}:"), sort, text, beside);
    }

    /// A scalar after `key:` or `-`, folded if it is too long for its line.
    fn value(&mut self, indent: usize, head: &str, sort: Sort, text: &str, beside: Option<&str>) {
        let text = if sort == Sort::Phrase { layout::phrase(text) } else { text.to_owned() };
        let written = scalar(&text, sort);
        if indent + columns(head) + 1 + columns(&written) > WIDTH && folds(&text) {
            let room = WIDTH - indent - 2;
            let lines = if sort == Sort::Phrase {
                layout::wrap_phrase(&text, room)
            } else {
                layout::wrap_prose(&text, room)
            };
            if lines.len() > 1 {
                self.line(indent, &format!("{head} >-"), beside);
                lines.iter().for_each(|line| self.line(indent + 2, line, None));
                return;
            }
        }
        self.line(indent, &format!("{head} {written}"), beside);
    }
}

/// Whether a text can be written as a folded block scalar: no line breaks, no leading or trailing
/// blanks, nothing to escape.
fn folds(text: &str) -> bool {
    text.trim() == text && text.chars().all(printable)
}

fn key(name: &str) -> String {
    // A YAML reader can change a number with a point or an exponent: 1.50 becomes 1.5.
    if looks_typed(name) && !is_whole(name) {
        single_quoted(name)
    } else {
        scalar(name, Sort::Phrase)
    }
}

/// The shortest form of a text that YAML 1.2 reads as this text.
fn scalar(text: &str, sort: Sort) -> String {
    if !text.chars().all(printable) {
        return double_quoted(text);
    }
    // A phrase is used as it is written, so its numbers need no quotes.
    let typed = looks_typed(text) && !(sort == Sort::Phrase && is_decimal(text));
    if typed || !is_plain(text) { single_quoted(text) } else { text.to_owned() }
}

fn printable(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{feff}' | '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}')
}

/// Whether a text can be written without quotes in a block collection.
fn is_plain(text: &str) -> bool {
    let mut chars = text.chars();
    let Some(first) = chars.next() else { return false };
    let second = chars.next();
    let starts = match first {
        '-' | '?' | ':' => second.is_some_and(|c| c != ' '),
        ',' | '[' | ']' | '{' | '}' | '#' | '&' | '*' | '!' | '|' | '>' | '\'' | '"' | '%'
        | '@' | '`' => false,
        _ => true,
    };
    starts
        && text.trim() == text
        && !text.ends_with(':')
        && !text.contains(": ")
        && !text.contains(" #")
        && !text.starts_with("---")
        && !text.starts_with("...")
}

/// Whether a YAML reader would read the plain text as something other than a text.
fn looks_typed(text: &str) -> bool {
    // Numbers in any base, dates and times. Unnecessary quotes do no harm.
    let number = || {
        let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
        digits.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            && text.chars().all(|c| c.is_ascii_hexdigit() || "xXoOinIN._+-:TtZz".contains(c))
    };
    matches!(text.to_ascii_lowercase().as_str(), "" | "~" | "null" | "true" | "false" | "<<" | "=")
        || number()
}

fn is_whole(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
        && (text == "0" || !text.starts_with('0'))
        && text.len() < 16
}

/// Decimal numbers such as `2` and `-1.50`.
fn is_decimal(text: &str) -> bool {
    let text = text.strip_prefix('-').unwrap_or(text);
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    is_whole(whole)
        && !whole.is_empty()
        && !fraction.is_empty()
        && fraction.bytes().all(|byte| byte.is_ascii_digit())
}

fn single_quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

fn double_quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if printable(c) => out.push(c),
            c if u32::from(c) <= 0xff => out.push_str(&format!("\\x{:02x}", u32::from(c))),
            c => out.push_str(&format!("\\u{:04x}", u32::from(c))),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checked with an independent YAML reader: each written scalar is read as the text.
    #[test]
    fn scalars_load_as_their_text() {
        let texts = [
            "",
            " a",
            "a ",
            "a: b",
            "a:b",
            "a #b",
            "a#b",
            "- a",
            "-a",
            "-3 %",
            "|p| - |q|",
            "true",
            "No",
            "null",
            "~",
            "1",
            "1.50",
            "1e3",
            "0x1F",
            ".5",
            ".inf",
            "2016-01-01",
            "[a]",
            "a, b",
            "{a}",
            "it's",
            "\"q\"",
            "'q'",
            "a\nb",
            "a\tb",
            "\u{7}",
            "\u{feff}",
            "\u{2028}",
            "---",
            "--- a",
            "%x",
            "@x",
            "`x`",
            "*x",
            "&x",
            "!x",
            ">x",
            "x:",
            "?",
            "? x",
            "?x",
            ":x",
            "=",
            "<<",
            "Größe \u{1f682}",
            "\\n",
            "12:30:00",
            "1_000",
            "+1",
            "-.5",
            "...",
        ];
        for text in texts {
            let written = format!("key: {}\n", scalar(text, Sort::Text));
            let read: serde_yaml::Value =
                serde_yaml::from_str(&written).unwrap_or_else(|error| panic!("{written}: {error}"));
            assert_eq!(read["key"].as_str(), Some(text), "{written}");
        }
    }

    #[test]
    fn numbers_in_phrases_need_no_quotes() {
        for text in ["2", "1.50", "-3", "20 Hz", "2/3", "n-1"] {
            assert_eq!(scalar(text, Sort::Phrase), text);
        }
        assert_eq!(scalar("1e3", Sort::Phrase), "'1e3'");
        assert_eq!(
            (key("1"), key("1.5"), key("null")),
            ("1".into(), "'1.5'".into(), "'null'".into())
        );
    }
}
