//! What nearly every file of the checker uses: the checker itself, phrases and the fields they are
//! in, the parts of a plan, and problems.

pub(super) use super::plan::*;
pub(super) use super::scope::Scope;
pub(super) use super::{Checker, if_written};
pub(super) use crate::problem::{Problem, Problems, all, error, problem, warning};
pub(super) use crate::source::{Located, Span, Spanned};
pub(super) use crate::syntax::document::{Block, Document, Field, Text};
pub(super) use crate::syntax::from_pest;
pub(super) use crate::syntax::phrase::{At, Node, Phrase, normalised};
pub(super) use crate::units::{Dimension, Unit};
