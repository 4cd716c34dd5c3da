//! Signals of the sections that matter most, thinned for plotting.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::record::{Found, Work, columns, open};
use super::sections::Unit;
use super::signal::Samples;
use crate::data::RecordKind;
use crate::result::{Curve, QuantityResult, Trace};

/// Points of a curve in a plot: each of so many stretches keeps its smallest and largest sample, so that no peak is lost.
const STRETCHES: usize = 700;

/// The pair with the largest difference of each quantity, measured by its limits; the worst first, each signal of a section once.
pub fn traces(work: &Work<'_>, units: &[Unit], quantities: &[QuantityResult], most: usize) -> Vec<Trace> {
    let mut picks: Vec<(f64, usize, usize, usize)> = Vec::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let limit = quantity.statistics.iter().filter_map(|statistic| statistic.limit).fold(f64::NAN, f64::max);
        let scale = if limit > 0.0 { limit } else { 1.0 };
        let worst = quantity.values.iter().max_by(|a, b| a.difference.abs().total_cmp(&b.difference.abs()));
        let Some(worst) = worst else { continue };
        let unit = units.iter().position(|unit| unit.name == worst.section);
        let signal = work.plan.quantities[index].signals.iter().position(|(name, _)| *name == worst.signal);
        if let (Some(unit), Some(signal)) = (unit, signal) {
            picks.push((worst.difference.abs() / scale, index, unit, signal));
        }
    }
    picks.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut shown = BTreeSet::new();
    picks.retain(|(_, index, unit, signal)| shown.insert((work.graph.quantities[*index].signals[*signal].filtered, *unit)));
    picks.truncate(most);
    picks.par_iter().filter_map(|(_, index, unit, signal)| trace(work, &units[*unit], *index, *signal)).collect()
}

fn trace(work: &Work<'_>, unit: &Unit, index: usize, signal: usize) -> Option<Trace> {
    let quantity = &work.plan.quantities[index];
    let node = work.graph.quantities[index].signals[signal].filtered;
    let wanted = BTreeSet::from([node]);
    let known = unit.known(work.facts);
    let curve = |kind: RecordKind| {
        let needed = columns(work.graph, &wanted, &known).ok()?;
        let opened = open(work, unit, kind, &needed).ok()?;
        let found = opened.evaluate(work.graph, &needed, &wanted, &known, work.plan.sections.percentiles).ok()?;
        match found.into_iter().next()? {
            (_, Found::Samples(samples)) => Some((thinned(&samples, work, index), opened.extent)),
            _ => None,
        }
    };
    let (measured, extent) = curve(RecordKind::Measurement)?;
    let (simulated, _) = curve(RecordKind::Simulation)?;
    let axis = &work.plan.axis;
    Some(Trace {
        quantity: quantity.id.clone(),
        section: unit.name.clone(),
        zone: unit.zone.clone(),
        signal: quantity.signals[signal].0.clone(),
        why: format!("largest difference of {}", quantity.id),
        unit: signal_unit(work, index).text,
        axis: axis.column.clone(),
        axis_unit: axis.unit.text.clone(),
        start: axis.unit.from_si(extent.0),
        end: axis.unit.from_si(extent.1),
        measured,
        simulated,
    })
}

/// The quantity's unit where the signal has its dimension (a metric's value may be a plain number), else SI.
fn signal_unit(work: &Work<'_>, index: usize) -> crate::units::Unit {
    let quantity = &work.plan.quantities[index];
    let dimension = quantity.signals.first().map_or(quantity.unit.dimension, |(_, signal)| signal.dimension);
    if dimension == quantity.unit.dimension {
        return quantity.unit.clone();
    }
    crate::units::Unit { text: dimension.to_string(), factor: 1.0, dimension }
}

fn thinned(samples: &Samples, work: &Work<'_>, index: usize) -> Curve {
    let unit = signal_unit(work, index);
    let axis = &work.plan.axis.unit;
    let mut curve = Curve::default();
    let mut keep = |at: usize| {
        curve.x.push(axis.from_si(samples.along.axis[at]));
        curve.y.push(unit.from_si(samples.values[at]));
    };
    let count = samples.values.len();
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
