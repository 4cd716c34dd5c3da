//! One record through the signal nodes of the graph.

mod held;
pub mod shared;
pub mod signal;
mod state;
mod stretch;
pub mod trial;

pub use held::Held;
use state::State;
use stretch::Stretched;
pub use stretch::{Soundness, Stretches};

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::check::evaluate::flag;
use crate::check::plan::{Axis, Plan, Side};
use crate::data::campaign::{Part, ReadFile};
use crate::data::checks::{Section, check_axis, whole};
use crate::data::record::Wanted;
use crate::data::{Campaign, Campaigns, Record, RecordKind, WhichRecord, qualified};
use crate::graph::{Graph, NodeId, Operation};
use crate::metrics::percentile::Method;
use crate::problem::Problem;
use crate::result::{FileHash, RecordOf};
use crate::run::sections::{Facts, Known, Unit};
use crate::units::Dimension;
use shared::Memo;
pub use shared::{Columns, Counts, Keys, Numbers, Sharing, Store};
pub use signal::{Along, Extent, Rate, Samples, Signal, apply, arithmetic, each};
pub use trial::Trial;

/// Data used for every record.
#[derive(Clone, Copy, Debug)]
pub struct Work<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub campaigns: Campaigns<'a>,
    pub facts: &'a Facts,
    /// All sections; a repeat needs that of its original.
    pub units: &'a [Unit],
    /// For each campaign and each position of each quantity, whether its channels were recorded.
    pub present: &'a [Vec<Vec<bool>>],
    /// The same for each position of each plausibility rule.
    pub recorded: &'a [Vec<Vec<bool>>],
    /// What is shared with other protocols, of the section that is worked on.
    pub shared: Option<Sharing<'a>>,
    /// Which stretches are sound.
    pub soundness: &'a Soundness,
    /// The records of the stretch that the section that is worked on shares with its neighbours.
    pub stretches: Option<&'a Stretches>,
}

impl<'a> Work<'a> {
    /// The campaign of a section.
    pub fn campaign(&self, unit: &Unit) -> &'a Campaign {
        self.campaigns.get(unit.campaign)
    }

    /// What is shared of a section.
    pub fn sharing(&self, unit: &Unit) -> Option<Sharing<'a>> {
        self.shared.filter(|shared| shared.store.is_of(unit))
    }

    /// Whether the protocol evaluates records of a side.
    pub fn reads(&self, side: Side) -> bool {
        self.plan.reads(side)
    }
}

/// A reason why a record cannot be used, and the problems that caused it.
#[derive(Debug)]
pub struct Fault {
    pub says: String,
    pub problems: Vec<Problem>,
}

impl Fault {
    pub fn new(says: impl Into<String>) -> Self {
        Self { says: says.into(), problems: Vec::new() }
    }

    /// What is wrong with a record of a campaign.
    fn of(campaign: &Campaign, problems: Vec<Problem>) -> Self {
        Self { says: said(campaign, &problems), problems }
    }

    /// The faults of both records of a section.
    pub fn and(mut self, other: Self) -> Self {
        self.says = if self.says == other.says {
            self.says
        } else {
            format!("{}; {}", self.says, other.says)
        };
        self.problems.extend(other.problems);
        self
    }
}

/// A record that was read and covers the section.
#[derive(Clone, Debug)]
pub struct Opened {
    /// Name and samples.
    columns: Arc<Vec<(String, Arc<Vec<f64>>)>>,
    along: Arc<Along>,
    pub extent: Extent,
    pub file: FileHash,
    /// Time recorded before and after the section, in s, where records have a time.
    pub margins: Option<(f64, f64)>,
    /// What protocols that share the record have computed of it.
    pub memo: Option<Arc<Memo>>,
    /// Of a stretch that sections share: the part of it that this section would read by itself.
    own: Option<Extent>,
    /// What sections that share the stretch have computed of it.
    stretch: Option<Arc<Stretched>>,
}

/// Value of a requested node.
#[derive(Clone, Debug)]
pub enum Found {
    /// A value of a signal, and the number of samples or windows.
    Number(f64, usize),
    Samples(Samples),
    /// The value cannot be computed from this record: the reason.
    Failed(String),
}

/// All nodes that the requested ones need in one section; of the cases of a signal, only the one
/// that applies.
pub fn needed(
    graph: &Graph,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
) -> Result<BTreeSet<NodeId>, String> {
    let mut needed = BTreeSet::new();
    let mut open: Vec<NodeId> = wanted.iter().copied().collect();
    while let Some(id) = open.pop() {
        if !needed.insert(id) {
            continue;
        }
        let node = &graph.nodes[id];
        match &node.operation {
            Operation::Select(conditions) => {
                open.push(node.inputs[chosen(conditions, &node.inputs, known)?])
            }
            _ => open.extend(&node.inputs),
        }
    }
    Ok(needed)
}

/// The input of a `Select` that applies in this section.
pub fn chosen(
    conditions: &[crate::check::plan::Expr],
    inputs: &[NodeId],
    known: &Known<'_>,
) -> Result<usize, String> {
    for (index, condition) in conditions.iter().enumerate() {
        if flag(condition, known)? {
            return Ok(index);
        }
    }
    if inputs.len() > conditions.len() {
        return Ok(inputs.len() - 1);
    }
    Err(format!(
        "none of the cases of `{}` applies to this section",
        conditions.first().map_or(String::new(), crate::check::evaluate::words)
    ))
}

/// Reads and checks a record of one section, and evaluates the nodes that are wanted with
/// `evaluate`.
///
/// # Errors
/// The record cannot be read or does not cover the section. What `evaluate` says stands beside the
/// record.
pub fn with_record<T>(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    evaluate: impl FnOnce(&Opened, &BTreeSet<NodeId>) -> Result<T, String>,
) -> Result<(Result<T, Fault>, Opened), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, which, &columns(work, which, &needed, true))?;
    let found = evaluate(&opened, &needed)
        .map_err(|says| Fault::new(format!("{}: {says}", opened.file.path)));
    Ok((found, opened))
}

/// The columns of a record that nodes need; `required`: whether the record must have them all.
fn columns(
    work: &Work<'_>,
    which: WhichRecord,
    needed: &BTreeSet<NodeId>,
    required: bool,
) -> Vec<Wanted> {
    let axis = &work.plan.axis;
    let mut wanted = vec![Wanted::new(axis.column.as_str(), axis.unit.dimension)];
    if let Some(time) = clock(work.plan, which) {
        wanted.push(Wanted::new(time.column.as_str(), time.unit.dimension));
    }
    for &id in needed {
        let node = &work.graph.nodes[id];
        if let Operation::Read { column } = &node.operation
            && node.track == (which.kind == RecordKind::Track)
            && !wanted.iter().any(|known| known.name == *column)
        {
            wanted.push(Wanted { required, ..Wanted::new(column.as_str(), node.dimension) });
        }
    }
    wanted
}

/// The time of a record that runs along something else.
fn clock(plan: &Plan, which: WhichRecord) -> Option<&Axis> {
    plan.time
        .as_ref()
        .filter(|time| which.kind != RecordKind::Track && time.column != plan.axis.column)
}

fn open(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    wanted: &[Wanted],
) -> Result<Opened, Fault> {
    let Some(sharing) = work.sharing(unit) else {
        let has =
            |stretched: &Arc<Stretched>| wanted.iter().all(|wanted| stretched.has(&wanted.name));
        if let Some(opened) = stretch::shared(work, unit, which, wanted)?
            .filter(has)
            .and_then(|stretched| stretched.section(work, unit, which))
        {
            return Ok(opened);
        }
        let read =
            work.campaign(unit).read(which, &unit.cell, wanted, part(work.plan, unit).as_ref());
        let (record, read) = read.map_err(|problems| Fault::of(work.campaign(unit), problems))?;
        return opened(work, unit, which, record, read);
    };
    let part = match unit.stretch {
        Some(stretch) if stretch::is_sound(work, unit, which)? => Some(stretch.part(work.plan)),
        _ => part(work.plan, unit),
    };
    if let Some(opened) = sharing.store.open(work, unit, which, wanted, part.as_ref()) {
        return opened;
    }
    let (record, read) = sharing
        .store
        .read(which, wanted, part.as_ref())
        .map_err(|problems| Fault::of(work.campaign(unit), problems))?;
    opened(work, unit, which, record, read)
}

/// The part of a run that a section reads by itself.
pub fn part(plan: &Plan, unit: &Unit) -> Option<Part> {
    unit.extent.map(|extent| Part::around(&plan.axis.column, extent, plan.sections.margin))
}

/// A record that was read, checked for the section.
pub fn opened(
    work: &Work<'_>,
    unit: &Unit,
    which: WhichRecord,
    record: Record,
    read: ReadFile,
) -> Result<Opened, Fault> {
    let axis = &work.plan.axis;
    let section = unit.extent.map(|(start, end)| Section { start, end, at: unit.span.clone() });
    let time = clock(work.plan, which).map_or(axis.column.as_str(), |time| time.column.as_str());
    let checked = check_axis(&record, time, &axis.column, section.as_ref());
    let checked = checked.map_err(|problems| Fault::of(work.campaign(unit), problems))?;
    let sampled = Sampled::new(work.plan, which, record, checked.sampling_rate);
    let along_axis = &sampled.along.axis;
    let extent = unit.extent.unwrap_or_else(|| {
        (along_axis.first().copied().unwrap_or(0.0), along_axis.last().copied().unwrap_or(0.0))
    });
    let margins = sampled.in_time.then_some((checked.before, checked.after));
    let own = unit.stretch.and_then(|_| part(work.plan, unit)).map(|part| (part.from, part.to));
    let (file, Sampled { columns, along, .. }) = (file_of(work, unit, which, &read), sampled);
    Ok(Opened { columns, along, extent, file, margins, memo: None, own, stretch: None })
}

fn file_of(work: &Work<'_>, unit: &Unit, which: WhichRecord, read: &ReadFile) -> FileHash {
    let name = work.campaign(unit).record_name(which).map(ToString::to_string);
    let of = RecordOf { kind: which.kind.key().into(), section: unit.name.clone(), name };
    let path = qualified(unit.campaign_name.as_deref(), &read.path);
    FileHash { path, sha256: read.sha256.clone(), bytes: read.bytes, record: Some(of) }
}

/// The samples of a record.
#[derive(Debug)]
struct Sampled {
    columns: Arc<Vec<(String, Arc<Vec<f64>>)>>,
    along: Arc<Along>,
    /// Whether the record has a time.
    in_time: bool,
}

impl Sampled {
    /// Of a record whose axes are sound.
    fn new(plan: &Plan, which: WhichRecord, record: Record, rate: f64) -> Self {
        let first_row = record.row_shown(0);
        let columns: Vec<_> = record
            .columns
            .into_iter()
            .map(|column| (column.name, Arc::new(column.values)))
            .collect();
        let values = |name: &str| {
            columns.iter().find(|(known, _)| known == name).map(|(_, values)| Arc::clone(values))
        };
        let time = clock(plan, which);
        let in_time = time.is_some() || plan.axis.unit.dimension == Dimension::TIME;
        let along = Arc::new(Along {
            axis: values(&plan.axis.column).unwrap_or_default(),
            time: time.and_then(|time| values(&time.column)),
            rate: if in_time { Rate::PerTime(rate) } else { Rate::PerLength(rate) },
            first_row: Some(first_row),
        });
        Self { columns: Arc::new(columns), along, in_time }
    }
}

/// Several problems in one line, each with its place unless the text already names it, and with its
/// help.
fn said(campaign: &Campaign, problems: &[Problem]) -> String {
    let mut told: Vec<(&Problem, usize)> = Vec::new();
    for problem in problems {
        // The same problem in several rows is stated once.
        match told.iter_mut().find(|(first, _)| first.says == problem.says) {
            Some((_, more)) => *more += 1,
            None => told.push((problem, 0)),
        }
    }
    let sentence = |(problem, more): &(&Problem, usize)| {
        let fact = match &problem.at {
            Some(at) => placed(&problem.says, campaign.inside(&at.source.name), at.line(), *more),
            None => problem.says.clone(),
        };
        problem.help.as_ref().map_or(fact.clone(), |help| format!("{fact}: {help}"))
    };
    told.iter().map(sentence).collect::<Vec<_>>().join("; ")
}

/// Adds the place to a text. A text that names file and row needs none; one that names the file
/// needs none in the header.
fn placed(says: &str, file: &str, row: usize, more: usize) -> String {
    let names_file = says.contains(&format!("`{file}`"));
    let names_row =
        row == 1 || says.split(|c: char| !c.is_ascii_digit()).any(|word| word.parse() == Ok(row));
    match more {
        0 if names_file && names_row => says.to_string(),
        0 => format!("{says} ({file}, row {row})"),
        _ => format!("{says} ({file}, row {row} and {more} more)"),
    }
}

impl Opened {
    /// A piece of a run, in which sections are looked for.
    pub fn piece(
        plan: &Plan,
        track: bool,
        columns: Vec<(String, Vec<f64>)>,
        first_row: usize,
    ) -> Self {
        let columns: Vec<_> =
            columns.into_iter().map(|(name, values)| (name, Arc::new(values))).collect();
        let values = |name: &str| {
            columns.iter().find(|(known, _)| known == name).map(|(_, values)| Arc::clone(values))
        };
        let axis = values(&plan.axis.column).unwrap_or_default();
        let time = plan.time.as_ref().filter(|_| !track).and_then(|time| values(&time.column));
        let rate = |clock: &[f64]| match clock {
            [first, .., last] => whole((clock.len() - 1) as f64 / (last - first)),
            _ => 1.0,
        };
        let rate = match &time {
            Some(time) => Rate::PerTime(rate(time)),
            None if plan.axis.unit.dimension == Dimension::TIME => Rate::PerTime(rate(&axis)),
            None => Rate::PerLength(rate(&axis)),
        };
        let extent = (axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0));
        let file = FileHash { path: String::new(), sha256: String::new(), bytes: 0, record: None };
        let along = Arc::new(Along { axis, time, rate, first_row: Some(first_row) });
        Self {
            columns: Arc::new(columns),
            along,
            extent,
            file,
            margins: None,
            memo: None,
            own: None,
            stretch: None,
        }
    }

    /// A signal, no longer than what the section would read by itself.
    pub fn around_section(&self, samples: Samples) -> Samples {
        match self.own.map(|own| samples.cut(own)) {
            Some(Ok(cut)) => cut,
            _ => samples,
        }
    }

    /// First and last row of the file inside the section, and of all that was read and is filtered;
    /// the header is row 1.
    pub fn rows(&self) -> [(usize, usize); 2] {
        let first = self.along.first_row.unwrap_or(1);
        let inside = self.along.inside(self.extent);
        [
            (first + inside.start, first + inside.end.saturating_sub(1)),
            (first, first + self.along.axis.len().saturating_sub(1)),
        ]
    }

    /// Values of the requested nodes. Nodes run level by level, so that channels with the same
    /// filter are filtered together.
    pub fn evaluate(
        &self,
        graph: &Graph,
        needed: &BTreeSet<NodeId>,
        wanted: &BTreeSet<NodeId>,
        known: &Known<'_>,
        method: Method,
        keys: Option<&Keys>,
    ) -> Result<Vec<(NodeId, Found)>, String> {
        let mut state = State::new(self, graph, known, method);
        state.memo = self.memo.as_deref().zip(keys);
        let left = state.recall(needed, wanted);
        let levels = state.count(left.as_ref().unwrap_or(needed));
        let done = state.on_stretch(needed, wanted, &levels)?;
        state.run(&levels, wanted, |id| !done[id])?;
        Ok(state.found)
    }

    /// Runs the nodes that do not depend on the place of the section: filters run, nothing is cut.
    pub fn hold<'a>(
        &'a self,
        graph: &'a Graph,
        needed: &BTreeSet<NodeId>,
        wanted: &'a BTreeSet<NodeId>,
        known: &'a Known<'a>,
        method: Method,
    ) -> Result<Held<'a>, String> {
        let mut state = State::new(self, graph, known, method);
        let levels = state.count(needed);
        let here = |operation: &Operation| {
            matches!(operation, Operation::Cut | Operation::Window(_) | Operation::Reduce(_))
        };
        let placed = stretch::leading(graph, needed, here);
        let done = state.on_stretch(needed, wanted, &levels)?;
        state.run(&levels, wanted, |id| !placed[id] && !done[id])?;
        Ok(Held { state, levels, placed, wanted })
    }
}
