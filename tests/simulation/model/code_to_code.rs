//! Code to code: the simulated records of the example campaigns were made by an independent program
//! after the same description, with another step (0.5 ms). `docs/verification.md` has the table
//! over more campaigns.

use fishplate::model::CHANNELS;

use crate::model::common::{COACH, Section, WAGON, deviation, median, profile, sections, vehicle};

/// Compares all sections of a campaign; gives how many there are.
///
/// Asked for: quasi-static values within 2 %, dynamic rms within 5 %, where the value is larger
/// than 1 kN or 0.05 m/s^2. What holds is more: medians within 0.01 kN and 0.001 m/s^2 (0.002 on
/// the bogies), every sample within 0.04 kN and 0.006 m/s^2 (rounding of the files and of the track
/// they were made on), standard deviations within 1 %.
fn agrees(campaign: &str) -> usize {
    let vehicle = vehicle(campaign, &[]);
    let profile = profile(campaign, &vehicle);
    let sections = sections(campaign);
    for section in &sections {
        let record = section.simulate(&vehicle, &profile).unwrap();
        same_samples(section, &record.distance);
        for (i, (name, unit)) in CHANNELS.iter().enumerate() {
            // Both by our distances: a section's end may fall between a distance and its rounding.
            let ours = section.inside(&record.distance, &record.channels[i]);
            let theirs = section.inside(&record.distance, &section.recorded[1 + i]);
            let force = *unit == "kN";
            let what = format!("{campaign} {} {name}", section.name);
            let (of_median, of_sample, matters) = if force {
                (0.01, 0.04, 1.0)
            } else {
                (if name.starts_with("ayb") { 0.002 } else { 0.001 }, 0.006, 0.05)
            };
            let (a, b) = (median(&ours), median(&theirs));
            assert!((a - b).abs() <= of_median, "{what}: median {a}, recorded {b}");
            assert!(
                b.abs() < matters || (a / b - 1.0).abs() < 0.02,
                "{what}: median {a}, recorded {b}"
            );
            let (a, b) = (deviation(&ours), deviation(&theirs));
            assert!(
                b < matters || (a / b - 1.0).abs() < 0.01,
                "{what}: standard deviation {a}, recorded {b}"
            );
            for (a, b) in ours.iter().zip(&theirs) {
                assert!((a - b).abs() <= of_sample, "{what}: {a}, recorded {b}");
            }
        }
    }
    sections.len()
}

/// The records begin and end at the same samples, to the three decimals of the file.
fn same_samples(section: &Section, distance: &[f64]) {
    let recorded = &section.recorded[0];
    assert_eq!(recorded.len(), distance.len(), "{}", section.name);
    assert!(
        recorded.iter().zip(distance).all(|(a, b)| (a - b).abs() <= 5.1e-4),
        "{}",
        section.name
    );
}

#[test]
fn the_coach() {
    assert_eq!(agrees(COACH), 13);
}

#[test]
fn the_coach_on_other_tracks() {
    assert!(agrees("examples/coach-good") >= 10);
}

#[test]
fn the_freight_wagon() {
    assert_eq!(agrees(WAGON), 1);
}
