//! Pairs of a simulated and a measured record, on even time steps.

use std::path::Path;

use crate::data::{
    checks::median,
    record::{Column, Wanted, read_headings, read_record},
};
use crate::metrics::resample::interpolate;
use crate::problem::{Problem, Problems, problem};
use crate::units::{Dimension, Unit, number::significant};

pub const TIME: &str = "time";
pub const DISTANCE: &str = "distance";
/// Deviation of a time step from the median step, as a share, from which a record is resampled.
/// `certify` refuses records beyond it.
const JITTER: f64 = 0.01;
/// Time stamps may be rounded to this, in s.
const ROUNDING: f64 = 1e-6;
/// Difference of the steps of two records, as a share, from which the simulation is resampled.
const SAME_STEP: f64 = 1e-3;
/// Fewest samples of a record.
const FEWEST: usize = 64;
/// Relative rms difference below which the simulation repeats a measured column: it is an input,
/// not a result.
const REPEATED: f64 = 1e-3;

/// A column in its own unit.
#[derive(Clone, Debug)]
pub struct Channel {
    pub name: String,
    pub unit: Unit,
    pub values: Vec<f64>,
}

/// One record.
#[derive(Clone, Debug)]
pub struct Series {
    pub shown: String,
    /// In s, in even steps.
    pub time: Vec<f64>,
    /// In m.
    pub distance: Option<Vec<f64>>,
    pub channels: Vec<Channel>,
}

/// The records of one run.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: String,
    pub simulated: Series,
    pub measured: Series,
}

/// What columns are for.
#[derive(Clone, Debug, Default)]
pub struct Roles {
    /// Columns of both records, which are compared.
    pub outputs: Vec<String>,
    /// Columns that only the measurement has, or that the simulation repeats.
    pub inputs: Vec<String>,
}

impl Series {
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    pub fn step(&self) -> f64 {
        let steps = self.time.len().saturating_sub(1).max(1) as f64;
        self.time.last().zip(self.time.first()).map_or(1.0, |(last, first)| (last - first) / steps)
    }

    /// The axis of sections: the distance where `over_distance`, otherwise the time.
    pub fn axis(&self, over_distance: bool) -> &[f64] {
        self.distance.as_deref().filter(|_| over_distance).unwrap_or(&self.time)
    }

    /// The same with other times, by linear interpolation.
    fn at(&self, time: Vec<f64>) -> Self {
        // Interpolated values have no more digits than a measurement can have.
        let of = |values: &[f64]| {
            let values = interpolate(&self.time, values, &time).unwrap_or_default();
            values.into_iter().map(|value| significant(value, 9)).collect()
        };
        let channel =
            |channel: &Channel| Channel { values: of(&channel.values), ..channel.clone() };
        Self {
            shown: self.shown.clone(),
            distance: self.distance.as_deref().map(of),
            channels: self.channels.iter().map(channel).collect(),
            time,
        }
    }

    /// The same with steps of `step` from its first time on.
    fn every(&self, step: f64) -> Self {
        let (first, last) = (self.time[0], self.time[self.time.len() - 1]);
        let count = ((last - first) / step * (1.0 + 1e-12)).floor() as usize;
        self.at((0..=count).map(|n| (first + n as f64 * step).min(last)).collect())
    }
}

impl Pair {
    /// Reads both records; `told` takes what was changed.
    ///
    /// Problems: of reading; `no-time`, `time-not-increasing`, `too-short`.
    pub fn read(
        name: String,
        simulated: &Path,
        measured: &Path,
        told: &mut Vec<String>,
        problems: &mut Problems,
    ) -> Option<Self> {
        let mut one = |path: &Path| problems.value(series(path, told));
        let (simulated, measured) = (one(simulated), one(measured));
        let (mut simulated, measured) = (simulated?, measured?);
        let (step, wanted) = (simulated.step(), measured.step());
        if (step / wanted - 1.0).abs() > SAME_STEP {
            told.push(format!(
                "{}: resampled from {:.4} to {:.4} Hz, the rate of the measurement",
                simulated.shown,
                1.0 / step,
                1.0 / wanted
            ));
            simulated = simulated.every(wanted);
        }
        Some(Self { name, simulated, measured })
    }

    /// Whether both records have a distance.
    pub fn over_distance(&self) -> bool {
        self.simulated.distance.is_some() && self.measured.distance.is_some()
    }

    /// The range of the axis that both records have.
    pub fn common(&self, over_distance: bool) -> (f64, f64) {
        let ends = |series: &Series| {
            let axis = series.axis(over_distance);
            (axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0))
        };
        let ((a, b), (c, d)) = (ends(&self.simulated), ends(&self.measured));
        (a.max(c), b.min(d))
    }

    /// Relative rms difference of a column of both records.
    fn differs(&self, name: &str, over_distance: bool) -> Option<f64> {
        let (simulated, measured) = (self.simulated.channel(name)?, self.measured.channel(name)?);
        let (from, to) = self.common(over_distance);
        let axis = self.measured.axis(over_distance);
        let inside: Vec<usize> =
            (0..axis.len()).filter(|at| (from..=to).contains(&axis[*at])).collect();
        let points: Vec<f64> = inside.iter().map(|at| axis[*at]).collect();
        let there =
            interpolate(self.simulated.axis(over_distance), &simulated.values, &points).ok()?;
        let measured: Vec<f64> =
            inside.iter().map(|at| measured.unit.to_si(measured.values[*at])).collect();
        let mean = measured.iter().sum::<f64>() / measured.len().max(1) as f64;
        let (mut off, mut all) = (0.0, 0.0);
        for (simulated_value, value) in there.iter().zip(&measured) {
            off += (simulated.unit.to_si(*simulated_value) - value).powi(2);
            all += (value - mean).powi(2);
        }
        Some((off / all.max(f64::MIN_POSITIVE)).sqrt())
    }
}

/// Which columns are compared and which are inputs: those of the first pair, which all pairs must
/// have.
///
/// # Errors
/// `no-common-channel`, `unit-mismatch`, `unknown-channel`.
pub fn roles(pairs: &[Pair]) -> Result<Roles, Problem> {
    let first = &pairs[0];
    let over_distance = pairs.iter().all(Pair::over_distance);
    let names = |series: &Series| -> Vec<String> {
        series.channels.iter().map(|channel| channel.name.clone()).collect()
    };
    let mut common = names(&first.measured);
    common.retain(|name| first.simulated.channel(name).is_some());
    for name in &common {
        let Some(wanted) = first.measured.channel(name) else { continue };
        for series in pairs.iter().flat_map(|pair| [&pair.simulated, &pair.measured]) {
            let shown = &series.shown;
            let Some(channel) = series.channel(name) else {
                let known = series.channels.iter().map(|channel| &channel.name);
                return Err(problem!(
                    "unknown-channel",
                    "`{shown}` has no column `{name}`, which the first pair has"
                )
                .suggest(name, known));
            };
            if channel.unit.dimension != wanted.unit.dimension {
                return Err(problem!(
                    "unit-mismatch",
                    "the column `{name}` is in {} in `{shown}`, and in {} in `{}`",
                    channel.unit,
                    wanted.unit,
                    first.measured.shown
                ));
            }
        }
    }
    let repeated = |name: &String| {
        let differs = |pair: &Pair| pair.differs(name, over_distance);
        pairs.iter().all(|pair| differs(pair).is_some_and(|share| share < REPEATED))
    };
    let (mut inputs, mut outputs): (Vec<String>, Vec<String>) =
        common.iter().cloned().partition(repeated);
    // Records that agree in everything are compared in everything.
    if outputs.is_empty() {
        outputs = std::mem::take(&mut inputs);
    }
    if outputs.is_empty() {
        let (a, b) = (names(&first.simulated).join(", "), names(&first.measured).join(", "));
        let says =
            "the simulated and the measured record have no column in common that could be compared";
        return Err(Problem::error("no-common-channel", says).help(format!(
            "the simulation has {a}; the measurement has {b}: give what is compared the same name"
        )));
    }
    let everywhere = |name: &String| pairs.iter().all(|pair| pair.measured.channel(name).is_some());
    let measured = names(&first.measured).into_iter();
    inputs.extend(measured.filter(|name| !common.contains(name) && everywhere(name)));
    Ok(Roles { outputs, inputs })
}

fn series(path: &Path, told: &mut Vec<String>) -> Result<Series, Vec<Problem>> {
    let shown = path.display().to_string();
    let headings = read_headings(path, &shown)?;
    let faults: Vec<Problem> =
        headings.iter().filter_map(|heading| heading.unit(None).err()).collect();
    if !faults.is_empty() {
        return Err(faults);
    }
    let record = read_record(path, &shown, &Wanted::all(&headings))?;
    let axis = |name: &str, dimension: Dimension| {
        record.column(name).filter(|column| column.unit.dimension == dimension)
    };
    let Some(time) = axis(TIME, Dimension::TIME) else {
        let at = headings.first().map(|first| first.span.clone());
        let problem = Problem {
            at,
            ..Problem::error(
                "no-time",
                format!("`{shown}` has no column `{TIME}` with a unit of time"),
            )
        };
        return Err(problem.help("call the column with the time so: `time [s]`").into());
    };
    if record.rows < FEWEST {
        return Err(problem!(
            "too-short",
            "`{shown}` has {} samples; at least {FEWEST} are needed",
            record.rows
        )
        .into());
    }
    let increases = |column: &Column| column.values.windows(2).all(|pair| pair[1] > pair[0]);
    let distance = axis(DISTANCE, Dimension::LENGTH).filter(|column| increases(column));
    if let Some(row) = time.values.windows(2).position(|pair| pair[1] <= pair[0]) {
        let at = record.place(row + 1, Some(time));
        let problem = Problem {
            at,
            ..Problem::error(
                "time-not-increasing",
                format!("`{shown}`: the time does not increase"),
            )
        };
        return Err(problem.help("delete the row, or export the record again").into());
    }
    let own = |name: &str| name == TIME || name == DISTANCE;
    let channels =
        record.columns.iter().filter(|column| !own(&column.name)).map(|column| Channel {
            name: column.name.clone(),
            unit: column.unit.clone(),
            values: column.values.iter().map(|value| column.unit.from_si(*value)).collect(),
        });
    let found = Series {
        shown,
        time: time.values.clone(),
        distance: distance.map(|column| column.values.clone()),
        channels: channels.collect(),
    };
    let steps: Vec<f64> = found.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let median = median(&steps);
    if steps.iter().all(|step| (step - median).abs() <= JITTER * median + 2.0 * ROUNDING) {
        return Ok(found);
    }
    told.push(format!(
        "{}: uneven time steps, resampled to {:.4} Hz by linear interpolation",
        found.shown,
        1.0 / median
    ));
    Ok(found.every(median))
}
