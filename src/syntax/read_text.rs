//! Reads the text form. Blocks are found by indentation, then each header and field is parsed
//! separately, so that an error in one line hides no other.

use std::{ops::Range, sync::Arc};

use super::{
    document::{Block, Document, Field, Text},
    keys::{Key, Kind, Sort},
    layout,
    lines::{self, Fault},
    phrase::normalised,
    rules::{self, Form, Reader},
    split::{Item, RawBlock, split},
};
use crate::problem::{Problem, Problems, error, problem};
use crate::source::{Source, Span};

/// Reads the text form. Unknown or duplicate blocks and fields are left out after a problem. One
/// with a slightly misspelt word is read as the similar one.
pub fn read_text(source: &Arc<Source>, problems: &mut Problems) -> Document {
    let earlier = problems.0.len();
    let parts = split(source, problems);
    let mut reader = Reader::new(Form::Lines, problems);
    for block in parts.blocks {
        read_block(source, block, &mut reader);
    }
    let blocks = reader.finish();
    rules::in_reading_order(problems, earlier);
    Document {
        source: Arc::clone(source),
        leading: parts.leading,
        blocks,
        trailing: parts.trailing,
    }
}

/// A header or a field as it is read: its text, and where this stands in the source.
struct Written<'a> {
    source: &'a Arc<Source>,
    item: &'a Item,
    text: String,
}

impl<'a> Written<'a> {
    fn new(source: &'a Arc<Source>, item: &'a Item) -> Self {
        Self { source, item, text: item.text(source) }
    }

    fn span(&self, range: &Range<usize>) -> Span {
        let start = self.item.range.start;
        self.source.span(start + range.start..start + range.end)
    }

    /// The text from here to its end.
    fn rest(&self, from: usize) -> Text {
        let span = self.source.span(self.item.range.start + from..self.item.range.end);
        Text { text: self.text[from..].to_owned(), span, exact: true }
    }

    fn fault(&self, fault: Fault) -> Problem {
        error("unexpected-text", fault.says, &self.span(&fault.at)).help_if(fault.help)
    }
}

fn read_block(source: &Arc<Source>, raw: RawBlock, reader: &mut Reader<'_>) {
    let written = Written::new(source, &raw.header);
    let text = &written.text;
    let (header, fault) = lines::header(text);
    let fault = fault.filter(|_| !raw.header.unclosed);
    let Some(mut header) = header else {
        reader.problems.add(fault.map(|fault| written.fault(fault)));
        return;
    };
    let word = rules::exact(written.span(&header.kind));
    let Some(kind) = reader.kind(&word.text, &word.span) else { return };
    let beside = text[header.kind.end..].trim();
    let fault = match reader.field_beside(kind, beside) {
        Some(help) => {
            let at = header.kind.end + blanks(&text[header.kind.end..])..text.trim_end().len();
            let says = format!("the fields of `{}` stand below it", kind.word);
            reader.problems.push(error("unexpected-text", says, &written.span(&at)).help(help));
            header.name = None;
            None
        }
        None => fault,
    };
    match fault {
        // If the name continues with characters that a name cannot contain, the whole word is
        // reported.
        Some(fault)
            if header.name.as_ref().map_or(kind.named && header.title.is_none(), |name| {
                name.end == fault.at.start
            }) =>
        {
            header.name = Some(header.name.map_or(fault.at.start, |name| name.start)..fault.at.end);
        }
        Some(mut fault) => {
            let rest = text[fault.at.start..].trim();
            if fault.help.is_none() && header.title.is_none() && !rest.contains('"') {
                fault.help = Some(format!(
                    "write the title in quotes: {} {}",
                    &text[..fault.at.start].trim_end(),
                    rules::quoted(rest)
                ));
            }
            reader.problems.push(written.fault(fault));
        }
        None => {}
    }
    let kind = kind.with_name(header.name.is_some());
    let title = header.title.map(|range| unquote(&[range], &written, reader));
    let mut comments = raw.header.comments(|_| None);
    comments.after = raw.after;
    let mut block = Block {
        kind: Text { text: kind.word.to_owned(), exact: word.text == kind.word, span: word.span },
        name: header.name.map(|range| rules::exact(written.span(&range))),
        title,
        fields: Vec::new(),
        comments,
    };
    for item in &raw.fields {
        if let Some((key, field)) = read_field(&Written::new(source, item), kind, reader) {
            reader.field(kind, key, &mut block, field);
        }
    }
    reader.block(kind, block);
}

fn read_field(
    written: &Written<'_>,
    kind: &'static Kind,
    reader: &mut Reader<'_>,
) -> Option<(&'static Key, Field)> {
    let text = written.text.as_str();
    let places = match lines::words(text) {
        Ok(places) => places,
        Err(fault) => {
            reader.problems.push(written.fault(fault));
            return None;
        }
    };
    let words: Vec<&str> = places.iter().map(|range| &text[range.clone()]).collect();
    let (key, count) = match rules::key(kind, &words) {
        Some(found) => found,
        None => reader.unknown_field(kind, &words, &written.span(places.first()?))?,
    };
    let head = places.first()?.start..places.get(count - 1)?.end;
    let mut value = head.end;
    value += blanks(&text[value..]);
    if text[value..].starts_with([':', '=']) {
        reader.problems.push(problem!(
            "unexpected-text",
            &written.span(&(value..value + 1)),
            "`{}` must be followed directly by its value",
            &text[head.clone()]
        ));
        value += 1;
        value += blanks(&text[value..]);
    }
    let key_text = Text {
        text: key.word.to_owned(),
        exact: key.word == &text[head.clone()],
        span: written.span(&head),
    };
    let from = written.item.range.start + value;
    let value = match key.sort {
        Sort::Phrase => written.rest(value),
        Sort::Text => read_prose(value, written, key, reader),
    };
    let case = |end: usize| {
        let until = value.text.get(..end.checked_sub(from)?)?;
        (key.sort == Sort::Phrase).then(|| layout::cases(until).len().saturating_sub(1))
    };
    let comments = written.item.comments(case);
    Some((key, Field { key: key_text, value, comments }))
}

fn blanks(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// The value of a text field: quoted pieces in a row.
fn read_prose(from: usize, written: &Written<'_>, key: &Key, reader: &mut Reader<'_>) -> Text {
    let at = written.rest(from);
    let rest = at.text.as_str();
    if rest.is_empty() {
        return at;
    }
    if !rest.starts_with('"') {
        let help = || format!("{} {}", key.word, rules::quoted(&normalised(rest)));
        let problem = problem!("missing-quotes", &at, "the text of `{}` has no quotes", key.word);
        reader.problems.push(problem.help(lines::slip(rest).unwrap_or_else(help)));
        return at;
    }
    match lines::prose(rest) {
        Ok(pieces) => {
            let pieces: Vec<Range<usize>> =
                pieces.into_iter().map(|piece| from + piece.start..from + piece.end).collect();
            unquote(&pieces, written, reader)
        }
        Err(mut fault) => {
            fault.at = from + fault.at.start..from + fault.at.end;
            if !written.item.unclosed {
                reader.problems.push(written.fault(fault));
            }
            Text { text: rest.trim_matches('"').to_owned(), ..at }
        }
    }
}

/// The text without quotes and escapes; pieces are joined by a blank.
fn unquote(pieces: &[Range<usize>], written: &Written<'_>, reader: &mut Reader<'_>) -> Text {
    let mut out = String::new();
    let mut plain = pieces.len() == 1;
    for (count, piece) in pieces.iter().enumerate() {
        if count > 0 {
            out.push(' ');
        }
        let inner = piece.start + 1..piece.end.saturating_sub(1).max(piece.start + 1);
        let mut chars = written.text[inner.clone()].char_indices();
        while let Some((at, c)) = chars.next() {
            if c != '\\' {
                out.push(c);
                continue;
            }
            plain = false;
            match chars.next() {
                Some((_, 'n')) => out.push('\n'),
                Some((_, c @ ('"' | '\\'))) => out.push(c),
                other => {
                    let c = other.map(|(_, c)| c);
                    let from = inner.start + at;
                    let place = written.span(&(from..from + 1 + c.map_or(0, char::len_utf8)));
                    let says = "in quotes, a backslash must be followed by `\"`, `\\` or `n`";
                    let problem = error("unknown-escape", says, &place);
                    reader.problems.push(problem.help("write a backslash as \\\\"));
                    out.push('\\');
                    out.extend(c);
                }
            }
        }
    }
    let whole = match pieces {
        [one] if plain => one.start + 1..one.end - 1,
        _ => {
            pieces.first().map_or(0, |piece| piece.start)
                ..pieces.last().map_or(0, |piece| piece.end)
        }
    };
    Text { text: out, span: written.span(&whole), exact: plain }
}
