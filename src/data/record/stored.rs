//! Records in an object store, as Parquet.

use super::held::Held;
use crate::data::prelude::*;
use crate::store::{Object, Refused};

/// An object, and where its parts are kept that are read again. Of an object, the footer and the
/// wanted columns of the row groups that are needed are read, and nothing else.
#[derive(Clone, Debug)]
pub struct Stored {
    pub object: Object,
    pub held: Held,
}

/// Why an object is not read, as a problem at the place where its URL is written.
pub fn refused(why: &Refused, at: &Span) -> Problem {
    error(why.code, why.says.as_str(), at).help_if(why.help.as_deref())
}
