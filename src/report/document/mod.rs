//! A report as a document: a cover, and chapters of paragraphs, lists, tables and figures.
//!
//! Certification, study, comparison and diagnosis are each made into a [`Document`]; PDF and HTML
//! are filled from it. Texts of users are data: escaping is the task of the template.

mod cell;
pub mod finding;
mod sentence;
pub mod symbol;
pub mod table;
mod text;

use serde::Serialize;

pub(crate) use cell::cells;
pub use cell::{Cell, Format};
pub use finding::{Finding, Tone};
pub use sentence::Symbols;
pub use table::{Row, Table};
pub use text::{Run, Text};

/// Program and version that write a document.
pub const PROGRAM: &str = concat!("Fishplate ", env!("CARGO_PKG_VERSION"));

/// All that a report prints, in order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Document {
    /// Title of the file: `Validation report: <campaign>`.
    pub title: String,
    /// [`PROGRAM`].
    pub program: &'static str,
    /// Date of issue, `2026-03-31`; `None` if it is not stated.
    pub issued: Option<String>,
    /// Every page is marked as a draft.
    pub draft: bool,
    /// Without it, the chapters follow the title.
    pub cover: Option<Cover>,
    pub chapters: Vec<Chapter>,
}

/// The first page, and what is repeated from it in the margins of the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cover {
    /// Name of the first page in the navigation: `Verdict`, `Result`.
    pub short: &'static str,
    /// What kind of report it is, above the name.
    pub over: String,
    /// The campaign.
    pub name: String,
    /// Title of the protocol, and its edition.
    pub subject: String,
    pub edition: Option<String>,
    /// `Report R-17, revision B`; empty if no number is stated.
    pub line: String,
    /// Start of the hash of the protocol.
    pub sha256: String,
    pub result: ResultBox,
    pub blocks: Vec<Block>,
    /// The contents list parts of chapters too, on a page of their own.
    pub parts_in_contents: bool,
}

/// The result, in a box on the cover.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultBox {
    /// `Verdict: <title>`; without it the result stands alone, without its sign.
    pub label: Option<String>,
    pub finding: Finding,
    pub note: Option<String>,
    pub sentence: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chapter {
    /// Anchor; not user text.
    pub id: &'static str,
    pub title: String,
    /// Title in the navigation.
    pub short: String,
    pub blocks: Vec<Block>,
    /// It stays on one page.
    pub together: bool,
    pub on_new_page: bool,
}

impl Chapter {
    pub fn new(id: &'static str, title: impl Into<String>, blocks: Vec<Block>) -> Self {
        let title = title.into();
        let short = title.clone();
        Self { id, short, title, blocks, together: false, on_new_page: false }
    }

    /// With another title in the navigation.
    pub fn called(self, short: &str) -> Self {
        Self { short: short.to_owned(), ..self }
    }
}

/// Where a block or a column is printed, if not everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Medium {
    /// The PDF.
    Paper,
    /// The HTML page.
    Screen,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "it", rename_all = "lowercase")]
pub enum Block {
    Paragraph(Text),
    Heading(String),
    List(Vec<Text>),
    /// A box with a list, under a title if it has one.
    Boxed {
        tone: Option<Tone>,
        title: &'static str,
        entries: Vec<Text>,
    },
    /// Names and values; several lists stand side by side.
    Facts(Vec<Vec<Fact>>),
    /// The most important facts, side by side.
    Tiles(Vec<Fact>),
    Figure(Figure),
    Table(Table),
    /// Blocks under a line that opens and closes them on a screen.
    Details(Text, Vec<Block>),
    /// A part of a chapter, with a place in the navigation.
    Part(Topic),
    /// Blocks about the sections of one zone.
    Zone(Option<String>, Vec<Block>),
    /// A text line by line, each with its number.
    Listing(Vec<String>),
    /// A statement for signature: what is to be filled in.
    Statement {
        title: String,
        text: Text,
        fields: [&'static str; 3],
    },
    /// The files that the PDF carries.
    Attached,
    /// Printed in one medium only.
    Only(Medium, Vec<Block>),
}

impl Block {
    /// A paragraph.
    pub fn text(text: impl Into<Text>) -> Self {
        Self::Paragraph(text.into())
    }

    pub fn heading(title: impl Into<String>) -> Self {
        Self::Heading(title.into())
    }

    pub fn list<T: Into<Text>>(entries: impl IntoIterator<Item = T>) -> Self {
        Self::List(entries.into_iter().map(Into::into).collect())
    }

    /// Printed on paper only.
    pub fn on_paper(blocks: impl IntoIterator<Item = Self>) -> Self {
        Self::Only(Medium::Paper, blocks.into_iter().collect())
    }

    /// Printed on a screen only.
    pub fn on_screen(blocks: impl IntoIterator<Item = Self>) -> Self {
        Self::Only(Medium::Screen, blocks.into_iter().collect())
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl From<Figure> for Block {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}

/// A name and what it is for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    pub name: String,
    pub value: Text,
}

impl Fact {
    pub fn new(name: impl Into<String>, value: impl Into<Text>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}

/// The facts that have a value.
pub fn facts<'a>(all: impl IntoIterator<Item = (&'a str, Text)>) -> Vec<Fact> {
    let known = all.into_iter().filter(|(_, value)| !value.is_empty());
    known.map(|(name, value)| Fact::new(name, value)).collect()
}

/// A figure: its name among the drawings, its caption, and a text alternative.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Figure {
    pub name: String,
    pub caption: Text,
    pub alt: String,
    /// The most height that it takes on paper \[mm\].
    pub height: u32,
    /// A heading, with which the figure has a page of its own.
    pub page: Option<&'static str>,
}

impl Figure {
    pub fn new(
        name: impl Into<String>,
        caption: impl Into<Text>,
        alt: impl Into<String>,
        height: u32,
    ) -> Self {
        Self { name: name.into(), caption: caption.into(), alt: alt.into(), height, page: None }
    }
}

/// What a chapter tells of one thing, such as a quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Topic {
    /// Anchor; not user text.
    pub id: String,
    pub title: String,
    /// Title in the navigation.
    pub short: Text,
    pub finding: Finding,
    /// Blocks that stay on one page with the title.
    pub opening: Vec<Block>,
    pub blocks: Vec<Block>,
}

impl Document {
    /// What one medium prints: without the blocks and the columns of others.
    pub fn on(&self, medium: Medium) -> Self {
        let cover = self.cover.as_ref();
        let chapter = |one: &Chapter| Chapter { blocks: on(&one.blocks, medium), ..one.clone() };
        Self {
            cover: cover.map(|one| Cover { blocks: on(&one.blocks, medium), ..one.clone() }),
            chapters: self.chapters.iter().map(chapter).collect(),
            ..self.clone()
        }
    }

    /// All blocks in order, those inside of another after it.
    pub fn blocks(&self) -> Vec<&Block> {
        let cover = self.cover.iter().flat_map(|cover| &cover.blocks);
        cover.chain(self.chapters.iter().flat_map(|one| &one.blocks)).flat_map(inside).collect()
    }

    /// All tables in order.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.blocks().into_iter().filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
    }
}

/// A block and the blocks inside of it.
fn inside(block: &Block) -> Vec<&Block> {
    let inner: Vec<&Block> = match block {
        Block::Only(_, inner) | Block::Details(_, inner) | Block::Zone(_, inner) => {
            inner.iter().collect()
        }
        Block::Part(part) => part.opening.iter().chain(&part.blocks).collect(),
        _ => Vec::new(),
    };
    std::iter::once(block).chain(inner.into_iter().flat_map(inside)).collect()
}

fn on(blocks: &[Block], medium: Medium) -> Vec<Block> {
    let placed = |block: &Block| match block {
        Block::Only(only, inner) if *only == medium => on(inner, medium),
        Block::Only(..) => Vec::new(),
        Block::Details(line, inner) => vec![Block::Details(line.clone(), on(inner, medium))],
        Block::Zone(zone, inner) => vec![Block::Zone(zone.clone(), on(inner, medium))],
        Block::Part(part) => vec![Block::Part(Topic {
            opening: on(&part.opening, medium),
            blocks: on(&part.blocks, medium),
            ..part.clone()
        })],
        Block::Table(table) => vec![Block::Table(table.on(medium))],
        other => vec![other.clone()],
    };
    blocks.iter().flat_map(placed).collect()
}
