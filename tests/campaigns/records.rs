//! Campaigns with several records of a side, and sections measured twice.

use crate::common;

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::campaign::{copy, replace, tiny};
use crate::common::program::{Certified, certify, fishplate};
use fishplate::metrics::percentile::{Method, percentile};
use serde_json::Value;
use tempfile::TempDir;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

const HEAD: &str = "protocol small \"Small\"\n  axis  distance in m\n  time  time in s\n\nplace wheelset\n  members  1, 3\n\nplace side\n  \
     members  R, L\n\nplace gear\n  members  I, II\n\nchannel Q \"Wheel force\"\n  in      kN\n  at      each wheelset and side\n  \
     column  \"Q_{wheelset}{side}\"\n\nchannel az \"Vertical acceleration\"\n  in      m/s^2\n  at      each gear\n  column  \"az_{gear}\"\n\n";
const TAIL: &str = "\nverdict\n  validated  when every limit holds\n";

fn protocol(folder: &Path, quantities: &str) -> String {
    let path = folder.join("small.fp");
    fs::write(&path, format!("{HEAD}{quantities}{TAIL}")).expect("written");
    path.display().to_string()
}

/// Each code has the measured wheel forces and a known offset [kN]: mean 3, median 2.
const CODES: [(&str, f64); 3] = [("alpha", 1.0), ("beta", 2.0), ("gamma", 6.0)];

/// Three simulations of [`tiny`], in folders of `simulation`.
fn three_codes() -> TempDir {
    let folder = tiny();
    let measured = folder.path().join("measurement");
    for (name, offset) in CODES {
        let to = folder.path().join("simulation").join(name);
        fs::create_dir_all(&to).expect("a folder");
        for entry in fs::read_dir(&measured).expect("records") {
            let path = entry.expect("an entry").path();
            let text = fs::read_to_string(&path).expect("a record");
            let heads: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
            let line = |line: &str| -> String {
                let cell = |(cell, head): (&str, &&str)| match cell.parse::<f64>() {
                    Ok(value) if head.starts_with("Q_") => format!("{:.3}", value + offset),
                    _ => cell.to_string(),
                };
                line.split(',').zip(&heads).map(cell).collect::<Vec<_>>().join(",") + "\n"
            };
            fs::write(
                to.join(path.file_name().expect("a name")),
                text.lines().map(line).collect::<String>(),
            )
            .expect("written");
        }
    }
    let list = "simulation: [simulation/alpha, simulation/beta, simulation/gamma]";
    replace(&folder.path().join("campaign.yaml"), "simulation: simulation", list);
    folder
}

fn run(folder: &Path, quantities: &str) -> Certified {
    let protocol = protocol(folder, quantities);
    certify(folder, &["--protocol", &protocol, "--only", "results"])
}

fn quantity<'a>(results: &'a Value, id: &str) -> &'a Value {
    let all = results["quantities"].as_array().expect("a list");
    all.iter().find(|quantity| quantity["id"] == id).unwrap_or_else(|| panic!("no quantity {id}"))
}

/// Value, pairs and sites of each group of a statistic, by the record of the group.
fn by_record(quantity: &Value, name: &str) -> Vec<(String, f64, u64, u64)> {
    let all = quantity["statistics"].as_array().expect("a list");
    let of = |one: &Value| {
        let number = |key: &str| one[key].as_u64().expect("a number");
        let record = one["group"]["record"].as_str().unwrap_or("all").to_string();
        (record, one["value"].as_f64().expect("a number"), number("count"), number("n"))
    };
    all.iter().filter(|one| one["name"] == name).map(of).collect()
}

#[track_caller]
fn assert_records(found: &[(String, f64, u64, u64)], expected: &[(&str, f64, u64, u64)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, (name, value, count, n)) in found.iter().zip(expected) {
        assert_eq!((found.0.as_str(), found.2, found.3), (*name, *count, *n));
        assert!((found.1 - value).abs() < 1e-9, "{name}: {} in place of {value}", found.1);
    }
}

/// Twelve sections, two signals each. The codes raise the count and not n, whose units are sites.
#[test]
fn several_codes_are_compared_with_each_other_and_with_the_measurement() {
    let folder = three_codes();
    let of = |id: &str, how: &str| {
        format!(
            "quantity {id} \"{id}\"\n  of  Q at wheelset 1\n  value  mean\n{how}  limit  mean 100 kN for each record\n  \
             limit  std 100 kN for each record\n  limit  p50 100 kN\n\n"
        )
    };
    let compared = |with: &str| format!("  compare  {with}\n  difference  simulated - measured\n");
    let text = [
        of("mean", &compared("simulated with mean of simulated")),
        of("median", &compared("simulated with median of simulated")),
        of("plain", &compared("simulated with measured")),
        of("alone", "  from  simulated\n"),
        of("tested", "  from  measured\n").replace(" for each record", ""),
    ];
    let found = run(folder.path(), &text.concat());
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    for (id, expected) in
        [("mean", [-2.0, -1.0, 3.0]), ("median", [-1.0, 0.0, 4.0]), ("plain", [1.0, 2.0, 6.0])]
    {
        let quantity = quantity(&results, id);
        let group = |at: usize| (CODES[at].0, expected[at], 24, 12);
        assert_records(&by_record(quantity, "mean"), &[group(0), group(1), group(2)]);
        assert!(by_record(quantity, "std").iter().all(|(_, value, ..)| value.abs() < 1e-9), "{id}");
        assert_records(&by_record(quantity, "p50"), &[("all", expected[1], 72, 12)]);
    }
    // The measured values and the offset of each code.
    let tested = by_record(quantity(&results, "tested"), "mean")[0].1;
    let group = |at: usize| (CODES[at].0, tested + CODES[at].1, 24, 12);
    assert_records(
        &by_record(quantity(&results, "alone"), "mean"),
        &[group(0), group(1), group(2)],
    );
    let files = results["campaign"]["files"].as_array().expect("a list");
    let named = files
        .iter()
        .filter(|file| file["record"]["name"] == "beta" && file["record"]["kind"] == "simulation")
        .count();
    let measured = files.iter().filter(|file| file["record"]["kind"] == "measurement");
    assert_eq!(
        (named, measured.filter(|file| file["record"].get("name").is_none()).count()),
        (12, 12)
    );
}

/// The rows of a table in `tables/`, without its head.
fn rows_of(found: &Certified, table: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(found.folder().join("tables").join(table)).expect("a table");
    text.lines().skip(1).map(|line| line.split(',').map(str::to_string).collect()).collect()
}

/// Deviations from the mean of the codes: -2, -1 and 3 kN at every section and signal.
#[test]
fn the_spread_of_the_codes_is_a_table() {
    let folder = three_codes();
    let protocol = protocol(
        folder.path(),
        "quantity Q \"Wheel force\"\n  of  Q at wheelset 1\n  value  mean\n  compare  simulated with mean of simulated\n  \
         difference  simulated - measured\n  limit  mean 100 kN for each record\n\n\
         quantity plain \"Plain\"\n  of  Q at wheelset 1\n  value  mean\n  difference  simulated - measured\n  limit  mean 100 kN\n",
    );
    let found = certify(folder.path(), &["--protocol", &protocol, "--only", "html"]);
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let near = |text: &str, wanted: f64| {
        assert!(
            (text.parse::<f64>().expect("a number") - wanted).abs() < 1e-9,
            "{text} in place of {wanted}"
        )
    };
    let rows = rows_of(&found, "spreads.csv");
    let all: Vec<&Vec<String>> = rows.iter().filter(|row| row[3].is_empty()).collect();
    for (row, (name, mean, rank)) in
        all.iter().zip([("alpha", -2.0, "2"), ("beta", -1.0, "1"), ("gamma", 3.0, "3")])
    {
        assert_eq!(
            (row[0].as_str(), row[4].as_str(), row[5].as_str(), row[12].as_str()),
            ("Q", name, "24", rank)
        );
        near(&row[6], mean);
        near(&row[7], 0.0);
        near(&row[8], mean);
        near(&row[11], mean.abs());
    }
    assert_eq!(all.len(), 3);
    let between = rows_of(&found, "spreads_between.csv");
    let row = between.iter().find(|row| row[3].is_empty()).expect("all sections");
    assert_eq!((row[2].as_str(), row[4].as_str(), row[5].as_str()), ("mean", "3", "24"));
    for (cell, wanted) in [(6, 5.0), (7, 7_f64.sqrt()), (8, 5.0), (9, 7_f64.sqrt()), (10, 5.0)] {
        near(&row[cell], wanted);
    }
    let page = fs::read_to_string(found.folder().join("report.html")).expect("a page");
    // The plot shows all codes, in the section where one is farthest from their mean.
    assert!(
        page.contains("Records gamma, alpha, beta: Q_1")
            && page.matches("class=\"curve other\"").count() == 2
    );
    assert_eq!(page.matches("<table class=\"spread\">").count(), 1);
    for word in [
        "Spread of the codes in",
        "deviations from the mean of all codes",
        "Spread of the codes, largest",
        "Max. − min. of the codes",
    ] {
        assert!(page.contains(word), "{word}");
    }
}

/// A rule is printed with the values of its parameters.
#[test]
fn values_and_metrics_are_printed_with_the_values_of_parameters() {
    let folder = tiny();
    let quantities = "parameter factor \"Factor\"\n  default  1.25\n\nparameter weight \"Weight\"\n  default  0.4\n\n\
                      quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  factor * mean\n  difference  weight * (simulated - measured)\n  \
                      limit  mean 100 kN\n\n\
                      quantity rating \"Rating\"\n  of  Q at wheelset 1\n  metric  weight * correlation + 0.6 * (1 - theil_inequality)\n  \
                      limit  p50 2\n";
    let found = run(folder.path(), quantities);
    assert_eq!(
        found.results()["quantities"][1]["metric"],
        "0.4 * correlation + 0.6 * (1 - theil_inequality)",
        "{}",
        found.ran.stderr
    );
    assert_eq!(rows_of(&found, "summary.csv")[0][3], "1.25 * mean");
}

/// Pairs of site and signal count once, however many codes give them.
#[test]
fn several_codes_are_no_further_pairs() {
    let folder = three_codes();
    let of = |pairs: u32| {
        format!(
            "quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  mean\n  difference  simulated - measured\n  limit  mean 100 kN\n  \
             minimum pairs  {pairs}\n"
        )
    };
    assert_eq!(run(folder.path(), &of(24)).ran.code, 0);
    let found = run(folder.path(), &of(25));
    assert_eq!(
        found.results()["reasons"][0],
        "Q: 24 pairs of site and signal (a repeat is no further section); at least 25 required"
    );
}

/// The offsets of the codes are 1, 2 and 6 kN, on average 3 kN.
#[test]
fn a_good_simulation_does_not_hide_a_bad_one() {
    let folder = three_codes();
    let path = folder.path();
    let of = |limit: &str| {
        format!(
            "quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  mean\n  difference  simulated - measured\n  limit  {limit}\n"
        )
    };
    let verdict = |rules: &str| run(path, rules).results()["verdict"].clone();
    assert_eq!(verdict(&of("mean 7 kN")), "validated");
    assert_eq!(verdict(&of("mean 2.5 kN")), "not validated");
    assert_eq!(verdict(&of("mean 4 kN for each record")), "not validated");
    let found = run(path, &of("mean 4 kN"));
    let reason = "Q: 3 simulations together meet the limits, but gamma by itself does not: mean 6.00 kN exceeds the limit 4.00 kN by 50 %; \
                  add `for each record` to the limits, or certify one simulation at a time";
    assert_eq!((found.ran.code, &found.results()["reasons"][0]), (1, &Value::from(reason)));
    let report = found.folder().join("results.json").display().to_string();
    let (here, small) = (path.display().to_string(), path.join("small.fp").display().to_string());
    let verified = fishplate(&["verify", &report, &here, "--protocol", &small]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    // The same for values of the simulations alone: the largest mean of all is far above that of
    // alpha and beta.
    let assessed = |limit: String| {
        of(&limit).replace("  difference  simulated - measured", "  from  simulated")
    };
    let mean_of = |at: usize| {
        by_record(
            quantity(&run(path, &assessed("mean 1000 kN for each record".into())).results(), "Q"),
            "mean",
        )[at]
            .1
    };
    let between = (mean_of(0) + mean_of(1) + mean_of(2)) / 3.0 + 1.0;
    let found = run(path, &assessed(format!("mean {between} kN")));
    assert!(
        found.results()["reasons"][0]
            .as_str()
            .is_some_and(|reason| reason.contains("but gamma by itself does not"))
    );
    assert_eq!(run(path, &assessed(format!("mean {} kN", mean_of(2) + 0.5))).ran.code, 0);
    // Who names records knows of several.
    let codes = "record codes \"Codes\"\n  is  simulated alpha, beta, gamma\n\n";
    let named =
        of("mean 4 kN").replace("  difference", "  compare  codes with measured\n  difference");
    assert_eq!(verdict(&format!("{codes}{named}")), "validated");
    // Two runs of the measurement are no two models.
    let campaign = path.join("campaign.yaml");
    replace(&campaign, "[simulation/alpha, simulation/beta, simulation/gamma]", "simulation/alpha");
    replace(
        &campaign,
        "measurement: measurement",
        "measurement: [simulation/beta, simulation/gamma]",
    );
    assert_eq!(verdict(&of("mean 4 kN")), "validated");
}

/// Runs and codes: every pair has a name, and reports of them can be verified and traced.
#[test]
fn runs_and_codes_are_paired_verified_and_traced() {
    let folder = three_codes();
    let path = folder.path();
    fs::rename(path.join("measurement"), path.join("first")).expect("renamed");
    fs::rename(path.join("simulation/gamma"), path.join("second")).expect("renamed");
    let campaign = path.join("campaign.yaml");
    replace(&campaign, "measurement: measurement", "measurement: {monday: first, tuesday: second}");
    replace(
        &campaign,
        "[simulation/alpha, simulation/beta, simulation/gamma]",
        "{alpha: simulation/alpha, beta: simulation/beta}",
    );
    let found = run(
        path,
        "quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  mean\n  difference  simulated - measured\n  limit  mean 100 kN for each record\n\n\
         quantity spread \"Spread\"\n  of  Q at wheelset 1\n  value  mean\n  compare  measured with mean of measured\n  \
         difference  simulated - measured\n  limit  std 100 kN\n\n\
         quantity misfit \"Misfit\"\n  of  Q at wheelset 1\n  metric  misfit\n  limit  p80 1\n",
    );
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let expected = [
        ("alpha, monday", 1.0, 24, 12),
        ("alpha, tuesday", -5.0, 24, 12),
        ("beta, monday", 2.0, 24, 12),
        ("beta, tuesday", -4.0, 24, 12),
    ];
    assert_records(&by_record(quantity(&results, "Q"), "mean"), &expected);
    assert_eq!(quantity(&results, "misfit")["values"].as_array().map(Vec::len), Some(96));
    let report = found.folder().join("results.json").display().to_string();
    let (here, small) = (path.display().to_string(), path.join("small.fp").display().to_string());
    let verified = fishplate(&["verify", &report, &here, "--protocol", &small]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    let trace = |quantity: &str, more: &[&str]| {
        let mut all = vec![
            "trace",
            &report,
            quantity,
            "S05",
            "Q_1R",
            "--campaign",
            &here,
            "--protocol",
            &small,
        ];
        all.extend(more);
        fishplate(&all)
    };
    let several = trace("Q", &[]);
    assert!(
        several.code == 2 && several.stderr.contains("alpha, monday; alpha, tuesday"),
        "{}",
        several.stderr
    );
    let unknown = trace("Q", &["--record", "alfa, monday"]);
    assert!(
        unknown.code == 2 && unknown.stderr.contains("did you mean `alpha, monday`?"),
        "{}",
        unknown.stderr
    );
    let one = trace("Q", &["--record", "beta, tuesday"]);
    assert_eq!(one.code, 0, "{}{}", one.stdout, one.stderr);
    for (file, there) in [
        ("simulation/beta/S05.csv", true),
        ("second/S05.csv", true),
        ("first/S05.csv", false),
        ("alpha/S05.csv", false),
    ] {
        assert_eq!(one.stdout.contains(file), there, "{file}: {}", one.stdout);
    }
    assert_eq!(one.stdout.matches("as in the report").count(), 3, "{}", one.stdout);
    let spread = trace("spread", &["--record", "monday"]);
    assert!(
        spread.code == 0 && spread.stdout.contains("second/S05.csv"),
        "{}{}",
        spread.stdout,
        spread.stderr
    );
}

/// A sound campaign stays so where one code is given as a list, to the last byte of its results.
#[test]
fn a_list_of_one_is_one_record() {
    let (plain, listed) = (tiny(), tiny());
    let quantities = "quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  rms\n  difference  simulated - measured\n  limit  std 100 kN for each record\n";
    replace(
        &listed.path().join("campaign.yaml"),
        "simulation: simulation",
        "simulation: [simulation]",
    );
    let quantities =
        |folder: &TempDir| run(folder.path(), quantities).results()["quantities"].clone();
    assert_eq!(quantities(&plain), quantities(&listed));
}

/// The plausibility of every record is looked at, and a finding names it; a fault of one record is
/// one of the section.
#[test]
fn every_record_is_looked_at() {
    let folder = three_codes();
    let text = "plausibility level \"Level of the wheel force\"\n  of  Q at wheelset 1 and side R\n  require  maximum < 1000 kN\n  otherwise  note\n\n\
                quantity Q \"Q\"\n  of  Q at wheelset 1\n  value  mean\n  difference  simulated - measured\n  limit  mean 100 kN\n";
    replace(&folder.path().join("simulation/beta/S03.csv"), "0.50,", "0.50,");
    let path = folder.path().join("simulation/beta/S03.csv");
    common::campaign::cell(&path, 300, "Q_1R [kN]", "5000");
    let found = run(folder.path(), text);
    let results = found.results();
    let finding = &results["findings"][0];
    assert_eq!(
        (finding["section"].as_str(), finding["record"].as_str()),
        (Some("S03"), Some("simulation beta")),
        "{finding}"
    );
    fs::remove_file(&path).expect("removed");
    let results = run(folder.path(), text).results();
    let section = results["sections"]
        .as_array()
        .and_then(|all| all.iter().find(|section| section["section"] == "S03"))
        .expect("S03");
    assert_eq!(section["used"], false);
    assert!(
        section["reason"].as_str().is_some_and(|reason| reason.contains("simulation/beta/S03.csv")),
        "{section}"
    );
}

/// What needs one simulation says that there are several.
#[test]
fn who_needs_one_record_refuses_several() {
    let folder = three_codes();
    let out = tempfile::tempdir().expect("a folder");
    let (here, out) =
        (folder.path().display().to_string(), out.path().join("new").display().to_string());
    for arguments in [
        &["study", "sync", "--offsets", "0,1"][..],
        &["study", "sections"],
        &["diagnose"],
        &["simulate", "--increment", "--effect", "friction=0.2"],
    ] {
        let (command, options) = arguments.split_at(if arguments[0] == "study" { 2 } else { 1 });
        let mut all = command.to_vec();
        all.extend([here.as_str(), "--out", &out]);
        all.extend(options);
        let ran = fishplate(&all);
        assert_ne!(ran.code, 0);
        assert!(
            ran.stderr.contains("error[several-records]")
                && ran.stderr.contains("campaign.yaml:5:13"),
            "{all:?}: {}",
            ran.stderr
        );
        assert!(!Path::new(&out).exists(), "{all:?}");
    }
}

/// Misfits of repeats and of the model, and the quality index, 1e-9; see
/// `cases/values/repeats/misfit.json`.
#[test]
fn repeats_are_compared_with_their_originals() {
    let folder = copy(&root().join("tests/cases/values/repeats"));
    let text = "filter LP20 \"Low-pass filter\"\n  step  low-pass 20 Hz, order 4, zero-phase, as-applied\n\n\
                quantity index \"Quality index\"\n  of  az at each gear\n  filter  LP20\n  metric  misfit\n  compare  repeats with originals\n  \
                limit  p80 1\n  limit  each 1\n\n\
                quantity model \"Misfit of the model\"\n  of  az at each gear\n  filter  LP20\n  metric  misfit\n  limit  p80 100\n\n\
                quantity values \"Extreme values measured again\"\n  of  az at each gear\n  filter  LP20\n  value  |p99.85|\n  \
                compare  repeats with originals\n  difference  (simulated - measured) / measured\n  limit  mean 1\n";
    let found = run(folder.path(), text);
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    assert_eq!(found.results()["verdict"], "validated");
    let results = found.results();
    let expected: Value = serde_json::from_str(
        &fs::read_to_string(folder.path().join("misfit.json")).expect("numbers"),
    )
    .expect("JSON");
    let mut numbers = Vec::new();
    for (id, key, count) in [("index", "repeats", 4), ("model", "model", 8)] {
        let values = quantity(&results, id)["values"].as_array().expect("a list");
        let expected = expected[key].as_array().expect("a list");
        assert_eq!((values.len(), expected.len()), (count, count), "{id}");
        for one in expected {
            let value = values.iter().find(|value| {
                value["section"] == one["section"] && value["signal"] == one["signal"]
            });
            let value = value.and_then(|value| value["value"].as_f64()).expect("a value");
            let want = one["misfit"].as_f64().expect("a number");
            assert!((value - want).abs() < 1e-9 * want.max(1.0), "{one}: {value}");
            if id == "index" {
                numbers.push(want);
            }
        }
    }
    let index = quantity(&results, "index");
    let p80 = percentile(&numbers, 80.0, Method::Linear).expect("a percentile");
    assert_records(&by_record(index, "p80"), &[("all", p80, 4, 2)]);
    // Each value of a repeat follows from its two sides, and is traced to both records.
    let report = found.folder().join("results.json").display().to_string();
    let (here, small) =
        (folder.path().display().to_string(), folder.path().join("small.fp").display().to_string());
    let verified = fishplate(&["verify", &report, &here, "--protocol", &small]);
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    for quantity in ["index", "values"] {
        let traced = fishplate(&[
            "trace",
            &report,
            quantity,
            "S18",
            "az_I",
            "--campaign",
            &here,
            "--protocol",
            &small,
        ]);
        assert_eq!(traced.code, 0, "{}{}", traced.stdout, traced.stderr);
        assert!(
            traced.stdout.contains("measurement/S06.csv")
                && traced.stdout.contains("measurement/S18.csv"),
            "{}",
            traced.stdout
        );
        assert!(!traced.stdout.contains("NOT"), "{}", traced.stdout);
    }
    // A repeat of a section that is not used has no value.
    fs::remove_file(folder.path().join("measurement/S06.csv")).expect("removed");
    let found = run(folder.path(), text);
    let values = quantity(&found.results(), "index")["values"].as_array().map(Vec::len);
    assert_eq!(values, Some(2), "{}", found.ran.stderr);
}

/// Numbers of both sides' samples, as a metric by itself: the repeat lies elsewhere than its
/// original.
#[test]
fn expressions_compare_repeats_with_their_originals() {
    let folder = copy(&root().join("tests/cases/values/repeats"));
    let of = |name: &str, metric: &str| {
        format!(
            "quantity {name} \"{name}\"\n  of  az at each gear\n  filter  LP20\n  metric  {metric}\n  \
             compare  repeats with originals\n  limit  p80 100\n\n"
        )
    };
    let repeat = "((rms of (simulated - measured)) / (rms of (simulated + 0 * measured)))^2";
    let original = "((rms of (simulated - measured)) / (rms of (measured + 0 * simulated)))^2";
    let all =
        [("index", "misfit"), ("double", "2 * misfit"), ("repeat", repeat), ("original", original)];
    let text = all.iter().fold(LP20.to_string(), |text, (name, metric)| text + &of(name, metric));
    let found = run(folder.path(), &text);
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let values = |id: &str| -> Vec<f64> {
        let values = quantity(&results, id)["values"].as_array().expect("a list");
        values.iter().map(|value| value["value"].as_f64().expect("a value")).collect()
    };
    let index = values("index");
    assert_eq!(index.len(), 4);
    let (double, repeat, original) = (values("double"), values("repeat"), values("original"));
    assert_eq!((double.len(), repeat.len(), original.len()), (4, 4, 4));
    for (at, one) in index.iter().enumerate() {
        // A misfit is over the smaller sum of squares.
        let samples = repeat[at].max(original[at]);
        assert!(
            (2.0 * one - double[at]).abs() <= 1e-9 * one && (one - samples).abs() <= 1e-9 * one,
            "{one}: {} {samples}",
            double[at]
        );
    }
}

/// Without a repeat there is nothing to compare: not assessable.
#[test]
fn without_repeats_their_quantity_is_not_assessable() {
    let folder = tiny();
    let text = "quantity index \"Quality index\"\n  of  Q at wheelset 1\n  metric  misfit\n  compare  repeats with originals\n  limit  p80 1\n";
    let found = run(folder.path(), text);
    let reason = found.results()["reasons"][0].as_str().map(str::to_string);
    assert!(
        reason.as_deref().is_some_and(|reason| reason.contains("repeats another one")),
        "{reason:?}"
    );
}

const LP20: &str =
    "filter LP20 \"Low-pass filter\"\n  step  low-pass 20 Hz, order 4, zero-phase, as-applied\n\n";
const INDEX: &str = "quantity repeated \"Misfit of repeats\"\n  of  az at each gear\n  filter  LP20\n  metric  misfit\n  \
     compare  repeats with originals\n\n";

/// The model's misfits against those of the repeats, whether the quantity referred to stands before
/// or after.
#[test]
fn a_limit_refers_to_another_quantity() {
    let folder = copy(&root().join("tests/cases/values/repeats"));
    let model = "quantity model \"Misfit of the model\"\n  of  az at each gear\n  filter  LP20\n  metric  misfit\n  \
                 limit  (share where value <= 3 * p80 of repeated) at least 0.5\n  limit  p80 p80 of repeated\n  \
                 limit  (p80 / (p80 of repeated)) 10\n\n";
    let read = |text: &str| run(folder.path(), text).results();
    let results = read(&format!("{LP20}{INDEX}{model}"));
    let after = read(&format!("{LP20}{model}{INDEX}"));
    for key in ["value", "limit", "holds"] {
        let of = |quantity: &Value| {
            quantity["statistics"]
                .as_array()
                .expect("a list")
                .iter()
                .map(|one| one[key].clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(of(&results["quantities"][1]), of(&after["quantities"][0]), "{key}");
    }
    let expected: Value = serde_json::from_str(
        &fs::read_to_string(folder.path().join("misfit.json")).expect("numbers"),
    )
    .expect("JSON");
    let numbers = |key: &str| -> Vec<f64> {
        expected[key]
            .as_array()
            .expect("a list")
            .iter()
            .map(|one| one["misfit"].as_f64().expect("a number"))
            .collect()
    };
    let p80 = |key: &str| percentile(&numbers(key), 80.0, Method::Linear).expect("a percentile");
    let share = numbers("model").iter().filter(|misfit| **misfit <= 3.0 * p80("repeats")).count()
        as f64
        / 8.0;
    let near = |value: &Value, want: f64| {
        assert!(
            (value.as_f64().expect("a number") - want).abs() < 1e-8 * want.max(1.0),
            "{value} {want}"
        )
    };
    let statistics = &results["quantities"][1]["statistics"];
    near(&statistics[0]["value"], share);
    near(&statistics[1]["limit"], p80("repeats"));
    near(&statistics[2]["value"], p80("model") / p80("repeats"));
    // Repeats that cannot be had are a reason.
    replace(&folder.path().join("sections.csv"), "second,S06", "second,");
    replace(&folder.path().join("sections.csv"), "second,S11", "second,");
    let results = read(&format!("{LP20}{INDEX}{model}"));
    assert_eq!(results["verdict"], "not assessable", "{}", results["reasons"]);
}

/// A datum of the vehicle that differs from section to section is a column: here the wheel load Q0
/// of two states.
#[test]
fn a_state_of_the_vehicle_is_section_data() {
    let folder = tiny();
    common::campaign::lines(&folder.path().join("sections.csv"), |lines| {
        for (row, line) in lines.iter_mut().enumerate() {
            line.push_str(if row == 0 {
                ",state,Q0 [kN]"
            } else if row % 2 == 0 {
                ",laden,80"
            } else {
                ",tare,50"
            });
        }
    });
    let text = "section state \"State\"\n  one of  tare, laden\n\nsection wheel_load \"Static wheel load\"\n  in      kN\n  column  \"Q0\"\n\n\
                quantity Q \"Q\"\n  of  Q at wheelset 1\n  from  measured\n  value  mean - wheel_load\n  limit  each 20 kN + wheel_load\n  \
                limit  mean 20 kN + mean of wheel_load for each state\n";
    let found = run(folder.path(), text);
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let statistics = quantity(&results, "Q")["statistics"].as_array().expect("a list").clone();
    let of_state = |state: &str| {
        let one = statistics
            .iter()
            .find(|one| one["group"]["state"] == state)
            .unwrap_or_else(|| panic!("{statistics:?}"));
        (one["limit"].as_f64().map(f64::round), one["count"].as_u64(), one["n"].as_u64())
    };
    assert_eq!(
        (of_state("tare"), of_state("laden")),
        ((Some(70.0), Some(12), Some(6)), (Some(100.0), Some(12), Some(6)))
    );
}

/// Spreads of three codes with known offsets by the shipped protocol, and their deviations from the
/// reference: of the wheel force 1, 2 and 6 kN, mean 3 kN, and of nothing else.
#[test]
fn a_code_benchmark_finds_the_offsets() {
    let folder = three_codes();
    let run = |protocol: &str| {
        certify(
            folder.path(),
            &["--protocol", protocol, "--only", "results", "--set", "force_tolerance=2.5 kN"],
        )
    };
    let (spread, deviation) = (run("code-benchmark"), run("code-benchmark-reference"));
    let (spreads, deviations) = (spread.results(), deviation.results());
    for (at, (code, offset)) in CODES.into_iter().enumerate() {
        for (results, expected) in [(&spreads, offset - 3.0), (&deviations, offset)] {
            // Nine sections in curves; the maximum in all twelve.
            for (id, rows, expected) in [
                ("Q_qst", 18, expected),
                ("Q_max", 24, expected),
                ("Y_qst", 18, 0.0),
                ("az_max", 12, 0.0),
            ] {
                let values = quantity(results, id)["values"].as_array().expect("a list");
                let values: Vec<f64> = values
                    .iter()
                    .filter(|one| one["record"] == code)
                    .map(|one| one["difference"].as_f64().expect("a number"))
                    .collect();
                assert_eq!(values.len(), rows, "{id} {code}");
                assert!(
                    values.iter().all(|value| (value - expected).abs() < 1e-9),
                    "{id} {code}: {values:?}"
                );
            }
        }
        let histories = quantity(&deviations, "Q_history")["values"].as_array().expect("a list");
        let histories = histories
            .iter()
            .filter(|one| one["record"] == code)
            .map(|one| one["value"].as_f64().expect("a number"));
        assert!(histories.into_iter().all(|value| (value - offset).abs() < 1e-9), "{code}");
        // Within 2.5 kN of the mean: -2 and -1, not 3. Of the reference: 1 and 2, not 6.
        let groups = quantity(&spreads, "Q_qst")["statistics"].as_array().expect("a list");
        assert_eq!(groups[at]["holds"].as_bool(), Some(at < 2), "{groups:?}");
    }
    assert_eq!((spread.ran.code, deviation.ran.code), (1, 1));
    assert_eq!(spreads["verdict_word"], "no agreement within the tolerances");
    let accepted = certify(
        folder.path(),
        &["--protocol", "code-benchmark", "--only", "results", "--set", "force_tolerance=3.001 kN"],
    );
    assert_eq!(accepted.results()["verdict_word"], "agreement within the tolerances");
}

/// Deviations of the example from its reference, against SciPy
/// (`tests/cases/code_benchmark/make.py`).
#[test]
fn the_example_of_codes_has_the_numbers_of_scipy() {
    let example = root().join("examples/code-benchmark");
    let found = certify(&example, &["--protocol", "code-benchmark-reference", "--only", "results"])
        .results();
    for (id, section, code, expected) in [
        ("Y_qst", "S13", "polach", 5.795995496887336),
        ("Y_qst", "S13", "independent", 0.00047489782190979213),
        ("Y_qst", "S05", "midpoint", -6.750208744854547e-05),
        ("Q_qst", "S13", "polach", -0.6284677029842243),
        ("Q_qst", "S13", "built_in", 0.00041291356902206644),
        ("Y_history", "S13", "polach", 5.891428998001503),
        ("Y_history", "S05", "independent", 0.0026758551505696635),
        ("Q_history", "S01", "midpoint", 0.003567811293937059),
    ] {
        let values = quantity(&found, id)["values"].as_array().expect("a list");
        let wheel = if id.starts_with('Y') { "Y_1L" } else { "Q_1L" };
        let one = values
            .iter()
            .find(|one| {
                one["section"] == section && one["record"] == code && one["signal"] == wheel
            })
            .expect("a value");
        let value = one["difference"].as_f64().or(one["value"].as_f64()).expect("a number");
        assert!((value - expected).abs() < 1e-9, "{id} {section} {code}: {value}");
    }
    // The creep law differs, the integration does not: three codes of four agree with the
    // reference.
    let groups = quantity(&found, "Y_qst")["statistics"].as_array().expect("a list");
    let holding: Vec<&str> = groups
        .iter()
        .filter(|one| one["holds"] == true)
        .map(|one| one["group"]["record"].as_str().expect("a name"))
        .collect();
    assert_eq!(holding, ["independent", "built_in", "midpoint"]);
}

/// Each code against a reference code, and each code against each other one, by closed form.
#[test]
fn declared_records_are_compared() {
    let folder = three_codes();
    let records = "record reference \"Reference code\"\n  is  simulated gamma\n\nrecord codes \"Codes\"\n  is  simulated alpha, beta\n\n\
                   record every_code \"All codes\"\n  is  simulated\n\n";
    let of = |id: &str, how: &str| {
        format!(
            "quantity {id} \"{id}\"\n  of  Q at wheelset 1\n  value  mean\n{how}  limit  mean 100 kN for each record\n  limit  std 100 kN for \
             each record\n\n"
        )
    };
    let compared = |with: &str| format!("  compare  {with}\n  difference  simulated - measured\n");
    let text = [
        of("against", &compared("codes with reference")),
        of("all_against", &compared("simulated with reference")),
        of("each", &compared("every_code with each other")),
        of("mean", &compared("reference with mean of codes")),
        of("tested", &compared("codes with measured")),
        of("alone", "  from  reference\n"),
        "quantity rms \"rms\"\n  of  Q at wheelset 1\n  metric  rms of (simulated - measured)\n  compare  codes with reference\n  \
         limit  mean 100 kN for each record\n\n"
            .to_string(),
    ];
    let found = run(folder.path(), &format!("{records}{}", text.concat()));
    assert_eq!(found.ran.code, 0, "{}{}", found.ran.stdout, found.ran.stderr);
    let results = found.results();
    let means =
        |id: &str| -> Vec<(String, f64, u64, u64)> { by_record(quantity(&results, id), "mean") };
    assert_records(
        &means("against"),
        &[("alpha, gamma", -5.0, 24, 12), ("beta, gamma", -4.0, 24, 12)],
    );
    assert_eq!(means("against"), means("all_against"));
    assert_records(
        &means("each"),
        &[
            ("alpha, beta", -1.0, 24, 12),
            ("alpha, gamma", -5.0, 24, 12),
            ("beta, gamma", -4.0, 24, 12),
        ],
    );
    assert_records(&means("mean"), &[("gamma", 4.5, 24, 12)]);
    assert_records(&means("tested"), &[("alpha", 1.0, 24, 12), ("beta", 2.0, 24, 12)]);
    assert_records(&means("rms"), &[("alpha, gamma", 5.0, 24, 12), ("beta, gamma", 4.0, 24, 12)]);
    assert_eq!(means("alone").len(), 1);
    let row = &quantity(&results, "against")["values"][1];
    assert_eq!(
        (&row["record"], &row["signal"]),
        (&Value::from("beta, gamma"), &Value::from("Q_1R"))
    );
    let difference = |key: &str| row[key].as_f64().expect("a number");
    assert!(
        (difference("simulated") - difference("measured") - difference("difference")).abs() < 1e-9,
        "{row}"
    );
}

/// A report of two codes is checked and traced to the records of both.
#[test]
fn a_pair_of_codes_is_verified_and_traced() {
    let folder = three_codes();
    let text = "record reference \"Reference code\"\n  is  simulated gamma\n\nquantity code \"Code\"\n  of  Q at wheelset 1\n  value  mean\n  \
                compare  simulated with reference\n  difference  simulated - measured\n  limit  mean 100 kN\n";
    let protocol = protocol(folder.path(), text);
    let found = certify(folder.path(), &["--protocol", &protocol]);
    assert_eq!(found.ran.code, 0, "{}", found.ran.stderr);
    let report = found.folder().join("report.pdf").display().to_string();
    let campaign = folder.path().display().to_string();
    let verified = fishplate(&["verify", &report, &campaign]);
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    let traced = fishplate(&[
        "trace",
        &report,
        "code",
        "S02",
        "Q_1L",
        "--record",
        "beta, gamma",
        "--campaign",
        &campaign,
    ]);
    assert_eq!(traced.code, 0, "{}{}", traced.stdout, traced.stderr);
    for part in ["simulation/beta/S02.csv", "simulation/gamma/S02.csv", "as in the report"] {
        assert!(traced.stdout.contains(part), "{part}: {}", traced.stdout);
    }
    assert!(
        !traced.stdout.contains("measurement/S02.csv") && !traced.stdout.contains("alpha"),
        "{}",
        traced.stdout
    );
    let page = found.text("report.html");
    assert!(
        page.contains("Comparison report") && page.contains("Reference code"),
        "the second side has its title"
    );
}

/// What a protocol calls by name must be in the campaign.
#[test]
fn a_record_that_a_campaign_lacks_is_told() {
    let folder = three_codes();
    let of = |name: &str| {
        format!(
            "record reference \"Reference code\"\n  is  simulated {name}\n\nquantity code \"Code\"\n  of  Q at wheelset 1\n  value  mean\n  from  \
             reference\n  limit  mean 100 kN\n"
        )
    };
    let found = run(folder.path(), &of("gama"));
    assert_eq!(found.ran.code, 2, "{}", found.ran.stdout);
    for part in [
        "error[unknown-record]: the campaign has no simulation `gama`",
        "did you mean `gamma`?",
        "small.fp:25:17",
    ] {
        assert!(found.ran.stderr.contains(part), "{part}: {}", found.ran.stderr);
    }
    // One record without a name.
    let one = tiny();
    let found = run(one.path(), &of("gamma"));
    assert!(
        found
            .ran
            .stderr
            .contains("give its records names in campaign.yaml: `simulation: {gamma: folder}`"),
        "{}",
        found.ran.stderr
    );
    replace(
        &one.path().join("campaign.yaml"),
        "simulation: simulation",
        "simulation: {gamma: simulation}",
    );
    assert_eq!(run(one.path(), &of("gamma")).ran.code, 0);
}
