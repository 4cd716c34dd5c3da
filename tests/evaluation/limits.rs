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

/// One row for both edges: the edge of which more is used decides, as a share that follows from the
/// recorded value alone.
#[test]
fn a_limit_between_two_edges_is_one_row() {
    let rules = |verdict: &str| {
        format!(
            "quantity Q_1 \"Leading\"\n  from   measured\n  of     Q at wheelset 1\n  value  mean - 50 kN\n  \
               limit  mean between -4 kN and 2 kN\n  limit  each between -100 kN and 300 kN\n  \
               limit  (mean + 60 kN) between 50 kN and 70 kN for each side\n  \
               limit  (mean - 60 kN) between -90 kN and -20 kN\n  \
               limit  (mean - 61 kN) between -90 kN and -80 kN\n  \
               limit  (n) between wheel_load / (1 kN) and 8\n\nverdict\n  validated  when {verdict}\n"
        )
    };
    let found = results(&rules("every limit holds"));
    let quantity = &found["quantities"][0];
    let values: Vec<f64> = quantity["values"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|one| number(&one["value"]))
        .collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let share = |value: f64, low: f64, high: f64| -> Option<f64> {
        let of = |value: f64, least: f64| match (least > 0.0, value > 0.0) {
            (true, true) => Some(least / value),
            (true, false) => None,
            (false, _) => Some((value / least).max(0.0)),
        };
        Some(of(value, low)?.max(of(-value, -high)?))
    };
    let check = |row: &Value, value: f64, (low, high): (f64, f64)| {
        let edge = |at: usize| number(&row["edges"][at]["limit"]);
        assert_eq!((edge(0), edge(1)), (low, high), "{row}");
        assert_eq!(row["holds"], Value::from(low <= value && value <= high), "{row}");
        near(number(&row["value"]), value);
        match share(value, low, high) {
            Some(share) => near(number(&row["normalised"]), share),
            None => assert!(row["normalised"].is_null(), "{row}"),
        }
    };
    assert_eq!(quantity["statistics"].as_array().expect("a list").len(), 7);
    check(statistics(quantity, "mean")[0], mean, (-4.0, 2.0));
    check(statistics(quantity, "mean - 60 kN")[0], mean - 60.0, (-90.0, -20.0));
    check(statistics(quantity, "mean - 61 kN")[0], mean - 61.0, (-90.0, -80.0));
    for side in statistics(quantity, "mean + 60 kN") {
        check(side, number(&side["value"]), (50.0, 70.0));
    }
    let worst = |low: f64, high: f64| {
        let share = |value: &&f64| share(**value, low, high).expect("a share");
        *values.iter().max_by(|a, b| share(a).total_cmp(&share(b))).expect("a value")
    };
    check(statistics(quantity, "each")[0], worst(-100.0, 300.0), (-100.0, 300.0));
    // 50 is above 8: no value is between them.
    let crossed = statistics(quantity, "n")[0];
    assert!(crossed["holds"].is_null(), "{crossed}");
    let reason = crossed["reason"].as_str().expect("a reason");
    assert!(reason.contains("lower edge is above its upper one"), "{reason}");
    // A limit with two edges counts once.
    let rule = "at least 6 limits hold";
    assert_eq!(results(&rules(rule))["verdict"], "not assessable");
}

/// Where the sign counts, a limit may be zero or below it.
#[test]
fn a_limit_at_most_zero_or_less() {
    let found = results(
        "quantity Q_1 \"Leading\"\n  from   measured\n  of     Q at wheelset 1\n  value  mean - 50 kN\n  \
           limit  each at most 0 kN\n  limit  (mean - 60 kN) at most -20 kN\n  \
           limit  (mean - 61 kN) at most -80 kN\n",
    );
    let quantity = &found["quantities"][0];
    let values = quantity["values"].as_array().expect("a list").iter();
    let values: Vec<f64> = values.map(|one| number(&one["value"])).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let each = statistics(quantity, "each")[0];
    assert_eq!(each["holds"], values.iter().all(|value| *value <= 0.0));
    assert!(each["reason"].is_null(), "{each}");
    let [wide, narrow] = [60, 61].map(|less| statistics(quantity, &format!("mean - {less} kN"))[0]);
    for (row, less, limit) in [(wide, 60.0, -20.0), (narrow, 61.0, -80.0)] {
        near(number(&row["value"]), mean - less);
        assert_eq!(row["holds"], mean - less <= limit, "{row}");
    }
}
