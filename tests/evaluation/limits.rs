//! Bounds of limits, from recorded values.

use std::fs;

use crate::common::campaign::tiny;
use crate::common::program::certify;
use serde_json::Value;

const HEAD: &str = "protocol small \"Small\"\n  axis  distance in m\n  time  time in s\n\nplace wheelset\n  members  1, 3\n\n\
     place side\n  members  R, L\n\nchannel Q \"Wheel force\"\n  in      kN\n  at      each wheelset and side\n  \
     column  \"Q_{wheelset}{side}\"\n\nvehicle wheel_load \"Static wheel load\"\n  in   kN\n  key  static_wheel_load\n\n";

/// The results of the tiny campaign under these rules.
fn results(rules: &str) -> Value {
    let folder = tiny();
    let path = folder.path().join("small.fp");
    fs::write(&path, format!("{HEAD}{rules}")).expect("written");
    certify(folder.path(), &["--protocol", &path.display().to_string(), "--only", "results"])
        .results()
}

fn statistics<'a>(quantity: &'a Value, name: &str) -> Vec<&'a Value> {
    let all = quantity["statistics"].as_array().expect("a list");
    all.iter().filter(|one| one["name"] == name).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn near(found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(off <= 1e-12 * expected.abs().max(1.0), "{found} in place of {expected}");
}

/// The limit of another quantity has its factors, and is taken from the values of that quantity in
/// the same group: here their median, which the test takes from the recorded values.
#[test]
fn a_bound_from_the_limit_of_another_quantity() {
    let found = results(
        "estimate spread \"Spread\"\n  is  p90 / std\n\n\
         quantity Q_1 \"Leading\"\n  from   measured\n  of     Q at wheelset 1\n  value  mean\n  \
           limit  std 40 kN, times 1.5 when wheel_load > 40 kN\n  \
           limit  maximum 2 * median for each side\n  limit  spread 40\n\n\
         quantity Q_3 \"Trailing\"\n  from   measured\n  of     Q at wheelset 3\n  value  mean\n  \
           limit  std 0.5 * limit of std of Q_1\n  \
           limit  p95 2 * limit of std of Q_1 for each side\n  \
           limit  maximum limit of maximum of Q_1 for each side\n  \
           limit  (mean / std) 3 * limit of spread of Q_1\n",
    );
    let [first, second] = [&found["quantities"][0], &found["quantities"][1]];
    let limit = |quantity, name: &str| number(&statistics(quantity, name)[0]["limit"]);
    near(limit(first, "std"), 60.0);
    near(limit(second, "std"), 30.0);
    near(limit(second, "p95"), 120.0);
    near(limit(second, "mean / std"), 120.0);
    let highest = statistics(second, "maximum");
    assert_eq!(highest.len(), 2);
    for (side, one) in ["R", "L"].into_iter().zip(highest) {
        assert_eq!(one["group"]["side"], side);
        let values = first["values"].as_array().expect("a list").iter();
        let of_side = values.filter(|value| value["signal"] == format!("Q_1{side}"));
        let mut values: Vec<f64> = of_side.map(|value| number(&value["value"])).collect();
        values.sort_by(f64::total_cmp);
        assert_eq!(values.len(), 12);
        near(number(&one["limit"]), values[5] + values[6]);
    }
}
