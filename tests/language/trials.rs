//! Protocols that users wrote down before the language could say them: each passes the check
//! (tests/language/check) and runs on a campaign that has its records.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::common::program::fishplate;
use serde_json::Value;

/// The protocol, a campaign with its records, and the quantities that have values there.
const TRIALS: [(&str, &str, &[&str]); 10] = [
    ("trial_a_distributions", "coach", &["matching", "means"]),
    ("trial_b", "coach", &[]),
    ("trial_c_metrics", "coach", &[]),
    ("trial_d", "coach", &[]),
    ("trial_f", "code-benchmark", &["Y_qst", "Y_two"]),
    ("trial_g", "coach", &[]),
    ("trial_h", "coach", &[]),
    ("trial_i", "run", &["Y_max"]),
    ("trial_j", "coach", &["Q_max", "Q_max_n", "repeatability"]),
    ("trial_k_own_rules", "coach", &[]),
];

/// Trial e asks for channels (roll, cant, twist, a door) that no shipped campaign has. It is
/// checked only.
#[test]
fn each_trial_runs_where_its_records_exist() {
    for (protocol, campaign, named) in TRIALS {
        let out = tempfile::tempdir().expect("a temporary folder");
        let folder = out.path().join("out");
        let ran = fishplate(&[
            "certify",
            &format!("examples/{campaign}"),
            "--protocol",
            &format!("tests/cases/check/good/{protocol}.fp"),
            "--only",
            "results",
            "--out",
            folder.to_str().expect("a path in UTF-8"),
        ]);
        assert!([0, 1].contains(&ran.code), "{protocol}: {}{}", ran.stdout, ran.stderr);
        let text = fs::read_to_string(folder.join("results.json")).expect("results.json");
        let found: Value = serde_json::from_str(&text).expect("JSON");
        let quantities = found["quantities"].as_array().expect("quantities");
        let with_values = |quantity: &&Value| {
            quantity["values"].as_array().is_some_and(|values| !values.is_empty())
        };
        let have: Vec<&str> = quantities
            .iter()
            .filter(with_values)
            .filter_map(|quantity| quantity["id"].as_str())
            .collect();
        assert!(!have.is_empty(), "{protocol}: no quantity has a value");
        for name in named {
            assert!(have.contains(name), "{protocol}: `{name}` has no value, only {have:?}");
        }
    }
}

/// Rules of standards without a detour (tests/cases/rule-sets/README.md names them).
#[test]
fn each_rule_set_passes_the_check() {
    let mut checked = 0;
    for entry in fs::read_dir("tests/cases/rule-sets").expect("the folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "fp") {
            continue;
        }
        // What the others extend has no quantity of its own.
        if !path.ends_with("base.fp") {
            let ran = fishplate(&["check", path.to_str().expect("a path in UTF-8")]);
            assert_eq!(ran.code, 0, "{}: {}{}", path.display(), ran.stdout, ran.stderr);
        }
        let formatted = fishplate(&["fmt", "--check", path.to_str().expect("a path in UTF-8")]);
        assert_eq!(formatted.code, 0, "{}{}", formatted.stdout, formatted.stderr);
        checked += 1;
    }
    assert!(checked >= 8, "{checked}");
}

/// Tones of 600 s with 50 samples a second, at both positions alike.
fn tones(folder: &Path, vertical: f64, lateral: f64) {
    let write = |name: &str, text: String| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    let paths = "vehicle: vehicle.yaml\nsections: sections.csv\nmeasurement: measurement\nsimulation: simulation\n";
    write("campaign.yaml", format!("name: tones\n{paths}sampling_rate [Hz]: 50\n"));
    write("vehicle.yaml", "name: none\n".into());
    write("sections.csv", "section,start [s],end [s]\nS1,300,550\n".into());
    let mut record = "time [s],ay_I [m/s^2],ay_II [m/s^2],az_I [m/s^2],az_II [m/s^2]\n".to_string();
    for sample in 0..=30_000 {
        let time = f64::from(sample) * 0.02;
        let of = |frequency: f64| (TAU * frequency * time).sin();
        let (y, z) = (of(lateral), of(vertical));
        writeln!(record, "{time},{y},{y},{z},{z}").expect("a string");
    }
    write("measurement/S1.csv", record.clone());
    write("simulation/S1.csv", record);
}

/// The first measured value of each quantity of a rule set on a campaign.
fn measured(protocol: &str, campaign: &Path) -> BTreeMap<String, f64> {
    let out = tempfile::tempdir().expect("a temporary folder");
    let folder = out.path().join("out");
    let ran = fishplate(&[
        "certify",
        campaign.to_str().expect("a path in UTF-8"),
        "--protocol",
        &format!("tests/cases/rule-sets/{protocol}.fp"),
        "--only",
        "results",
        "--out",
        folder.to_str().expect("a path in UTF-8"),
    ]);
    assert!([0, 1].contains(&ran.code), "{protocol}: {}{}", ran.stdout, ran.stderr);
    let text = fs::read_to_string(folder.join("results.json")).expect("results.json");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let quantities = found["quantities"].as_array().expect("quantities");
    let of = |quantity: &Value| {
        let value = &quantity["values"][0];
        let value = value["value"].as_f64().or(value["measured"].as_f64()).expect("a value");
        (quantity["id"].as_str().expect("a name").to_string(), value)
    };
    quantities.iter().map(of).collect()
}

/// Closed forms: of a tone of 0.2 Hz in m/s², MSDV is |Wf| √(T/2), with the transfer function of Wf
/// at its frequency; the bilinear transformation changes it by less than 1 %. Of a tone of 0.4 Hz
/// the largest range in a second is 2 sin(0.4 π): 1.9, and 1.55 is what tiles may give.
#[test]
fn rule_sets_give_the_numbers_of_tones() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    tones(folder.path(), 0.2, 0.4);
    let p = |frequency: f64, quality: f64| {
        let ratio = 0.2 / frequency;
        (1.0 - ratio * ratio).hypot(ratio / quality)
    };
    // As the rule set writes it.
    const BUTTERWORTH: f64 = 70_711e-5;
    let high_pass = (0.2_f64 / 0.08).powi(2) / p(0.08, BUTTERWORTH);
    let upward = (0.0625_f64 / 0.1).powi(2) * p(0.0625, 0.8) / p(0.1, 0.8);
    let weight = high_pass / p(0.63, BUTTERWORTH) / p(0.25, 0.86) * upward;
    let found = measured("05-msdv", folder.path());
    for id in ["MSDV", "MSDV_rms"] {
        let ratio = found[id] / (weight * (250.0_f64 / 2.0).sqrt());
        assert!((ratio - 1.0).abs() < 0.01, "{id}: {ratio}");
    }
    let found = measured("02c-fra-windows", folder.path());
    let range = 2.0 * (0.4 * std::f64::consts::PI).sin();
    let short = range - found["carbody_lateral"];
    // A window of a second holds 50 samples, 0.98 s from the first to the last.
    assert!((0.0..0.03).contains(&short), "{short}");
}

/// A tone of 0.4 Hz over 250 s comes above any level within its range 100 times; the written samples
/// and the filter move no crossing over the ends of the section.
#[test]
fn crossings_of_a_tone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    tones(folder.path(), 0.2, 0.4);
    let protocol = folder.path().join("crossings.fp");
    let text = |name: &str, value: &str| {
        format!(
            "quantity {name}\n  from  measured\n  of  ay\n  value  {value}\n  limit  each 1\n\n"
        )
    };
    let text =
        "protocol crossings \"Crossings\"\n  axis  time in s\n\nchannel ay \"ay\"\n  in  m/s^2\n  \
                column  \"ay_I\"\n\n"
            .to_string()
            + &text("half", "crossings where ay > 0.5 m/s^2")
            + &text("falling", "crossings where ay < 0.5 m/s^2")
            + &text("rate", "(crossings where ay > 0.5 m/s^2) / length * (1 s)")
            + &text("never", "crossings where ay > 2 m/s^2")
            + &text("always", "crossings where ay < 2 m/s^2")
            + "verdict\n  validated  when every limit holds\n";
    fs::write(&protocol, text).expect("a file");
    let out = folder.path().join("out");
    let ran = fishplate(&[
        "certify",
        folder.path().to_str().expect("a path in UTF-8"),
        "--protocol",
        protocol.to_str().expect("a path in UTF-8"),
        "--only",
        "results",
        "--out",
        out.to_str().expect("a path in UTF-8"),
    ]);
    assert!([0, 1].contains(&ran.code), "{}{}", ran.stdout, ran.stderr);
    let text = fs::read_to_string(out.join("results.json")).expect("results.json");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let of = |at: usize| found["quantities"][at]["values"][0]["value"].as_f64().expect("a value");
    assert_eq!([of(0), of(1), of(3), of(4)], [100.0, 100.0, 0.0, 0.0]);
    assert!((of(2) - 0.4).abs() < 1e-12, "{}", of(2));
}
