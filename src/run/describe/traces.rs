//! Signals of the most important sections, reduced for plotting.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::check::plan::{Evaluation, Plan, Records, Side};
use crate::data::WhichRecord;
use crate::graph::{Graph, NodeId};
use crate::result::{Curve, QuantityResult, Reason, RecordName, Remark, Trace};
use crate::run::data_rules::take_over;
use crate::run::record::{NodeValue, Opened, Samples, Work, with_record};
use crate::run::sections::{Extent, Unit as Section};
use crate::run::values::{Row, SectionValues};
use crate::units::Unit;

/// Number of stretches of a plotted curve. Each keeps its smallest and largest sample, so that no
/// peak is lost.
const STRETCHES: usize = 700;

/// Sections of each quantity whose signals a part keeps, the worst first. Sections that the part
/// itself uses may be left out when all parts are together: copies of other parts, and a reduction.
/// A plot for which nothing was kept is told.
const KEPT: usize = 3;

/// Where the signals of plots come from.
#[derive(Debug)]
pub enum Signals<'a> {
    /// The records.
    Of(&'a Work<'a>),
    /// What parts of the campaign kept.
    Kept(&'a [Kept]),
}

/// The signals of one pair, or why there is no plot of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Kept {
    quantity: usize,
    unit: usize,
    signal: usize,
    #[serde(flatten)]
    record: Option<RecordName>,
    pub found: Result<Trace, Reason>,
}

impl Kept {
    /// Whether each curve has as many values as places, as a file may claim.
    pub fn is_sound(&self) -> bool {
        let sound = |curve: &Curve| curve.x.len() == curve.y.len();
        let Ok(trace) = &self.found else { return true };
        [&trace.measured, &trace.simulated]
            .into_iter()
            .chain(trace.others.iter().map(|(_, curve)| curve))
            .all(sound)
    }
}

/// The pair with the largest difference of each quantity, relative to its limits. The worst is
/// first, each signal of a section once. If a plot cannot be made, a note states the reason.
pub fn traces(
    (plan, graph): (&Plan, &Graph),
    units: &[Section],
    quantities: &[QuantityResult],
    most: usize,
    signals: &Signals<'_>,
) -> Vec<Result<Trace, Remark>> {
    let mut picks: Vec<(f64, Pick<'_>)> = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let limit = quantity
            .statistics
            .iter()
            .filter_map(|statistic| statistic.limit)
            .fold(f64::NAN, f64::max);
        let scale = if limit > 0.0 { limit } else { 1.0 };
        let worst =
            quantity.values.iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()));
        let Some(worst) = worst else { continue };
        let unit = units.iter().position(|unit| unit.name == worst.section);
        let signal = plan.quantities[index]
            .positions
            .iter()
            .position(|position| position.name == worst.signal);
        if let (Some(unit), Some(signal)) = (unit, signal) {
            let pick = Pick { quantity: index, unit, signal, record: worst.record.as_ref() };
            picks.push((worst.difference.abs() / scale, pick));
        }
    }
    picks.sort_by(|(a, first), (b, second)| {
        b.total_cmp(a).then(first.quantity.cmp(&second.quantity))
    });
    let mut shown = BTreeSet::new();
    picks.retain(|(_, pick)| {
        shown.insert((
            graph.quantities[pick.quantity].signals[pick.signal].filtered,
            pick.unit,
            pick.record,
        ))
    });
    picks.truncate(most);
    let one = |(_, pick): &(f64, Pick<'_>)| {
        let found = match signals {
            Signals::Of(work) => {
                trace(work, *pick, &|unit, which, wanted| evaluated(work, unit, which, wanted))
            }
            Signals::Kept(kept) => kept
                .iter()
                .find(|kept| {
                    (kept.quantity, kept.unit, kept.signal, kept.record.as_ref()) == pick.key()
                })
                .map_or_else(|| Err(Reason::SignalsNotKept), |kept| kept.found.clone()),
        };
        found.map_err(|reason| Remark::NoPlot {
            quantity: quantities[pick.quantity].id.clone(),
            section: units[pick.unit].name.clone(),
            reason,
        })
    };
    picks.par_iter().map(one).collect()
}

/// The signals that plots of the whole campaign may need from these sections: of each quantity the
/// worst ones.
pub fn kept(work: &Work<'_>, sections: &[(usize, SectionValues)]) -> Vec<Kept> {
    let mut units: Vec<Section> =
        sections.iter().filter_map(|(number, _)| work.units.get(*number).cloned()).collect();
    let values: Vec<SectionValues> = sections.iter().map(|(_, values)| values.clone()).collect();
    // What stops a run stops it when the sections are judged.
    let _ = take_over(work.plan, work.facts, &mut units, &values, &[], &mut Vec::new());
    let mut picks: BTreeMap<usize, Vec<Pick<'_>>> = BTreeMap::new();
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut worst: Vec<(f64, Pick<'_>)> = Vec::new();
        for (_, (number, values)) in
            units.iter().zip(sections).filter(|(unit, _)| unit.fault.is_none())
        {
            let size = |row: &Row| quantity.unit.from_si(row.value).abs();
            let rows = values.rows.get(index).map_or(&[][..], Vec::as_slice);
            let Some(row) = rows.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else {
                continue;
            };
            worst.push((
                size(row),
                Pick {
                    quantity: index,
                    unit: *number,
                    signal: row.position,
                    record: row.record.as_ref(),
                },
            ));
        }
        // Of equal ones the last, as in the whole campaign.
        worst.reverse();
        worst.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        worst.truncate(KEPT);
        worst.into_iter().for_each(|(_, pick)| picks.entry(pick.unit).or_default().push(pick));
    }
    let of_section = |picks: &Vec<Pick<'_>>| {
        let together = Together::of(work, picks);
        let one = |pick: &Pick<'_>| Kept {
            quantity: pick.quantity,
            unit: pick.unit,
            signal: pick.signal,
            record: pick.record.cloned(),
            found: trace(work, *pick, &|unit, which, wanted| {
                together.evaluated(unit, which, wanted)
            }),
        };
        picks.iter().map(one).collect::<Vec<_>>()
    };
    picks.par_iter().flat_map_iter(|(_, picks)| of_section(picks)).collect()
}

/// What is plotted.
#[derive(Clone, Copy)]
struct Pick<'a> {
    quantity: usize,
    unit: usize,
    signal: usize,
    /// The records that were compared, where there are several.
    record: Option<&'a RecordName>,
}

impl<'a> Pick<'a> {
    fn key(&self) -> (usize, usize, usize, Option<&'a RecordName>) {
        (self.quantity, self.unit, self.signal, self.record)
    }
}

/// Values of nodes of a record, and the range that is shown.
type Nodes = (Vec<(NodeId, NodeValue)>, Extent);
type Signal = Result<Nodes, Reason>;
/// Evaluates nodes of a record.
type Evaluate<'a> = &'a dyn Fn(&Section, WhichRecord, &BTreeSet<NodeId>) -> Signal;

fn evaluated(
    work: &Work<'_>,
    unit: &Section,
    which: WhichRecord,
    wanted: &BTreeSet<NodeId>,
) -> Signal {
    let known = unit.known(work.facts);
    let evaluate = |opened: &Opened, needed: &BTreeSet<NodeId>| {
        opened.evaluate((work.plan, work.graph), needed, wanted, &known, None)
    };
    let (found, opened) =
        with_record(work, unit, which, wanted, &known, evaluate).map_err(|fault| fault.reason)?;
    let around = |found: NodeValue| match found {
        NodeValue::Samples(samples) => NodeValue::Samples(opened.around_section(samples)),
        other => other,
    };
    Ok((
        found
            .map_err(|fault| fault.reason)?
            .into_iter()
            .map(|(node, found)| (node, around(found)))
            .collect(),
        opened.extent,
    ))
}

/// The signals of several plots of a section: each record is read once.
struct Together<'a> {
    work: &'a Work<'a>,
    all: BTreeSet<NodeId>,
    found: RefCell<BTreeMap<(String, WhichRecord), Option<Nodes>>>,
}

impl<'a> Together<'a> {
    fn of(work: &'a Work<'a>, picks: &[Pick<'_>]) -> Self {
        let all = picks.iter().flat_map(|pick| wanted(work, pick)).collect();
        Self { work, all, found: RefCell::default() }
    }

    fn evaluated(&self, unit: &Section, which: WhichRecord, wanted: &BTreeSet<NodeId>) -> Signal {
        let mut found = self.found.borrow_mut();
        let of_all = || evaluated(self.work, unit, which, &self.all).ok();
        match found.entry((unit.name.clone(), which)).or_insert_with(of_all) {
            Some((found, extent)) => Ok((
                found.iter().filter(|(node, _)| wanted.contains(node)).cloned().collect(),
                *extent,
            )),
            // One of them cannot be evaluated: each by itself.
            None => evaluated(self.work, unit, which, wanted),
        }
    }
}

/// The signals of a plot: what is plotted, and the signal that a metric uses in place of the axis.
/// A loop is plotted from the signals that were compared; other signals from the record around the
/// section as well.
fn wanted(work: &Work<'_>, pick: &Pick<'_>) -> Vec<NodeId> {
    let nodes = &work.graph.quantities[pick.quantity].signals[pick.signal];
    match (work.plan.quantities[pick.quantity].evaluation.as_ref(), nodes.over) {
        (Evaluation::Metric { over_axis: Some(_), .. }, Some(over)) => vec![nodes.processed, over],
        _ => vec![nodes.filtered],
    }
}

/// The horizontal axis of a plot: the axis of the records, or the signal that the metric uses in
/// its place.
struct Over {
    node: Option<NodeId>,
    name: String,
    unit: Unit,
}

fn trace(work: &Work<'_>, pick: Pick<'_>, evaluate: Evaluate<'_>) -> Result<Trace, Reason> {
    let Pick { quantity: index, signal, record, .. } = pick;
    let unit = &work.units[pick.unit];
    let quantity = &work.plan.quantities[index];
    let nodes = &work.graph.quantities[index].signals[signal];
    let axis = &work.plan.axis;
    let over = match (quantity.evaluation.as_ref(), nodes.over) {
        (Evaluation::Metric { over_axis: Some(over), .. }, Some(node)) => {
            Over { node: Some(node), name: over.column.clone(), unit: over.unit.clone() }
        }
        _ => Over { node: None, name: axis.column.clone(), unit: axis.unit.clone() },
    };
    let all = wanted(work, &pick);
    let (node, wanted) = (all[0], BTreeSet::from_iter(all));
    let curve_of = |unit: &Section, which: WhichRecord| {
        let (found, extent) = evaluate(unit, which, &wanted)?;
        let of = |node: NodeId| {
            found.iter().find_map(|(id, found)| {
                if let (true, NodeValue::Samples(samples)) = (*id == node, found) {
                    Some(samples)
                } else {
                    None
                }
            })
        };
        let samples = of(node).ok_or(Reason::NoSamples)?;
        let x: &[f64] = match over.node {
            Some(node) => &of(node).ok_or(Reason::NoSamples)?.values,
            None => &samples.along.axis,
        };
        Ok::<_, Reason>((thinned(samples, x, &quantity.signal_unit, &over.unit), extent))
    };
    let name = |which| work.campaign(unit).record_name(which).map(|name| name.as_ref());
    let curve = |unit: &Section, side: Side| {
        let all = work.campaign(unit).records(side.kind());
        let which = all
            .into_iter()
            .find(|&which| RecordName::took_part(record, side == Side::Simulated, name(which)));
        curve_of(
            unit,
            which.ok_or_else(|| Reason::NoRecordOfSide { side: side.in_words().into() })?,
        )
    };
    let of = |side: Side| -> Result<_, Reason> {
        if quantity.evaluation.reads(side) { curve(unit, side).map(Some) } else { Ok(None) }
    };
    let original = unit
        .original
        .and_then(|original| work.units.get(original))
        .filter(|_| quantity.evaluation.of_repeats());
    let (measured, simulated) = match original {
        // The original stands in the place of the measurement; distances count from the start of
        // each section.
        Some(original) => {
            let (repeat, (mut first, extent)) =
                (curve(unit, Side::Measured)?, curve(original, Side::Measured)?);
            if over.node.is_none() {
                let shift = over.unit.from_si(repeat.1.0) - over.unit.from_si(extent.0);
                first.x.iter_mut().for_each(|x| *x += shift);
            }
            (Some((first, repeat.1)), Some(repeat))
        }
        None => (of(Side::Measured)?, of(Side::Simulated)?),
    };
    let mut others = Vec::new();
    if let Evaluation::Values { records: Records::Spread { of, .. }, .. } =
        quantity.evaluation.as_ref()
    {
        for which in work
            .campaign(unit)
            .records(of.side.kind())
            .into_iter()
            .filter(|&which| name(which) != record.map(|record| record.first().as_ref()))
        {
            others.push((name(which).unwrap_or_default().to_string(), curve_of(unit, which)?.0));
        }
    }
    let extent = measured.as_ref().or(simulated.as_ref()).map_or((0.0, 0.0), |(_, extent)| *extent);
    let of_curve = |curve: Option<(Curve, _)>| curve.map(|(curve, _)| curve).unwrap_or_default();
    let (measured, simulated) = (of_curve(measured), of_curve(simulated));
    let (start, end) = match over.node {
        None => (over.unit.from_si(extent.0), over.unit.from_si(extent.1)),
        Some(_) => measured
            .x
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x))),
    };
    Ok(Trace {
        quantity: quantity.id.clone(),
        section: unit.name.clone(),
        zone: unit.zone.clone(),
        signal: quantity.positions[signal].name.clone(),
        why: format!(
            "largest {} of {}{}",
            if quantity.evaluation.assesses() { "value" } else { "difference" },
            quantity.id,
            record.map_or_else(String::new, |name| format!(" ({name})"))
        ),
        unit: quantity.signal_unit.text.clone(),
        axis: over.name,
        axis_unit: over.unit.text,
        start,
        end,
        measured,
        simulated,
        record: record.map(ToString::to_string),
        others,
    })
}

fn thinned(samples: &Samples, x: &[f64], unit: &Unit, x_unit: &Unit) -> Curve {
    let mut curve = Curve::default();
    let mut keep = |at: usize| {
        curve.x.push(x_unit.from_si(x[at]));
        curve.y.push(unit.from_si(samples.values[at]));
    };
    let count = samples.values.len().min(x.len());
    if count <= 2 * STRETCHES {
        (0..count).for_each(keep);
        return curve;
    }
    for stretch in 0..STRETCHES {
        let range = stretch * count / STRETCHES..(stretch + 1) * count / STRETCHES;
        let by = |a: &usize, b: &usize| samples.values[*a].total_cmp(&samples.values[*b]);
        let (low, high) = (range.clone().min_by(by), range.max_by(by));
        if let (Some(low), Some(high)) = (low, high) {
            keep(low.min(high));
            if low != high {
                keep(low.max(high));
            }
        }
    }
    curve
}
