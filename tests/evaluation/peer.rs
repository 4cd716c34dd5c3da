//! The engine against independent evaluations: whole campaigns through `certify`, with each setting
//! of the shipped protocols.
//!
//! References: `tests/cases/peer` (polars and scipy), `tests/cases/sprague_geers` (scipy),
//! `tests/cases/sway` (plain Python); see the README beside each.

use std::path::{Path, PathBuf};

use crate::common::campaign::{certified, copy, replace};
use fishplate::result::{Certification, QuantityResult, StatisticResult, Verdict};
use serde_json::Value;

/// Relative; rounding apart, both sides do the same arithmetic.
const TOLERANCE: f64 = 1e-9;
/// Differences of nearly equal numbers, relative to the size of the compared values.
const CANCELLATION: f64 = 1e-12;

const ANNEX_T: &str = "en14363-2016-annex-t";

/// Setting of the reference, and the parameter of the protocol that is the same.
const SETTINGS: [(&str, &str); 12] = [
    ("cutoff-per_pass", "filter_edge=per-pass"),
    ("ddof-0", "variance_divisor=n"),
    ("lp_order-2", "lowpass_order=2"),
    ("max_rule-measured_side", "maximum_side=measurement"),
    ("percentile-hazen", "percentile_rule=hazen"),
    ("qst_sign-magnitude", "quasi_static_difference=magnitudes"),
    ("qst_sign-signed", "quasi_static_difference=signed"),
    ("ratio_from-filtered", "ratio_from=lowpassed"),
    ("sliding_input-lowpass", "sliding_input=lowpassed"),
    ("sliding_mean-integral", "window_ends=integral"),
    ("zero_phase-false", "filter_phase=causal"),
    ("", ""),
];

fn expected(path: &Path) -> Value {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[track_caller]
fn near(what: &str, found: f64, expected: f64, scale: f64) {
    let room = TOLERANCE * expected.abs() + CANCELLATION * scale;
    assert!((found - expected).abs() <= room, "{what}: {found:e}, expected {expected:e}");
}

fn statistic<'a>(quantity: &'a QuantityResult, name: &str) -> &'a StatisticResult {
    quantity
        .statistics
        .iter()
        .find(|statistic| statistic.name.to_string() == name)
        .unwrap_or_else(|| panic!("{}: {name}", quantity.id))
}

/// Number of pairs, mean, standard deviation, limits, shares of the limits, what holds, and the
/// verdict.
fn same_statistics(case: &str, found: &Certification, expected: &Value) {
    assert_eq!(found.verdict.in_words(), expected["verdict"], "{case}");
    let quantities = expected["quantities"].as_array().expect("a list");
    let ids = |quantity: &Value| quantity["id"].as_str().expect("an id").to_string();
    assert_eq!(
        found.quantities.iter().map(|quantity| quantity.id.clone()).collect::<Vec<_>>(),
        quantities.iter().map(ids).collect::<Vec<_>>(),
        "{case}"
    );
    for (quantity, expected) in found.quantities.iter().zip(quantities) {
        assert_eq!(quantity.values.len() as u64, expected["pairs"], "{case} {}", quantity.id);
        assert_eq!(quantity.holds, expected["holds"].as_bool(), "{case} {}", quantity.id);
        let largest = quantity
            .values
            .iter()
            .flat_map(|pair| [pair.simulated, pair.measured])
            .flatten()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        for name in ["mean", "std"] {
            let statistic = statistic(quantity, name);
            let what = format!("{case} {} {name}", quantity.id);
            let number =
                |key: &str| expected[key].as_f64().unwrap_or_else(|| panic!("{what}: {key}"));
            let limit = number(&format!("limit_{name}"));
            near(&what, statistic.value.expect("a value"), number(name), largest);
            near(&what, statistic.limit.expect("a limit"), limit, 0.0);
            near(
                &what,
                statistic.normalised.expect("a share"),
                number(&format!("normalised_{name}")),
                largest / limit,
            );
        }
    }
}

/// Every value of every section and signal, in the reference's order.
fn same_values(case: &str, found: &Certification, path: &Path) {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut rows = text.lines();
    let header: Vec<&str> = rows.next().expect("a header").split(',').collect();
    let column = |name: &str| {
        header
            .iter()
            .position(|known| *known == name)
            .unwrap_or_else(|| panic!("{case}: no column {name}"))
    };
    let [section, zone, id, signal, simulated, measured, difference] =
        ["section", "zone", "quantity", "signal", "simulated", "measured", "difference"]
            .map(column);
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let what = format!("{case} {} {} {}", cells[id], cells[section], cells[signal]);
        let quantity = found
            .quantities
            .iter()
            .find(|quantity| quantity.id == cells[id])
            .unwrap_or_else(|| panic!("{what}"));
        let pair = quantity
            .values
            .iter()
            .find(|pair| pair.section == cells[section] && pair.signal == cells[signal]);
        let pair = pair.unwrap_or_else(|| panic!("{what}: no such pair"));
        let number = |column: usize| {
            cells[column].parse::<f64>().unwrap_or_else(|error| panic!("{what}: {error}"))
        };
        // The reference writes maxima as magnitudes, as the protocol does.
        let (s, m) = (pair.simulated.expect("a value"), pair.measured.expect("a value"));
        let scale = s.abs().max(m.abs());
        assert_eq!(pair.zone.as_deref(), Some(cells[zone]), "{what}");
        near(&format!("{what} simulated"), s, number(simulated), 0.0);
        near(&format!("{what} measured"), m, number(measured), 0.0);
        near(&format!("{what} difference"), pair.difference, number(difference), scale);
        assert!(pair.samples > 0, "{what}");
        count += 1;
    }
    assert_eq!(
        count,
        found.quantities.iter().map(|quantity| quantity.values.len()).sum::<usize>(),
        "{case}"
    );
}

fn against_reference(campaign: &Path, folder: &Path, name: &str) {
    let mut compared = 0;
    for (setting, parameter) in SETTINGS {
        let stem = if setting.is_empty() { name.to_string() } else { format!("{name}.{setting}") };
        let path = folder.join(format!("{stem}.json"));
        if !path.exists() {
            continue;
        }
        let set: Vec<&str> = if parameter.is_empty() { Vec::new() } else { vec![parameter] };
        let found = certified(campaign, ANNEX_T, &set)
            .unwrap_or_else(|problems| panic!("{stem}\n{}", problems.render(false)));
        same_statistics(&stem, &found, &expected(&path));
        let values = folder.join(format!("{stem}.csv"));
        if values.exists() {
            same_values(&stem, &found, &values);
        }
        compared += 1;
    }
    assert!(compared > 0, "no reference for {name}");
}

#[test]
fn the_coach_that_fails() {
    against_reference(Path::new("examples/coach"), Path::new("tests/cases/peer"), "coach");
}

#[test]
fn the_coach_that_validates() {
    against_reference(
        Path::new("examples/coach-good"),
        Path::new("tests/cases/peer"),
        "coach-good",
    );
}

/// Every setting of the reference has its parameter here.
#[test]
fn no_reference_is_left_out() {
    let mut settings: Vec<String> = std::fs::read_dir("tests/cases/peer")
        .expect("a folder")
        .filter_map(|entry| {
            entry
                .ok()?
                .file_name()
                .to_str()?
                .strip_suffix(".json")?
                .split_once('.')
                .map(|(_, setting)| setting.to_string())
        })
        .collect();
    settings.sort();
    settings.dedup();
    assert_eq!(
        settings,
        SETTINGS[..SETTINGS.len() - 1].iter().map(|(setting, _)| *setting).collect::<Vec<_>>()
    );
}

/// `PRACTICE_CAMPAIGNS` names a folder of campaigns, each with `<name>.json` (and `<name>.csv`) of
/// the same form in `expected` below it.
#[test]
#[ignore = "skipped: asked for with --ignored, where PRACTICE_CAMPAIGNS names a folder"]
fn practice_campaigns() {
    let folder = std::env::var_os("PRACTICE_CAMPAIGNS").map(PathBuf::from);
    let folder = folder.expect("PRACTICE_CAMPAIGNS names a folder");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .expect("a folder")
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| folder.join(name).join("campaign.yaml").exists())
        .collect();
    names.sort();
    assert!(!names.is_empty(), "no campaign in {}", folder.display());
    for name in names {
        against_reference(&folder.join(&name), &folder.join("expected"), &name);
    }
}

#[test]
fn sprague_geers_example() {
    let expected = expected(Path::new("tests/cases/sprague_geers/expected.json"));
    let found = certified(Path::new("examples/sprague-geers"), "sprague-geers", &[])
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    let mut count = 0;
    for value in expected["values"].as_array().expect("a list") {
        let text = |key: &str| value[key].as_str().expect("text");
        for part in ["magnitude", "phase", "comprehensive"] {
            let (section, signal) = (text("section"), text("signal"));
            let id = format!("{}_{part}", signal.split('_').next().unwrap_or_default());
            let quantity = found
                .quantities
                .iter()
                .find(|quantity| quantity.id == id)
                .unwrap_or_else(|| panic!("{id}"));
            let pair = quantity
                .values
                .iter()
                .find(|pair| pair.section == section && pair.signal == signal);
            let pair = pair.unwrap_or_else(|| panic!("{id} {section} {signal}"));
            near(
                &format!("{id} {section}"),
                pair.difference,
                value[part].as_f64().expect("a number"),
                0.0,
            );
            assert_eq!(pair.samples as u64, value["samples"], "{id} {section}");
            count += 1;
        }
    }
    assert_eq!(count, found.quantities.iter().map(|quantity| quantity.values.len()).sum::<usize>());
}

#[test]
fn sway_example() {
    // The protocol has no limits of its own.
    const SWAY: [&str; 2] = ["largest_error=1 mrad", "mean_error=0.5 mrad"];
    let without = certified(Path::new("examples/sway"), "stationary-sway", &[]).expect("a result");
    assert_eq!(without.verdict, Verdict::NotAssessable);
    let reason = without.reasons[0].text().to_string();
    assert!(reason.contains("`largest_error`, `mean_error`"), "{reason}");

    let expected = expected(Path::new("tests/cases/sway/expected.json"));
    let found = certified(Path::new("examples/sway"), "stationary-sway", &SWAY)
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    for value in expected["values"].as_array().expect("a list") {
        let text = |key: &str| value[key].as_str().expect("text");
        for (name, key) in [("largest", "maximum"), ("mean", "mean")] {
            let id = format!("{}_{name}", text("signal").split(' ').next().unwrap_or_default());
            let quantity = found
                .quantities
                .iter()
                .find(|quantity| quantity.id == id)
                .unwrap_or_else(|| panic!("{id}"));
            assert_eq!(quantity.unit, "mrad");
            let pair = quantity.values.iter().find(|pair| pair.section == text("record"));
            let pair = pair.unwrap_or_else(|| panic!("{id} {}", text("record")));
            near(
                &format!("{id} {}", text("record")),
                pair.difference,
                value[key].as_f64().expect("a number"),
                0.0,
            );
        }
    }
    assert_eq!(found.quantities.iter().map(|quantity| quantity.values.len()).sum::<usize>(), 8);
}

/// Footnote of Table 1: each of three properties of the vehicle doubles the four limits of
/// acceleration, and nothing else.
#[test]
fn four_limits_are_doubled() {
    let coach = certified(Path::new("examples/coach"), ANNEX_T, &[]).expect("certified");
    for (before, after) in [
        ("category: passenger", "category: freight"),
        ("running_gear: bogies", "running_gear: single_axles"),
        ("secondary_suspension: true", "secondary_suspension: false"),
    ] {
        let folder = copy(Path::new("examples/coach"));
        replace(&folder.path().join("vehicle.yaml"), before, after);
        let other = certified(folder.path(), ANNEX_T, &[]).expect("certified");
        for (coach, other) in coach.quantities.iter().zip(&other.quantities) {
            let factor =
                if coach.id.starts_with("ay_") || coach.id.starts_with("az_") { 2.0 } else { 1.0 };
            for name in ["mean", "std"] {
                let (a, b) = (statistic(coach, name), statistic(other, name));
                near(
                    &format!("{after} {} {name}", coach.id),
                    b.limit.expect("a limit"),
                    factor * a.limit.expect("a limit"),
                    0.0,
                );
                assert_eq!((a.value, a.count), (b.value, b.count));
            }
        }
    }
}

/// Closed form: 4 (1 + 0.01 Q0) and 6 (1 + 0.01 Q0), Q0 in kN, and 2/3 of them.
#[test]
fn limits_follow_the_wheel_load() {
    for (written, wheel_load) in [("70", 70.0), ("62.5", 62.5)] {
        let folder = copy(Path::new("examples/coach"));
        replace(
            &folder.path().join("vehicle.yaml"),
            "static_wheel_load: 54.546 kN",
            &format!("static_wheel_load: {written} kN"),
        );
        let found = certified(folder.path(), ANNEX_T, &[]).expect("certified");
        for (id, base) in [("Q_qst", 4.0), ("Q_max", 6.0)] {
            let quantity =
                found.quantities.iter().find(|quantity| quantity.id == id).expect("there");
            let limit = base * (1.0 + 0.01 * wheel_load);
            near(id, statistic(quantity, "std").limit.expect("a limit"), limit, 0.0);
            near(id, statistic(quantity, "mean").limit.expect("a limit"), 2.0 / 3.0 * limit, 0.0);
        }
    }
}
