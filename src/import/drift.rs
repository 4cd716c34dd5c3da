//! Drift of the distance of a run's measurement against its simulation: estimated in windows along the whole run, and corrected.

use super::mapping::Drift;
use super::process::{Column, Made, short};
use crate::data::RecordKind;
use crate::metrics::drift::{Curve, Point, Signals, Tracker, Windows, within};
use crate::metrics::statistics::{Divisor, regression, standard_deviation};
use crate::problem::Problem;
use crate::units::Dimension;

/// Most points of the curve that are listed one by one.
const MOST_LISTED: usize = 12;

/// Estimates the drift, corrects it where this is asked for, and tells it with its numbers.
///
/// # Errors
/// `no-drift`: no window in which the records agree; `axis-not-increasing`: the corrected distance would go back.
pub fn drift(asked: &Drift, measured: &mut Made, simulated: &Made) -> Result<(), Problem> {
    let name = measured.section.clone();
    let fault = |code: &'static str, says: String| Problem::error(code, format!("run `{name}`: {says}")).at(&asked.span);
    let axis = |made: &Made| made.columns.iter().position(|column| column.name == "distance");
    let (Some(own), Some(other)) = (axis(measured), axis(simulated)) else {
        let side = if axis(measured).is_none() { RecordKind::Measurement } else { RecordKind::Simulation };
        return Err(fault("no-drift", format!("its {} has no distance", side.key())).help("state it: `distance`"));
    };
    let names = common(measured, simulated);
    if names.is_empty() {
        let help = "the channels of both sides are compared that have the same name";
        return Err(fault("no-drift", "measurement and simulation have no channel in common".into()).help(help));
    }
    let of = |made: &Made| -> Vec<Vec<f64>> {
        let column = |name: &String| made.columns.iter().find(|column| column.name == *name).map(|column| column.values.clone());
        names.iter().filter_map(column).collect()
    };
    let windows = Windows::of(asked.window, asked.within);
    let (m, s) = (&measured.columns[own].values, &simulated.columns[other].values);
    let (points, looked) = tracked(windows, (m, &of(measured)), (s, &of(simulated)));
    let Some(curve) = Curve::new(&points) else {
        let says = match points.len() {
            0 => format!("in none of {looked} windows of {} m do measurement and simulation agree", short(asked.window)),
            _ => "the shifts along the run would let the distance go back".to_string(),
        };
        let help = format!("check signs and channels; a shift of more than {} m needs a larger `within`", short(asked.within));
        return Err(fault("no-drift", says).help(help));
    };
    measured.steps.push(told(&points, looked, asked, names.len()));
    measured.steps.extend(clock(measured, simulated, &points, (own, other)));
    if !asked.correct {
        return Ok(());
    }
    let values = &mut measured.columns[own].values;
    values.iter_mut().for_each(|at| *at += curve.at(*at));
    // Beyond the last point the curve goes on as before, which a distance can be too steep for.
    if let Some(row) = (1..values.len()).find(|&row| values[row] <= values[row - 1]) {
        let says = format!("the corrected distance does not increase at {} m", short(values[row]));
        return Err(fault("axis-not-increasing", says).help("leave the drift as it is: `drift: tell`"));
    }
    let (first, last) = (values[0], values[values.len() - 1]);
    measured.steps.push(format!(
        "distance of the {} corrected along the run, linear between these points: now {} m to {} m",
        measured.kind.key(),
        short(first),
        short(last)
    ));
    Ok(())
}

/// Channels of both sides, with the same name and dimension, that are no axis.
fn common(measured: &Made, simulated: &Made) -> Vec<String> {
    let axis = |column: &Column| [Dimension::TIME, Dimension::LENGTH].contains(&column.unit.dimension);
    let same = |column: &Column, other: &Column| column.name == other.name && column.unit.dimension == other.unit.dimension;
    let both = measured.columns.iter().filter(|column| !axis(column) && simulated.columns.iter().any(|other| same(column, other)));
    both.map(|column| column.name.clone()).collect()
}

type Record<'a> = (&'a [f64], &'a [Vec<f64>]);

/// The shifts along the run, and the number of windows that were looked at.
fn tracked(windows: Windows, measured: Record<'_>, simulated: Record<'_>) -> (Vec<Point>, usize) {
    let mut tracker = Tracker::new(windows);
    let ends = |axis: &[f64]| axis.first().copied().zip(axis.last().copied()).unwrap_or((0.0, 0.0));
    let ((m0, m1), (s0, s1)) = (ends(measured.0), ends(simulated.0));
    let mut start = s0.max(m0 + 1.0);
    loop {
        let end = start + windows.length;
        if end > s1 || end > m1 + tracker.expected() {
            break;
        }
        let part = |(axis, values): Record<'_>, range: (f64, f64)| -> (Vec<f64>, Vec<Vec<f64>>) {
            let rows = within(axis, range);
            (axis[rows.clone()].to_vec(), values.iter().map(|values| values[rows.clone()].to_vec()).collect())
        };
        let (s, sv) = part(simulated, (start, end));
        let (m, mv) = part(measured, tracker.reach(start));
        tracker.look(start, Signals { axis: &s, values: &sv }, Signals { axis: &m, values: &mv });
        start += windows.every;
    }
    let looked = tracker.looked();
    (tracker.finish(), looked)
}

fn told(points: &[Point], looked: usize, asked: &Drift, channels: usize) -> String {
    let shift = |point: &Point| point.estimate.shift;
    let least = points.iter().map(shift).fold(f64::INFINITY, f64::min);
    let most = points.iter().map(shift).fold(f64::NEG_INFINITY, f64::max);
    let widest = points.iter().map(|point| (point.estimate.high - point.estimate.low) / 2.0).fold(0.0, f64::max);
    // A few points along the run show its course; the outer ones are always among them.
    let count = points.len().min(MOST_LISTED);
    let index = |k: usize| if count < 2 { 0 } else { k * (points.len() - 1) / (count - 1) };
    let listed: Vec<String> =
        (0..count).map(|k| &points[index(k)]).map(|point| format!("{:+.2} m at {:.0} m", shift(point), point.at)).collect();
    format!(
        "drift of the distance by correlation of {channels} channels with the simulation, in {} of {looked} windows of {} m: \
         {least:+.2} m to {most:+.2} m would align it (95 % intervals up to ±{widest:.2} m); {}",
        points.len(),
        short(asked.window),
        listed.join(", ")
    )
}

/// How much faster the clock of the measurement runs than that of the simulation over the same distance. It says something about the
/// clock if the simulation was run with the recorded speed.
fn clock(measured: &Made, simulated: &Made, points: &[Point], (own, other): (usize, usize)) -> Option<String> {
    let time = |made: &Made, axis: usize, at: f64| -> Option<f64> {
        let times = &made.columns.iter().find(|column| column.name == "time")?.values;
        let axis = &made.columns[axis].values;
        let after = axis.partition_point(|x| *x < at).clamp(1, axis.len() - 1);
        let share = (at - axis[after - 1]) / (axis[after] - axis[after - 1]);
        Some(times[after - 1] + share * (times[after] - times[after - 1]))
    };
    let mut pairs = Vec::new();
    for point in points {
        pairs.push((time(simulated, other, point.at)?, time(measured, own, point.at - point.estimate.shift)?));
    }
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let line = regression(&x, &y)?;
    let parts = 1e6;
    let left: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y - line.intercept - line.slope * x).collect();
    let error = standard_deviation(&left, Divisor::Sample)? / (standard_deviation(&x, Divisor::Sample)? * (x.len() as f64 - 1.0).sqrt());
    Some(format!(
        "time against that of the simulation at the same places: {:+.0} ppm (standard error {:.0} ppm); nothing was corrected",
        (line.slope - 1.0) * parts,
        error * parts
    ))
}
