//! Confidence of statistics of values that depend on each other within a site.

use fishplate::metrics::{
    cluster::*,
    interval::Interval,
    statistics::{Divisor, mean, standard_deviation, variance},
};
use serde_json::Value;

use crate::metrics::{close, json, number, numbers};

fn std(values: &[f64]) -> Option<f64> {
    standard_deviation(values, Divisor::Sample)
}

/// Confidence level usual in test reports.
const CONFIDENCE: f64 = 0.95;

/// The statistic of all values. Its standard error follows from leaving out one site at a time: the
/// square root of (G - 1)/G times the sum of squares about their mean, for G sites (Efron and
/// Tibshirani 1993, chapter 11). The lower bound of a standard deviation can be negative. The
/// closed forms are compared with it.
fn jackknife<T: Copy>(sites: &[Vec<T>], statistic: impl Fn(&[T]) -> Option<f64>) -> Estimate {
    let of = |left_out: Option<usize>| {
        let kept = sites.iter().enumerate().filter(|(site, _)| Some(*site) != left_out);
        let values: Vec<T> = kept.flat_map(|(_, values)| values.iter().copied()).collect();
        statistic(&values).expect("defined")
    };
    let without: Vec<f64> = (0..sites.len()).map(|site| of(Some(site))).collect();
    let degrees = sites.len() as f64 - 1.0;
    let variance = variance(&without, Divisor::Population).expect("several sites");
    Estimate { value: of(None), standard_error: (degrees * variance).sqrt(), degrees }
}

/// Digits of the differences of the vectors: 15, of the results: 12.
const DIGITS: f64 = 1e-9;

#[track_caller]
fn ends(interval: Interval, expected: &Value) {
    let expected = numbers(expected);
    close(interval.low, expected[0], DIGITS);
    close(interval.high, expected[1], DIGITS);
}

/// All that the vectors say of one way to the bounds.
#[track_caller]
fn bounds(of_mean: &impl Bounds, of_deviation: &impl Bounds, expected: &Value) {
    ends(of_mean.interval(CONFIDENCE).expect("an interval"), &expected["mean"]);
    ends(of_deviation.interval(CONFIDENCE).expect("an interval"), &expected["std"]);
    ends(of_mean.interval(0.90).expect("an interval"), &expected["mean_90"]);
    close(of_deviation.bound(0.95).expect("a bound"), number(&expected["std_upper_95"]), DIGITS);
}

/// NumPy and SciPy, `tests/cases/vectors/make_confidence.py`: three campaigns of 16 sites, one of 8
/// with repeats.
#[test]
fn bounds_of_campaigns() {
    for campaign in json("vectors/confidence.json").as_array().expect("a list") {
        assert_eq!(
            (number(&campaign["replicates"]), number(&campaign["seed"])),
            (REPLICATES as f64, SEED as f64)
        );
        let first = numbers(&campaign["first_draws"]);
        let draws = Draws::new(first.len(), REPLICATES, SEED).expect("draws");
        assert_eq!(
            draws
                .iter()
                .next()
                .expect("a draw")
                .iter()
                .map(|site| *site as f64)
                .collect::<Vec<_>>(),
            first
        );
        assert_eq!(draws.iter().count(), REPLICATES);
        for quantity in campaign["quantities"].as_array().expect("quantities") {
            let site: Vec<usize> =
                numbers(&quantity["site"]).iter().map(|site| *site as usize).collect();
            let sites = by_site(&numbers(&quantity["difference"]), &site).expect("sites");
            assert_eq!(sites.len() as f64, number(&quantity["sites"]));
            let all = sites.concat();
            close(mean(&all).expect("defined"), number(&quantity["mean"]), DIGITS);
            close(std(&all).expect("defined"), number(&quantity["std"]), DIGITS);

            let drawn = |statistic: fn(&[f64]) -> Option<f64>| {
                bootstrap(&sites, &draws, statistic).expect("replicates")
            };
            bounds(&drawn(mean), &drawn(std), &quantity["bootstrap"]);

            let without = |statistic: fn(&[f64]) -> Option<f64>| jackknife(&sites, statistic);
            let expected = &quantity["jackknife"];
            close(without(mean).standard_error, number(&expected["se_mean"]), DIGITS);
            close(without(std).standard_error, number(&expected["se_std"]), DIGITS);
            bounds(&without(mean), &without(std), expected);

            let (of_mean, of_deviation) = (
                Mean::of(&sites).expect("a mean"),
                StandardDeviation::of(&sites).expect("a deviation"),
            );
            let expected = &quantity["closed_form"];
            close(of_mean.estimate.standard_error, number(&expected["se_mean"]), DIGITS);
            close(of_mean.effective_values, number(&quantity["n_eff"]), DIGITS);
            close(of_mean.design_effect, number(&quantity["design_effect"]), DIGITS);
            close(of_deviation.degrees.expect("finite"), number(&quantity["nu"]), DIGITS);
            bounds(&of_mean, &of_deviation, expected);
        }
    }
}

/// With one value per site the closed form of the mean and its jackknife are the usual s / sqrt(n).
#[test]
fn one_value_per_site() {
    let values = [3.0, -1.0, 4.0, 1.5, 9.0, 2.0];
    let sites: Vec<Vec<f64>> = values.iter().map(|value| vec![*value]).collect();
    let of_mean = Mean::of(&sites).expect("a mean");
    let usual = std(&values).expect("defined") / 6.0_f64.sqrt();
    close(of_mean.estimate.standard_error, usual, 1e-14);
    close(of_mean.design_effect, 1.0, 1e-14);
    close(jackknife(&sites, mean).standard_error, usual, 1e-14);
}

/// Any statistic, of any kind of member: the slope over drawn points.
#[test]
fn members_may_be_points() {
    let sites: Vec<Vec<(f64, f64)>> =
        (0..5).map(|k| vec![(f64::from(k), 2.0 * f64::from(k)); 3]).collect();
    let slope = |points: &[(f64, f64)]| {
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        Some(fishplate::metrics::statistics::regression(&x, &y).map_or(2.0, |line| line.slope))
    };
    let drawn =
        bootstrap(&sites, &Draws::new(5, 50, SEED).expect("draws"), slope).expect("replicates");
    assert!(drawn.values().iter().all(|slope| (slope - 2.0).abs() < 1e-12));
    assert!(jackknife(&sites, slope).standard_error < 1e-12);
}

/// Equal values say all there is: every interval is a point, every value counts.
#[test]
fn of_equal_values_every_interval_is_a_point() {
    for level in [0.0, 0.1] {
        let sites = vec![vec![level; 3], vec![level; 2], vec![level]];
        let draws = Draws::new(3, REPLICATES, SEED).expect("draws");
        let (of_mean, of_deviation) = (
            Mean::of(&sites).expect("a mean"),
            StandardDeviation::of(&sites).expect("a deviation"),
        );
        assert_eq!(
            (of_mean.effective_values, of_mean.design_effect, of_deviation.degrees),
            (6.0, 1.0, None)
        );
        let point = |bounds: &dyn Bounds, at: f64| {
            let Interval { low, high } = bounds.interval(CONFIDENCE).expect("an interval");
            assert!((low - at).abs() < 1e-15 && (high - at).abs() < 1e-15, "{low} to {high}");
        };
        point(&of_mean, level);
        point(&of_deviation, 0.0);
        point(&jackknife(&sites, mean), level);
        point(&jackknife(&sites, std), 0.0);
        point(&bootstrap(&sites, &draws, mean).expect("replicates"), level);
        point(&bootstrap(&sites, &draws, std).expect("replicates"), 0.0);
    }
    // Sites whose squares sum up alike: nothing is known of their scatter.
    let alike = StandardDeviation::of(&[vec![1.0, -1.0], vec![-1.0, 1.0]]).expect("a deviation");
    assert_eq!((alike.degrees, alike.bound(0.95)), (None, Ok(alike.value)));
}

#[test]
fn what_has_no_bound_is_told() {
    let sites = [vec![1.0, 2.0], vec![4.0]];
    let draws = |sites| Draws::new(sites, 10, SEED).expect("draws");
    let one = by_site(&[1.0, 2.0], &[7, 7]).expect_err("one site");
    assert_eq!(one.to_string(), "there is 1 site; at least 2 are needed");
    assert_eq!(
        by_site::<f64>(&[], &[]).expect_err("none").to_string(),
        "there is no site; at least 2 are needed"
    );
    assert_eq!(
        by_site(&[1.0], &[]).expect_err("lengths").to_string(),
        "there are 1 values but 0 site numbers"
    );
    assert_eq!(Draws::new(1, 10, SEED).expect_err("one site"), ClusterError::TooFew { sites: 1 });
    assert_eq!(Draws::new(2, 0, SEED).expect_err("none"), ClusterError::NoDraw);
    assert_eq!(Mean::of(&sites[..1]), Err(ClusterError::TooFew { sites: 1 }));
    assert_eq!(StandardDeviation::of(&[]), Err(ClusterError::TooFew { sites: 0 }));
    assert_eq!(
        bootstrap(&sites, &draws(3), mean),
        Err(ClusterError::OtherSites { sites: 2, draws: 3 })
    );
    let never = bootstrap(&sites, &draws(2), |_: &[f64]| None).expect_err("undefined");
    assert_eq!(never.to_string(), "the statistic is not defined for draw 1 of the sites");
    assert_eq!(Mean::of(&[vec![1.0], vec![f64::NAN]]), Err(ClusterError::OutOfRange));
    let of_mean = Mean::of(&sites).expect("a mean");
    for probability in [0.0, 1.0, -1.0, f64::NAN] {
        assert!(
            matches!(of_mean.bound(probability), Err(ClusterError::Probability { .. })),
            "{probability}"
        );
        assert!(matches!(
            StandardDeviation::of(&sites).expect("a deviation").bound(probability),
            Err(ClusterError::Probability { .. })
        ));
    }
}

/// Shares of 95 % intervals that hold the true value, as `docs/definitions.md` states them: 12
/// sites of 6 normal values with standard deviation 1, correlated within a site. Takes half a
/// minute: `cargo test --test evaluation -- --ignored --nocapture coverage`.
#[test]
#[ignore = "half a minute"]
fn coverage() {
    const SITES: usize = 12;
    const TRIALS: usize = 4000;
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut normal = move || {
        (-2.0 * (1.0 - random.f64()).ln()).sqrt() * (std::f64::consts::TAU * random.f64()).cos()
    };
    let draws = Draws::new(SITES, REPLICATES, SEED).expect("draws");
    let site: Vec<usize> = (0..SITES * 6).map(|at| at / 6).collect();
    // Of the mean: closed form, bootstrap. Of the standard deviation: printed, closed form,
    // jackknife, bootstrap.
    let stated = [
        (0.0, [0.95, 0.91, 1.00, 0.92, 0.95, 0.90]),
        (0.3, [0.95, 0.91, 1.00, 0.89, 0.92, 0.84]),
        (0.8, [0.95, 0.91, 0.99, 0.86, 0.89, 0.76]),
    ];
    for (correlation, stated) in stated {
        let mut held = [0_usize; 6];
        for _ in 0..TRIALS {
            let sites: Vec<Vec<f64>> = (0..SITES)
                .map(|_| {
                    let common = f64::sqrt(correlation) * normal();
                    (0..6).map(|_| common + f64::sqrt(1.0 - correlation) * normal()).collect()
                })
                .collect();
            let of = |bounds: &dyn Bounds| bounds.interval(CONFIDENCE).expect("an interval");
            let drawn = |statistic: fn(&[f64]) -> Option<f64>| {
                bootstrap(&sites, &draws, statistic).expect("replicates")
            };
            let found = [
                (of(&Mean::of(&sites).expect("a mean")), 0.0),
                (of(&drawn(mean)), 0.0),
                (
                    standard_deviation_interval(&sites.concat(), &site, CONFIDENCE)
                        .expect("an interval"),
                    1.0,
                ),
                (of(&StandardDeviation::of(&sites).expect("a deviation")), 1.0),
                (of(&jackknife(&sites, std)), 1.0),
                (of(&drawn(std)), 1.0),
            ];
            for (held, (Interval { low, high }, truth)) in held.iter_mut().zip(found) {
                *held += usize::from(low <= truth && truth <= high);
            }
        }
        let shares = held.map(|held| held as f64 / TRIALS as f64);
        eprintln!("correlation {correlation}: {shares:.3?}");
        for (share, stated) in shares.iter().zip(stated) {
            assert!((share - stated).abs() < 0.02, "{correlation}: {share}, stated {stated}");
        }
    }
}
