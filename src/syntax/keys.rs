//! The blocks and fields of a protocol: one table for both forms, the JSON Schema and the language
//! reference.

mod fields;
mod kinds;

use super::document::Block;

pub use kinds::KINDS;

/// The field that makes a block a family of blocks.
pub const EACH: &str = "for each";

/// The field of what may be absent.
pub const OPTIONAL: &str = "optional";

/// What an optional datum leads to that is absent.
pub const NOT_ASSESSABLE: &str = "not assessable";

/// As the first versions wrote a default for `optional not assessable`.
pub const NOT_STATED: &str = "not stated";

/// How the value of a field is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// Prose: in quotes in the text form, a plain string in YAML.
    Text,
    /// Words of the language: the same in both forms.
    Phrase,
}

/// A field of a block.
#[derive(Debug)]
pub struct Key {
    pub word: &'static str,
    pub sort: Sort,
    /// Can occur several times (a list in YAML).
    pub many: bool,
    /// A list of words, parted by commas; in YAML also a list.
    pub list: bool,
    /// A text with places of the vehicle in braces.
    pub pattern: bool,
    pub about: &'static str,
    pub example: &'static str,
}

/// A kind of block.
#[derive(Debug)]
pub struct Kind {
    /// Word in the text form: `quantity`.
    pub word: &'static str,
    /// Key in YAML: `quantities`.
    pub group: &'static str,
    pub named: bool,
    /// Whether a protocol has at most one such block. In YAML, its fields are then directly below
    /// the group.
    pub single: bool,
    pub about: &'static str,
    pub keys: &'static [Key],
}

/// The kind of block of a word of the text form; of two with the same word, the one without a name.
pub fn kind(word: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.word == word)
}

/// The kind of a block. A `verdict` with a name has other fields than the one without.
pub fn of_block(block: &Block) -> Option<&'static Kind> {
    kind(&block.kind.text).map(|kind| kind.with_name(block.name.is_some()))
}

/// The kind of block of a top-level key of the YAML form.
pub fn group(word: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.group == word)
}

impl Kind {
    /// Whether a block of this kind can be a family.
    pub fn has_families(&self) -> bool {
        self.key(EACH).is_some()
    }

    /// The kind with the same word that has a name or has none; this kind if there is only one.
    pub fn with_name(&'static self, named: bool) -> &'static Self {
        KINDS.iter().find(|kind| kind.word == self.word && kind.named == named).unwrap_or(self)
    }

    pub fn key(&self, word: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.word == word)
    }
}
