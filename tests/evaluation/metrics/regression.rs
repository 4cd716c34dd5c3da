//! Least squares: the data sets that NIST certifies, closed forms, and the samples of assessments
//! (`tests/cases/vectors`).

use fishplate::metrics::{
    regression::{Kind, Regression, RegressionError, Side, Tails},
    statistics,
    student::student_quantile,
};

use crate::metrics::{close, json, number, numbers};

fn columns(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    (0..rows[0].len()).map(|of| rows.iter().map(|row| row[of]).collect()).collect()
}

/// NIST StRD, linear regression, "Norris": y, x. Certified values; solving the normal equations in
/// exact fractions (Python's `fractions`) gives the same 15 digits.
#[test]
fn norris_is_as_certified() {
    #[rustfmt::skip]
    const DATA: [[f64; 2]; 36] = [
        [0.1, 0.2], [338.8, 337.4], [118.1, 118.2], [888.0, 884.6], [9.2, 10.1], [228.1, 226.5], [668.5, 666.3], [998.5, 996.3],
        [449.1, 448.6], [778.9, 777.0], [559.2, 558.2], [0.3, 0.4], [0.1, 0.6], [778.1, 775.5], [668.8, 666.9], [339.3, 338.0],
        [448.9, 447.5], [10.8, 11.6], [557.7, 556.0], [228.3, 228.1], [998.0, 995.8], [888.8, 887.6], [119.6, 120.2], [0.3, 0.3],
        [0.6, 0.3], [557.6, 556.8], [339.3, 339.1], [888.0, 887.2], [998.5, 999.0], [778.9, 779.0], [10.2, 11.1], [117.6, 118.3],
        [228.9, 229.2], [668.4, 669.1], [449.2, 448.9], [0.2, 0.5],
    ];
    let (y, x): (Vec<f64>, Vec<f64>) = DATA.iter().map(|[y, x]| (*y, *x)).unzip();
    let fit = Regression::fit(&y, std::slice::from_ref(&x)).expect("a fit");
    close(fit.coefficients()[0], -0.262_323_073_774_029, 1e-12);
    close(fit.coefficients()[1], 1.002_116_818_020_45, 1e-13);
    close(fit.residual_standard_deviation(), 0.884_796_396_144_373, 1e-12);
    assert_eq!(fit.degrees_of_freedom(), 34);
    // At x = 0 the fit is the intercept, and its standard error is certified.
    close(fit.at(&[0.0]).expect("a value"), -0.262_323_073_774_029, 1e-12);
    close(
        fit.residual_standard_deviation() * fit.leverage(&[0.0]).expect("a value").sqrt(),
        0.232_818_234_301_152,
        1e-12,
    );
    // Closed form of the simple regression.
    let (mean, deviation) =
        (statistics::mean(&x).expect("values"), |at: f64, mean: f64| (at - mean) * (at - mean));
    let squares: f64 = x.iter().map(|x| deviation(*x, mean)).sum();
    for at in [-50.0, 0.0, mean, 1234.5] {
        close(
            fit.leverage(&[at]).expect("a value"),
            1.0 / 36.0 + deviation(at, mean) / squares,
            1e-13,
        );
    }
    let line = statistics::regression(&x, &y).expect("a line");
    close(fit.coefficients()[1], line.slope, 1e-13);
}

/// NIST StRD, "Longley": total employment by deflator, GNP, unemployed, armed forces, population,
/// year; highly collinear. Certified values; fit and leverage at the point by exact fractions,
/// bounds with `scipy.stats.t.ppf(0.975, 9)` and `(0.99, 9)`.
#[test]
fn longley_is_as_certified() {
    let rows: Vec<Vec<f64>> = [
        [60323.0, 83.0, 234_289.0, 2356.0, 1590.0, 107_608.0, 1947.0],
        [61122.0, 88.5, 259_426.0, 2325.0, 1456.0, 108_632.0, 1948.0],
        [60171.0, 88.2, 258_054.0, 3682.0, 1616.0, 109_773.0, 1949.0],
        [61187.0, 89.5, 284_599.0, 3351.0, 1650.0, 110_929.0, 1950.0],
        [63221.0, 96.2, 328_975.0, 2099.0, 3099.0, 112_075.0, 1951.0],
        [63639.0, 98.1, 346_999.0, 1932.0, 3594.0, 113_270.0, 1952.0],
        [64989.0, 99.0, 365_385.0, 1870.0, 3547.0, 115_094.0, 1953.0],
        [63761.0, 100.0, 363_112.0, 3578.0, 3350.0, 116_219.0, 1954.0],
        [66019.0, 101.2, 397_469.0, 2904.0, 3048.0, 117_388.0, 1955.0],
        [67857.0, 104.6, 419_180.0, 2822.0, 2857.0, 118_734.0, 1956.0],
        [68169.0, 108.4, 442_769.0, 2936.0, 2798.0, 120_445.0, 1957.0],
        [66513.0, 110.8, 444_546.0, 4681.0, 2637.0, 121_950.0, 1958.0],
        [68655.0, 112.6, 482_704.0, 3813.0, 2552.0, 123_366.0, 1959.0],
        [69564.0, 114.2, 502_601.0, 3931.0, 2514.0, 125_368.0, 1960.0],
        [69331.0, 115.7, 518_173.0, 4806.0, 2572.0, 127_852.0, 1961.0],
        [70551.0, 116.9, 554_894.0, 4007.0, 2827.0, 130_081.0, 1962.0],
    ]
    .map(Vec::from)
    .to_vec();
    let mut regressors = columns(&rows);
    let values = regressors.remove(0);
    let fit = Regression::fit(&values, &regressors).expect("a fit");
    let certified = [
        -3_482_258.634_595_82,
        15.061_872_271_373_3,
        -0.035_819_179_292_591,
        -2.020_229_803_816_83,
        -1.033_226_867_173_59,
        -0.051_104_105_653_580_7,
        1_829.151_464_613_55,
    ];
    for (found, certified) in fit.coefficients().iter().zip(certified) {
        close(*found, certified, 1e-10);
    }
    close(fit.residual_standard_deviation(), 304.854_073_561_965, 1e-11);
    assert_eq!(fit.degrees_of_freedom(), 9);
    let point = [117.0, 560_000.0, 4000.0, 2900.0, 131_000.0, 1963.0];
    close(fit.at(&point).expect("a value"), 72_297.274_121_793_86, 1e-12);
    close(fit.leverage(&point).expect("a value"), 2.172_411_036_468_708, 1e-11);
    close(
        fit.bound(&point, Kind::Prediction, Side::Upper, Tails::Two, 0.95).expect("a bound"),
        73_525.588_407_188_61,
        1e-12,
    );
    close(
        fit.bound(&point, Kind::Mean, Side::Lower, Tails::One, 0.99).expect("a bound"),
        71_029.524_462_405_36,
        1e-12,
    );
}

/// NumPy and SciPy, `tests/cases/vectors/make_assessment.py`: two-dimensional and multiple
/// estimates of assessments.
#[test]
fn estimates_of_assessments() {
    let (mut estimates, mut refused) = (0, 0);
    for campaign in json("vectors/assessment.json").as_array().expect("a list") {
        let points: Vec<Vec<f64>> =
            campaign["points"].as_array().expect("points").iter().map(numbers).collect();
        for sample in campaign["samples"].as_array().expect("samples") {
            // The two-dimensional one is over the cant deficiency alone, and asks for it where the
            // others do.
            let two = numbers(&sample["multiple_zone"]["target"]);
            for (method, all) in
                [("two_dimensional", false), ("multiple_zone", true), ("multiple_zones_2_4", true)]
            {
                let expected = &sample[method];
                if expected.is_null() {
                    continue;
                }
                let of = format!("{} {} {method}", campaign["campaign"], sample["of"]);
                let sections = numbers(&expected["section"]);
                let rows: Vec<Vec<f64>> = sections
                    .iter()
                    .map(|&section| &points[section as usize])
                    .map(|point| if all { point.clone() } else { vec![point[1]] })
                    .collect();
                let target = if all { numbers(&expected["target"]) } else { vec![two[1]] };
                let fit = Regression::fit(&numbers(&expected["y"]), &columns(&rows));
                let Some(value) = expected["value"].as_f64() else {
                    let reason = fit.expect_err(&of).to_string();
                    let theirs = expected["reason"].as_str().expect("a reason");
                    if theirs.contains("needed") {
                        assert_eq!(reason, theirs, "{of}");
                    } else {
                        assert!(
                            reason.contains("does not vary") || reason.contains("collinear"),
                            "{of}: {reason}"
                        );
                    }
                    refused += 1;
                    continue;
                };
                let fit = fit.expect(&of);
                for (found, theirs) in
                    fit.coefficients().iter().zip(numbers(&expected["coefficients"]))
                {
                    // A coefficient beside the largest part that any makes of a value: the values
                    // have 12 digits.
                    assert!(
                        (found - theirs).abs() <= 1e-9 * theirs.abs().max(1e-3),
                        "{of}: {found}, not {theirs}"
                    );
                }
                // Where the fit is nearly exact, what is left of the 12 digits of the values is
                // rounding.
                let (left, theirs) = (fit.residual_standard_deviation(), number(&expected["s_e"]));
                let largest = statistics::peak_magnitude(&numbers(&expected["y"])).expect("values");
                assert!(
                    (left - theirs).abs() <= 1e-9 * theirs + 1e-12 * largest,
                    "{of}: {left}, not {theirs}"
                );
                assert_eq!(fit.degrees_of_freedom() as f64, number(&expected["dof"]));
                close(fit.leverage(&target).expect(&of), number(&expected["leverage"]), 1e-9);
                close(fit.at(&target).expect(&of), number(&expected["fit"]), 1e-9);
                let confidence = match sample["class"].as_str() {
                    Some("safety") => 0.99,
                    Some("quasi_static" | "quasi-static") => {
                        close(fit.at(&target).expect(&of), value, 1e-9);
                        estimates += 1;
                        continue;
                    }
                    _ => 0.95,
                };
                let t = student_quantile(0.5 + confidence / 2.0, fit.degrees_of_freedom() as f64)
                    .expect("a quantile");
                close(t, number(&expected["t"]), 1e-11);
                let bound = fit
                    .bound(&target, Kind::Prediction, Side::Upper, Tails::Two, confidence)
                    .expect(&of);
                close(bound, value, 1e-9);
                estimates += 1;
            }
        }
    }
    assert!(estimates > 100 && refused > 20, "{estimates} estimates, {refused} refused");
}

/// Without regressors it is the mean of a sample: mean + t s sqrt(1 + 1/n), and mean + t s /
/// sqrt(n).
#[test]
fn without_regressors_it_is_the_mean() {
    let fit = Regression::fit(&[1.0, 2.0, 3.0, 4.0, 10.0], &[]).expect("a fit");
    // scipy.stats.t.ppf(0.95, 4); s = sqrt(12.5).
    let t = 2.131_846_786_326_649;
    assert_eq!((fit.coefficients(), fit.degrees_of_freedom()), (vec![4.0], 4));
    let bound = |kind, side| fit.bound(&[], kind, side, Tails::One, 0.95).expect("a bound");
    close(bound(Kind::Prediction, Side::Upper), 4.0 + t * 12.5_f64.sqrt() * 1.2_f64.sqrt(), 1e-13);
    close(bound(Kind::Mean, Side::Lower), 4.0 - t * 2.5_f64.sqrt(), 1e-13);
    // Below one half the bound lies on the other side of the fit.
    let low = fit.bound(&[], Kind::Mean, Side::Upper, Tails::One, 0.05).expect("a bound");
    close(low, bound(Kind::Mean, Side::Lower), 1e-12);
}

/// A plane met exactly, far from the origin and in units of very different size: nothing is left,
/// and no bound beyond the fit.
#[test]
fn a_plane_is_found_again() {
    let x: Vec<f64> = (0..12).map(|k| 1e6 + f64::from(k * k % 7)).collect();
    let z: Vec<f64> = (0..12).map(|k| 1e-6 * f64::from(k)).collect();
    let values: Vec<f64> = x.iter().zip(&z).map(|(x, z)| 3.0 + 2.0 * (x - 1e6) - 5e6 * z).collect();
    let fit = Regression::fit(&values, &[x, z]).expect("a fit");
    close(fit.coefficients()[1], 2.0, 1e-10);
    close(fit.coefficients()[2], -5e6, 1e-10);
    assert!(fit.residual_standard_deviation() < 1e-8);
    let equal = Regression::fit(&[0.1; 5], &[vec![1.0, 2.0, 3.0, 4.0, 6.0]]).expect("a fit");
    assert_eq!(
        (equal.residual_standard_deviation(), equal.at(&[100.0])),
        (0.0, Ok(equal.coefficients()[0]))
    );
}

#[test]
fn what_cannot_be_fitted_is_told() {
    let x = vec![1.0, 2.0, 3.0, 4.0];
    let twice: Vec<f64> = x.iter().map(|x| 2.0 * x + 1.0).collect();
    let y = [1.0, 3.0, 2.0, 5.0];
    let says = |values: &[f64], regressors: &[Vec<f64>]| {
        Regression::fit(values, regressors).expect_err("refused").to_string()
    };
    assert_eq!(says(&y[..2], &[vec![1.0, 2.0]]), "2 values for 2 coefficients: at least 3 needed");
    assert_eq!(says(&[], &[]), "0 values for 1 coefficient: at least 2 needed");
    assert_eq!(says(&y, &[x.clone(), vec![1.0]]), "regressor 2 has 1 number for 4 values");
    assert_eq!(says(&y, &[vec![0.3; 4]]), "regressor 1 does not vary");
    assert_eq!(
        says(&y, &[x.clone(), twice]),
        "the regressors are collinear: one of them depends linearly on the others"
    );
    // A hair's breadth of a column beside its size.
    let nearly: Vec<f64> = x.iter().map(|x| 1.0 + 1e-14 * x).collect();
    assert_eq!(Regression::fit(&y, &[nearly]).expect_err("refused"), RegressionError::Collinear);
    assert_eq!(says(&[1.0, f64::NAN, 2.0, 1.0], std::slice::from_ref(&x)), "value 2 is not finite");
    assert_eq!(
        says(&y, &[vec![1.0, 2.0, f64::INFINITY, 3.0]]),
        "number 3 of regressor 1 is not finite"
    );
    assert_eq!(
        says(&[1e300, -1e300, 1e300, 3.0], std::slice::from_ref(&x)),
        "the sum of the squares overflows"
    );
    let fit = Regression::fit(&y, &[x]).expect("a fit");
    assert_eq!(
        fit.at(&[]).expect_err("refused").to_string(),
        "the point has 0 numbers for 1 regressor"
    );
    assert_eq!(
        fit.leverage(&[f64::NAN]).expect_err("refused").to_string(),
        "number 1 of the point is not finite"
    );
    for confidence in [0.0, 1.0, -0.5, f64::NAN] {
        let bound = fit.bound(&[1.0], Kind::Mean, Side::Upper, Tails::Two, confidence);
        assert!(matches!(bound, Err(RegressionError::Confidence { .. })), "{confidence}");
    }
}

/// Closed forms for one and two degrees of freedom, `scipy.stats.t.ppf` for others.
#[test]
fn quantiles_of_student() {
    for p in [1e-9_f64, 0.003, 0.2, 0.4, 0.6, 0.95, 0.995] {
        let one = -1.0 / (std::f64::consts::PI * p).tan();
        close(student_quantile(p, 1.0).expect("a quantile"), one, 1e-12);
        let two = (2.0 * p - 1.0) / (2.0 * p * (1.0 - p)).sqrt();
        close(student_quantile(p, 2.0).expect("a quantile"), two, 1e-12);
    }
    let scipy = [
        (1e-12, 2.5, -55_306.174_076_515_82),
        (1e-12, 9.0, -51.414_916_023_282_23),
        (0.005, 2.5, -7.163_728_138_948_786),
        (0.2, 9.0, -0.883_403_859_685_534_1),
        (0.2, 1e5, -0.841_624_827_996_900_6),
        (0.5, 9.0, 0.0),
        (0.9, 2.5, 1.730_250_928_807_176_6),
        (0.995, 1e5, 2.575_878_469_908_375),
    ];
    for (p, degrees, expected) in scipy {
        close(student_quantile(p, degrees).expect("a quantile"), expected, 1e-10);
    }
    for (p, degrees) in [
        (0.0, 3.0),
        (1.0, 3.0),
        (f64::NAN, 3.0),
        (0.9, 0.0),
        (0.9, -1.0),
        (0.9, f64::INFINITY),
        (0.9, f64::NAN),
    ] {
        assert_eq!(student_quantile(p, degrees), None, "{p} {degrees}");
    }
}
