//! Looks into the document of a report.

use fishplate::report::document::{Block, Document, Figure, Medium, Table, Topic};
use fishplate::report::view;
use fishplate::result::Certification;

/// The document of a certification as a page shows it.
pub fn on_screen(found: &Certification) -> Document {
    view::document(found).on(Medium::Screen)
}

/// The tables whose captions contain a text.
pub fn tables<'a>(document: &'a Document, caption: &str) -> Vec<&'a Table> {
    document.tables().filter(|table| table.caption.letters().contains(caption)).collect()
}

/// The first table whose caption contains a text.
#[track_caller]
pub fn table<'a>(document: &'a Document, caption: &str) -> &'a Table {
    let found = tables(document, caption);
    found.into_iter().next().unwrap_or_else(|| panic!("no table with the caption {caption}"))
}

/// Titles of the columns of a table.
pub fn titles(table: &Table) -> Vec<&str> {
    table.columns.iter().map(|column| column.title.as_str()).collect()
}

/// The cells of a row as printed.
pub fn row(table: &Table, at: usize) -> Vec<String> {
    table.rows[at].cells.iter().map(|cell| cell.printed().letters()).collect()
}

/// The quantities that have a part of their own.
pub fn parts(document: &Document) -> Vec<&Topic> {
    document
        .blocks()
        .into_iter()
        .filter_map(|block| match block {
            Block::Part(part) => Some(part),
            _ => None,
        })
        .collect()
}

/// All figures.
pub fn figures(document: &Document) -> Vec<&Figure> {
    document
        .blocks()
        .into_iter()
        .filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
        .collect()
}

/// The document of one quantity alone.
pub fn of_part(part: &Topic) -> Document {
    let blocks = part.opening.iter().chain(&part.blocks).cloned().collect();
    Document {
        title: part.title.clone(),
        program: "",
        issued: None,
        draft: false,
        cover: None,
        chapters: vec![fishplate::report::document::Chapter::new("part", "Part", blocks)],
    }
}

/// Names and values on the cover.
pub fn key_facts(document: &Document) -> Vec<(String, String)> {
    let tiles = document.blocks().into_iter().find_map(|block| match block {
        Block::Tiles(facts) => Some(facts),
        _ => None,
    });
    let facts = tiles.into_iter().flatten();
    facts.map(|fact| (fact.name.clone(), fact.value.letters())).collect()
}

/// All that a document prints of sentences and lists.
pub fn sentences(document: &Document) -> Vec<String> {
    document
        .blocks()
        .into_iter()
        .flat_map(|block| match block {
            Block::Paragraph(text) => vec![text.letters()],
            Block::List(entries) | Block::Boxed { entries, .. } => {
                entries.iter().map(|entry| entry.letters()).collect()
            }
            Block::Statement { title, text, .. } => vec![format!("{title}: {}", text.letters())],
            _ => Vec::new(),
        })
        .collect()
}
