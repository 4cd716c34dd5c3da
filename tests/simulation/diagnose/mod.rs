//! Diagnoses of campaigns whose truth is known: measurements made by the reference model with an
//! effect and noise.
//!
//! One set of simulations serves all tests: the campaigns differ in their measurements alone.

#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap
)]

mod blind;
mod closed_form;
mod metamorphic;
mod turned;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;

const NOISE: [&str; 2] = [
    "sensor_noise=0.3 on guiding forces, vertical forces",
    "sensor_noise=0.02 on accelerations, bogie accelerations",
];

fn fishplate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fishplate")).args(arguments).output().unwrap()
}

fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diagnose");
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    })
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// `examples/coach-good` with some of its sections, all if none are given, and a measurement that
/// the model made with these effects.
fn campaign(name: &str, effects: &[&str], sections: &[&str]) -> PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good");
    let (nominal, made, to) = (
        folder().join(format!("{name}-nominal")),
        folder().join(format!("{name}-made")),
        folder().join(name),
    );
    copy(&example, &nominal);
    let table = fs::read_to_string(nominal.join("sections.csv")).unwrap();
    let is_kept =
        |line: &str| sections.is_empty() || sections.iter().any(|name| line.starts_with(name));
    let kept = table.lines().enumerate().filter(|(at, line)| *at == 0 || is_kept(line));
    fs::write(
        nominal.join("sections.csv"),
        kept.map(|(_, line)| format!("{line}\n")).collect::<String>(),
    )
    .unwrap();
    let mut arguments =
        vec!["simulate", nominal.to_str().unwrap(), "--out", made.to_str().unwrap(), "--quiet"];
    for effect in effects.iter().chain(&NOISE) {
        arguments.extend(["--effect", effect]);
    }
    let ran = fishplate(&arguments);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    copy(&nominal, &to);
    copy(&made.join("simulation"), &to.join("measurement"));
    to
}

fn diagnose(campaign: &Path, more: &[&str]) -> (Value, Option<i32>) {
    let out = campaign.with_extension("diagnosis");
    let resume = folder().join("resume");
    let mut arguments = vec![
        "diagnose",
        campaign.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
        "--resume",
        resume.to_str().unwrap(),
    ];
    arguments.extend(more);
    let ran = fishplate(&arguments);
    assert!(
        ran.status.code().is_some_and(|code| code <= 1),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    for file in ["report.pdf", "report.html"] {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 10_000, "{file}");
    }
    (
        serde_json::from_str(&fs::read_to_string(out.join("diagnosis.json")).unwrap()).unwrap(),
        ran.status.code(),
    )
}

/// `examples/coach-good` without a track: nothing is simulated, so that a diagnosis takes no time.
fn without_track(name: &str) -> PathBuf {
    let to = folder().join(name);
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good"), &to);
    fs::remove_dir_all(to.join("track")).unwrap();
    let text = fs::read_to_string(to.join("campaign.yaml")).unwrap();
    let text = text
        .lines()
        .filter(|line| !line.starts_with("track:"))
        .fold(String::new(), |all, line| all + line + "\n");
    fs::write(to.join("campaign.yaml"), text).unwrap();
    to
}

/// A declared tolerance that the catalogue does not know, or in a unit that it cannot be in, is
/// told where it stands.
#[test]
fn a_tolerance_that_cannot_be_used_is_told() {
    let to = without_track("tolerances");
    let text = fs::read_to_string(to.join("campaign.yaml")).unwrap();
    let run = |from: &str, into: &str| {
        assert!(text.contains(from), "{text}");
        fs::write(to.join("campaign.yaml"), text.replace(from, into)).unwrap();
        let out = to.with_extension("diagnosis");
        let ran = fishplate(&["diagnose", to.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        (ran.status.code(), String::from_utf8(ran.stderr).unwrap())
    };
    let (code, says) = run("  cant [mm]:", "  cnt [mm]:");
    assert!(code.is_some_and(|code| code <= 1), "{says}");
    assert!(
        says.contains("the catalogue has no tolerance `cnt`")
            && says.contains("did you mean `cant`?"),
        "{says}"
    );
    assert!(says.contains("campaign.yaml:"), "{says}");
    let (code, says) = run("  cant [mm]:", "  cant [kN]:");
    assert_eq!(code, Some(2), "{says}");
    assert!(says.contains("declared in kN") && says.contains("cant [mm]"), "{says}");
}

/// A number of the vehicle file that is none is to be mended; without a track, or with its key
/// misspelt, what can be done is done.
#[test]
fn a_vehicle_that_is_wrong_is_told_and_a_track_that_is_misspelt_pointed_at() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good");
    let to = folder().join("wrong-vehicle");
    copy(&example, &to);
    let run = || {
        let out = to.with_extension("diagnosis");
        let ran = fishplate(&["diagnose", to.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        (ran.status.code(), String::from_utf8(ran.stderr).unwrap(), out)
    };
    let exchange = |file: &str, from: &str, into: &str| {
        let text = fs::read_to_string(example.join(file)).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(to.join(file), text.replacen(from, into, 1)).unwrap();
    };
    exchange("vehicle.yaml", "\nfriction: ", "\nfriction: abc # ");
    let (code, says, out) = run();
    assert!(code == Some(2) && !out.exists(), "{says}");
    assert!(
        says.contains("error[wrong-kind]: `friction` (")
            && says.contains("): `abc` is not a number\n"),
        "{says}"
    );
    assert!(says.contains("vehicle.yaml:"), "{says}");
    fs::copy(example.join("vehicle.yaml"), to.join("vehicle.yaml")).unwrap();
    exchange("campaign.yaml", "\ntrack:", "\ntrak:");
    let (code, says, _) = run();
    assert!(
        code == Some(2)
            && says.contains("error[unknown-key]")
            && says.contains("did you mean `track`?"),
        "{says}"
    );
}

/// A table of sections that cannot be read is told once, at its place, and nothing is simulated or
/// written.
#[test]
fn a_table_of_sections_that_cannot_be_read_is_told_once() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good");
    let to = folder().join("table");
    copy(&example, &to);
    let table = fs::read_to_string(example.join("sections.csv")).unwrap();
    let widened: String = table
        .lines()
        .enumerate()
        .map(|(row, line)| format!("{line},{}\n", if row == 0 { "wind [foo]" } else { "3" }))
        .collect();
    let second = |from: &str, into: &str| {
        let rows = table.lines().enumerate();
        rows.fold(String::new(), |all, (row, line)| {
            all + &if row == 2 { line.replacen(from, into, 1) } else { line.to_string() } + "\n"
        })
    };
    let cases = [
        (widened, "`foo` is not a known unit", "sections.csv:1:"),
        (second("105.00", "abc"), "`start`: `abc` is not a number", "sections.csv:3:7"),
        (second("105.00", ""), "section `S02` has no start or no end", "sections.csv:3:1"),
    ];
    for (text, says, place) in cases {
        fs::write(to.join("sections.csv"), text).unwrap();
        let out = to.with_extension("diagnosis");
        let ran = fishplate(&["diagnose", to.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        let told = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(2), "{told}");
        assert!(
            told.contains(says) && told.contains(place) && told.matches("error[").count() == 1,
            "{told}"
        );
        assert!(!out.exists());
    }
}

/// A column that the section table does not have tells no sections apart, and a zone that the
/// protocol does not know is none of its zones: both are told where they stand, and a zone written
/// `1.0` is zone 1.
#[test]
fn columns_that_are_not_there_and_zones_that_are_none_are_told() {
    let to = without_track("columns");
    let exchange = |file: &Path, pairs: &[(&str, &str)]| {
        let text = fs::read_to_string(file).unwrap();
        pairs.iter().fold(text, |text, (from, into)| {
            assert!(text.contains(from), "{from} in {text}");
            text.replacen(from, into, 1)
        })
    };
    let run = |catalogue: &str, table: &str| {
        let effects = to.with_extension("effects.yaml");
        fs::write(&effects, catalogue).unwrap();
        fs::write(to.join("sections.csv"), table).unwrap();
        let out = to.with_extension("diagnosis");
        let _ = fs::remove_dir_all(&out);
        let ran = fishplate(&[
            "diagnose",
            to.to_str().unwrap(),
            "--effects",
            effects.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
        ]);
        (
            ran.status.code(),
            String::from_utf8(ran.stderr).unwrap(),
            fs::read_to_string(out.join("diagnosis.json")).unwrap_or_default(),
        )
    };
    let catalogue = Path::new(env!("CARGO_MANIFEST_DIR")).join("effects/bogie-vehicle.yaml");
    let (good, right) = (exchange(&catalogue, &[]), exchange(&to.join("sections.csv"), &[]));
    let (code, says, found) = run(&good, &right);
    assert!(
        code.is_some_and(|code| code <= 1)
            && !says.contains("unknown-column")
            && !says.contains("section-data"),
        "{says}"
    );
    // As numbers with a point, which is what is left of whole numbers in many a table.
    let (code_of_numbers, says, same) =
        run(&good, &right.replace(",1,", ",1.0,").replace(",4,", ",4.0,"));
    assert!(code_of_numbers == code && !says.contains("section-data") && same == found, "{says}");

    let wrong = exchange(
        &catalogue,
        &[
            ("strata: zone", "strata: zones"),
            ("[zone, direction]", "[zone, directon]"),
            ("cant deficiency, speed", "cant defficiency, speed"),
        ],
    );
    let (code, says, _) = run(&wrong, &right.replacen("S02,1,", "S02,x,", 1));
    assert!(code.is_some_and(|code| code <= 1), "{says}");
    for (column, near) in
        [("zones", "zone"), ("directon", "direction"), ("cant defficiency", "cant deficiency")]
    {
        assert!(
            says.contains(&format!("no column `{column}`"))
                && says.contains(&format!("did you mean `{near}`?")),
            "{says}"
        );
    }
    // Where the catalogue names the column as well.
    assert!(
        says.contains("`zone`: `x` is not one of 1, 2, 3, 4") && says.contains("sections.csv:3:5"),
        "{says}"
    );

    // What is no name, no single column, and no channel.
    let cases = [
        ("strata: zone", "strata: {zone: 1}", "expected a name or a list of names, found"),
        (
            "mirrored: {direction: left}",
            "mirrored: left",
            "`mirrored` must be one column and its value",
        ),
        (
            "channels: [Y_1L, Y_3L, Q_1L, Q_3L]",
            "channels: [Y_1X]",
            "`Y_1X` is neither a group nor a channel of a group",
        ),
        ("{channels: [Y_1L,", "{chanels: [Y_1L,", "needs `channels`"),
    ];
    for (from, into, wanted) in cases {
        let (code, says, found) = run(&exchange(&catalogue, &[(from, into)]), &right);
        assert!(
            code == Some(2)
                && says.contains(wanted)
                && says.contains("effects.yaml:")
                && found.is_empty(),
            "{says}"
        );
    }
}

/// From itself nothing can be learnt that stands beside its gap, by whatever path it is given.
#[test]
fn a_campaign_is_no_reference_for_itself() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/coach-good");
    let out = folder().join("itself");
    let same = example.join("../coach-good");
    let ran = fishplate(&[
        "diagnose",
        example.to_str().unwrap(),
        "--reference",
        same.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    let says = String::from_utf8(ran.stderr).unwrap();
    assert!(
        ran.status.code() == Some(2) && says.contains("is the campaign itself") && !out.exists(),
        "{says}"
    );
}

/// In one test, one after the other: each uses the runs of the one before.
#[test]
fn what_is_hidden_is_found_and_nothing_is_invented() {
    nothing_hidden();
    payload();
    gain_of_a_channel();
    removed_from_the_catalogue();
}

fn nothing_hidden() {
    let (found, code) = diagnose(&campaign("nothing", &[], &[]), &[]);
    assert_eq!(
        (found["verdict"].as_str(), code),
        (Some("no significant gap"), Some(0)),
        "{found:#}"
    );
    assert_eq!(found["causes"], Value::Array(Vec::new()));
    assert!(found["detectable"].as_array().unwrap().len() > 10);
}

/// 4 t within 8 %; the same bytes whatever `truth.json` says.
fn payload() {
    let campaign = campaign("payload", &["payload=4000"], &[]);
    let better = folder().join("payload-better");
    let (found, code) = diagnose(&campaign, &["--write-improved", better.to_str().unwrap()]);
    assert_eq!(
        (found["verdict"].as_str(), code),
        (Some("explained"), Some(0)),
        "{:#}",
        found["says"]
    );
    let effects = found["causes"][0]["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 1);
    assert_eq!(effects[0]["name"], "payload");
    let mass = effects[0]["parameters"]["payload.mass"]["value"].as_f64().unwrap();
    assert!((mass / 4000.0 - 1.0).abs() < 0.08, "{mass}");
    assert!(found["shrink"]["fraction_removed"].as_f64().unwrap() > 0.7, "{:#}", found["shrink"]);
    let quantities = found["shrink"]["quantities"].as_array().unwrap();
    for quantity in quantities {
        let number =
            |key: &str| quantity[key].as_f64().unwrap_or_else(|| panic!("{key}: {quantity:#}"));
        assert!(
            number("low") <= number("high") && (0.0..0.5).contains(&number("noise_floor")),
            "{quantity:#}"
        );
    }
    // The weight is in the quasi-static vertical forces, far above their noise.
    let vertical = quantities.iter().find(|quantity| quantity["id"] == "Q_qst").unwrap();
    assert!(vertical["variance_explained_above_noise"].as_f64().unwrap() > 0.9, "{vertical:#}");
    assert!(fs::read_dir(better.join("simulation")).unwrap().count() >= 12);
    let text =
        || fs::read_to_string(campaign.with_extension("diagnosis").join("diagnosis.json")).unwrap();
    let before = text();
    let truth =
        r#"{"kind": "single", "effects": [{"name": "friction", "parameters": {"friction": 0.1}}]}"#;
    fs::write(campaign.join("truth.json"), truth).unwrap();
    diagnose(&campaign, &[]);
    assert_eq!(text(), before, "with truth.json: {truth}");
}

/// A truth that cannot be read is not looked at either.
#[test]
fn a_truth_that_is_not_json_changes_nothing() {
    let to = without_track("unreadable-truth");
    let (before, _) = diagnose(&to, &[]);
    fs::write(to.join("truth.json"), "not JSON at all").unwrap();
    assert_eq!(diagnose(&to, &[]).0, before);
}

fn gain_of_a_channel() {
    let (found, _) = diagnose(&campaign("gain", &["sensor_gain=0.75 on Y_3R"], &[]), &[]);
    let effect = &found["causes"][0]["effects"][0];
    assert_eq!(effect["name"], "sensor_gain", "{:#}", found["says"]);
    let gain = effect["parameters"]["measurement.gain.Y_3R"]["value"].as_f64().unwrap();
    assert!((gain - 0.75).abs() < 0.05, "{gain}");
}

/// The gain with no gains in the catalogue, the payload with no payload: nothing else is named with
/// confidence, though a gain of all vertical forces is near to a payload.
fn removed_from_the_catalogue() {
    for (name, effect) in [("gain", "sensor_gain"), ("payload", "payload")] {
        let catalogue = folder().join("without.yaml");
        fs::write(&catalogue, format!("catalogue: without\ntitle: Not all\nextends: bogie-vehicle\neffects:\n  {effect}: remove\n"))
            .unwrap();
        let (found, _) =
            diagnose(&folder().join(name), &["--effects", catalogue.to_str().unwrap()]);
        assert_ne!(found["verdict"], "explained", "{name}: {:#}", found["says"]);
    }
}
