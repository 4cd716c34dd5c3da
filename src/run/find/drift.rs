//! Shift of the measurement against the simulation along a run, estimated at every section that was
//! found. The two distances of a run drift apart: wheels wear, and a wheel sensor slips.

use super::Place;
use super::course::Course;
use crate::check::plan::{Plan, Side};
use crate::data::Campaign;
use crate::data::campaign::Run;
use crate::graph::Graph;
use crate::result::found::{Drift, DriftPoint};
use crate::run::campaign::evaluate;
use crate::run::values::{Offset, Shifts};

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
    places: &[(&Run, Place)],
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
