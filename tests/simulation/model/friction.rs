//! The effect shown in Figures 3 and 4 of Götz and Polach, Verification and validation of
//! simulations in a railway vehicle certification context: friction 0.3 and 0.6 in a right curve of
//! about 290 m.

use crate::model::common::{COACH, channel, median, profile, section, vehicle};

/// Y in kN, median over section S13 (radius 280 m, right): wheels 1R 1L 2R 2L.
fn leading_bogie(friction: f64) -> [f64; 4] {
    let section = section(COACH, "S13");
    let vehicle = vehicle(COACH, &[("friction", friction)]);
    let record = section.simulate(&vehicle, &profile(COACH, &vehicle)).unwrap();
    ["Y_1R", "Y_1L", "Y_2R", "Y_2L"]
        .map(|name| median(&section.inside(&record.distance, &record.channels[channel(name)])))
}

/// The outer leading wheel (left, in a right curve) bears markedly more, and so does the inner one,
/// since friction on the inner wheel has to be overcome; the trailing wheels change by less than a
/// third of that.
#[test]
fn friction_raises_the_leading_wheels_and_hardly_the_trailing() {
    let (low, high) = (leading_bogie(0.3), leading_bogie(0.6));
    let rise: Vec<f64> = (0..4).map(|i| high[i] - low[i]).collect();
    assert!(rise[1] < -5.0, "outer leading {low:?} {high:?}");
    assert!(rise[0] > 5.0, "inner leading {low:?} {high:?}");
    assert!(
        rise[2].abs() < 0.33 * rise[1].abs() && rise[3].abs() < 0.33 * rise[1].abs(),
        "trailing {low:?} {high:?}"
    );
}
