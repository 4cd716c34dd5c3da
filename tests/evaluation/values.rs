//! The table of values: assessments of one record, estimates by group, and what has no number.

use crate::common;
use crate::common::texts::{text as reason_text, texts};

use std::fs;
use std::path::{Path, PathBuf};

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::report::figure::{self, Zones};
use fishplate::result::{
    Certification, Occurrence, PairValue, QuantityResult, StatisticResult, Verdict,
};
use fishplate::run::Settings;
use fishplate::source::Source;
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

fn assessment() -> String {
    fs::read_to_string(root().join("tests/cases/values/assessment.fp")).expect("a protocol")
}

fn of_group<'a>(
    found: &'a Certification,
    quantity: &str,
    name: &str,
    zone: &str,
    wheelset: &str,
) -> Option<&'a StatisticResult> {
    let quantity = found.quantities.iter().find(|known| known.id == quantity).expect("a quantity");
    let has = |group: &[(String, String)], key: &str, of: &str| {
        group.iter().any(|(known, member)| known == key && member == of)
    };
    quantity.statistics.iter().find(|one| {
        one.name.to_string() == name
            && one.scope.has_zone(Some(zone))
            && has(&one.scope.keys, "wheelset", wheelset)
    })
}

/// Conditions on samples, functions of samples, and limits of single values against NumPy, 1e-9
/// relative; see `cases/values/conditions.py`.
#[test]
fn conditions_on_samples_and_values_agree_with_numpy() {
    let found = agreeing("conditions");
    limits_follow_from_values(found.quantities.last().expect("a quantity"));
}

/// Numbers of spectra against SciPy, 1e-9 relative; see `cases/values/spectra.py`.
#[test]
fn numbers_of_spectra_agree_with_scipy() {
    assert_eq!(agreeing("spectra").quantities.len(), 6);
}

/// Numbers of cycles against another way of counting, 1e-9 relative; see `cases/values/cycles.py`.
#[test]
fn numbers_of_cycles_agree_with_another_count() {
    assert_eq!(agreeing("cycles").quantities.len(), 4);
}

/// The values of a protocol on examples/coach, after a comparison with the expected ones.
fn agreeing(name: &str) -> Certification {
    let of = |extension: &str| root().join(format!("tests/cases/values/{name}.{extension}"));
    let text = fs::read_to_string(of("fp")).expect("a text");
    let found = certified(&compiled(&format!("{name}.fp"), &text), &root().join("examples/coach"));
    let expected = fs::read_to_string(of("json"));
    let expected: Value = serde_json::from_str(&expected.expect("expected numbers")).expect("JSON");
    let same = |want: &Value, got: f64, what: &str| {
        let want = want.as_f64().unwrap_or_else(|| panic!("{what}: {got}, and none expected"));
        assert!((want - got).abs() <= 1e-9 * want.abs().max(1.0), "{what}: {want} {got}");
    };
    for (id, values) in expected.as_object().expect("quantities") {
        let quantity = found.quantities.iter().find(|one| one.id == *id).expect("a quantity");
        let there = values.as_object().expect("sections").values().filter(|one| !one.is_null());
        assert_eq!(quantity.values.len(), there.count(), "{id}");
        for pair in &quantity.values {
            let (want, what) = (&values[&pair.section], format!("{id} {}", pair.section));
            if id == "mixed" {
                same(&want[0], pair.simulated.expect("a value"), &what);
                same(&want[1], pair.measured.expect("a value"), &what);
            } else {
                same(want, pair.difference, &what);
            }
        }
    }
    found
}

/// The limits of single values, shares, counts and statistics of an expression, from the values.
fn limits_follow_from_values(mixed: &QuantityResult) {
    let limit = |pair: &PairValue| (0.1 * pair.measured.expect("a value").abs()).max(2.0);
    let values = &mixed.values;
    for pair in values {
        assert!((pair.limit.expect("a limit") - limit(pair)).abs() < 1e-12, "{}", pair.section);
    }
    let n = values.len() as f64;
    let mean = |of: &dyn Fn(&PairValue) -> f64| values.iter().map(of).sum::<f64>() / n;
    let average = mean(&|pair| pair.difference);
    let squares = mean(&|pair| (pair.difference - average).powi(2));
    let std = (squares * n / (n - 1.0)).sqrt();
    let magnitude = mean(&|pair| pair.difference.abs());
    let wanted = [
        mean(&|pair| f64::from(u8::from(pair.difference.abs() <= limit(pair)))),
        values.iter().filter(|pair| pair.difference.abs() > 2.0).count() as f64,
        magnitude,
        average + 3.0 * std,
        std,
    ];
    let told: Vec<f64> =
        mixed.statistics[1..].iter().map(|one| one.value.expect("a value")).collect();
    for (want, told) in wanted.iter().zip(&told) {
        assert!((want - told).abs() < 1e-12 * want.abs().max(1.0), "{wanted:?} {told:?}");
    }
    let bound = mixed.statistics[5].limit.expect("a limit");
    assert!((bound - 2.0 * magnitude).abs() < 1e-12, "{bound}");
    let squares =
        mean(&|pair| (pair.measured.expect("a value") - pair.simulated.expect("a value")).powi(2));
    let reported: Vec<f64> = mixed.reported.iter().map(|one| one.value.expect("a value")).collect();
    let wanted = [magnitude / 2.0, squares.sqrt()];
    assert!(wanted.iter().zip(&reported).all(|(a, b)| (a - b).abs() < 1e-12), "{reported:?}");
}

/// The differences have a mean of 2.870 kN and a standard deviation of 3.669 kN (`conditions.json`);
/// three of 13 are above 6 kN, one is above 6.2 kN.
#[test]
fn the_first_outcome_whose_rule_is_met_applies() {
    let text = fs::read_to_string(root().join("tests/cases/values/outcomes.fp")).expect("a text");
    for (scale, of_quantity, holds, overall, verdict) in [
        ("0.2", "excellent", true, "validated", Verdict::Validated),
        ("0.9", "good", true, "validated with restriction", Verdict::Validated),
        ("1", "fair", false, "validated with restriction", Verdict::Validated),
        ("2", "fair", false, "not validated", Verdict::NotValidated),
        ("3", "poor", false, "not validated", Verdict::NotValidated),
    ] {
        let text = text.replace("default  1\n", &format!("default  {scale}\n"));
        let found = certified(&compiled("outcomes.fp", &text), &root().join("examples/coach"));
        let graded = found.quantities.iter().find(|one| one.id == "graded").expect("a quantity");
        assert_eq!(graded.outcome.as_deref(), Some(of_quantity), "{scale}");
        assert_eq!(graded.holds, Some(holds), "{scale}");
        assert_eq!(found.outcome.as_deref(), Some(overall), "{scale}");
        assert_eq!(found.verdict, verdict, "{scale}");
        // Why it is not a better one.
        assert_eq!(found.reasons.is_empty(), overall == "validated", "{scale}");
    }
}

/// Estimates of each zone and wheelset against NumPy and SciPy, 1e-9 relative; see
/// `cases/values/assessment.py`.
#[test]
fn an_assessment_agrees_with_scipy() {
    let found =
        certified(&compiled("assessment.fp", &assessment()), &root().join("examples/coach-good"));
    let expected = fs::read_to_string(root().join("tests/cases/values/assessment.json"))
        .expect("expected numbers");
    let expected: Vec<Value> = serde_json::from_str(&expected).expect("JSON");
    let (mut numbers, mut without) = (0, 0);
    for one in &expected {
        let text = |key: &str| one[key].as_str().expect("a text").to_string();
        let quantity = text("quantity").replace("_max", "");
        let (estimate, zone, wheelset) = (text("estimate"), text("zone"), text("wheelset"));
        let place = format!("{quantity} {estimate} zone {zone} wheelset {wheelset}");
        let result = of_group(&found, &quantity, &estimate, &zone, &wheelset)
            .unwrap_or_else(|| panic!("{place} is missing"));
        match (one["value"].as_f64(), result.value) {
            (Some(want), Some(value)) => {
                assert!(
                    (value - want).abs() <= 1e-9 * want.abs(),
                    "{place}: {value} in place of {want}"
                );
                numbers += 1;
            }
            (None, None) => {
                let reason = reason_text(&result.reason).expect("a reason");
                assert!(
                    reason.contains("does not vary")
                        || reason.contains("collinear")
                        || reason.contains("values"),
                    "{place}: {reason}"
                );
                without += 1;
            }
            (want, value) => panic!("{place}: {value:?} in place of {want:?}"),
        }
    }
    assert!(numbers >= 100 && without >= 10, "{numbers} {without}");
    // A regression that has no number is a reason, never a verdict.
    assert_eq!(found.verdict, Verdict::NotAssessable);
    assert!(
        texts(&found.reasons).iter().any(|reason| reason.contains("Two-dimensional estimate")),
        "{:?}",
        texts(&found.reasons)
    );
}

/// An assessment reads one record: the campaign need not have the other, and its numbers are the
/// same.
#[test]
fn an_assessment_needs_no_simulation() {
    let folder = tempfile::tempdir().expect("a folder");
    let from = root().join("examples/coach-good");
    for name in ["vehicle.yaml", "sections.csv", "application.csv", "profile.csv"] {
        fs::copy(from.join(name), folder.path().join(name)).expect("a copy");
    }
    for part in ["measurement", "track"] {
        fs::create_dir(folder.path().join(part)).expect("a folder");
        for entry in fs::read_dir(from.join(part)).expect("records") {
            let path = entry.expect("an entry").path();
            fs::copy(&path, folder.path().join(part).join(path.file_name().expect("a name")))
                .expect("a copy");
        }
    }
    let campaign = fs::read_to_string(from.join("campaign.yaml")).expect("a campaign");
    let without: String = campaign
        .lines()
        .filter(|line| !line.starts_with("simulation:"))
        .map(|line| format!("{line}\n"))
        .collect();
    assert_ne!(campaign, without);
    fs::write(folder.path().join("campaign.yaml"), without).expect("written");
    let protocol = compiled("assessment.fp", &assessment());
    let (alone, both) = (certified(&protocol, folder.path()), certified(&protocol, &from));
    for (a, b) in alone.quantities.iter().zip(&both.quantities) {
        let numbers = |statistics: &[StatisticResult]| {
            statistics.iter().map(|one| (one.value, one.limit, one.holds)).collect::<Vec<_>>()
        };
        assert_eq!(numbers(&a.statistics), numbers(&b.statistics), "{}", a.id);
        assert!(
            a.from.as_deref() == Some("measured")
                && !a.has_sides
                && a.values.iter().all(|value| value.simulated.is_none())
        );
    }
    assert_eq!((alone.verdict, texts(&alone.reasons)), (both.verdict, texts(&both.reasons)));
}

const HEAD: &str = "protocol small \"Small\"\n  extends  en14363-2016-annex-t\n\n";

/// Of one quantity in place of all others.
fn small(quantity: &str) -> Compiled {
    let shipped = library::shipped("en14363-2016-annex-t").expect("a shipped protocol");
    let names = shipped
        .text
        .lines()
        .filter_map(|line| line.strip_prefix("quantity ")?.split(' ').next().map(str::to_string));
    let removed: String = names.map(|name| format!("  quantity  {name}\n")).collect();
    compiled("small.fp", &format!("{HEAD}remove\n{removed}\n{quantity}"))
}

fn statistics(found: &Certification) -> &[StatisticResult] {
    &found.quantities[0].statistics
}

/// Groups by key partition the values, and a group of all is the whole.
#[test]
fn groups_partition_the_values() {
    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelsets 1, 2\n  filter  LP20\n  value   p99.85\n  limit   mean 500 kN\n  \
         limit   p50 500 kN for each wheelset and side\n  limit   p60 500 kN for each section\n  limit   p70 500 kN for zones 2, 3 and each side\n  \
         limit   p80 500 kN for each zone where direction is not straight\n  limit   (n) at least 1\n  limit   (total of length) at least 1 m\n  \
         limit   (share where value <= 60 kN) at least 0.01\n  limit   (share of sections where direction is straight) at least 0.01\n",
    );
    let found = certified(&protocol, &root().join("examples/coach-good"));
    let values = &found.quantities[0].values;
    let of = |name: &str| {
        statistics(&found).iter().filter(|one| one.name.to_string() == name).collect::<Vec<_>>()
    };
    let counted = |name: &str| of(name).iter().map(|one| one.count).sum::<usize>();
    assert_eq!((of("p50").len(), counted("p50")), (4, values.len()));
    assert_eq!((of("p60").len(), counted("p60")), (13, values.len()));
    let zones_2_3 =
        values.iter().filter(|value| matches!(value.zone.as_deref(), Some("2" | "3"))).count();
    assert_eq!((of("p70").len(), counted("p70")), (2, zones_2_3));
    // Zone 1 is straight: a group that the condition empties vanishes.
    let scopes: Vec<String> = of("p80").iter().map(|one| one.scope.to_string()).collect();
    assert_eq!(
        scopes,
        [
            "zone 2, direction is not straight",
            "zone 3, direction is not straight",
            "zone 4, direction is not straight"
        ]
    );
    assert_eq!(of("n")[0].value, Some(13.0));
    let length: f64 = found.sections.iter().map(|section| section.length).sum();
    let total = of("total of length")[0];
    assert!((total.value.expect("a length") - length).abs() < 1e-9 * length && total.unit == "m");
    let low =
        values.iter().filter(|value| value.difference <= 60.0).count() as f64 / values.len() as f64;
    assert_eq!(of("share where value <= 60 kN")[0].value, Some(low));
    assert_eq!(of("share of sections where direction is straight")[0].value, Some(3.0 / 13.0));
    assert_eq!(found.verdict, Verdict::Validated, "{:?}", texts(&found.reasons));
}

/// A position that is recorded, in a zone that has none of its values: not assessable, not left
/// out.
#[test]
fn a_group_that_should_be_there_is_missed() {
    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1\n  of      Q at wheelset 2 when direction is straight\n  filter  LP20\n  \
         value   p99.85\n  limit   mean 500 kN for each zone and wheelset\n",
    );
    let found = certified(&protocol, &root().join("examples/coach-good"));
    assert_eq!(found.verdict, Verdict::NotAssessable);
    let missed = statistics(&found)
        .iter()
        .find(|one| one.scope.to_string() == "zone 2, wheelset 2")
        .expect("the group");
    assert_eq!(
        (missed.value, reason_text(&missed.reason).as_deref()),
        (None, Some("no value is available"))
    );
}

/// What an estimate cannot be had of is a reason: one value, equal values, too few for a
/// regression.
#[test]
fn too_few_values_are_a_reason() {
    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1 and side R\n  filter  LP20\n  value   p99.85\n  \
         limit   std 500 kN for each section\n  limit   (prediction over speed, radius, cant at 1 m/s, 1 m, 1 mm, confidence 95 %) 500 kN for zone 3\n  \
         limit   (regression over radius, (2 * radius) at 400 m, 800 m) 500 kN for zone 4\n  limit   (upper 95 % of mean) 500 kN for each section\n",
    );
    let found = certified(&protocol, &root().join("examples/coach-good"));
    assert!(statistics(&found).iter().all(|one| one.value.is_none() && one.holds.is_none()));
    let reason = |at: usize| reason_text(&statistics(&found)[at].reason).expect("a reason");
    assert_eq!(reason(0), "not defined for 1 value");
    let of = |word: &str| {
        statistics(&found)
            .iter()
            .find(|one| one.name.to_string().starts_with(word))
            .and_then(|one| reason_text(&one.reason))
            .expect("a reason")
    };
    assert!(of("prediction").contains("3 values"), "{}", of("prediction"));
    assert!(of("regression").contains("collinear"), "{}", of("regression"));
    assert!(of("upper").contains("site"), "{}", of("upper"));
}

/// A study of sections evaluates an estimate over every selection, and takes a repeat with the
/// section that it repeats.
#[test]
fn a_study_takes_estimates_and_repeats() {
    use fishplate::run::{Shifts, evaluate};
    use fishplate::study::{Settings as StudySettings, case::Case, selections};

    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1 and side R\n  filter  LP20\n  value   p99.85\n  \
         limit   (mean + 2.2 * std) 90 kN\n  limit   (regression over cant_deficiency at 100 mm) 500 kN\n",
    );
    let mut problems = Problems::default();
    let campaign =
        Campaign::open(&root().join("examples/coach-good"), &mut problems).expect("a campaign");
    let all = evaluate(&protocol.plan, &protocol.graph, &campaign, &Shifts::NONE, &|_| {})
        .expect("values")
        .swap_remove(0);
    let pool = all.pool(&protocol.plan);
    let case = Case::of(&pool, None).expect("a case");
    let found = selections(&case, &StudySettings::default());
    // Zones of 3, 3, 3 and 4 sections, 3 of each.
    assert_eq!(found.counted.combinations, 4.0);
    let value = |sections: &[usize]| {
        let values: Vec<f64> =
            sections.iter().flat_map(|&at| case.quantities[0].values[at].iter().copied()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        (mean + 2.2 * (squares / (values.len() as f64 - 1.0)).sqrt()) / 90.0
    };
    let measure = &case.quantities[0].measures[0];
    let largest = case.strata[3]
        .members
        .iter()
        .map(|left_out| {
            let chosen: Vec<usize> =
                case.usable().into_iter().filter(|at| at != left_out).collect();
            let found = measure.over(chosen.iter().copied()).expect("a value");
            assert!((found - value(&chosen)).abs() < 1e-12 * found, "{found}");
            found
        })
        .fold(0.0, f64::max);
    let spread = &found.quantities[0].statistics[0];
    assert!((spread.spread.as_ref().expect("a spread").max - largest).abs() < 1e-12);

    let mut repeated = pool.clone();
    repeated.sections[1].site = 0;
    let refused = Case::of(&repeated, None).expect_err("zone 1 has two sites");
    assert!(refused.text().to_string().contains("zone 1 has 2 usable sites"), "{refused:?}");
    let merged = Case::of(&repeated, Some(2)).expect("a case");
    assert_eq!(
        (merged.strata[0].members.as_slice(), merged.quantities[0].values[0].len()),
        ([0, 2].as_slice(), 2)
    );
    let found =
        merged.quantities[0].measures[0].over(merged.usable().into_iter()).expect("a value");
    assert!((found - value(&(0..13).collect::<Vec<_>>())).abs() < 1e-12 * found, "{found}");
}

/// Estimates over selections against every selection by itself: from sums, of one zone, of all.
/// Where selections are drawn at random, those of one zone are exact all the same.
#[test]
fn a_study_evaluates_estimates_of_groups_for_each_choice_of_their_sections() {
    use fishplate::run::{Shifts, evaluate};
    use fishplate::study::{Settings as StudySettings, case::Case, enumerate, sampling};

    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1 and side R\n  of      Q at wheelset 2 and side R when zone is 4\n  \
         filter  LP20\n  value   p99.85\n  limit   (mean + 2.2 * std) 72 kN\n  limit   (mean + 0.5 * rms) 120 kN for each zone\n  \
         limit   (regression over cant_deficiency at 100 mm) 75 kN\n  limit   (regression over cant_deficiency at 120 mm) 75 kN for zone 4\n  \
         limit   median 80 kN for each zone\n",
    );
    let mut problems = Problems::default();
    let campaign =
        Campaign::open(&root().join("examples/coach-good"), &mut problems).expect("a campaign");
    let all = evaluate(&protocol.plan, &protocol.graph, &campaign, &Shifts::NONE, &|_| {})
        .expect("values")
        .swap_remove(0);
    let case = Case::of(&all.pool(&protocol.plan), Some(2)).expect("a case");
    let selections = common::pools::every(&case);
    // Two of 3, 3, 3 and 4 sections.
    assert_eq!(selections.len(), 3 * 3 * 3 * 6);
    let judged: Vec<_> = selections.iter().map(|selection| case.judge(selection)).collect();
    let counted = enumerate::all(&case);
    let good = judged.iter().filter(|(verdict, _)| *verdict == Verdict::Validated).count();
    assert_eq!(counted.share.validated as usize, good);
    let drawn = sampling::some(&case, &StudySettings { most: 0.0, width: 0.2, seed: 1 });
    let statistics = &counted.quantities[0].statistics;
    assert_eq!(statistics.len(), 1 + 4 + 1 + 1 + 4);
    for (at, (counted, drawn)) in statistics.iter().zip(&drawn.quantities[0].statistics).enumerate()
    {
        let values: Vec<f64> = judged.iter().filter_map(|(_, all)| all[at].normalised).collect();
        let failing =
            judged.iter().filter(|(_, all)| all[at].normalised.is_some() && !all[at].holds).count();
        assert_eq!(
            (counted.failing * judged.len() as f64).round() as usize,
            failing,
            "{} {}",
            counted.title,
            counted.scope
        );
        let wanted = common::pools::sorted(values).expect("values");
        let (found, again) = (counted.spread.expect("values"), drawn.spread.expect("values"));
        let parts = [(found, wanted), (again, wanted)];
        for (found, wanted) in parts {
            let pairs = [
                (found.min, wanted.min),
                (found.q1, wanted.q1),
                (found.median, wanted.median),
                (found.max, wanted.max),
            ];
            assert!(
                pairs.iter().all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs()),
                "{} {}: {pairs:?}",
                counted.title,
                counted.scope
            );
            assert_eq!(
                (found.count, found.outliers, found.exact),
                (wanted.count, wanted.outliers, true)
            );
        }
    }
}

/// Neither the order of keys nor the unit of a quantity changes what is found.
#[test]
fn order_and_units_change_nothing() {
    let of = |unit: &str, keys: &str| {
        small(&format!(
            "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelsets 1, 2\n  filter  LP20\n  value   p99.85\n  in      {unit}\n  \
             limit   (mean + 2.2 * std) 90 kN for each {keys}\n  limit   (upper 95 % of std) 20 kN for each {keys}\n"
        ))
    };
    let campaign = root().join("examples/coach-good");
    let found = |unit: &str, keys: &str| {
        let found = certified(&of(unit, keys), &campaign);
        let mut all = Vec::new();
        for one in statistics(&found) {
            let mut group = one.scope.keys.clone();
            group.sort();
            let (value, limit) = (one.value.expect("a value"), one.limit.expect("a limit"));
            all.push((one.name.to_string(), group, value, limit, one.holds));
        }
        all.sort_by(|a, b| (&a.0, &a.1).cmp(&(&b.0, &b.1)));
        all
    };
    let (plain, turned, newton) = (
        found("kN", "wheelset and side"),
        found("kN", "side and wheelset"),
        found("N", "wheelset and side"),
    );
    assert_eq!(plain.len(), 8);
    assert_eq!(plain, turned);
    for (a, b) in plain.iter().zip(&newton) {
        assert!(
            (a.2 * 1000.0 - b.2).abs() <= 1e-12 * b.2
                && (a.3 * 1000.0 - b.3).abs() <= 1e-12 * b.3
                && a.4 == b.4,
            "{a:?} {b:?}"
        );
    }
}

/// A condition that cannot be told, or that no section meets, is a reason: its limit does not
/// vanish.
#[test]
fn a_limit_does_not_vanish() {
    let protocol = small(
        "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1 and side R\n  filter  LP20\n  value   p99.85\n  limit   mean 500 kN\n  \
         limit   p60 500 kN for each wheelset where speed > 5000 km/h\n  limit   p70 500 kN for zone 1 and each wheelset where radius < 600 m\n",
    );
    let found = certified(&protocol, &root().join("examples/coach-good"));
    let of = |name: &str| {
        statistics(&found)
            .iter()
            .find(|one| one.name.to_string() == name)
            .unwrap_or_else(|| panic!("{name} is missing"))
    };
    assert_eq!(reason_text(&of("p60").reason).as_deref(), Some("no value is available"));
    assert!(
        reason_text(&of("p70").reason)
            .as_deref()
            .expect("a reason")
            .contains("cannot be determined"),
        "{:?}",
        of("p70").reason
    );
    assert_eq!(found.verdict, Verdict::NotAssessable);
}

/// A limit of groups is one limit where limits are counted.
#[test]
fn groups_are_no_further_limits() {
    let protocol = |needed: usize| {
        small(&format!(
            "quantity Q \"Q\"\n  from    measured\n  of      Q at wheelset 1 and side R\n  filter  LP20\n  value   p99.85\n  \
             limit   mean 0.001 kN\n  limit   (n) 100 for each section\n\nverdict\n  validated  when at least {needed} limits hold\n  minimum pairs  1\n  minimum signals  1\n"
        ))
    };
    let campaign = root().join("examples/coach-good");
    assert_eq!(certified(&protocol(1), &campaign).verdict, Verdict::Validated);
    assert_eq!(certified(&protocol(2), &campaign).verdict, Verdict::NotValidated);
}

fn numbers(name: &str) -> Vec<Value> {
    let text =
        fs::read_to_string(root().join("tests/cases/values").join(name)).expect("expected numbers");
    serde_json::from_str(&text).expect("JSON")
}

/// Metrics in expressions, coherence, numbers of both sides' samples, derivative, integral, shift
/// and slope over a signal: against an independent program (12 digits) and NumPy
/// (`cases/values/both_sides.py`), 1e-9 relative.
#[test]
fn numbers_of_both_sides_agree_with_numpy() {
    let protocol =
        fs::read_to_string(root().join("tests/cases/values/both_sides.fp")).expect("a protocol");
    let found =
        certified(&compiled("both_sides.fp", &protocol), &root().join("examples/coach-good"));
    let value_of = |quantity: &str, section: &str, signal: &str| {
        let known = found
            .quantities
            .iter()
            .find(|known| known.id == quantity)
            .unwrap_or_else(|| panic!("no {quantity}"));
        let factor = fishplate::units::Unit::parse(&known.unit).expect("a unit").factor;
        let value =
            known.values.iter().find(|value| value.section == section && value.signal == signal);
        let value = value.unwrap_or_else(|| {
            panic!("{quantity} {section} {signal} is missing: {:?}", texts(&found.reasons))
        });
        (
            value.difference * factor,
            value.simulated.map(|side| side * factor),
            value.measured.map(|side| side * factor),
        )
    };
    let near = |place: &str, value: f64, want: f64, scale: f64| {
        assert!((value - want).abs() <= 1e-9 * scale.abs(), "{place}: {value} in place of {want}");
    };
    let mut compared = 0;
    for one in numbers("both_sides_filtered.json") {
        let (section, signal) =
            (one["section"].as_str().expect("a text"), one["signal"].as_str().expect("a text"));
        let want = |key: &str| one[key].as_f64().unwrap_or_else(|| panic!("no {key}"));
        let channel = &signal[..1];
        let mut all: Vec<(String, f64)> = ["1_2", "2_4", "4_8", "8_16"]
            .iter()
            .flat_map(|band| {
                [
                    (format!("coherence_{band}"), want(&format!("coherence_{band}"))),
                    (format!("octave_{band}"), want(&format!("band_ratio_{band}"))),
                ]
            })
            .collect();
        all.push(("nrmse".into(), want("nrmse_rms")));
        all.push(("nrmse_of_metric".into(), want("nrmse_rms")));
        all.push(("nrmse_range".into(), want("nrmse_range")));
        all.push(("rating".into(), 0.4 * want("correlation") + 0.6 * (1.0 - want("theil_U1"))));
        for (quantity, want) in all {
            let quantity = format!("{channel}_{quantity}");
            near(
                &format!("{quantity} {section} {signal}"),
                value_of(&quantity, section, signal).0,
                want,
                want,
            );
            compared += 1;
        }
    }
    for one in numbers("both_sides.json") {
        let text = |key: &str| one[key].as_str().expect("a text");
        if text("quantity") == "apart" {
            let at = |place: &&Occurrence| {
                place.section.as_deref() == Some(text("section"))
                    && place.channel.as_deref() == Some(text("signal"))
            };
            let of = found.findings.iter().filter(|finding| finding.code == "apart");
            let finding = of.flat_map(|finding| &finding.places).find(at).expect("a finding");
            let want = one["value"].as_f64().expect("a number") / 1000.0;
            near("apart", finding.value.expect("a number"), want, want);
            compared += 1;
            continue;
        }
        let (value, simulated, measured) =
            value_of(text("quantity"), text("section"), text("signal"));
        let place = format!("{} {} {}", text("quantity"), text("section"), text("signal"));
        // A difference of two sums over a record loses the digits of these.
        let scale =
            one["measured"].as_f64().or(one["value"].as_f64()).expect("a number").abs().max(1e-3);
        for (key, value) in
            [("simulated", simulated), ("measured", measured), ("value", Some(value))]
        {
            if let (Some(want), Some(value)) = (one[key].as_f64(), value) {
                near(&place, value, want, scale);
                compared += 1;
            }
        }
    }
    assert!(compared > 2000, "{compared}");
}

/// Numbers of NumPy, SciPy and `objective-rating-metrics` 1.3: protocol > section > signal >
/// quantity; see `cases/values/metrics.py`.
fn expected_metrics() -> Value {
    let text = fs::read_to_string(root().join("tests/cases/values/metrics.json"))
        .expect("expected numbers");
    serde_json::from_str(&text).expect("JSON")
}

fn shipped(name: &str) -> Compiled {
    compiled(name, &library::shipped(name).expect("a shipped protocol").text)
}

/// In SI, of a quantity, section, signal and, where there are several, record.
fn value_of(
    found: &Certification,
    quantity: &str,
    section: &str,
    signal: &str,
    record: Option<&str>,
) -> f64 {
    let of = found
        .quantities
        .iter()
        .find(|known| known.id == quantity)
        .unwrap_or_else(|| panic!("no quantity {quantity}"));
    let is = |value: &&PairValue| {
        value.section == section
            && value.signal == signal
            && value.record.as_ref().map(ToString::to_string).as_deref() == record
    };
    let value = of
        .values
        .iter()
        .find(is)
        .unwrap_or_else(|| panic!("{quantity} has no value of {section} {signal}"));
    let factor = if of.unit == "kN" { 1000.0 } else { 1.0 };
    value.difference * factor
}

#[track_caller]
fn agree(value: f64, expected: &Value, what: &str) {
    let expected = expected.as_f64().expect("a number");
    // The numbers are written with 12 digits; a probability of 1e-30 is a zero.
    assert!(
        (value - expected).abs() <= 1e-9 * expected.abs() + 1e-12,
        "{what}: {value}, not {expected}"
    );
}

/// Every metric of the shipped protocols, 1e-9 relative.
#[test]
fn shipped_metrics_agree_with_scipy() {
    let expected = expected_metrics();
    for (protocol, least) in [("metrics-side-by-side", 2600), ("bogojevic-lucanin", 430)] {
        let found = certified(&shipped(protocol), &root().join("examples/coach-good"));
        let mut numbers = 0;
        for (section, signals) in expected[protocol].as_object().expect("sections") {
            for (signal, quantities) in signals.as_object().expect("signals") {
                for (quantity, number) in quantities.as_object().expect("quantities") {
                    agree(
                        value_of(&found, quantity, section, signal, None),
                        number,
                        &format!("{quantity} {section} {signal}"),
                    );
                    numbers += 1;
                }
            }
        }
        assert!(numbers >= least, "{numbers} numbers of {protocol}");
        let unverified = |id: &str| {
            found
                .quantities
                .iter()
                .find(|of| of.id == id)
                .expect("a quantity")
                .comparison
                .contains("unverified")
        };
        if protocol == "metrics-side-by-side" {
            assert!(
                unverified("Y_cora") && unverified("az_cora_size") && !unverified("Y_iso18571")
            );
        }
        // Limits that are no one's say so.
        assert!(
            found
                .quantities
                .iter()
                .flat_map(|of| &of.statistics)
                .all(|one| one.limit_text.ends_with("to be confirmed against the standard"))
        );
        assert!(!found.provisional.is_empty());
    }
}

/// The index of each quantity, the share of each model up to it, and what the figure shows.
#[test]
fn misfits_are_judged_by_repeats_and_model() {
    let expected = expected_metrics();
    let found = certified(&shipped("kraft"), &root().join("examples/repeats"));
    assert_eq!(found.verdict, Verdict::NotValidated);
    for (section, signals) in expected["kraft"]
        .as_object()
        .expect("sections")
        .iter()
        .filter(|(section, _)| *section != "index")
    {
        for (signal, quantities) in signals.as_object().expect("signals") {
            for (quantity, number) in quantities.as_object().expect("quantities") {
                let (quantity, record) = quantity
                    .split_once(", ")
                    .map_or((quantity.as_str(), None), |(name, record)| (name, Some(record)));
                agree(
                    value_of(&found, quantity, section, signal, record),
                    number,
                    &format!("{quantity} {section} {signal}"),
                );
            }
        }
    }
    for (name, of) in expected["kraft"]["index"].as_object().expect("quantities") {
        let quantity = found
            .quantities
            .iter()
            .find(|known| known.id == format!("{name}_misfit"))
            .expect("a quantity");
        assert_eq!(quantity.statistics.len(), 2, "one for each model");
        for one in &quantity.statistics {
            let (_, record) =
                one.scope.keys.iter().find(|(key, _)| key == "record").expect("a record");
            agree(one.value.expect("a share"), &of[record], &format!("share of {name}, {record}"));
            agree(one.divided_at.expect("an index"), &of["index"], &format!("index of {name}"));
        }
        let svg = figure::frequency(quantity, &Zones::of(&found));
        assert_eq!(svg.matches("class=\"curve\"").count(), 2, "a curve for each model");
        assert!(
            svg.contains("reference (")
                && svg.contains("soft_guidance (")
                && !svg.contains("limit 0.8"),
            "{svg}"
        );
    }
    // Without sections measured again there is no index, and no verdict.
    let found = certified(&shipped("kraft"), &root().join("examples/coach-good"));
    assert_eq!(found.verdict, Verdict::NotAssessable);
}
