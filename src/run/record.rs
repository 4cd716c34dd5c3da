//! One record through the signal nodes of the graph.

mod held;

pub use held::Held;

use std::collections::BTreeSet;
use std::sync::Arc;

use super::facts::{Facts, Known};
use super::sections::Unit;
use super::shared::{Kept, Keys, Memo, Sharing};
use super::signal::{Along, Cutter, Extent, Rate, Samples, Signal, apply, arithmetic, each};
use crate::catalog::Reducer;
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Plan, Side, StepSpec};
use crate::data::campaign::ReadFile;
use crate::data::checks::{Section, check_axis};
use crate::data::record::Wanted;
use crate::data::{Campaign, Campaigns, Record, RecordKind, WhichRecord, qualified};
use crate::graph::{Graph, NodeId, Operation};
use crate::metrics::percentile::{Method, percentiles};
use crate::problem::Problem;
use crate::result::{FileHash, RecordOf};
use crate::units::Dimension;

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

    /// The faults of both records of a section.
    pub fn and(mut self, other: Self) -> Self {
        self.says = if self.says == other.says { self.says } else { format!("{}; {}", self.says, other.says) };
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

/// All nodes that the requested ones need in one section; of the cases of a signal, only the one that applies.
pub fn needed(graph: &Graph, wanted: &BTreeSet<NodeId>, known: &Known<'_>) -> Result<BTreeSet<NodeId>, String> {
    let mut needed = BTreeSet::new();
    let mut open: Vec<NodeId> = wanted.iter().copied().collect();
    while let Some(id) = open.pop() {
        if !needed.insert(id) {
            continue;
        }
        let node = &graph.nodes[id];
        match &node.operation {
            Operation::Select(conditions) => open.push(node.inputs[chosen(conditions, &node.inputs, known)?]),
            _ => open.extend(&node.inputs),
        }
    }
    Ok(needed)
}

/// The input of a `Select` that applies in this section.
pub fn chosen(conditions: &[crate::check::plan::Expr], inputs: &[NodeId], known: &Known<'_>) -> Result<usize, String> {
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

/// Reads and checks a record of one section.
pub fn open(work: &Work<'_>, unit: &Unit, which: WhichRecord, needed: &BTreeSet<NodeId>) -> Result<Opened, Fault> {
    let axis = &work.plan.axis;
    let mut wanted = vec![Wanted::new(axis.column.as_str(), axis.unit.dimension)];
    let time = work.plan.time.as_ref().filter(|time| which.kind != RecordKind::Track && time.column != axis.column);
    if let Some(time) = time {
        wanted.push(Wanted::new(time.column.as_str(), time.unit.dimension));
    }
    for &id in needed {
        if let Operation::Read { column } = &work.graph.nodes[id].operation
            && !wanted.iter().any(|known| known.name == *column)
        {
            wanted.push(Wanted::new(column.as_str(), work.graph.nodes[id].dimension));
        }
    }
    let sharing = work.sharing(unit);
    if let Some(opened) = sharing.and_then(|sharing| sharing.store.open(work, unit, which, &wanted)) {
        return opened;
    }
    let read = match sharing {
        Some(sharing) => sharing.store.read(which, &wanted),
        None => work.campaign(unit).read(which, &unit.cell, &wanted),
    };
    let (record, read) = read.map_err(|problems| Fault { says: said(work.campaign(unit), &problems), problems })?;
    opened(work, unit, which, record, read)
}

/// A record that was read, checked for the section.
pub fn opened(work: &Work<'_>, unit: &Unit, which: WhichRecord, record: Record, read: ReadFile) -> Result<Opened, Fault> {
    let fault = |problems: Vec<Problem>| Fault { says: said(work.campaign(unit), &problems), problems };
    let axis = &work.plan.axis;
    let time = work.plan.time.as_ref().filter(|time| which.kind != RecordKind::Track && time.column != axis.column);
    let clock = time.map_or(axis.column.as_str(), |time| time.column.as_str());
    let section = unit.extent.map(|(start, end)| Section { start, end, at: unit.span.clone() });
    let checked = check_axis(&record, clock, &axis.column, section.as_ref()).map_err(fault)?;
    let name = work.campaign(unit).record_name(which).map(ToString::to_string);
    let of = RecordOf { kind: which.kind.key().into(), section: unit.name.clone(), name };
    let path = qualified(unit.campaign_name.as_deref(), &read.path);
    let file = FileHash { path, sha256: read.sha256, bytes: read.bytes, record: Some(of) };
    let columns: Vec<_> = record.columns.into_iter().map(|column| (column.name, Arc::new(column.values))).collect();
    let values = |name: &str| columns.iter().find(|(known, _)| known == name).map(|(_, values)| Arc::clone(values));
    let along_axis = values(&axis.column).unwrap_or_default();
    let extent = unit.extent.unwrap_or_else(|| (along_axis.first().copied().unwrap_or(0.0), along_axis.last().copied().unwrap_or(0.0)));
    let in_time = time.is_some() || axis.unit.dimension == Dimension::TIME;
    let along = Arc::new(Along {
        axis: along_axis,
        time: time.and_then(|time| values(&time.column)),
        rate: if in_time { Rate::PerTime(checked.sampling_rate) } else { Rate::PerLength(checked.sampling_rate) },
        // The header is row 1.
        first_row: Some(2),
    });
    let margins = in_time.then_some((checked.before, checked.after));
    Ok(Opened { columns: Arc::new(columns), along, extent, file, margins, memo: None })
}

/// Several problems in one line, each with its place unless the text already names it, and with its help.
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

/// Adds the place to a text. A text that names file and row needs none; one that names the file needs none in the header.
fn placed(says: &str, file: &str, row: usize, more: usize) -> String {
    let names_file = says.contains(&format!("`{file}`"));
    let names_row = row == 1 || says.split(|c: char| !c.is_ascii_digit()).any(|word| word.parse() == Ok(row));
    match more {
        0 if names_file && names_row => says.to_string(),
        0 => format!("{says} ({file}, row {row})"),
        _ => format!("{says} ({file}, row {row} and {more} more)"),
    }
}

impl Opened {
    /// First and last row of the file inside the section, and the last row of the file; the header is row 1.
    pub fn rows(&self) -> ((usize, usize), usize) {
        let first = self.along.first_row.unwrap_or(1);
        let inside = self.along.inside(self.extent);
        ((first + inside.start, first + inside.end.saturating_sub(1)), first + self.along.axis.len().saturating_sub(1))
    }

    /// Values of the requested nodes. Nodes run level by level, so that channels with the same filter are filtered together.
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
        state.run(&levels, wanted, |_| true)?;
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
        let mut placed = vec![false; graph.nodes.len()];
        for &id in needed {
            let node = &graph.nodes[id];
            let here = matches!(node.operation, Operation::Cut | Operation::Window(_) | Operation::Reduce(_));
            placed[id] = here || node.inputs.iter().any(|&input| placed[input]);
        }
        state.run(&levels, wanted, |id| !placed[id])?;
        Ok(Held { state, levels, placed, wanted })
    }
}

#[derive(Clone, Debug)]
struct State<'a> {
    opened: &'a Opened,
    graph: &'a Graph,
    known: &'a Known<'a>,
    method: Method,
    values: Vec<Option<Signal>>,
    /// Why a node has no value. Nodes that depend on it have none either; the others run on.
    failed: Vec<Option<String>>,
    /// Number of nodes that still need the value.
    uses: Vec<usize>,
    cutter: Cutter,
    /// The part of the section that is evaluated.
    extent: Extent,
    found: Vec<(NodeId, Found)>,
    /// Where results are kept for other protocols, and under which numbers.
    memo: Option<(&'a Memo, &'a Keys)>,
}

impl<'a> State<'a> {
    fn new(opened: &'a Opened, graph: &'a Graph, known: &'a Known<'a>, method: Method) -> Self {
        let nodes = graph.nodes.len();
        let cutter = Cutter::new(opened.extent);
        Self {
            opened,
            graph,
            known,
            method,
            values: vec![None; nodes],
            failed: vec![None; nodes],
            uses: vec![0; nodes],
            cutter,
            extent: opened.extent,
            found: Vec::new(),
            memo: None,
        }
    }

    /// The needed nodes by level, inputs before the nodes that use them, and the number of uses of each.
    fn count(&mut self, needed: &BTreeSet<NodeId>) -> Vec<Vec<NodeId>> {
        let mut level = vec![0_usize; self.graph.nodes.len()];
        let mut levels: Vec<Vec<NodeId>> = Vec::new();
        for &id in needed {
            for &input in &self.graph.nodes[id].inputs {
                if needed.contains(&input) {
                    self.uses[input] += 1;
                    level[id] = level[id].max(level[input] + 1);
                }
            }
            levels.resize_with(levels.len().max(level[id] + 1), Vec::new);
            levels[level[id]].push(id);
        }
        levels
    }

    /// Runs the chosen nodes and keeps the values of the requested ones.
    fn run(&mut self, levels: &[Vec<NodeId>], wanted: &BTreeSet<NodeId>, chosen: impl Fn(NodeId) -> bool) -> Result<(), String> {
        for level in levels {
            let here: Vec<NodeId> = level.iter().copied().filter(|&id| chosen(id)).collect();
            let before = self.found.len();
            self.filters(&here)?;
            self.reducers(&here)?;
            for &id in &here {
                if self.values[id].is_none() && self.failed[id].is_none() && !matches!(self.graph.nodes[id].operation, Operation::Reduce(_))
                {
                    self.value(id)?;
                }
            }
            self.keep(&here, before);
            for &id in &here {
                if wanted.contains(&id) {
                    if let Some(reason) = &self.failed[id] {
                        self.found.push((id, Found::Failed(reason.clone())));
                    } else if self.values[id].is_some() {
                        let samples = self.samples(id)?;
                        self.found.push((id, Found::Samples(samples)));
                    }
                }
                self.release(id);
            }
        }
        Ok(())
    }
}

impl State<'_> {
    /// Takes what others have computed of this record already; what is left to compute, where results are shared.
    fn recall(&mut self, needed: &BTreeSet<NodeId>, wanted: &BTreeSet<NodeId>) -> Option<BTreeSet<NodeId>> {
        let (memo, keys) = self.memo?;
        let filters = |id: &&NodeId| matches!(&self.graph.nodes[**id].operation, Operation::Step(spec) if spec.is_filter());
        memo.count_asked(needed.iter().filter(filters).count());
        let mut left = BTreeSet::new();
        let mut seen = BTreeSet::new();
        let mut open: Vec<NodeId> = wanted.iter().copied().collect();
        while let Some(id) = open.pop() {
            if !seen.insert(id) {
                continue;
            }
            match keys[id].and_then(|key| memo.get(key)) {
                Some(Kept::Signal(signal)) => {
                    self.values[id] = Some(signal);
                    if wanted.contains(&id)
                        && let Ok(samples) = self.samples(id)
                    {
                        self.found.push((id, Found::Samples(samples)));
                    }
                }
                Some(Kept::Number(value, samples)) => self.found.push((id, Found::Number(value, samples))),
                None => {
                    left.insert(id);
                    open.extend(self.graph.nodes[id].inputs.iter().filter(|input| needed.contains(input)));
                }
            }
        }
        Some(left)
    }

    /// Keeps the results of a level; those before `from` were there already.
    fn keep(&self, here: &[NodeId], from: usize) {
        let Some((memo, keys)) = self.memo else { return };
        let key = |id: NodeId| keys.get(id).copied().flatten();
        for &id in here {
            if let (Some(key), Some(signal)) = (key(id), &self.values[id]) {
                memo.put(key, Kept::Signal(signal.clone()));
            }
        }
        for (id, found) in &self.found[from..] {
            if let (Some(key), Found::Number(value, samples)) = (key(*id), found) {
                memo.put(key, Kept::Number(*value, *samples));
            }
        }
    }

    /// Frees inputs that no later node needs.
    fn release(&mut self, id: NodeId) {
        for &input in &self.graph.nodes[id].inputs {
            if self.uses[input] > 0 {
                self.uses[input] -= 1;
                if self.uses[input] == 0 {
                    self.values[input] = None;
                }
            }
        }
    }

    fn signal(&self, id: NodeId) -> Result<&Signal, String> {
        self.values[id].as_ref().ok_or_else(|| self.failed[id].clone().unwrap_or_else(|| "an input is missing".to_string()))
    }

    /// Whether an input has no value. Then this node has none for the same reason.
    fn without_input(&mut self, id: NodeId) -> bool {
        let reason = self.graph.nodes[id].inputs.iter().find_map(|&input| self.failed[input].clone());
        let failed = reason.is_some();
        if failed {
            self.failed[id] = reason;
        }
        failed
    }

    fn fail(&mut self, id: NodeId, reason: &str) {
        self.failed[id] = Some(format!("{reason} ({})", self.graph.nodes[id].label));
    }

    /// Computes a node. Where a step of a quantity is not possible, only this node has no value. Samples without a finite result
    /// are a fault of the record.
    fn value(&mut self, id: NodeId) -> Result<(), String> {
        if self.without_input(id) {
            return Ok(());
        }
        match self.one(id) {
            Ok(value) => self.values[id] = Some(value),
            Err(reason) if self.asks(id) => self.fail(id, &reason),
            Err(reason) => return Err(format!("{reason} ({})", self.graph.nodes[id].label)),
        }
        Ok(())
    }

    fn asks(&self, id: NodeId) -> bool {
        matches!(self.graph.nodes[id].operation, Operation::Step(_) | Operation::Window(_) | Operation::OverAxis(_))
    }

    fn samples(&self, id: NodeId) -> Result<Samples, String> {
        match self.signal(id)? {
            Signal::Samples(samples) => Ok(samples.clone()),
            // A constant becomes a signal of equal samples where a signal is needed.
            Signal::Constant(value) => {
                Ok(Samples { along: Arc::clone(&self.opened.along), values: Arc::new(vec![*value; self.opened.along.axis.len()]) })
            }
        }
    }

    /// Filters of one level: all channels with the same design together.
    fn filters(&mut self, here: &[NodeId]) -> Result<(), String> {
        let mut groups: Vec<(StepSpec, Vec<(NodeId, Samples)>)> = Vec::new();
        for &id in here {
            let node = &self.graph.nodes[id];
            let Operation::Step(spec) = &node.operation else { continue };
            if !spec.is_filter() {
                continue;
            }
            if self.without_input(id) {
                continue;
            }
            let samples = self.samples(node.inputs[0])?;
            let same = groups.iter_mut().find(|(known, members)| {
                known == spec && members[0].1.along.rate == samples.along.rate && members[0].1.values.len() == samples.values.len()
            });
            match same {
                Some((_, members)) => members.push((id, samples)),
                None => groups.push((spec.clone(), vec![(id, samples)])),
            }
        }
        if let Some((memo, _)) = self.memo {
            memo.count_filtered(groups.iter().map(|(_, members)| members.len()).sum());
        }
        for (spec, members) in groups {
            let signals: Vec<&[f64]> = members.iter().map(|(_, samples)| samples.values.as_slice()).collect();
            let designed = members[0].1.designed(&spec);
            let filtered = designed.and_then(|filter| filter.apply_many(&signals).map_err(|error| error.to_string()));
            let filtered = match filtered {
                Ok(filtered) => filtered,
                Err(reason) => {
                    members.iter().for_each(|(id, _)| self.fail(*id, &reason));
                    continue;
                }
            };
            for ((id, samples), values) in members.iter().zip(filtered) {
                self.values[*id] = Some(Signal::Samples(samples.with(values)));
            }
        }
        Ok(())
    }

    /// Reducers of one level: percentiles of one signal share one sorting.
    fn reducers(&mut self, here: &[NodeId]) -> Result<(), String> {
        let mut sorted: Vec<(NodeId, Vec<(NodeId, f64)>)> = Vec::new();
        for &id in here {
            let node = &self.graph.nodes[id];
            let Operation::Reduce(reducer) = &node.operation else { continue };
            if self.without_input(id) {
                continue;
            }
            let percent = match reducer {
                Reducer::Percentile(percent) => *percent,
                Reducer::Named(_) => {
                    let samples = self.samples(node.inputs[0])?;
                    let over = node.inputs.get(1).map(|&over| self.samples(over)).transpose()?;
                    let axis = over.as_ref().map_or(&samples.along.axis, |over| &over.values);
                    let value = reducer.run(axis, &samples.values, self.method).filter(|value| value.is_finite());
                    match value {
                        Some(value) => self.found.push((id, Found::Number(value, samples.values.len()))),
                        None => {
                            let says = format!("the {} of {} samples is not defined", reducer.in_words(), samples.values.len());
                            self.failed[id] = Some(says);
                        }
                    }
                    continue;
                }
            };
            match sorted.iter_mut().find(|(input, _)| *input == node.inputs[0]) {
                Some((_, members)) => members.push((id, percent)),
                None => sorted.push((node.inputs[0], vec![(id, percent)])),
            }
        }
        for (input, members) in sorted {
            let samples = self.samples(input)?;
            let percents: Vec<f64> = members.iter().map(|(_, percent)| *percent).collect();
            let values = match percentiles(&samples.values, &percents, self.method) {
                Ok(values) => values,
                Err(error) => {
                    members.iter().for_each(|(id, _)| self.failed[*id] = Some(error.to_string()));
                    continue;
                }
            };
            self.found.extend(members.iter().zip(values).map(|((id, _), value)| (*id, Found::Number(value, samples.values.len()))));
        }
        Ok(())
    }

    fn one(&mut self, id: NodeId) -> Result<Signal, String> {
        let node = &self.graph.nodes[id];
        let input = |index: usize| self.signal(node.inputs[index]);
        match &node.operation {
            Operation::Read { column } => {
                let found = self.opened.columns.iter().find(|(name, _)| name == column);
                let (_, values) = found.ok_or_else(|| format!("no column `{column}`"))?;
                Ok(Signal::Samples(Samples { along: Arc::clone(&self.opened.along), values: Arc::clone(values) }))
            }
            Operation::Constant(expr) => Ok(Signal::Constant(number(expr, self.known)?)),
            Operation::Level => {
                let of = |(id, found): &(NodeId, Found)| match found {
                    Found::Number(value, _) if *id == node.inputs[0] => Some(*value),
                    _ => None,
                };
                Ok(Signal::Constant(self.found.iter().find_map(of).ok_or("a number of the section is missing")?))
            }
            Operation::Arithmetic(operator) => arithmetic(*operator, input(0)?, input(1)?),
            Operation::Negative => each(input(0)?, |value| -value),
            Operation::Power(exponent) => each(input(0)?, |value| value.powi(i32::from(*exponent))),
            Operation::Apply(function) => {
                let inputs = node.inputs.iter().map(|&input| self.signal(input)).collect::<Result<Vec<_>, _>>()?;
                apply(&inputs, function.run)
            }
            Operation::Select(conditions) => Ok(input(chosen(conditions, &node.inputs, self.known)?)?.clone()),
            Operation::OverAxis(operation) => {
                Ok(Signal::Samples(self.samples(node.inputs[0])?.over_axis(operation, self.known, self.extent)?))
            }
            Operation::Step(spec) => Ok(Signal::Samples(self.samples(node.inputs[0])?.stepped(spec)?)),
            Operation::Cut => {
                let samples = self.samples(node.inputs[0])?;
                Ok(Signal::Samples(self.cutter.cut(&samples)?))
            }
            Operation::Window(spec) => Ok(Signal::Samples(self.samples(node.inputs[0])?.windowed(spec, self.extent)?)),
            _ => Err("this node combines records".into()),
        }
    }
}
