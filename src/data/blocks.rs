//! A long record, block by block: a thread reads ahead of the one that asks.

use std::{
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread,
};

use super::record::{Block, Known, RecordSource, Wanted};
use crate::problem::Problem;

/// Blocks that are read ahead: one is worked on while the next is read.
const AHEAD: usize = 1;

/// Columns of a block in SI, in the order in which they were wanted.
pub type Columns = Vec<Vec<f64>>;

type Message = Result<Columns, Vec<Problem>>;

/// The blocks of a record in the order of the file.
#[derive(Debug)]
pub struct Blocks {
    blocks: Receiver<Message>,
}

impl Blocks {
    /// The wanted columns of a record; all of them are required, and the first is its axis.
    pub fn open(source: RecordSource, wanted: Vec<Wanted>, known: Known) -> Self {
        let (to, blocks) = sync_channel(AHEAD);
        thread::spawn(move || {
            let axis = wanted.first().map_or("", |axis| axis.name.as_str());
            let read = source.stream(&wanted, axis, &known, |block| send(&to, block, &wanted));
            if let Err(problems) = read {
                // Who asked may have gone.
                let _ = to.send(Err(problems));
            }
        });
        Self { blocks }
    }

    /// The next block; `None` at the end of the record.
    ///
    /// # Errors
    /// Those of [`RecordSource::stream`].
    pub fn following(&mut self) -> Result<Option<Columns>, Vec<Problem>> {
        self.blocks.recv().map_or(Ok(None), |block| block.map(Some))
    }
}

fn send(to: &SyncSender<Message>, block: &Block<'_>, wanted: &[Wanted]) {
    let of = |wanted: &Wanted| block.columns.iter().find(|column| column.name == wanted.name);
    let columns = wanted
        .iter()
        .map(|wanted| of(wanted).map_or_else(Vec::new, |column| column.values.clone()))
        .collect();
    // Who asked may have gone.
    let _ = to.send(Ok(columns));
}
