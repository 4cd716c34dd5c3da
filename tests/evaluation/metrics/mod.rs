//! The metrics against independent sources: SciPy and NumPy (`tests/cases/scipy`,
//! `tests/cases/vectors`), closed forms.

mod cluster;
mod filter;
mod hysteresis;
mod pair;
mod percentile;
mod properties;
mod ratings;
mod regression;
mod resample;
mod statistics;
mod transfer;
mod vectors;
mod window;

use std::path::PathBuf;

use serde_json::Value;

pub fn case(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases").join(path)
}

pub fn json(path: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(case(path)).expect(path)).expect(path)
}

#[track_caller]
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list")).iter().map(number).collect()
}

/// Within a relative tolerance, or so near to zero that only rounding is compared.
#[track_caller]
pub fn close(actual: f64, expected: f64, relative: f64) {
    assert!(
        (actual - expected).abs() <= relative * expected.abs() + 1e-14,
        "{actual} is not {expected} to {relative}"
    );
}

/// Largest difference as a fraction of a scale.
#[track_caller]
pub fn all_close(actual: &[f64], expected: &[f64], scale: f64, relative: f64) {
    assert_eq!(actual.len(), expected.len());
    for (at, (a, e)) in actual.iter().zip(expected).enumerate() {
        assert!(
            (a - e).abs() <= relative * scale,
            "value {at}: {a} is not {e} to {relative} of {scale}"
        );
    }
}

/// The record of `tests/cases/scipy/make.py`.
pub fn record(samples: i64, offset: f64) -> Vec<f64> {
    (0..samples)
        .map(|k| ((k * k * 7919 + k * 104_729) % 65536) as f64 / 65536.0 - 0.5 + offset)
        .collect()
}
