//! Balances that hold whatever the suspension does, and hand formulas for what it does.

use std::sync::LazyLock;

use fishplate::model::equations::Equations;
use fishplate::model::integrate::{Method, SAMPLE, least_steps, run};
use fishplate::model::state::{BOGIE, CAR, PHI, PSI, State, WHEELSET};
use fishplate::model::{G, Profile, Track, TrackTable, Vehicle, start};

use crate::model::common::{COACH, WAGON, curve, even, profile, vehicle};

/// Mass of the vehicle with its payload in kg.
fn total_mass(v: &Vehicle) -> f64 {
    v.car_mass + v.payload_mass + 2.0 * v.bogie_mass + 4.0 * v.wheelset_mass
}

/// Steady motion at the end of a track: the state and the forces, Y and Q in N.
struct Steady {
    state: State,
    y: [f64; 8],
    q: [f64; 8],
}

fn steady(vehicle: &Vehicle, profile: &Profile, table: &TrackTable, speed: f64) -> Steady {
    let equations = Equations::new(vehicle, profile, speed);
    let track = Track::new(table, vehicle);
    let from = start(&equations, &track);
    // Where the last oscillations have died out, in m: the track goes on as it ends. Dry friction
    // takes longer to creep.
    let settled = if vehicle.primary_friction_z > 0.0 { 2500.0 } else { 1000.0 };
    let samples = ((settled - from) / speed / SAMPLE) as usize;
    let mut last = Steady { state: State::default(), y: [0.0; 8], q: [0.0; 8] };
    run(
        &equations,
        &track,
        equations.at_rest(),
        from,
        samples,
        least_steps(Method::RungeKutta, &equations).expect("few steps"),
        |_, state, outputs| {
            last = Steady { state: *state, y: outputs.y, q: outputs.q };
        },
    )
    .unwrap();
    last
}

/// Campaign, radius in m, cant in mm, speed in m/s.
const CURVES: [(&str, f64, f64, f64); 6] = [
    (COACH, 300.0, 120.0, 20.0),
    (COACH, -300.0, 120.0, 20.0),
    (COACH, 500.0, 100.0, 27.0),
    (COACH, 1500.0, 80.0, 40.0),
    (WAGON, 300.0, 100.0, 18.0),
    (WAGON, 600.0, 80.0, 23.0),
];

/// The vehicles in all curves.
static STEADY: LazyLock<Vec<(Vehicle, Steady)>> = LazyLock::new(|| {
    let runs = CURVES.map(|(campaign, radius, cant, speed)| {
        let vehicle = vehicle(campaign, &[]);
        let steady = steady(&vehicle, &profile(campaign, &vehicle), &curve(radius, cant), speed);
        (vehicle, steady)
    });
    runs.into()
});

/// `check` gets the vehicle, the steady motion, curvature, v^2 kappa phi and the uncompensated
/// acceleration of each curve.
fn in_curves(check: impl Fn(&Vehicle, &Steady, f64, f64, f64)) {
    for ((_, radius, cant, speed), (vehicle, steady)) in CURVES.iter().zip(STEADY.iter()) {
        let kappa = 1.0 / radius;
        let phi = cant * kappa.signum() * 1e-3 / (2.0 * vehicle.half_contact_spacing);
        check(vehicle, steady, kappa, speed * speed * kappa * phi, speed * speed * kappa - G * phi);
    }
}

/// Newton, vertically: sum Q = m g + m v^2 kappa phi. Within 1 N of some 430 000 N.
#[test]
fn vertical_forces_carry_the_weight() {
    in_curves(|vehicle, steady, kappa, lift, _| {
        let expected = total_mass(vehicle) * (G + lift);
        let sum: f64 = steady.q.iter().sum();
        assert!((sum - expected).abs() < 1.0, "kappa {kappa}: {sum} N, not {expected}");
    });
}

/// Newton, sideways: sum Y = -m (v^2 kappa - g phi), of the vehicle within 2 N. Each bogie bears
/// half of it but for the yaw moments of the suspension in the curve, within 1.5 % of a wheelset's
/// share of gravity at 0.1 g.
#[test]
fn guiding_forces_balance_the_uncompensated_acceleration() {
    in_curves(|vehicle, steady, kappa, _, uncompensated| {
        let expected = -total_mass(vehicle) * uncompensated;
        let sum: f64 = steady.y.iter().sum();
        assert!((sum - expected).abs() < 2.0, "kappa {kappa}: {sum} N, not {expected}");
        for bogie in 0..2 {
            let wheelset = |j: usize| steady.y[j] + steady.y[4 + j];
            let mean = (wheelset(2 * bogie) + wheelset(2 * bogie + 1)) / 2.0;
            let share = expected / 4.0;
            let tolerance = 0.015 * total_mass(vehicle) / 4.0 * 0.1 * G + 0.05 * share.abs();
            assert!(
                (mean - share).abs() < tolerance,
                "kappa {kappa} bogie {bogie}: {mean} N a wheelset, not {share}"
            );
        }
    });
}

/// Moments about the middle of the track: the wheel loads of the sides differ by what the
/// uncompensated acceleration does at the centres of gravity, and by the sideways shift of the
/// weights. (The model leaves the weight of what is above the primary springs at the bogie's own
/// middle.) Within 0.2 %.
#[test]
fn cant_deficiency_unloads_the_inner_side() {
    in_curves(|v, steady, kappa, _, uncompensated| {
        let x = &steady.state.x;
        let car = v.car_mass * v.car_cog_height
            + 2.0 * v.bogie_mass * v.bogie_cog_height
            + 4.0 * v.wheelset_mass * v.wheel_radius;
        let mut moment = -uncompensated * car;
        for i in 0..2 {
            let b = BOGIE + 5 * i;
            // The car body above the bogie, seen from the bogie's frame: the chord of the curve
            // lies inside it.
            let lever = [v.half_bogie_spacing, -v.half_bogie_spacing][i];
            let versine = 0.5 * kappa * v.half_bogie_spacing * v.half_bogie_spacing;
            moment += v.car_mass * G / 2.0 * (x[CAR] + lever * x[CAR + PSI] - versine - x[b]);
        }
        for j in 0..4 {
            moment += x[WHEELSET.y + j] * (steady.q[j] + steady.q[4 + j]);
        }
        let difference: f64 =
            (0..4).map(|j| steady.q[j] - steady.q[4 + j]).sum::<f64>() * v.half_contact_spacing;
        assert!(
            (difference - moment).abs() < 0.002 * moment.abs().max(1000.0),
            "kappa {kappa}: {difference} N m, not {moment}"
        );
        // The outer side bears more.
        assert!(difference * kappa < 0.0 || uncompensated * kappa < 0.0);
    });
}

/// In small curves the leading wheelsets run against the outer rail: their outer wheels bear the
/// largest |Y| of their bogies, more the smaller the radius, by the friction on the inner wheel: |Y
/// outer| = |Y of the wheelset| + |Y inner|, and on the inner wheel friction is used up: Y = Q
/// tan(atan(mu) + gamma) at most, 85 % of it at least with its small contact angle.
#[test]
fn leading_outer_wheels_guide_in_small_curves() {
    let vehicle = vehicle(COACH, &[]);
    let profile = profile(COACH, &vehicle);
    let outer = |radius: f64| {
        let steady = steady(
            &vehicle,
            &profile,
            &curve(radius, 100.0),
            (radius * (0.8 + G * 100e-3 / 1.5)).sqrt(),
        );
        for bogie in [0, 2] {
            let leading = steady.y[4 + bogie].abs();
            assert!(
                (0..8).filter(|i| *i % 4 / 2 == bogie / 2).all(|i| steady.y[i].abs() <= leading),
                "R {radius} {:?}",
                steady.y
            );
        }
        let (y_inner, q_inner) = (steady.y[0], steady.q[0]);
        let most = q_inner * (vehicle.friction.atan() + 0.0525).tan();
        assert!(
            y_inner < most && y_inner > 0.85 * most,
            "R {radius}: inner {y_inner} N, at most {most}"
        );
        let wheelset = steady.y[0] + steady.y[4];
        assert!(wheelset < 0.0 && (steady.y[4].abs() - (wheelset.abs() + y_inner)).abs() < 1e-6);
        steady.y[4].abs()
    };
    // At a constant uncompensated acceleration of 0.8 m/s^2.
    let forces = [250.0, 300.0, 400.0].map(outer);
    assert!(forces[0] > forces[1] && forces[1] > forces[2], "{forces:?}");
}

/// Sway on a canted straight: roll of the body over the cant angle (flexibility coefficient, UIC
/// 505-5) against springs in series by hand: contact, primary springs, secondary springs with
/// anti-roll bar, lateral secondary spring. Within 1 %.
#[test]
fn flexibility_coefficient_by_hand() {
    let v = vehicle(COACH, &[]);
    let phi = 0.05;
    let cant = phi * 2.0 * v.half_contact_spacing * 1e3;
    let table = even(&[(0.0, 0.0, 0.0), (40.0, 0.0, 0.0), (120.0, 0.0, cant), (500.0, 0.0, cant)]);
    let steady = steady(&v, &profile(COACH, &v), &table, 20.0);
    let x = &steady.state.x;

    let (hcs, hbs, hbw) = (
        v.car_cog_height - v.secondary_height,
        v.secondary_height - v.bogie_cog_height,
        v.bogie_cog_height - v.wheel_radius,
    );
    let weight = v.car_mass * G;
    let (car, bogies) = (weight * phi, 2.0 * v.bogie_mass * G * phi);
    let all = total_mass(&v) * G * phi;
    let secondary =
        4.0 * v.secondary_half_spacing.powi(2) * v.secondary_kz + 2.0 * v.anti_roll_stiffness;
    let primary = 8.0 * v.primary_half_spacing.powi(2) * v.primary_kz;
    let contact = 8.0 * v.half_contact_spacing.powi(2) * v.contact_kc;
    let d = car / (4.0 * v.secondary_ky);
    // Roll of wheelsets w, bogies b, body c; the weight of the body acts at its displaced centre.
    let shift = x[WHEELSET.y..WHEELSET.y + 4].iter().sum::<f64>() / 4.0 * total_mass(&v) * G;
    let (mut b, mut c) = (0.0, 0.0);
    for _ in 0..100 {
        let on_car = hcs * car + weight * (hcs * c + d / 2.0);
        let on_bogies = on_car + hbs * car + weight * (hbs * b + d / 2.0) + hbw * (car + bogies);
        let w = (on_bogies + v.wheel_radius * all + shift) / contact;
        b = w + on_bogies / primary;
        c = b + on_car / secondary;
    }
    let (found, expected) = (x[CAR + PHI] / phi, c / phi);
    assert!((found / expected - 1.0).abs() < 0.01, "{found}, by hand {expected}");
    assert!((0.1..0.4).contains(&found), "{found}");
    assert!((x[BOGIE + PHI] / b - 1.0).abs() < 0.02, "{} {b}", x[BOGIE + PHI]);
}
