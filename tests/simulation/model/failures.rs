//! Runs that come to no result say what happened, when and where.

use fishplate::model::{Failure, FailureKind, Profile, Setup, Window, simulate};

use crate::model::common::{COACH, curve, even, profile, profile_table, vehicle};

fn fails(set: &[(&str, f64)], radius: f64, speed: f64) -> Failure {
    let vehicle = vehicle(COACH, set);
    let profile = profile(COACH, &vehicle);
    let track = curve(radius, 0.0);
    let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed };
    let Err(failure) = simulate(&setup, Window::around(210.0, 310.0), 1.into()) else {
        panic!("a record")
    };
    let words = failure.to_string();
    assert!(failure.time.is_finite() && failure.distance.is_finite(), "{words}");
    assert!(
        words.contains(&format!(
            "{:.3} s after the start, at {:.1} m",
            failure.time, failure.distance
        )),
        "{words}"
    );
    assert!(!words.contains("NaN"), "{words}");
    failure
}

/// Far too fast in a small curve: a wheelset climbs out of the contact table, in the curve and not
/// before it.
#[test]
fn derailment_in_a_curve() {
    let failure = fails(&[], 200.0, 45.0);
    let FailureKind::Derailed { wheelset, displacement } = failure.kind else {
        panic!("{failure}")
    };
    assert!((1..=4).contains(&wheelset) && displacement > 0.011, "{failure}");
    assert!((40.0..345.0).contains(&failure.distance), "{failure}");
}

/// Dampers far too stiff for the step: the motion grows without bound, and that is said instead of
/// written.
#[test]
fn divergence() {
    let failure = fails(&[("primary.cz", 1e8)], 300.0, 20.0);
    assert!(
        matches!(failure.kind, FailureKind::Diverged | FailureKind::Derailed { .. }),
        "{failure}"
    );
}

/// Hunting wider than the contact table: at 240 km/h without yaw dampers the wheelsets swing by 6
/// mm, and this table ends at 2.5 mm. Started by a kink in the track.
#[test]
fn hunting_beyond_the_table() {
    let vehicle = vehicle(COACH, &[("secondary.yaw_damper_remaining", 0.0)]);
    let mut table = profile_table(COACH);
    let inside: Vec<usize> =
        (0..table.displacement.len()).filter(|i| table.displacement[*i].abs() <= 2.5).collect();
    let cut = |values: &mut Vec<f64>| *values = inside.iter().map(|i| values[*i]).collect();
    cut(&mut table.displacement);
    table.radius_deviation.iter_mut().chain(&mut table.contact_angle).for_each(cut);
    let profile = Profile::new(&table, None, &vehicle).unwrap();
    let mut track =
        even(&[(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (40.0, 0.0, 0.0), (2000.0, 0.0, 0.0)]);
    track.alignment[1] = 5.0;
    let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed: 240.0 / 3.6 };
    let Err(failure) = simulate(&setup, Window::around(1000.0, 1500.0), 1.into()) else {
        panic!("a record")
    };
    let FailureKind::Derailed { displacement, .. } = failure.kind else { panic!("{failure}") };
    assert!(displacement.is_finite() && failure.distance > 0.0 && failure.time > 0.0, "{failure}");
}

/// A record that would begin before its run.
#[test]
fn too_early() {
    let vehicle = vehicle(COACH, &[]);
    let profile = profile(COACH, &vehicle);
    let track = curve(300.0, 100.0);
    let setup = Setup { vehicle: &vehicle, profile: &profile, track: &track, speed: 20.0 };
    let Err(failure) = simulate(&setup, Window::around(-100.0, 50.0), 1.into()) else {
        panic!("a record")
    };
    // The run starts at 9.5 + 1.28 - 2.5 * 20 m.
    assert!(
        matches!(failure.kind, FailureKind::TooEarly { by } if (by - (136.0 - 39.22)).abs() < 1e-9),
        "{failure}"
    );
}
