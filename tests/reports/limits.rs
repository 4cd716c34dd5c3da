//! Limits of single values, least values and signed estimates: numbers, and what reports say of
//! them, against closed forms.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const HEAD: &str = "protocol own \"Own limits\"\n  extends  en14363-2016-annex-t\n\nremove\n  quantity  every\n  plausibility  every\n";

/// `certify` of the good example by an own protocol: its terminal, results and the folder.
fn certified(folder: &Path, quantities: &str) -> (String, Value) {
    let protocol = folder.join("own.fp");
    fs::write(&protocol, format!("{HEAD}\n{quantities}")).expect("written");
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO_BIN_EXE_fishplate"))
        .args(["certify", "--only", "html", "examples/coach-good", "--protocol"])
        .arg(&protocol)
        .arg("--out")
        .arg(folder.join("out"))
        .current_dir(root)
        .output()
        .expect("the program runs");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code().is_some_and(|code| code < 2), "{said}{told}");
    let results = fs::read_to_string(folder.join("out/results.json")).expect("results");
    (said, serde_json::from_str(&results).expect("JSON"))
}

fn quantity<'a>(found: &'a Value, name: &str) -> &'a Value {
    let all = found["quantities"].as_array().expect("quantities");
    all.iter().find(|one| one["id"] == name).expect("a quantity")
}

fn values(quantity: &Value) -> &[Value] {
    quantity["values"].as_array().expect("values")
}

fn number(of: &Value, key: &str) -> f64 {
    of[key].as_f64().unwrap_or_else(|| panic!("no {key} in {of}"))
}

/// The first row of the first table with this caption.
fn first_row(folder: &Path, caption: &str) -> String {
    let page = fs::read_to_string(folder.join("out/report.html")).expect("a page");
    let table = page.split(caption).nth(1).unwrap_or_else(|| panic!("no {caption}"));
    let row = table.split("<tbody>").nth(1).and_then(|rows| rows.split("</tr>").next());
    row.expect("a row").to_owned()
}

#[test]
fn each_value_is_set_against_its_own_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, found) = certified(
        folder.path(),
        "quantity Y_each \"Largest guiding force\"\n  of  Y at wheelsets 1, 3\n  filter  LP20\n  value  p99.85\n  difference  signed\n  \
         limit  each 20 kN when direction is straight, otherwise 1 kN\n",
    );
    let all = values(quantity(&found, "Y_each"));
    for value in all {
        let limit = if value["zone"] == 1 || value["zone"] == "1" { 20.0 } else { 1.0 };
        assert_eq!(number(value, "limit"), limit, "{value}");
        assert!((number(value, "ratio") - number(value, "difference").abs() / limit).abs() < 1e-12);
    }
    let by_share = |a: &&Value, b: &&Value| number(a, "ratio").total_cmp(&number(b, "ratio"));
    let worst = all.iter().max_by(by_share).expect("a value");
    let by_size = |a: &&Value, b: &&Value| {
        number(a, "difference").abs().total_cmp(&number(b, "difference").abs())
    };
    assert!(number(worst, "ratio") > 1.0 && all.iter().max_by(by_size).is_some());
    let row = first_row(folder.path(), "Decisive differences of");
    for part in [&worst["section"], &worst["signal"]] {
        assert!(row.contains(part.as_str().expect("a name")), "{row}");
    }
    assert!(row.contains(&format!("{:.2}", number(worst, "ratio"))), "{row}");
}

/// The smallest value is the decisive one, its share the limit divided by it; tables, terminal and
/// CSV say that the limit is a least value. A share of values is a plain number.
#[test]
fn a_least_value_is_told_as_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let (said, found) = certified(
        folder.path(),
        "quantity Q_min \"Smallest wheel force\"\n  from  measured\n  of  Q\n  value  minimum\n  limit  each at least 20 kN\n\nquantity \
         many \"Share of differences\"\n  of  Y at wheelsets 1, 3\n  filter  LP20\n  value  median\n  difference  signed\n  limit  \
         (share where |value| > 0.001 kN) 5 %\n",
    );
    let least = quantity(&found, "Q_min");
    let smallest =
        values(least).iter().min_by(|a, b| number(a, "value").total_cmp(&number(b, "value")));
    let smallest = smallest.expect("a value");
    assert!((number(smallest, "ratio") - 20.0 / number(smallest, "value")).abs() < 1e-12);
    let statistic = &least["statistics"][0];
    assert_eq!(statistic["direction"], "at_least");
    assert_eq!(number(statistic, "value"), number(smallest, "value"));
    let row = first_row(folder.path(), "Decisive values of");
    assert!(row.contains(smallest["section"].as_str().expect("a section")), "{row}");
    assert!(row.contains(&format!("{:.2}", number(smallest, "ratio"))), "{row}");
    let line = |name: &str| said.lines().find(|line| line.starts_with(name)).expect("a line");
    assert!(line("Q_min").contains("≥ 20"), "{said}");
    let share = line("many");
    assert!(share.split_whitespace().nth(1) == Some("-"), "{said}");
    let csv = fs::read_to_string(folder.path().join("out/tables/summary.csv")).expect("a table");
    assert!(
        csv.lines().any(|line| line.starts_with("Q_min") && line.contains("at_least")),
        "{csv}"
    );
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert!(page.contains("≥ 20") && page.contains("limit ≥ 20"), "the table and the figure");
    assert!(page.contains("decisive value of Q_min"));
}

/// A vertical force with a minus sign is below every limit above zero; its magnitude is not.
#[test]
fn a_signed_limit_compares_with_the_sign() {
    let folder = tempfile::tempdir().expect("a folder");
    let quantity_of = |name: &str, limit: &str| {
        format!(
            "quantity {name} \"Minus the wheel force\"\n  from  measured\n  of  Q at wheelset 1 and side R\n  value  -1 * median\n  limit  \
             maximum {limit}\n\n"
        )
    };
    let text = quantity_of("signed", "at most 10 kN") + &quantity_of("magnitude", "10 kN");
    let (said, found) = certified(folder.path(), &text);
    let statistic = |name: &str| &quantity(&found, name)["statistics"][0];
    let largest = values(quantity(&found, "signed")).iter().map(|one| number(one, "value"));
    let largest = largest.fold(f64::NEG_INFINITY, f64::max);
    assert!(largest < -10.0);
    assert_eq!(statistic("signed")["holds"], true);
    assert_eq!(statistic("magnitude")["holds"], false);
    assert!((number(statistic("signed"), "normalised") - largest / 10.0).abs() < 1e-12);
    assert!((number(statistic("magnitude"), "normalised") + largest / 10.0).abs() < 1e-12);
    assert!(said.contains("≤ 10"), "{said}");
}

/// Three values and a line leave one degree of freedom: at the mean of the regressor the estimate is
/// the mean of the values plus 63.66 standard errors times the root of 4/3.
#[test]
fn an_estimate_far_beyond_its_values_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let (said, found) = certified(
        folder.path(),
        "quantity Q_fit \"Wheel force\"\n  from  measured\n  of  Q at wheelset 1 and side R\n  filter  LP20\n  value  median + 0.83 * median of \
         Y at side R through LP20\n  limit  (prediction over cant_deficiency at mean of cant_deficiency, confidence 99 %) at most 5000 kN for \
         zone 3\n",
    );
    let one = quantity(&found, "Q_fit");
    let inside = |value: &&Value| value["zone"] == 3 || value["zone"] == "3";
    let y: Vec<f64> =
        values(one).iter().filter(inside).map(|value| number(value, "value")).collect();
    // The cant deficiencies of S09, S10 and S11.
    let x = [100.3, 92.0, 82.0];
    let mean = |of: &[f64]| of.iter().sum::<f64>() / 3.0;
    let (mx, my) = (mean(&x), mean(&y));
    let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
        / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>();
    let left: f64 = x.iter().zip(&y).map(|(x, y)| (y - my - slope * (x - mx)).powi(2)).sum();
    // The quantile of Student's t with one degree of freedom is a tangent.
    let t = (std::f64::consts::PI * 0.495).tan();
    let expected = my + t * left.sqrt() * (4.0_f64 / 3.0).sqrt();
    let statistic = &one["statistics"][0];
    assert!((number(statistic, "value") - expected).abs() < 1e-6 * expected.abs(), "{statistic}");
    let (low, high) =
        (y.iter().copied().fold(f64::MAX, f64::min), y.iter().copied().fold(f64::MIN, f64::max));
    assert!(expected > high + (high - low), "the case: {expected} beyond {low} to {high}");
    assert_eq!(statistic["beyond"], serde_json::json!([low, high]));
    let finding =
        said.lines().find(|line| line.contains("farther from the values")).expect("a finding");
    assert!(finding.contains("Q_fit") && finding.contains("3 values"), "{finding}");
    // The figure is of one of the signals.
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert!(page.contains("which is formed from other signals as well"));
}

/// Each edge stands in the legend of the figure with its own sign, whatever the signs of the values.
#[test]
fn both_edges_of_a_limit_are_in_the_legend() {
    let folder = tempfile::tempdir().expect("a folder");
    for (value, edges, legend) in [
        ("median", "-200 kN and 300 kN", ["limit ≥ −200", "limit ≤ 300"]),
        ("-1 * median", "-200 kN and -1 kN", ["limit ≥ −200", "limit ≤ −1"]),
    ] {
        let text = format!(
            "quantity Q_band \"Wheel force\"\n  from  measured\n  of  Q at wheelset 1 and side R\n  \
             value  {value}\n  limit  each between {edges}\n"
        );
        certified(folder.path(), &text);
        let page = fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
        for entry in legend {
            assert!(page.contains(entry), "no `{entry}` for {value} between {edges}");
        }
    }
}
