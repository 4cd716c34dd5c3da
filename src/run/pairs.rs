//! All pairs of one section: both records through the graph, then values, differences and metrics.

use std::collections::BTreeSet;

use super::copies::Print;
use super::facts::Known;
use super::plausibility;
use super::record::{Fault, Found, Opened, Work, needed, open};
use super::sections::Unit;
use super::signal::{Extent, Samples};
use super::synchronisation::{self, Offset, Shifts};
use crate::catalog::{Metric, Pair};
use crate::check::evaluate::{flag, number};
use crate::check::plan::{Check, Evaluation, Input, InputSide, Quantity, StepSpec};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId, Operation, SignalNodes};
use crate::metrics::filter::{Band, Roots};
use crate::metrics::resample;
use crate::problem::Problem;
use crate::result::{CheckResult, FileHash, Finding};
use crate::units::Dimension;

/// What one section came to.
#[derive(Clone, Debug, Default)]
pub struct SectionValues {
    /// For each quantity and signal, SI; `None` where the position was not recorded or the quantity leaves the section out.
    pub pairs: Vec<Vec<Option<PairSi>>>,
    /// Quantities that cannot be had of this section, with the signal and the reason.
    pub impossible: Vec<(usize, String)>,
    pub checks: Vec<CheckResult>,
    /// What is not plausible in this section alone.
    pub findings: Vec<Finding>,
    /// Marks of the signals that are to differ from others.
    pub prints: Vec<Print>,
    pub files: Vec<FileHash>,
    /// What a whole record covers, as measured.
    pub extent: Option<Extent>,
    /// Record beyond the section [s], where it is too little for a slow filter to settle.
    pub short_margin: Option<f64>,
    /// Where the measurement lies against the simulation, where that was asked for.
    pub offset: Option<Offset>,
    pub fault: Option<String>,
    pub problems: Vec<Problem>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSi {
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    pub difference: f64,
    pub samples: usize,
}

/// Values of the wanted nodes of one record.
pub type Evaluated = Vec<(NodeId, Found)>;

/// The simulated record, evaluated.
pub type Simulated<'a> = &'a [(NodeId, Found)];

/// The section, once for each shift.
pub fn of_section(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>) -> Vec<SectionValues> {
    let mut common = SectionValues::default();
    match fill(work, unit, shifts, &mut common) {
        Ok(all) => all,
        Err(fault) => {
            common.fault = Some(fault.says);
            common.problems = fault.problems;
            vec![common; shifts.offsets.len()]
        }
    }
}

fn fill(work: &Work<'_>, unit: &Unit, shifts: &Shifts<'_>, common: &mut SectionValues) -> Result<Vec<SectionValues>, Fault> {
    let known = unit.known(work.facts);
    let track = track_checks(work, unit, &known, common)?;
    let active: Vec<bool> = work
        .plan
        .quantities
        .iter()
        .map(|quantity| quantity.only.as_ref().map_or(Ok(true), |only| flag(only, &known)))
        .collect::<Result<_, _>>()
        .map_err(Fault::new)?;
    let mut wanted = wanted(work, &known, &active);
    if shifts.farthest.is_some() {
        wanted.extend(synchronisation::signals(work, &active));
    }
    // The simulated record is reduced to numbers before the measured one is opened: one record in memory at a time.
    let simulated = side(work, unit, RecordKind::Simulation, &wanted, &known, common).map(|(simulated, _)| simulated);
    let measured = if shifts.plain() {
        side(work, unit, RecordKind::Measurement, &wanted, &known, common).map(|(found, opened)| (vec![Ok(found)], opened.extent))
    } else {
        match &simulated {
            Ok(simulated) => shifted(work, unit, shifts, &wanted, &known, simulated, common),
            Err(_) => side(work, unit, RecordKind::Measurement, &wanted, &known, common).map(|(_, opened)| (Vec::new(), opened.extent)),
        }
    };
    let (simulated, (measured, extent)) = match (simulated, measured) {
        (Ok(simulated), Ok(measured)) => (simulated, measured),
        (Err(first), Err(second)) => return Err(first.and(second)),
        (Err(fault), _) | (_, Err(fault)) => return Err(fault),
    };
    common.extent = Some(extent);
    let one = |measured: Result<Evaluated, String>| {
        let mut values = common.clone();
        match measured {
            Ok(measured) => {
                let sides = Sides { simulated: &simulated, measured: &measured, known: &known, extent: unit.extent };
                quantities(work, &sides, &active, &mut values);
                record_checks(work, &sides, &mut values);
                plausibility::look(work, unit, &sides, &track, &mut values);
            }
            Err(says) => values.fault = Some(says),
        }
        values
    };
    Ok(measured.into_iter().map(one).collect())
}

/// The measured record cut at every shift; its filters run once.
fn shifted(
    work: &Work<'_>,
    unit: &Unit,
    shifts: &Shifts<'_>,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    simulated: &Evaluated,
    common: &mut SectionValues,
) -> Result<(Vec<Result<Evaluated, String>>, Extent), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, RecordKind::Measurement, &needed)?;
    common.files.push(opened.file.clone());
    note_margins(work, unit, &needed, &opened, common);
    let placed = |says: String| format!("{}: {says}", opened.file.path);
    let held = opened.hold(work.graph, &needed, wanted, known, work.plan.sections.percentiles).map_err(|says| Fault::new(placed(says)))?;
    common.offset = shifts.farthest.and_then(|farthest| synchronisation::estimate(work.graph, unit, farthest, simulated, &held));
    let own = if shifts.correct { common.offset.as_ref().map_or(0.0, |offset| offset.shift) } else { 0.0 };
    let all = shifts.offsets.iter().map(|offset| held.at(own + offset).map_err(placed)).collect();
    Ok((all, opened.extent))
}

/// A pair that cannot be had is the matter of its quantity: the section serves the others.
fn quantities(work: &Work<'_>, sides: &Sides<'_>, active: &[bool], values: &mut SectionValues) {
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut pairs = Vec::new();
        for (number, nodes) in work.graph.quantities[index].signals.iter().enumerate() {
            if !active[index] || !work.present[index][number] {
                pairs.push(None);
                continue;
            }
            match sides.pair(work, quantity, nodes) {
                Ok(pair) => pairs.push(Some(pair)),
                Err(says) => {
                    pairs.push(None);
                    values.impossible.push((index, format!("{}: {says}", quantity.signals[number].0)));
                }
            }
        }
        values.pairs.push(pairs);
    }
}

/// Nodes whose values are needed of both records.
fn wanted(work: &Work<'_>, known: &Known<'_>, active: &[bool]) -> BTreeSet<NodeId> {
    let mut wanted = BTreeSet::new();
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        for (number, signal) in quantity.signals.iter().enumerate() {
            if active[index] && work.present[index][number] {
                wanted_of(work, index, signal, &mut wanted);
            }
        }
    }
    for check in &work.graph.checks {
        wanted.extend(check.iter().map(|input| input.node).filter(|&node| !work.graph.nodes[node].track));
    }
    wanted.extend(plausibility::wanted(work, known, false));
    wanted
}

/// Nodes that one signal of a quantity needs of both records.
fn wanted_of(work: &Work<'_>, index: usize, signal: &SignalNodes, wanted: &mut BTreeSet<NodeId>) {
    match &work.plan.quantities[index].evaluation {
        Evaluation::Sides { .. } => wanted.extend(signal.inputs.iter().map(|input| input.node)),
        Evaluation::Metric { metric, .. } => {
            let common = metric.on_common_points(keeps_samples(&work.plan.quantities[index]));
            wanted.insert(if common { signal.filtered } else { signal.processed });
            wanted.extend(signal.over);
        }
    }
}

/// Whether the samples of the record are still there after the quantity's filter.
fn keeps_samples(quantity: &Quantity) -> bool {
    quantity.chain.iter().all(|step| step.kind.keeps_samples())
}

/// One pair and what each record gave, the simulated one first.
pub struct Computed {
    pub pair: PairSi,
    pub sides: [(Vec<(NodeId, Found)>, Opened); 2],
}

/// One signal of one quantity in one section, by itself.
pub fn single(work: &Work<'_>, unit: &Unit, index: usize, signal: usize) -> Result<Computed, Fault> {
    let known = unit.known(work.facts);
    let nodes = &work.graph.quantities[index].signals[signal];
    let mut wanted = BTreeSet::new();
    wanted_of(work, index, nodes, &mut wanted);
    let mut values = SectionValues::default();
    let (simulated, of_simulated) = side(work, unit, RecordKind::Simulation, &wanted, &known, &mut values)?;
    let (measured, of_measured) = side(work, unit, RecordKind::Measurement, &wanted, &known, &mut values)?;
    let sides = Sides { simulated: &simulated, measured: &measured, known: &known, extent: unit.extent };
    let pair = sides.pair(work, &work.plan.quantities[index], nodes).map_err(Fault::new)?;
    Ok(Computed { pair, sides: [(simulated, of_simulated), (measured, of_measured)] })
}

fn side(
    work: &Work<'_>,
    unit: &Unit,
    kind: RecordKind,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<(Evaluated, Opened), Fault> {
    let needed = needed(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, kind, &needed)?;
    values.files.push(opened.file.clone());
    let found = opened
        .evaluate(work.graph, &needed, wanted, known, work.plan.sections.percentiles)
        .map_err(|says| Fault::new(format!("{}: {says}", opened.file.path)))?;
    note_margins(work, unit, &needed, &opened, values);
    Ok((found, opened))
}

/// One note for all used sections with too little record for a slow filter.
pub fn margin_note<'a>(used: impl Iterator<Item = &'a SectionValues>) -> Option<String> {
    let margins: Vec<Option<f64>> = used.map(|values| values.short_margin).collect();
    let short: Vec<f64> = margins.iter().copied().flatten().collect();
    let least = short.iter().copied().reduce(f64::min)?;
    let (_, rms, peak) = MARGIN_TRIALS.iter().rev().find(|(margin, _, _)| *margin <= least).copied().unwrap_or(MARGIN_TRIALS[0]);
    Some(format!(
        "In {} of {} sections the records extend less than {SLOW_FILTER_MARGIN} s beyond the section (minimum {least:.1} s). A filter with a cut-off below {SLOW_FILTER} Hz has not fully settled there. In trials with a 0.4 Hz edge and records cut so short, rms values moved by up to {rms} % and extreme values by up to {peak} %.",
        short.len(),
        margins.len()
    ))
}

/// What a short margin does: margin in s, and the largest change of an rms value and of an extreme value (0.15 and 99.85 % values) in per
/// cent, against records that reach 3.2 s beyond the section. Own trials with car body accelerations of seven sections of three simulated
/// campaigns (28 values of each kind), band-pass 0.4 to 10 Hz, order 4, zero-phase, parts of 2 to 4 s evaluated: short ones, in which the ends
/// weigh most. Half of the values moved by less than a fifth of this.
const MARGIN_TRIALS: [(f64, u8, u8); 7] =
    [(0.0, 50, 75), (0.25, 19, 50), (0.5, 16, 41), (1.0, 9, 27), (1.5, 7, 16), (2.0, 4, 10), (3.0, 2, 10)];

/// Filters that reach below this frequency need this much record on each side to settle (own trials: 5 s keep the error of a
/// 0.4 Hz edge below 0.5 % of an rms value).
const SLOW_FILTER: f64 = 1.0;
const SLOW_FILTER_MARGIN: f64 = 5.0;

/// Of a filter: its lowest edge, or where its slowest pole lies.
fn lowest_frequency(step: &StepSpec) -> Option<f64> {
    match step {
        StepSpec::Butterworth { band, .. } => match band {
            Band::LowPass(edge) | Band::HighPass(edge) | Band::BandPass(edge, _) | Band::BandStop(edge, _) => Some(*edge),
        },
        StepSpec::Transfer { function, .. } => match function.poles {
            Roots::One(frequency) => Some(frequency),
            // Of low quality, two real poles part; the lower one lies near this.
            Roots::Two { frequency, quality } => Some(frequency * quality.min(1.0)),
        },
        _ => None,
    }
}

fn note_margins(work: &Work<'_>, unit: &Unit, needed: &BTreeSet<NodeId>, opened: &Opened, values: &mut SectionValues) {
    let Some((before, after)) = opened.margins else { return };
    if unit.extent.is_none() || before.min(after) >= SLOW_FILTER_MARGIN {
        return;
    }
    let slow = needed.iter().any(|&id| match &work.graph.nodes[id].operation {
        Operation::Step(step) => lowest_frequency(step).is_some_and(|frequency| frequency < SLOW_FILTER),
        _ => false,
    });
    if slow {
        values.short_margin = Some(before.min(after));
    }
}

pub fn number_of(found: &Evaluated, node: NodeId) -> Result<f64, String> {
    match found.iter().find(|(id, _)| *id == node) {
        Some((_, Found::Number(value, _))) => Ok(*value),
        Some((_, Found::Failed(reason))) => Err(reason.clone()),
        _ => Err("a value is missing".into()),
    }
}

fn samples_of(found: &Evaluated, node: NodeId) -> Result<&Samples, String> {
    match found.iter().find(|(id, _)| *id == node) {
        Some((_, Found::Samples(samples))) => Ok(samples),
        Some((_, Found::Failed(reason))) => Err(reason.clone()),
        _ => Err("a signal is missing".into()),
    }
}

/// Both records of a section, evaluated.
#[derive(Debug)]
pub struct Sides<'a> {
    simulated: &'a Evaluated,
    measured: &'a Evaluated,
    pub known: &'a Known<'a>,
    extent: Option<Extent>,
}

impl Sides<'_> {
    fn pair(&self, work: &Work<'_>, quantity: &Quantity, nodes: &SignalNodes) -> Result<PairSi, String> {
        match &quantity.evaluation {
            Evaluation::Sides { value, difference, .. } => {
                let own = |side: InputSide| -> Result<f64, String> {
                    let inputs: Vec<Result<f64, String>> = nodes.inputs.iter().map(|input| self.input(input, side)).collect();
                    number(value, &Known { inputs: &inputs, ..section(self.known) })
                };
                let (s, m) = (own(InputSide::Simulated)?, own(InputSide::Measured)?);
                let difference = number(difference, &Known { sides: Some((s, m)), ..section(self.known) })?;
                Ok(PairSi { simulated: Some(s), measured: Some(m), difference, samples: self.samples(work, nodes) })
            }
            Evaluation::Metric { metric, .. } => {
                let common = metric.on_common_points(keeps_samples(quantity));
                let node = if common { nodes.filtered } else { nodes.processed };
                let (difference, samples) = self.compared(*metric, common, node, nodes.over)?;
                Ok(PairSi { simulated: None, measured: None, difference, samples })
            }
        }
    }

    /// A metric of both signals of a node, and of how many measured samples.
    fn compared(&self, metric: Metric, on_common_points: bool, node: NodeId, over: Option<NodeId>) -> Result<(f64, usize), String> {
        let (simulated, measured) = (samples_of(self.simulated, node)?, samples_of(self.measured, node)?);
        let common = if on_common_points {
            Common::of(simulated, measured, self.extent)?
        } else {
            Common { axis: Vec::new(), simulated: simulated.values.to_vec(), measured: measured.values.to_vec() }
        };
        let over = match over {
            None => None,
            Some(node) => Some((samples_of(self.simulated, node)?, samples_of(self.measured, node)?)),
        };
        let over = over.map(|(s, m)| (s.values.as_slice(), m.values.as_slice()));
        let pair = Pair { axis: &common.axis, simulated: &common.simulated, measured: &common.measured, over };
        Ok((metric.run(&pair)?, common.measured.len()))
    }

    /// The samples of a node on both sides: simulated, measured.
    pub fn samples_of(&self, node: NodeId) -> Result<(&Samples, &Samples), String> {
        Ok((samples_of(self.simulated, node)?, samples_of(self.measured, node)?))
    }

    pub fn input(&self, input: &InputNode, side: InputSide) -> Result<f64, String> {
        if let Some(metric) = input.metric {
            return self.compared(metric, metric.0.common_points, input.node, None).map(|(value, _)| value);
        }
        let of = if input.side.resolve(side) == InputSide::Measured { self.measured } else { self.simulated };
        number_of(of, input.node)
    }

    /// How many samples or windows of the quantity's own signal the measured value was taken from.
    fn samples(&self, work: &Work<'_>, nodes: &SignalNodes) -> usize {
        let own = |input: &&InputNode| work.graph.nodes[input.node].inputs.contains(&nodes.processed);
        let input = nodes.inputs.iter().find(own).or(nodes.inputs.first());
        let found = input.and_then(|input| self.measured.iter().find(|(id, _)| *id == input.node));
        match found {
            Some((_, Found::Number(_, samples))) => *samples,
            Some((_, Found::Samples(samples))) => samples.values.len(),
            Some((_, Found::Failed(_))) | None => 0,
        }
    }
}

/// The same names with nothing yet for inputs and sides.
pub fn section<'a>(known: &Known<'a>) -> Known<'a> {
    Known { facts: known.facts, columns: known.columns, extent: known.extent, inputs: &[], sides: None }
}

/// Both signals on the measured samples of the section.
struct Common {
    axis: Vec<f64>,
    simulated: Vec<f64>,
    measured: Vec<f64>,
}

impl Common {
    /// The simulated signal is interpolated unless its samples lie where the measured ones do already.
    fn of(simulated: &Samples, measured: &Samples, extent: Option<Extent>) -> Result<Self, String> {
        let cut = |samples: &Samples| match extent {
            Some(extent) => samples.cut(extent),
            None => Ok(samples.clone()),
        };
        let (s, m) = (cut(simulated)?, cut(measured)?);
        let same = s.along.axis.len() == m.along.axis.len()
            && s.along.axis.iter().zip(m.along.axis.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()));
        let onto = if same {
            s.values.to_vec()
        } else {
            resample::interpolate(&simulated.along.axis, &simulated.values, &m.along.axis)
                .map_err(|error| format!("the simulation cannot be brought onto the measured points: {error}"))?
        };
        Ok(Self { axis: m.along.axis.to_vec(), simulated: onto, measured: m.values.to_vec() })
    }
}

/// Checks that use the track record. Without one they are said to be not checked.
/// What the track record came to.
fn track_checks(work: &Work<'_>, unit: &Unit, known: &Known<'_>, values: &mut SectionValues) -> Result<Evaluated, Fault> {
    let mut wanted: BTreeSet<NodeId> =
        work.graph.checks.iter().flatten().map(|input| input.node).filter(|&node| work.graph.nodes[node].track).collect();
    wanted.extend(plausibility::wanted(work, known, true));
    let there = || match work.campaign.record_place(RecordKind::Track, &unit.cell) {
        Ok(_) => Ok(true),
        // That there is none is said of each check; that it cannot be read is a fault.
        Err(problem) if problem.code == "file-unreadable" => Err(Fault::new(problem.says)),
        Err(_) => Ok(false),
    };
    let found = if !wanted.is_empty() && work.campaign.has(RecordKind::Track) && there()? {
        side(work, unit, RecordKind::Track, &wanted, known, values)?.0
    } else {
        Vec::new()
    };
    for (check, inputs) in work.plan.checks.iter().zip(&work.graph.checks) {
        if !inputs.is_empty() && !inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            // Filled in once both records are evaluated.
            let says = "not checked: the records could not be evaluated".into();
            values.checks.push(CheckResult { name: check.name.clone(), title: check.title.clone(), holds: None, says });
            continue;
        }
        let value = |input: &InputNode| number_of(&found, input.node).map_err(|_| "not checked: there is no track record".to_string());
        let inputs: Vec<Result<f64, String>> = inputs.iter().map(value).collect();
        values.checks.push(checked(work, check, known, &inputs));
    }
    Ok(found)
}

fn record_checks(work: &Work<'_>, sides: &Sides<'_>, values: &mut SectionValues) {
    for (index, (check, inputs)) in work.plan.checks.iter().zip(&work.graph.checks).enumerate() {
        if inputs.is_empty() || inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            continue;
        }
        let inputs: Vec<Result<f64, String>> = inputs.iter().map(|input| sides.input(input, InputSide::Measured)).collect();
        values.checks[index] = checked(work, check, sides.known, &inputs);
    }
}

fn checked(work: &Work<'_>, check: &Check, known: &Known<'_>, inputs: &[Result<f64, String>]) -> CheckResult {
    let result = |holds: Option<bool>, says: String| CheckResult { name: check.name.clone(), title: check.title.clone(), holds, says };
    let spared = check.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known));
    match spared {
        Ok(true) => return result(Some(true), "does not apply to this section".into()),
        Err(reason) => return result(None, reason),
        Ok(false) => {}
    }
    match flag(&check.require, &Known { inputs, ..section(known) }) {
        Ok(true) => result(Some(true), format!("{}{}", check.words, found_values(work, check, inputs))),
        Ok(false) => result(Some(false), format!("not met: {}{}", check.words, found_values(work, check, inputs))),
        Err(reason) => result(None, reason),
    }
}

/// `; found: range of curvature 0.00021 1/m, mean of curvature 0.002 1/m`
fn found_values(work: &Work<'_>, check: &Check, inputs: &[Result<f64, String>]) -> String {
    let one = |(input, value): (&Input, &Result<f64, String>)| {
        let value: f64 = format!("{:.3e}", value.as_ref().ok()?).parse().ok()?;
        let signal = input.signal.as_ref()?;
        let dimension = input.taken.gives(signal.dimension, work.plan.axis.unit.dimension);
        let unit = if dimension == Dimension::ONE { String::new() } else { format!(" {dimension}") };
        let words = input.span.text().split_whitespace().collect::<Vec<_>>().join(" ");
        Some(format!("{words} {value}{unit}"))
    };
    let found = check.inputs.iter().zip(inputs).filter_map(one).collect::<Vec<_>>().join(", ");
    if found.is_empty() { found } else { format!("; found: {found}") }
}
