//! Time integration with a fixed step: the classical Runge-Kutta method of fourth order, or the
//! midpoint method.
//!
//! Explicit, since at a step of 1 ms only the spin of the wheelsets at low speed is stiff, for
//! which the step is divided. Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary
//! Differential Equations I", 2nd ed. (1993), II.1.

use super::{
    equations::{Equations, Hints, Input, Outputs},
    state::State,
    track::Track,
};

/// Step in s, and sampling interval.
pub const SAMPLE: f64 = 1e-3;
/// Largest rate of any state of a vehicle at rest, in SI units, due to rounding. In the seconds
/// before the track it causes less than a nanometre.
const AT_REST: f64 = 1e-10;
/// Maximum number of steps per sample. The reference vehicles need about ten at 1 m/s; a run with
/// the maximum takes a hundred times as long.
pub const MOST_STEPS: f64 = 1000.0;
/// Longest run in s: about 54 km at 30 m/s. Its channels take 317 MB.
pub const LONGEST: f64 = 1800.0;
/// Longest time of a wheelset beyond the contact table, in s.
const BEYOND: f64 = 0.2;

/// A method of integration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The classical method of fourth order.
    #[default]
    RungeKutta,
    /// The midpoint method of second order: less accurate with the same step, for comparisons.
    Midpoint,
}

impl Method {
    /// Largest product of step and fastest rate: 88 % of the stability limit of the method, which
    /// is 2.78 or 2.
    fn stable(self) -> f64 {
        match self {
            Self::RungeKutta => 2.45,
            Self::Midpoint => 1.76,
        }
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Self::RungeKutta => "Runge-Kutta method of fourth order",
            Self::Midpoint => "midpoint method",
        }
    }
}

/// A method, and the number of its steps in each sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    pub method: Method,
    pub per_sample: usize,
}

/// Of the Runge-Kutta method.
impl From<usize> for Steps {
    fn from(per_sample: usize) -> Self {
        Self { method: Method::RungeKutta, per_sample }
    }
}

/// A run without a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// Time since the start of the run, s.
    pub time: f64,
    /// Distance of the car body's centre, m.
    pub distance: f64,
    pub kind: FailureKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FailureKind {
    /// A state is not finite.
    Diverged,
    /// A wheelset (1 to 4) was beyond the contact table for too long, or too far beyond it;
    /// displacement in m.
    Derailed { wheelset: usize, displacement: f64 },
    /// The vehicle is too stiff for its masses: 1 ms would have to be divided into this number of
    /// steps.
    TooStiff { steps: f64 },
    /// The run would take this time in s.
    TooLong { seconds: f64 },
    /// The run would have to begin this distance in m before its start.
    TooEarly { by: f64 },
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (time, distance) = (self.time, self.distance);
        match self.kind {
            FailureKind::Diverged => write!(
                f,
                "the motion grew without bound {time:.3} s after the start, at {distance:.1} m"
            ),
            FailureKind::Derailed { wheelset, displacement } => write!(
                f,
                "wheelset {wheelset} left the contact table {time:.3} s after the start, at {distance:.1} m: displaced by {:.1} mm",
                displacement * 1e3
            ),
            FailureKind::TooStiff { steps } => write!(
                f,
                "a millisecond would have to be divided into {steps:.0e} steps, more than {MOST_STEPS:.0}: check masses, inertias and stiffnesses"
            ),
            FailureKind::TooLong { seconds } => {
                write!(
                    f,
                    "the run would last {seconds:.0} s, longer than {LONGEST:.0} s: check the length of the track and the speed"
                )
            }
            FailureKind::TooEarly { by } => {
                write!(f, "the record would begin {by:.1} m before the run does")
            }
        }
    }
}

impl std::error::Error for Failure {}

/// Integrates from `state` at distance `from` for `samples` samples, and calls `sample` with each
/// and its number.
///
/// # Errors
/// The run diverges, or a wheelset leaves the contact table.
pub fn run(
    equations: &Equations<'_>,
    track: &Track,
    state: State,
    from: f64,
    samples: usize,
    steps: impl Into<Steps>,
    sample: impl FnMut(usize, &State, &Outputs),
) -> Result<(), Failure> {
    let Steps { method, per_sample } = steps.into();
    // The widest vector instructions of the processor. They change the time, but not the result.
    let arch = pulp::Arch::new();
    match method {
        Method::RungeKutta => arch.dispatch(Run::<_, 4> {
            equations,
            track,
            state,
            from,
            samples,
            per_sample,
            stages: RUNGE_KUTTA,
            sample,
        }),
        Method::Midpoint => arch.dispatch(Run::<_, 2> {
            equations,
            track,
            state,
            from,
            samples,
            per_sample,
            stages: MIDPOINT,
            sample,
        }),
    }
}

struct Run<'a, F, const N: usize> {
    equations: &'a Equations<'a>,
    track: &'a Track,
    state: State,
    from: f64,
    samples: usize,
    per_sample: usize,
    stages: [Stage; N],
    sample: F,
}

/// Where the rates of a stage are taken: 0 at the beginning, 1 in the middle, 2 at the end of the
/// step. Then the part of the step to the state of the next stage, and the weight of the rates in
/// the step.
type Stage = (usize, f64, f64);

const RUNGE_KUTTA: [Stage; 4] =
    [(0, 0.5, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 1.0, 1.0 / 3.0), (2, 0.0, 1.0 / 6.0)];
const MIDPOINT: [Stage; 2] = [(0, 0.5, 0.0), (1, 0.0, 1.0)];

impl<F: FnMut(usize, &State, &Outputs), const N: usize> pulp::NullaryFnOnce for Run<'_, F, N> {
    type Output = Result<(), Failure>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        let (equations, track) = (self.equations, self.track);
        let speed = equations.speed;
        let step = SAMPLE / self.per_sample as f64;
        let (low, high) = equations.table();
        let most = high.max(-low);
        let mut beyond = 0;
        let mut hints = Hints::default();
        let mut rates = State::default();
        // At the beginning, in the middle and at the end of the step; the end is the beginning of
        // the next one.
        let mut inputs =
            [equations.input(track, self.from, &mut hints), Input::default(), Input::default()];
        let (mut begin, mut end) = (0, 2);
        let still = self.still(&inputs[0]);
        if still > 0 {
            equations.look(
                track,
                self.from + speed * (still as f64 * SAMPLE),
                &mut hints,
                &mut inputs[begin],
            );
        }
        for n in still..self.samples {
            for part in 0..self.per_sample {
                let t = n as f64 * SAMPLE + part as f64 * step;
                equations.look(
                    track,
                    self.from + speed * (t + 0.5 * step),
                    &mut hints,
                    &mut inputs[1],
                );
                equations.look(track, self.from + speed * (t + step), &mut hints, &mut inputs[end]);
                let (start, mut probe) = (self.state, self.state);
                for (stage, (at, next, weight)) in self.stages.into_iter().enumerate() {
                    let input = &inputs[[begin, 1, end][at]];
                    let wheels = equations.motion(&probe, input, &mut rates);
                    if stage == 0 && part == 0 {
                        let outputs = equations.outputs(&probe, input, &rates, &wheels);
                        (self.sample)(n, &start, &outputs);
                        let (displacement, wheelset) = outputs.widest;
                        beyond = if displacement > most { beyond + 1 } else { 0 };
                        let failure =
                            |kind| Failure { time: t, distance: self.from + speed * t, kind };
                        if !start.is_finite() {
                            return Err(failure(FailureKind::Diverged));
                        }
                        if displacement > 2.0 * most || f64::from(beyond) * SAMPLE > BEYOND {
                            return Err(failure(FailureKind::Derailed {
                                wheelset: wheelset + 1,
                                displacement,
                            }));
                        }
                    }
                    self.state.add(weight * step, &rates);
                    probe.follow(&start, next * step, &rates);
                }
                (begin, end) = (end, begin);
            }
        }
        Ok(())
    }
}

impl<F: FnMut(usize, &State, &Outputs), const N: usize> Run<'_, F, N> {
    /// Outputs the samples of a vehicle at rest before the track; returns their number.
    fn still(&mut self, input: &Input) -> usize {
        let mut rates = State::default();
        let outputs = self.equations.rates(&self.state, input, &mut rates);
        if rates.largest() > AT_REST
            || self.state.v != [0.0; State::BODIES]
            || self.equations.vehicle.roundness_amplitude > 0.0
        {
            return 0;
        }
        let free = self.track.start() - self.equations.wheelset_position(self.from, 0);
        let still =
            ((free / (self.equations.speed * SAMPLE)).floor().max(0.0) as usize).min(self.samples);
        for n in 0..still {
            (self.sample)(n, &self.state, &outputs);
        }
        still
    }
}

/// Least number of steps per sample with which a method is stable for the vehicle at its speed.
///
/// # Errors
/// The number is too large: [`FailureKind::TooStiff`].
pub fn least_steps(method: Method, equations: &Equations<'_>) -> Result<usize, FailureKind> {
    let steps = (equations.fastest_rate() * SAMPLE / method.stable()).ceil().max(1.0);
    if steps <= MOST_STEPS { Ok(steps as usize) } else { Err(FailureKind::TooStiff { steps }) }
}
