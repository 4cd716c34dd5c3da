//! The test protocols of `cases/check/good` run on a small campaign of straight lines, whose every
//! value follows by hand.
//!
//! A channel of section `s` is `offset + slope * (x - 30 m)`, in kN; simulation and measurement
//! differ in the offset only.

use crate::common::straight;

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Override, Overrides, family, plan::SetBy};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::{Certification, PairValue, QuantityResult, StatisticResult, Verdict};
use fishplate::run::{Settings, Shifts, evaluate};
use fishplate::source::Source;
use fishplate::syntax::document::Text;
use straight::{END, SECTIONS, SLOPE, START, write_campaign};
use tempfile::TempDir;

/// A test protocol and the campaign of straight lines, in a folder that must outlive it.
fn prepared(protocol: &str, set: &[(&str, &str)]) -> (Compiled, Campaign, TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    write_campaign(folder.path());
    let path =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/cases/check/good").join(protocol);
    let source = Source::new(protocol, fs::read_to_string(path).expect("a readable case"));
    let mut problems = Problems::default();
    let family = family::read(&source, &library::parent, &mut problems);
    let overrides: Overrides = set
        .iter()
        .map(|(name, value)| {
            let text = Text {
                text: (*value).to_string(),
                span: Source::new("--set", *value).whole(),
                exact: true,
            };
            ((*name).to_string(), Override { text, set_by: SetBy::CommandLine })
        })
        .collect();
    let compiled = compile(family, &overrides, &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    let campaign = Campaign::open(folder.path(), &mut problems)
        .unwrap_or_else(|| panic!("{}", problems.render(false)));
    (compiled, campaign, folder)
}

fn run(protocol: &str, set: &[(&str, &str)]) -> Certification {
    let (compiled, campaign, _folder) = prepared(protocol, set);
    certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
}

#[track_caller]
fn quantity<'a>(found: &'a Certification, id: &str) -> &'a QuantityResult {
    found.quantities.iter().find(|quantity| quantity.id == id).expect("the quantity")
}

#[track_caller]
fn statistic<'a>(
    found: &'a Certification,
    id: &str,
    name: &str,
    scope: &str,
) -> &'a StatisticResult {
    let quantity = quantity(found, id);
    let same = |statistic: &&StatisticResult| {
        statistic.name.to_string() == name && statistic.scope.to_string() == scope
    };
    quantity.statistics.iter().find(same).unwrap_or_else(|| panic!("{:?}", quantity.statistics))
}

#[track_caller]
fn near(found: Option<f64>, wanted: f64) {
    let found = found.expect("a value");
    assert!((found - wanted).abs() <= 1e-9 * (1.0 + wanted.abs()), "{found} is not {wanted}");
}

fn values(found: &Certification, id: &str) -> Vec<(String, String, f64)> {
    let mut values: Vec<_> = quantity(found, id)
        .values
        .iter()
        .map(|value| (value.section.clone(), value.signal.clone(), value.difference))
        .collect();
    values.sort_by(|a, b| (&a.0, &a.1).cmp(&(&b.0, &b.1)));
    values
}

fn deviation(of: &[f64], divisor: f64) -> f64 {
    let mean = of.iter().sum::<f64>() / of.len() as f64;
    (of.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (of.len() as f64 - divisor)).sqrt()
}

#[test]
fn the_outer_wheel_is_the_left_one_in_right_hand_curves() {
    let found = run("outer_wheel.fp", &[]);
    // S2, S4 right: left wheel; S3 left: right wheel. Oriented: measured values are negative on the
    // left.
    let wanted: Vec<(String, String, f64)> = [("S2", -2.0), ("S3", -1.0), ("S4", 3.0)]
        .map(|(section, difference)| (section.into(), "Y_1outer".into(), difference))
        .into();
    let outer = values(&found, "leading_outer");
    assert_eq!(
        outer.iter().map(|value| (&value.0, &value.1)).collect::<Vec<_>>(),
        wanted.iter().map(|value| (&value.0, &value.1)).collect::<Vec<_>>()
    );
    for (found, wanted) in outer.iter().zip(&wanted) {
        near(Some(found.2), wanted.2);
    }
    let outside: Vec<f64> = values(&found, "towards_outside").iter().map(|value| value.2).collect();
    for (found, wanted) in outside.iter().zip([-2.0, -1.0, 3.0]) {
        near(Some(*found), wanted);
    }
}

#[test]
fn limits_follow_the_zone() {
    let found = run("limits_by_zone.fp", &[("share", "1/2")]);
    let zone_2 = [1.0, 2.0, -1.0, 0.5, -2.0, -3.0];
    for (zone, limit, differences) in
        [("zone 1", 5.0, &[0.5, 0.25][..]), ("zone 2", 7.0, &zone_2[..])]
    {
        let std = statistic(&found, "table", "std", zone);
        near(std.value, deviation(differences, 1.0));
        near(std.limit, limit);
        near(statistic(&found, "table", "mean", zone).limit, limit / 2.0);
    }
    assert_eq!(quantity(&found, "table").statistics.len(), 5);
    // A passenger vehicle with Q0 = 60 kN: one of the three limits applies.
    let [only] = quantity(&found, "by_condition").statistics.as_slice() else {
        panic!("one limit applies")
    };
    near(only.limit, 4.0);
}

#[test]
fn limits_follow_the_section() {
    let found = run("limits_by_speed.fp", &[]);
    // Worst of |difference| / limit: S4 left, 3 kN of 1.5 * 4 kN (90 km/h, zone 2) against S2 left,
    // 2 kN of 1.5 * 3 kN.
    let each = statistic(&found, "each_section", "each", "all");
    near(each.normalised, 3.0 / 6.0);
    near(each.limit, 6.0);
    near(
        statistic(&found, "by_class", "std", "speed <= 80 km/h").value,
        deviation(&[0.5, 0.25, 1.0, 2.0], 1.0),
    );
    near(statistic(&found, "by_class", "mean", "speed <= 80 km/h").limit, 2.0);
    let found = run("bound_by_section.fp", &[]);
    // Bounds 3, 2 and 2.6 kN in S2 to S4.
    let each = statistic(&found, "bounded", "each", "all");
    near(each.normalised, 3.0 / 2.6);
    assert_eq!((each.holds, found.verdict), (Some(false), Verdict::NotValidated));
}

#[test]
fn lower_limits_hold_from_above() {
    let found = run("correlation_at_least.fp", &[]);
    // Parallel lines are fully correlated.
    let quantity = quantity(&found, "likeness");
    assert_eq!(quantity.statistics.len(), 2);
    for statistic in &quantity.statistics {
        near(statistic.value, 1.0);
        assert_eq!(statistic.holds, Some(true));
    }
}

#[test]
fn the_slope_is_that_of_the_line() {
    let found = run("regression_slope.fp", &[]);
    let drift = quantity(&found, "drift");
    assert_eq!(drift.unit, "N/m");
    for value in &drift.values {
        near(value.simulated, 1e3 * SLOPE);
        assert!(value.difference.abs() < 1e-6);
    }
}

#[test]
fn a_quantity_may_be_of_straight_track_only() {
    let found = run("straight_only.fp", &[]);
    let straight = quantity(&found, "straight");
    assert!(
        straight.values.iter().all(|value| value.section == "S1") && straight.values.len() == 2
    );
    let differences: Vec<f64> = straight.values.iter().map(|value| value.difference).collect();
    // Divisor n.
    near(statistic(&found, "straight", "std", "all").value, deviation(&differences, 0.0));
    assert_eq!(found.verdict, Verdict::Validated);
}

#[test]
fn the_side_of_a_percentile_is_chosen() {
    // Section values rise by 1.2 kN; linear percentiles over the 1201 samples of 0.1 m.
    let percentile = |offset: f64, percent: f64| offset + SLOPE * (END - START) * percent / 100.0;
    let found = run("side_of_percentile.fp", &[]);
    for value in &quantity(&found, "extreme").values {
        let section =
            SECTIONS.iter().find(|section| section.name == value.section).expect("a section");
        let (measured, more) = if value.signal == "Y_1R" { section.right } else { section.left };
        // The side larger in the measurement: upper where the values are positive.
        let percent = if percentile(measured, 99.85).abs() >= percentile(measured, 0.15).abs() {
            99.85
        } else {
            0.15
        };
        near(value.measured, percentile(measured, percent).abs());
        near(value.simulated, percentile(measured + more, percent).abs());
    }
    let found = run("side_of_percentile.fp", &[("rule", "curve")]);
    for id in ["extreme", "extreme_by_curve"] {
        let s2 = quantity(&found, id)
            .values
            .iter()
            .find(|value| value.section == "S2" && value.signal == "Y_1R")
            .expect("a value");
        near(s2.measured, percentile(4.0, 0.15).abs());
        let s3 = quantity(&found, id)
            .values
            .iter()
            .find(|value| value.section == "S3" && value.signal == "Y_1R")
            .expect("a value");
        near(s3.measured, percentile(22.0, 99.85).abs());
    }
}

#[test]
fn spatial_filters_and_sliding_windows_run() {
    // A straight line has no waves of 3 to 25 m; what the ends of the record leave in the section
    // is small.
    let found = run("spatial_filters.fp", &[]);
    assert!(
        quantity(&found, "long_waves")
            .values
            .iter()
            .all(|value| value.simulated.is_some_and(|value| value < 0.05)),
        "{:?}",
        quantity(&found, "long_waves").values
    );
    let found = run("instability.fp", &[("frequency", "4 Hz")]);
    let rms = quantity(&found, "SigmaY_rms");
    assert_eq!(rms.values.len(), 8);
    near(statistic(&found, "SigmaY_rms", "std", "all").limit, 0.1 * (10.0 + 2.0 / 3.0 * 60.0));
}

/// Of the line 4 kN + 0.01 kN/m (x - 30 m) with samples each 0.1 m, 0.005 s apart, by hand: 20 samples
/// in 2 m, 200 in 1 s; the last window of 5 ft from a sample begins at 148.4 m. Of n samples of the
/// parabola c k², what the line leaves has the rms c √((n² - 1)(n² - 4)/180).
#[test]
fn values_of_sliding_windows_run() {
    let found = run("sliding_values.fp", &[]);
    let measured = |found: &Certification, id: &str| {
        let of = |value: &&PairValue| value.section == "S2";
        quantity(found, id).values.iter().find(of).expect("a value").measured
    };
    near(measured(&found, "throughout"), 4.0 + SLOPE * 118.4);
    near(measured(&found, "any_second"), SLOPE * 19.9);
    near(measured(&found, "scatter"), SLOPE * 0.1 * 35_f64.sqrt());
    near(measured(&found, "steepest"), SLOPE);
    let parabola = |n: f64| (SLOPE * 0.1).powi(2) * ((n * n - 1.0) * (n * n - 4.0) / 180.0).sqrt();
    for (id, samples) in [("about_trend", 20.0), ("whole_about_trend", 1201.0)] {
        let ratio = measured(&found, id).expect("a value") / parabola(samples);
        assert!((ratio - 1.0).abs() < 1e-7, "{id}: {ratio}");
    }
    // The largest of 20 samples is 1.9 m behind their start; of five windows, the fourth.
    near(measured(&found, "chosen"), 4.0 + SLOPE * 31.9);
    near(
        measured(&run("sliding_values.fp", &[("which", "minimum")]), "chosen"),
        4.0 + SLOPE * 30.0,
    );
}

/// Of the line 4 kN + 0.01 kN/m u, u from 0 to 120 m, by hand: ∫ Y² = (5.2³ - 4³)/0.03 kN² m, and by
/// the trapezoidal rule 2e-5 of that unit more. The mean is 4.6 kN.
#[test]
fn rational_powers_run() {
    let found = run("rational_powers.fp", &[]);
    let of = |found: &Certification, id: &str| {
        let of = |value: &&PairValue| value.section == "S2";
        let value = quantity(found, id).values.iter().find(of).expect("a value");
        value.measured.or(Some(value.difference))
    };
    let dose = ((5.2_f64.powi(3) - 64.0) / 0.03 + 2e-5).sqrt();
    for id in ["dose", "dose_by_power"] {
        near(of(&found, id), dose);
    }
    assert_eq!(quantity(&found, "dose").unit, "kN*m^0.5");
    near(of(&found, "third"), 4.6_f64.cbrt());
    near(of(&found, "index"), 4.42 * 4.6_f64.powf(0.3));
    near(of(&run("rational_powers.fp", &[("exponent", "0.5")]), "index"), 4.42 * 4.6_f64.sqrt());
    // First^-2 of the root is 1/(4 kN), of S1 1/(1 kN).
    near(Some(quantity(&found, "root_first").values[0].difference), 1.0);
    // A negative number has no root: no value, and the reason names the row.
    let found = run("root_of_negative.fp", &[]);
    assert!(quantity(&found, "nothing").values.iter().all(|value| value.section == "S3"));
    let told = format!("{:?}", found.sections);
    assert!(told.contains("NotFiniteResult") && told.contains("row: Some"), "{told}");
}

/// Percentiles of a line over 1201 samples by hand; of the windows those of `windows` lie 0.75 · 19
/// samples behind their starts. Confidence and percentile of pairs come from the same pairs as
/// `upper 90 % of mean` and `p75`.
#[test]
fn a_parameter_stands_for_a_number() {
    let found = run("parameters_as_numbers.fp", &[]);
    let of = |found: &Certification, id: &str| {
        let of = |value: &&PairValue| value.section == "S2";
        let value = quantity(found, id).values.iter().find(of).expect("a value");
        value.measured.or(Some(value.difference))
    };
    let percentile = |offset: f64, percent: f64| offset + SLOPE * (END - START) * percent / 100.0;
    near(of(&found, "extreme"), percentile(4.0, 99.85));
    near(of(&found, "named"), percentile(4.0, 0.15));
    let median = run("parameters_as_numbers.fp", &[("level", "50 %"), ("share", "50 %")]);
    near(of(&median, "extreme"), percentile(4.0, 50.0));
    let names = |found: &Certification| -> Vec<String> {
        let statistics = &quantity(found, "extreme").statistics;
        statistics.iter().map(|statistic| statistic.name.to_string()).collect()
    };
    assert!(names(&found).contains(&"p75".to_string()), "{:?}", names(&found));
    assert!(names(&median).contains(&"p50".to_string()), "{:?}", names(&median));
    let value = |found: &Certification, name: &str| statistic(found, "extreme", name, "all").value;
    // Differences 0.5, 1, -1 and -2: p75 is 0.625. Student's t(0.9, 3) = 1.637744; with the
    // standard deviation 1.3149778 of four, the end is -0.375 + 0.657489 * 1.637744.
    near(value(&found, "p75"), 0.625);
    let upper = value(&found, "upper confidence of mean").expect("an end");
    let deviation = deviation(&[0.5, 1.0, -1.0, -2.0], 1.0);
    assert!((upper - (-0.375 + deviation / 2.0 * 1.637_744_353_7)).abs() < 1e-7, "{upper}");
}

/// By hand: limits at 72 and 90 km/h between 60 and 100 km/h; the travel between two points.
#[test]
fn tables_run() {
    let found = run("tables.fp", &[]);
    let travelled = quantity(&found, "travelled").values.iter().find(|value| value.section == "S2");
    let (first, last) = (4.0 / 4.4 * 2.0, 8.0 + 0.2 / 25.0 * 50.0);
    near(travelled.expect("a value").measured, last - first);
    for (id, slow, fast) in [("difference", 3.2, 5.0), ("held", 3.0, 5.0)] {
        for value in &quantity(&found, id).values {
            let speed =
                SECTIONS.iter().find(|section| section.name == value.section).expect("one").speed;
            let limit = value.limit;
            near(limit, if speed < 80.0 { slow } else { fast });
        }
    }
    // A sample outside the points has no value, and the reason says where.
    let found = run("tables.fp", &[("first_force", "0.9 kN")]);
    let told = format!("{:?}", found.sections);
    assert!(told.contains("OutsideTable") && told.contains("row: Some"), "{told}");
}

/// Lines of equal slope have equal variances: the probability is 1, and what is left are the means.
/// A window `a <= x < a + 2 m` of 20 samples has its mean 0.95 m behind `a`.
#[test]
fn distributions_of_samples_windows_and_steps() {
    let (compiled, campaign, folder) = prepared("distributions.fp", &[]);
    // The simulation of S2 has twice as many samples.
    let mut record = "time [s],distance [m],Y_1R [kN],Y_1L [kN],Y_2R [kN],Y_2L [kN]\n".to_string();
    for sample in 0..=3600 {
        let (time, x) = (f64::from(sample) * 0.0025, f64::from(sample) * 0.05);
        let (r, l) = (5.0 + SLOPE * (x - START), -18.0 + SLOPE * (x - START));
        writeln!(record, "{time},{x},{r},{l},{r},{l}").expect("a string");
    }
    fs::write(folder.path().join("simulation/S2.csv"), record).expect("a file");
    let found = certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    let of = |id: &str, signal: &str| {
        values(&found, id)
            .iter()
            .find(|value| value.0 == "S2" && value.1 == signal)
            .expect("a value")
            .2
    };
    let agreement = |behind: f64| {
        let measured = 4.0 + SLOPE * behind;
        1.0 - 1.0 / (measured + 1.0)
    };
    // What the ends of a filtered record leave in the section is below 1e-6 of it.
    assert!((of("matching", "Y_1R") - agreement(60.0)).abs() < 1e-6);
    // With steps of 0.05 m the simulated windows have 40 samples, and their means lie 0.975 m
    // behind their starts.
    let (measured, simulated) = (4.0 + SLOPE * 59.95, 5.0 + SLOPE * 59.975);
    assert!(
        (of("matching_of_windows", "Y_1R") - (1.0 - (simulated - measured) / simulated)).abs()
            < 1e-6
    );
    assert!((of("area", "Y_2R") - 1.0).abs() < 1e-9);
    assert!((of("area_as_recorded", "Y_2R") - 1.0).abs() < 1e-3);
    assert_eq!(values(&found, "area_as_recorded").len(), 8);
}

/// Forward and backward a line stays where it is; the gain and its unit are in the value. A tone is
/// weighted by Wk.
#[test]
fn transfer_functions_run() {
    let (compiled, campaign, folder) = prepared("frequency_weighting.fp", &[]);
    for (kind, more) in [("measurement", 0.0), ("simulation", 1.0)] {
        for section in &SECTIONS {
            let mut record = "time [s],distance [m],az_I [m/s^2],az_II [m/s^2]\n".to_string();
            for sample in 0..=1800 {
                let (time, x) = (f64::from(sample) * 0.005, f64::from(sample) * 0.1);
                // Rising by 2 m/s^3; and a tone at 8 Hz, where Wk is 1.0363.
                let (line, tone) = (
                    1.0 + 0.5 * more + 2.0 * time,
                    (1.0 + more) * (std::f64::consts::TAU * 8.0 * time).sin(),
                );
                writeln!(record, "{time},{x},{line},{tone}").expect("a string");
            }
            fs::write(folder.path().join(kind).join(format!("{}.csv", section.name)), record)
                .expect("a file");
        }
    }
    let found = certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    let of = |id: &str, signal: &str| {
        quantity(&found, id)
            .values
            .iter()
            .find(|value| value.section == "S2" && value.signal == signal)
            .expect("a value")
            .clone()
    };
    let lagged = of("az_lagged", "az_I");
    assert_eq!(quantity(&found, "az_lagged").unit, "m/s");
    // Forward and backward there is no delay: in the middle of the section, at 90 m and 4.5 s.
    assert!((lagged.measured.expect("a value") - 2.0 * 10.0).abs() < 1e-6, "{lagged:?}");
    assert!((lagged.difference - 2.0 * 0.5).abs() < 1e-6);
    let weighted = of("az_weighted", "az_II");
    assert!(
        (weighted.measured.expect("a value") - 1.0363 / 2.0_f64.sqrt()).abs() < 2e-3,
        "{weighted:?}"
    );
    assert!(
        (weighted.simulated.expect("a value") - 2.0 * weighted.measured.expect("a value")).abs()
            < 1e-9
    );
    assert!(of("az_shape", "az_I").measured.is_some());
}

/// An offset d is added to the axis of the measurement: at a place x it has what it had at x - d.
/// On lines that rise by `SLOPE`, every measured value falls by `SLOPE` d, and the simulation
/// stays.
#[test]
fn an_offset_moves_the_measurement_forward_along_the_axis() {
    const OFFSETS: [f64; 4] = [-4.0, 0.0, 2.0, 10.0];
    let (compiled, campaign, _folder) = prepared("limits_by_zone.fp", &[]);
    let shifts = Shifts { offsets: &OFFSETS, farthest: None, correct: false };
    let found = evaluate(&compiled.plan, &compiled.graph, &campaign, &shifts, &|_| {})
        .unwrap_or_else(|problems| panic!("{}", problems.render(false)));
    assert_eq!(found.len(), OFFSETS.len());
    let judged: Vec<_> = found.iter().map(|found| found.judge(&compiled.plan)).collect();
    let mut compared = 0;
    for (judged, offset) in judged.iter().zip(OFFSETS) {
        let table =
            judged.quantities.iter().find(|quantity| quantity.id == "table").expect("there");
        for value in &table.values {
            let section = SECTIONS.iter().find(|section| section.name == value.section);
            let section = section.expect("a section");
            let (start, more) = if value.signal == "Y_1R" { section.right } else { section.left };
            // The median of a line is its value in the middle of the section.
            let middle = start + SLOPE * (END - START) / 2.0;
            near(value.measured, middle - SLOPE * offset);
            near(value.simulated, middle + more);
            near(Some(value.difference), more + SLOPE * offset);
            compared += 1;
        }
    }
    assert_eq!(compared, OFFSETS.len() * 2 * SECTIONS.len());
}
