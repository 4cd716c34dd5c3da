//! `compare`: verdicts, agreement, sensitivity and differences against closed forms and counts by
//! hand.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

fn compare(out: &Path, arguments: &[&str]) -> Value {
    let out_text = out.display().to_string();
    let (code, _, said) = run(&[&["compare", "--quiet", "--out", &out_text], arguments].concat());
    assert_eq!(code, 0, "{said}");
    serde_json::from_str(&fs::read_to_string(out.join("comparison.json")).expect("comparison.json"))
        .expect("JSON")
}

/// The mean of the differences of one channel's section means, without a filter.
fn mean_of_q(folder: &Path, name: &str, limit: &str) -> String {
    let text = format!(
        "protocol {name} \"{name}\"\n  extends  en14363-2016-annex-t\n\nremove\n  quantity  every\n  plausibility  every\n\nquantity Q_mean \
         \"Q\"\n  of  Q at wheelset 1 and side R\n  value  mean\n  difference  signed\n  limit  mean {limit}\n"
    );
    let path = folder.join(format!("{name}.fp"));
    fs::write(&path, text).expect("written");
    path.display().to_string()
}

/// Standard deviation (divisor n) and rms of the measured Q_1R in each section, straight from the
/// records.
fn scatter() -> Vec<(f64, f64)> {
    let example = root().join("examples/coach-good");
    let rows = |path: PathBuf| -> Vec<Vec<String>> {
        let mut reader = csv::Reader::from_path(path).expect("a table");
        reader
            .records()
            .map(|row| row.expect("a row").iter().map(str::to_string).collect())
            .collect()
    };
    let of = |section: &Vec<String>| {
        let (start, end): (f64, f64) =
            (section[2].parse().expect("a number"), section[3].parse().expect("a number"));
        let values: Vec<f64> = rows(example.join(format!("measurement/{}.csv", section[0])))
            .iter()
            .filter(|row| (start..=end).contains(&row[1].parse::<f64>().expect("a number")))
            .map(|row| row[10].parse().expect("a number"))
            .collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt();
        (mean, deviation)
    };
    rows(example.join("sections.csv")).iter().map(of).collect()
}

fn values<'a>(found: &'a Value, disturbance: &str) -> Vec<f64> {
    let all: &'a Vec<Value> = found["sensitivity"].as_array().expect("a list");
    let one = all.iter().find(|one| one["disturbance"] == disturbance).expect("a disturbance");
    one["values"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|value| value.as_f64().expect("a number"))
        .collect()
}

/// An offset of x standard deviations moves the mean by x times the mean of the sections' standard
/// deviations; a gain moves the mean of each section by its share of the rms.
#[test]
fn the_sensitivity_of_a_mean_is_the_closed_form() {
    let temp = tempfile::tempdir().expect("a folder");
    let protocol = mean_of_q(temp.path(), "plain", "10 kN");
    let found = compare(
        &temp.path().join("out"),
        &["examples/coach-good", "--protocol", &protocol, "--sizes", "0.1,0.4", "--no-report"],
    );
    let scatter = scatter();
    let mean_of = |of: &dyn Fn(&(f64, f64)) -> f64| {
        scatter.iter().map(of).sum::<f64>() / scatter.len() as f64
    };
    let offset = mean_of(&|(_, deviation)| *deviation);
    let gain = mean_of(&|(mean, deviation)| mean * deviation / mean.hypot(*deviation));
    for (disturbance, expected) in [("offset", offset), ("gain", gain)] {
        for (size, value) in [0.1, 0.4].into_iter().zip(values(&found, disturbance)) {
            let expected = size * expected / 10.0;
            assert!(
                (value - expected).abs() < 1e-9,
                "{disturbance} {size}: {value} and {expected}"
            );
        }
    }
    // White noise has mean zero; the mean of n samples moves by 1/sqrt(n) of it.
    assert!(values(&found, "noise")[1] < 0.1 * values(&found, "offset")[1]);
    assert_eq!(found["protocols"].as_array().map(Vec::len), Some(1));
}

/// Records are read and filtered once, however many protocols need them.
#[test]
fn records_are_read_and_filtered_once() {
    let temp = tempfile::tempdir().expect("a folder");
    let of = |name: &str, protocols: &[&str]| {
        let mut arguments = vec!["examples/coach-good", "--sizes", "none", "--no-report"];
        protocols.iter().for_each(|protocol| arguments.extend(["--protocol", protocol]));
        compare(&temp.path().join(name), &arguments)["work"].clone()
    };
    let (annex, six) = ("en14363-2016-annex-t", "en14363-2016-annex-t-six-sections");
    let (one, two) = (of("one", &[annex]), of("two", &[annex, six]));
    // A simulation, a measurement and a track of 13 sections.
    assert_eq!(one["records_read"], 39);
    assert_eq!(
        (&two["records_read"], &two["filters_run"]),
        (&one["records_read"], &one["filters_run"])
    );
    assert!(two["filters_asked"].as_u64() > one["filters_asked"].as_u64());
}

/// Two protocols: the verdict of each is that of `certify`, and each difference alone has the
/// effect that it must have.
#[test]
fn each_difference_is_applied_alone() {
    let temp = tempfile::tempdir().expect("a folder");
    let variant = temp.path().join("variant.fp");
    let text = "protocol variant \"Variant\"\n  extends  en14363-2016-annex-t\n\nquantity Y_max\n  limit  mean 0.01 kN\n\nquantity Q_max\n  \
                limit  std 90 kN\n";
    fs::write(&variant, text).expect("written");
    let variant = variant.display().to_string();
    let out = temp.path().join("out");
    let found = compare(
        &out,
        &[
            "examples/coach-good",
            "--protocol",
            "en14363-2016-annex-t",
            "--protocol",
            &variant,
            "--sizes",
            "none",
        ],
    );
    let verdicts: Vec<&Value> =
        found["verdicts"].as_array().expect("a list").iter().map(|cell| &cell["verdict"]).collect();
    assert_eq!(verdicts, ["validated", "not validated"]);
    let after = |rule: &str| {
        let all = found["differences"].as_array().expect("a list");
        let one =
            all.iter().find(|one| one["rule"].as_str().is_some_and(|name| name.contains(rule)));
        one.unwrap_or_else(|| panic!("{rule}: {all:?}"))["verdict_after"].clone()
    };
    assert_eq!(
        (after("Y_max"), after("Q_max"), after("all rules")),
        ("not validated".into(), "validated".into(), "not validated".into())
    );
    assert!(found["unrelated"].is_null());
    // Thirteen sections, each with a score of both protocols.
    let agreement = &found["agreement"][0];
    let cells: Vec<u64> = agreement["contingency"]
        .as_array()
        .expect("rows")
        .iter()
        .flat_map(|row| row.as_array().expect("counts"))
        .map(|count| count.as_u64().expect("a count"))
        .collect();
    assert_eq!((cells.iter().sum::<u64>(), agreement["sections"].as_u64()), (13, Some(13)));
    // The same counts from the scores of the sections: up to 1, the requirement is met.
    let scores = |protocol: &str| -> Vec<bool> {
        let all = found["scores"].as_array().expect("a list").iter();
        let own = all.filter(|one| one["protocol"] == protocol && one["metric"].is_null());
        own.map(|one| one["score"].as_f64().expect("a number") <= 1.0).collect()
    };
    let pairs: Vec<(bool, bool)> =
        scores("en14363-2016-annex-t").into_iter().zip(scores("variant")).collect();
    let counted = [(true, true), (true, false), (false, true), (false, false)]
        .map(|cell| pairs.iter().filter(|pair| **pair == cell).count() as u64);
    assert_eq!((pairs.len(), cells), (13, counted.to_vec()));
    assert_eq!(fs::read(out.join("report.pdf")).expect("a report")[..5], *b"%PDF-");
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    for part in
        ["Comparison of protocols", "Differences, rule by rule", "Applicability", "Agreement"]
    {
        assert!(page.contains(part), "{part}");
    }
}

/// The same bytes on any number of cores; a protocol whose needs are not met is told in its cell.
#[test]
fn cells_without_a_verdict_and_bytes() {
    let temp = tempfile::tempdir().expect("a folder");
    let arguments = [
        "examples/coach-good",
        "examples/sway",
        "--protocol",
        "en14363-2016-annex-t",
        "--protocol",
        "stationary-sway",
        "--sizes",
        "0.2",
    ];
    let (one, two) = (temp.path().join("one"), temp.path().join("two"));
    let found = compare(&one, &[&arguments[..], &["--jobs", "1"]].concat());
    compare(&two, &[&arguments[..], &["--jobs", "2"]].concat());
    for name in [
        "comparison.json",
        "report.pdf",
        "report.html",
        "tables/verdicts.csv",
        "tables/sensitivity.csv",
    ] {
        let [a, b] =
            [&one, &two].map(|folder| fs::read(folder.join(name)).expect("a written file"));
        assert!(a == b, "{name} is not the same");
    }
    let cells = found["verdicts"].as_array().expect("a list");
    let of = |at: usize| {
        (
            cells[at]["verdict"].as_str().expect("a word"),
            cells[at]["reasons"][0].as_str().unwrap_or_default().to_string(),
        )
    };
    assert_eq!(
        (of(0).0, of(1).0, of(2).0, of(3).0),
        ("validated", "not assessable", "not assessable", "not assessable")
    );
    assert!(of(2).1.contains("no table of sections"), "{}", of(2).1);
    // The two have nothing in common: no rule of one makes sense in the other.
    let count = found["unrelated"].as_u64().expect("a number");
    assert!(count > 50 && found["differences"].as_array().is_some_and(Vec::is_empty), "{count}");
    let page = fs::read_to_string(one.join("report.html")).expect("a page");
    assert!(page.contains("are unrelated") && page.contains(&format!("{count} rules")));
}

/// More protocols than stand side by side in a table, with titles that must not act.
#[test]
fn many_protocols_and_strange_titles_make_a_report() {
    let temp = tempfile::tempdir().expect("a folder");
    let protocols: Vec<String> = (1..=8)
        .map(|at| {
            let path = temp.path().join(format!("v{at}.fp"));
            let title = "#panic() <script>alert(1)</script> $x$ {{ 7 * 7 }}";
            let text =
                format!("protocol v{at} \"{title} {at}\"\n  extends  en14363-2016-annex-t\n\nquantity Y_max\n  limit  mean {at} kN\n");
            fs::write(&path, text).expect("written");
            path.display().to_string()
        })
        .collect();
    let mut arguments = vec!["examples/coach-good", "--sizes", "none"];
    protocols.iter().for_each(|protocol| arguments.extend(["--protocol", protocol]));
    let out = temp.path().join("out");
    let found = compare(&out, &arguments);
    assert_eq!(
        found["agreement"]
            .as_array()
            .expect("a list")
            .iter()
            .filter(|one| one["of"] == "protocols")
            .count(),
        8 * 7 / 2
    );
    assert_eq!(
        (
            found["sensitivity"].as_array().map(Vec::len),
            found["differences"].as_array().map(Vec::len)
        ),
        (Some(0), Some(0))
    );
    let page = fs::read_to_string(out.join("report.html")).expect("a page");
    assert!(
        page.contains("&lt;script&gt;alert(1)")
            && !page.contains("<script>alert(1)")
            && page.contains("{{ 7 * 7 }}")
    );
    let Ok(text) = Command::new("pdftotext").arg(out.join("report.pdf")).arg("-").output() else {
        crate::common::tools::skip("pdftotext");
        return;
    };
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    for part in ["Ratios by quantity", "v8", "#panic()"] {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn wrong_input_is_told_and_nothing_is_written() {
    let temp = tempfile::tempdir().expect("a folder");
    let out = temp.path().join("out").display().to_string();
    let annex = "en14363-2016-annex-t";
    for (arguments, says) in [
        (
            &["examples/coach-good", "--protocol", "sprague-geerz"][..],
            "did you mean `sprague-geers`?",
        ),
        (&["examples/coach-good", "--protocol", annex, "--protocol", annex], "is given twice"),
        (&["examples/coach-good", "examples/coach-good", "--protocol", annex], "is given twice"),
        (&["examples/coach-good", "--protocol", annex, "--sizes", "0.1,2"], "at most 1"),
        (&["examples/coach-good", "--protocol", annex, "--sizes", "small"], "`--sizes small`"),
        (&["examples/coach-good", "--protocol", annex, "--set", "lowpass_frequency"], "has no `=`"),
        (
            &["examples/coach-good", "--protocol", annex, "--set", "lowpas_frequency=20 Hz"],
            "unknown-parameter",
        ),
        (
            &["examples/coach-good", "--protocol", annex, "--set", "x=1", "--set", "x=2"],
            "error[set-twice]",
        ),
    ] {
        let (code, _, said) = run(&[&["compare", "--out", &out], arguments].concat());
        assert_eq!(code, 2, "{arguments:?}: {said}");
        assert!(said.contains(says), "{says}: {said}");
    }
    assert!(!Path::new(&out).exists());
}

/// A correlation, the same with the other sign, both at least 0.5, and without a limit: the scores
/// follow from the correlations of `certify`.
#[test]
fn a_value_below_zero_does_not_reach_a_least_value() {
    let temp = tempfile::tempdir().expect("a folder");
    let protocol = |name: &str, metrics: &[(&str, &str)]| {
        let mut text = format!(
            "protocol {name} \"{name}\"\n  extends  en14363-2016-annex-t\n\nremove\n  quantity  every\n  plausibility  every\n"
        );
        for (at, (metric, end)) in metrics.iter().enumerate() {
            text += &format!(
                "\nquantity r{at} \"r{at}\"\n  of  Y at wheelset 1 and side R\n  filter  LP20\n  metric  {metric}\n  {end}\n"
            );
        }
        let path = temp.path().join(format!("{name}.fp"));
        fs::write(&path, text).expect("written");
        path.display().to_string()
    };
    let least = "limit  each at least 0.5";
    let limited = protocol("limited", &[("correlation", least), ("-1 * correlation", least)]);
    let free = protocol("free", &[("correlation", "reported  \"A number.\"")]);
    let found = compare(
        &temp.path().join("out"),
        &[
            "examples/coach-good",
            "--protocol",
            &limited,
            "--protocol",
            &free,
            "--sizes",
            "none",
            "--no-report",
        ],
    );
    let own = temp.path().join("own").display().to_string();
    let (_, _, said) = run(&[
        "certify",
        "examples/coach-good",
        "--quiet",
        "--only",
        "results",
        "--protocol",
        &free,
        "--out",
        &own,
    ]);
    let results: Value = serde_json::from_str(
        &fs::read_to_string(temp.path().join("own/results.json"))
            .unwrap_or_else(|_| panic!("{said}")),
    )
    .expect("JSON");
    let correlations = results["quantities"][0]["values"].as_array().expect("values");
    assert_eq!(correlations.len(), 13);
    let score = |protocol: &str, metric: &str, section: &Value| {
        let all = found["scores"].as_array().expect("scores").iter();
        let mut own = all.filter(|one| {
            one["protocol"] == protocol
                && one["metric"].as_str().unwrap_or("all") == metric
                && one["section"] == *section
        });
        let first = own.next().unwrap_or_else(|| panic!("{metric} {section}: {}", found["scores"]));
        (first["score"].as_f64(), first["shortfall"].as_f64())
    };
    let near =
        |found: Option<f64>, wanted: f64| found.is_some_and(|found| (found - wanted).abs() < 1e-12);
    let mut met = 0;
    for one in correlations {
        let (r, section) = (one["value"].as_f64().expect("a number"), &one["section"]);
        assert!(r > 0.0, "the case");
        met += u64::from(r >= 0.5);
        let (plain, minus) = (score("limited", "correlation", section), "-1 * correlation");
        assert!(near(plain.0, 0.5 / r) && plain.1.is_none(), "{r} {plain:?}");
        // Neither the metric nor the protocol is met there.
        for metric in [minus, "all"] {
            let (ratio, shortfall) = score("limited", metric, section);
            assert!(
                ratio.is_none() && near(shortfall, 1.0 + r / 0.5),
                "{r} {ratio:?} {shortfall:?}"
            );
        }
        assert!(near(score("free", "correlation", section).0, 1.0 - r));
    }
    let agreement = found["agreement"].as_array().expect("a list");
    let metrics = agreement.iter().find(|one| one["of"] == "metrics").expect("two metrics");
    assert_eq!(metrics["contingency"], serde_json::json!([[0, met], [0, 13 - met]]));
    // The better the correlation, the worse the same with the other sign.
    assert_eq!(metrics["spearman"].as_f64(), Some(-1.0));
}
