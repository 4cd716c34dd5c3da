//! The records of one section that several protocols evaluate: each record is read once, and what
//! two protocols compute alike of it is computed once.

use std::{
    collections::BTreeMap,
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{
    memo::{Keys, Memo, locked},
    opened::{Fault, Opened, Reading},
    trial::Trial,
};
use crate::data::{
    Record,
    campaign::{ReadFile, RunStretch},
    record::Wanted,
    table::Cell,
};
use crate::run::{
    prelude::*,
    sections::{Extent, Unit},
};

/// How much was read and filtered, and how much it would have been for each protocol by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub records_read: usize,
    pub records_asked: usize,
    pub filters_run: usize,
    pub filters_asked: usize,
}

impl std::iter::Sum for Counts {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |a, b| Self {
            records_read: a.records_read + b.records_read,
            records_asked: a.records_asked + b.records_asked,
            filters_run: a.filters_run + b.filters_run,
            filters_asked: a.filters_asked + b.filters_asked,
        })
    }
}

/// Columns that the protocols read between them.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    pub record: Vec<String>,
    pub track: Vec<String>,
    /// Columns that records run along, in some protocol.
    pub axes: Vec<String>,
}

impl Columns {
    /// Adds those of a protocol.
    pub fn add(&mut self, plan: &Plan, graph: &Graph) {
        for axis in std::iter::once(&plan.axis).chain(&plan.time) {
            push(&mut self.axes, &axis.column);
            push(&mut self.record, &axis.column);
        }
        push(&mut self.track, &plan.axis.column);
        for node in &graph.nodes {
            if let Operation::Read { column } = &node.operation {
                push(if node.track { &mut self.track } else { &mut self.record }, column);
            }
        }
    }

    fn of(&self, kind: RecordKind) -> Vec<Wanted> {
        let names = if kind == RecordKind::Track { &self.track } else { &self.record };
        names
            .iter()
            .map(|name| Wanted { name: name.clone(), dimension: None, required: false })
            .collect()
    }
}

fn push(names: &mut Vec<String>, name: &str) {
    if !names.iter().any(|known| known == name) {
        names.push(name.to_string());
    }
}

/// The records of one section, in one trial.
#[derive(Debug)]
pub struct SectionRecords<'a> {
    campaign: &'a Campaign,
    cell: &'a Cell,
    columns: &'a Columns,
    /// The axis and where the section lies on it, where the campaign says so.
    place: Option<(String, Extent)>,
    /// The part of a run that is read.
    part: Option<RunStretch>,
    trial: Trial,
    /// The records as recorded.
    base: Option<&'a SectionRecords<'a>>,
    records: Mutex<BTreeMap<WhichRecord, Arc<SharedRecord>>>,
}

/// A record with all columns that some protocol reads.
#[derive(Debug)]
struct SharedRecord {
    record: Result<Option<(Record, ReadFile)>, Reason>,
    /// As protocols with the same axes and section see it.
    opened: Mutex<Vec<(View, Opened)>>,
    memo: Arc<Memo>,
    asked: AtomicUsize,
}

/// What the checks of a record depend on: axis, time, section, and which record it is. Protocols for
/// which these are the same share the opened record.
type View = (String, Option<String>, Option<Extent>, WhichRecord);

impl<'a> SectionRecords<'a> {
    /// `place`: the axis, where the section lies on it, and what is read of a run, as one of the
    /// protocols asks.
    pub fn new(
        campaign: &'a Campaign,
        cell: &'a Cell,
        columns: &'a Columns,
        place: Option<(String, Extent, Option<RunStretch>)>,
    ) -> Self {
        let (place, part) =
            place.map_or((None, None), |(axis, extent, part)| (Some((axis, extent)), part));
        Self {
            campaign,
            cell,
            columns,
            place,
            part,
            trial: Trial::AsRecorded,
            base: None,
            records: Mutex::default(),
        }
    }

    /// The same section with its records changed; records that stay keep what was computed of them.
    pub fn with(&'a self, trial: Trial) -> SectionRecords<'a> {
        SectionRecords {
            campaign: self.campaign,
            cell: self.cell,
            columns: self.columns,
            place: self.place.clone(),
            part: self.part.clone(),
            trial,
            base: Some(self),
            records: Mutex::default(),
        }
    }

    pub fn is_of(&self, unit: &Unit) -> bool {
        unit.cell.value == self.cell.value
    }

    fn rows(&self, record: &Record) -> std::ops::Range<usize> {
        let inside = self.place.as_ref().and_then(|(axis, (start, end))| {
            let axis = &record.column(axis)?.values;
            let from = axis.partition_point(|x| x < start);
            let to = axis.partition_point(|x| x <= end);
            (from < to).then_some(from..to)
        });
        inside.unwrap_or(0..record.rows)
    }

    fn changed(&self, mut record: Record) -> Result<Record, Reason> {
        let rows = self.rows(&record);
        self.trial.apply(&self.cell.value, &mut record, &self.columns.axes, rows)?;
        Ok(record)
    }

    fn shared(&self, which: WhichRecord) -> Arc<SharedRecord> {
        if let Some(base) = self.base.filter(|_| !self.trial.changes(which.kind)) {
            return base.shared(WhichRecord { kind: self.trial.kind(which.kind), ..which });
        }
        let mut records = locked(&self.records);
        let shared = records.entry(which).or_insert_with(|| {
            let record = match self.base {
                None => Ok(self
                    .campaign
                    .read(which, self.cell, &self.columns.of(which.kind), self.part.as_ref())
                    .ok()),
                Some(base) => match &base.shared(which).record {
                    Ok(Some((record, file))) => {
                        self.changed(record.clone()).map(|record| Some((record, file.clone())))
                    }
                    other => other.clone(),
                },
            };
            Arc::new(SharedRecord {
                record,
                opened: Mutex::default(),
                memo: Arc::default(),
                asked: AtomicUsize::new(0),
            })
        });
        Arc::clone(shared)
    }

    /// A record as a protocol asks for it. `None` where it cannot be had in common, as where
    /// protocols read different parts of a run: the protocol then reads it by itself, and says what
    /// is wrong with it.
    pub fn open(
        &self,
        reading: &Reading<'_>,
        wanted: &[Wanted],
        part: Option<&RunStretch>,
    ) -> Option<Result<Opened, Fault>> {
        if part != self.part.as_ref() {
            return None;
        }
        let shared = self.shared(reading.which);
        shared.asked.fetch_add(1, Ordering::Relaxed);
        let (record, file) = match &shared.record {
            Ok(record) => record.as_ref()?,
            Err(reason) => return Some(Err(Fault::new(reason.clone()))),
        };
        for wanted in wanted {
            let column = record.column(&wanted.name)?;
            if wanted.dimension.is_some_and(|dimension| dimension != column.unit.dimension) {
                return None;
            }
        }
        let Reading { plan, unit, which, .. } = *reading;
        let time = plan.time.as_ref().map(|time| time.column.clone());
        let view = (plan.axis.column.clone(), time, unit.extent, which);
        let mut known = locked(&shared.opened);
        if let Some((_, opened)) = known.iter().find(|(of, _)| *of == view) {
            return Some(Ok(opened.clone()));
        }
        let mut one = Opened::new(reading, (record.clone(), file.clone())).ok()?;
        one.memo = Some(Arc::clone(&shared.memo));
        known.push((view, one.clone()));
        Some(Ok(one))
    }

    /// A record read by one protocol alone, in this trial.
    pub fn read(
        &self,
        which: WhichRecord,
        wanted: &[Wanted],
        part: Option<&RunStretch>,
    ) -> Result<(Record, ReadFile), Vec<Problem>> {
        let kind = self.trial.kind(which.kind);
        let (record, file) =
            self.campaign.read(WhichRecord { kind, ..which }, self.cell, wanted, part)?;
        if !self.trial.changes(which.kind) {
            return Ok((record, file));
        }
        let changed = self.changed(record);
        let record =
            changed.map_err(|reason| vec![Problem::error("not-disturbed", reason.text())])?;
        Ok((record, file))
    }

    /// What was done for this section in this trial, without what its base did.
    pub fn counts(&self) -> Counts {
        let of = |shared: &Arc<SharedRecord>| {
            let (filters_run, filters_asked) = shared.memo.counts();
            let read = self.base.is_none() && matches!(shared.record, Ok(Some(_)));
            Counts {
                records_read: usize::from(read),
                records_asked: shared.asked.load(Ordering::Relaxed),
                filters_run,
                filters_asked,
            }
        };
        locked(&self.records).values().map(of).sum()
    }
}

/// A protocol's part in what is shared of a section.
#[derive(Clone, Copy, Debug)]
pub struct Sharing<'a> {
    pub records: &'a SectionRecords<'a>,
    pub keys: &'a Keys,
}
