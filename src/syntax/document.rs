//! A protocol as written: blocks with fields, places and comments. The tree is the same for the
//! text form and for YAML.
//!
//! The meaning of fields is not known here. [`super::keys`] lists the blocks and fields.

use std::{ops::Range, sync::Arc};

use crate::source::{Located, Source, Span};

#[derive(Clone, Debug)]
pub struct Document {
    pub source: Arc<Source>,
    /// Comment lines at the top of the file that a blank line separates from what follows, without
    /// the `#`.
    pub leading: Vec<String>,
    pub blocks: Vec<Block>,
    /// Comment lines after the last block, without the `#`.
    pub trailing: Vec<String>,
}

impl Document {
    /// A document without blocks and comments.
    pub fn empty(source: &Arc<Source>) -> Self {
        let (leading, blocks, trailing) = Default::default();
        Self { source: Arc::clone(source), leading, blocks, trailing }
    }
}

/// A block such as `quantity Y_max "Guiding force, maximum"`, with the fields indented below it.
#[derive(Clone, Debug)]
pub struct Block {
    /// The word of a [`super::keys::Kind`].
    pub kind: Text,
    /// `None` for blocks that a protocol has only once.
    pub name: Option<Text>,
    pub title: Option<Text>,
    pub fields: Vec<Field>,
    pub comments: Comments,
}

#[derive(Clone, Debug)]
pub struct Field {
    pub key: Text,
    /// Text without its quotes for a text field; the phrase as written for a phrase field.
    pub value: Text,
    pub comments: Comments,
}

/// Comments that move with a block or field when the text is formatted, each without its `#` and
/// leading blank.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Comments {
    pub before: Vec<String>,
    pub beside: Option<String>,
    /// For a field with cases: comments beside further cases, each with the index of its case.
    pub rows: Vec<(usize, String)>,
    /// For a block: comment lines below its last field.
    pub after: Vec<String>,
}

impl Comments {
    /// Those above the field in a form that has none beside a case.
    pub fn above(&self) -> Vec<String> {
        let rows = self.rows.iter().map(|(_, comment)| comment);
        self.before.iter().chain(rows).cloned().collect()
    }

    /// Puts a comment beside; one that is there goes above.
    pub fn put_beside(&mut self, comment: Option<String>) {
        if let Some(comment) = comment {
            self.before.extend(self.beside.replace(comment));
        }
    }
}

/// A text and its place.
#[derive(Clone, Debug)]
pub struct Text {
    pub text: String,
    pub span: Span,
    /// Whether byte `n` of `text` is byte `n` of `span`. It is not where YAML or quotes contain
    /// escapes or folded lines.
    pub exact: bool,
}

impl Text {
    /// The place of a part of the text, as exact as possible.
    pub fn place(&self, range: Range<usize>) -> Span {
        if self.exact { self.span.part(range) } else { self.span.of_which(range) }
    }
}

impl Located for Text {
    fn place(&self) -> Span {
        self.span.clone()
    }
}

/// A field is pointed at by its value.
impl Located for Field {
    fn place(&self) -> Span {
        self.value.span.clone()
    }
}

/// The place for messages about the block as a whole.
impl Located for Block {
    fn place(&self) -> Span {
        self.span().clone()
    }
}

/// Documents are compared by meaning: places and comments are ignored.
impl PartialEq for Text {
    fn eq(&self, other: &Self) -> bool {
        self.text.split_whitespace().eq(other.text.split_whitespace())
    }
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key && self.value == other.value
    }
}

impl PartialEq for Block {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
            && self.name == other.name
            && self.title == other.title
            && self.fields == other.fields
    }
}

impl PartialEq for Document {
    fn eq(&self, other: &Self) -> bool {
        self.blocks == other.blocks
    }
}

impl Block {
    pub fn field(&self, key: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.key.text == key)
    }

    pub fn fields_named<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a Field> {
        self.fields.iter().filter(move |field| field.key.text == key)
    }

    /// The text of a field, if the block has it.
    pub fn text(&self, key: &str) -> Option<String> {
        self.field(key).map(|field| field.value.text.clone())
    }

    /// The texts of the notes of the block.
    pub fn notes(&self) -> Vec<String> {
        self.fields_named("note").map(|note| note.value.text.clone()).collect()
    }

    /// The title, if the block has one.
    pub fn title_text(&self) -> Option<String> {
        self.title.as_ref().map(|title| title.text.clone())
    }

    /// The title, or the words of the name.
    pub fn title_in_words(&self) -> String {
        self.title_text().unwrap_or_else(|| self.name_text().replace('_', " "))
    }

    /// The title, or the name as it is.
    pub fn title_or_name(&self) -> String {
        self.title_text().unwrap_or_else(|| self.own_name())
    }

    /// A copy of [`Self::name_text`].
    pub fn own_name(&self) -> String {
        self.name_text().to_owned()
    }

    /// The name, or an empty text for a block without a name.
    pub fn name_text(&self) -> &str {
        self.name.as_ref().map_or("", |name| name.text.as_str())
    }

    /// The place for messages about the block as a whole.
    pub fn span(&self) -> &Span {
        self.name.as_ref().map_or(&self.kind.span, |name| &name.span)
    }
}
