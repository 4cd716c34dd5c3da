//! Parameters that are set from outside the protocol, and values that were confirmed.

use indexmap::IndexMap;

use super::plan::SetBy;
use crate::result::Confirmation;
use crate::syntax::document::Text;

/// A parameter set from outside the protocol.
#[derive(Clone, Debug)]
pub struct Override {
    pub text: Text,
    pub set_by: SetBy,
}

/// Parameters set from outside, by name, and the values that were confirmed.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    parameters: IndexMap<String, Override>,
    pub confirmed: Vec<Confirmation>,
}

impl Overrides {
    pub fn new() -> Self {
        Self::default()
    }
}

impl std::ops::Deref for Overrides {
    type Target = IndexMap<String, Override>;

    fn deref(&self) -> &Self::Target {
        &self.parameters
    }
}

impl std::ops::DerefMut for Overrides {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.parameters
    }
}

impl FromIterator<(String, Override)> for Overrides {
    fn from_iter<T: IntoIterator<Item = (String, Override)>>(all: T) -> Self {
        Self { parameters: all.into_iter().collect(), confirmed: Vec::new() }
    }
}
