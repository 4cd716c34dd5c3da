//! Protocols that users wrote down before the language could say them: each passes the check
//! (tests/language/check) and runs on a campaign that has its records.

use std::fs;

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
