//! Functions of expressions, by name.

use crate::catalog::{FUNCTIONS, Function, SIGNAL_FUNCTIONS};

/// The function of a name.
pub fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// Whether it is a function of signals along the axis.
pub fn is_signal_function(name: &str) -> bool {
    SIGNAL_FUNCTIONS.iter().any(|(known, ..)| *known == name)
}
