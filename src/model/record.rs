//! From a run to a record: the recording chain of the reference.

use super::{
    equations::{Equations, Outputs},
    integrate::{Failure, FailureKind, LONGEST, SAMPLE, Steps, least_steps, run},
    parameters::Vehicle,
    profile::Profile,
    track::{Track, TrackTable},
};
use crate::metrics::filter::{Band, Cutoff, Filter, Phase};

/// Channels of a record with their units, in the order of the file.
pub const CHANNELS: [(&str, &str); 22] = [
    ("Y_1R", "kN"),
    ("Y_1L", "kN"),
    ("Y_2R", "kN"),
    ("Y_2L", "kN"),
    ("Y_3R", "kN"),
    ("Y_3L", "kN"),
    ("Y_4R", "kN"),
    ("Y_4L", "kN"),
    ("Q_1R", "kN"),
    ("Q_1L", "kN"),
    ("Q_2R", "kN"),
    ("Q_2L", "kN"),
    ("Q_3R", "kN"),
    ("Q_3L", "kN"),
    ("Q_4R", "kN"),
    ("Q_4L", "kN"),
    ("ay_I", "m/s^2"),
    ("ay_II", "m/s^2"),
    ("az_I", "m/s^2"),
    ("az_II", "m/s^2"),
    ("ayb_I", "m/s^2"),
    ("ayb_II", "m/s^2"),
];

/// Sampling rate of a record in Hz.
pub const SAMPLING_RATE: f64 = 200.0;
/// Decimation factor from run to record.
const DECIMATION: usize = 5;
/// Cut-off frequency of the low-pass before decimation in Hz, for each of its two passes.
const ANTI_ALIAS: f64 = 40.0;
const ANTI_ALIAS_ORDER: usize = 2;
/// Time of the trailing wheelset before the first table point, in s.
const RUN_IN: f64 = 2.5;
/// Time after the last sample in s, so that the filter's transient is outside the record.
const RUN_OUT: f64 = 0.1;
/// Length recorded before and after a section, in m.
pub const BEFORE: f64 = 36.0;
pub const BEHIND: f64 = 34.0;

/// A simulated record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Distance of the car body's centre in m; one per sample, at [`SAMPLING_RATE`].
    pub distance: Vec<f64>,
    /// One vector per entry of [`CHANNELS`], in its unit.
    pub channels: Vec<Vec<f64>>,
}

/// Latest begin and earliest end of the record, in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub from: f64,
    pub to: f64,
}

impl Window {
    /// The window of a section with the margins for the filters.
    pub fn around(start: f64, end: f64) -> Self {
        Self { from: start - BEFORE, to: end + BEHIND }
    }
}

/// One vehicle on one track at a constant speed in m/s.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    pub vehicle: &'a Vehicle,
    pub profile: &'a Profile,
    pub track: &'a TrackTable,
    pub speed: f64,
}

/// Simulates a record, by a method with at least this number of steps per sample, more if it would
/// not be stable.
///
/// # Errors
/// The run diverges, a wheelset leaves the contact table, or the window lies before the start of
/// the run.
pub fn simulate(setup: &Setup<'_>, window: Window, steps: Steps) -> Result<Record, Failure> {
    let equations = Equations::new(setup.vehicle, setup.profile, setup.speed);
    let track = Track::new(setup.track, setup.vehicle);
    let s0 = start(&equations, &track);
    let at = |n: usize| s0 + setup.speed * (n as f64 * SAMPLE);
    if window.from < s0 {
        return Err(Failure {
            time: 0.0,
            distance: s0,
            kind: FailureKind::TooEarly { by: s0 - window.from },
        });
    }
    let seconds = (window.to - s0) / setup.speed;
    if seconds > LONGEST {
        return Err(Failure { time: 0.0, distance: s0, kind: FailureKind::TooLong { seconds } });
    }
    let first = first_at(window.from, s0, setup.speed);
    let mut last = first;
    while at(last) < window.to {
        last += DECIMATION;
    }
    let samples = last + 1 + (RUN_OUT / SAMPLE) as usize;
    let least = least_steps(steps.method, &equations);
    let least = least.map_err(|kind| Failure { time: 0.0, distance: s0, kind })?;
    let steps = Steps { per_sample: steps.per_sample.max(least), ..steps };
    let mut raw = vec![vec![0.0; samples]; CHANNELS.len()];
    run(&equations, &track, equations.at_rest(), s0, samples, steps, |n, _, outputs| {
        for (channel, value) in raw.iter_mut().zip(channels(outputs)) {
            channel[n] = value;
        }
    })?;
    let filter = Filter::design(
        Band::LowPass(ANTI_ALIAS),
        ANTI_ALIAS_ORDER,
        1.0 / SAMPLE,
        Phase::Zero,
        Cutoff::PerPass,
    );
    let filter = filter.expect("the chain's constants make a filter");
    let signals: Vec<&[f64]> = raw.iter().map(Vec::as_slice).collect();
    let smooth =
        filter.apply_many(&signals).expect("the run-in alone is long enough for the filter");
    let kept =
        |signal: Vec<f64>| signal[first..=last].iter().step_by(DECIMATION).copied().collect();
    Ok(Record {
        distance: (first..=last).step_by(DECIMATION).map(at).collect(),
        channels: smooth.into_iter().map(kept).collect(),
    })
}

/// Start of the run: the trailing wheelset reaches the first point of the track after the run-in.
pub fn start(equations: &Equations<'_>, track: &Track) -> f64 {
    track.start() + equations.vehicle.half_bogie_spacing + equations.vehicle.half_wheelbase
        - RUN_IN * equations.speed
}

fn first_at(from: f64, s0: f64, speed: f64) -> usize {
    let mut n = ((from - s0) / (speed * SAMPLE)).floor().max(0.0) as usize;
    while s0 + speed * (n as f64 * SAMPLE) < from {
        n += 1;
    }
    n
}

/// In the order of [`CHANNELS`].
fn channels(outputs: &Outputs) -> [f64; 22] {
    let mut values = [0.0; 22];
    for j in 0..4 {
        for side in 0..2 {
            values[2 * j + side] = outputs.y[4 * side + j] * 1e-3;
            values[8 + 2 * j + side] = outputs.q[4 * side + j] * 1e-3;
        }
    }
    values[16..18].copy_from_slice(&outputs.ay);
    values[18..20].copy_from_slice(&outputs.az);
    values[20..22].copy_from_slice(&outputs.ayb);
    values
}
