//! Inverse dynamics of a rigid double pendulum as an external simulator of `fishplate`: from
//! measured positions to torques.
//!
//! ```console
//! double_pendulum_simulator VEHICLE KINEMATICS OUT [--set NAME=VALUE ...]
//! ```
//!
//! VEHICLE has a line `name: value` for each parameter; `--set` overrides it. KINEMATICS is a
//! record of `time`, `position_1` and `position_2` with constant time steps: the angle of the upper
//! link from the vertical, and of the lower link relative to the upper one. Velocities and
//! accelerations are those of a cubic fitted symmetrically around every sample, without phase
//! error.

use std::collections::BTreeMap;
use std::fmt::Write;

/// Half width of the fit and standard deviation of its weights, in s.
const HALF: f64 = 0.06;
const WEIGHT: f64 = 0.025;
/// Speed in rad/s below which Coulomb friction is regularised.
const TURNS: f64 = 0.05;

type Error = Box<dyn std::error::Error>;

fn main() -> Result<(), Error> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [vehicle, kinematics, out, rest @ ..] = words.as_slice() else {
        return Err(
            "usage: double_pendulum_simulator VEHICLE KINEMATICS OUT [--set NAME=VALUE ...]".into(),
        );
    };
    let mut parameters = read_parameters(&std::fs::read_to_string(vehicle)?);
    for pair in rest.chunks(2) {
        let [set, assignment] = pair else { return Err("--set needs NAME=VALUE".into()) };
        let (name, value) = assignment
            .split_once('=')
            .filter(|_| set == "--set")
            .ok_or("--set needs NAME=VALUE")?;
        let known =
            parameters.get_mut(name).ok_or_else(|| format!("there is no parameter `{name}`"))?;
        *known = value.parse()?;
    }
    let [time, upper, lower] = read_kinematics(&std::fs::read_to_string(kinematics)?)?;
    let step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    let (upper, lower) = (derivatives(&upper, step), derivatives(&lower, step));
    let mut text = String::from("time [s],tau_1 [N m],tau_2 [N m]\n");
    for ((time, upper), lower) in time.iter().zip(upper).zip(lower) {
        let [first, second] = torques(&parameters, upper, lower)?;
        writeln!(text, "{time:.6},{first:.6},{second:.6}")?;
    }
    Ok(std::fs::write(out, text)?)
}

/// Reads all lines `name: number`.
fn read_parameters(text: &str) -> BTreeMap<String, f64> {
    let line = |line: &str| {
        let (name, rest) = line.split_once(':')?;
        let number = rest.split('#').next()?.trim().parse().ok()?;
        Some((name.trim().to_string(), number))
    };
    text.lines().filter_map(line).collect()
}

fn read_kinematics(text: &str) -> Result<[Vec<f64>; 3], Error> {
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for line in text.lines().skip(1) {
        let cells: Result<Vec<f64>, _> = line.split(',').map(|cell| cell.trim().parse()).collect();
        for (column, value) in columns.iter_mut().zip(cells?) {
            column.push(value);
        }
    }
    if columns[0].len() < 32 || columns.iter().any(|column| column.len() != columns[0].len()) {
        return Err(
            "the kinematics need at least 32 rows of time, position_1 and position_2".into()
        );
    }
    Ok(columns)
}

/// Position, velocity and acceleration, from a cubic fitted by weighted least squares around every
/// sample.
fn derivatives(values: &[f64], step: f64) -> Vec<[f64; 3]> {
    let half = (HALF / step).round() as usize;
    (0..values.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(half), (at + half).min(values.len() - 1));
            let mut normal = nalgebra::Matrix4::<f64>::zeros();
            let mut right = nalgebra::Vector4::<f64>::zeros();
            for (n, value) in values.iter().enumerate().take(to + 1).skip(from) {
                let t = (n as f64 - at as f64) * step;
                // In units of the half width, for good conditioning.
                let x = t / HALF;
                let row = nalgebra::Vector4::new(1.0, x, x * x, x * x * x);
                let weight = (-0.5 * (t / WEIGHT).powi(2)).exp();
                normal += weight * row * row.transpose();
                right += weight * row * *value;
            }
            let fit = normal.lu().solve(&right).unwrap_or_default();
            [fit[0], fit[1] / HALF, 2.0 * fit[2] / (HALF * HALF)]
        })
        .collect()
}

/// Torques at the shoulder and at the elbow.
fn torques(
    parameters: &BTreeMap<String, f64>,
    upper: [f64; 3],
    lower: [f64; 3],
) -> Result<[f64; 2], Error> {
    let of = |name: &str| {
        parameters
            .get(name)
            .copied()
            .ok_or_else(|| format!("the vehicle file has no number `{name}`"))
    };
    let ([q1, v1, a1], [q2, v2, a2]) = (upper, lower);
    let (m1, m2, payload) = (of("upper_mass")?, of("lower_mass")?, of("payload_mass")?);
    let (l1, r1, r2, l2) =
        (of("upper_length")?, of("upper_centre")?, of("lower_centre")?, of("lower_length")?);
    let (gravity, tilt) = (of("gravity")?, of("mount_tilt")?);
    // First and second moments of the lower link about the elbow, including the payload.
    let moment = m2 * r2 + payload * l2;
    let inertia = of("lower_inertia")? + payload * l2 * l2;
    let (gear, rotor) = (of("gear_ratio")?, of("motor_inertia")?);
    let (cos, sin) = (l1 * moment * q2.cos(), l1 * moment * q2.sin());
    let m11 = of("upper_inertia")?
        + inertia
        + l1 * l1 * (m2 + payload)
        + 2.0 * cos
        + (gear * gear + 1.0) * rotor;
    let m12 = inertia + cos - gear * rotor;
    let m22 = inertia + gear * gear * rotor;
    let hangs = gravity * moment * (q1 + q2 + tilt).sin();
    let upper_hangs = gravity * (m1 * r1 + (m2 + payload) * l1) * (q1 + tilt).sin();
    let friction = |viscous: f64, coulomb: f64, v: f64| viscous * v + coulomb * (v / TURNS).tanh();
    let shoulder = friction(of("shoulder_viscous")?, of("shoulder_coulomb")?, v1);
    let elbow = friction(of("elbow_viscous")?, of("elbow_coulomb")?, v2);
    Ok([
        m11 * a1 + m12 * a2 - sin * (2.0 * v1 * v2 + v2 * v2) + upper_hangs + hangs + shoulder,
        m12 * a1 + m22 * a2 + sin * v1 * v1 + hangs + elbow,
    ])
}
