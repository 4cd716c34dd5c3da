//! How fast the vehicle model runs: `cargo bench --bench simulate [-- CAMPAIGN]`, by default the
//! coach of the examples.
//!
//! Times are the best of several rounds. What is timed is the run, not the reading of files.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "../tests/simulation/model/common.rs"]
#[allow(dead_code)]
mod common;

use std::cell::RefCell;
use std::sync::LazyLock;
use std::time::Instant;

use fishplate::model::equations::{Equations, Hints, Input};
use fishplate::model::integrate::{Method, SAMPLE, least_steps, run};
use fishplate::model::state::State;
use fishplate::model::{Profile, Setup, Track, Vehicle, simulate, start};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};
use rayon::prelude::*;

use common::Section;

const ROUNDS: usize = 7;
/// 31 displacements and 4 spin speeds.
const DEGREES_OF_FREEDOM: f64 = 35.0;

/// Shortest time of a round on the processor in s.
fn best<T>(mut work: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = on_processor();
        std::hint::black_box(work());
        on_processor() - start
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

/// Time in s that this thread has had a processor: waiting for others on a shared machine does not
/// count. By the clock where the system does not say.
fn on_processor() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let said = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = said.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// Shortest time of a round by the clock in s.
fn best_by_clock<T>(mut work: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(time).fold(f64::INFINITY, f64::min)
}

struct Campaign {
    vehicle: Vehicle,
    profile: Profile,
    sections: Vec<Section>,
}

impl Campaign {
    fn setup<'a>(&'a self, section: &'a Section) -> Setup<'a> {
        Setup {
            vehicle: &self.vehicle,
            profile: &self.profile,
            track: &section.track,
            speed: section.speed,
        }
    }

    fn steps(&self, section: &Section) -> usize {
        least_steps(
            Method::RungeKutta,
            &Equations::new(&self.vehicle, &self.profile, section.speed),
        )
        .expect("few steps")
    }

    /// Samples of a run, of 1 ms.
    fn samples(&self, section: &Section) -> f64 {
        let equations = Equations::new(&self.vehicle, &self.profile, section.speed);
        let from = start(&equations, &Track::new(&section.track, &self.vehicle));
        (section.window().to - from) / section.speed / SAMPLE
    }

    fn all(&self, steps: usize) {
        for section in &self.sections {
            std::hint::black_box(
                simulate(&self.setup(section), section.window(), steps.into()).unwrap(),
            );
        }
    }
}

fn main() {
    let folder = std::env::args()
        .skip(1)
        .find(|word| !word.starts_with('-'))
        .unwrap_or_else(|| common::COACH.to_owned());
    let vehicle = common::vehicle(&folder, &[]);
    let campaign = Campaign {
        profile: common::profile(&folder, &vehicle),
        vehicle,
        sections: common::sections(&folder),
    };
    throughput(&campaign);
    right_hand_side(&campaign);
    peers(&campaign);
    memory(&campaign);
}

fn throughput(campaign: &Campaign) {
    let samples: f64 = campaign.sections.iter().map(|section| campaign.samples(section)).sum();
    println!("{} sections, {:.0} s of running", campaign.sections.len(), samples * SAMPLE);
    let steps = |least: usize| -> f64 {
        campaign
            .sections
            .iter()
            .map(|section| campaign.samples(section) * campaign.steps(section).max(least) as f64)
            .sum()
    };
    for (what, least) in [("default step", 1), ("0.5 ms", 2)] {
        let time = best(|| campaign.all(least));
        let step = time / steps(least) * 1e9;
        println!(
            "{what:13} 1 thread  {:6.0} x real time, {step:5.0} ns a step, {:4.0} ns a stage, {:4.1} ns a stage and degree of freedom",
            samples * SAMPLE / time,
            step / 4.0,
            step / 4.0 / DEGREES_OF_FREEDOM
        );
    }
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let time = best_by_clock(|| {
            pool.install(|| {
                campaign.sections.par_iter().for_each(|section| {
                    std::hint::black_box(
                        simulate(&campaign.setup(section), section.window(), 1.into()).unwrap(),
                    );
                });
            });
        });
        println!("default step  {threads} threads {:6.0} x real time", samples * SAMPLE / time);
    }
}

/// The equations alone, and the track under the wheels alone.
fn right_hand_side(campaign: &Campaign) {
    const TIMES: usize = 500_000;
    let section = &campaign.sections[0];
    let equations = Equations::new(&campaign.vehicle, &campaign.profile, section.speed);
    let track = Track::new(&section.track, &campaign.vehicle);
    let mut hints = Hints::default();
    let input = best(|| {
        (0..TIMES).map(|n| equations.input(&track, 100.0 + n as f64 * 4e-4, &mut hints)).last()
    });
    println!("track under all bodies: {:.0} ns", input / TIMES as f64 * 1e9);
    let state = equations.at_rest();
    let arch = pulp::Arch::new();
    let rates = best(|| {
        arch.dispatch(|| {
            let mut rates = State::default();
            for _ in 0..TIMES {
                equations.rates(std::hint::black_box(&state), &Input::default(), &mut rates);
                std::hint::black_box(&rates);
            }
        });
    });
    println!(
        "right-hand side: {:.0} ns, {:.1} ns a degree of freedom",
        rates / TIMES as f64 * 1e9,
        rates / TIMES as f64 * 1e9 / DEGREES_OF_FREEDOM
    );
}

struct Motion<'a> {
    equations: &'a Equations<'a>,
    track: &'a Track,
    from: f64,
    hints: RefCell<Hints>,
    evaluations: RefCell<usize>,
}

/// On the stack, as ours: the library's methods lose nothing by allocations.
type Y = SVector<f64, { State::ALL }>;

impl System<f64, Y> for &Motion<'_> {
    #[inline(never)]
    fn system(&self, t: f64, y: &Y, dy: &mut Y) {
        *self.evaluations.borrow_mut() += 1;
        let input = self.equations.input(
            self.track,
            self.from + self.equations.speed * t,
            &mut self.hints.borrow_mut(),
        );
        let mut rates = State::default();
        let state = State::from_slice(y.as_slice());
        pulp::Arch::new().dispatch(|| self.equations.rates(&state, &input, &mut rates));
        rates.write(dy.as_mut_slice());
    }
}

/// Our method and those of a kept library over the first section: time against the largest error of
/// a displacement of a wheelset at the samples, against our method with steps of 1/16 ms. (DOP853
/// at the end only: the library's continuous output of it goes wrong here.)
fn peers(campaign: &Campaign) {
    let section = &campaign.sections[0];
    let equations = Equations::new(&campaign.vehicle, &campaign.profile, section.speed);
    let track = Track::new(&section.track, &campaign.vehicle);
    // Where the first wheelset reaches the track: before, nothing moves, and a step of any length
    // will do.
    let from = track.start() - (equations.wheelset_position(0.0, 0));
    let seconds = 5.0;
    let samples = (seconds / SAMPLE) as usize + 1;
    let ours = |divided: usize| {
        let mut states = Vec::with_capacity(samples);
        run(&equations, &track, equations.at_rest(), from, samples, divided, |_, state, _| {
            states.push(state.x)
        })
        .unwrap();
        states
    };
    let truth = ours(16);
    let lateral = 15..19;
    // Of all samples, or of the last.
    let error = |states: &[[f64; 31]]| {
        let pairs = states
            .iter()
            .zip(&truth[truth.len() - states.len()..])
            .flat_map(|(a, b)| lateral.clone().map(move |i| (a[i] - b[i]).abs()));
        pairs.fold(0.0, f64::max)
    };
    println!("first section, {seconds} s: method, time, evaluations, largest error");
    let told = |name: &str, time: f64, evaluations: usize, states: &[[f64; 31]]| {
        println!("  {name:20} {:8.2} ms {evaluations:8} {:9.1e} m", time * 1e3, error(states));
    };
    for divided in [1, 2] {
        let time = best_of_few(|| ours(divided));
        told(&format!("ours, 1/{divided} ms"), time, 4 * divided * (samples - 1), &ours(divided));
    }
    let motion = Motion {
        equations: &equations,
        track: &track,
        from,
        hints: RefCell::default(),
        evaluations: RefCell::default(),
    };
    let at_rest = Y::from_vec(equations.at_rest().to_vec());
    for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
        // DOP853 needs more evaluations with each, not fewer: two tolerances show it.
        if tolerance > 5e-5 {
            motion.evaluations.take();
            let states = eighth_order(&motion, at_rest, seconds, tolerance);
            let evaluations = motion.evaluations.take();
            let time = best_of_few(|| eighth_order(&motion, at_rest, seconds, tolerance));
            told(&format!("DOP853, {tolerance:.0e}"), time, evaluations, &states);
        }
        motion.evaluations.take();
        let states = fifth_order(&motion, at_rest, seconds, tolerance);
        let evaluations = motion.evaluations.take();
        let time = best_of_few(|| fifth_order(&motion, at_rest, seconds, tolerance));
        told(&format!("DOPRI5, {tolerance:.0e}"), time, evaluations, &states);
    }
}

/// The mean of ten, best of three: what takes a few milliseconds is short against the ticks in
/// which the system counts.
fn best_of_few<T>(mut work: impl FnMut() -> T) -> f64 {
    let ten = |_| {
        let start = on_processor();
        for _ in 0..10 {
            std::hint::black_box(work());
        }
        (on_processor() - start) / 10.0
    };
    (0..3).map(ten).fold(f64::INFINITY, f64::min)
}

/// Never stops at what looks stiff.
const STEPS: (u32, u32) = (10_000_000, u32::MAX);

/// Displacements at the end.
fn eighth_order(motion: &Motion<'_>, y: Y, seconds: f64, tolerance: f64) -> Vec<[f64; 31]> {
    let (absolute, (most, never)) = (tolerance * 1e-3, STEPS);
    let sparse = OutputType::Sparse;
    let mut solver = Dop853::from_param(
        motion, 0.0, seconds, SAMPLE, y, tolerance, absolute, 0.9, 0.0, 0.333, 6.0, seconds, 0.0,
        most, never, sparse,
    );
    solver.integrate().unwrap();
    solver.y_out().last().into_iter().map(|y| State::from_slice(y.as_slice()).x).collect()
}

/// Displacements at all samples, after the rates at them: the record is of forces, which ours has
/// at its samples anyway.
fn fifth_order(motion: &Motion<'_>, y: Y, seconds: f64, tolerance: f64) -> Vec<[f64; 31]> {
    let (absolute, (most, never)) = (tolerance * 1e-3, STEPS);
    let dense = OutputType::Dense;
    let mut solver = Dopri5::from_param(
        motion, 0.0, seconds, SAMPLE, y, tolerance, absolute, 0.9, 0.04, 0.2, 10.0, seconds, 0.0,
        most, never, dense,
    );
    solver.integrate().unwrap();
    for (n, y) in solver.y_out().iter().enumerate() {
        motion.system(n as f64 * SAMPLE, y, &mut Y::zeros());
    }
    solver.y_out().iter().map(|y| State::from_slice(y.as_slice()).x).collect()
}

/// The highest memory of this process after one pass over the sections and after ten.
fn memory(campaign: &Campaign) {
    let peak = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line =
            status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("VmHWM: unknown");
        line.trim_start_matches("VmHWM:").trim().to_owned()
    };
    campaign.all(1);
    let once = peak();
    (0..10).for_each(|_| campaign.all(1));
    println!(
        "peak memory after {} sections {once}, after {} {}",
        campaign.sections.len(),
        11 * campaign.sections.len(),
        peak()
    );
}
