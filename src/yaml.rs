//! A YAML text as a tree in which every key and value has its place and its original text.
//!
//! One YAML 1.2 document, core schema: only `true` and `false` are booleans; `no` and `1.2.3` are
//! text.

mod load;
mod scalar;
#[cfg(test)]
mod tests;

pub use load::{Remark, load, load_as_written, remarks};

use std::ops::Range;

use crate::source::Span;

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub value: Value,
    /// Span of the value without anchor, tag and, if [`Node::exact`], without quotes. For an alias,
    /// the span of the anchored value.
    pub span: Span,
    /// A scalar as text, whatever its type: `1.50`, `no`, `5 kN`; with escapes resolved and folded
    /// lines joined. Empty for lists and maps.
    pub raw: String,
    /// Whether byte `n` of `raw` is at byte `n` of `span`.
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
    /// In the order written; keys are unique unless loaded as written.
    Map(Vec<(Key, Node)>),
}

/// A key of a map, always text.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub text: String,
    /// Without quotes if [`Key::exact`].
    pub span: Span,
    /// Whether byte `n` of `text` is at byte `n` of `span`.
    pub exact: bool,
}

impl Key {
    /// The span of a part of the text, as precise as possible.
    pub fn place(&self, range: Range<usize>) -> Span {
        if self.exact { self.span.part(range) } else { self.span.clone() }
    }
}

impl Node {
    /// The entries of a map; empty for any other value.
    pub fn entries(&self) -> &[(Key, Node)] {
        if let Value::Map(entries) = &self.value { entries } else { &[] }
    }

    /// The items of a list; empty for any other value.
    pub fn items(&self) -> &[Node] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entry(key).map(|(_, node)| node)
    }

    pub fn entry(&self, key: &str) -> Option<&(Key, Node)> {
        self.entries().iter().find(|(known, _)| known.text == key)
    }

    /// Looks up `a.b.c` in nested maps. A key that contains a dot is found by its full text first.
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

    /// The span of a part of [`Node::raw`], as precise as possible.
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
