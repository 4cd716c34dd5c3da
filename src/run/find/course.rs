//! Course of the drift along a whole run: the shift in windows from its start to its end, of which
//! only one is read at a time.

use std::collections::BTreeSet;

use super::Place;
use crate::check::plan::{Plan, Side};
use crate::data::campaign::Run;
use crate::data::record::{Record, Wanted};
use crate::data::{Campaign, RecordKind};
use crate::graph::{Graph, NodeId, Operation};
use crate::metrics::drift::{Point, Signals, Tracker, Windows};
use crate::result::found::CoursePoint;

/// From the start of a window to that of the next, in windows: one kilometre for windows of 250 m.
/// A distance drifts slowly; more windows take longer to read and change the course by less than
/// its interval.
const EVERY: f64 = 4.0;
/// Steps of the search up to its largest shift, as at a section.
const STEPS: f64 = 100.0;
/// Most windows of a run; more lie further apart. Windows of 70 m reach 280 km so.
const MOST: f64 = 1000.0;
/// Shortest window in largest shifts: it must be longer than what it is moved by.
const SHORTEST: f64 = 2.0;

/// The course, and how many windows were looked at.
#[derive(Clone, Debug, Default)]
pub struct Course {
    pub points: Vec<Point>,
    pub looked: usize,
}

impl Course {
    /// As results tell it.
    pub fn told(&self, plan: &Plan) -> Vec<CoursePoint> {
        let shown = |x: f64| plan.axis.unit.from_si(x);
        let of = |Point { at, estimate }: &Point| CoursePoint {
            at: shown(*at),
            shift: shown(estimate.shift),
            low: shown(estimate.low),
            high: shown(estimate.high),
            correlation: estimate.correlation,
        };
        self.points.iter().map(of).collect()
    }

    /// Places on the axis of the measurement, with the shift there.
    pub fn knots(&self) -> Vec<(f64, f64)> {
        self.points
            .iter()
            .map(|point| (point.at - point.estimate.shift, point.estimate.shift))
            .collect()
    }
}

/// The course from one end of what both records cover to the other. `farthest` is the largest shift
/// from one window to the next, the longest section gives the length of a window. Nothing where the
/// protocol does not evaluate both sides.
pub fn course(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    run: &Run,
    places: &[&Place],
    (start, end): (f64, f64),
    farthest: f64,
) -> Course {
    let longest = places.iter().map(|place| place.end - place.start).fold(0.0, f64::max);
    if !(plan.reads(Side::Simulated) && plan.reads(Side::Measured))
        || longest <= 0.0
        || !farthest.is_finite()
    {
        return Course::default();
    }
    let length = longest.max(SHORTEST * farthest);
    let mut tracker = Tracker::new(Windows {
        length,
        every: (EVERY * length).max((end - start) / MOST),
        farthest,
        step: farthest / STEPS,
    });
    let wanted = wanted(plan, graph);
    let read = |kind: RecordKind, (from, to): (f64, f64)| -> Option<Record> {
        let source = campaign.run_source(run, kind).ok()?;
        source.stretch(&wanted, &plan.axis.column, from..to, run.known(kind)).ok()
    };
    let mut at = start;
    while at + length <= end {
        let (simulated, measured) = rayon::join(
            || read(RecordKind::Simulation, (at - farthest, at + length + farthest)),
            || read(RecordKind::Measurement, tracker.reach(at)),
        );
        // What is wrong with a record is told when its sections are evaluated.
        if let (Some(simulated), Some(measured)) = (simulated, measured) {
            let both = both(&simulated, &measured);
            let [s, m] =
                [0, 1].map(|side| both.iter().map(|pair| pair[side].clone()).collect::<Vec<_>>());
            let axes = [&simulated, &measured].map(|record| record.columns[0].values.as_slice());
            tracker.look(
                at,
                Signals { axis: axes[0], values: &s },
                Signals { axis: axes[1], values: &m },
            );
        }
        at += tracker.windows.every;
    }
    let looked = tracker.looked();
    Course { points: tracker.finish(), looked }
}

/// The axis, and the channels that quantities are made of, where a record has them.
fn wanted(plan: &Plan, graph: &Graph) -> Vec<Wanted> {
    let mut open: Vec<NodeId> = graph
        .quantities
        .iter()
        .flat_map(|quantity| &quantity.signals)
        .map(|signal| signal.filtered)
        .collect();
    let mut seen = BTreeSet::new();
    let mut wanted = vec![Wanted::new(plan.axis.column.as_str(), plan.axis.unit.dimension)];
    let time = plan.time.as_ref().map(|time| time.column.as_str());
    while let Some(id) = open.pop() {
        if seen.insert(id) {
            open.extend(&graph.nodes[id].inputs);
        }
    }
    for node in seen.into_iter().map(|id| &graph.nodes[id]).filter(|node| !node.track) {
        if let Operation::Read { column } = &node.operation
            && time != Some(column.as_str())
            && wanted.iter().all(|known| known.name != *column)
        {
            wanted.push(Wanted::new(column.as_str(), node.dimension).if_there());
        }
    }
    wanted
}

/// The values of the channels of both records.
fn both(simulated: &Record, measured: &Record) -> Vec<[Vec<f64>; 2]> {
    let channels = simulated.columns.iter().skip(1);
    channels
        .filter_map(|channel| {
            Some([channel.values.clone(), measured.column(&channel.name)?.values.clone()])
        })
        .collect()
}
