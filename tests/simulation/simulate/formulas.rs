//! Effects as expressions of the protocol language.

use super::{FORCE, Place, SECTIONS, apart, channel};

const CATALOGUE: &str = "\
catalogue: mine
extends: bogie-vehicle
effects:
  leaking_bridge:
    title: Bridge that sees the vertical force
    acts on: measuring chain
    signals:
      Y_1R: Y_1R + leak * Q_1R
      Y_1L: (larger of Y_1L, -stop) + leak * |Q_1L - Y_1R|
    parameters:
      bridge.leak: {unit: '%', neutral: 0, default: 5, range: [0, 10]}
      bridge.stop: {unit: N, neutral: 1000000, range: [10000, 1000000]}
";

/// Both channels come from the record as it was: `Y_1L` uses `Y_1R` before it is changed.
/// Parameters are in their own units.
#[test]
fn channels_are_computed_anew() {
    let place = Place::new();
    place.write("mine.yaml", CATALOGUE);
    place.simulated("plain", &[]);
    let effects = [
        "--effect",
        "leaking_bridge.leak=4 in zone 4",
        "--effect",
        "leaking_bridge.stop=20000 in zone 4",
    ];
    place.simulated("with", &[&effects[..], &["--effects", "mine.yaml"]].concat());
    let (plain, with) = (place.record("plain", "S13"), place.record("with", "S13"));
    let value = |name: &str, n: usize| channel(&plain, name)[n];
    let all = 0..plain.axis.len();
    let right: Vec<f64> = all.clone().map(|n| value("Y_1R", n) + 0.04 * value("Q_1R", n)).collect();
    let left: Vec<f64> = all
        .map(|n| value("Y_1L", n).max(-20.0) + 0.04 * (value("Q_1L", n) - value("Y_1R", n)).abs())
        .collect();
    assert!(apart(&right, channel(&with, "Y_1R")) < 1.1 * 2.0 * FORCE);
    assert!(apart(&left, channel(&with, "Y_1L")) < 1.2 * 2.0 * FORCE);
    assert_eq!(channel(&plain, "Y_2L"), channel(&with, "Y_2L"));
    for section in &SECTIONS[..3] {
        let record = format!("simulation/{section}.csv");
        assert!(
            place.text(&format!("plain/{record}")) == place.text(&format!("with/{record}")),
            "confined to zone 4"
        );
    }
}

#[test]
fn neutral_changes_nothing_and_increments_need_no_run() {
    let place = Place::new();
    place.write("mine.yaml", CATALOGUE);
    place.simulated(
        "same",
        &["--effects", "mine.yaml", "--effect", "leaking_bridge=0", "--increment"],
    );
    assert!(place.record("same", "S13") == place.record("small", "S13"));
}

#[test]
fn a_value_that_is_not_finite() {
    let place = Place::new();
    place.write(
        "mine.yaml",
        &CATALOGUE.replace("Y_1R + leak * Q_1R", "Y_1R / (Y_1R - Y_1R) * leak * 1 kN"),
    );
    let ran = place.simulate("out", &["--effects", "mine.yaml", "--effect", "leaking_bridge=5"]);
    assert_eq!(ran.code, 3, "{}", ran.stderr);
    assert!(ran.stderr.contains("section `S01`: `Y_1R` is not finite at 69."), "{}", ran.stderr);
}

#[test]
fn other_units_than_the_catalogue_says() {
    let place = Place::new();
    place.write(
        "mine.yaml",
        &CATALOGUE.replace("effects:\n", "units: {guiding forces: N}\neffects:\n"),
    );
    let ran = place.simulate("out", &["--effects", "mine.yaml", "--effect", "leaking_bridge=5"]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(
        ran.stderr.contains("`Y_1R` is recorded in kN, but the catalogue expects N"),
        "{}",
        ran.stderr
    );
}
