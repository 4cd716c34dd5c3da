//! A program without the feature `store`: no object is ever found, and none can be made.

use std::{convert::Infallible, ops::Range};

use bytes::Bytes;

use super::Refused;

/// No object.
#[derive(Clone, Debug)]
pub struct Object(Infallible);

impl Object {
    /// # Errors
    /// `store-not-built`, always.
    pub fn find(url: &str) -> Result<Self, Refused> {
        let says = format!(
            "`{url}` is in a store, and this program was built without the feature `store`"
        );
        let help = "build it with `cargo build --release --features store`, or copy the record to the campaign's folder".to_string();
        Err(Refused { code: "store-not-built", says, help: Some(help) })
    }

    pub fn url(&self) -> &str {
        match self.0 {}
    }

    pub fn size(&self) -> u64 {
        match self.0 {}
    }

    pub fn version(&self) -> &str {
        match self.0 {}
    }

    /// # Errors
    /// None.
    pub fn read(&self, _ranges: &[Range<u64>]) -> Result<Vec<Bytes>, String> {
        match self.0 {}
    }
}
