//! Effects that a simulation may lack, declared in a text file, and how each is added.

mod catalogue;
mod choose;
mod expression;
mod formulas;
pub mod operators;
mod read;
mod signals;

pub use catalogue::{Action, Acts, Catalogue, Effect, Fit, Group, Parameter};
pub use choose::{Applied, Confined, choose};
pub use expression::Formula;
pub use operators::{Gauss, Operator};
pub use read::{CHANNEL, Find, ModelParameters, read};
pub use signals::{Channel, Signals};
