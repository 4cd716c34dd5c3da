//! The evaluated records of one section, and the values, differences and metrics computed from
//! them.

use std::borrow::Cow;
use std::sync::Arc;

use super::common::{Both, Meetings};
use crate::catalog::{Metric, Pair};
use crate::check::evaluate::{flag, number};
use crate::check::plan::{
    Center, Chosen, Evaluation, Expr, InputSide, Kind, Pairing, Records, Side,
};
use crate::data::WhichRecord;
use crate::graph::{InputNode, Joint, NodeId, Operation, SignalNodes, ValueNodes};
use crate::metrics::percentile::Method;
use crate::metrics::{pair, statistics};
use crate::run::estimate::Row;
use crate::run::record::{Extent, Found, Rate, Samples, Work};
use crate::run::sections::{Known, Unit};

/// Values of the requested nodes of one record, in the order in which they were computed.
#[derive(Clone, Debug, Default)]
pub struct Evaluated {
    all: Vec<(NodeId, Found)>,
    /// For each node, its place among all and one more; 0 where it has none.
    places: Vec<usize>,
}

impl From<Vec<(NodeId, Found)>> for Evaluated {
    fn from(all: Vec<(NodeId, Found)>) -> Self {
        let mut places = vec![0; all.iter().map(|(node, _)| node + 1).max().unwrap_or(0)];
        // Of a node that was found twice, the first counts.
        for (at, (node, _)) in all.iter().enumerate().rev() {
            places[*node] = at + 1;
        }
        Self { all, places }
    }
}

impl Evaluated {
    pub fn get(&self, node: NodeId) -> Option<&Found> {
        let place = self.places.get(node)?.checked_sub(1)?;
        self.all.get(place).map(|(_, found)| found)
    }

    pub fn iter(&self) -> impl Iterator<Item = &(NodeId, Found)> {
        self.all.iter()
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
    pub found: Evaluated,
}

/// All records of a section.
#[derive(Debug)]
pub struct Sides<'a> {
    pub simulated: &'a [RecordOfSide],
    pub measured: &'a [RecordOfSide],
    /// The section that this one repeats.
    pub original: Option<&'a Original<'a>>,
    pub known: &'a Known<'a>,
    pub extent: Option<Extent>,
    /// Interpolation rule of percentiles.
    pub method: Method,
    pub meetings: &'a Meetings,
}

/// The original of a repeated section, and its measured records.
#[derive(Debug)]
pub struct Original<'a> {
    pub unit: &'a Unit,
    pub known: Known<'a>,
    pub records: Vec<RecordOfSide>,
}

/// One record of each side; a side that is not read has none.
#[derive(Clone, Copy, Debug)]
pub struct Two<'a> {
    pub simulated: &'a Evaluated,
    pub measured: &'a Evaluated,
    pub known: &'a Known<'a>,
    pub extent: Option<Extent>,
    /// Interpolation rule of percentiles.
    pub method: Method,
    /// Added to the axis of the simulated record, SI: a repeat is at another distance than its
    /// original.
    pub shift: f64,
    pub meetings: &'a Meetings,
}

/// The values of a side that is not read.
pub static NOT_READ: Evaluated = Evaluated { all: Vec::new(), places: Vec::new() };

impl<'a> Sides<'a> {
    /// The simulated and the measured records of a section.
    pub fn of_section(
        work: &Work<'_>,
        unit: &Unit,
        (simulated, measured): (&'a [RecordOfSide], &'a [RecordOfSide]),
        original: Option<&'a Original<'a>>,
        (known, meetings): (&'a Known<'a>, &'a Meetings),
    ) -> Self {
        Self {
            simulated,
            measured,
            original,
            known,
            extent: unit.extent,
            method: work.plan.sections.percentiles,
            meetings,
        }
    }

    fn of(&self, side: Side) -> &'a [RecordOfSide] {
        match side {
            Side::Simulated => self.simulated,
            Side::Measured => self.measured,
        }
    }

    /// One record in the place of both sides.
    pub fn alone(&self, record: &'a RecordOfSide) -> Two<'a> {
        let Self { known, extent, method, meetings, .. } = *self;
        Two {
            simulated: &record.found,
            measured: &record.found,
            known,
            extent,
            method,
            shift: 0.0,
            meetings,
        }
    }

    /// Every record of one side with every record of the other, with the names of those of which
    /// there are several.
    pub fn pairs(&self) -> impl Iterator<Item = (Option<Arc<str>>, Two<'a>)> {
        let Self { known, extent, method, meetings, .. } = *self;
        let of = |records: &'a [RecordOfSide]| -> Vec<(Option<Arc<str>>, &'a Evaluated)> {
            if records.is_empty() {
                return vec![(None, &NOT_READ)];
            }
            records.iter().map(|record| (record.name.clone(), &record.found)).collect()
        };
        let (simulated, measured) = (of(self.simulated), of(self.measured));
        simulated.into_iter().flat_map(move |(s, simulated)| {
            let one = |(m, measured): &(Option<Arc<str>>, &'a Evaluated)| {
                (
                    names(s.as_ref(), m.as_ref()),
                    Two { simulated, measured, known, extent, method, shift: 0.0, meetings },
                )
            };
            measured.iter().map(one).collect::<Vec<_>>()
        })
    }

    /// Every measured record of a repeat with that of its original, which takes the place of the
    /// measurement. Distances are counted from the start of each section.
    fn repeats(&self) -> impl Iterator<Item = Joined<'a>> {
        let Self { known, extent: own, method, meetings, .. } = *self;
        self.original.into_iter().flat_map(move |original| {
            let extent = original.unit.extent;
            let shift = extent.zip(own).map_or(0.0, |((first, _), (again, _))| first - again);
            self.measured.iter().zip(&original.records).map(move |(repeat, first)| {
                let two = Two {
                    simulated: &repeat.found,
                    measured: &first.found,
                    known,
                    extent,
                    method,
                    shift,
                    meetings,
                };
                let second = Two { known: &original.known, ..self.alone(first) };
                Joined { record: repeat.name.clone(), two, first: self.alone(repeat), second }
            })
        })
    }

    /// The records that a rule asks for, in the order of the campaign.
    fn chosen(&self, work: &Work<'_>, chosen: Chosen) -> Vec<&'a RecordOfSide> {
        let members = chosen.record.map_or(&[][..], |index| &work.plan.records[index].members);
        let named = |record: &&RecordOfSide| {
            members.iter().any(|member| record.called.as_deref() == Some(member.value.as_str()))
        };
        self.of(chosen.side).iter().filter(|record| members.is_empty() || named(record)).collect()
    }

    /// Two records that are compared, and the names of those of which there are several.
    fn joined(&self, work: &Work<'_>, pairing: Pairing) -> Result<Vec<Joined<'a>>, String> {
        let pair = |first: &'a RecordOfSide, second: &'a RecordOfSide| {
            let two = Two { simulated: &first.found, measured: &second.found, ..self.alone(first) };
            Joined {
                record: names(first.name.as_ref(), second.name.as_ref()),
                two,
                first: self.alone(first),
                second: self.alone(second),
            }
        };
        match pairing {
            Pairing::Repeats => Ok(self.repeats().collect()),
            Pairing::EachOther(of) => {
                let all = self.chosen(work, of);
                if all.len() < 2 {
                    return Err(one_record(of.side));
                }
                Ok(all
                    .iter()
                    .enumerate()
                    .flat_map(|(at, first)| all[at + 1..].iter().map(|second| pair(first, second)))
                    .collect())
            }
            Pairing::Each(one, other) => {
                let (firsts, seconds) = (self.chosen(work, one), self.chosen(work, other));
                let with = |first: &'a RecordOfSide| {
                    let others = seconds.iter().filter(move |second| second.which != first.which);
                    others.map(|second| pair(first, second)).collect::<Vec<_>>()
                };
                let found: Vec<Joined<'a>> = firsts.into_iter().flat_map(with).collect();
                if found.is_empty() { Err(one_record(one.side)) } else { Ok(found) }
            }
        }
    }

    /// The rows of one position.
    pub fn rows(
        &self,
        work: &Work<'_>,
        position: usize,
        nodes: &SignalNodes,
    ) -> Result<Vec<Row>, String> {
        let Operation::Compare(evaluation) = &work.graph.nodes[nodes.compare].operation else {
            return Err("this node gives no rows".into());
        };
        match evaluation.as_ref() {
            Evaluation::Metric { metric, pairing, .. } => {
                let common = metric.on_common_points(keeps_samples(work, nodes));
                let node = if common { nodes.filtered } else { nodes.processed };
                let one = |Joined { record, two, .. }: Joined<'_>| {
                    let (value, samples) = two.compared(*metric, common, node, nodes.over)?;
                    Ok(Row {
                        position,
                        which: 0,
                        record,
                        simulated: None,
                        measured: None,
                        value,
                        samples,
                    })
                };
                self.joined(work, *pairing)?.into_iter().map(one).collect()
            }
            Evaluation::Combined { of, pairing } => {
                let one = |Joined { record, two, .. }: Joined<'_>| {
                    let found: Vec<_> = nodes
                        .inputs
                        .iter()
                        .map(|input| two.counted(input, InputSide::Measured))
                        .collect();
                    let samples =
                        found.iter().flatten().map(|(_, samples)| *samples).max().unwrap_or(0);
                    let inputs: Vec<Result<f64, String>> =
                        found.into_iter().map(|found| found.map(|(value, _)| value)).collect();
                    let value =
                        number(&of.expr, &Known { inputs: &inputs, ..section(self.known) })?;
                    Ok(Row {
                        position,
                        which: 0,
                        record,
                        simulated: None,
                        measured: None,
                        value,
                        samples,
                    })
                };
                self.joined(work, *pairing)?.into_iter().map(one).collect()
            }
            Evaluation::Values { values, records } => {
                let mut rows = Vec::new();
                let mut applied = false;
                for (which, (value, of)) in values.iter().zip(&nodes.values).enumerate() {
                    // Of several values, only those whose case applies.
                    if values.len() > 1 && !applies(&value.expr, self.known)? {
                        continue;
                    }
                    applied = true;
                    rows.extend(self.of_value(work, records, (position, which), nodes, of)?);
                }
                if applied {
                    Ok(rows)
                } else {
                    Err("none of its values applies to this section".into())
                }
            }
        }
    }

    fn of_value(
        &self,
        work: &Work<'_>,
        records: &Records,
        (position, which): (usize, usize),
        nodes: &SignalNodes,
        value: &ValueNodes,
    ) -> Result<Vec<Row>, String> {
        let samples = |two: &Two<'_>, side| two.samples(work, nodes, value, side);
        let alone = |of: Chosen| {
            self.chosen(work, of).into_iter().map(move |record| {
                let two = self.alone(record);
                Ok::<_, String>((record.name.clone(), two, two.value(work, value, own(of.side))?))
            })
        };
        let difference_of = |difference: &Expr, s: f64, m: f64| {
            number(difference, &Known { sides: Some((s, m)), ..section(self.known) })
        };
        match records {
            Records::Of(of) => {
                let one = |(record, two, value): (Option<Arc<str>>, Two<'_>, f64)| {
                    let samples = samples(&two, own(of.side));
                    Row { position, which, record, simulated: None, measured: None, value, samples }
                };
                alone(*of).map(|found| found.map(one)).collect()
            }
            Records::Compared { pairing, difference } => {
                let one = |Joined { record, two, first, second }: Joined<'_>| {
                    // Of two sides, each number may also take values of the other one.
                    let (s, m, samples) = match pairing
                        .within()
                        .or((*pairing == Pairing::Repeats).then_some(Side::Measured))
                    {
                        None => {
                            let s = two.value(work, value, InputSide::Simulated)?;
                            (
                                s,
                                two.value(work, value, InputSide::Measured)?,
                                samples(&two, InputSide::Measured),
                            )
                        }
                        Some(side) => {
                            let s = first.value(work, value, own(side))?;
                            (s, second.value(work, value, own(side))?, samples(&first, own(side)))
                        }
                    };
                    let value = difference_of(difference, s, m)?;
                    Ok(Row {
                        position,
                        which,
                        record,
                        simulated: Some(s),
                        measured: Some(m),
                        value,
                        samples,
                    })
                };
                self.joined(work, *pairing)?.into_iter().map(one).collect()
            }
            Records::Spread { of, among, center, difference } => {
                let all = alone(*among).collect::<Result<Vec<_>, _>>()?;
                let values: Vec<f64> = all.iter().map(|(_, _, value)| *value).collect();
                if values.len() < 2 {
                    return Err(one_record(of.side));
                }
                let center = match center {
                    Center::Mean => statistics::mean(&values),
                    Center::Median => statistics::median(&values),
                };
                let center = center.ok_or("the records have no mean")?;
                let one = |(record, two, value): (Option<Arc<str>>, Two<'_>, f64)| {
                    let samples = samples(&two, own(of.side));
                    let difference = difference_of(difference, value, center)?;
                    Ok(Row {
                        position,
                        which,
                        record,
                        simulated: Some(value),
                        measured: Some(center),
                        value: difference,
                        samples,
                    })
                };
                alone(*of).map(|found| found.and_then(one)).collect()
            }
        }
    }
}

/// Two records that are compared.
struct Joined<'a> {
    /// The names of those of which there are several.
    record: Option<Arc<str>>,
    two: Two<'a>,
    /// Each by itself.
    first: Two<'a>,
    second: Two<'a>,
}

/// `simpack`, and of several on both sides `simpack, run1`.
fn names(first: Option<&Arc<str>>, second: Option<&Arc<str>>) -> Option<Arc<str>> {
    match (first, second) {
        (Some(first), Some(second)) => Some(format!("{first}, {second}").into()),
        (one, other) => one.or(other).cloned(),
    }
}

fn one_record(side: Side) -> String {
    format!("there is one {} record, and several are compared", side.in_words())
}

fn own(side: Side) -> InputSide {
    match side {
        Side::Simulated => InputSide::Simulated,
        Side::Measured => InputSide::Measured,
    }
}

/// Whether the samples of the record are still available after the quantity's filter.
pub fn keeps_samples(work: &Work<'_>, nodes: &SignalNodes) -> bool {
    let quantity = work
        .graph
        .quantities
        .iter()
        .position(|known| known.signals.iter().any(|signal| signal.compare == nodes.compare));
    quantity.is_none_or(|index| work.plan.quantities[index].keeps_samples())
}

/// Whether some case of an expression holds; an expression without cases always applies.
fn applies(expr: &Expr, known: &Known<'_>) -> Result<bool, String> {
    let Kind::Cases(arms, None) = &expr.kind else { return Ok(true) };
    for (_, condition) in arms {
        if flag(condition, &section(known))? {
            return Ok(true);
        }
    }
    Ok(false)
}

impl Two<'_> {
    /// The value of a node for one side.
    fn value(&self, work: &Work<'_>, value: &ValueNodes, side: InputSide) -> Result<f64, String> {
        match &work.graph.nodes[value.node].operation {
            Operation::Value(expr) => {
                let inputs: Vec<Result<f64, String>> =
                    value.inputs.iter().map(|input| self.input(input, side)).collect();
                number(expr, &Known { inputs: &inputs, ..section(self.known) })
            }
            _ => self.input(value.inputs.first().ok_or("a value takes nothing")?, side),
        }
    }

    /// A metric of both signals of a node, and the number of measured samples.
    fn compared(
        &self,
        metric: Metric,
        on_common_points: bool,
        node: NodeId,
        over: Option<NodeId>,
    ) -> Result<(f64, usize), String> {
        let of @ (simulated, measured) =
            (samples_of(self.simulated, node)?, samples_of(self.measured, node)?);
        let meeting = if on_common_points {
            Some(self.meetings.of(simulated, measured, self.extent, self.shift)?)
        } else {
            None
        };
        let over = match over {
            None => None,
            Some(node) => {
                Some((samples_of(self.simulated, node)?, samples_of(self.measured, node)?))
            }
        };
        let over = over.map(|(s, m)| (s.values.as_slice(), m.values.as_slice()));
        let (Rate::PerTime(rate) | Rate::PerLength(rate)) = measured.along.rate;
        let (axis, simulated, measured) = match &meeting {
            Some(meeting) => {
                (meeting.axis(), meeting.simulated(simulated), meeting.measured(measured))
            }
            None => (
                measured.along.axis.as_slice(),
                Cow::Borrowed(simulated.values.as_slice()),
                measured.values.as_slice(),
            ),
        };
        let pair = Pair { axis, simulated: &simulated, measured, rate, band: None, over };
        let Some(points) = metric.points() else { return Ok((metric.run(&pair)?, measured.len())) };
        let quantiles = |side: Side, samples: &Samples, values: &[f64]| {
            let sorted = self.meetings.sorted((samples, meeting.as_ref(), side), values);
            pair::quantiles_of_sorted(&sorted, points).map_err(|undefined| undefined.to_string())
        };
        let of_simulated = quantiles(Side::Simulated, of.0, &simulated)?;
        let of_measured = quantiles(Side::Measured, of.1, measured)?;
        Ok((
            metric.run(&Pair { simulated: &of_simulated, measured: &of_measured, ..pair })?,
            measured.len(),
        ))
    }

    pub fn input(&self, input: &InputNode, side: InputSide) -> Result<f64, String> {
        self.counted(input, side).map(|(value, _)| value)
    }

    /// A value, and the number of samples.
    fn counted(&self, input: &InputNode, side: InputSide) -> Result<(f64, usize), String> {
        match &input.joint {
            None => {
                let record = self.record(input.side.resolve(side));
                let samples = match record.get(input.node) {
                    Some(Found::Number(_, samples)) => *samples,
                    _ => 0,
                };
                Ok((number_of(record, input.node)?, samples))
            }
            Some(Joint::Metric { metric, on_common_points, over }) => {
                self.compared(*metric, *on_common_points, input.node, *over)
            }
            Some(Joint::Samples { reducer, signal }) => {
                let both = Both {
                    simulated: samples_of(self.simulated, input.node)?,
                    measured: samples_of(self.measured, input.node)?,
                    known: self.known,
                    extent: self.extent,
                    shift: self.shift,
                    meetings: self.meetings,
                };
                both.reduced(*reducer, self.method, signal)
            }
        }
    }

    pub fn record(&self, side: InputSide) -> &Evaluated {
        if side == InputSide::Measured { self.measured } else { self.simulated }
    }

    /// Number of samples or windows of the quantity's own signal that a value was taken from.
    fn samples(
        &self,
        work: &Work<'_>,
        nodes: &SignalNodes,
        value: &ValueNodes,
        side: InputSide,
    ) -> usize {
        let own =
            |input: &&InputNode| work.graph.nodes[input.node].inputs.contains(&nodes.processed);
        let input = value.inputs.iter().find(own).or(value.inputs.first());
        match input.and_then(|input| self.record(side).get(input.node)) {
            Some(Found::Number(_, samples)) => *samples,
            Some(Found::Samples(samples)) => samples.values.len(),
            Some(Found::Failed(_)) | None => 0,
        }
    }
}

pub fn number_of(found: &Evaluated, node: NodeId) -> Result<f64, String> {
    match found.get(node) {
        Some(Found::Number(value, _)) => Ok(*value),
        Some(Found::Failed(reason)) => Err(reason.clone()),
        _ => Err("a value is missing".into()),
    }
}

pub fn samples_of(found: &Evaluated, node: NodeId) -> Result<&Samples, String> {
    match found.get(node) {
        Some(Found::Samples(samples)) => Ok(samples),
        Some(Found::Failed(reason)) => Err(reason.clone()),
        _ => Err("a signal is missing".into()),
    }
}

/// The same names, without inputs and sides.
pub fn section<'a>(known: &Known<'a>) -> Known<'a> {
    Known {
        vehicle: known.vehicle,
        columns: known.columns,
        extent: known.extent,
        inputs: &[],
        sides: None,
    }
}
