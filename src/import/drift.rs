//! Drift of the distance and of the clock of a run's measurement against its simulation: estimated
//! in windows along the whole run, and corrected.

use std::borrow::Cow;

use super::mapping::Drift;
use super::process::{Column, Made, Values, short};
use crate::metrics::drift::{Curve, Point, Signals, Tracker, Windows, within};
use crate::metrics::statistics::{Divisor, regression, standard_deviation};
use crate::problem::{Problem, error};
use crate::units::Dimension;

/// Most points of the curve that are listed one by one.
const MOST_LISTED: usize = 12;
/// Parts of a million.
const PARTS: f64 = 1e6;
/// Windows that must agree for the drift of the clock to be corrected: with fewer, its standard
/// error is itself not certain.
const FEWEST_TIMES: usize = 8;
/// Largest standard error of a drift of the clock that is corrected, 10 ppm: clocks of recorders
/// are off by some tens of ppm.
const UNCERTAIN_CLOCK: f64 = 10e-6;
/// Largest drift of the clock that is corrected, 500 ppm. A quartz is never off by more; the
/// simulation then had another speed.
const MOST_CLOCK: f64 = 500e-6;

/// Estimates the drift, corrects it where this is asked for, and tells it with its numbers.
///
/// # Errors
/// `no-drift`: no window in which the records agree, or no certain drift of the clock;
/// `axis-not-increasing`: the corrected distance would go back.
pub fn drift(asked: &Drift, measured: &mut Made, simulated: &Made) -> Result<(), Problem> {
    let run = format!("run `{}`", measured.section);
    let fault = |code: &'static str, says: &str| error(code, format!("{run}: {says}"), &asked.span);
    let axis = |made: &Made| {
        made.columns.iter().position(|column| column.name == "distance").ok_or_else(|| {
            fault("no-drift", &format!("its {} has no distance", made.kind.key()))
                .help("state it: `distance`")
        })
    };
    let (own, other) = (axis(measured)?, axis(simulated)?);
    let names = common(measured, simulated);
    if names.is_empty() {
        return Err(fault("no-drift", "measurement and simulation have no channel in common")
            .help("the channels of both sides are compared that have the same name"));
    }
    let windows = Windows::of(asked.window, asked.within);
    let both = (Record::new(measured, own, &names)?, Record::new(simulated, other, &names)?);
    let (points, looked) = tracked(windows, &both.0, &both.1)?;
    let Some(curve) = Curve::new(&points) else {
        let says = match points.len() {
            0 => format!(
                "in none of {looked} windows of {} m do measurement and simulation agree",
                short(asked.window)
            ),
            _ => "the shifts along the run would let the distance go back".to_string(),
        };
        return Err(fault("no-drift", &says).help(format!(
            "check signs and channels; a shift of more than {} m needs a larger `within`",
            short(asked.within)
        )));
    };
    drop(both);
    measured.steps.push(told(&points, looked, asked, names.len()));
    let clock = clock(measured, simulated, &points, (own, other))?;
    correct_clock(asked, measured, clock, points.len())?;
    if !asked.correct {
        return Ok(());
    }
    let mut values = measured.columns[own].values.all()?.into_owned();
    values.iter_mut().for_each(|at| *at += curve.at(*at));
    // Beyond the last point the curve goes on as before, which a distance can be too steep for.
    if let Some(row) = (1..values.len()).find(|&row| values[row] <= values[row - 1]) {
        let says = format!("the corrected distance does not increase at {} m", short(values[row]));
        return Err(
            fault("axis-not-increasing", &says).help("leave the drift as it is: `drift: tell`")
        );
    }
    measured.steps.push(format!(
        "distance of the {} corrected along the run, linear between these points: now {} m to {} m",
        measured.kind.key(),
        short(values[0]),
        short(values[values.len() - 1])
    ));
    measured.columns[own].values = Values::Held(values);
    Ok(())
}

/// Channels of both sides, with the same name and dimension, that are no axis.
fn common(measured: &Made, simulated: &Made) -> Vec<String> {
    let is_axis =
        |column: &Column| [Dimension::TIME, Dimension::LENGTH].contains(&column.unit.dimension);
    let is_in_both = |column: &&Column| {
        simulated
            .columns
            .iter()
            .any(|other| column.name == other.name && column.unit.dimension == other.unit.dimension)
    };
    let both = measured.columns.iter().filter(|column| !is_axis(column)).filter(is_in_both);
    both.map(|column| column.name.clone()).collect()
}

/// The values of a column.
fn column<'a>(made: &'a Made, name: &str) -> Option<&'a Values> {
    made.columns.iter().find(|column| column.name == name).map(|column| &column.values)
}

/// The axis of a record, and the channels that are compared.
struct Record<'a> {
    axis: Cow<'a, [f64]>,
    channels: Vec<&'a Values>,
}

impl<'a> Record<'a> {
    fn new(made: &'a Made, axis: usize, names: &[String]) -> Result<Self, Problem> {
        let channels = names.iter().filter_map(|name| column(made, name)).collect();
        Ok(Self { axis: made.columns[axis].values.all()?, channels })
    }

    fn ends(&self) -> (f64, f64) {
        self.axis.first().copied().zip(self.axis.last().copied()).unwrap_or((0.0, 0.0))
    }

    /// What lies in a range of the axis.
    fn part(&self, range: (f64, f64)) -> Result<(Vec<f64>, Vec<Vec<f64>>), Problem> {
        let rows = within(&self.axis, range);
        let channels = self
            .channels
            .iter()
            .map(|values| Ok(values.part(rows.clone())?.into_owned()))
            .collect::<Result<_, _>>()?;
        Ok((self.axis[rows].to_vec(), channels))
    }
}

/// The shifts along the run, and the number of windows that were looked at.
fn tracked(
    windows: Windows,
    measured: &Record<'_>,
    simulated: &Record<'_>,
) -> Result<(Vec<Point>, usize), Problem> {
    let mut tracker = Tracker::new(windows);
    let ((m0, m1), (s0, s1)) = (measured.ends(), simulated.ends());
    let mut start = s0.max(m0 + 1.0);
    loop {
        let end = start + windows.length;
        if end > s1 || end > m1 + tracker.expected() {
            break;
        }
        let (s, sv) = simulated.part((start, end))?;
        let (m, mv) = measured.part(tracker.reach(start))?;
        tracker.look(start, Signals { axis: &s, values: &sv }, Signals { axis: &m, values: &mv });
        start += windows.every;
    }
    let looked = tracker.looked();
    Ok((tracker.finish(), looked))
}

fn told(points: &[Point], looked: usize, asked: &Drift, channels: usize) -> String {
    let shifts = || points.iter().map(|point| point.estimate.shift);
    let (least, most) =
        (shifts().fold(f64::INFINITY, f64::min), shifts().fold(f64::NEG_INFINITY, f64::max));
    let half_widths = points.iter().map(|point| (point.estimate.high - point.estimate.low) / 2.0);
    let widest = half_widths.fold(0.0, f64::max);
    // A few points along the run show its course; the outer ones are always among them.
    let count = points.len().min(MOST_LISTED);
    let index = |k: usize| if count < 2 { 0 } else { k * (points.len() - 1) / (count - 1) };
    let listed: Vec<String> = (0..count)
        .map(|k| &points[index(k)])
        .map(|point| format!("{:+.2} m at {:.0} m", point.estimate.shift, point.at))
        .collect();
    format!(
        "drift of the distance by correlation of {channels} channels with the simulation, in {} of {looked} windows of {} m: \
         {least:+.2} m to {most:+.2} m would align it (95 % intervals up to ±{widest:.2} m); {}",
        points.len(),
        short(asked.window),
        listed.join(", ")
    )
}

/// How the clock of the measurement runs against that of the simulation.
struct Clock {
    /// By how much the measured time is too long, as a share of it.
    drift: f64,
    /// Standard error of the drift.
    error: f64,
}

/// Compares the times at the same places. It says something about the clock if the simulation was
/// run with the recorded speed.
fn clock(
    measured: &Made,
    simulated: &Made,
    points: &[Point],
    (own, other): (usize, usize),
) -> Result<Option<Clock>, Problem> {
    let times = |made: &Made, axis: usize, places: Vec<f64>| -> Result<Vec<f64>, Problem> {
        let Some(times) = column(made, "time") else { return Ok(Vec::new()) };
        let (times, axis) = (times.all()?, made.columns[axis].values.all()?);
        let at = |place: f64| {
            let after = axis.partition_point(|x| *x < place).clamp(1, axis.len() - 1);
            let share = (place - axis[after - 1]) / (axis[after] - axis[after - 1]);
            times[after - 1] + share * (times[after] - times[after - 1])
        };
        Ok(places.into_iter().map(at).collect())
    };
    let x = times(simulated, other, points.iter().map(|point| point.at).collect())?;
    let moved = points.iter().map(|point| point.at - point.estimate.shift).collect();
    let y = times(measured, own, moved)?;
    Ok(regression(&x, &y).and_then(|line| {
        let left: Vec<f64> =
            x.iter().zip(&y).map(|(x, y)| y - line.intercept - line.slope * x).collect();
        let spread = standard_deviation(&x, Divisor::Sample)? * (x.len() as f64 - 1.0).sqrt();
        let error = standard_deviation(&left, Divisor::Sample)? / spread;
        Some(Clock { drift: line.slope - 1.0, error })
    }))
}

/// Tells the drift of the clock, and corrects the time of the measurement where this is asked for.
///
/// # Errors
/// `no-drift`: a drift that is to be corrected is not certain.
fn correct_clock(
    asked: &Drift,
    measured: &mut Made,
    clock: Option<Clock>,
    windows: usize,
) -> Result<(), Problem> {
    let is_certain =
        |clock: &Clock| clock.error <= UNCERTAIN_CLOCK && clock.drift.abs() <= MOST_CLOCK;
    if asked.correct_clock && !(windows >= FEWEST_TIMES && clock.as_ref().is_some_and(is_certain)) {
        let why = match &clock {
            Some(clock) if windows >= FEWEST_TIMES => format!(
                "the times differ by {:+.0} ppm with a standard error of {:.0} ppm; at most {:.0} ppm with {:.0} ppm can be the clock",
                clock.drift * PARTS,
                clock.error * PARTS,
                MOST_CLOCK * PARTS,
                UNCERTAIN_CLOCK * PARTS
            ),
            _ => format!("{windows} windows agree; at least {FEWEST_TIMES} are needed"),
        };
        let section = &measured.section;
        let says = format!("run `{section}`: the drift of the clock cannot be estimated: {why}");
        let help = "the simulation must be run with the recorded speed; a drift that is known is stated: `time: {drift: 50 ppm}`";
        return Err(error("no-drift", says, &asked.span).help(help));
    }
    let Some(Clock { drift, error }) = clock else { return Ok(()) };
    let done = if asked.correct_clock {
        for column in measured.columns.iter_mut().filter(|column| column.name == "time") {
            let times = column.values.all()?.iter().map(|time| time / (1.0 + drift)).collect();
            column.values = Values::Held(times);
        }
        format!("time divided by 1 + {drift:.8}")
    } else {
        "nothing was corrected".to_string()
    };
    measured.steps.push(format!(
        "time against that of the simulation at the same places: {:+.0} ppm (standard error {:.0} ppm); {done}",
        drift * PARTS,
        error * PARTS
    ));
    Ok(())
}
