//! Values of a protocol that a user answers for.

use crate::result::{ConfirmedValue, Remark, StatedValue};

/// All values that are to be confirmed: those that are not yet, those that are, and confirmations
/// that do not count.
#[derive(Clone, Debug, Default)]
pub struct StatedValues {
    pub provisional: Vec<StatedValue>,
    pub confirmed: Vec<ConfirmedValue>,
    pub not_counted: Vec<Remark>,
}

impl StatedValues {
    /// Whether a value of this name is not confirmed.
    pub fn open(&self, name: &str) -> bool {
        self.provisional.iter().any(|stated| stated.name == name)
    }

    /// Why a value is to be confirmed that is not.
    pub fn why(&self, name: &str) -> Option<String> {
        self.provisional.iter().find(|stated| stated.name == name)?.why.clone()
    }
}
