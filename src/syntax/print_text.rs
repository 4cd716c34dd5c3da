//! The canonical text form.

use super::{
    document::{Block, Document, Field},
    keys::{self, Sort},
    layout::{self, Page, WIDTH, columns},
    rules::quoted,
    spelling::spelled,
};

const INDENT: usize = 2;

/// Writes the canonical text. Reading it gives the same document in canonical order, and printing
/// that gives the same text.
pub fn print_text(document: &Document) -> String {
    let document = layout::in_order(document);
    let mut out = Page::default();
    out.comments(0, &document.leading);
    if !document.leading.is_empty() {
        out.text.push('\n');
    }
    let mut above: Option<&Block> = None;
    for block in &document.blocks {
        let together = above.is_some_and(|above| {
            above.kind == block.kind
                && layout::is_bare(above)
                && layout::is_bare(block)
                && block.comments.before.is_empty()
        });
        if above.is_some() && !together {
            out.text.push('\n');
        }
        print_block(block, &mut out);
        above = Some(block);
    }
    if above.is_some() && !document.trailing.is_empty() {
        out.text.push('\n');
    }
    out.comments(0, &document.trailing);
    out.text
}

fn print_block(block: &Block, out: &mut Page) {
    out.comments(0, &block.comments.before);
    let mut header = block.kind.text.clone();
    if let Some(name) = &block.name {
        header = format!("{header} {}", name.text);
    }
    if let Some(title) = &block.title {
        header = format!("{header} {}", quoted(&title.text));
    }
    out.line(0, &header, block.comments.beside.as_deref());
    let column = block.fields.iter().map(|field| columns(&field.key.text)).max().unwrap_or(0);
    for field in &block.fields {
        print_field(block, field, column, out);
    }
    out.comments(INDENT, &block.comments.after);
}

fn print_field(block: &Block, field: &Field, column: usize, out: &mut Page) {
    out.comments(INDENT, &field.comments.before);
    let room = WIDTH.saturating_sub(2 * INDENT + column);
    let plain = |lines: Vec<String>| lines.into_iter().map(|line| (None, line)).collect();
    let lines: Vec<(Option<usize>, String)> = match layout::sort(keys::of_block(block), field) {
        Sort::Phrase => {
            let phrase = spelled(&block.kind.text, &field.key.text, &field.value.text);
            match field.comments.rows.is_empty() {
                true => plain(layout::wrap_phrase(&phrase, room)),
                false => layout::wrap_cases(&phrase, room),
            }
        }
        // Quotes take two columns. Escapes are rare and may exceed the width.
        Sort::Text => {
            let pieces = layout::wrap_prose(&field.value.text, room.saturating_sub(2));
            plain(pieces.iter().map(|piece| quoted(piece)).collect())
        }
    };
    let mut head = format!("{:column$}", field.key.text);
    let mut beside = field.comments.beside.as_deref();
    for (case, piece) in lines {
        let row = field.comments.rows.iter().find(|(row, _)| Some(*row) == case);
        let comment = beside.take().or(row.map(|(_, comment)| comment.as_str()));
        out.line(INDENT, &format!("{head}{:INDENT$}{piece}", ""), comment);
        head = " ".repeat(column);
    }
}
