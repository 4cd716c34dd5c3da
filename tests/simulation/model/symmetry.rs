//! What must not matter: left and right, and running again.

use fishplate::model::{CHANNELS, Setup, TrackTable, simulate};

use crate::model::common::{COACH, channel, profile, section, vehicle};

fn negated(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| -value).collect()
}

/// The mirrored track gives the mirrored record: Y of the sides exchanged with the other sign, Q
/// exchanged, lateral accelerations negated, vertical ones the same. The contact table is symmetric
/// to its last digit; within 1e-6 kN and m/s^2.
#[test]
fn mirrored_track_gives_the_mirrored_record() {
    let section = section(COACH, "S13");
    let vehicle = vehicle(COACH, &[]);
    let profile = profile(COACH, &vehicle);
    let mirrored = TrackTable {
        curvature: negated(&section.track.curvature),
        cant: negated(&section.track.cant),
        alignment: negated(&section.track.alignment),
        cross_level: negated(&section.track.cross_level),
        ..section.track.clone()
    };
    let run = |track: &TrackTable| {
        let setup = Setup { vehicle: &vehicle, profile: &profile, track, speed: section.speed };
        simulate(&setup, section.window(), 1.into()).unwrap()
    };
    let (there, here) = (run(&section.track), run(&mirrored));
    for (i, (name, _)) in CHANNELS.iter().enumerate() {
        let other = match name.as_bytes()[name.len() - 1] {
            b'R' => channel(&name.replace('R', "L")),
            b'L' => channel(&name.replace('L', "R")),
            _ => i,
        };
        let sign = if name.starts_with('Q') || name.starts_with("az") { 1.0 } else { -1.0 };
        for (a, b) in there.channels[i].iter().zip(&here.channels[other]) {
            assert!((a - sign * b).abs() < 1e-6, "{name}: {a} {b}");
        }
    }
}

/// The same run gives the same bits, also beside other runs.
#[test]
fn runs_repeat_bit_for_bit() {
    let section = section(COACH, "S14");
    let vehicle = vehicle(COACH, &[]);
    let profile = profile(COACH, &vehicle);
    let alone = section.simulate(&vehicle, &profile).unwrap();
    let beside: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> =
            (0..3).map(|_| scope.spawn(|| section.simulate(&vehicle, &profile).unwrap())).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    let bits = |record: &fishplate::model::Record| {
        record.channels.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    assert!(beside.iter().all(|record| bits(record) == bits(&alone)));
    assert!(alone.channels.iter().flatten().all(|value| value.is_finite()));
}
