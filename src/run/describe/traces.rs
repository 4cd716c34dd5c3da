//! Signals of the most important sections, reduced for plotting.

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::check::plan;
use crate::metrics::statistics::ends;
use crate::result::{Curve, Direction, QuantityResult, Trace};
use crate::run::{
    data_rules::take_over,
    prelude::*,
    record::{NodeValue, Samples, SectionWork, Work},
    sections::{Extent, Unit as Section},
    values::{Row, SectionValues},
};
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

/// The pair of each quantity that uses the largest share of its limit. The worst is first, each signal of a section once. If a plot cannot be made, a note states the reason.
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
        let Some((worst, share)) = quantity.worst_first().into_iter().next() else { continue };
        let unit = units.iter().position(|unit| unit.name == worst.section);
        let signal = plan.quantities[index]
            .positions
            .iter()
            .position(|position| position.name == worst.signal);
        if let (Some(unit), Some(signal)) = (unit, signal) {
            let pick = Pick { quantity: index, unit, signal, record: worst.record.as_ref() };
            picks.push((share.unwrap_or_else(|| worst.difference.abs() / scale), pick));
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
            Signals::Of(work) => Records::of(work, std::slice::from_ref(pick)).trace(pick),
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
    let _ = take_over(work.plan, &mut units, &values, &[], &mut Vec::new());
    let mut picks: BTreeMap<usize, Vec<Pick<'_>>> = BTreeMap::new();
    for (index, quantity) in work.plan.quantities.iter().enumerate() {
        let mut worst: Vec<(f64, Pick<'_>)> = Vec::new();
        for (_, (number, values)) in
            units.iter().zip(sections).filter(|(unit, _)| unit.fault.is_none())
        {
            // The limits of single values, which may differ between sections, are not known yet.
            let limit = quantity.limits.first();
            let least = limit.is_some_and(|limit| limit.direction == Direction::AtLeast);
            let size = |row: &Row| if least { -row.value } else { row.value.abs() };
            let rows = values.rows.get(index).map_or(&[][..], Vec::as_slice);
            let Some(row) = rows.iter().rev().max_by(|a, b| size(a).total_cmp(&size(b))) else {
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
        // Of equal ones the first, as in the whole campaign.
        worst.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        worst.truncate(KEPT);
        worst.into_iter().for_each(|(_, pick)| picks.entry(pick.unit).or_default().push(pick));
    }
    let of_section = |picks: &Vec<Pick<'_>>| {
        let records = Records::of(work, picks);
        let one = |pick: &Pick<'_>| Kept {
            quantity: pick.quantity,
            unit: pick.unit,
            signal: pick.signal,
            record: pick.record.cloned(),
            found: records.trace(pick),
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

    /// The signal that is plotted, and the horizontal axis: that of the records, or the signal that
    /// a metric uses in its place. A loop is plotted from the signals that were compared; other
    /// signals from the record around the section as well.
    fn signals<'w>(&self, work: &Work<'w>) -> (NodeId, Option<NodeId>, &'w Axis) {
        let nodes = &work.graph.quantities[self.quantity].signals[self.signal];
        match (work.plan.quantities[self.quantity].evaluation.as_ref(), nodes.over) {
            (Evaluation::Metric { over_axis: Some(axis), .. }, Some(over)) => {
                (nodes.processed, Some(over), axis)
            }
            _ => (nodes.filtered, None, &work.plan.axis),
        }
    }

    fn nodes(&self, work: &Work<'_>) -> BTreeSet<NodeId> {
        let (signal, over, _) = self.signals(work);
        BTreeSet::from_iter(Some(signal).into_iter().chain(over))
    }
}

/// Signals of a record, and the range that is shown.
type Shown = Result<(BTreeMap<NodeId, Samples>, Extent), Reason>;

/// The records of the plots of a section: each is read once.
struct Records<'a> {
    work: &'a Work<'a>,
    /// The signals of all plots.
    all: BTreeSet<NodeId>,
    found: RefCell<BTreeMap<(String, WhichRecord), Shown>>,
}

impl<'a> Records<'a> {
    fn of(work: &'a Work<'a>, picks: &[Pick<'_>]) -> Self {
        let all = picks.iter().flat_map(|pick| pick.nodes(work)).collect();
        Self { work, all, found: RefCell::default() }
    }

    fn read(&self, unit: &Section, which: WhichRecord, wanted: &BTreeSet<NodeId>) -> Shown {
        let Work { plan, graph, .. } = *self.work;
        let section = SectionWork::new(self.work, unit);
        let read = section.with_record(which, wanted, |opened, needed| {
            opened.evaluate((plan, graph), needed, wanted, &section.known, None)
        });
        let (found, opened) = read.map_err(|fault| fault.reason)?;
        let samples = |(node, found): (NodeId, NodeValue)| match found {
            NodeValue::Samples(samples) => Some((node, opened.around_section(samples))),
            NodeValue::Number(..) | NodeValue::Failed(_) => None,
        };
        let found = found.map_err(|fault| fault.reason)?;
        Ok((found.into_iter().filter_map(samples).collect(), opened.extent))
    }

    fn signals(&self, unit: &Section, which: WhichRecord, pick: &Pick<'_>) -> Shown {
        let mut found = self.found.borrow_mut();
        let of_all = || self.read(unit, which, &self.all);
        match found.entry((unit.name.clone(), which)).or_insert_with(of_all) {
            Ok(found) => Ok(found.clone()),
            // One of them cannot be evaluated: each by itself.
            Err(_) => self.read(unit, which, &pick.nodes(self.work)),
        }
    }

    fn trace(&self, pick: &Pick<'_>) -> Result<Trace, Reason> {
        let Pick { quantity, signal, record, .. } = *pick;
        let work = self.work;
        let (unit, quantity) = (&work.units[pick.unit], &work.plan.quantities[quantity]);
        let campaign = work.campaigns.get(unit.campaign);
        let (node, over, axis) = pick.signals(work);
        let least = quantity.limits.iter().any(|one| one.direction == Direction::AtLeast);
        let further = match quantity.evaluation.as_ref() {
            Evaluation::Values { values, .. } => {
                let inputs = values.iter().flat_map(|value| value.inputs.iter().flatten());
                inputs.into_iter().any(|input| input.signal.is_some())
            }
            _ => false,
        };
        let name = |which| campaign.record_name(which).map(|name| name.as_ref());
        let curve_of = |unit: &Section, which: WhichRecord| {
            let (found, extent) = self.signals(unit, which, pick)?;
            let of = |node: NodeId| found.get(&node).ok_or(Reason::NoSamples);
            let samples = of(node)?;
            let x: &[f64] = match over {
                Some(node) => &of(node)?.values,
                None => &samples.along.axis,
            };
            Ok::<_, Reason>((thinned(samples, x, &quantity.signal_unit, &axis.unit), extent))
        };
        let curve = |unit: &Section, side: Side| {
            let took_part =
                |which| RecordName::took_part(record, side == Side::Simulated, name(which));
            let which = campaign.records(side.kind()).into_iter().find(|&which| took_part(which));
            let none = || Reason::NoRecordOfSide { side: side.in_words().into() };
            curve_of(unit, which.ok_or_else(none)?)
        };
        let of =
            |side: Side| quantity.evaluation.reads(side).then(|| curve(unit, side)).transpose();
        let original = unit
            .original
            .and_then(|original| work.units.get(original))
            .filter(|_| quantity.evaluation.of_repeats());
        let (measured, simulated) = match original {
            // The original stands in the place of the measurement; distances count from the start
            // of each section.
            Some(original) => {
                let repeat = curve(unit, Side::Measured)?;
                let (mut first, extent) = curve(original, Side::Measured)?;
                if over.is_none() {
                    let shift = axis.unit.from_si(repeat.1.0) - axis.unit.from_si(extent.0);
                    first.x.iter_mut().for_each(|x| *x += shift);
                }
                (Some((first, repeat.1)), Some(repeat))
            }
            None => (of(Side::Measured)?, of(Side::Simulated)?),
        };
        let mut others = Vec::new();
        if let Evaluation::Values { records: plan::Records::Spread { of, .. }, .. } =
            quantity.evaluation.as_ref()
        {
            let own = record.map(|record| record.first().as_ref());
            for which in campaign.records(of.side.kind()) {
                if name(which) != own {
                    let name = name(which).unwrap_or_default().to_string();
                    others.push((name, curve_of(unit, which)?.0));
                }
            }
        }
        let shown = measured.as_ref().or(simulated.as_ref());
        let (start, end) = shown.map_or((0.0, 0.0), |(_, extent)| *extent);
        let of_curve =
            |curve: Option<(Curve, _)>| curve.map(|(curve, _)| curve).unwrap_or_default();
        let (measured, simulated) = (of_curve(measured), of_curve(simulated));
        let (start, end) = match over {
            None => (axis.unit.from_si(start), axis.unit.from_si(end)),
            Some(_) => ends(measured.x.iter().copied()),
        };
        Ok(Trace {
            quantity: quantity.id.clone(),
            section: unit.name.clone(),
            zone: unit.zone.clone(),
            signal: quantity.positions[signal].name.clone(),
            why: format!(
                "{} {} of {}{}{}",
                if least { "decisive" } else { "largest" },
                if quantity.evaluation.assesses() { "value" } else { "difference" },
                quantity.id,
                record.map_or_else(String::new, |name| format!(" ({name})")),
                if further { ", which is formed from other signals as well" } else { "" }
            ),
            unit: quantity.signal_unit.text.clone(),
            axis: axis.column.clone(),
            axis_unit: axis.unit.text.clone(),
            start,
            end,
            measured,
            simulated,
            record: record.map(ToString::to_string),
            others,
        })
    }
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
