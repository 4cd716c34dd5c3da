//! One record of a section through the graph, and whether it extends far enough beyond the section
//! for slow filters to settle.

use std::{collections::BTreeSet, sync::Arc};

use super::SectionValues;
use crate::metrics::filter::{Band, Roots};
use crate::run::{
    prelude::*,
    record::{Fault, NodeValue, Opened, Samples, SectionWork, Work},
    sections::Extent,
};

/// Values of the requested nodes of one record, in the order in which they were computed.
#[derive(Clone, Debug, Default)]
pub struct NodeValues {
    all: Vec<(NodeId, NodeValue)>,
    /// For each node, one more than the index of its value; 0 if it has no value.
    places: Vec<usize>,
}

impl From<Vec<(NodeId, NodeValue)>> for NodeValues {
    fn from(all: Vec<(NodeId, NodeValue)>) -> Self {
        let mut places = vec![0; all.iter().map(|(node, _)| node + 1).max().unwrap_or(0)];
        // If a node has two values, the first counts.
        for (at, (node, _)) in all.iter().enumerate().rev() {
            places[*node] = at + 1;
        }
        Self { all, places }
    }
}

impl NodeValues {
    pub const NONE: Self = Self { all: Vec::new(), places: Vec::new() };

    pub fn get(&self, node: NodeId) -> Option<&NodeValue> {
        let place = self.places.get(node)?.checked_sub(1)?;
        self.all.get(place).map(|(_, found)| found)
    }

    pub fn iter(&self) -> impl Iterator<Item = &(NodeId, NodeValue)> {
        self.all.iter()
    }

    /// A number of a signal, and of how many samples it is.
    ///
    /// # Errors
    /// It could not be computed, and why.
    pub fn number(&self, node: NodeId) -> Result<(f64, usize), Reason> {
        match self.get(node) {
            Some(NodeValue::Number(value, samples)) => Ok((*value, *samples)),
            Some(NodeValue::Failed(reason)) => Err(reason.clone()),
            _ => Err(Reason::ValueMissing),
        }
    }

    /// # Errors
    /// As [`NodeValues::number`].
    pub fn samples(&self, node: NodeId) -> Result<&Samples, Reason> {
        match self.get(node) {
            Some(NodeValue::Samples(samples)) => Ok(samples),
            Some(NodeValue::Failed(reason)) => Err(reason.clone()),
            _ => Err(Reason::SignalMissing),
        }
    }
}

/// One record of a side.
#[derive(Clone, Debug)]
pub struct RecordOfSide {
    /// Its name, where the campaign has several records of the side.
    pub name: Option<Arc<str>>,
    /// What the campaign calls it, also if it is the only one.
    pub called: Option<Arc<str>>,
    pub which: WhichRecord,
    pub found: NodeValues,
    pub file: FileHash,
    /// The section on the axis; of a whole record all of it.
    pub extent: Extent,
    /// As [`Opened::rows`].
    pub rows: [(usize, usize); 2],
}

impl RecordOfSide {
    pub fn new(
        section: &SectionWork<'_>,
        which: WhichRecord,
        opened: &Opened,
        found: Vec<(NodeId, NodeValue)>,
    ) -> Self {
        let campaign = section.campaign();
        Self {
            name: campaign.record_name(which).cloned(),
            called: campaign.record_called(which).cloned(),
            which,
            found: found.into(),
            file: opened.file.clone(),
            extent: opened.extent,
            rows: opened.rows(),
        }
    }
}

impl SectionWork<'_> {
    /// The nodes that are wanted, of one record.
    ///
    /// # Errors
    /// As of [`Self::read`].
    pub fn record(
        &self,
        which: WhichRecord,
        wanted: &BTreeSet<NodeId>,
        values: &mut SectionValues,
    ) -> Result<RecordOfSide, Fault> {
        let Work { plan, graph, .. } = *self.work;
        let keys = self.sharing().map(|sharing| sharing.keys);
        self.read(which, wanted, values, |opened, needed| {
            let found = opened.evaluate((plan, graph), needed, wanted, &self.known, keys)?;
            Ok(RecordOfSide::new(self, which, opened, found))
        })
    }

    /// Evaluates a record with `evaluate`, and notes its file, and a margin that is too short for
    /// slow filters.
    ///
    /// # Errors
    /// The record cannot be read or does not cover the section; and what `evaluate` says.
    pub fn read<T>(
        &self,
        which: WhichRecord,
        wanted: &BTreeSet<NodeId>,
        values: &mut SectionValues,
        evaluate: impl FnOnce(&Opened, &BTreeSet<NodeId>) -> Result<T, Reason>,
    ) -> Result<T, Fault> {
        let (found, opened) = self.with_record(which, wanted, |opened, needed| {
            Ok((evaluate(opened, needed)?, slow(self.work.graph, needed)))
        })?;
        values.files.push(opened.file.clone());
        let (found, slow) = found?;
        if let Some((before, after)) = opened.margins
            && slow
            && self.unit.extent.is_some()
            && before.min(after) < SLOW_FILTER_MARGIN
        {
            values.short_margin = Some(before.min(after));
        }
        Ok(found)
    }
}

/// One note for all sections used whose record is too short for a slow filter.
pub fn margin_note<'a>(used: impl Iterator<Item = &'a SectionValues>) -> Option<Remark> {
    let margins: Vec<Option<f64>> = used.map(|values| values.short_margin).collect();
    let short: Vec<f64> = margins.iter().copied().flatten().collect();
    let least = short.iter().copied().reduce(f64::min)?;
    let (_, rms, extreme) = MARGIN_TRIALS
        .iter()
        .rev()
        .find(|(margin, _, _)| *margin <= least)
        .copied()
        .unwrap_or(MARGIN_TRIALS[0]);
    Some(Remark::ShortMargins {
        short: short.len(),
        sections: margins.len(),
        least,
        needed: SLOW_FILTER_MARGIN,
        frequency: SLOW_FILTER,
        rms,
        extreme,
    })
}

/// Effect of a short margin: margin in s, and the largest change in % of an rms value and of an
/// extreme value (0.15 and 99.85 % values), compared with records that extend 3.2 s beyond the
/// section. Source: own trials with car body accelerations of seven sections of three simulated
/// campaigns (28 values of each kind), band-pass 0.4 to 10 Hz, order 4, zero-phase. Evaluated parts
/// of 2 to 4 s, for which the ends have the largest effect. Half of the values changed by less than
/// a fifth of this.
const MARGIN_TRIALS: [(f64, u8, u8); 7] = [
    (0.0, 50, 75),
    (0.25, 19, 50),
    (0.5, 16, 41),
    (1.0, 9, 27),
    (1.5, 7, 16),
    (2.0, 4, 10),
    (3.0, 2, 10),
];

/// Frequency in Hz below which a filter needs this margin, and the margin in s on each side of the
/// section (own trials: 5 s keep the error at a 0.4 Hz edge below 0.5 % of an rms value).
const SLOW_FILTER: f64 = 1.0;
const SLOW_FILTER_MARGIN: f64 = 5.0;

/// Lowest edge frequency of a filter, or the frequency of its slowest pole.
fn lowest_frequency(step: &StepSpec) -> Option<f64> {
    match step {
        StepSpec::Butterworth { band, .. } => match band {
            Band::LowPass(edge)
            | Band::HighPass(edge)
            | Band::BandPass(edge, _)
            | Band::BandStop(edge, _) => Some(*edge),
        },
        StepSpec::Transfer { function, .. } => match function.poles {
            Roots::One(frequency) => Some(frequency),
            // At low quality there are two real poles; the lower one is near this frequency.
            Roots::Two { frequency, quality } => Some(frequency * quality.min(1.0)),
        },
        _ => None,
    }
}

/// Whether one of the nodes is a slow filter.
fn slow(graph: &Graph, needed: &BTreeSet<NodeId>) -> bool {
    needed.iter().any(|&id| match &graph.nodes[id].operation {
        Operation::Step(step) => {
            lowest_frequency(step).is_some_and(|frequency| frequency < SLOW_FILTER)
        }
        _ => false,
    })
}
