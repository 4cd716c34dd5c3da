//! Weighted estimates, numbers of several groups, minimum counts of groups, regressions outside
//! their data and over repeats.

use crate::common::texts::{text, texts};
use std::fs;
use std::path::{Path, PathBuf};

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::metrics::{cluster, percentile, statistics, weighted};
use fishplate::problem::Problems;
use fishplate::result::{Certification, StatisticResult, Verdict};
use fishplate::run::{Settings, Shifts, evaluate};
use fishplate::source::Source;
use fishplate::study::{Settings as StudySettings, case::Case, selections};
use serde_json::Value;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn compiled(name: &str, text: &str) -> Compiled {
    let mut problems = Problems::default();
    let family = family::read(&Source::new(name, text), &library::parent, &mut problems);
    let found = compile(family, &Overrides::new(), &mut problems).filter(|_| !problems.any_error());
    found.unwrap_or_else(|| panic!("{}", problems.render(false)))
}

fn certified(protocol: &Compiled, campaign: &Path) -> Certification {
    let mut problems = Problems::default();
    let campaign = Campaign::open(campaign, &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    certify(protocol, &campaign, Settings { traces: 1 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

fn coach() -> PathBuf {
    root().join("examples/coach-good")
}

/// The assessed vertical wheel force, with some more fields.
fn assessed(fields: &str) -> Compiled {
    compiled(
        "assessed.fp",
        &format!(
            "protocol assessed \"Assessed\"\n  extends  en14363-2016-annex-t\n\nremove\n  quantity  every\n\nquantity Q \"Q\"\n  \
             from  measured\n  of  Q at wheelsets 1, 2, 3, 4 and side outer when direction is not straight\n  \
             of  Q at wheelsets 1, 2, 3, 4 when direction is straight\n  filter  LP20\n  value  p99.85\n{fields}"
        ),
    )
}

fn all(found: &Certification) -> impl Iterator<Item = &StatisticResult> {
    found.quantities.iter().flat_map(|quantity| &quantity.statistics)
}

/// Values and names against NumPy and SciPy, 1e-9 relative; see `cases/values/weights.py`.
#[test]
fn weights_and_groups_agree_with_numpy() {
    let folder = root().join("tests/cases/values");
    let protocol = fs::read_to_string(folder.join("weights.fp")).expect("a protocol");
    let found = certified(&compiled("weights.fp", &protocol), &coach());
    let expected = fs::read_to_string(folder.join("weights.json")).expect("expected numbers");
    let expected: Vec<Value> = serde_json::from_str(&expected).expect("JSON");
    for one in &expected {
        let text = |key: &str| one[key].as_str().expect("a text");
        let scope = if text("zone") == "all" {
            "all".to_string()
        } else {
            format!("zone {}", text("zone"))
        };
        let result = all(&found).find(|known| {
            known.name.to_string() == text("estimate") && known.scope.to_string() == scope
        });
        let result = result.unwrap_or_else(|| panic!("{one} is missing"));
        let factor = if result.unit == "km/h" { 1.0 / 3.6 } else { 1.0 };
        let (value, want) =
            (result.value.expect("a value") * factor, one["value"].as_f64().expect("a number"));
        assert!((value - want).abs() <= 1e-9 * want.abs(), "{one}: {value}");
    }
    assert_eq!((expected.len(), all(&found).count()), (58, 58));
}

/// Weights that are alike change nothing, whatever their unit; a value of weight 0 does not count;
/// few are no number.
#[test]
fn weights_that_are_alike_change_nothing() {
    let values = [3.0, -1.0, 4.0, 1.5, 9.0, -2.6, 5.0];
    let near = |found: Option<f64>, want: Option<f64>| {
        let (found, want) = (found.expect("a number"), want.expect("a number"));
        assert!((found - want).abs() <= 1e-14 * want.abs().max(1.0), "{found} in place of {want}");
    };
    for weight in [1.0, 250.0, 0.001] {
        let weights = [weight; 7];
        near(weighted::mean(&values, &weights), statistics::mean(&values));
        near(weighted::rms(&values, &weights), statistics::rms(&values));
        near(weighted::effective_count(&weights), Some(7.0));
        for (ddof, divisor) in
            [(1, statistics::Divisor::Sample), (0, statistics::Divisor::Population)]
        {
            near(
                weighted::standard_deviation(&values, &weights, ddof),
                statistics::standard_deviation(&values, divisor),
            );
        }
        for percent in [0.0, 0.15, 20.0, 50.0, 80.0, 99.85, 100.0] {
            let want = percentile::percentile(&values, percent, percentile::Method::Linear).ok();
            near(weighted::percentile(&values, &weights, percent), want);
        }
        let sites = [0, 0, 1, 1, 2, 3, 3];
        let rows: Vec<(f64, f64)> = values.iter().copied().zip(weights).collect();
        let plain = cluster::by_site(&values, &sites)
            .and_then(|sites| cluster::Mean::of(&sites))
            .expect("an estimate")
            .estimate;
        let found = cluster::by_site(&rows, &sites)
            .and_then(|sites| cluster::weighted_mean(&sites))
            .expect("an estimate");
        near(Some(found.standard_error), Some(plain.standard_error));
        assert_eq!(found.degrees, plain.degrees);
    }
    let (more, weights) = ([3.0, -1.0, 4.0, 70.0], [2.0, 1.0, 5.0, 0.0]);
    let (fewer, of_fewer) = (&more[..3], &weights[..3]);
    near(weighted::mean(&more, &weights), weighted::mean(fewer, of_fewer));
    near(
        weighted::standard_deviation(&more, &weights, 1),
        weighted::standard_deviation(fewer, of_fewer, 1),
    );
    near(
        weighted::percentile(&more, &weights, 100.0),
        weighted::percentile(fewer, of_fewer, 100.0),
    );
    let rows = [vec![(3.0, 2.0)], vec![(-1.0, 1.0), (4.0, 5.0)], vec![(70.0, 0.0)]];
    assert_eq!(cluster::weighted_mean(&rows).expect("an estimate").degrees, 1.0);
    assert_eq!(weighted::standard_deviation(&[1.0, 2.0], &[1.0, 0.0], 1), None);
    assert_eq!(weighted::mean(&[1.0, 2.0], &[0.0, 0.0]), None);
    assert_eq!(weighted::percentile(&[], &[], 50.0), None);
    assert_eq!(weighted::standard_deviation(&[0.1, 0.1, 0.1], &[1.0, 2.0, 3.0], 1), Some(0.0));
}

/// What cannot be weighted, or has no number in a group, is a reason that names the section or the
/// group.
#[test]
fn weights_without_a_number_are_a_reason() {
    let found = certified(
        &assessed(
            "  limit  mean weighted by (speed - 135 km/h) 500 kN\n  limit  p80 weighted by (0 * speed) 500 kN\n  \
             limit  std weighted by length 500 kN for each section\n  limit  (mean of (std for each section and wheelset)) 500 kN for zone 4\n  \
             limit  (share weighted by (0 * length) where value <= 60 kN) at least 0.1\n",
        ),
        &coach(),
    );
    let reason = |name: &str| {
        all(&found)
            .find(|one| one.name.to_string().contains(name))
            .and_then(|one| text(&one.reason))
            .expect("a reason")
    };
    assert_eq!(
        reason("mean weighted by (speed"),
        "section S01: its weight `(speed - 135 km/h)` is negative"
    );
    assert_eq!(reason("p80"), "no weight is above zero");
    assert_eq!(reason("share"), "no weight is above zero");
    assert!(
        reason("mean of (std").contains(", wheelset 1: not defined for 1 value"),
        "{}",
        reason("mean of (std")
    );
    assert_eq!(found.verdict, Verdict::NotAssessable);
}

/// A group with too few pairs is not assessable, the others have their numbers, and the quantity
/// says why.
#[test]
fn groups_need_their_pairs() {
    let limit = "  limit  mean 500 kN for each zone and wheelset\n  limit  std 500 kN\n";
    let found = certified(
        &assessed(&format!("  minimum pairs  4 for each zone and wheelset\n{limit}")),
        &coach(),
    );
    assert_eq!(found.verdict, Verdict::NotAssessable);
    // Zones 1 to 3 have three sections, zone 4 four; straight track (zone 1) has two sides.
    let reason = "zone 2, wheelset 1: 3 pairs of section and signal; at least 4 required; also too few in 7 other groups";
    assert_eq!(text(&found.quantities[0].reason).as_deref(), Some(reason));
    for one in all(&found).filter(|one| one.name.to_string() == "mean") {
        let short = ["2", "3"].iter().any(|zone| one.scope.zones == [*zone]);
        assert_eq!((one.value.is_none(), one.holds.is_none()), (short, short), "{}", one.scope);
        let says = "3 pairs of section and signal; at least 4 required";
        assert_eq!(text(&one.reason).as_deref(), short.then_some(says), "{}", one.scope);
    }
    assert!(all(&found).any(|one| one.name.to_string() == "std" && one.value.is_some()));
    let enough =
        |minimum: &str| certified(&assessed(&format!("{minimum}{limit}")), &coach()).verdict;
    assert_eq!(enough("  minimum pairs  3 for each zone and wheelset\n"), Verdict::Validated);
    assert_eq!(enough("  minimum pairs  4 for zone 4 and each wheelset\n"), Verdict::Validated);
    assert_eq!(
        enough(
            "  minimum pairs  16 for sections where zone is 4\n  minimum pairs  17 for zone 4\n"
        ),
        Verdict::NotAssessable
    );
    assert_eq!(
        enough("  minimum pairs  64\n  minimum pairs  12 for each zone\n"),
        Verdict::Validated
    );
    assert_eq!(
        enough("  minimum pairs  65\n  minimum pairs  12 for each zone\n"),
        Verdict::NotAssessable
    );
    // The verdict's minimum holds for a quantity without its own.
    let of_all = format!(
        "{limit}\nverdict\n  minimum signals  1\n  minimum pairs  1\n  minimum pairs  4 for each zone and wheelset\n"
    );
    assert_eq!(
        text(&certified(&assessed(&of_all), &coach()).quantities[0].reason).as_deref(),
        Some(reason)
    );
    let own = format!("  minimum pairs  3 for each zone\n{of_all}");
    assert_eq!(certified(&assessed(&own), &coach()).verdict, Verdict::Validated);
}

/// A variant changes the minimum of the groups that it names, and no other.
#[test]
fn minima_are_overridden_by_their_groups() {
    let text = "protocol p \"P\"\n  extends  en14363-2016-annex-t\n\nquantity Y_max\n  minimum pairs  3 for each zone\n";
    let plan = compiled("p.fp", text).plan;
    let of =
        |id: &str| plan.quantities.iter().find(|quantity| quantity.id == id).expect("a quantity");
    assert_eq!((of("Y_max").minimum_pairs, of("Q_max").minimum_pairs), (24, 24));
    let groups = |id: &str| {
        of(id)
            .minimum_of_groups
            .iter()
            .map(|one| (one.needed, one.scope.zones.join(", ")))
            .collect::<Vec<_>>()
    };
    assert_eq!(groups("Y_max"), ["1", "2", "3", "4"].map(|zone| (3, zone.to_string())));
    assert!(groups("Q_max").is_empty());
}

/// Of the selections of sections, those without the pairs of a group are not validated.
#[test]
fn a_study_counts_the_pairs_of_groups() {
    let sections = fs::read_to_string(coach().join("sections.csv")).expect("a table");
    let of = |zone: &str, direction: &str| {
        let has = |line: &&str| {
            line.split(',').nth(1) == Some(zone) && line.split(',').nth(5) == Some(direction)
        };
        sections.lines().filter(has).count()
    };
    let right: usize = ["2", "3", "4"].iter().map(|zone| of(zone, "right")).sum();
    let in_zone_4 = of("4", "right");
    assert!(in_zone_4 > 0 && in_zone_4 < 4, "{in_zone_4}");
    let share = |needed: usize| {
        let protocol = assessed(&format!(
            "  minimum pairs  {needed} for each direction where direction is right\n  limit  mean 500 kN\n"
        ));
        let mut problems = Problems::default();
        let campaign = Campaign::open(&coach(), &mut problems).expect("a campaign");
        let found = evaluate(&protocol.plan, &protocol.graph, &campaign, &Shifts::NONE, &|_| {})
            .expect("values")
            .swap_remove(0);
        let case = Case::of(&found.pool(&protocol.plan), None).expect("a case");
        let (verdict, _) = case.judge(&case.usable());
        (selections(&case, &StudySettings::default()).counted.share.share, verdict)
    };
    // Each selection leaves out one of the four sections of zone 4; each curve has four wheelsets
    // with one outer wheel.
    assert_eq!(share(4 * right), ((4 - in_zone_4) as f64 / 4.0, Verdict::Validated));
    assert_eq!(share(4 * right - 4), (1.0, Verdict::Validated));
    assert_eq!(share(4 * right + 1), (0.0, Verdict::NotAssessable));
}

/// A regression that is read outside its data has its number and a remark: where it is read, and
/// how far beyond, of the table of sections.
#[test]
fn regressions_outside_their_data_are_told() {
    let protocol = assessed(
        "  limit  (prediction over cant_deficiency, speed at 143 mm, mean of speed, confidence 99 %) 5000 kN for zone 4 and each wheelset\n  \
         limit  (regression over cant_deficiency at 90 mm) 5000 kN for zone 4\n  \
         limit  (larger of mean, (regression over cant_deficiency at 60 mm)) 5000 kN for zone 3\n",
    );
    let found = certified(&protocol, &coach());
    let sections = fs::read_to_string(coach().join("sections.csv")).expect("a table");
    let of_zone = |zone: &str| {
        let of = sections
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>())
            .filter(|row| row[1] == zone);
        let all: Vec<f64> = of.map(|row| row[7].parse().expect("a number")).collect();
        (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max))
    };
    let told: Vec<_> =
        found.findings.iter().filter(|finding| finding.code == "extrapolated").collect();
    assert_eq!(told.len(), 2, "{told:?}");
    let ((low, high), near) =
        (of_zone("4"), |a: Option<f64>, b: f64| (a.expect("a number") - b).abs() < 1e-9);
    assert!(
        near(told[0].first.value, 143.0)
            && near(told[0].first.expected, high)
            && told[0].first.unit.as_deref() == Some("mm")
    );
    let says = format!(
        "{} mm above the data, which reach from {low} to {high} mm",
        fishplate::metrics::rounded(143.0 - high)
    );
    assert!(
        told[0].first.text().to_string().contains(&says),
        "{} without {says}",
        told[0].first.text()
    );
    let groups = "(zone 4, wheelset 1; zone 4, wheelset 2; zone 4, wheelset 3; zone 4, wheelset 4)";
    assert!(
        told[0].first.text().to_string().ends_with(groups),
        "{}",
        told[0].first.text().to_string()
    );
    assert!(
        near(told[1].first.value, 60.0)
            && near(told[1].first.expected, of_zone("3").0)
            && told[1].first.text().to_string().contains("below the data")
    );
    assert!(all(&found).all(|one| one.value.is_some()));
}

/// A repeat is a value of its own in a regression, and no further unit: SciPy's number of all
/// values stays, n counts sites, or what the protocol says is independent.
#[test]
fn repeats_are_values_of_a_regression() {
    let folder = tempfile::tempdir().expect("a folder");
    copy(&coach(), folder.path());
    let table = fs::read_to_string(coach().join("sections.csv")).expect("a table");
    let with: Vec<String> = table
        .lines()
        .enumerate()
        .map(|(row, line)| {
            let zone = line.split(',').nth(1).unwrap_or_default();
            match (row, zone) {
                (0, _) => format!("{line},site,day"),
                // One place in each zone is passed twice, and all of it on one day.
                (2 | 3 | 5 | 6 | 8 | 9 | 11 | 12, zone) => format!("{line},place {zone},one"),
                _ => format!("{line},,one"),
            }
        })
        .collect();
    fs::write(folder.path().join("sections.csv"), with.join("\n") + "\n").expect("written");
    let limits = "  limit  (prediction over cant_deficiency at 143 mm, confidence 95 %) 5000 kN for zone 4 and each wheelset\n  \
                  limit  (n) 5000 for zone 4\n  limit  mean 5000 kN for zone 4\n";
    let column = "\nsection day \"Day of the test\"\n  one of  one, two\n";
    let day = format!(
        "{limits}{column}\nverdict\n  minimum signals  1\n  minimum pairs  1\n  independent  day\n"
    );
    let found =
        [(limits, coach()), (limits, folder.path().into()), (day.as_str(), folder.path().into())]
            .map(|(fields, campaign)| certified(&assessed(fields), &campaign));
    let expected = fs::read_to_string(root().join("tests/cases/values/assessment.json"))
        .expect("expected numbers");
    let expected: Vec<Value> = serde_json::from_str(&expected).expect("JSON");
    for (found, n) in found.iter().zip([4, 3, 1]) {
        for one in all(found).filter(|one| one.name.to_string().starts_with("prediction")) {
            let wheelset =
                &one.scope.keys.iter().find(|(key, _)| key == "wheelset").expect("a wheelset").1;
            let wanted = |known: &&Value| {
                known["estimate"] == "loading_2d"
                    && known["zone"] == "4"
                    && known["wheelset"] == wheelset.as_str()
            };
            let want = expected
                .iter()
                .find(wanted)
                .and_then(|known| known["value"].as_f64())
                .expect("SciPy's number");
            let value = one.value.expect("a number");
            assert!((value - want).abs() <= 1e-9 * want, "{value} in place of {want}");
            assert_eq!((one.count, one.n), (4, n));
        }
        let of =
            |name: &str| all(found).find(|one| one.name.to_string() == name).expect("an estimate");
        assert_eq!((of("n").value, of("mean").n, of("mean").count), (Some(n as f64), n, 16));
        // One unit says nothing of how far units differ.
        assert_eq!(of("mean").interval.is_none(), n == 1);
    }
}

/// The recipe for a verdict with 95 % confidence in `docs/language.md`: bounds of Y_max by NumPy
/// and SciPy from the differences of an independent program (`cases/peer/coach-good.csv`, formulas
/// of `docs/definitions.md`). Limits between a value and its bound fail.
#[test]
fn a_verdict_with_confidence() {
    let (low, high, std, upper) =
        (-2.209_897_730_287_58, 0.454_416_129_764_01, 3.055_178_902_694_35, 5.113_682_324_030_08);
    let page = fs::read_to_string(root().join("docs/language.md")).expect("the page");
    let recipe = page
        .split("```fp\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .find(|text| text.contains("with-confidence"));
    let recipe = recipe
        .expect("the recipe")
        .replace("\nquantity Y_max\n", "  quantity  Y_qst\n\nquantity Y_max\n");
    let others = [
        "Q_qst",
        "YQ_qst",
        "SigmaY_qst",
        "Q_max",
        "YQ_max",
        "SigmaY_max",
        "ay_rms",
        "az_rms",
        "ay_max",
        "az_max",
    ];
    let removed: String = others.map(|name| format!("  quantity  {name}\n")).concat();
    let recipe = recipe.replace("  quantity  Y_qst\n", &format!("  quantity  Y_qst\n{removed}"));
    let found = certified(&compiled("with-confidence.fp", &recipe), &coach());
    for (name, want) in [
        ("upper 95 % of std", upper),
        ("upper 95 % of mean", high),
        ("lower 95 % of mean", low),
        ("n", 13.0),
    ] {
        let value = all(&found)
            .find(|one| one.name.to_string() == name)
            .and_then(|one| one.value)
            .expect("a value");
        assert!((value - want).abs() <= 1e-9 * want.abs(), "{name}: {value} in place of {want}");
    }
    assert_eq!(found.verdict, Verdict::Validated, "{:?}", texts(&found.reasons));
    let between =
        recipe.replace("of std 9 kN", &format!("of std {:.3} kN", f64::midpoint(std, upper)));
    assert_eq!(
        certified(&compiled("with-confidence.fp", &between), &coach()).verdict,
        Verdict::NotValidated
    );
    let between = recipe.replace("lower 95 % of mean 6 kN", "lower 95 % of mean 2.2 kN");
    assert_eq!(
        certified(&compiled("with-confidence.fp", &between), &coach()).verdict,
        Verdict::NotValidated
    );
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            fs::create_dir_all(&target).expect("a folder");
            copy(&path, &target);
        } else {
            fs::copy(&path, target).expect("a copy");
        }
    }
}
