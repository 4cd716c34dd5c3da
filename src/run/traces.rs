//! Signals of the most important sections, reduced for plotting.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::record::{Found, Work, needed, open};
use super::sections::Unit as Section;
use super::signal::Samples;
use crate::check::plan::{Evaluation, Records, Side};
use crate::data::WhichRecord;
use crate::graph::NodeId;
use crate::result::{Curve, QuantityResult, Trace, took_part};
use crate::units::Unit;

/// Number of stretches of a plotted curve. Each keeps its smallest and largest sample, so that no peak is lost.
const STRETCHES: usize = 700;

/// The pair with the largest difference of each quantity, relative to its limits. The worst is first, each signal of a section
/// once. If a plot cannot be made, a note states the reason.
pub fn traces(work: &Work<'_>, units: &[Section], quantities: &[QuantityResult], most: usize) -> Vec<Result<Trace, String>> {
    let mut picks: Vec<(f64, Pick<'_>)> = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let limit = quantity.statistics.iter().filter_map(|statistic| statistic.limit).fold(f64::NAN, f64::max);
        let scale = if limit > 0.0 { limit } else { 1.0 };
        let worst = quantity.values.iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()));
        let Some(worst) = worst else { continue };
        let unit = units.iter().position(|unit| unit.name == worst.section);
        let signal = work.plan.quantities[index].positions.iter().position(|position| position.name == worst.signal);
        if let (Some(unit), Some(signal)) = (unit, signal) {
            let pick = Pick { quantity: index, unit, signal, record: worst.record.as_deref() };
            picks.push((worst.difference.abs() / scale, pick));
        }
    }
    picks.sort_by(|(a, first), (b, second)| b.total_cmp(a).then(first.quantity.cmp(&second.quantity)));
    let mut shown = BTreeSet::new();
    picks.retain(|(_, pick)| shown.insert((work.graph.quantities[pick.quantity].signals[pick.signal].filtered, pick.unit, pick.record)));
    picks.truncate(most);
    let one = |(_, pick): &(f64, Pick<'_>)| {
        let unit = &units[pick.unit];
        trace(work, unit, *pick).map_err(|why| {
            let id = &quantities[pick.quantity].id;
            format!("there is no plot of {id} in section {}: {why}", unit.name)
        })
    };
    picks.par_iter().map(one).collect()
}

/// What is plotted.
#[derive(Clone, Copy)]
struct Pick<'a> {
    quantity: usize,
    unit: usize,
    signal: usize,
    /// The records that were compared, where there are several.
    record: Option<&'a str>,
}

/// The horizontal axis of a plot: the axis of the records, or the signal that the metric uses in its place.
struct Over {
    node: Option<NodeId>,
    name: String,
    unit: Unit,
}

fn trace(work: &Work<'_>, unit: &Section, Pick { quantity: index, signal, record, .. }: Pick<'_>) -> Result<Trace, String> {
    let quantity = &work.plan.quantities[index];
    let nodes = &work.graph.quantities[index].signals[signal];
    let axis = &work.plan.axis;
    let over = match (quantity.evaluation.as_ref(), nodes.over) {
        (Evaluation::Metric { over_axis: Some(over), .. }, Some(node)) => {
            Over { node: Some(node), name: over.column.clone(), unit: over.unit.clone() }
        }
        _ => Over { node: None, name: axis.column.clone(), unit: axis.unit.clone() },
    };
    // A loop is plotted from the signals that were compared; other signals from the record around the section as well.
    let node = if over.node.is_some() { nodes.processed } else { nodes.filtered };
    let wanted: BTreeSet<NodeId> = [node].into_iter().chain(over.node).collect();
    let curve_of = |unit: &Section, which: WhichRecord| {
        let known = unit.known(work.facts);
        let needed = needed(work.graph, &wanted, &known)?;
        let opened = open(work, unit, which, &needed).map_err(|fault| fault.says)?;
        let found = opened.evaluate(work.graph, &needed, &wanted, &known, work.plan.sections.percentiles, None)?;
        let of = |node: NodeId| {
            found
                .iter()
                .find_map(|(id, found)| if let (true, Found::Samples(samples)) = (*id == node, found) { Some(samples) } else { None })
        };
        let none = || "the signal has no samples".to_string();
        let samples = of(node).ok_or_else(none)?;
        let x: &[f64] = match over.node {
            Some(node) => &of(node).ok_or_else(none)?.values,
            None => &samples.along.axis,
        };
        Ok::<_, String>((thinned(samples, x, &quantity.signal_unit, &over.unit), opened.extent))
    };
    let name = |which| work.campaign(unit).record_name(which).map(|name| name.as_ref());
    let curve = |unit: &Section, side: Side| {
        let all = work.campaign(unit).records(side.kind());
        let which = all.into_iter().find(|&which| took_part(record, side == Side::Simulated, name(which)));
        curve_of(unit, which.ok_or_else(|| format!("there is no {} record of it", side.in_words()))?)
    };
    let of = |side: Side| -> Result<_, String> { if quantity.evaluation.reads(side) { curve(unit, side).map(Some) } else { Ok(None) } };
    let original = unit.original.and_then(|original| work.units.get(original)).filter(|_| quantity.evaluation.of_repeats());
    let (measured, simulated) = match original {
        // The original stands in the place of the measurement; distances count from the start of each section.
        Some(original) => {
            let (repeat, (mut first, extent)) = (curve(unit, Side::Measured)?, curve(original, Side::Measured)?);
            if over.node.is_none() {
                let shift = over.unit.from_si(repeat.1.0) - over.unit.from_si(extent.0);
                first.x.iter_mut().for_each(|x| *x += shift);
            }
            (Some((first, repeat.1)), Some(repeat))
        }
        None => (of(Side::Measured)?, of(Side::Simulated)?),
    };
    let mut others = Vec::new();
    if let Evaluation::Values { records: Records::Spread { of, .. }, .. } = quantity.evaluation.as_ref() {
        for which in work.campaign(unit).records(of.side.kind()).into_iter().filter(|&which| name(which) != record) {
            others.push((name(which).unwrap_or_default().to_string(), curve_of(unit, which)?.0));
        }
    }
    let extent = measured.as_ref().or(simulated.as_ref()).map_or((0.0, 0.0), |(_, extent)| *extent);
    let of_curve = |curve: Option<(Curve, _)>| curve.map(|(curve, _)| curve).unwrap_or_default();
    let (measured, simulated) = (of_curve(measured), of_curve(simulated));
    let (start, end) = match over.node {
        None => (over.unit.from_si(extent.0), over.unit.from_si(extent.1)),
        Some(_) => measured.x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x))),
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
        record: record.map(str::to_string),
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
