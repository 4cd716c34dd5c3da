//! Shift of the measurement against the simulation along a run: estimated at every section that was
//! found, and in windows from its start to its end, of which only one is read at a time. The two
//! distances of a run drift apart: wheels wear, and a wheel sensor slips.

use std::collections::BTreeSet;

use super::Candidate;
use crate::data::{
    campaign::Run,
    record::{Record, Wanted},
};
use crate::metrics::drift::{Point, Signals, Tracker, Windows};
use crate::result::found::{CoursePoint, Drift, DriftPoint};
use crate::run::{
    campaign::evaluate,
    prelude::*,
    values::{Offset, Shifts},
};

/// Largest shift that is looked for, in lengths of the shortest section: 21 m for 70 m. Twice as
/// much and more is read beside a section.
pub const FARTHEST: f64 = 0.3;
/// A shift whose 95 % interval is wider than this to one side, in largest shifts, is not used: 1 m
/// of 21 m.
const UNCERTAIN: f64 = 0.05;

/// The shift at each place, where it can be estimated; nothing where the protocol does not evaluate
/// both sides.
pub fn shifts(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    places: &[(&Run, Candidate)],
) -> Vec<Option<Offset>> {
    let shortest =
        places.iter().map(|(_, place)| place.end - place.start).fold(f64::INFINITY, f64::min);
    let none = || vec![None; places.len()];
    let both = plan.reads(Side::Simulated) && plan.reads(Side::Measured);
    if !both || places.is_empty() {
        return none();
    }
    let farthest = FARTHEST * shortest;
    let asked = Shifts { offsets: &[0.0], farthest: Some(farthest), correct: false };
    // What is wrong with the campaign is told when it is evaluated.
    let Ok(evaluated) = evaluate(plan, graph, campaign, &asked, &|_| {}) else { return none() };
    let all: Vec<Option<Offset>> = evaluated
        .iter()
        .flat_map(|one| one.offsets().map(|(.., offset)| offset.cloned()))
        .collect();
    if all.len() != places.len() {
        return none();
    }
    let certain = |offset: &Offset| (offset.high - offset.low) / 2.0 <= UNCERTAIN * farthest;
    all.into_iter().map(|offset| offset.filter(certain)).collect()
}

/// The shift of each place of one run: its own, or between those beside it, of other places or of
/// the course of the drift. Nothing where none is known in the run.
pub fn along(starts: &[f64], shifts: &[Option<f64>], course: &[(f64, f64)]) -> Option<Vec<f64>> {
    let own = starts.iter().zip(shifts).filter_map(|(start, shift)| Some((*start, (*shift)?)));
    let mut known: Vec<(f64, f64)> = own.chain(course.iter().copied()).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (known.first()?, known.last()?);
    let at = |start: f64| {
        let after = known.iter().position(|(x, _)| *x >= start);
        match after {
            None => last.1,
            Some(0) => first.1,
            Some(after) => {
                let ((x0, y0), (x1, y1)) = (known[after - 1], known[after]);
                y0 + (y1 - y0) * (start - x0) / (x1 - x0)
            }
        }
    };
    Some(
        starts
            .iter()
            .zip(shifts)
            .map(|(start, shift)| shift.unwrap_or_else(|| at(*start)))
            .collect(),
    )
}

/// What is told of a run: all arguments are of this run.
pub fn told(
    plan: &Plan,
    run: &Run,
    (names, starts): (&[&str], &[f64]),
    shifts: &[Option<Offset>],
    course: &Course,
) -> Option<Drift> {
    let shown = |x: f64| plan.axis.unit.from_si(x);
    let point = |((name, start), shift): ((&&str, &f64), &Option<Offset>)| {
        let shift = shift.as_ref()?;
        Some(DriftPoint {
            section: (*name).to_string(),
            start: shown(*start),
            shift: shown(shift.shift),
            low: shown(shift.low),
            high: shown(shift.high),
            correlation: shift.correlation,
        })
    };
    let points: Vec<DriftPoint> = names.iter().zip(starts).zip(shifts).filter_map(point).collect();
    let drift = Drift {
        points,
        along: course.told(plan),
        windows: course.looked,
        corrected: run.correct_drift,
    };
    (!drift.points.is_empty() || !drift.along.is_empty()).then_some(drift)
}

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
    places: &[&Candidate],
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

#[cfg(test)]
mod tests {
    use super::along;

    /// Between 1 at 0 and 3 at 100 the shift at 25 is 1.5; beyond the ends it is that of the end.
    #[test]
    fn a_place_without_a_shift_has_that_between_its_neighbours() {
        let starts = [-10.0, 0.0, 25.0, 100.0, 200.0];
        assert_eq!(
            along(&starts, &[None, Some(1.0), None, Some(3.0), None], &[]),
            Some(vec![1.0, 1.0, 1.5, 3.0, 3.0])
        );
        assert_eq!(along(&starts, &[None; 5], &[]), None);
        // A window of the course at 20 m is nearer.
        assert_eq!(
            along(&starts, &[None, Some(1.0), None, Some(3.0), None], &[(20.0, 5.0), (30.0, 6.0)])
                .map(|all| all[2]),
            Some(5.5)
        );
    }
}
