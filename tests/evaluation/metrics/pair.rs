use std::f64::consts::TAU;

use fishplate::metrics::pair::*;
use serde_json::Value;

use crate::metrics::{
    close, json, number, numbers, record,
    vectors::{PAIRS, Pair},
};

/// The distribution of a signal at some points.
fn quantiles(signal: &[f64], points: usize) -> Result<Vec<f64>, Undefined> {
    let mut sorted = signal.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    quantiles_of_sorted(&sorted, points)
}

type Function = fn(&[f64], &[f64]) -> Metric;

/// Metric and where `expected.json` has it.
const METRICS: [(Function, &str); 16] = [
    (sprague_geers_magnitude, "/sprague_geers/magnitude"),
    (sprague_geers_phase, "/sprague_geers/phase"),
    (sprague_geers_comprehensive, "/sprague_geers/comprehensive"),
    (russell_magnitude, "/russell/magnitude"),
    (russell_phase, "/russell/phase"),
    (russell_comprehensive, "/russell/comprehensive"),
    (theil_u1, "/theil/U1"),
    (theil_u2, "/theil/U2"),
    (theil_bias, "/theil/bias"),
    (theil_variance, "/theil/variance"),
    (theil_covariance, "/theil/covariance"),
    (root_mean_square_error, "/theil/rmse"),
    (weighted_integrated_factor, "/wifac"),
    (kraft_misfit, "/misfit_over_lower/squared"),
    (area_metric, "/area_metric_wasserstein"),
    (bogojevic_mean_term, "/bogojevic/mean_term"),
];

#[track_caller]
fn compare(simulated: &[f64], measured: &[f64], expected: &Value, what: &str, relative: f64) {
    for (metric, place) in METRICS {
        if let Some(expected) = expected.pointer(place).and_then(Value::as_f64) {
            let actual = metric(simulated, measured)
                .unwrap_or_else(|undefined| panic!("{what} {place}: {undefined}"));
            assert!(
                (actual - expected).abs() <= relative * expected.abs() + 2e-15,
                "{what} {place}: {actual}, not {expected}"
            );
        }
    }
    let bogojevic_expected = &expected["bogojevic"];
    close(
        bogojevic_variance_ratio(simulated, measured).expect("defined"),
        number(&bogojevic_expected["F"]),
        relative,
    );
    close(
        bogojevic_variance_probability(simulated, measured).expect("defined"),
        number(&bogojevic_expected["p_two_sided"]),
        1e-9,
    );
    close(
        bogojevic(simulated, measured).expect("defined"),
        number(&bogojevic_expected["product"]),
        1e-9,
    );
}

/// Four pairs, NumPy and SciPy.
#[test]
fn pairs_agree_with_numpy() {
    for name in PAIRS {
        let pair = Pair::read(name);
        let (simulated, measured) = pair.signals();
        let mut expected = pair.expected["time_history"].clone();
        expected["bogojevic"] = pair.expected["bogojevic"].clone();
        expected["area_metric_wasserstein"] = pair.expected["area_metric_wasserstein"].clone();
        compare(&simulated, &measured, &expected, name, 1e-10);
        let theil = [theil_bias, theil_variance, theil_covariance]
            .map(|share| share(&simulated, &measured).expect("defined"));
        close(theil.iter().sum(), 1.0, 1e-12);
    }
}

/// A 3 Hz sine, 1001 samples at 1 kHz, and what becomes of it: mostly closed forms.
#[test]
fn edge_cases() {
    let sine = |shift: f64| {
        (0..1001).map(|k| (TAU * 3.0 * (f64::from(k) / 1000.0 - shift)).sin()).collect::<Vec<f64>>()
    };
    let measured = sine(0.0);
    let of = |f: fn(f64) -> f64| measured.iter().map(|&value| f(value)).collect::<Vec<f64>>();
    let cases = [
        ("equal", measured.clone()),
        ("gain_1_2", of(|value| 1.2 * value)),
        ("inverted", of(|value| -value)),
        ("offset_0_3", of(|value| value + 0.3)),
        ("quadrature", (0..1001).map(|k| (TAU * 3.0 * f64::from(k) / 1000.0).cos()).collect()),
        ("constant_1", vec![1.0; 1001]),
        ("zero", vec![0.0; 1001]),
    ];
    let expected = &json("vectors/expected.json")["edge_cases_sin3Hz_1001_samples_1kHz"];
    for (name, simulated) in cases {
        compare(&simulated, &measured, &expected[name], name, 1e-10);
    }
}

/// Two samples of different size: scipy.stats.wasserstein_distance.
#[test]
fn area_of_unequal_counts() {
    let expected = &json("vectors/expected.json")["two_samples"];
    let (simulated, measured) =
        (numbers(&expected["simulation"]), numbers(&expected["measurement"]));
    close(
        area_between(&simulated, &measured).expect("defined"),
        number(&expected["wasserstein"]),
        1e-12,
    );
    // Of equal counts both forms are the same number.
    let (a, b) = (record(200, 0.0), record(400, 0.3)[200..].to_vec());
    close(area_between(&a, &b).expect("defined"), area_metric(&a, &b).expect("defined"), 1e-12);
    assert!(area_between(&[], &a).is_err());
}

/// scipy.stats.f: tails down to 3e-36, and up to a million degrees of freedom.
#[test]
fn f_distribution() {
    for case in json("vectors/expected.json")["f_distribution"].as_array().expect("a list") {
        let p = f_two_sided(number(&case["F"]), number(&case["d1"]), number(&case["d2"]));
        let expected = number(&case["two_sided"]);
        assert!((p - expected).abs() <= 1e-9 * expected, "{case}: {p}");
    }
    for case in json("scipy/statistics.json")["f"].as_array().expect("a list") {
        let p = f_two_sided(number(&case["F"]), number(&case["d1"]), number(&case["d2"]));
        close(p, number(&case["p"]), 1e-9);
    }
}

/// Ratios of root mean squares and ranges, of numbers that are easily seen.
#[test]
fn relative_errors() {
    let (simulated, measured) = ([2.0, -2.0, 2.0, -2.0], [1.0, -1.0, 1.0, -1.0]);
    assert_eq!(root_mean_square_error(&simulated, &measured), Ok(1.0));
    assert_eq!(relative_to_range(&simulated, &measured), Ok(0.5));
    assert_eq!(rms_ratio(&simulated[..2], &measured), Ok(2.0));
    assert!(
        relative_to_range(&simulated, &[1.0; 4])
            .is_err_and(|undefined| undefined.reason.contains("constant"))
    );
    assert!(
        rms_ratio(&simulated, &[0.0; 4])
            .is_err_and(|undefined| undefined.reason.contains("zero throughout"))
    );
}

#[test]
fn undefined_says_why() {
    let (zero, one, ramp) = ([0.0; 3], [1.0; 3], [1.0, 2.0, 3.0]);
    let says = |result: Result<f64, Undefined>, text: &str| {
        let reason = result.expect_err("undefined").reason;
        assert!(reason.contains(text), "{reason}");
    };
    for (metric, place) in METRICS {
        says(metric(&[], &[]), "no samples");
        // Of distributions, which need not have equally many values.
        if place != "/bogojevic/mean_term" {
            says(metric(&one, &one[..2]), "the simulated signal has 3 samples, the measured 2");
        }
        says(metric(&ramp, &[1.0, f64::NAN, 2.0]), "sample 2 of the measured signal is not finite");
        says(metric(&[f64::INFINITY, 0.0, 0.0], &ramp), "sample 1 of the simulated signal");
    }
    says(sprague_geers_magnitude(&one, &zero), "measured signal is zero");
    assert_eq!(sprague_geers_magnitude(&zero, &one), Ok(-1.0));
    says(sprague_geers_phase(&zero, &one), "simulated signal is zero");
    says(russell_magnitude(&zero, &one), "simulated signal is zero");
    says(kraft_misfit(&zero, &one), "zero throughout");
    says(theil_u1(&zero, &zero), "both signals");
    says(theil_bias(&one, &one), "equal");
    says(weighted_integrated_factor(&zero, &zero), "both signals");
    says(correlation(&one, &ramp), "constant");
    says(bogojevic(&ramp, &one), "measured signal is constant");
    says(root_mean_square_error(&[1e200], &[-1e200]), "overflows");
}

/// A phase error of 1e-9 is seen as such: the plain arc cosine would give 0.
#[test]
fn a_small_angle_keeps_its_digits() {
    let measured = [1.0, 0.0];
    let simulated = [1.0, 1e-9];
    close(
        sprague_geers_phase(&simulated, &measured).expect("defined") * std::f64::consts::PI * 1e9,
        1.0,
        1e-12,
    );
}

/// NumPy and SciPy, `tests/cases/vectors/make_distributions.py`: three sections, both sides at 20,
/// 50 and 100 points.
#[test]
fn distributions_at_points() {
    for case in json("vectors/distributions.json").as_array().expect("a list") {
        let (simulated, measured) = (numbers(&case["simulated"]), numbers(&case["measured"]));
        close(area_metric(&simulated, &measured).expect("defined"), number(&case["area"]), 1e-10);
        for points in [20, 50, 100] {
            let of = |signal: &[f64]| quantiles(signal, points).expect("points");
            let (s, m) = (of(&simulated), of(&measured));
            let expected = |what: &str| number(&case[format!("bogojevic_{points}_{what}")]);
            close(bogojevic_variance_ratio(&s, &m).expect("defined"), expected("F"), 1e-9);
            close(bogojevic_variance_probability(&s, &m).expect("defined"), expected("p"), 1e-9);
            // The peer's mean term goes below zero, its product does not.
            close(bogojevic_mean_term(&s, &m).expect("defined"), expected("mean_term"), 1e-9);
            close(bogojevic(&s, &m).expect("defined"), expected("product"), 1e-9);
        }
    }
}

/// Sides of different length: each variance has its own n. Of a distribution at points the number
/// of samples hardly matters.
#[test]
fn distributions_of_unequal_counts() {
    let (s, m) = (record(400, 1.0), record(300, 1.1));
    // scipy.stats.f of the ratio with 399 and 299 degrees of freedom.
    let ratio = bogojevic_variance_ratio(&s, &m).expect("defined");
    close(
        bogojevic_variance_probability(&s, &m).expect("defined"),
        f_two_sided(ratio, 399.0, 299.0),
        1e-15,
    );
    assert!(f_two_sided(ratio, 399.0, 299.0) != f_two_sided(ratio, 299.0, 299.0));
    assert_eq!(quantiles(&[1.0, 3.0], 4).expect("points"), vec![1.25, 1.75, 2.25, 2.75]);
    assert_eq!(quantiles(&[], 4).expect_err("nothing").reason, "there are no values");
    assert!(quantiles(&[1.0], 0).is_err() && quantiles(&[f64::NAN], 2).is_err());
    assert_eq!(
        bogojevic(&[], &m).expect_err("nothing").reason,
        "the simulated signal has no samples"
    );
}
