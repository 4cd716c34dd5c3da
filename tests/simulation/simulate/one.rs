//! One vehicle on one track: right, and each of its inputs wrong.

use std::fs;

use super::program::{Ran, program, ran};
use super::{Place, apart, channel, signals};

/// `simulate --vehicle small/vehicle.yaml --track small/track/S10.csv` in a place.
#[track_caller]
fn one(place: &Place, more: &[&str]) -> Ran {
    let fixed = [
        "simulate",
        "--vehicle",
        "small/vehicle.yaml",
        "--track",
        "small/track/S10.csv",
        "-o",
        "out.csv",
    ];
    let ran = ran(program().current_dir(place.path("")).args(fixed).args(more));
    assert_eq!(place.path("out.csv").exists(), ran.code == 0, "{}", ran.stderr);
    ran
}

/// The call fails with this code and these words, and writes nothing.
#[track_caller]
fn refused(place: &Place, more: &[&str], code: i32, words: &[&str]) {
    let ran = one(place, more);
    assert_eq!(ran.code, code, "{}", ran.stderr);
    for word in words {
        assert!(ran.stderr.contains(word), "`{word}` is not in:\n{}", ran.stderr);
    }
}

#[test]
fn a_record_is_written() {
    let place = Place::new();
    let ran = one(&place, &["--speed", "77.6 km/h"]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let made = signals(&place.path("out.csv"));
    assert_eq!(made.channels.len(), 22);
    assert!((made.rate - 200.0).abs() < 1e-6);
    let metres = 77.6 / 3.6 / 200.0;
    assert!(
        made.axis.windows(2).all(|pair| (pair[1] - pair[0] - metres).abs() < 0.0011),
        "a constant speed"
    );
}

#[test]
fn speeds() {
    let place = Place::new();
    one(&place, &["--speed", "77.6 km/h"]);
    let kmh = fs::read(place.path("out.csv")).expect("written");
    fs::remove_file(place.path("out.csv")).expect("removed");
    let metres = (77.6_f64 / 3.6).to_string();
    one(&place, &["--speed", &metres]);
    assert_eq!(
        kmh,
        fs::read(place.path("out.csv")).expect("written"),
        "77.6 km/h and {metres} m/s"
    );
    fs::remove_file(place.path("out.csv")).expect("removed");
    refused(&place, &[], 2, &["speed-missing", "--speed 30"]);
    refused(&place, &["--speed", "fast"], 2, &["`fast` is not a number (in m/s)"]);
    refused(&place, &["--speed", "30 kmh"], 2, &["`kmh` is not a known unit"]);
    refused(&place, &["--speed", "30 kN"], 2, &["error[speed]"]);
    refused(&place, &["--speed", "700 km/h"], 2, &["194.4 m/s is outside", "1 to 150 m/s"]);
}

#[test]
fn effects_that_are_none() {
    let place = Place::new();
    let wrong = |effect: &str, words: &[&str]| {
        refused(&place, &["--speed", "22", "--effect", effect], 2, words)
    };
    wrong("fricton=0.5", &["unknown-effect", "did you mean `friction`?"]);
    wrong("payload.payload.mas=1000", &["unknown-parameter", "did you mean `payload.mass`?"]);
    wrong("friction=2", &["range", "2 is outside the range of `friction`: 0.05 to 0.7"]);
    wrong("payload=20 t", &["range", "0 to 15000 kg"]);
    wrong("payload=3 kN", &["unit-mismatch", "`payload.mass` is in kg, not in kN"]);
    wrong("payload=3 tonnes", &["unknown-unit", "`tonnes` is not a known unit"]);
    wrong("friction=much", &["wrong-kind", "`much` is not a number"]);
    wrong("friction=1e999", &["wrong-kind", "`1e999` is not a number"]);
    wrong("friction=0.5 on Y_1R", &["acts on the environment, not on channels"]);
    wrong("sensor_gain=0.8", &["channel-missing", "sensor_gain=0.8 on Y_1R"]);
    wrong("sensor_gain=0.8 on Y_9R", &["unknown-channel", "`Y_9R`"]);
    wrong("sensor_gain.measurement.gain.Y_1S=0.8", &["unknown-channel", "Y_1S"]);
    wrong("channel_swap", &["channel-missing", "exchanges two channels"]);
    wrong("channel_swap=1 on Y_1R", &["channel-missing", "exchanges two channels"]);
    wrong("friction=0.2 in zones 3", &["no-such-section", "only one record is simulated"]);
    wrong("friction=0.2 in places 3", &["unknown-word", "in zones 3, 4"]);
}

/// Two values of one parameter: the second does not silently replace the first.
#[test]
fn an_effect_that_is_given_twice() {
    let place = Place::new();
    refused(
        &place,
        &["--speed", "22", "--effect", "friction=0.3", "--effect", "friction=0.4"],
        2,
        &["duplicate-effect", "given twice"],
    );
}

/// Several faults are told at once, each with its place in what was written.
#[test]
fn all_faults_at_once() {
    let place = Place::new();
    let ran = one(&place, &["--speed", "22", "--effect", "friction=2", "--effect", "paylod=3"]);
    assert!(
        ran.stderr.contains("2 errors") && ran.stderr.contains("--effect:1:1"),
        "{}",
        ran.stderr
    );
}

#[test]
fn files_that_are_wrong() {
    let place = Place::new();
    let speed = ["--speed", "22"];
    let track = place.text("small/track/S10.csv");
    let line = track.lines().nth(41).expect("a line").to_string();
    let cells: Vec<&str> = line.split(',').collect();
    place.replace("small/track/S10.csv", &line, &line.replacen(cells[3], "NaN", 1));
    refused(&place, &speed, 2, &["not-finite", "small/track/S10.csv:42:"]);
    place.write("small/track/S10.csv", &track.replace("cant [mm]", "camber [mm]"));
    refused(&place, &speed, 2, &["unknown-channel", "`cant`"]);
    place.write("small/track/S10.csv", &track.replace("cant [mm]", "cant [kN]"));
    refused(&place, &speed, 2, &["unit-mismatch", "small/track/S10.csv:1:"]);
    let mut lines: Vec<&str> = track.lines().collect();
    lines.swap(20, 21);
    place.write("small/track/S10.csv", &(lines.join("\n") + "\n"));
    refused(&place, &speed, 2, &["not-increasing", "small/track/S10.csv:22:"]);
    place.write("small/track/S10.csv", &track);

    let vehicle = place.text("small/vehicle.yaml");
    place.replace("small/vehicle.yaml", "  ky: 4.0e+6 N/m\n", "");
    refused(&place, &speed, 2, &["key-missing", "`primary.ky`"]);
    place.write("small/vehicle.yaml", &vehicle.replace("radius: 0.46", "radius: -1"));
    refused(&place, &speed, 2, &["range", "`wheelset.radius` is -1", "small/vehicle.yaml:"]);
    place.write("small/vehicle.yaml", &vehicle);

    fs::rename(place.path("small/profile.csv"), place.path("profile.csv")).expect("moved");
    refused(&place, &speed, 2, &["file-missing", "small/profile.csv"]);
    fs::rename(place.path("profile.csv"), place.path("small/profile.csv")).expect("moved");
    fs::remove_file(place.path("small/profile_worn.csv")).expect("removed");
    refused(
        &place,
        &["--speed", "22", "--effect", "worn_profile=1"],
        2,
        &["a worn profile needs a second profile table"],
    );
    assert_eq!(one(&place, &speed).code, 0, "without wear, one profile is enough");
}

/// A run that diverges is told with time and place; the exit code says that the work could not be
/// done.
#[test]
fn divergence() {
    let place = Place::new();
    let hunting = [
        "--speed",
        "540 km/h",
        "--effect",
        "yaw_damper_loss=0",
        "--effect",
        "worn_profile.profile.conicity_scale=3",
    ];
    refused(&place, &hunting, 3, &["simulation-failed", " s after the start, at ", " m"]);
}

/// An effect at the value that the vehicle file has changes nothing.
#[test]
fn neutral_values_change_nothing() {
    let place = Place::new();
    one(&place, &["--speed", "22"]);
    let plain = signals(&place.path("out.csv"));
    fs::remove_file(place.path("out.csv")).expect("removed");
    one(
        &place,
        &[
            "--speed",
            "22",
            "--effect",
            "friction=0.35",
            "--effect",
            "sensor_gain=1 on forces_of_none",
        ],
    );
    assert!(!place.path("out.csv").exists());
    one(
        &place,
        &[
            "--speed",
            "22",
            "--effect",
            "friction=0.35",
            "--effect",
            "sensor_gain=1 on guiding forces",
        ],
    );
    let same = signals(&place.path("out.csv"));
    for known in &plain.channels {
        assert_eq!(
            apart(&known.values, channel(&same, &known.name)).to_bits(),
            0.0_f64.to_bits(),
            "{}",
            known.name
        );
    }
}
