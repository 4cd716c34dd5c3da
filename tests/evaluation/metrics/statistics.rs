use fishplate::metrics::{
    cluster::{mean_interval, standard_deviation_interval},
    interval::wilson,
    statistics::*,
};

use crate::metrics::{close, json, number, numbers, record};

/// Confidence level usual in test reports.
const CONFIDENCE: f64 = 0.95;

/// Squares beyond the largest double: there is no deviation, rather than none.
#[test]
fn a_deviation_that_overflows_is_not_defined() {
    for values in [[1e200, 0.0, 1.0], [1e155, -1e155, 1.0], [1e308, -1e308, 1e308]] {
        assert_eq!(standard_deviation(&values, Divisor::Sample), None, "{values:?}");
    }
    close(
        standard_deviation(&[1e150, 2e150, 3e150], Divisor::Sample).expect("defined"),
        1e150,
        1e-15,
    );
}

/// scipy.stats t and chi2, 2 to 100001 values.
#[test]
fn intervals_agree_with_scipy() {
    let expected = json("scipy/statistics.json");
    for case in expected["intervals"].as_array().expect("a list") {
        let values = record(number(&case["n"]) as i64, 3.0);
        close(mean(&values).expect("defined"), number(&case["mean"]), 1e-14);
        close(
            standard_deviation(&values, Divisor::Sample).expect("defined"),
            number(&case["std"]),
            1e-13,
        );
        let each: Vec<usize> = (0..values.len()).collect();
        let of_mean = mean_interval(&values, &each, CONFIDENCE).expect("defined");
        let of_deviation =
            standard_deviation_interval(&values, &each, CONFIDENCE).expect("defined");
        for (interval, key) in [(of_mean, "mean_interval"), (of_deviation, "std_interval")] {
            let ends = numbers(&case[key]);
            close(interval.low, ends[0], 1e-9);
            close(interval.high, ends[1], 1e-9);
        }
    }
}

/// NumPy and SciPy, `tests/cases/sites/make.py`: differences of eight sites, four of them measured
/// twice, several signals each.
#[test]
fn intervals_of_sites_agree_with_numpy() {
    for case in json("sites/intervals.json").as_array().expect("a list") {
        let (values, site) = (numbers(&case["difference"]), numbers(&case["site"]));
        let site: Vec<usize> = site.iter().map(|site| *site as usize).collect();
        let of_mean = mean_interval(&values, &site, CONFIDENCE).expect("defined");
        let of_deviation =
            standard_deviation_interval(&values, &site, CONFIDENCE).expect("defined");
        for (interval, key) in [(of_mean, "mean_interval"), (of_deviation, "std_interval")] {
            let ends = numbers(&case[key]);
            close(interval.low, ends[0], 1e-9);
            close(interval.high, ends[1], 1e-9);
        }
    }
}

/// A site measured again and again says no more of the others: the interval of the mean stays, but
/// for rounding.
#[test]
fn repeats_do_not_narrow_an_interval() {
    let (values, site) = ([1.0, 2.0, 4.0, 4.5], [0, 1, 2, 3]);
    let (twice, of_twice) = ([values, values].concat(), [site, site].concat());
    let (once, again) =
        (mean_interval(&values, &site, CONFIDENCE), mean_interval(&twice, &of_twice, CONFIDENCE));
    let (once, again) = (once.expect("defined"), again.expect("defined"));
    close(again.low, once.low, 1e-14);
    close(again.high, once.high, 1e-14);
    let as_if_apart: Vec<usize> = (0..8).collect();
    let apart = mean_interval(&twice, &as_if_apart, CONFIDENCE).expect("defined");
    assert!(apart.high - apart.low < 0.7 * (once.high - once.low));
}

/// scipy.stats.linregress.
#[test]
fn regression_agrees_with_scipy() {
    let expected = &json("scipy/statistics.json")["regression"];
    let (x, y) = (record(50, 1.0), record(90, -2.0)[40..].to_vec());
    let line = regression(&x, &y).expect("defined");
    close(line.slope, number(&expected["slope"]), 1e-12);
    close(line.intercept, number(&expected["intercept"]), 1e-12);
    close(correlation(&x, &y).expect("defined"), number(&expected["correlation"]), 1e-12);
}

/// Closed forms.
#[test]
fn of_a_few_values() {
    let values = [3.0, -7.0, 1.0, 4.0, -1.0];
    assert_eq!(mean(&values), Some(0.0));
    assert_eq!(median(&values), Some(1.0));
    assert_eq!(median(&values[..4]), Some(2.0));
    assert_eq!(minimum(&values), Some(-7.0));
    assert_eq!(maximum(&values), Some(4.0));
    assert_eq!(peak_magnitude(&values), Some(7.0));
    assert_eq!(range(&values), Some(11.0));
    close(rms(&values).expect("defined"), 15.2_f64.sqrt(), 1e-15);
    close(variance(&values, Divisor::Sample).expect("defined"), 19.0, 1e-15);
    close(variance(&values, Divisor::Population).expect("defined"), 15.2, 1e-15);
    let line = regression(&[0.0, 1.0, 2.0], &[5.0, 3.0, 1.0]).expect("defined");
    assert_eq!(line, Line { slope: -2.0, intercept: 5.0 });
    close(correlation(&[0.0, 1.0, 2.0], &[5.0, 3.0, 1.0]).expect("defined"), -1.0, 1e-15);
}

/// Shifting by a large number shifts the mean and leaves the scatter.
#[test]
fn a_large_offset_costs_no_digits() {
    let values: Vec<f64> = (0..10_000).map(|k| 1e9 + f64::from(k % 2)).collect();
    close(standard_deviation(&values, Divisor::Population).expect("defined"), 0.5, 1e-12);
    assert_eq!(mean(&values), Some(1e9 + 0.5));
}

#[test]
fn none_where_not_defined() {
    assert_eq!(mean(&[]), None);
    assert_eq!(rms(&[]), None);
    assert_eq!(median(&[]), None);
    assert_eq!(minimum(&[]), None);
    assert_eq!(standard_deviation(&[1.0], Divisor::Sample), None);
    assert_eq!(standard_deviation(&[1.0], Divisor::Population), Some(0.0));
    assert_eq!(standard_deviation(&[0.1; 10], Divisor::Sample), Some(0.0));
    assert_eq!(regression(&[0.1; 3], &[1.0, 2.0, 3.0]), None);
    assert_eq!(correlation(&[1.0, 2.0, 3.0], &[0.1; 3]), None);
    assert_eq!(correlation(&[1.0, 2.0, 3.0], &[0.1; 2]), None);
    assert_eq!(mean_interval(&[1.0], &[0], CONFIDENCE), None);
    assert_eq!(mean_interval(&[1.0, 2.0], &[0, 1], 1.0), None);
    assert_eq!(mean_interval(&[1.0, 2.0], &[0, 0], CONFIDENCE), None, "one site");
    assert_eq!(mean_interval(&[1.0, 2.0], &[0], CONFIDENCE), None);
    assert_eq!(standard_deviation_interval(&[1.0, 2.0], &[3, 3], CONFIDENCE), None, "one site");
    assert_eq!(standard_deviation_interval(&[1.0, 2.0], &[0, 1], f64::NAN), None);
    for broken in [[1.0, f64::NAN], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
        for statistic in [mean, rms, median, minimum, maximum, peak_magnitude, range] {
            assert_eq!(statistic(&broken), None);
        }
        assert_eq!(standard_deviation(&broken, Divisor::Sample), None);
        assert_eq!(correlation(&broken, &[1.0, 2.0]), None);
    }
}

/// Wilson 1927; Newcombe 1998 (Statistics in Medicine 17:857), table I, method 3.
#[test]
fn wilson_intervals_as_published() {
    for (good, all, low, high) in [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ] {
        let found = wilson(good, all);
        // Four decimals are printed.
        assert!(
            (found.0 - low).abs() < 5e-5 && (found.1 - high).abs() < 5e-5,
            "{good} of {all}: {found:?}"
        );
        let other = wilson(all - good, all);
        close(other.0, 1.0 - found.1, 1e-12);
        close(other.1, 1.0 - found.0, 1e-12);
    }
    // The ends themselves, without rounding.
    assert_eq!((wilson(0, 10).0, wilson(10, 10).1, wilson(0, 0)), (0.0, 1.0, (0.0, 1.0)));
}
