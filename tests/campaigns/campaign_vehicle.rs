//! What a campaign says beside its records, end to end: vehicle data with units, sections measured
//! again, sections that are refused, and where the simulation comes from.

use std::fs;
use std::path::Path;

use crate::common::campaign::{lines, replace, tiny};
use crate::common::program::{Certified, certify, program, ran};
use serde_json::Value;

const RESULTS: [&str; 2] = ["--only", "results"];

fn with(change: impl FnOnce(&Path)) -> Certified {
    let folder = tiny();
    change(folder.path());
    certify(folder.path(), &RESULTS)
}

fn load(text: &str) -> Certified {
    with(|campaign| {
        replace(
            &campaign.join("vehicle.yaml"),
            "static_wheel_load: 50",
            &format!("static_wheel_load: {text}"),
        )
    })
}

/// The findings of a code.
fn findings(found: &Certified, code: &str) -> Vec<Value> {
    let results = found.results();
    results["findings"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|finding| finding["code"] == code)
        .cloned()
        .collect()
}

#[test]
fn a_unit_of_vehicle_data_is_converted_and_a_missing_one_is_told() {
    let bare = load("50");
    let [assumed] = &findings(&bare, "unit-assumed")[..] else {
        panic!("{}", bare.results()["findings"])
    };
    assert_eq!(
        assumed["says"],
        "the vehicle file states no unit; read in the unit of the protocol: static_wheel_load = 50 kN"
    );
    assert_eq!(assumed["consequence"], "note");
    assert!(
        bare.text("tables/vehicle.csv").contains("Static vertical wheel force,50,kN,true,true"),
        "{}",
        bare.text("tables/vehicle.csv")
    );
    for stated in ["50 kN", "50000 N", "'50 [kN]'", "5e4 N", "0.05 MN"] {
        let found = load(stated);
        assert!(findings(&found, "unit-assumed").is_empty(), "{stated}");
        assert_eq!(found.results()["quantities"], bare.results()["quantities"], "{stated}");
        assert!(
            found
                .text("tables/vehicle.csv")
                .contains("Static vertical wheel force,50,kN,false,true"),
            "{stated}"
        );
    }
}

#[test]
fn a_load_that_is_none_is_an_error_at_its_place() {
    for (written, says, help) in [
        (
            "5.56 t",
            "`5.56 t` is a mass, not a force (in kN)",
            "a mass of 5.56 t weighs 54.52497 kN",
        ),
        (
            "50000",
            "50000 kN is outside the range of the protocol, 10 kN to 200 kN",
            "write `50000 N` if that is meant",
        ),
        (
            "50 N",
            "0.05 kN is outside the range of the protocol, 10 kN to 200 kN",
            "give its value with the unit",
        ),
        (
            "0",
            "0 kN is outside the range of the protocol, 10 kN to 200 kN",
            "give its value with the unit",
        ),
        (
            "-50 kN",
            "-50 kN is outside the range of the protocol, 10 kN to 200 kN",
            "give its value with the unit",
        ),
        (
            "400 kN",
            "400 kN is outside the range of the protocol, 10 kN to 200 kN",
            "give its value with the unit",
        ),
        (
            "5.1",
            "5.1 kN is outside the range of the protocol, 10 kN to 200 kN",
            "give its value with the unit",
        ),
        (
            "50,5 kN",
            "`50,5 kN` has a decimal comma; numbers are written with a point",
            "write `50.5 kN`",
        ),
        ("50 kn", "`kn` is not a known unit", "did you mean `kN`?"),
        ("heavy", "`heavy` is not a number (in kN)", ""),
    ] {
        let found = load(written);
        assert_eq!(found.ran.code, 2, "{written}: {}", found.ran.stdout);
        for part in ["error[vehicle-data]: `static_wheel_load`: ", says, help, "vehicle.yaml:5:"] {
            assert!(
                found.ran.stderr.contains(part),
                "{written}: `{part}` is not in\n{}",
                found.ran.stderr
            );
        }
    }
}

#[test]
fn limits_that_the_vehicle_doubles_are_told_with_the_reason() {
    let told = |from: &str, to: &str| {
        let found = with(|campaign| replace(&campaign.join("vehicle.yaml"), from, to));
        let told: Vec<String> = findings(&found, "limit-factor")
            .iter()
            .map(|finding| finding["says"].to_string())
            .collect();
        (told, found)
    };
    let (none, _) = told("passenger", "locomotive");
    assert!(none.is_empty(), "{none:?}");
    let (freight, found) = told("passenger", "freight");
    assert_eq!(
        freight,
        [
            "\"the limits of ay_rms, az_rms, ay_max, az_max are doubled, because vehicle category is freight\""
        ]
    );
    assert!(
        found.ran.stdout.contains("are doubled, because vehicle category is freight"),
        "{}",
        found.ran.stdout
    );
    let statistic = &found.results()["quantities"][8]["statistics"][0];
    assert_eq!(
        statistic["factors"],
        serde_json::json!([{
            "by": 2.0,
            "because": "vehicle category is freight",
            "because_data": {
                "code": "vehicle-data",
                "data": [{"name": "Vehicle category", "value": "freight", "unit": null}],
            },
        }])
    );
    let (rigid, _) = told("secondary_suspension: true", "secondary_suspension: false");
    assert_eq!(
        rigid,
        [
            "\"the limits of ay_rms, az_rms, ay_max, az_max are doubled, because secondary suspension is false\""
        ]
    );
}

/// Writes the records of a section once more under another name, with the cells of its row and one
/// more.
fn measured_again(campaign: &Path, of: &str, name: &str) {
    for kind in ["measurement", "simulation"] {
        fs::copy(
            campaign.join(format!("{kind}/{of}.csv")),
            campaign.join(format!("{kind}/{name}.csv")),
        )
        .expect("copied");
    }
    // What is measured again is not the same to the last digit: that would be a copy, and told as
    // one.
    lines(&campaign.join(format!("measurement/{name}.csv")), |lines| {
        for line in lines.iter_mut().skip(1) {
            let changed = line.split(',').enumerate().map(|(at, cell)| match cell.parse::<f64>() {
                Ok(value) if at >= 2 => format!("{:.6}", 1.0001 * value),
                _ => cell.to_string(),
            });
            *line = changed.collect::<Vec<_>>().join(",");
        }
    });
    lines(&campaign.join("sections.csv"), |lines| {
        let row =
            lines.iter().find(|line| line.starts_with(&format!("{of},"))).expect("a row").clone();
        if !lines[0].ends_with(",repeat of") {
            lines
                .iter_mut()
                .enumerate()
                .for_each(|(at, line)| line.push_str(if at == 0 { ",repeat of" } else { "," }));
        }
        lines.push(format!("{},{of}", row.replacen(of, name, 1).trim_end_matches(',')));
    });
}

#[test]
fn a_repeat_does_not_raise_n_nor_narrow_an_interval_nor_fill_a_zone() {
    let once = with(|_| {});
    let twice = with(|campaign| {
        ["S01", "S02", "S03"]
            .iter()
            .for_each(|of| measured_again(campaign, of, &format!("{of}again")))
    });
    let quantity = |found: &Certified| found.results()["quantities"][0].clone();
    assert_eq!(
        (quantity(&once)["pairs"].as_u64(), quantity(&once)["n"].as_u64()),
        (Some(48), Some(12))
    );
    assert_eq!(
        (quantity(&twice)["pairs"].as_u64(), quantity(&twice)["n"].as_u64()),
        (Some(60), Some(12))
    );
    assert_eq!(twice.results()["zones"][0]["sites"], 3);
    // A zone with two sites, one of them measured twice, has too few, however many sections it has.
    let filled = with(|campaign| {
        lines(&campaign.join("sections.csv"), |lines| {
            lines.retain(|line| !line.starts_with("S03,"))
        });
        measured_again(campaign, "S02", "S02again");
    });
    assert_eq!(filled.results()["verdict"], "not assessable");
    assert_eq!(
        filled.results()["reasons"][0],
        "zone 1 has 3 usable sections of 2 sites (a repeat is no further section); at least 3 required"
    );
    // All sites measured twice, with the same result: as many pairs again, and the same interval of
    // the mean.
    let all = with(|campaign| {
        (1..=12).for_each(|at| {
            measured_again(campaign, &format!("S{at:02}"), &format!("S{at:02}again"))
        })
    });
    for (before, after) in [(&quantity(&once), &quantity(&all))] {
        for (a, b) in before["statistics"]
            .as_array()
            .expect("a list")
            .iter()
            .zip(after["statistics"].as_array().expect("a list"))
        {
            assert_eq!(
                (a["n"].as_u64(), b["n"].as_u64(), b["count"].as_u64()),
                (Some(12), Some(12), Some(96))
            );
            let width = |of: &Value| {
                of["interval"][1].as_f64().expect("an end")
                    - of["interval"][0].as_f64().expect("an end")
            };
            // The standard deviation has the divisor n - 1 of the pairs, which are twice as many.
            assert!(width(b) > 0.98 * width(a), "{} and {}", width(a), width(b));
        }
    }
    let wrong = with(|campaign| {
        measured_again(campaign, "S01", "S01again");
        replace(&campaign.join("sections.csv"), ",S01\n", ",S1\n");
    });
    assert_eq!(wrong.ran.code, 2);
    assert!(
        wrong.ran.stderr.contains("error[unknown-section]: `repeat of` names `S1`"),
        "{}",
        wrong.ran.stderr
    );
}

/// A section that its records show to be unusable is evaluated, and then counts nowhere.
#[test]
fn a_refused_section_is_not_pooled() {
    let set = ["--only", "results", "--set", "sections_per_zone=2"];
    let track = |campaign: &Path, bent: bool| {
        fs::create_dir_all(campaign.join("track")).expect("made");
        for at in 1..=12 {
            let name = format!("S{at:02}");
            let curvature = |x: u32| if bent && name == "S05" { f64::from(x) * 1e-5 } else { 1e-3 };
            let rows: String = (0..=400).map(|x| format!("{x},{}\n", curvature(x))).collect();
            fs::write(
                campaign.join(format!("track/{name}.csv")),
                format!("distance [m],curvature [1/m]\n{rows}"),
            )
            .expect("written");
        }
        let file = campaign.join("campaign.yaml");
        fs::write(&file, fs::read_to_string(&file).expect("readable") + "track: track\n")
            .expect("written");
    };
    let folder = tiny();
    track(folder.path(), true);
    // Were it pooled, its tenfold lateral forces would show.
    lines(&folder.path().join("measurement/S05.csv"), |lines| {
        let at = lines[0].split(',').position(|heading| heading == "Y_1R [kN]").expect("a channel");
        for line in lines.iter_mut().skip(1) {
            let mut cells: Vec<String> = line.split(',').map(str::to_string).collect();
            cells[at] = format!("{:.2}", 10.0 * cells[at].parse::<f64>().expect("a number"));
            *line = cells.join(",");
        }
    });
    let refused = certify(folder.path(), &set);
    let reason = refused.reason("S05").expect("refused");
    assert!(reason.starts_with("section lies in full curve"), "{reason}");
    let folder = tiny();
    track(folder.path(), false);
    lines(&folder.path().join("sections.csv"), |lines| {
        lines.retain(|line| !line.starts_with("S05,"))
    });
    let without = certify(folder.path(), &set);
    assert_eq!(refused.results()["quantities"], without.results()["quantities"]);
    assert_eq!(refused.results()["domain"], without.results()["domain"]);
}

/// An origin as `diagnose --write-improved` writes it.
fn origin(campaign: &Path, fitted_to: &str) {
    let file = campaign.join("campaign.yaml");
    fs::write(&file, fs::read_to_string(&file).expect("readable") + "origin: origin.yaml\n")
        .expect("written");
    let hash = fishplate::data::hash::sha256(
        &fs::read(campaign.join("measurement/S01.csv")).expect("readable"),
    );
    let text = format!(
        "program: fishplate 0.1.0\ncommand: diagnose\neffects:\n- effect: friction\n  parameters:\n  - name: friction\n    value: 0.2304\n    \
         unit: \"-\"\n{}sources: []\n",
        fitted_to.replace("HASH", &hash)
    );
    fs::write(campaign.join("origin.yaml"), text).expect("written");
}

const FITTED: &str = "fitted to:\n- path: measurement/S01.csv\n  sha256: \"HASH\"\n";

#[test]
fn a_simulation_fitted_to_the_same_measurement_says_so_beside_the_verdict() {
    let folder = tiny();
    origin(folder.path(), FITTED);
    let found = certify(folder.path(), &["--only", "html"]);
    assert_eq!(found.ran.code, 0, "{}", found.ran.stderr);
    let results = found.results();
    assert_eq!(results["verdict"], "validated");
    assert_eq!(results["verdict_note"], "with a simulation fitted to the same measurements");
    assert!(
        found.ran.stdout.contains(
            "Verdict: validated, provisional: 4 values not confirmed, with a simulation fitted"
        ),
        "{}",
        found.ran.stdout
    );
    let says = "The simulated records were written by fishplate 0.1.0, diagnose, with the effect friction = 0.23, fitted to the same 1 measured \
                records (origin of the campaign)";
    assert!(found.ran.stdout.contains(says), "{}", found.ran.stdout);
    let html = found.text("report.html");
    assert!(
        html.contains("with a simulation fitted to the same measurements") && html.contains(says)
    );
    assert!(!html.contains("not changed after the comparison"));
    assert!(
        results["campaign"]["files"]
            .as_array()
            .expect("a list")
            .iter()
            .any(|file| file["path"] == "origin.yaml")
    );
}

#[test]
fn effects_that_were_not_fitted_are_named_beside_the_verdict() {
    let note = |fitted_to: &str| {
        let found = with(|campaign| origin(campaign, fitted_to));
        found.results()["verdict_note"].clone()
    };
    assert_eq!(note(""), "simulation with effect friction = 0.23");
    let other = FITTED.replace("HASH", &"0".repeat(64));
    assert_eq!(
        note(&other),
        "simulation with effect friction = 0.23, fitted to other measurements"
    );
    let plain = certify(tiny().path(), &["--only", "html"]);
    assert_eq!(plain.results()["verdict_note"], Value::Null);
    assert!(plain.text("report.html").contains("not changed after the comparison"));
}

#[test]
fn an_origin_that_cannot_be_read_is_an_error() {
    let found = with(|campaign| {
        origin(campaign, "");
        fs::write(campaign.join("origin.yaml"), "effects: friction\n").expect("written");
    });
    assert_eq!(found.ran.code, 2);
    assert!(
        found.ran.stderr.contains("error[wrong-kind]: `effects` must be a list")
            && found.ran.stderr.contains("origin.yaml:1:")
    );
    let outside = with(|campaign| {
        origin(campaign, "");
        replace(&campaign.join("campaign.yaml"), "origin: origin.yaml", "origin: ../origin.yaml");
    });
    assert_eq!(outside.ran.code, 2, "{}", outside.ran.stderr);
}

/// A vehicle file in other units makes the same simulation, byte by byte; a wrong one is refused at
/// its place.
#[test]
fn the_vehicle_model_reads_units_too() {
    let coach = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach");
    let folder = tempfile::tempdir().expect("a folder");
    for file in ["vehicle.yaml", "profile.csv", "profile_worn.csv"] {
        fs::copy(coach.join(file), folder.path().join(file)).expect("copied");
    }
    let simulate = |out: &str| {
        let track = coach.join("track/S13.csv");
        let mut command = program();
        command.current_dir(folder.path()).args([
            "simulate",
            "--vehicle",
            "vehicle.yaml",
            "--speed",
            "72 km/h",
            "-o",
            out,
        ]);
        ran(command.arg("--track").arg(track))
    };
    assert_eq!(simulate("plain.csv").code, 0);
    let vehicle = folder.path().join("vehicle.yaml");
    replace(&vehicle, "  mass: 32000.0 kg", "  mass: 32 t");
    replace(&vehicle, "half_bogie_spacing: 9.5 m", "half_bogie_spacing: 9500 mm");
    replace(&vehicle, "  kx: 1.2e+7 N/m", "  kx: 12 kN/mm");
    let stated = simulate("stated.csv");
    assert_eq!(stated.code, 0, "{}", stated.stderr);
    let read = |name: &str| fs::read(folder.path().join(name)).expect("readable");
    assert_eq!(read("plain.csv"), read("stated.csv"));
    replace(&vehicle, "  mass: 32 t", "  mass: 314 kN");
    let wrong = simulate("wrong.csv");
    assert_eq!(wrong.code, 2, "{}", wrong.stderr);
    assert!(
        wrong.stderr.contains(
            "`car_body.mass` (mass of the car body): `314 kN` is a force, not a mass (in kg)"
        ),
        "{}",
        wrong.stderr
    );
    assert!(wrong.stderr.contains("vehicle.yaml:"), "{}", wrong.stderr);
}
