//! The evaluated records of one section, and the values, differences and metrics computed from
//! them.

use std::{borrow::Cow, sync::Arc};

use super::{
    NodeValues, RecordOfSide, Row,
    common::{Both, Meetings},
};
use crate::catalog::{Metric, Pair};
use crate::graph::{Joint, SignalNodes, ValueNodes};
use crate::metrics::{pair, statistics};
use crate::run::{
    prelude::*,
    record::{NodeValue, Rate, Samples, SectionWork},
    sections::{Extent, Known},
};

/// What is computed of two records, and of how many samples.
type OfTwo<'a> = dyn Fn(&Two<'_>) -> Result<(f64, usize), Reason> + 'a;

/// All records of a section.
#[derive(Debug)]
pub struct Sides<'a> {
    pub section: &'a SectionWork<'a>,
    pub simulated: &'a [RecordOfSide],
    pub measured: &'a [RecordOfSide],
    /// The section that this one repeats.
    pub original: Option<&'a Original<'a>>,
    pub meetings: Meetings,
}

/// The original of a repeated section, and its measured records.
#[derive(Debug)]
pub struct Original<'a> {
    pub section: SectionWork<'a>,
    pub records: Vec<RecordOfSide>,
}

/// One record of each side; a side that is not read has none.
#[derive(Clone, Copy, Debug)]
pub struct Two<'a> {
    pub sides: &'a Sides<'a>,
    pub simulated: &'a NodeValues,
    pub measured: &'a NodeValues,
    pub known: &'a Known<'a>,
    pub extent: Option<Extent>,
    /// Added to the axis of the simulated record, SI: a repeat is at another distance than its
    /// original.
    pub shift: f64,
}

/// The values of a side that is not read.
static NOT_READ: NodeValues = NodeValues::NONE;

impl<'a> Sides<'a> {
    fn of(&self, side: Side) -> &'a [RecordOfSide] {
        match side {
            Side::Simulated => self.simulated,
            Side::Measured => self.measured,
        }
    }

    fn two(&'a self, simulated: &'a NodeValues, measured: &'a NodeValues) -> Two<'a> {
        let known = &self.section.known;
        Two { sides: self, simulated, measured, known, extent: known.extent, shift: 0.0 }
    }

    /// One record in the place of both sides.
    pub fn alone(&'a self, record: &'a RecordOfSide) -> Two<'a> {
        self.two(&record.found, &record.found)
    }

    /// Every record of one side with every record of the other, with the names of those of which
    /// there are several.
    pub fn pairs(&'a self) -> impl Iterator<Item = (Option<RecordName>, Two<'a>)> {
        let of = |records: &'a [RecordOfSide]| -> Vec<(Option<&'a Arc<str>>, &'a NodeValues)> {
            if records.is_empty() {
                return vec![(None, &NOT_READ)];
            }
            records.iter().map(|record| (record.name.as_ref(), &record.found)).collect()
        };
        let (simulated, measured) = (of(self.simulated), of(self.measured));
        simulated.into_iter().flat_map(move |(s, simulated)| {
            let one = |(m, measured): &(Option<&Arc<str>>, &'a NodeValues)| {
                (RecordName::joined(s, *m), self.two(simulated, measured))
            };
            measured.iter().map(one).collect::<Vec<_>>()
        })
    }

    /// Every measured record of a repeat with that of its original, which takes the place of the
    /// measurement. Distances are counted from the start of each section.
    fn repeats(&'a self) -> impl Iterator<Item = Joined<'a>> {
        self.original.into_iter().flat_map(move |original| {
            let (extent, own) = (original.section.unit.extent, self.section.known.extent);
            let shift = extent.zip(own).map_or(0.0, |((first, _), (again, _))| first - again);
            self.measured.iter().zip(&original.records).map(move |(repeat, first)| Joined {
                record: repeat.name.clone().map(RecordName::Single),
                two: Two { extent, shift, ..self.two(&repeat.found, &first.found) },
                first: self.alone(repeat),
                second: Two { known: &original.section.known, ..self.alone(first) },
            })
        })
    }

    /// The records that a rule asks for, in the order of the campaign.
    fn chosen(&self, chosen: Chosen) -> Vec<&'a RecordOfSide> {
        let records = &self.section.work.plan.records;
        let members = chosen.record.map_or(&[][..], |index| &records[index].members);
        let named = |record: &&RecordOfSide| {
            members.iter().any(|member| record.called.as_deref() == Some(member.value.as_str()))
        };
        self.of(chosen.side).iter().filter(|record| members.is_empty() || named(record)).collect()
    }

    /// Two records that are compared, and the names of those of which there are several.
    fn joined(&'a self, pairing: Pairing) -> Result<Vec<Joined<'a>>, Reason> {
        let pair = |first: &'a RecordOfSide, second: &'a RecordOfSide| Joined {
            record: RecordName::joined(first.name.as_ref(), second.name.as_ref()),
            two: self.two(&first.found, &second.found),
            first: self.alone(first),
            second: self.alone(second),
        };
        match pairing {
            Pairing::Repeats => Ok(self.repeats().collect()),
            Pairing::EachOther(of) => {
                let all = self.chosen(of);
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
                let (firsts, seconds) = (self.chosen(one), self.chosen(other));
                let with = |first: &'a RecordOfSide| {
                    let others = seconds.iter().filter(move |second| second.which != first.which);
                    others.map(|second| pair(first, second)).collect::<Vec<_>>()
                };
                let found: Vec<Joined<'a>> = firsts.into_iter().flat_map(with).collect();
                if found.is_empty() { Err(one_record(one.side)) } else { Ok(found) }
            }
        }
    }

    /// The rows of one position of a quantity.
    ///
    /// # Errors
    /// Why it has none.
    pub fn rows(&'a self, quantity: usize, position: usize) -> Result<Vec<Row>, Reason> {
        let nodes = &self.section.work.graph.quantities[quantity].signals[position];
        let quantity = &self.section.work.plan.quantities[quantity];
        let of_pairs = |pairing: Pairing, of_two: &OfTwo<'_>| -> Result<Vec<Row>, Reason> {
            let one = |Joined { record, two, .. }: Joined<'_>| {
                Ok(Row::single(position, 0, record, of_two(&two)?))
            };
            self.joined(pairing)?.into_iter().map(one).collect()
        };
        match quantity.evaluation.as_ref() {
            Evaluation::Metric { metric, pairing, .. } => {
                let common = metric.on_common_points(quantity.keeps_samples());
                let node = if common { nodes.filtered } else { nodes.processed };
                of_pairs(*pairing, &|two| two.compared(*metric, common, node, nodes.over))
            }
            Evaluation::Combined { of, pairing } => {
                of_pairs(*pairing, &|two| two.combined(&of.expr, &nodes.inputs))
            }
            Evaluation::Values { values, records } => {
                let mut rows = Vec::new();
                let mut applied = false;
                for (which, (value, of)) in values.iter().zip(&nodes.values).enumerate() {
                    // Of several values, only those whose case applies.
                    if values.len() > 1 && !applies(&value.expr, &self.section.known)? {
                        continue;
                    }
                    applied = true;
                    rows.extend(self.of_value(records, (position, which), nodes, of)?);
                }
                if applied { Ok(rows) } else { Err(Reason::NoValueApplies) }
            }
        }
    }

    fn of_value(
        &'a self,
        records: &Records,
        (position, which): (usize, usize),
        nodes: &SignalNodes,
        value: &ValueNodes,
    ) -> Result<Vec<Row>, Reason> {
        let samples = |two: &Two<'_>, side| two.count(nodes, value, side);
        let alone = |of: Chosen| {
            self.chosen(of).into_iter().map(move |record| {
                let (two, side) = (self.alone(record), own(of.side));
                let found = (two.value(value, side)?, samples(&two, side));
                Ok::<_, Reason>(Row::single(
                    position,
                    which,
                    record.name.clone().map(RecordName::Single),
                    found,
                ))
            })
        };
        let compared = |row: Row, difference: &Expr, (s, m): (f64, f64)| -> Result<Row, Reason> {
            let value = number(difference, &Known { sides: Some((s, m)), ..self.section.known })?;
            Ok(Row { simulated: Some(s), measured: Some(m), value, ..row })
        };
        match records {
            Records::Of(of) => alone(*of).collect(),
            Records::Compared { pairing, difference } => {
                let within = pairing.within();
                let within = within.or((*pairing == Pairing::Repeats).then_some(Side::Measured));
                let one = |Joined { record, two, first, second }: Joined<'_>| {
                    // Of two sides, each number may also take values of the other one.
                    let (s, m, of) = match within.map(own) {
                        None => {
                            let s = two.value(value, InputSide::Simulated)?;
                            let m = two.value(value, InputSide::Measured)?;
                            (s, m, samples(&two, InputSide::Measured))
                        }
                        Some(side) => {
                            let s = first.value(value, side)?;
                            (s, second.value(value, side)?, samples(&first, side))
                        }
                    };
                    compared(Row::single(position, which, record, (0.0, of)), difference, (s, m))
                };
                self.joined(*pairing)?.into_iter().map(one).collect()
            }
            Records::Spread { of, among, center, difference } => {
                let all = alone(*among).map(|row| Ok(row?.value));
                let values = all.collect::<Result<Vec<f64>, Reason>>()?;
                if values.len() < 2 {
                    return Err(one_record(of.side));
                }
                let center = match center {
                    Center::Mean => statistics::mean(&values),
                    Center::Median => statistics::median(&values),
                };
                let center = center.ok_or(Reason::NoMeanOfRecords)?;
                let one = |row: Result<Row, Reason>| {
                    let row = row?;
                    let value = row.value;
                    compared(row, difference, (value, center))
                };
                alone(*of).map(one).collect()
            }
        }
    }
}

/// Two records that are compared.
struct Joined<'a> {
    /// The names of those of which there are several.
    record: Option<RecordName>,
    two: Two<'a>,
    /// Each by itself.
    first: Two<'a>,
    second: Two<'a>,
}

fn one_record(side: Side) -> Reason {
    Reason::OneRecord { side: side.in_words().into() }
}

fn own(side: Side) -> InputSide {
    match side {
        Side::Simulated => InputSide::Simulated,
        Side::Measured => InputSide::Measured,
    }
}

/// Whether some case of an expression holds; an expression without cases always applies.
fn applies(expr: &Expr, known: &Known<'_>) -> Result<bool, Reason> {
    let Kind::Cases(arms, None) = &expr.kind else { return Ok(true) };
    for (_, condition) in arms {
        if flag(condition, known)? {
            return Ok(true);
        }
    }
    Ok(false)
}

impl Two<'_> {
    /// The value of a node for one side.
    fn value(&self, value: &ValueNodes, side: InputSide) -> Result<f64, Reason> {
        match &self.sides.section.work.graph.nodes[value.node].operation {
            Operation::Value(expr) => {
                let inputs: Vec<Result<f64, Reason>> =
                    value.inputs.iter().map(|input| self.input(input, side)).collect();
                number(expr, &Known { inputs: &inputs, ..*self.known })
            }
            _ => self.input(value.inputs.first().ok_or(Reason::Internal)?, side),
        }
    }

    /// An expression of metrics of both signals, and the number of samples.
    fn combined(&self, of: &Expr, inputs: &[InputNode]) -> Result<(f64, usize), Reason> {
        let found: Vec<_> =
            inputs.iter().map(|input| self.counted(input, InputSide::Measured)).collect();
        let samples = found.iter().flatten().map(|(_, samples)| *samples).max().unwrap_or(0);
        let inputs: Vec<Result<f64, Reason>> =
            found.into_iter().map(|found| found.map(|(value, _)| value)).collect();
        Ok((number(of, &Known { inputs: &inputs, ..self.sides.section.known })?, samples))
    }

    /// A metric of both signals of a node, and the number of measured samples.
    fn compared(
        &self,
        metric: Metric,
        on_common_points: bool,
        node: NodeId,
        over: Option<NodeId>,
    ) -> Result<(f64, usize), Reason> {
        let of @ (simulated, measured) =
            (self.simulated.samples(node)?, self.measured.samples(node)?);
        let meeting = if on_common_points {
            Some(self.sides.meetings.of(simulated, measured, self.extent, self.shift)?)
        } else {
            None
        };
        let over = match over {
            None => None,
            Some(node) => Some((self.simulated.samples(node)?, self.measured.samples(node)?)),
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
        let shift = self.sides.meetings.best_shift(of);
        let (simulated, best_shift) = (simulated.as_ref(), shift.as_ref());
        let pair = Pair { axis, simulated, measured, rate, band: None, over, best_shift };
        let run = |pair: &Pair<'_>| metric.run(pair).map_err(Reason::method);
        let Some(points) = metric.points() else { return Ok((run(&pair)?, measured.len())) };
        let quantiles = |side: Side, samples: &Samples, values: &[f64]| {
            let sorted = self.sides.meetings.sorted((samples, meeting.as_ref(), side), values);
            pair::quantiles_of_sorted(&sorted, points).map_err(Reason::method)
        };
        let of_simulated = quantiles(Side::Simulated, of.0, simulated)?;
        let of_measured = quantiles(Side::Measured, of.1, measured)?;
        Ok((
            run(&Pair { simulated: &of_simulated, measured: &of_measured, ..pair })?,
            measured.len(),
        ))
    }

    pub fn input(&self, input: &InputNode, side: InputSide) -> Result<f64, Reason> {
        self.counted(input, side).map(|(value, _)| value)
    }

    /// A value, and the number of samples.
    fn counted(&self, input: &InputNode, side: InputSide) -> Result<(f64, usize), Reason> {
        match &input.joint {
            None => self.record(input.side.resolve(side)).number(input.node),
            Some(Joint::Metric { metric, on_common_points, over }) => {
                self.compared(*metric, *on_common_points, input.node, *over)
            }
            Some(Joint::Samples { reducer, signal }) => {
                let both = Both {
                    simulated: self.simulated.samples(input.node)?,
                    measured: self.measured.samples(input.node)?,
                    known: self.known,
                    extent: self.extent,
                    shift: self.shift,
                    meetings: &self.sides.meetings,
                };
                let method = self.sides.section.work.plan.sections.percentiles;
                both.reduced(*reducer, method, signal)
            }
        }
    }

    fn record(&self, side: InputSide) -> &NodeValues {
        if side == InputSide::Measured { self.measured } else { self.simulated }
    }

    /// Number of samples or windows of the quantity's own signal that a value was taken from.
    fn count(&self, nodes: &SignalNodes, value: &ValueNodes, side: InputSide) -> usize {
        let graph = self.sides.section.work.graph;
        let own = |input: &&InputNode| graph.nodes[input.node].inputs.contains(&nodes.processed);
        let input = value.inputs.iter().find(own).or(value.inputs.first());
        match input.and_then(|input| self.record(side).get(input.node)) {
            Some(NodeValue::Number(_, samples)) => *samples,
            Some(NodeValue::Samples(samples)) => samples.values.len(),
            Some(NodeValue::Failed(_)) | None => 0,
        }
    }
}
