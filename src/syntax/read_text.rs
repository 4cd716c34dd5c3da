//! Reads the text form. Blocks are found by indentation, then each header and field is parsed
//! separately, so that an error in one line hides no other.

use std::ops::Range;
use std::sync::Arc;

use super::document::{Block, Document, Field, Text};
use super::keys::{Key, Kind, Sort};
use super::lines::{self, Fault};
use super::rules::{self, Form, Reader};
use super::split::{Item, RawBlock, split};
use crate::problem::{Problems, error};
use crate::source::Source;

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

fn read_block(source: &Arc<Source>, raw: RawBlock, reader: &mut Reader<'_>) {
    let place = |range: &Range<usize>, within: &Item| {
        source.span(within.range.start + range.start..within.range.start + range.end)
    };
    let text = raw.header.text(source);
    let (header, fault) = lines::header(&text);
    let fault = fault.filter(|_| !raw.header.unclosed);
    let Some(mut header) = header else {
        if let Some(fault) = fault {
            report(reader, source, raw.header.range.start, fault);
        }
        return;
    };
    let word = rules::exact(place(&header.kind, &raw.header));
    let Some(kind) = reader.kind(&word.text, &word.span) else { return };
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
            report(reader, source, raw.header.range.start, fault);
        }
        None => {}
    }
    let kind = kind.with_name(header.name.is_some());
    let title = header.title.map(|range| unquote(&[range], &text, &raw.header, source, reader));
    let mut comments = raw.header.comments.clone();
    comments.after = raw.after;
    let mut block = Block {
        kind: Text { text: kind.word.to_owned(), exact: word.text == kind.word, span: word.span },
        name: header.name.map(|range| rules::exact(place(&range, &raw.header))),
        title,
        fields: Vec::new(),
        comments,
    };
    for item in &raw.fields {
        if let Some((key, field)) = read_field(source, item, kind, reader) {
            reader.field(kind, key, &mut block, field);
        }
    }
    reader.block(kind, block);
}

fn read_field(
    source: &Arc<Source>,
    item: &Item,
    kind: &'static Kind,
    reader: &mut Reader<'_>,
) -> Option<(&'static Key, Field)> {
    let text = item.text(source);
    let start = item.range.start;
    let places = match lines::words(&text) {
        Ok(places) => places,
        Err(fault) => {
            report(reader, source, start, fault);
            return None;
        }
    };
    let words: Vec<&str> = places.iter().map(|range| &text[range.clone()]).collect();
    let (key, count) = match rules::key(kind, &words) {
        Some(found) => found,
        None => {
            let first = source.span(start + places.first()?.start..start + places.first()?.end);
            reader.unknown_field(kind, &words, &first)?
        }
    };
    let head = places.first()?.start..places.get(count - 1)?.end;
    let mut value = head.end;
    value += blanks(&text[value..]);
    if text[value..].starts_with([':', '=']) {
        reader.problems.push(error(
            "unexpected-text",
            format!("`{}` must be followed directly by its value", &text[head.clone()]),
            &source.span(start + value..start + value + 1),
        ));
        value += 1;
        value += blanks(&text[value..]);
    }
    let key_text = Text {
        text: key.word.to_owned(),
        exact: key.word == &text[head.clone()],
        span: source.span(start + head.start..start + head.end),
    };
    let value = match key.sort {
        Sort::Phrase => Text {
            text: text[value..].to_owned(),
            span: source.span(start + value..item.range.end),
            exact: true,
        },
        Sort::Text => read_prose(value, &text, item, source, key, reader),
    };
    Some((key, Field { key: key_text, value, comments: item.comments.clone() }))
}

fn blanks(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// The value of a text field: quoted pieces in a row.
fn read_prose(
    from: usize,
    text: &str,
    item: &Item,
    source: &Arc<Source>,
    key: &Key,
    reader: &mut Reader<'_>,
) -> Text {
    let rest = &text[from..];
    let at = source.span(item.range.start + from..item.range.end);
    let bare = |text: &str| Text { text: text.to_owned(), span: at.clone(), exact: true };
    if rest.is_empty() {
        return bare("");
    }
    if !rest.starts_with('"') {
        let help = || {
            format!(
                "{} {}",
                key.word,
                rules::quoted(&rest.split_whitespace().collect::<Vec<_>>().join(" "))
            )
        };
        reader.problems.push(
            error("missing-quotes", format!("the text of `{}` has no quotes", key.word), &at)
                .help(lines::slip(rest).unwrap_or_else(help)),
        );
        return bare(rest);
    }
    match lines::prose(rest) {
        Ok(pieces) => {
            let pieces: Vec<Range<usize>> =
                pieces.into_iter().map(|piece| from + piece.start..from + piece.end).collect();
            unquote(&pieces, text, item, source, reader)
        }
        Err(fault) => {
            if !item.unclosed {
                report(reader, source, item.range.start + from, fault);
            }
            bare(rest.trim_matches('"'))
        }
    }
}

/// The text without quotes and escapes; pieces are joined by a blank.
fn unquote(
    pieces: &[Range<usize>],
    text: &str,
    item: &Item,
    source: &Arc<Source>,
    reader: &mut Reader<'_>,
) -> Text {
    let start = item.range.start;
    let mut out = String::new();
    let mut plain = pieces.len() == 1;
    for (count, piece) in pieces.iter().enumerate() {
        if count > 0 {
            out.push(' ');
        }
        let inner = piece.start + 1..piece.end.saturating_sub(1).max(piece.start + 1);
        let mut chars = text[inner.clone()].char_indices();
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
                    let from = start + inner.start + at;
                    reader.problems.push(
                        error(
                            "unknown-escape",
                            "in quotes, a backslash must be followed by `\"`, `\\` or `n`",
                            &source.span(from..from + 1 + c.map_or(0, char::len_utf8)),
                        )
                        .help("write a backslash as \\\\"),
                    );
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
    Text { text: out, span: source.span(start + whole.start..start + whole.end), exact: plain }
}

fn report(reader: &mut Reader<'_>, source: &Arc<Source>, offset: usize, fault: Fault) {
    let mut problem = error(
        "unexpected-text",
        fault.says,
        &source.span(offset + fault.at.start..offset + fault.at.end),
    );
    problem.help = fault.help;
    reader.problems.push(problem);
}
