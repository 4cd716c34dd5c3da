//! What nearly every file that reads data uses: problems and their places, YAML, and units.

pub(super) use crate::disk;
pub(super) use crate::problem::{Problem, Problems, error, problem, warning};
pub(super) use crate::source::{Source, Span, Spanned};
pub(super) use crate::units::{Dimension, Unit};
pub(super) use crate::yaml::{FromNode, Key, Node, Value, fields};
