//! The shipped procedures: each runs on an example, and its numbers are those of independent
//! programs.

use crate::common::texts::texts;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{certified, copy, lines, replace, tiny};
use fishplate::library;
use fishplate::result::{Certification, Outcome, QuantityResult, Verdict};
use serde_json::Value;

const ASSESSMENT: &str = "en14363-on-track-assessment";
const TWO_DIMENSIONAL: &str = "en14363-on-track-assessment-two-dimensional";
const MULTIPLE: &str = "en14363-on-track-assessment-multiple-regression";
const VIRTUAL: &str = "en14363-virtual-test";
const SIDE_BY_SIDE: &str = "en14363-virtual-against-measured";

/// The example campaigns have three sections in most zones; the procedure asks for more.
const THREE: &[&str] = &["sections_per_zone=3"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[track_caller]
fn run(campaign: &Path, protocol: &str, set: &[&str]) -> Certification {
    certified(campaign, protocol, set)
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

fn example(name: &str, protocol: &str, set: &[&str]) -> Certification {
    run(&root().join("examples").join(name), protocol, set)
}

fn verdicts(found: &Certification) -> BTreeMap<&str, Outcome> {
    found.verdicts.iter().map(|verdict| (verdict.name.as_str(), verdict.outcome)).collect()
}

#[track_caller]
fn quantity<'a>(found: &'a Certification, name: &str) -> &'a QuantityResult {
    found
        .quantities
        .iter()
        .find(|known| known.id == name)
        .unwrap_or_else(|| panic!("no quantity {name}"))
}

/// 1e-9 of the number, as the vectors have 12 digits.
#[track_caller]
fn close(found: f64, wanted: f64, place: &str) {
    assert!(
        (found - wanted).abs() <= 1e-9 * wanted.abs().max(1e-3),
        "{place}: {found} in place of {wanted}"
    );
}

/// Wheelset or running gear of a signal: `kYQ_2L`, `Y_1outer`, `ay_II`.
fn group_of(signal: &str) -> &str {
    let tail = signal.rsplit('_').next().unwrap_or_default();
    tail.trim_end_matches("outer").trim_end_matches(['L', 'R'])
}

/// Each protocol with the record that it assesses, and what its quantities are called for that
/// record.
const ASSESSMENTS: [(&str, &str, &str); 4] = [
    (ASSESSMENT, "measured", ""),
    (VIRTUAL, "simulated", ""),
    (SIDE_BY_SIDE, "measured", ""),
    (SIDE_BY_SIDE, "simulated", "_simulated"),
];

/// Values of each section, wheelset and quantity against an independent program; see
/// `cases/procedures/README.md`.
#[test]
fn values_of_sections() {
    let text =
        fs::read_to_string(root().join("tests/cases/procedures/values.csv")).expect("values");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    for (protocol, record, suffix) in ASSESSMENTS {
        let found = example("coach-good", protocol, THREE);
        let mut wanted: BTreeMap<(&str, &str, &str), Vec<f64>> = BTreeMap::new();
        for row in rows.iter().filter(|row| row[0] == record) {
            wanted
                .entry((row[3], row[1], row[4]))
                .or_default()
                .push(row[5].parse().expect("a number"));
        }
        assert!(wanted.len() > 400, "{}", wanted.len());
        for ((name, section, group), mut wanted) in wanted {
            let values = &quantity(&found, &format!("{name}{suffix}")).values;
            let mut values: Vec<f64> = values
                .iter()
                .filter(|value| value.section == section && group_of(&value.signal) == group)
                .map(|value| value.difference)
                .collect();
            let place = format!("{protocol} {name} {section} {group}");
            assert_eq!(values.len(), wanted.len(), "{place}");
            values.sort_by(f64::total_cmp);
            wanted.sort_by(f64::total_cmp);
            values.iter().zip(&wanted).for_each(|(found, wanted)| close(*found, *wanted, &place));
        }
    }
}

/// Estimates of each zone and wheelset against NumPy and SciPy; see
/// `cases/procedures/estimates.py`.
#[test]
fn estimates_of_zones_and_wheelsets() {
    let text = fs::read_to_string(root().join("tests/cases/procedures/estimates.json"))
        .expect("estimates");
    let wanted: Vec<Value> = serde_json::from_str(&text).expect("JSON");
    let methods = [
        (TWO_DIMENSIONAL, "two-dimensional", "measured", ""),
        (MULTIPLE, "multiple", "measured", ""),
    ];
    let all = ASSESSMENTS
        .iter()
        .map(|(protocol, record, suffix)| (*protocol, "one-dimensional", *record, *suffix))
        .chain(methods);
    for (protocol, method, record, suffix) in all {
        let found = example("coach-good", protocol, THREE);
        let mut compared = 0;
        for one in &wanted {
            let text = |key: &str| one[key].as_str().expect("a text");
            if text("method") != method || text("record") != record {
                continue;
            }
            let (name, zone, group) =
                (format!("{}{suffix}", text("quantity")), text("zone"), text("group"));
            let place = format!("{protocol} {name} zone {zone} {group}");
            let mut results = quantity(&found, &name).statistics.iter().filter(|result| {
                let of_group = result.scope.keys.iter().any(|(_, member)| member == group);
                of_group
                    && (result.scope.zones == [zone]
                        || result.name.to_string().ends_with(&format!("_zone_{zone}")))
            });
            let (Some(result), None) = (results.next(), results.next()) else {
                panic!("{place}: not one estimate")
            };
            close(
                result.value.unwrap_or(f64::NAN),
                one["value"].as_f64().expect("a number"),
                &place,
            );
            compared += 1;
        }
        assert!(compared > 140, "{protocol}: {compared}");
        // Drawn over the cant deficiency wherever the estimate is a regression over it.
        for result in found
            .quantities
            .iter()
            .flat_map(|quantity| &quantity.statistics)
            .filter(|_| protocol == TWO_DIMENSIONAL)
        {
            assert_eq!(
                result.regression.is_some(),
                result.scope.zones != ["1"],
                "{} {}",
                result.title,
                result.scope
            );
        }
    }
}

/// Too few sections: the numbers are there, and no verdict.
#[test]
fn a_test_with_too_few_sections_is_not_assessable() {
    let found = example("coach-good", ASSESSMENT, &[]);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert!(
        texts(&found.reasons)
            .iter()
            .any(|reason| reason.contains("zone 1") && reason.contains("25")),
        "{:?}",
        texts(&found.reasons)
    );
    assert!(quantity(&found, "SigmaY_max").statistics.iter().all(|result| result.value.is_some()));
}

/// Limits by category, wheel load, admissible speed and mass of the bogie.
#[test]
fn limits_by_vehicle() {
    let limit = |found: &Certification, name: &str, zone: &str| {
        quantity(found, name)
            .statistics
            .iter()
            .find(|result| result.scope.zones == [zone])
            .and_then(|result| result.limit)
            .expect("a limit")
    };
    let coach = example("coach-good", ASSESSMENT, THREE);
    let wanted = [
        ("SigmaY_max", 10.0 + 2.0 / 3.0 * 54.546),
        ("SigmaY_instability", 0.5 * (10.0 + 2.0 / 3.0 * 54.546)),
        ("YQ_max", 0.8),
        ("ayb_rms", (12.0 - 0.2 * (2.615 + 2.0 * 1.813)) / 2.0),
        ("Q_max", 90.0 + 54.546),
        ("Q_qst", 145.0),
        ("B_qst", 180.0),
        ("ay_max", 2.5),
        ("az_rms", 0.75),
    ];
    for (name, wanted) in wanted {
        close(limit(&coach, name, "4"), wanted, name);
    }
    close(limit(&coach, "Y_qst", "3"), 60.0, "Y_qst");
    // The mean radius of 270, 305, 350 and 365 m.
    close(limit(&coach, "Y_qst", "4"), 30.0 + 10500.0 / 322.5, "Y_qst");

    let folder = copy(&root().join("examples/coach-good"));
    let vehicle = folder.path().join("vehicle.yaml");
    replace(&vehicle, "category: passenger", "category: freight");
    replace(&vehicle, "static_wheel_load: 54.546 kN", "static_wheel_load: 120 kN");
    replace(&vehicle, "admissible_speed: 140 km/h", "admissible_speed: 120 km/h");
    let text = format!(
        "protocol loads \"Loads alone\"\n  extends  {ASSESSMENT}\n\nremove\n  plausibility  every\n"
    );
    let protocol = folder.path().join("loads.fp");
    fs::write(&protocol, text).expect("written");
    let wagon = run(folder.path(), &protocol.display().to_string(), THREE);
    let wanted = [
        ("SigmaY_max", 0.85 * 90.0),
        ("Q_max", 200.0),
        ("Q_qst", 155.0),
        ("ay_max", 3.0),
        ("az_max", 5.0),
        ("az_rms", 2.0),
    ];
    for (name, wanted) in wanted {
        close(limit(&wagon, name, "4"), wanted, name);
    }
}

/// Both tests by the same rules: the verdicts of each, and whether they are the same.
#[test]
fn the_virtual_test_beside_the_measured_one() {
    // The simulated vertical acceleration is a little above its limit, the measured one is not.
    let found = example("coach-good", SIDE_BY_SIDE, THREE);
    assert_eq!(
        (found.verdict, found.verdict_in_words().as_str()),
        (Verdict::NotValidated, "other acceptance, provisional: 41 values not confirmed")
    );
    let differ = ["virtual_test", "virtual_ride", "same_acceptance", "ride_agrees"];
    for (name, outcome) in verdicts(&found) {
        let wanted = if differ.contains(&name) { Outcome::DoesNotHold } else { Outcome::Holds };
        assert_eq!(outcome, wanted, "{name}");
    }
    let same = example("coach-good", SIDE_BY_SIDE, &[THREE[0], "az_rms_limit_passenger=0.8 m/s^2"]);
    assert_eq!(
        (same.verdict, same.verdict_in_words().as_str()),
        (Verdict::Validated, "same acceptance, provisional: 41 values not confirmed")
    );
    assert!(
        verdicts(&same).values().all(|outcome| *outcome == Outcome::Holds),
        "{:?}",
        verdicts(&same)
    );
    // Other numbers are as in the tests alone.
    for (name, protocol) in [("Q_max", ASSESSMENT), ("Q_max_simulated", VIRTUAL)] {
        let alone = example("coach-good", protocol, THREE);
        let numbers = |of: &QuantityResult| {
            of.statistics.iter().map(|result| (result.value, result.limit)).collect::<Vec<_>>()
        };
        assert_eq!(numbers(quantity(&found, name)), numbers(quantity(&alone, "Q_max")), "{name}");
    }
}

/// What a person judges stays open, with all numbers.
#[test]
fn procedures_judged_by_a_person() {
    for (protocol, open) in [("uic518-2009-comparison", 5), ("gm-rt2141-comparison", 1)] {
        let found = example("coach-good", protocol, &[]);
        assert_eq!(found.verdict, Verdict::NotAssessable, "{protocol}");
        let of =
            |outcome: Outcome| verdicts(&found).values().filter(|one| **one == outcome).count();
        assert_eq!(of(Outcome::Open), open, "{protocol}: {:?}", verdicts(&found));
        assert!(
            found
                .quantities
                .iter()
                .all(|quantity| quantity.statistics.iter().all(|result| result.value.is_some())),
            "{protocol}"
        );
    }
}

/// Wheel unloading on the coach, flexibility on the sway test: by hand, 0.1286 is the slope of the
/// sum of both roll angles.
#[test]
fn wheel_unloading_and_flexibility() {
    let found = example("coach-good", "en14067-6-wheel-unloading", &[]);
    assert_eq!(found.verdict, Verdict::Validated, "{:?}", texts(&found.reasons));
    let unloading = quantity(&found, "unloading_I_largest");
    assert!(unloading.values.iter().all(|value| value.difference.abs() < 0.3));
    let found = example("sway", "en14067-6-flexibility", &[]);
    assert_eq!(found.verdict, Verdict::Validated, "{:?}", texts(&found.reasons));
    for (name, sign) in [("loop-1", 0), ("loop-2", 1)] {
        let (x, y) = sway(name);
        let n = x.len() as f64;
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
            / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>();
        close(quantity(&found, "flexibility_measured").values[sign].difference, slope, name);
    }
}

/// Angle of the cant and roll angle of the body, rad, of a measured loop of the sway test.
fn sway(name: &str) -> (Vec<f64>, Vec<f64>) {
    let text = fs::read_to_string(root().join(format!("examples/sway/measurement/{name}.csv")))
        .expect("a record");
    let rows = text.lines().skip(1).map(|line| {
        line.split(',').map(|cell| cell.parse::<f64>().expect("a number")).collect::<Vec<_>>()
    });
    rows.map(|row| ((row[1] / 1500.0).asin(), (row[2] + row[3]) / 1000.0)).unzip()
}

/// Annex T with 95 % confidence: the bounds lie outside the statistics, and the examples keep their
/// verdicts.
#[test]
fn annex_t_with_confidence() {
    for (campaign, verdict) in
        [("coach-good", Verdict::Validated), ("coach", Verdict::NotValidated)]
    {
        let found = example(campaign, "en14363-2016-annex-t-confidence", &[]);
        assert_eq!(found.verdict, verdict, "{campaign}");
        for quantity in &found.quantities {
            let of = |name: &str| {
                quantity
                    .statistics
                    .iter()
                    .find(|result| result.name.to_string() == name)
                    .and_then(|result| result.value)
                    .expect(name)
            };
            assert!(of("upper 95 % of std by bootstrap") > of("std"), "{}", quantity.id);
            let (low, mean, high) = (
                of("lower 95 % of mean by bootstrap"),
                of("mean"),
                of("upper 95 % of mean by bootstrap"),
            );
            assert!(low < mean && mean < high, "{}", quantity.id);
        }
    }
}

/// Zone 5 and other counts: four sections in zone 4, three of less than 250 m radius.
#[test]
fn a_next_edition_has_zone_5() {
    let folder = tiny();
    for kind in ["measurement", "simulation"] {
        for (from, to) in [("S10", "S13"), ("S10", "S14"), ("S11", "S15"), ("S12", "S16")] {
            let at = |name: &str| folder.path().join(kind).join(format!("{name}.csv"));
            fs::copy(at(from), at(to)).expect("a copy");
        }
    }
    lines(&folder.path().join("sections.csv"), |lines| {
        for (from, to, zone) in
            [(10, "S13", "4"), (10, "S14", "5"), (11, "S15", "5"), (12, "S16", "5")]
        {
            let mut cells: Vec<String> = lines[from].split(',').map(str::to_string).collect();
            (cells[0], cells[1]) = (to.into(), zone.into());
            if zone == "5" {
                cells[4] = "200".into();
            }
            lines.push(cells.join(","));
        }
    });
    let text = "protocol next \"Numbers alone\"\n  extends  en14363-next-edition\n\nremove\n  plausibility  every\n";
    let protocol = folder.path().join("next.fp");
    fs::write(&protocol, text).expect("written");
    let protocol = protocol.display().to_string();
    let required = &["sections_in_zone_5=3"];
    let found = run(folder.path(), &protocol, required);
    assert!(
        texts(&found.reasons).iter().all(|reason| !reason.contains("zone")),
        "{:?}",
        texts(&found.reasons)
    );
    let used: Vec<(&str, usize)> =
        found.zones.iter().map(|zone| (zone.zone.as_str(), zone.used)).collect();
    assert_eq!(used, [("1", 3), ("2", 3), ("3", 3), ("4", 4), ("5", 3)]);
    lines(&folder.path().join("sections.csv"), |lines| lines.truncate(14));
    let found = run(folder.path(), &protocol, required);
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert!(
        texts(&found.reasons).iter().any(|reason| reason.contains("zone 5")),
        "{:?}",
        texts(&found.reasons)
    );
    assert!(
        texts(&run(folder.path(), &protocol, &[]).reasons)
            .iter()
            .all(|reason| !reason.contains("zone"))
    );
    assert_eq!(example("coach-good", "en14363-next-edition", &[]).verdict, Verdict::Validated);
    assert_eq!(example("coach", "en14363-next-edition", &[]).verdict, Verdict::NotValidated);
}

/// Numbers from memory say so beside each limit, and numbers that are set do so as well.
#[test]
fn numbers_from_memory_are_marked() {
    let words = ", to be confirmed against the standard";
    let found = example("coach-good", ASSESSMENT, THREE);
    for quantity in &found.quantities {
        assert!(
            quantity.statistics.iter().all(|result| result.limit_text.ends_with(words)),
            "{}",
            quantity.id
        );
    }
    assert!(found.zones.iter().all(|zone| zone.condition.ends_with(words)));
    let found = example("coach-good", ASSESSMENT, &[THREE[0], "YQ_limit=0.8", "k_safety=3"]);
    assert!(
        quantity(&found, "YQ_max")
            .statistics
            .iter()
            .all(|result| result.limit_text.ends_with(words))
    );
}

/// Rules that two protocols have in common stay alike: the plausibility of the records does not
/// depend on what is assessed.
#[test]
fn plausibility_is_that_of_annex_t() {
    let blocks = |name: &str| {
        let text = library::shipped(name).expect("shipped").text.clone();
        let of: BTreeMap<String, String> = text
            .split("\n\n")
            .filter(|block| {
                block.starts_with("plausibility ")
                    || block.starts_with("zone ")
                    || block.starts_with("channel ")
            })
            .map(|block| {
                (
                    block.split_whitespace().take(2).collect::<Vec<_>>().join(" "),
                    without_source(block),
                )
            })
            .collect();
        of
    };
    let (annex_t, assessment) = (blocks("en14363-2016-annex-t"), blocks(ASSESSMENT));
    let common = assessment.iter().filter(|(name, _)| annex_t.contains_key(*name));
    assert!(common.clone().count() >= 24, "{}", common.clone().count());
    common.for_each(|(name, block)| assert_eq!(block, &annex_t[name], "{name}"));
}

fn without_source(block: &str) -> String {
    let mut kept = Vec::new();
    let mut source = false;
    for line in block.lines() {
        source = ["  source", "  unconfirmed"].iter().any(|key| line.starts_with(key))
            || source && line.starts_with("     ");
        if !source {
            kept.push(line);
        }
    }
    kept.join("\n")
}
