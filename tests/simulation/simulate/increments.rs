//! Effects added to records that another simulator made.

use super::{ACCELERATION, FORCE, Place, SECTIONS, apart, channel};

/// Where the model itself made the recorded simulation, recorded + (with - without) is the
/// simulation with the effect, within the digits that are written.
#[test]
fn on_the_models_own_records_they_are_direct_simulations() {
    let place = Place::new();
    place.simulated("plain", &[]);
    for section in SECTIONS {
        let record = format!("simulation/{section}.csv");
        place.write(&format!("small/{record}"), &place.text(&format!("plain/{record}")));
    }
    let effects = [
        "--effect",
        "friction=0.5",
        "--effect",
        "payload=4 t",
        "--effect",
        "sensor_gain=1.2 on Y_1R",
    ];
    place.simulated("direct", &effects);
    place.simulated("increment", &[&effects[..], &["--increment"]].concat());
    for section in SECTIONS {
        let [plain, direct, increment] =
            ["plain", "direct", "increment"].map(|out| place.record(out, section));
        for known in &direct.channels {
            let digit = if known.name.starts_with('a') { ACCELERATION } else { FORCE };
            let off = apart(&known.values, channel(&increment, &known.name));
            // The recorded value was rounded, scaled by the gain, and the sum is rounded again.
            // Positions are written to 1 mm: the difference is taken half a millimetre beside its
            // place at most.
            let added: Vec<f64> = known
                .values
                .iter()
                .zip(channel(&plain, &known.name))
                .map(|(with, without)| with - without)
                .collect();
            let steepest =
                added.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            let beside = 0.0005 / (direct.axis[1] - direct.axis[0]);
            assert!(
                off <= 2.3 * digit + 1.2 * beside * steepest,
                "{section} {}: {off}",
                known.name
            );
        }
    }
}

/// What the model lacks, and what the recorded simulation has of its own, stays.
#[test]
fn what_the_records_have_of_their_own_stays() {
    let place = Place::new();
    for section in SECTIONS {
        let inside = format!("small/simulation/{section}.csv");
        let text = place.text(&inside);
        let mut lines = text.lines();
        let mut made = format!("{},strain [-]\n", lines.next().expect("a header"));
        for (n, line) in lines.enumerate() {
            made += &format!("{line},{}\n", n % 7);
        }
        place.write(&inside, &made);
    }
    place.simulated("increment", &["--increment", "--effect", "friction=0.5"]);
    let record = place.record("increment", "S13");
    assert!(
        channel(&record, "strain").iter().enumerate().all(|(n, value)| *value == (n % 7) as f64)
    );
    let before = super::signals(&place.path("small/simulation/S13.csv"));
    assert!(
        apart(channel(&record, "Y_1L"), channel(&before, "Y_1L")) > 1.0,
        "friction moves the guiding force"
    );
}

/// Without an effect of the simulator nothing is run and nothing changes but the measuring chain.
#[test]
fn without_effects_the_records_come_back() {
    let place = Place::new();
    place.simulated("same", &["--increment"]);
    for section in SECTIONS {
        assert!(place.record("same", section) == place.record("small", section), "{section}");
    }
}

/// Forces recorded in N get the same increment as forces in kN.
#[test]
fn records_in_other_units() {
    let place = Place::new();
    place.simulated("kilonewton", &["--increment", "--effect", "friction=0.5"]);
    for section in SECTIONS {
        let inside = format!("small/simulation/{section}.csv");
        let text = place.text(&inside);
        let mut made = text.lines().next().expect("a header").replace("[kN]", "[N]") + "\n";
        for line in text.lines().skip(1) {
            let cells = line.split(',').enumerate().map(|(n, cell)| {
                // Time, distance, sixteen forces, accelerations.
                if (2..18).contains(&n) {
                    format!("{:.0}", 1e3 * cell.parse::<f64>().expect("a number"))
                } else {
                    cell.to_string()
                }
            });
            made += &(cells.collect::<Vec<_>>().join(",") + "\n");
        }
        place.write(&inside, &made);
    }
    place.simulated("newton", &["--increment", "--effect", "friction=0.5"]);
    for section in SECTIONS {
        let (a, b) = (place.record("kilonewton", section), place.record("newton", section));
        assert!(apart(channel(&a, "Y_1L"), channel(&b, "Y_1L")) < 0.0101, "{section}");
    }
}

/// The tolerance of the baseline is that of the model where no simulator is given.
#[test]
fn the_baseline() {
    let place = Place::new();
    let ran = place.simulated("out", &["--baseline"]);
    assert!(
        ran.stderr.contains("baseline: reference vehicle model deviates")
            && !ran.stderr.contains("warning"),
        "{}",
        ran.stderr
    );
    place.replace("small/vehicle.yaml", "mass: 32000.0", "mass: 40000.0");
    let ran = place.simulated("heavy", &["--baseline"]);
    for word in [
        "warning[baseline]",
        "does not reproduce the campaign's simulation",
        "channels deviate by more than 5 %",
    ] {
        assert!(ran.stderr.contains(word), "`{word}` is not in {}", ran.stderr);
    }
}
