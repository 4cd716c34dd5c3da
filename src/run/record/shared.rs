//! What several protocols share of one section: each record is read once, and what two protocols
//! compute alike of it is computed once.
//!
//! Two nodes of two graphs are alike if they do the same with the same: operation, inputs, and the
//! values of all names in them, for this section. Each such operation has a number ([`Keys`]); its
//! result is kept under this number while the section is worked on ([`Memo`]).

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use indexmap::IndexMap;

use super::signal::{Extent, Signal};
use super::trial::Trial;
use super::{Fault, Opened, Work, chosen, opened};
use crate::check::evaluate::number;
use crate::check::plan::AxisOperation;
use crate::data::campaign::{Part, ReadFile};
use crate::data::record::Wanted;
use crate::data::table::Cell;
use crate::data::{Campaign, Record, RecordKind, WhichRecord};
use crate::graph::{Graph, Operation};
use crate::problem::Problem;
use crate::run::sections::{Known, Unit};

/// The number of what each node of a graph does, the same in every graph; `None` for nodes that
/// join records.
pub type Keys = Vec<Option<usize>>;

/// What nodes do in one section, in words, with their numbers.
#[derive(Debug, Default)]
pub struct Numbers(IndexMap<String, usize>);

impl Numbers {
    fn of(&mut self, what: String) -> usize {
        let next = self.0.len();
        *self.0.entry(what).or_insert(next)
    }

    /// Numbers the nodes of a protocol's graph for a section.
    pub fn keys(&mut self, work: &Work<'_>, unit: &Unit) -> Keys {
        let known = unit.known(work.facts);
        let mut keys: Keys = Vec::with_capacity(work.graph.nodes.len());
        for node in &work.graph.nodes {
            let inputs: Option<Vec<usize>> = node.inputs.iter().map(|&input| keys[input]).collect();
            let key = match (&node.operation, inputs) {
                (Operation::Select(conditions), _) => chosen(conditions, &node.inputs, &known)
                    .ok()
                    .and_then(|input| keys[node.inputs[input]]),
                (operation, Some(inputs)) => does(work, unit, &known, operation, node.track)
                    .map(|what| self.of(format!("{what} {inputs:?}"))),
                _ => None,
            };
            keys.push(key);
        }
        keys
    }
}

/// What an operation does, all names put in. `None` where it does not work on one record, or a name
/// has no value.
fn does(
    work: &Work<'_>,
    unit: &Unit,
    known: &Known<'_>,
    operation: &Operation,
    track: bool,
) -> Option<String> {
    let place =
        || format!("{:?}", unit.extent.map(|(start, end)| (start.to_bits(), end.to_bits())));
    Some(match operation {
        Operation::Read { column } => {
            let time = work.plan.time.as_ref().map(|time| &time.column);
            format!("read {column:?} {track} {:?} {time:?}", work.plan.axis.column)
        }
        Operation::Constant(expr) => format!("constant {:x}", number(expr, known).ok()?.to_bits()),
        Operation::Arithmetic(operator) => format!("{operator:?}"),
        Operation::Negative => "negative".into(),
        Operation::Power(exponent) => format!("power {exponent}"),
        Operation::Apply(function) => format!("apply {}", function.name),
        Operation::OverAxis(AxisOperation::Shifted(distance)) => {
            format!("shifted {:x} {}", number(distance, known).ok()?.to_bits(), place())
        }
        Operation::OverAxis(AxisOperation::Derivative { over_time }) => {
            format!("derivative {over_time}")
        }
        Operation::OverAxis(AxisOperation::Integral { over_time }) => {
            format!("integral {over_time}")
        }
        Operation::Level => format!("level {}", place()),
        Operation::Step(spec) => format!("step {spec:?}"),
        Operation::Cut => format!("cut {}", place()),
        Operation::Window(spec) => format!("window {spec:?} {}", place()),
        Operation::Reduce(reducer) => {
            format!("reduce {} {:?}", reducer.in_words(), work.plan.sections.percentiles)
        }
        Operation::Select(_)
        | Operation::Value(_)
        | Operation::Compare(_)
        | Operation::Estimate(_)
        | Operation::Report(_)
        | Operation::Limit(_)
        | Operation::Verdict(_) => return None,
    })
}

/// A result of a node.
#[derive(Clone, Debug)]
pub enum Kept {
    Signal(Signal),
    /// A reduced signal, and of how many samples.
    Number(f64, usize),
}

/// Results of one record by the numbers of what made them.
#[derive(Debug, Default)]
pub struct Memo {
    results: Mutex<Vec<Option<Kept>>>,
    filtered: AtomicUsize,
    asked: AtomicUsize,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A thread that panicked ends the run; what it left is not looked at.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Memo {
    pub fn get(&self, key: usize) -> Option<Kept> {
        locked(&self.results).get(key).cloned().flatten()
    }

    pub fn put(&self, key: usize, kept: Kept) {
        let mut results = locked(&self.results);
        if results.len() <= key {
            results.resize(key + 1, None);
        }
        results[key] = Some(kept);
    }

    /// Signals that a filter ran over.
    pub fn count_filtered(&self, signals: usize) {
        self.filtered.fetch_add(signals, Ordering::Relaxed);
    }

    /// Signals that a protocol by itself would have filtered.
    pub fn count_asked(&self, signals: usize) {
        self.asked.fetch_add(signals, Ordering::Relaxed);
    }
}

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
    pub fn add(&mut self, axis: &str, time: Option<&str>, graph: &Graph) {
        for name in [Some(axis), time].into_iter().flatten() {
            push(&mut self.axes, name);
            push(&mut self.record, name);
        }
        push(&mut self.track, axis);
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
pub struct Store<'a> {
    campaign: &'a Campaign,
    cell: &'a Cell,
    columns: &'a Columns,
    /// The axis and where the section lies on it, where the campaign says so.
    place: Option<(String, Extent)>,
    /// The part of a run that is read.
    part: Option<Part>,
    trial: Trial,
    /// The records as recorded.
    base: Option<&'a Store<'a>>,
    records: Mutex<BTreeMap<WhichRecord, Arc<Shared>>>,
}

/// A record with all columns that some protocol reads.
#[derive(Debug)]
struct Shared {
    record: Result<Option<(Record, ReadFile)>, String>,
    /// As protocols with the same axes and section see it.
    opened: Mutex<Vec<(String, Opened)>>,
    memo: Arc<Memo>,
    asked: AtomicUsize,
}

impl<'a> Store<'a> {
    /// `place`: the axis, where the section lies on it, and what is read of a run, as one of the
    /// protocols asks.
    pub fn new(
        campaign: &'a Campaign,
        cell: &'a Cell,
        columns: &'a Columns,
        place: Option<(String, Extent, Option<Part>)>,
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
    pub fn with(&'a self, trial: Trial) -> Store<'a> {
        Store {
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

    fn changed(&self, mut record: Record) -> Result<Record, String> {
        let rows = self.rows(&record);
        self.trial.apply(&self.cell.value, &mut record, &self.columns.axes, rows)?;
        Ok(record)
    }

    fn shared(&self, which: WhichRecord) -> Arc<Shared> {
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
            Arc::new(Shared {
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
        work: &Work<'_>,
        unit: &Unit,
        which: WhichRecord,
        wanted: &[Wanted],
        part: Option<&Part>,
    ) -> Option<Result<Opened, Fault>> {
        if part != self.part.as_ref() {
            return None;
        }
        let shared = self.shared(which);
        shared.asked.fetch_add(1, Ordering::Relaxed);
        let (record, file) = match &shared.record {
            Ok(record) => record.as_ref()?,
            Err(says) => return Some(Err(Fault::new(says.clone()))),
        };
        for wanted in wanted {
            let column = record.column(&wanted.name)?;
            if wanted.dimension.is_some_and(|dimension| dimension != column.unit.dimension) {
                return None;
            }
        }
        let time = work.plan.time.as_ref().map(|time| &time.column);
        let key = format!("{:?} {time:?} {:?} {:?}", work.plan.axis.column, unit.extent, which);
        let mut known = locked(&shared.opened);
        if let Some((_, opened)) = known.iter().find(|(of, _)| *of == key) {
            return Some(Ok(opened.clone()));
        }
        let mut one = opened(work, unit, which, record.clone(), file.clone()).ok()?;
        one.memo = Some(Arc::clone(&shared.memo));
        known.push((key, one.clone()));
        Some(Ok(one))
    }

    /// A record read by one protocol alone, in this trial.
    pub fn read(
        &self,
        which: WhichRecord,
        wanted: &[Wanted],
        part: Option<&Part>,
    ) -> Result<(Record, ReadFile), Vec<Problem>> {
        let kind = self.trial.kind(which.kind);
        let (record, file) =
            self.campaign.read(WhichRecord { kind, ..which }, self.cell, wanted, part)?;
        let record = if self.trial.changes(which.kind) {
            self.changed(record).map_err(|says| vec![Problem::error("not-disturbed", says)])?
        } else {
            record
        };
        Ok((record, file))
    }

    /// What was done for this section in this trial, without what its base did.
    pub fn counts(&self) -> Counts {
        let of = |shared: &Arc<Shared>| Counts {
            records_read: usize::from(self.base.is_none() && matches!(shared.record, Ok(Some(_)))),
            records_asked: shared.asked.load(Ordering::Relaxed),
            filters_run: shared.memo.filtered.load(Ordering::Relaxed),
            filters_asked: shared.memo.asked.load(Ordering::Relaxed),
        };
        locked(&self.records).values().map(of).sum()
    }
}

/// A protocol's part in what is shared of a section.
#[derive(Clone, Copy, Debug)]
pub struct Sharing<'a> {
    pub store: &'a Store<'a>,
    pub keys: &'a Keys,
}
