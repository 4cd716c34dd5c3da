//! The part of a record around the places that are looked at. Samples behind it are forgotten as
//! the search goes on.

use crate::data::{
    blocks::Blocks,
    record::{Known, RecordSource, Wanted},
};
use crate::problem::Problem;

/// A stretch of a record; its first column is the axis.
pub struct Window {
    blocks: Option<Blocks>,
    pub shown: String,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    /// Row of the file of the first sample that is held.
    pub first_row: usize,
    /// Where the record begins.
    pub first: Option<f64>,
    /// Up to where it is read.
    pub last: f64,
}

impl Window {
    pub fn open(source: RecordSource, wanted: Vec<Wanted>, known: Known) -> Self {
        let names: Vec<String> = wanted.iter().map(|wanted| wanted.name.clone()).collect();
        Self {
            columns: vec![Vec::new(); names.len()],
            names,
            shown: source.inside().to_string(),
            first_row: source.first_row(),
            blocks: Some(Blocks::open(source, wanted, known)),
            first: None,
            last: f64::NEG_INFINITY,
        }
    }

    /// Reads until the record goes beyond `to`, or ends.
    ///
    /// # Errors
    /// Those of a record; `axis-not-increasing`.
    pub fn fill(&mut self, to: f64) -> Result<(), Vec<Problem>> {
        while self.last <= to || self.first.is_none() {
            let Some(blocks) = &mut self.blocks else { return Ok(()) };
            let Some(block) = blocks.following()? else {
                self.blocks = None;
                return Ok(());
            };
            let before = self.columns[0].len();
            for (column, values) in self.columns.iter_mut().zip(&block) {
                column.extend_from_slice(values);
            }
            let axis = &self.columns[0];
            let from = before.max(1);
            if let Some(at) = (from..axis.len()).find(|&at| axis[at] <= axis[at - 1]) {
                let row = self.first_row + at;
                let says = format!(
                    "`{}` does not increase at row {row} of `{}`",
                    self.names[0], self.shown
                );
                return Err(vec![
                    Problem::error("axis-not-increasing", says)
                        .help("a run goes forward along its axis"),
                ]);
            }
            self.first = self.first.or_else(|| axis.first().copied());
            self.last = axis.last().copied().unwrap_or(self.last);
        }
        Ok(())
    }

    /// Forgets the samples before a place, but one.
    pub fn forget(&mut self, before: f64) {
        let count = self.columns[0].partition_point(|x| *x < before).saturating_sub(1);
        self.columns.iter_mut().for_each(|column| drop(column.drain(..count)));
        self.first_row += count;
    }

    /// Where what is held begins.
    pub fn first_held(&self) -> Option<f64> {
        self.columns[0].first().copied()
    }

    /// Where the record ends, once this is known.
    pub fn end(&self) -> Option<f64> {
        self.blocks.is_none().then_some(self.last)
    }

    pub fn columns(&self) -> impl Iterator<Item = (String, Vec<f64>)> {
        self.names.iter().cloned().zip(self.columns.iter().cloned())
    }
}
