//! Ratings of ISO/TS 18571 against `objective-rating-metrics` 1.3, and of CORA against code of our
//! own (`tests/cases/vectors/make_ratings.py`).

use std::f64::consts::TAU;

use fishplate::metrics::pair::*;

use crate::metrics::{close, json, number, vectors::Pair};

type Function = fn(&[f64], &[f64]) -> Metric;

const RATINGS: [(Function, &str); 10] = [
    (iso18571_corridor, "/iso/corridor"),
    (iso18571_phase, "/iso/phase"),
    (iso18571_magnitude, "/iso/magnitude"),
    (iso18571_slope, "/iso/slope"),
    (iso18571_overall, "/iso/overall"),
    (cora_corridor, "/cora/corridor"),
    (cora_progression, "/cora/progression"),
    (cora_size, "/cora/size"),
    (cora_phase, "/cora/phase"),
    (cora_total, "/cora/total"),
];

/// The sum of sines of `make_ratings.py`.
fn wave(late: f64) -> Vec<f64> {
    let at = |x: f64| {
        (TAU * x / 190.0).sin() + 0.4 * (TAU * x / 47.0).cos() + 0.15 * (TAU * x / 13.0).sin()
    };
    (0..700).map(|k| at(f64::from(k) - late)).collect()
}

#[test]
fn ratings_agree_with_the_package() {
    let cases = json("vectors/ratings.json");
    let cases = cases.as_array().expect("a list");
    assert_eq!(cases.len(), 10);
    for case in cases {
        let (simulated, measured) = match case["pair"].as_str() {
            Some(name) => {
                let (mut simulated, mut measured) = Pair::read(name).signals();
                simulated.truncate(1200);
                measured.truncate(1200);
                (simulated, measured)
            }
            None => {
                let [late, gain, offset] = ["late", "gain", "offset"].map(|key| number(&case[key]));
                (wave(late).iter().map(|value| gain * value + offset).collect(), wave(0.0))
            }
        };
        for (metric, place) in RATINGS {
            let found = metric(&simulated, &measured)
                .unwrap_or_else(|undefined| panic!("{place}: {undefined}"));
            close(found, number(case.pointer(place).expect(place)), 1e-9);
        }
    }
}

#[test]
fn ratings_that_are_undefined_say_why() {
    let (ramp, one, zero) = (wave(0.0), [1.0; 700], [0.0; 700]);
    let says = |result: Result<f64, Undefined>, text: &str| {
        let reason = result.expect_err("undefined").reason;
        assert!(reason.contains(text), "{reason}");
    };
    for (metric, place) in RATINGS {
        says(metric(&[], &[]), "no samples");
        says(metric(&ramp, &ramp[..2]), "the simulated signal has 700 samples, the measured 2");
        assert!(metric(&ramp, &zero).is_err(), "{place}");
    }
    says(iso18571_corridor(&ramp, &zero), "measured signal is zero");
    says(iso18571_phase(&one, &ramp), "constant");
    says(iso18571_slope(&ramp[..5], &wave(1.0)[..5]), "the slopes need 9");
    says(cora_progression(&zero, &ramp), "zero throughout");
    says(cora_size(&one[..1], &one[..1]), "no interval");
}
