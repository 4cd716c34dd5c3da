//! Several campaigns evaluated as one.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{lines, replace, tiny};
use crate::common::program::{Certified, Ran, certify, fishplate};
use serde_json::Value;
use tempfile::TempDir;

const HEAD: &str = "protocol small \"Small\"\n  axis  distance in m\n  time  time in s\n\nplace wheelset\n  members  1, 3\n\nplace side\n  \
     members  R, L\n\nchannel Q \"Wheel force\"\n  in      kN\n  at      each wheelset and side\n  column  \"Q_{wheelset}{side}\"\n\n\
     vehicle wheel_load \"Static wheel load\"\n  in  kN\n  key  static_wheel_load\n\n";
const TAIL: &str = "\nverdict\n  validated  when every limit holds\n";

fn protocol(folder: &Path, rules: &str) -> String {
    let path = folder.join("small.fp");
    let verdict = if rules.contains("\nverdict\n") {
        TAIL.replace("\nverdict\n", "")
    } else {
        TAIL.to_string()
    };
    fs::write(&path, format!("{HEAD}{rules}{verdict}")).expect("written");
    path.display().to_string()
}

/// A quantity of the measurement with some limits.
fn assessed(limits: &[&str]) -> String {
    let limits: String = limits.iter().map(|limit| format!("  limit  {limit}\n")).collect();
    format!(
        "quantity Q_mean \"Wheel force\"\n  of  Q at wheelset 1\n  value  mean\n  from  measured\n{limits}"
    )
}

/// [`tiny`] under other names.
fn called(name: &str) -> TempDir {
    let folder = tiny();
    replace(&folder.path().join("campaign.yaml"), "name: Tiny", &format!("name: {name}"));
    folder
}

fn pooled(campaigns: &[&TempDir], rules: &str) -> Certified {
    let first = campaigns[0].path();
    let protocol = protocol(first, rules);
    let others: Vec<String> =
        campaigns[1..].iter().map(|campaign| campaign.path().display().to_string()).collect();
    let mut more: Vec<&str> = others.iter().map(String::as_str).collect();
    more.extend(["--protocol", &protocol, "--only", "results"]);
    certify(first, &more)
}

fn quantity(results: &Value) -> &Value {
    &results["quantities"][0]
}

fn statistic<'a>(results: &'a Value, name: &str, scope: &str) -> &'a Value {
    let all = quantity(results)["statistics"].as_array().expect("a list");
    let found = all.iter().find(|one| one["name"] == name && one["scope"] == scope);
    found.unwrap_or_else(|| panic!("no {name}, {scope}: {all:#?}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-12 * expected.abs().max(1.0),
        "{found} in place of {expected}"
    );
}

/// Twice the same rows: the same mean, and sums of squares over 2n - 1 in place of n - 1.
#[test]
fn a_campaign_with_itself_has_the_mean_and_the_spread_that_follow() {
    let (a, b) = (called("A"), called("B"));
    let rules = assessed(&["mean 100 kN", "std 100 kN", "std 100 kN for each campaign"]);
    let one = pooled(&[&a], &rules).results();
    let found = pooled(&[&a, &b], &rules);
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let two = found.results();
    let pairs = number(&quantity(&one)["pairs"]);
    assert_eq!(
        (pairs, number(&quantity(&two)["pairs"]), number(&quantity(&two)["n"])),
        (24.0, 48.0, 24.0)
    );
    let value = |results: &Value, name: &str, scope: &str| {
        number(&statistic(results, name, scope)["value"])
    };
    near(value(&two, "mean", "all"), value(&one, "mean", "all"));
    near(
        value(&two, "std", "all"),
        value(&one, "std", "all") * (2.0 * (pairs - 1.0) / (2.0 * pairs - 1.0)).sqrt(),
    );
    for scope in ["campaign A", "campaign B"] {
        assert_eq!(value(&two, "std", scope).to_bits(), value(&one, "std", "all").to_bits());
        assert_eq!(statistic(&two, "std", scope)["group"]["campaign"], scope[9..]);
    }
    // Everything says which campaign it is of.
    assert_eq!(two["campaign"]["name"], "A + B");
    assert_eq!(two["campaign"]["members"][1]["short_name"], "B");
    let rows = quantity(&two)["values"].as_array().expect("a list");
    assert_eq!(
        (&rows[47]["campaign"], &rows[47]["section"]),
        (&Value::from("B"), &Value::from("B/S12"))
    );
    assert_eq!(
        (&two["sections"][12]["campaign"], &two["sections"][12]["section"]),
        (&Value::from("B"), &Value::from("B/S01"))
    );
    let files = two["campaign"]["files"].as_array().expect("a list");
    let paths: Vec<&str> = files.iter().filter_map(|file| file["path"].as_str()).collect();
    assert_eq!(
        (paths[0], paths[3], paths.last().copied()),
        ("A/campaign.yaml", "B/campaign.yaml", Some("B/measurement/S12.csv"))
    );
    assert!(
        found.text("tables/values.csv").contains("\nQ_mean,kN,B,B/S12,"),
        "{}",
        found.text("tables/values.csv")
    );
    assert!(found.text("tables/sections.csv").starts_with("campaign,section,"));
}

/// Both halves of a campaign, one after the other, are the campaign to the last digit.
#[test]
fn halves_are_the_whole() {
    let whole = called("Whole");
    let (first, second) = (called("First"), called("Second"));
    for (half, kept) in [(&first, 1..7), (&second, 7..13)] {
        lines(&half.path().join("sections.csv"), |all| {
            *all = std::iter::once(0).chain(kept).map(|row| all[row].clone()).collect()
        });
    }
    let limits = [
        "mean 100 kN",
        "std 100 kN",
        "p95 100 kN",
        "upper 95 % of std 100 kN",
        "(mean + 3 * std) 100 kN for each side",
    ];
    let rules = assessed(&limits);
    let results = |found: Certified| found.results();
    let (one, two) =
        (results(pooled(&[&whole], &rules)), results(pooled(&[&first, &second], &rules)));
    let bits = |results: &Value| -> Vec<(String, u64, Value)> {
        let all = quantity(results)["statistics"].as_array().expect("a list").clone();
        let of = |one: &Value| {
            (
                format!("{} {}", one["name"], one["scope"]),
                number(&one["value"]).to_bits(),
                one["interval"].clone(),
            )
        };
        all.iter().map(of).collect()
    };
    assert_eq!(bits(&one), bits(&two));
    assert_eq!(one["verdict"], two["verdict"]);
}

/// A limit with a vehicle datum: each row and each group has its own; one limit of two vehicles has
/// none.
#[test]
fn vehicles_of_campaigns_may_differ() {
    let (a, b) = (called("A"), called("B"));
    replace(&b.path().join("vehicle.yaml"), "static_wheel_load: 50", "static_wheel_load: 60");
    let limits = [
        "each 2 * wheel_load",
        "mean 2 * wheel_load for each campaign",
        "std 100 kN only when wheel_load > 55 kN for each campaign",
    ];
    let found = pooled(&[&a, &b], &assessed(&limits));
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let limit = |scope: &str| number(&statistic(&results, "mean", scope)["limit"]);
    assert_eq!((limit("campaign A"), limit("campaign B")), (100.0, 120.0));
    let stds = quantity(&results)["statistics"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|one| one["name"] == "std");
    assert_eq!(stds.map(|one| one["scope"].clone()).collect::<Vec<_>>(), ["campaign B"]);
    let vehicle = results["campaign"]["vehicle"].as_array().expect("a list");
    let loads: Vec<_> = vehicle
        .iter()
        .filter(|item| item["used"] == true)
        .map(|item| (&item["of"], &item["value"]))
        .collect();
    assert_eq!(
        loads,
        [(&Value::from("A"), &Value::from("50")), (&Value::from("B"), &Value::from("60"))]
    );
    let findings = results["findings"].as_array().expect("a list");
    let assumed: Vec<&Value> = findings
        .iter()
        .filter(|finding| finding["code"] == "unit-assumed")
        .map(|one| &one["says"])
        .collect();
    assert_eq!(
        assumed[1],
        "the vehicle file of B states no unit; read in the unit of the protocol: static_wheel_load = 60 kN"
    );

    let found = pooled(&[&a, &b], &assessed(&["mean 2 * wheel_load"]));
    assert_eq!(found.ran.code, 1);
    let results = found.results();
    let reason = "Q_mean: mean: its limit cannot be evaluated: it depends on the vehicle: 100.0 kN for A, 120.0 kN for B; give each its \
                  own: `for each campaign`";
    assert_eq!(
        (&results["verdict"], &results["reasons"][0]),
        (&Value::from("not assessable"), &Value::from(reason))
    );
    // What differs and does not enter is no matter.
    assert_eq!(
        pooled(&[&a, &b], &assessed(&["mean 100 kN", "std 20 kN times 2 when wheel_load > 10 kN"]))
            .ran
            .code,
        0
    );
}

#[test]
fn campaigns_are_a_key_of_conditions_and_of_independence() {
    let (a, b) = (called("First series"), called("B"));
    let limits = [
        "mean 100 kN for sections where campaign is \"First series\"",
        "std 100 kN for sections where campaign is not \"First series\"",
    ];
    let results = pooled(&[&a, &b], &assessed(&limits)).results();
    let all = quantity(&results)["statistics"].as_array().expect("a list");
    assert_eq!(all.iter().map(|one| number(&one["count"])).collect::<Vec<_>>(), [24.0, 24.0]);
    // Each campaign is one unit, and one campaign alone is the only one.
    let one_unit = format!("{}\nverdict\n  independent  campaign\n", assessed(&["mean 100 kN"]));
    assert_eq!(number(&quantity(&pooled(&[&a, &b], &one_unit).results())["n"]), 2.0);
    assert_eq!(number(&quantity(&pooled(&[&a], &one_unit).results())["n"]), 1.0);
    let found = pooled(
        &[&a, &b],
        &assessed(&["mean 100 kN for sections where campaign is \"Frist series\""]),
    );
    assert_eq!(found.ran.code, 2);
    assert!(
        found.ran.stderr.contains("none of the campaigns is called `Frist series`"),
        "{}",
        found.ran.stderr
    );
    assert!(found.ran.stderr.contains("did you mean `First series`?"), "{}", found.ran.stderr);
}

/// Sites of campaigns differ, unless the column `site` names the same place in both.
#[test]
fn a_site_may_be_of_two_campaigns() {
    let (a, b) = (called("A"), called("B"));
    let rules = assessed(&["mean 100 kN"]);
    let n = |a: &TempDir, b: &TempDir| number(&quantity(&pooled(&[a, b], &rules).results())["n"]);
    assert_eq!(n(&a, &b), 24.0);
    for folder in [&a, &b] {
        lines(&folder.path().join("sections.csv"), |all| {
            let names =
                std::iter::once("site").chain(["km 12", "km 15"]).chain(std::iter::repeat(""));
            *all = all.iter().zip(names).map(|(line, site)| format!("{line},{site}")).collect();
        });
    }
    assert_eq!(n(&a, &b), 22.0);
}

/// The same record in two campaigns is no second measurement, and is told.
#[test]
fn a_record_in_two_campaigns_is_a_copy() {
    let (a, b) = (called("A"), called("B"));
    let more = "plausibility copies \"Copies\"\n  of  Q\n  distinct  channels, sections\n  otherwise  not used\n\n";
    let found = pooled(&[&a, &b], &format!("{more}{}", assessed(&["mean 100 kN"])));
    let reason = found.reason("B/S03").expect("not used");
    assert!(
        reason.contains("repeats the samples of the same channels of section A/S03"),
        "{reason}"
    );
    let findings = found.results()["findings"].clone();
    let copy = findings
        .as_array()
        .expect("a list")
        .iter()
        .find(|finding| finding["code"] == "copies")
        .expect("a finding")
        .clone();
    assert_eq!((&copy["campaign"], &copy["section"]), (&Value::from("B"), &Value::from("B/S01")));
    // A verdict on both needs something of both.
    let results = found.results();
    assert_eq!((found.ran.code, &results["verdict"]), (1, &Value::from("not assessable")));
    assert_eq!(results["reasons"][0], "no section of campaign B is used");
}

#[test]
fn a_report_of_a_pool_is_verified_and_traced() {
    let (a, b) = (called("A"), called("B"));
    replace(&b.path().join("vehicle.yaml"), "static_wheel_load: 50", "static_wheel_load: 60");
    let protocol =
        protocol(a.path(), &assessed(&["mean 2 * wheel_load for each campaign", "std 100 kN"]));
    let (first, second) = (a.path().display().to_string(), b.path().display().to_string());
    let found = certify(a.path(), &[&second, "--protocol", &protocol]);
    assert_eq!(found.ran.code, 0, "{}", found.ran.stderr);
    let report = found.folder().join("report.pdf").display().to_string();
    let verified = fishplate(&["verify", &report, &second, &first]);
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    assert!(verified.stdout.contains("byte for byte"), "{}", verified.stdout);
    let one = fishplate(&["verify", &report, &first]);
    assert!(
        one.code == 2
            && one.stderr.contains("the report is of 2 campaigns, not of 1; give these: A; B"),
        "{}",
        one.stderr
    );
    let thrice = fishplate(&["verify", &report, &first, &second, &first]);
    assert!(
        thrice.code == 2 && thrice.stderr.contains("the report is of 2 campaigns, not of 3"),
        "{}",
        thrice.stderr
    );
    let one = fishplate(&["trace", &report, "Q_mean", "B/S02", "Q_1R", "--campaign", &first]);
    assert!(
        one.code == 2 && one.stderr.contains("the report is of 2 campaigns, not of 1"),
        "{}",
        one.stderr
    );
    let trace =
        |of: &[&str]| fishplate(&[&["trace", &report, "Q_mean", "B/S02", "Q_1R"], of].concat());
    let traced: Ran = trace(&["--campaign", &first, "--campaign", &second]);
    assert_eq!(traced.code, 0, "{}{}", traced.stdout, traced.stderr);
    assert!(
        traced.stdout.contains("\nB/measurement/S02.csv\n")
            && traced.stdout.contains("as in the report"),
        "{}",
        traced.stdout
    );
    let page = found.text("report.html");
    assert!(
        page.contains("A + B")
            && page.contains("Campaign B")
            && page.contains("Static wheel load (B)"),
        "the page lists the campaigns"
    );
    // What was changed is told with its campaign.
    replace(&b.path().join("vehicle.yaml"), "static_wheel_load: 60", "static_wheel_load: 61");
    let changed = fishplate(&["verify", &report, &first, &second]);
    assert!(
        changed.code == 1 && changed.stdout.contains("changed: B/vehicle.yaml"),
        "{}",
        changed.stdout
    );
}

/// A study of a pool takes sections of all campaigns.
#[test]
fn sections_of_a_pool_are_studied() {
    let (a, b) = (called("A"), called("B"));
    let out = tempfile::tempdir().expect("a folder");
    let path = |folder: &TempDir| folder.path().display().to_string();
    let protocol = protocol(
        a.path(),
        &assessed(&["mean 100 kN", "std 100 kN"])
            .replace("  from  measured\n", "  difference  simulated - measured\n"),
    );
    let found = fishplate(&[
        "study",
        "sections",
        &path(&a),
        &path(&b),
        "--protocol",
        &protocol,
        "--out",
        &path(&out),
        "--take",
        "3",
    ]);
    assert_eq!(found.code, 0, "{}", found.stderr);
    let text = fs::read_to_string(out.path().join("study.json")).expect("written");
    let study: Value = serde_json::from_str(&text).expect("JSON");
    // 24 sections, 3 at a time.
    assert_eq!(number(&study["combinations"]), 2024.0);
    assert_eq!(study["campaign"]["members"][0]["short_name"], "A");
}

#[test]
fn what_cannot_stand_side_by_side_is_told() {
    let wrong = |campaigns: &[&TempDir], more: &[&str], says: &[&str]| {
        let others: Vec<PathBuf> =
            campaigns[1..].iter().map(|folder| folder.path().to_path_buf()).collect();
        let mut all: Vec<&str> = others.iter().filter_map(|path| path.to_str()).collect();
        all.extend(more);
        let found = certify(campaigns[0].path(), &all);
        assert_eq!(found.ran.code, 2, "{}", found.ran.stdout);
        for says in says {
            assert!(found.ran.stderr.contains(says), "{says}: {}", found.ran.stderr);
        }
    };
    let (a, b) = (called("A"), called("A"));
    wrong(
        &[&a, &b],
        &[],
        &["error[duplicate-name]: two campaigns are called `A`", "short name: series 2"],
    );
    wrong(&[&a, &a], &[], &["error[campaign-twice]"]);
    let campaign = |folder: &TempDir| folder.path().join("campaign.yaml");
    replace(&campaign(&b), "name: A", "name: A\nshort name: A/2");
    wrong(&[&a, &b], &[], &["error[name-invalid]", "campaign.yaml:2:13"]);
    replace(&campaign(&b), "A/2", "A 2\nparameters:\n  evaluated_wheelsets: 1");
    wrong(
        &[&a, &b],
        &[],
        &["error[parameters-differ]", "not in the campaign `A`", "--set evaluated_wheelsets="],
    );
    replace(&campaign(&b), "parameters:\n  evaluated_wheelsets: 1", "protocol: other.fp");
    wrong(
        &[&a, &b],
        &[],
        &["error[several-protocols]: the campaigns name different protocols: none and `other.fp`"],
    );
    replace(&campaign(&a), "name: A", "name: A\nprotocol: other.fp");
    wrong(&[&a, &b], &[], &["each campaign has a protocol `other.fp` of its own"]);
}

/// [`tiny`] with a vehicle file for each state: the first six sections tare, the others laden.
fn states() -> TempDir {
    let folder = tiny();
    let file = |name: &str| folder.path().join(name);
    replace(
        &file("campaign.yaml"),
        "vehicle: vehicle.yaml",
        "vehicle: {tare: vehicle.yaml, laden: laden.yaml}",
    );
    fs::copy(file("vehicle.yaml"), file("laden.yaml")).expect("copied");
    replace(&file("laden.yaml"), "static_wheel_load: 50", "static_wheel_load: 60 kN");
    lines(&file("sections.csv"), |all| {
        let states = std::iter::once("state").chain(["tare"; 6]).chain(["laden"; 6]);
        *all = all.iter().zip(states).map(|(line, state)| format!("{line},{state}")).collect();
    });
    folder
}

#[test]
fn each_state_has_its_vehicle() {
    let folder = states();
    let state = "section state \"State\"\n  one of  tare, laden\n\n";
    let limits = ["each 2 * wheel_load", "mean 2 * wheel_load for each state"];
    let found = pooled(&[&folder], &format!("{state}{}", assessed(&limits)));
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let limit = |scope: &str| number(&statistic(&results, "mean", scope)["limit"]);
    assert_eq!((limit("state tare"), limit("state laden")), (100.0, 120.0));
    assert_eq!(
        (&results["sections"][0]["vehicle"], &results["sections"][11]["vehicle"]),
        (&Value::from("tare"), &Value::from("laden"))
    );
    assert!(results["sections"][0].get("campaign").is_none());
    let found = pooled(&[&folder], &format!("{state}{}", assessed(&["mean 2 * wheel_load"])));
    let reason = "Q_mean: mean: its limit cannot be evaluated: it depends on the vehicle: 100.0 kN for tare, 120.0 kN for laden; give each \
                  its own: `for each state`";
    assert_eq!(found.results()["reasons"][0], reason);
    // A report of it is verified, and says which is which.
    let protocol = protocol(folder.path(), &format!("{state}{}", assessed(&limits)));
    let found = certify(folder.path(), &["--protocol", &protocol]);
    let (report, campaign) =
        (found.folder().display().to_string(), folder.path().display().to_string());
    let verified = fishplate(&["verify", &report, &campaign]);
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    assert!(found.text("report.html").contains("Static wheel load (laden)"));
    // Of two campaigns, every vehicle has a name of its own.
    let other = called("B");
    let results = pooled(&[&folder, &other], &assessed(&["each 2 * wheel_load"])).results();
    let vehicles: Vec<&Value> = results["sections"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|section| &section["vehicle"])
        .collect();
    assert_eq!(
        (vehicles[0], vehicles[6], vehicles[12]),
        (&Value::from("Tiny, tare"), &Value::from("Tiny, laden"), &Value::from("B"))
    );
}

#[test]
fn states_that_are_no_states_are_told() {
    let rules = assessed(&["mean 100 kN"]);
    let wrong = |folder: &TempDir, says: &[&str]| {
        let found = pooled(&[folder], &rules);
        assert_eq!(found.ran.code, 2, "{}", found.ran.stdout);
        for says in says {
            assert!(found.ran.stderr.contains(says), "{says}: {}", found.ran.stderr);
        }
    };
    let folder = states();
    let table = folder.path().join("sections.csv");
    lines(&table, |all| all[3] = all[3].replace(",tare", ",tara"));
    wrong(
        &folder,
        &[
            "error[unknown-state]: section S03: there is no vehicle file for the state `tara`",
            "sections.csv:4:",
            "did you mean `tare`?",
        ],
    );
    lines(&table, |all| all[3] = all[3].replace(",tara", ","));
    wrong(&folder, &["error[missing-state]: section S03 has no state", "known here: tare, laden"]);
    lines(&table, |all| all[0] = all[0].replace(",state", ",stat"));
    wrong(
        &folder,
        &[
            "error[missing-column]: the table of sections has no column `state`",
            "did you mean `stat`?",
        ],
    );
    let one = states();
    let ran = fishplate(&["diagnose", &one.path().display().to_string(), "--out", "target/never"]);
    assert!(ran.code == 2 && ran.stderr.contains("error[several-vehicles]"), "{}", ran.stderr);
    replace(&one.path().join("campaign.yaml"), "{tare: vehicle.yaml, laden: laden.yaml}", "{}");
    wrong(&one, &["error[wrong-kind]: `vehicle` names no file"]);
}
