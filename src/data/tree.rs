//! A YAML text as a tree in which every key and value knows its place and the words it was written with.
//!
//! One YAML 1.2 document, core schema: `true` and `false` are the only truth values, `no` and `1.2.3` are text.

mod load;
mod scalar;
#[cfg(test)]
mod tests;

pub use load::{Remark, load, remarks};

use std::ops::Range;

use crate::source::Span;

/// A value and where it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub value: Value,
    /// The value without anchor, tag and, if [`Node::exact`], without quotes. Where an alias stands, the place of the anchored value.
    pub span: Span,
    /// A scalar as text, whatever it was resolved to: `1.50`, `no`, `5 kN`; escapes undone and folded lines joined.
    /// Empty for lists and maps.
    pub raw: String,
    /// Whether byte `n` of `raw` stands at byte `n` of `span`.
    pub exact: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Null,
    Bool(bool),
    /// Always finite: `.inf`, `.nan` and `1e999` are refused when loading.
    Number(f64),
    Text(String),
    List(Vec<Node>),
    /// In the order written; keys are unique.
    Map(Vec<(Key, Node)>),
}

/// A key of a map; whatever it looks like, it is text.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub text: String,
    /// Without quotes if [`Key::exact`].
    pub span: Span,
    /// Whether byte `n` of `text` stands at byte `n` of `span`.
    pub exact: bool,
}

impl Key {
    /// The place of a part of the text, as narrow as is known.
    pub fn place(&self, range: Range<usize>) -> Span {
        if self.exact { self.span.part(range) } else { self.span.clone() }
    }
}

impl Node {
    /// The entries of a map; none for any other value.
    pub fn entries(&self) -> &[(Key, Node)] {
        if let Value::Map(entries) = &self.value { entries } else { &[] }
    }

    /// The items of a list; none for any other value.
    pub fn items(&self) -> &[Node] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|(_, node)| node)
    }

    pub fn entry(&self, key: &str) -> Option<&(Key, Node)> {
        self.entries().iter().find(|(known, _)| known.text == key)
    }

    /// `a.b.c`: a value below maps. A key that itself holds a dot is found by its whole text first.
    pub fn lookup(&self, path: &str) -> Option<&Node> {
        if let Some(node) = self.get(path) {
            return Some(node);
        }
        path.match_indices('.').find_map(|(at, _)| self.get(&path[..at])?.lookup(&path[at + 1..]))
    }

    pub fn is_scalar(&self) -> bool {
        !matches!(self.value, Value::List(_) | Value::Map(_))
    }

    pub fn number(&self) -> Option<f64> {
        if let Value::Number(number) = self.value { Some(number) } else { None }
    }

    /// The text of a scalar other than null, as written.
    pub fn scalar_text(&self) -> Option<&str> {
        (self.is_scalar() && self.value != Value::Null).then_some(self.raw.as_str())
    }

    /// The place of a part of [`Node::raw`], as narrow as is known.
    pub fn place(&self, range: Range<usize>) -> Span {
        if self.exact { self.span.part(range) } else { self.span.clone() }
    }

    /// "a list", "a number": for messages.
    pub fn kind_in_words(&self) -> &'static str {
        match self.value {
            Value::Null => "nothing",
            Value::Bool(_) => "a truth value",
            Value::Number(_) => "a number",
            Value::Text(_) => "text",
            Value::List(_) => "a list",
            Value::Map(_) => "a map",
        }
    }
}
