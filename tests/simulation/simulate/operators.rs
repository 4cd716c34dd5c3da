//! The measuring chain, each operator through the command line against what it is by definition.

use fishplate::effects::Signals;
use fishplate::metrics::filter::{Band, Cutoff, Filter, Phase};

use super::{ACCELERATION, FORCE, Place, apart, channel};

/// The record of S13 without and with effects.
#[track_caller]
fn both(effects: &[&str]) -> (Signals, Signals) {
    let place = Place::new();
    place.simulated("plain", &[]);
    let arguments: Vec<&str> = effects.iter().flat_map(|effect| ["--effect", effect]).collect();
    place.simulated("with", &arguments);
    (place.record("plain", "S13"), place.record("with", "S13"))
}

/// A channel is what a function makes of it, within the digits that are written (times `scale`);
/// all others are as they were.
#[track_caller]
fn becomes(effect: &str, name: &str, scale: f64, expected: impl Fn(usize, f64, &Signals) -> f64) {
    let (plain, with) = both(&[effect]);
    let digit = if name.starts_with('a') { ACCELERATION } else { FORCE };
    let values: Vec<f64> =
        channel(&plain, name).iter().enumerate().map(|(n, x)| expected(n, *x, &plain)).collect();
    let off = apart(&values, channel(&with, name));
    assert!(off <= digit * (1.0 + scale), "{effect}: {off}");
    for other in plain.channels.iter().filter(|other| other.name != name) {
        assert_eq!(other.values, channel(&with, &other.name), "{effect}: {}", other.name);
    }
}

#[test]
fn gain() {
    becomes("sensor_gain=0.8 on Y_3R", "Y_3R", 0.8, |_, x, _| 0.8 * x);
    becomes("sensor_gain.measurement.gain.ay_I=1.5", "ay_I", 1.5, |_, x, _| 1.5 * x);
}

#[test]
fn offset() {
    becomes("sensor_offset=-7.5 on Q_2L", "Q_2L", 1.0, |_, x, _| x - 7.5);
}

#[test]
fn polarity() {
    becomes("polarity on az_II", "az_II", 0.0, |_, x, _| -x);
}

#[test]
fn drift() {
    becomes("sensor_drift=0.5 on Y_1L", "Y_1L", 1.0, |n, x, _| x + 0.5 * n as f64 / 200.0);
}

#[test]
fn clipping() {
    becomes("clipping=20 on Y_1L", "Y_1L", 0.0, |_, x, _| x.clamp(-20.0, 20.0));
}

#[test]
fn crosstalk_of_one_wheel() {
    becomes("crosstalk=0.1 on Y_2R", "Y_2R", 1.1, |n, x, plain| {
        x + 0.1 * channel(plain, "Q_2R")[n]
    });
}

#[test]
fn crosstalk_of_all_wheels() {
    let (plain, with) = both(&["crosstalk=0.1"]);
    for wheel in ["1R", "1L", "2R", "2L", "3R", "3L", "4R", "4L"] {
        let sides = channel(&plain, &format!("Y_{wheel}"))
            .iter()
            .zip(channel(&plain, &format!("Q_{wheel}")));
        let expected: Vec<f64> = sides.map(|(y, q)| y + 0.1 * q).collect();
        assert!(apart(&expected, channel(&with, &format!("Y_{wheel}"))) <= 2.1 * FORCE, "{wheel}");
    }
}

#[test]
fn swap() {
    let (plain, with) = both(&["channel_swap on Y_1R, Q_4L"]);
    assert_eq!(channel(&plain, "Y_1R"), channel(&with, "Q_4L"));
    assert_eq!(channel(&plain, "Q_4L"), channel(&with, "Y_1R"));
    assert_eq!(channel(&plain, "Y_1L"), channel(&with, "Y_1L"));
}

/// The recorded distance is the true one plus the shift, and the record still begins and ends where
/// the section needs it.
#[test]
fn shift() {
    let (plain, with) = both(&["sync_shift=12"]);
    assert!(
        (plain.axis[0] - with.axis[0]).abs() < 0.1
            && plain.axis.len().abs_diff(with.axis.len()) <= 1,
        "the same window"
    );
    let mut compared = 0;
    for (n, x) in with.axis.iter().enumerate() {
        let true_position = x - 12.0;
        let Some(after) =
            plain.axis.iter().position(|known| *known >= true_position).filter(|after| *after > 0)
        else {
            continue;
        };
        let share =
            (true_position - plain.axis[after - 1]) / (plain.axis[after] - plain.axis[after - 1]);
        let q = channel(&plain, "Q_1L");
        let expected = q[after - 1] + share * (q[after] - q[after - 1]);
        compared += 1;
        // Between two samples of a signal without content above 40 Hz.
        assert!((expected - channel(&with, "Q_1L")[n]).abs() < 0.6, "at {x}");
    }
    assert!(compared > 1000, "{compared}");
}

/// Butterworth of second order by the bilinear transform, written out: its recursion is compared
/// with the library's filter too.
#[test]
fn low_pass() {
    let (edge, rate) = (6.0, 200.0);
    let (plain, with) = both(&["filter_mismatch=6 on vertical forces"]);
    let k = (std::f64::consts::PI * edge / rate).tan();
    let root = std::f64::consts::SQRT_2;
    let norm = 1.0 / (1.0 + root * k + k * k);
    let b = [k * k * norm, 2.0 * k * k * norm, k * k * norm];
    let a = [2.0 * (k * k - 1.0) * norm, (1.0 - root * k + k * k) * norm];
    let input = channel(&plain, "Q_1R");
    // In the steady state of the first sample.
    let (mut x, mut y) = ([input[0]; 2], [input[0]; 2]);
    let recursion: Vec<f64> = input
        .iter()
        .map(|&now| {
            let out = b[0] * now + b[1] * x[0] + b[2] * x[1] - a[0] * y[0] - a[1] * y[1];
            (x, y) = ([now, x[0]], [out, y[0]]);
            out
        })
        .collect();
    let filter = Filter::design(Band::LowPass(edge), 2, rate, Phase::Causal, Cutoff::PerPass)
        .expect("a filter");
    assert!(apart(&recursion, &filter.apply(input).expect("long enough")) < 1e-9);
    assert!(apart(&recursion, channel(&with, "Q_1R")) < 2.0 * FORCE);
    assert_eq!(channel(&plain, "Y_1R"), channel(&with, "Y_1R"), "not on other channels");
}

/// Mean, deviation and independence of what is added, within four standard errors.
#[test]
fn noise() {
    let (plain, with) = both(&["sensor_noise=2 on Y_1R, Y_1L"]);
    let added = |name: &str| -> Vec<f64> {
        channel(&with, name).iter().zip(channel(&plain, name)).map(|(a, b)| a - b).collect()
    };
    let (right, left) = (added("Y_1R"), added("Y_1L"));
    let n = right.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / n;
    for values in [&right, &left] {
        assert!(mean(values).abs() < 4.0 * 2.0 / n.sqrt());
        assert!((product(values, values) - 4.0).abs() < 4.0 * 4.0 * (2.0 / n).sqrt());
        assert!(
            (product(&values[1..], values) * n / (n - 1.0)).abs() < 4.0 * 4.0 / n.sqrt(),
            "white"
        );
    }
    assert!(product(&right, &left).abs() < 4.0 * 4.0 / n.sqrt(), "channels are independent");
    assert_eq!(channel(&plain, "Y_2R"), channel(&with, "Y_2R"));
}

/// The chain has one order however effects are listed: cross-talk, low-pass, gain, polarity,
/// offset.
#[test]
fn the_order_of_the_chain() {
    let (plain, with) = both(&[
        "sensor_offset=3 on Y_1R",
        "polarity on Y_1R",
        "sensor_gain=0.5 on Y_1R",
        "crosstalk=0.1 on Y_1R",
        "clipping=9 on Y_1R",
    ]);
    let sides = channel(&plain, "Y_1R").iter().zip(channel(&plain, "Q_1R"));
    let expected: Vec<f64> =
        sides.map(|(y, q)| (-(y + 0.1 * q) * 0.5 + 3.0).clamp(-9.0, 9.0)).collect();
    assert!(apart(&expected, channel(&with, "Y_1R")) < 2.0 * FORCE);
}

/// Every operator at its neutral value leaves every byte as it was.
#[test]
fn neutral() {
    let place = Place::new();
    place.simulated("plain", &[]);
    let neutral = [
        "sensor_gain=1 on guiding forces",
        "sensor_offset=0 on guiding forces",
        "sync_shift=0",
        "filter_mismatch=80",
        "channel_swap=0 on Y_1R, Y_1L",
        "polarity=1 on Y_1R",
        "crosstalk=0",
        "sensor_drift=0 on Y_1R",
        "sensor_noise=0 on Y_1R",
        "clipping=1000 on Y_1R",
    ];
    let arguments: Vec<&str> = neutral.iter().flat_map(|effect| ["--effect", effect]).collect();
    place.simulated("with", &arguments);
    for section in super::SECTIONS {
        let record = format!("simulation/{section}.csv");
        assert!(place.text(&format!("plain/{record}")) == place.text(&format!("with/{record}")));
    }
}
