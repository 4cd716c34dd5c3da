//! All pairs of one section: both records through the graph, then values, differences and metrics.

use std::collections::BTreeSet;

use super::facts::Known;
use super::record::{Fault, Found, Opened, Work, columns, open};
use super::sections::Unit;
use super::signal::{Extent, Samples};
use crate::catalog::Pair;
use crate::check::evaluate::{Values, flag, number};
use crate::check::plan::{Evaluation, InputSide, Quantity, StepSpec};
use crate::data::RecordKind;
use crate::graph::{InputNode, NodeId, Operation, SignalNodes};
use crate::metrics::filter::Band;
use crate::metrics::resample;
use crate::problem::Problem;
use crate::result::{CheckResult, FileHash};

/// What one section came to.
#[derive(Debug, Default)]
pub struct SectionValues {
    /// For each quantity and signal, SI; `None` where the position was not recorded or the quantity leaves the section out.
    pub pairs: Vec<Vec<Option<PairSi>>>,
    pub checks: Vec<CheckResult>,
    pub files: Vec<FileHash>,
    /// What a whole record covers, as measured.
    pub extent: Option<Extent>,
    /// Record beyond the section [s], where it is too little for a slow filter to settle.
    pub short_margin: Option<f64>,
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
type Evaluated = Vec<(NodeId, Found)>;

pub fn of_section(work: &Work<'_>, unit: &Unit) -> SectionValues {
    let mut values = SectionValues::default();
    if let Err(fault) = fill(work, unit, &mut values) {
        values.fault = Some(fault.says);
        values.problems = fault.problems;
    }
    values
}

fn fill(work: &Work<'_>, unit: &Unit, values: &mut SectionValues) -> Result<(), Fault> {
    let known = unit.known(work.facts);
    track_checks(work, unit, &known, values)?;
    let active: Vec<bool> = work
        .plan
        .quantities
        .iter()
        .map(|quantity| quantity.only.as_ref().map_or(Ok(true), |only| flag(only, &known)))
        .collect::<Result<_, _>>()
        .map_err(Fault::new)?;
    let wanted = wanted(work, &active);
    // The simulated record is reduced to numbers before the measured one is opened: one record in memory at a time.
    let (simulated, _) = side(work, unit, RecordKind::Simulation, &wanted, &known, values)?;
    let (measured, opened) = side(work, unit, RecordKind::Measurement, &wanted, &known, values)?;
    values.extent = Some(opened.extent);
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut pairs = Vec::new();
        for (number, nodes) in work.graph.quantities[index].signals.iter().enumerate() {
            if !active[index] || !work.present[index][number] {
                pairs.push(None);
                continue;
            }
            let pair = pair(quantity, number, nodes, &simulated, &measured, &known, unit);
            pairs.push(Some(pair.map_err(|says| Fault::new(format!("{} {}: {says}", quantity.id, quantity.signals[number].0)))?));
        }
        values.pairs.push(pairs);
    }
    record_checks(work, &known, &simulated, &measured, values);
    Ok(())
}

/// Nodes whose values are needed of both records.
fn wanted(work: &Work<'_>, active: &[bool]) -> BTreeSet<NodeId> {
    let mut wanted = BTreeSet::new();
    for (index, quantity) in work.graph.quantities.iter().enumerate() {
        for (number, signal) in quantity.signals.iter().enumerate() {
            if !active[index] || !work.present[index][number] {
                continue;
            }
            match &work.plan.quantities[index].evaluation {
                Evaluation::Sides { .. } => wanted.extend(signal.inputs.iter().map(|input| input.node)),
                Evaluation::Metric { metric, .. } => {
                    wanted.insert(if metric.0.common_points { signal.filtered } else { signal.processed });
                    wanted.extend(signal.over);
                }
            }
        }
    }
    for check in &work.graph.checks {
        wanted.extend(check.iter().map(|input| input.node).filter(|&node| !work.graph.nodes[node].track));
    }
    wanted
}

fn side(
    work: &Work<'_>,
    unit: &Unit,
    kind: RecordKind,
    wanted: &BTreeSet<NodeId>,
    known: &Known<'_>,
    values: &mut SectionValues,
) -> Result<(Evaluated, Opened), Fault> {
    let needed = columns(work.graph, wanted, known).map_err(Fault::new)?;
    let opened = open(work, unit, kind, &needed)?;
    values.files.push(opened.file.clone());
    let found = opened
        .evaluate(work.graph, &needed, wanted, known, work.plan.sections.percentiles)
        .map_err(|says| Fault::new(format!("{}: {says}", opened.file.path)))?;
    note_margins(work, unit, &needed, &opened, values);
    Ok((found, opened))
}

/// One note for all sections with too little record for a slow filter.
pub fn margin_note(values: &[SectionValues]) -> Option<String> {
    let short: Vec<f64> = values.iter().filter_map(|values| values.short_margin).collect();
    let least = short.iter().copied().reduce(f64::min)?;
    Some(format!(
        "In {} of {} sections the records reach less than {SLOW_FILTER_MARGIN} s beyond the section (least {least:.1} s): a filter with an edge below {SLOW_FILTER} Hz has not fully settled there, and its values may be off by a few per cent.",
        short.len(),
        values.len()
    ))
}

/// Filters that reach below this frequency need this much record on each side to settle (own trials: 5 s keep the error of a
/// 0.4 Hz edge below 0.5 % of an rms value).
const SLOW_FILTER: f64 = 1.0;
const SLOW_FILTER_MARGIN: f64 = 5.0;

fn lowest_edge(band: Band) -> f64 {
    match band {
        Band::LowPass(edge) | Band::HighPass(edge) | Band::BandPass(edge, _) | Band::BandStop(edge, _) => edge,
    }
}

fn note_margins(work: &Work<'_>, unit: &Unit, needed: &BTreeSet<NodeId>, opened: &Opened, values: &mut SectionValues) {
    let Some((before, after)) = opened.margins else { return };
    if unit.extent.is_none() || before.min(after) >= SLOW_FILTER_MARGIN {
        return;
    }
    let slow = needed.iter().any(|&id| match &work.graph.nodes[id].operation {
        Operation::Step(StepSpec::Butterworth { band, .. }) => lowest_edge(*band) < SLOW_FILTER,
        _ => false,
    });
    if slow {
        values.short_margin = Some(before.min(after));
    }
}

fn number_of(found: &Evaluated, node: NodeId) -> Result<f64, String> {
    match found.iter().find(|(id, _)| *id == node) {
        Some((_, Found::Number(value))) => Ok(*value),
        _ => Err("a value is missing".into()),
    }
}

fn samples_of(found: &Evaluated, node: NodeId) -> Result<&Samples, String> {
    match found.iter().find(|(id, _)| *id == node) {
        Some((_, Found::Samples(samples))) => Ok(samples),
        _ => Err("a signal is missing".into()),
    }
}

fn pair(
    quantity: &Quantity,
    number: usize,
    nodes: &SignalNodes,
    simulated: &Evaluated,
    measured: &Evaluated,
    known: &Known<'_>,
    unit: &Unit,
) -> Result<PairSi, String> {
    let _ = number;
    match &quantity.evaluation {
        Evaluation::Sides { value, difference, .. } => {
            let own = |side: InputSide| -> Result<f64, String> {
                let inputs: Vec<Result<f64, String>> =
                    nodes.inputs.iter().map(|input| input_value(input, side, simulated, measured)).collect();
                self::number(value, &Known { inputs: &inputs, ..section(known) })
            };
            let (s, m) = (own(InputSide::Simulated)?, own(InputSide::Measured)?);
            let difference = self::number(difference, &Known { sides: Some((s, m)), ..section(known) })?;
            let samples = nodes.inputs.first().map_or(0, |input| sample_count(measured, input));
            Ok(PairSi { simulated: Some(s), measured: Some(m), difference, samples })
        }
        Evaluation::Metric { metric, .. } => {
            let entry = metric.0;
            let (s, m) = if entry.common_points {
                common(samples_of(simulated, nodes.filtered)?, samples_of(measured, nodes.filtered)?, unit)?
            } else {
                (samples_of(simulated, nodes.processed)?.values.to_vec(), samples_of(measured, nodes.processed)?.values.to_vec())
            };
            let over = match nodes.over {
                None => None,
                Some(node) => Some((samples_of(simulated, node)?, samples_of(measured, node)?)),
            };
            let over = over.map(|(s, m)| (s.values.as_slice(), m.values.as_slice()));
            let difference = (entry.run)(&Pair { simulated: &s, measured: &m, over })?;
            Ok(PairSi { simulated: None, measured: None, difference, samples: m.len() })
        }
    }
}

/// The same names with nothing yet for inputs and sides.
fn section<'a>(known: &Known<'a>) -> Known<'a> {
    Known { facts: known.facts, columns: known.columns, extent: known.extent, inputs: &[], sides: None, limits: &[] }
}

fn input_value(input: &InputNode, side: InputSide, simulated: &Evaluated, measured: &Evaluated) -> Result<f64, String> {
    let of = if input.side.resolve(side) == InputSide::Measured { measured } else { simulated };
    number_of(of, input.node)
}

/// How many samples or windows a value was taken from.
fn sample_count(found: &Evaluated, input: &InputNode) -> usize {
    found.iter().find_map(|(id, value)| if *id == input.node { Some(value) } else { None }).map_or(0, |value| match value {
        Found::Number(_) => 0,
        Found::Samples(samples) => samples.values.len(),
    })
}

/// Both signals on the measured samples of the section; the simulated one is interpolated unless its samples lie there already.
fn common(simulated: &Samples, measured: &Samples, unit: &Unit) -> Result<(Vec<f64>, Vec<f64>), String> {
    let cut = |samples: &Samples| match unit.extent {
        Some(extent) => samples.cut(extent),
        None => Ok(samples.clone()),
    };
    let (s, m) = (cut(simulated)?, cut(measured)?);
    let same = s.along.axis.len() == m.along.axis.len()
        && s.along.axis.iter().zip(m.along.axis.iter()).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()));
    if same {
        return Ok((s.values.to_vec(), m.values.to_vec()));
    }
    let onto = resample::interpolate(&simulated.along.axis, &simulated.values, &m.along.axis)
        .map_err(|error| format!("the simulation cannot be brought onto the measured points: {error}"))?;
    Ok((onto, m.values.to_vec()))
}

/// Checks that use the track record. Without one they are said to be not checked.
fn track_checks(work: &Work<'_>, unit: &Unit, known: &Known<'_>, values: &mut SectionValues) -> Result<(), Fault> {
    let wanted: BTreeSet<NodeId> =
        work.graph.checks.iter().flatten().map(|input| input.node).filter(|&node| work.graph.nodes[node].track).collect();
    let mut found = Vec::new();
    let mut missing = None;
    if !wanted.is_empty() {
        let exists = work.campaign.has(RecordKind::Track) && work.campaign.record_place(RecordKind::Track, &unit.cell).is_ok();
        if exists {
            found = side(work, unit, RecordKind::Track, &wanted, known, values)?.0;
        } else {
            missing = Some("not checked: there is no track record".to_string());
        }
    }
    for (check, inputs) in work.plan.checks.iter().zip(&work.graph.checks) {
        if !inputs.is_empty() && !inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            // Filled in once both records are evaluated.
            values.checks.push(CheckResult { name: check.name.clone(), title: check.title.clone(), holds: None, says: String::new() });
            continue;
        }
        let inputs: Vec<Result<f64, String>> = inputs.iter().map(|input| number_of(&found, input.node)).collect();
        values.checks.push(checked(check, known, &inputs, missing.as_deref()));
    }
    Ok(())
}

fn record_checks(work: &Work<'_>, known: &Known<'_>, simulated: &Evaluated, measured: &Evaluated, values: &mut SectionValues) {
    for (index, (check, inputs)) in work.plan.checks.iter().zip(&work.graph.checks).enumerate() {
        if inputs.is_empty() || inputs.iter().all(|input| work.graph.nodes[input.node].track) {
            continue;
        }
        let inputs: Vec<Result<f64, String>> =
            inputs.iter().map(|input| input_value(input, InputSide::Measured, simulated, measured)).collect();
        values.checks[index] = checked(check, known, &inputs, None);
    }
}

fn checked(check: &crate::check::plan::Check, known: &Known<'_>, inputs: &[Result<f64, String>], missing: Option<&str>) -> CheckResult {
    let result = |holds: Option<bool>, says: String| CheckResult { name: check.name.clone(), title: check.title.clone(), holds, says };
    let spared = check.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known));
    match spared {
        Ok(true) => return result(Some(true), "not asked of this section".into()),
        Err(reason) => return result(None, reason),
        Ok(false) => {}
    }
    if let Some(missing) = missing {
        return result(None, missing.to_string());
    }
    match flag(&check.require, &Known { inputs, ..section(known) } as &dyn Values) {
        Ok(true) => result(Some(true), check.words.clone()),
        Ok(false) => result(Some(false), format!("not satisfied: {}", check.words)),
        Err(reason) => result(None, reason),
    }
}
