//! Forces between wheel and rail against theory: Kalker's linear limit, Coulomb's limit, Klingel's
//! wave, the flange.

use crate::model::modes::Linear;
use fishplate::model::equations::{Equations, Input};
use fishplate::model::state::{State, WHEELSET};
use fishplate::model::{Contact, Vehicle};

use crate::model::common::{COACH, cones, free_run, profile, vehicle};

/// Kalker's coefficients by hand: f = K G C ab of the ellipse at this load.
fn kalker(v: &Vehicle, load: f64) -> (f64, f64, f64) {
    let ab = v.ellipse_ab * (load / v.ellipse_reference_load).powf(2.0 / 3.0);
    let stiffness = v.kalker_scale * v.shear_modulus;
    (
        stiffness * v.kalker_c11 * ab,
        stiffness * v.kalker_c22 * ab,
        stiffness * v.kalker_c23 * ab.powf(1.5),
    )
}

/// For vanishing creepage the forces are Kalker's linear ones. Saturation takes r/3 of them, r =
/// linear force / mu N: here at most 1e-4, and 1e-9 for the coefficients themselves.
#[test]
fn small_creepages_give_kalkers_forces() {
    let v = vehicle(COACH, &[]);
    let contact = Contact::new(&v);
    for load in [2.0e4, 5.4e4, 1.2e5] {
        let (f11, f22, f23) = kalker(&v, load);
        for (xi, eta, zeta) in
            [(1e-7, 0.0, 0.0), (0.0, -2e-7, 0.0), (0.0, 0.0, 1e-5), (1e-7, 1e-7, -1e-5)]
        {
            let (fx, ft) = contact.creep(load, xi, eta, zeta);
            let (lx, lt) = (-f11 * xi, -f22 * eta - f23 * zeta);
            let r = lx.hypot(lt) / (v.friction * load);
            let share = 1.0 - r / 3.0 + r * r / 27.0;
            assert!(r < 3e-4, "{r}");
            assert!(
                (fx - share * lx).abs() <= 1e-9 * lx.hypot(lt)
                    && (ft - share * lt).abs() <= 1e-9 * lx.hypot(lt),
                "{load} N: {fx} {ft}"
            );
        }
    }
}

/// Beyond r = 3 the force is mu N against the creep, whatever the creepage (Coulomb); it never
/// exceeds mu N before; and the two branches of Shen, Hedrick and Elkins meet smoothly. Within
/// 1e-12 of mu N.
#[test]
fn large_creepages_give_coulombs_friction() {
    let v = vehicle(COACH, &[("friction", 0.42)]);
    let contact = Contact::new(&v);
    let load = 6.0e4;
    let limit = 0.42 * load;
    for (xi, eta) in [(0.03, 0.0), (0.0, -0.05), (0.02, 0.04), (-1.0, 2.0)] {
        let (fx, ft) = contact.creep(load, xi, eta, 0.0);
        assert!((fx.hypot(ft) / limit - 1.0).abs() < 1e-12, "{fx} {ft}");
        assert!(fx * xi <= 0.0 && ft * eta <= 0.0);
    }
    let (f11, _, _) = kalker(&v, load);
    let full = 3.0 * limit / f11;
    let mut last = 0.0;
    for n in 1..=400 {
        let (fx, _) = contact.creep(load, full * f64::from(n) / 200.0, 0.0, 0.0);
        assert!(-fx >= last - 1e-9 && -fx <= limit * (1.0 + 1e-12), "{fx}");
        last = -fx;
    }
    let slope = |at: f64| {
        (contact.creep(load, at * (1.0 + 1e-6), 0.0, 0.0).0 - contact.creep(load, at, 0.0, 0.0).0)
            / (1e-6 * at)
            / f11
    };
    assert!(slope(full * 0.99999).abs() < 1e-3 && slope(full * 1.00001).abs() < 1e-9);
}

/// A coach whose wheelsets are free of their bogies, on cones.
fn free_wheelsets() -> Vehicle {
    let free = [
        ("primary.kx", 0.0),
        ("primary.ky", 0.0),
        ("primary.cx", 0.0),
        ("primary.cy", 0.0),
        // Spin creep turns the wave a little; Klingel's wheelset has none.
        ("contact.C23", 0.0),
    ];
    vehicle(COACH, &free)
}

/// Klingel (1883): a free wheelset on cones of conicity l runs in a wave of length 2 pi sqrt(b0 r0
/// / l). At 3 m/s, where inertia does not count, the time integration crosses the centre line at
/// that distance, within 0.5 %.
#[test]
fn free_wheelsets_run_in_klingels_wave() {
    let v = free_wheelsets();
    let speed = 3.0;
    for conicity in [0.05, 0.15, 0.3] {
        let profile = cones(conicity, 0.0, &v);
        let equations = Equations::new(&v, &profile, speed);
        let mut start = State::default();
        start.x[WHEELSET.y..WHEELSET.y + 4].fill(1e-4);
        let states = free_run(&equations, start, 12.0, 0);
        let y: Vec<f64> = states.iter().map(|state| state.x[WHEELSET.y]).collect();
        let crossings: Vec<f64> = (1..y.len())
            .filter(|n| y[n - 1] < 0.0 && y[*n] >= 0.0)
            .map(|n| speed * 1e-3 * (n as f64 - y[n] / (y[n] - y[n - 1])))
            .collect();
        assert!(crossings.len() > 1, "{conicity}: no wave");
        let length = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
        let klingel =
            std::f64::consts::TAU * (v.half_contact_spacing * v.wheel_radius / conicity).sqrt();
        assert!(
            (length / klingel - 1.0).abs() < 0.005,
            "{conicity}: {length} m, Klingel {klingel} m"
        );
    }
}

/// The same by eigenvalues, and on the table's own profile with its slope at the centre, 0.15:
/// gravity then pushes the wheelset back, which hardly shortens the wave. Within 0.5 % and 3 %.
#[test]
fn klingels_wave_by_eigenvalues() {
    let v = free_wheelsets();
    let speed = 3.0;
    let klingel = std::f64::consts::TAU * (v.half_contact_spacing * v.wheel_radius / 0.15).sqrt();
    for (profile, tolerance) in [(cones(0.15, 0.0, &v), 0.005), (profile(COACH, &v), 0.03)] {
        let equations = Equations::new(&v, &profile, speed);
        let linear = Linear::about(&equations, &equations.at_rest(), 1e-6);
        let waves: Vec<f64> = linear
            .modes()
            .unwrap()
            .iter()
            .filter(|mode| {
                let shape = linear.shape(mode).unwrap();
                let largest = (0..State::BODIES)
                    .max_by(|a, b| shape[*a].norm().total_cmp(&shape[*b].norm()))
                    .unwrap();
                mode.frequency() > 0.1 && (WHEELSET.y..WHEELSET.y + 4).contains(&largest)
            })
            .map(|mode| speed / mode.frequency())
            .collect();
        assert!(
            !waves.is_empty() && waves.iter().all(|wave| (wave / klingel - 1.0).abs() < tolerance),
            "{waves:?}, Klingel {klingel}"
        );
    }
}

/// A wheelset pushed 10 mm to the right, hardly any friction: the right flange bears Q tan(gamma)
/// and the stop, k (u - 9 mm), the left wheel Q tan(gamma) of its small angle. Within 1e-6.
#[test]
fn the_flange_bears_by_its_angle_and_its_stop() {
    let v = vehicle(COACH, &[("friction", 1e-9)]);
    let wheels = profile(COACH, &v);
    let equations = Equations::new(&v, &wheels, 20.0);
    let mut state = State::default();
    state.x[WHEELSET.y] = 0.010;
    let outputs = equations.rates(&state, &Input::default(), &mut State::default());
    let q = v.static_wheel_load();
    let (right, left) = (wheels.at(0, 0.010), wheels.at(1, 0.010));
    let flange = q * right.gamma.tan() + v.stop_stiffness * 0.001;
    assert!((outputs.y[0] / flange - 1.0).abs() < 1e-6, "{} N, not {flange}", outputs.y[0]);
    assert!((outputs.y[4] / (-q * left.gamma.tan()) - 1.0).abs() < 1e-6, "{} N", outputs.y[4]);
    assert!(right.gamma > 1.0 && left.gamma < 0.1, "the table has a flange");
}
