//! What is known of a file of which several stretches are read: its hash, and of a text where in it
//! which part of the axis is.

use std::{
    ops::Range,
    sync::{Arc, Mutex, OnceLock},
};

use super::{
    Column,
    held::Held,
    recent::locked,
    stored::{Stored, refused},
};
use crate::data::{place::CampaignPath, prelude::*};
use crate::store::{Object, Refused};

/// Known once for all that share it; computed by the first who asks while the others wait.
#[derive(Clone, Debug, Default)]
pub struct Known {
    file: Arc<Mutex<Option<Arc<KnownFile>>>>,
    /// Of a record in a store: it is looked for once.
    object: Arc<OnceLock<Result<Object, Refused>>>,
    /// Where the file is, if it was found before.
    pub place: Arc<OnceLock<CampaignPath>>,
    /// Parts of this file and others.
    pub held: Held,
}

#[derive(Debug)]
pub struct KnownFile {
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file.
    pub bytes: u64,
    /// Of a text.
    pub index: Option<Index>,
}

/// Where the rows of a text are.
#[derive(Debug)]
pub struct Index {
    /// Name of the column.
    pub axis: String,
    pub rows: usize,
    pub marks: Vec<Mark>,
}

/// Consecutive rows of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Number of rows before.
    pub first_row: usize,
    /// First and last byte in the file.
    pub from: u64,
    pub to: u64,
    /// Least and largest value of the axis, SI.
    pub low: f64,
    pub high: f64,
}

impl Mark {
    /// Of rows with this axis.
    pub fn of(first_row: usize, (from, to): (u64, u64), axis: &Column) -> Self {
        let low = axis.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = axis.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { first_row, from, to, low, high }
    }

    pub fn touches(&self, range: &Range<f64>) -> bool {
        self.high >= range.start && self.low <= range.end
    }
}

impl Known {
    /// Of a file whose parts are kept with those of others.
    pub fn with(held: &Held) -> Self {
        Self { held: held.clone(), ..Self::default() }
    }

    /// The record in a store.
    ///
    /// # Errors
    /// As [`Object::find`].
    pub fn stored(&self, url: &str, at: &Span) -> Result<Stored, Problem> {
        match self.object.get_or_init(|| Object::find(url)) {
            Ok(object) => Ok(Stored { object: object.clone(), held: self.held.clone() }),
            Err(why) => Err(refused(why, at)),
        }
    }

    /// What is known, if it is enough; otherwise what is computed now.
    ///
    /// # Errors
    /// Of the computation.
    pub fn or<E>(
        &self,
        enough: impl FnOnce(&KnownFile) -> bool,
        compute: impl FnOnce() -> Result<KnownFile, E>,
    ) -> Result<Arc<KnownFile>, E> {
        let mut known = locked(&self.file);
        match &*known {
            Some(file) if enough(file) => Ok(Arc::clone(file)),
            _ => compute().map(|file| Arc::clone(known.insert(Arc::new(file)))),
        }
    }

    /// Keeps what was found in passing.
    pub fn keep(&self, file: KnownFile) {
        *locked(&self.file) = Some(Arc::new(file));
    }
}
