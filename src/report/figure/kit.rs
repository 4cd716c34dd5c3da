//! What every figure is drawn with.

pub use super::axis::{self, Range};
pub use super::canvas::{Canvas, Font, Group, Point};
pub use super::frame::Frame;
pub use super::legend::{Entry, Legend};
pub use super::style::*;
pub use crate::report::number;
