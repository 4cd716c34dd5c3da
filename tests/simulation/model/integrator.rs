//! The integrator: order, step, and agreement with one that shares nothing with it.

use std::cell::RefCell;

use fishplate::metrics::filter::{Band, Cutoff, Filter, Phase};
use fishplate::model::equations::{Equations, Hints};
use fishplate::model::integrate::{Method, Steps, least_steps, run};
use fishplate::model::state::{CAR, State, WHEELSET, Z};
use fishplate::model::{CHANNELS, SAMPLING_RATE, Setup, Track, simulate, start};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{DVector, Dop853, System};

use crate::model::common::{
    COACH, WAGON, cones, deviation, even, free_run, profile, section, vehicle,
};

/// On cones the equations are smooth: halving the step divides the error by 16. A wheelset set
/// aside and a body let fall, 0.3 s; the order of the largest difference between successive
/// halvings lies between 3.8 and 4.3.
#[test]
fn the_method_is_of_fourth_order() {
    let v = vehicle(COACH, &[]);
    let profile = cones(0.1, 0.05, &v);
    let equations = Equations::new(&v, &profile, 40.0);
    let mut from = State::default();
    from.x[WHEELSET.y..WHEELSET.y + 4].copy_from_slice(&[0.002, 0.0015, 0.001, 0.002]);
    from.x[CAR + Z] = 0.005;
    let end = |divided: usize| {
        let states = free_run(&equations, from, 0.3, divided);
        states[states.len() - 1].x
    };
    let ends = [1, 2, 4, 8].map(end);
    let difference = |a: usize, b: usize| {
        ends[a].iter().zip(&ends[b]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for (coarse, fine) in
        [(difference(0, 1), difference(1, 2)), (difference(1, 2), difference(2, 3))]
    {
        let order = (coarse / fine).log2();
        assert!((3.8..4.3).contains(&order), "{order} from {coarse} and {fine}");
    }
}

/// The midpoint method on the same motion: halving the step divides the error by 4; the order lies
/// between 1.9 and 2.1.
#[test]
fn the_midpoint_method_is_of_second_order() {
    let v = vehicle(COACH, &[]);
    let profile = cones(0.1, 0.05, &v);
    let equations = Equations::new(&v, &profile, 40.0);
    let track = Track::new(&even(&[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]), &v);
    let mut from = State::default();
    from.x[WHEELSET.y..WHEELSET.y + 4].copy_from_slice(&[0.002, 0.0015, 0.001, 0.002]);
    from.x[CAR + Z] = 0.005;
    let end = |per_sample: usize| {
        let mut end = from;
        let steps = Steps { method: Method::Midpoint, per_sample };
        run(&equations, &track, from, 10.0, 301, steps, |_, state, _| end = *state).unwrap();
        end.x
    };
    let ends = [2, 4, 8, 16].map(end);
    let difference = |a: usize, b: usize| {
        ends[a].iter().zip(&ends[b]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for (coarse, fine) in
        [(difference(0, 1), difference(1, 2)), (difference(1, 2), difference(2, 3))]
    {
        let order = (coarse / fine).log2();
        assert!((1.9..2.1).contains(&order), "{order} from {coarse} and {fine}");
    }
}

/// Halving the default step changes what is left below 20 Hz by less than 0.5 %: rms of the change
/// over the standard deviation, all channels, on straight track and in a small curve, coach and
/// wagon.
#[test]
fn halving_the_step_changes_nothing_that_matters() {
    let filter =
        Filter::design(Band::LowPass(20.0), 4, SAMPLING_RATE, Phase::Zero, Cutoff::AsApplied)
            .unwrap();
    for (campaign, name) in [(COACH, "S01"), (COACH, "S13"), (WAGON, "S14")] {
        let section = section(campaign, name);
        let vehicle = vehicle(campaign, &[]);
        let profile = profile(campaign, &vehicle);
        let setup = Setup {
            vehicle: &vehicle,
            profile: &profile,
            track: &section.track,
            speed: section.speed,
        };
        let steps =
            least_steps(Method::RungeKutta, &Equations::new(&vehicle, &profile, section.speed))
                .expect("few steps");
        let records = [steps, 2 * steps]
            .map(|steps| simulate(&setup, section.window(), steps.into()).unwrap());
        for (i, (channel, _)) in CHANNELS.iter().enumerate() {
            let [coarse, fine] = records.each_ref().map(|record| {
                let smooth = filter.apply(&record.channels[i]).unwrap();
                section.inside(&record.distance, &smooth)
            });
            let change = (coarse.iter().zip(&fine).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
                / fine.len() as f64)
                .sqrt();
            assert!(
                change < 0.005 * deviation(&fine),
                "{campaign} {name} {channel}: {change} of {}",
                deviation(&fine)
            );
        }
    }
}

struct Motion<'a> {
    equations: &'a Equations<'a>,
    track: &'a Track,
    from: f64,
    hints: RefCell<Hints>,
}

impl System<f64, DVector<f64>> for Motion<'_> {
    fn system(&self, t: f64, y: &DVector<f64>, dy: &mut DVector<f64>) {
        let input = self.equations.input(
            self.track,
            self.from + self.equations.speed * t,
            &mut self.hints.borrow_mut(),
        );
        let mut rates = State::default();
        self.equations.rates(&State::from_slice(y.as_slice()), &input, &mut rates);
        dy.copy_from_slice(&rates.to_vec());
    }
}

/// Dormand and Prince's method of eighth order with step control (crate `ode_solvers`, tolerances
/// 1e-7 relative, 1e-8 absolute), through the run-in and the transition into a curve of 280 m over
/// uneven track, 8 s: displacements of the wheelsets within 2 micrometres and of the bodies within
/// 1 micrometre at the end.
#[test]
fn an_independent_integrator_agrees() {
    let section = section(COACH, "S13");
    let v = vehicle(COACH, &[]);
    let profile = profile(COACH, &v);
    let equations = Equations::new(&v, &profile, section.speed);
    let track = Track::new(&section.track, &v);
    let from = start(&equations, &track);
    let mut ours = State::default();
    run(&equations, &track, equations.at_rest(), from, 8001, 1, |_, state, _| ours = *state)
        .unwrap();
    let motion = Motion { equations: &equations, track: &track, from, hints: RefCell::default() };
    let at_rest = DVector::from_vec(equations.at_rest().to_vec());
    // The defaults of `new`, but no end at what looks stiff: the spin of the wheelsets is, a
    // little.
    let (safety, beta, least, most, first) = (0.9, 0.0, 0.333, 6.0, 0.0);
    let sparse = OutputType::Sparse;
    let mut solver = Dop853::from_param(
        motion,
        0.0,
        8.0,
        8.0,
        at_rest,
        1e-7,
        1e-8,
        safety,
        beta,
        least,
        most,
        8.0,
        first,
        10_000_000,
        u32::MAX,
        sparse,
    );
    solver.integrate().unwrap();
    let theirs = State::from_slice(solver.y_out().last().unwrap().as_slice());
    assert!((solver.x_out().last().unwrap() - 8.0).abs() < 1e-12);
    for i in 0..State::BODIES {
        let tolerance = if i < WHEELSET.y { 1e-6 } else { 2e-6 };
        assert!(
            (ours.x[i] - theirs.x[i]).abs() < tolerance,
            "displacement {i}: {} {}",
            ours.x[i],
            theirs.x[i]
        );
    }
    assert!(theirs.x[WHEELSET.y].abs() > 1e-3, "in the curve");
}
