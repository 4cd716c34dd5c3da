use proptest::prelude::*;

use fishplate::metrics::percentile::{Method, PercentileError, percentile, percentiles};

use crate::metrics::{json, number, numbers, record};

/// numpy.percentile, every method, to the last digits.
#[test]
fn agrees_with_numpy() {
    let cases = json("scipy/percentiles.json");
    for case in cases.as_array().expect("a list") {
        let values = record(number(&case["n"]) as i64, 0.0);
        let method = Method::from_name(case["method"].as_str().expect("a name")).expect("a method");
        let percents = numbers(&case["percents"]);
        let expected = numbers(&case["values"]);
        let together = percentiles(&values, &percents, method).expect("values");
        for ((percent, expected), together) in percents.into_iter().zip(expected).zip(together) {
            let single = percentile(&values, percent, method).expect("values");
            assert_eq!(single.to_bits(), together.to_bits(), "{method:?} {percent}");
            assert!(
                (single - expected).abs() < 1e-15,
                "{method:?} of {} at {percent} %: {single}, not {expected}",
                values.len()
            );
        }
    }
}

/// Ten powers of two: NumPy, of which many values can be done by hand.
#[test]
fn small_sample() {
    let expected = &json("vectors/expected.json")["percentiles_small"];
    let (values, percents) = (numbers(&expected["x"]), numbers(&expected["q"]));
    for (method, _) in Method::NAMES {
        if let Some(theirs) = expected.get(method.name()) {
            for (ours, theirs) in percentiles(&values, &percents, method)
                .expect("values")
                .into_iter()
                .zip(numbers(theirs))
            {
                assert!(
                    (ours - theirs).abs() <= 1e-12 * theirs,
                    "{method:?}: {ours}, not {theirs}"
                );
            }
        }
    }
}

#[test]
fn names_lead_back() {
    for (method, _) in Method::NAMES {
        assert_eq!(Method::from_name(method.name()), Some(method));
    }
    assert_eq!(Method::from_name("type 7"), None);
}

#[test]
fn refuses_rather_than_guesses() {
    assert_eq!(percentile(&[], 50.0, Method::Linear), Err(PercentileError::Empty));
    assert_eq!(
        percentile(&[1.0, f64::NAN], 50.0, Method::Linear),
        Err(PercentileError::NotFinite { index: 1 })
    );
    assert_eq!(
        percentile(&[1.0], 100.1, Method::Linear),
        Err(PercentileError::Percent { percent: 100.1 })
    );
    assert!(percentiles(&[1.0], &[f64::NAN], Method::Linear).is_err());
    assert_eq!(percentiles(&[1.0], &[], Method::Linear), Ok(vec![]));
}

proptest! {
    /// Definition: an order statistic is the value at its place in the sorted record, near an end,
    /// inside, and among equal values.
    #[test]
    fn order_statistics(values in prop::collection::vec(prop_oneof![-1e3..1e3, Just(1.0), Just(0.0)], 1..700), percent in 0.0..=100.0, edge in 0.0..=1.0) {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let last = (values.len() - 1) as f64;
        for percent in [percent, edge, 100.0 - edge, 0.0, 100.0] {
            let place = last * (percent / 100.0);
            let expected = [(Method::Lower, place.floor()), (Method::Higher, place.ceil())];
            for (method, place) in expected {
                let expected = sorted[place as usize];
                prop_assert_eq!(percentile(&values, percent, method), Ok(expected));
                prop_assert_eq!(percentiles(&values, &[50.0, percent, 40.0], method).map(|all| all[1]), Ok(expected));
            }
            let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
            let linear = percentile(&values, percent, Method::Linear).expect("a value");
            prop_assert!((linear - (low + (high - low) * place.fract())).abs() <= 1e-12 * (low.abs() + high.abs()));
        }
    }
}
