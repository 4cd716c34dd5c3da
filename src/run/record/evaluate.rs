//! The nodes of a graph on one record: at once, or with the record kept after its filters ran, to
//! be cut and reduced again for every shift.

use std::{collections::BTreeSet, sync::Arc};

use super::{
    memo::Keys,
    opened::Opened,
    signal::{Along, Cutter, Samples, Signal},
    state::{NodeValue, State},
    stretch::leading,
};
use crate::run::{
    prelude::*,
    sections::{Extent, Known},
};

/// A record whose filters have run, to be cut at several places.
#[derive(Debug)]
pub struct Held<'a> {
    state: State<'a>,
    levels: Vec<Vec<NodeId>>,
    /// Nodes that depend on the place of the section.
    placed: Vec<bool>,
    wanted: &'a BTreeSet<NodeId>,
}

impl Held<'_> {
    /// A requested signal of the whole record.
    pub fn samples(&self, node: NodeId) -> Option<&Samples> {
        self.state.found.iter().find_map(|(id, found)| match found {
            NodeValue::Samples(samples) if *id == node => Some(samples),
            _ => None,
        })
    }

    /// The part of the section that the shifted record covers.
    fn covered(&self, shift: f64) -> Result<Extent, Reason> {
        let (start, end) = self.state.extent;
        if shift == 0.0 {
            return Ok((start, end));
        }
        let axis = &self.state.opened.sampled.along.axis;
        // Of a stretch that sections share, no more than the section would read by itself.
        let (first, last) = self.state.opened.own.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let from = axis.first().map_or(start, |x| (x.max(first) + shift).max(start));
        let to = axis.last().map_or(end, |x| (x.min(last) + shift).min(end));
        let missing = (end - start) - (to - from);
        if missing > MOST_MISSING * (end - start) {
            return Err(Reason::ShiftedOut { shift, missing });
        }
        Ok((from, to))
    }

    /// Values of the requested nodes with the record moved along the axis by `shift` (SI) before
    /// the section is cut.
    ///
    /// # Errors
    /// Where the moved record covers too little of the section; and the errors of an evaluation.
    pub fn at(&self, shift: f64) -> Result<Vec<(NodeId, NodeValue)>, Reason> {
        let mut moved = Moved { shift, known: Vec::new() };
        let extent = self.covered(shift)?;
        let mut state = self.state.clone();
        state.cutter = Cutter::new(extent);
        state.extent = extent;
        for value in state.values.iter_mut().flatten() {
            if let Signal::Samples(samples) = value {
                *samples = moved.samples(samples);
            }
        }
        for (_, found) in &mut state.found {
            if let NodeValue::Samples(samples) = found {
                *samples = moved.samples(samples);
            }
        }
        state.run(&self.levels, self.wanted, |id| self.placed[id])?;
        Ok(state.found)
    }
}

/// Largest share of a section that a moved record may leave uncovered; the covered part is
/// evaluated.
const MOST_MISSING: f64 = 0.2;

/// Signals of a record share their axis, which is moved once for all of them.
struct Moved {
    shift: f64,
    known: Vec<(Arc<Along>, Arc<Along>)>,
}

impl Moved {
    fn samples(&mut self, samples: &Samples) -> Samples {
        if self.shift == 0.0 {
            return samples.clone();
        }
        let known = self
            .known
            .iter()
            .find(|(from, _)| Arc::ptr_eq(from, &samples.along))
            .map(|(_, to)| Arc::clone(to));
        let along = known.unwrap_or_else(|| {
            let to = Arc::new(samples.along.moved(self.shift));
            self.known.push((Arc::clone(&samples.along), Arc::clone(&to)));
            to
        });
        Samples { along, values: Arc::clone(&samples.values) }
    }
}

impl Opened {
    /// Values of the requested nodes. Nodes run level by level, so that channels with the same
    /// filter are filtered together. `keys` are those of the nodes, where protocols share the
    /// record.
    ///
    /// # Errors
    /// Samples without a finite result.
    pub fn evaluate(
        &self,
        of: (&Plan, &Graph),
        needed: &BTreeSet<NodeId>,
        wanted: &BTreeSet<NodeId>,
        known: &Known<'_>,
        keys: Option<&Keys>,
    ) -> Result<Vec<(NodeId, NodeValue)>, Reason> {
        let mut state = State::new(self, of, known);
        state.memo = self.memo.as_deref().zip(keys);
        let left = match state.memo {
            None => None,
            Some((memo, keys)) => {
                state.count_asked(memo, needed);
                let open = wanted.iter().copied().collect();
                Some(state.recall((memo, keys), open, wanted, |id| needed.contains(&id))?)
            }
        };
        let levels = state.count(left.as_ref().unwrap_or(needed));
        let done = state.on_stretch(needed, wanted, &levels)?;
        state.run(&levels, wanted, |id| !done[id])?;
        Ok(state.found)
    }

    /// Runs the nodes that do not depend on the place of the section: filters run, nothing is cut.
    ///
    /// # Errors
    /// As of [`Opened::evaluate`].
    pub fn hold<'a>(
        &'a self,
        of: (&'a Plan, &'a Graph),
        needed: &BTreeSet<NodeId>,
        wanted: &'a BTreeSet<NodeId>,
        known: &'a Known<'a>,
    ) -> Result<Held<'a>, Reason> {
        let mut state = State::new(self, of, known);
        let levels = state.count(needed);
        let here = |operation: &Operation| {
            matches!(operation, Operation::Cut | Operation::Window(_) | Operation::Reduce(_))
        };
        let placed = leading(of.1, needed, here);
        let done = state.on_stretch(needed, wanted, &levels)?;
        state.run(&levels, wanted, |id| !placed[id] && !done[id])?;
        Ok(Held { state, levels, placed, wanted })
    }
}
