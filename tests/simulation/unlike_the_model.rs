//! Machines whose records are not quite the model's: another integrator, another friction, noise.
//! A servo drive with and without its Coulomb friction in the catalogue, and an oscillator whose
//! spring hardens.

#![allow(clippy::cast_precision_loss)]

use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::machines::{Machine, has_python};

/// Rate of the records in Hz.
const RATE: f64 = 200.0;
/// Length of a record in s.
const LONG: f64 = 30.0;

/// A fixed sequence of normal numbers, nearly: the sum of twelve uniform ones (variance 1).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum += (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    }
}

fn written(folder: &Path, run: usize, [simulated, measured]: [String; 2]) -> [PathBuf; 2] {
    let paths = ["sim", "meas"].map(|side| folder.join(format!("{side}{run}.csv")));
    fs::write(&paths[0], simulated).expect("written");
    fs::write(&paths[1], measured).expect("written");
    paths
}

/// A drive of 20 kg: 60 N s/m and 25 N, smooth at standstill and larger there (Stribeck). The
/// amplitude differs between runs.
fn drive(folder: &Path, run: usize) -> [PathBuf; 2] {
    let noise = &mut Noise(run as u64 + 3);
    let mut simulated = String::from("time [s],force [N]\n");
    let mut measured = String::from("time [s],force [N],x [m],v [m/s],a [m/s^2]\n");
    for n in 0..(LONG * RATE) as usize {
        let t = n as f64 / RATE;
        let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
        for (k, f) in [0.31, 0.7, 1.3, 2.9, 5.3].into_iter().enumerate() {
            let (w, phase) = (TAU * f, run as f64 + 1.7 * k as f64);
            let size = [0.4, 0.8, 1.3, 2.0][run] * 0.04 / (1.0 + f);
            x += size * (w * t + phase).sin();
            v += size * w * (w * t + phase).cos();
            a -= size * w * w * (w * t + phase).sin();
        }
        let _ = writeln!(simulated, "{t},{:.4}", 20.0 * a);
        let coulomb = 25.0 * (v / 0.003).tanh() * (1.0 + 0.25 * (-(v / 0.02_f64).powi(2)).exp());
        let force = 20.0 * a + 60.0 * v + coulomb + noise.next();
        let _ = writeln!(measured, "{t},{force:.4},{x:.7},{v:.7},{a:.7}");
    }
    written(folder, run, [simulated, measured])
}

const DRIVE: &str = "
    force = []
    for x, v, a in zip(inputs['x'], inputs['v'], inputs['a']):
        sign = 1.0 if v > 0 else -1.0
        force.append((20.0 + parameters['mass']) * a + parameters['viscous'] * v
                     + parameters['coulomb'] * sign + parameters['stiffness'] * x)
    return {'force': force}
";

/// 10 kg, 40 N s/m, 4000 N/m and 600000 N/m^3, by the explicit midpoint rule with 4000 steps a
/// second.
fn oscillator(folder: &Path, run: usize) -> [PathBuf; 2] {
    let noise = &mut Noise(run as u64 + 5);
    let force = |t: f64| -> f64 {
        let wave = |k: usize| {
            let k = k as f64;
            (TAU * (0.6 + 0.47 * k) * t + 2.3 * k * k + run as f64).sin()
        };
        [4.0, 8.0, 14.0, 20.0][run] * (0..12).map(wave).sum::<f64>()
    };
    let rows = |cubic: f64| -> Vec<(f64, f64, f64)> {
        let (mut x, mut v, mut rows) = (0.0, 0.0, Vec::new());
        let acceleration =
            |t: f64, x: f64, v: f64| (force(t) - 40.0 * v - 4000.0 * x - cubic * x * x * x) / 10.0;
        let (steps, h) = (20, 1.0 / (20.0 * RATE));
        for n in 0..(LONG * RATE) as usize * steps {
            let t = n as f64 * h;
            if n % steps == 0 {
                rows.push((t, x, acceleration(t, x, v)));
            }
            let (middle, speed) = (x + 0.5 * h * v, v + 0.5 * h * acceleration(t, x, v));
            x += h * speed;
            v += h * acceleration(t + 0.5 * h, middle, speed);
        }
        rows
    };
    let mut simulated = String::from("time [s],x [m],a [m/s^2]\n");
    let mut measured = String::from("time [s],x [m],a [m/s^2],F [N]\n");
    for ((t, x, a), (_, real, felt)) in rows(0.0).into_iter().zip(rows(6e5)) {
        let _ = writeln!(simulated, "{t:.3},{x:.8},{a:.6}");
        let (real, felt) = (real + 2e-5 * noise.next(), felt + 0.03 * noise.next());
        let _ = writeln!(measured, "{t:.3},{real:.8},{felt:.6},{:.5}", force(t));
    }
    written(folder, run, [simulated, measured])
}

/// The classical Runge-Kutta rule, two steps a sample.
const OSCILLATOR: &str = "
    t, force = list(inputs['time']), list(inputs['F'])
    mass, damping = 10.0 + parameters['mass'], 40.0 + parameters['damping']
    stiffness = 4000.0 + parameters['stiffness']
    quadratic, cubic = parameters['stiffness_quadratic'], parameters['stiffness_cubic']
    def acceleration(f, x, v):
        dry = parameters['coulomb'] * max(-1.0, min(1.0, v / 1e-3))
        return (f - damping * v - stiffness * x - quadratic * x * x - cubic * x ** 3 - dry) / mass
    xs, accelerations, x, v = [], [], 0.0, 0.0
    for i, f in enumerate(force):
        xs.append(x)
        accelerations.append(acceleration(f, x, v))
        if i + 1 == len(t):
            break
        h = (t[i + 1] - t[i]) / 2
        for half in range(2):
            at, to = (f + (force[i + 1] - f) * share / 2 for share in (half, half + 1))
            a1, v1 = acceleration(at, x, v), v
            a2, v2 = acceleration((at + to) / 2, x + h / 2 * v1, v + h / 2 * a1), v + h / 2 * a1
            a3, v3 = acceleration((at + to) / 2, x + h / 2 * v2, v + h / 2 * a2), v + h / 2 * a2
            a4, v4 = acceleration(to, x + h * v3, v + h * a3), v + h * a3
            x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
            v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return {'x': xs, 'a': accelerations}
";

fn diagnosed(machine: &Machine, out: &str) -> Value {
    let done = machine.diagnose(&["--out", out]);
    assert!(matches!(done.code, 0 | 1), "{}{}", done.stdout, done.stderr);
    serde_json::from_str(&machine.text(&format!("{out}/diagnosis.json"))).expect("JSON")
}

/// The named effects with their sizes.
fn named(found: &Value) -> Vec<(String, f64)> {
    let effects = found["causes"][0]["effects"].as_array().expect("effects");
    let one = |effect: &Value| {
        let name = effect["name"].as_str().expect("a name").to_string();
        let size = effect["parameters"][&name]["value"].as_f64().expect("a size");
        (name, size)
    };
    let mut all: Vec<(String, f64)> = effects.iter().map(one).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

/// Both frictions are named, each within 5 %. Without Coulomb friction in the catalogue, viscous
/// friction would have to be larger in the slow runs: no single size fits, and nothing is explained.
#[test]
fn a_drive_without_coulomb_friction_in_the_catalogue_is_unexplained() {
    if !has_python() {
        return;
    }
    let machine = Machine::of("drive", 4, &drive);
    machine.fill(DRIVE);
    let both = diagnosed(&machine, "both");
    assert_eq!(both["verdict"], "explained", "{}", both["says"]);
    let found = named(&both);
    assert_eq!(found.len(), 2, "{found:?}");
    for ((name, size), (wanted, truth)) in found.iter().zip([("coulomb", 25.0), ("viscous", 60.0)])
    {
        assert!(name == wanted && (size / truth - 1.0).abs() < 0.05, "{name} {size}");
    }
    let catalogue = machine.text("effects.yaml");
    let from = catalogue.find("  coulomb:\n").expect("offered");
    let to = catalogue.find("  mass:\n").expect("after it");
    fs::write(machine.path("effects.yaml"), format!("{}{}", &catalogue[..from], &catalogue[to..]))
        .expect("written");
    let without = diagnosed(&machine, "without");
    assert_eq!(without["verdict"], "unexplained", "{}", without["says"]);
    let says = without["says"].to_string();
    assert!(says.contains("Viscous friction: no single size fits all data"), "{says}");
}

/// The cubic term is named within 5 %, with an interval that contains it.
#[test]
fn a_hardening_spring_is_named() {
    if !has_python() {
        return;
    }
    let machine = Machine::of("oscillator", 4, &oscillator);
    machine.fill(OSCILLATOR);
    let found = diagnosed(&machine, "out");
    assert_eq!(found["verdict"], "explained", "{}", found["says"]);
    let effects = named(&found);
    assert_eq!(effects.len(), 1, "{effects:?}");
    assert!(effects[0].0 == "stiffness_cubic" && (effects[0].1 / 6e5 - 1.0).abs() < 0.05);
    let size = &found["causes"][0]["effects"][0]["parameters"]["stiffness_cubic"];
    let end = |key: &str| size[key].as_f64().expect("an interval");
    assert!(end("low") < 6e5 && 6e5 < end("high"), "{size}");
}
