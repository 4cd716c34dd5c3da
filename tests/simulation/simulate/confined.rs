//! Effects that act in some of the sections.

use std::fs;

use super::{Place, SECTIONS};

/// The sections whose records differ between two campaigns.
fn changed(place: &Place, a: &str, b: &str) -> Vec<&'static str> {
    let bytes = |out: &str, section: &str| {
        fs::read(place.path(&format!("{out}/simulation/{section}.csv"))).expect("written")
    };
    SECTIONS.into_iter().filter(|section| bytes(a, section) != bytes(b, section)).collect()
}

#[test]
fn to_zones_directions_and_sections() {
    let place = Place::new();
    place.simulated("plain", &[]);
    for (n, (effect, expected)) in [
        ("friction=0.6 in zones 3, 4", vec!["S10", "S13"]),
        ("friction=0.6 in zone 2", vec!["S06"]),
        ("friction=0.6 in direction left", vec!["S06"]),
        ("friction=0.6 in directions left, straight", vec!["S01", "S06"]),
        ("friction=0.6 in sections S01, S13", vec!["S01", "S13"]),
        ("sensor_gain=0.8 on Y_1R in zone 4", vec!["S13"]),
        ("friction=0.6", SECTIONS.to_vec()),
    ]
    .into_iter()
    .enumerate()
    {
        let out = format!("out{n}");
        place.simulated(&out, &["--effect", effect]);
        assert_eq!(changed(&place, "plain", &out), expected, "{effect}");
    }
}

/// One effect may have different sizes in different sections.
#[test]
fn sizes_by_zone() {
    let place = Place::new();
    place.simulated(
        "both",
        &["--effect", "friction=0.6 in zone 3", "--effect", "friction=0.2 in zone 4"],
    );
    place.simulated("high", &["--effect", "friction=0.6"]);
    place.simulated("low", &["--effect", "friction=0.2"]);
    assert_eq!(changed(&place, "both", "high"), ["S01", "S06", "S13"]);
    assert_eq!(changed(&place, "both", "low"), ["S01", "S06", "S10"]);
}

#[test]
fn to_nothing_is_a_slip() {
    let place = Place::new();
    for (effect, words) in [
        (
            "friction=0.2 in zones 3, 7",
            ["`7`, but no section has this value", "known here: 1, 2, 3, 4"],
        ),
        ("friction=0.2 in direction lefft", ["`lefft`", "did you mean `left`?"]),
        ("friction=0.2 in section S06b", ["`S06b`", "did you mean `S06`?"]),
        ("friction=0.2 in zones ", ["confined", "in zones 3, 4"]),
    ] {
        let ran = place.simulate("out", &["--effect", effect]);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        assert!(words.iter().all(|word| ran.stderr.contains(word)), "{effect}: {}", ran.stderr);
    }
}
