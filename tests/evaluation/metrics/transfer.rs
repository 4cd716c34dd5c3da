//! Filters by poles and zeros, against SciPy (`tests/cases/scipy/make_transfer.py`) and the closed
//! form of frequency weightings.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use fishplate::metrics::filter::{DesignError, Filter, Phase, Roots, TransferFunction, Warping};
use nalgebra::Complex;
use serde_json::Value;

use crate::metrics::{all_close, close, json, number, numbers, record};

fn two(frequency: f64, quality: f64) -> Roots {
    Roots::Two { frequency, quality }
}

/// Weighting Wk of ISO 2631-1, table of Annex A: band limits 0.4 and 100 Hz, transition at 12.5 Hz,
/// upward step from 2.37 to 3.35 Hz.
fn wk() -> [TransferFunction; 4] {
    let of = |poles, zeros, gain| TransferFunction { poles, zeros, gain };
    [
        of(two(0.4, FRAC_1_SQRT_2), Some(two(0.0, f64::INFINITY)), 1.0),
        of(two(100.0, FRAC_1_SQRT_2), None, 1.0),
        of(two(12.5, 0.63), Some(Roots::One(12.5)), 1.0),
        of(two(3.35, 0.91), Some(two(2.37, 0.91)), (2.37_f64 / 3.35).powi(2)),
    ]
}

/// |H(j 2 pi f)| of Wk as the standard writes it.
fn closed_form(frequency: f64) -> f64 {
    let s = Complex::new(0.0, TAU * frequency);
    let w = |frequency: f64| TAU * frequency;
    let square = |f: f64, q: f64| 1.0 + s / (q * w(f)) + s * s / (w(f) * w(f));
    let high_pass = s * s / (w(0.4) * w(0.4)) / square(0.4, FRAC_1_SQRT_2);
    let low_pass = 1.0 / square(100.0, FRAC_1_SQRT_2);
    let transition = (1.0 + s / w(12.5)) / square(12.5, 0.63);
    let upward_step =
        square(2.37, 0.91) / square(3.35, 0.91) * (w(2.37) * w(2.37) / (w(3.35) * w(3.35)));
    (high_pass * low_pass * transition * upward_step).norm()
}

fn weighted(frequency: f64, rate: f64, warping: Warping) -> f64 {
    let filter = |function| {
        Filter::transfer(&function, rate, Phase::Causal, warping).expect("a good design")
    };
    wk().map(|function| filter(function).gain(frequency)).iter().product()
}

/// ISO 2631-1, table 3: nominal centre frequencies in Hz and the factor in thousandths.
const TABLE: [(f64, f64); 30] = [
    (0.1, 31.2),
    (0.125, 48.6),
    (0.16, 79.0),
    (0.2, 121.0),
    (0.25, 182.0),
    (0.315, 263.0),
    (0.4, 352.0),
    (0.5, 418.0),
    (0.63, 459.0),
    (0.8, 477.0),
    (1.0, 482.0),
    (1.25, 484.0),
    (1.6, 494.0),
    (2.0, 531.0),
    (2.5, 631.0),
    (3.15, 804.0),
    (4.0, 967.0),
    (5.0, 1039.0),
    (6.3, 1054.0),
    (8.0, 1036.0),
    (10.0, 988.0),
    (12.5, 902.0),
    (16.0, 768.0),
    (20.0, 636.0),
    (25.0, 513.0),
    (31.5, 405.0),
    (40.0, 314.0),
    (50.0, 246.0),
    (63.0, 186.0),
    (80.0, 132.0),
];

/// The closed form is the published table to its last digit; the filter is the closed form but for
/// what the bilinear transformation squeezes near half the sampling rate, which at 1000 Hz is 0.06
/// % up to 20 Hz, 0.4 % up to 40 Hz, and 1.4 % at 80 Hz.
#[test]
fn wk_at_third_octaves() {
    for (frequency, thousandths) in TABLE {
        let exact = closed_form(frequency);
        let digit = if thousandths < 100.0 { 0.1 } else { 1.0 };
        assert!((1000.0 * exact - thousandths).abs() <= digit, "{frequency} Hz: {exact}");
        let allowed = match frequency {
            ..21.0 => 6.2e-4,
            ..41.0 => 3.6e-3,
            _ => 1.4e-2,
        };
        close(weighted(frequency, 1000.0, Warping::PreWarped), exact, allowed);
        // Not pre-warped, the filter is the closed form at another frequency, to the last digits.
        let squeezed = 1000.0 / PI * (PI * frequency / 1000.0).tan();
        close(weighted(frequency, 1000.0, Warping::Plain), closed_form(squeezed), 1e-9);
        // What is squeezed falls with the square of the sampling rate.
        close(weighted(frequency, 1e5, Warping::PreWarped), exact, 1.4e-6);
    }
}

/// The table of `docs/definitions.md`.
#[test]
fn deviations_are_as_documented() {
    for (rate, stated) in [
        (400.0, [4e-3, 2.4e-2, 9.1e-2]),
        (1000.0, [6.2e-4, 4e-3, 1.4e-2]),
        (2000.0, [1.6e-4, 9e-4, 4e-3]),
    ] {
        for (upper, stated) in [20.0, 40.0, 80.0].into_iter().zip(stated) {
            let off = |frequency: f64| {
                (weighted(frequency, rate, Warping::PreWarped) / closed_form(frequency) - 1.0).abs()
            };
            let largest = TABLE
                .iter()
                .filter(|(frequency, _)| *frequency <= upper)
                .fold(0.0_f64, |most, (at, _)| most.max(off(*at)));
            assert!(largest <= stated && largest > 0.7 * stated, "{rate} {upper}: {largest}");
        }
    }
}

/// Each corner by itself stays where it was said: 1/(2 pi f) of a pole is at -3 dB there, a pair at
/// its quality.
#[test]
fn corners_stay_where_they_are_said() {
    for rate in [250.0, 1000.0] {
        let gain = |poles| {
            let function = TransferFunction { poles, zeros: None, gain: 1.0 };
            Filter::transfer(&function, rate, Phase::Causal, Warping::PreWarped)
                .expect("a good design")
                .gain(80.0)
        };
        close(gain(Roots::One(80.0)), FRAC_1_SQRT_2, 1e-13);
        for quality in [0.2, 0.5, 0.63, 3.0] {
            close(gain(two(80.0, quality)), quality, 1e-12);
        }
    }
}

#[test]
fn agrees_with_scipy() {
    let roots = |kind: &Value, roots: &Value| {
        let roots = numbers(roots);
        if kind == "one" {
            Roots::One(roots[0])
        } else {
            two(roots[0], roots.get(1).copied().unwrap_or(f64::INFINITY))
        }
    };
    let signal = record(200, 1.5);
    for case in json("scipy/transfer.json").as_array().expect("a list") {
        let function = TransferFunction {
            poles: roots(&case["pole_kind"], &case["poles"]),
            zeros: (!case["zeros"].is_null()).then(|| roots(&case["zero_kind"], &case["zeros"])),
            gain: number(&case["gain"]),
        };
        let warping = if case["warping"] == "plain" { Warping::Plain } else { Warping::PreWarped };
        for (phase, name) in [
            (Phase::Causal, "causal"),
            (Phase::CausalFromRest, "causal-from-rest"),
            (Phase::Zero, "zero-phase"),
        ] {
            let filter = Filter::transfer(&function, number(&case["rate"]), phase, warping)
                .expect("a good design");
            let (ours, mut theirs) = (filter.sections(), numbers(&case["sos"]));
            if phase == Phase::Zero {
                // The gain is that of both passes.
                theirs[..3].iter_mut().for_each(|part| *part /= function.gain.sqrt());
            }
            assert_eq!(ours.len(), 1);
            // Coefficients lie between -2 and 2, numerators times the gain.
            all_close(&ours[0], &theirs, theirs[0].abs().max(1.0), 1e-12);
            let filtered: Vec<f64> =
                filter.apply(&signal).expect("long enough").into_iter().step_by(23).collect();
            let theirs = numbers(&case[name]);
            let largest = theirs.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
            all_close(&filtered, &theirs, largest, 1e-9);
        }
    }
}

/// Both passes square the magnitude, and the gain is that of both; the transient dies with the
/// slowest pole.
#[test]
fn forward_and_backward_squares_the_magnitude() {
    let function = TransferFunction { poles: Roots::One(2.0), zeros: None, gain: 0.5 };
    let of = |phase| {
        Filter::transfer(&function, 500.0, phase, Warping::PreWarped).expect("a good design")
    };
    close(of(Phase::Zero).gain(3.0), of(Phase::Causal).gain(3.0).powi(2) / 0.5, 1e-14);
    close(of(Phase::Causal).time_constant(), 1.0 / (TAU * 2.0), 1e-3);
    // Two real poles of low quality: the slower one at about quality x frequency.
    let slow = TransferFunction { poles: two(10.0, 0.05), zeros: None, gain: 1.0 };
    let slow =
        Filter::transfer(&slow, 500.0, Phase::Causal, Warping::PreWarped).expect("a good design");
    close(slow.time_constant(), 1.0 / (TAU * 0.5), 1e-2);
}

#[test]
fn refuses_with_the_reason() {
    let says = |function: TransferFunction, rate: f64, warping| {
        Filter::transfer(&function, rate, Phase::Causal, warping).expect_err("refused").to_string()
    };
    let low_pass =
        |frequency| TransferFunction { poles: Roots::One(frequency), zeros: None, gain: 1.0 };
    let beyond = says(low_pass(100.0), 200.0, Warping::PreWarped);
    assert!(beyond.contains("does not lie between 0 and half the sampling rate"), "{beyond}");
    assert!(Filter::transfer(&low_pass(100.0), 200.0, Phase::Causal, Warping::Plain).is_ok());
    assert!(says(low_pass(1.0), 0.0, Warping::Plain).contains("sampling rate"));
    let improper =
        TransferFunction { poles: Roots::One(1.0), zeros: Some(two(1.0, 1.0)), gain: 1.0 };
    for function in
        [low_pass(0.0), low_pass(-1.0), improper, TransferFunction { gain: 0.0, ..low_pass(1.0) }]
    {
        let refused = Filter::transfer(&function, 200.0, Phase::Causal, Warping::Plain);
        assert!(matches!(refused, Err(DesignError::Degenerate { .. })), "{function:?}");
    }
    assert!(matches!(
        Filter::transfer(&low_pass(f64::NAN), 200.0, Phase::Causal, Warping::Plain),
        Err(DesignError::Degenerate { .. } | DesignError::Frequency { .. })
    ));
}
