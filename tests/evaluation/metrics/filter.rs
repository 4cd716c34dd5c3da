use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use fishplate::metrics::filter::{Band, Cutoff, DesignError, Filter, Phase, TooShort};

use crate::metrics::{all_close, close, json, number, numbers, record};

fn zero(band: Band, order: usize, sampling_rate: f64) -> Filter {
    Filter::design(band, order, sampling_rate, Phase::Zero, Cutoff::AsApplied)
        .expect("a good design")
}

/// Every kind of band, odd and even orders, several rates, three ways of running: SciPy.
#[test]
fn agrees_with_scipy() {
    let cases = json("scipy/filters.json");
    let cases = cases.as_array().expect("a list");
    assert_eq!(cases.len(), 240);
    for case in cases {
        let hz = numbers(&case["hz"]);
        let band = match case["kind"].as_str() {
            Some("lowpass") => Band::LowPass(hz[0]),
            Some("highpass") => Band::HighPass(hz[0]),
            Some("bandpass") => Band::BandPass(hz[0], hz[1]),
            _ => Band::BandStop(hz[0], hz[1]),
        };
        let phase = match case["phase"].as_str() {
            Some("zero") => Phase::Zero,
            Some("causal") => Phase::Causal,
            _ => Phase::CausalFromRest,
        };
        let cutoff = if case["as_applied"] == true { Cutoff::AsApplied } else { Cutoff::PerPass };
        let (order, sampling_rate) =
            (number(&case["order"]) as usize, number(&case["sampling_rate"]));
        let filter =
            Filter::design(band, order, sampling_rate, phase, cutoff).expect("a good design");
        let filtered = filter
            .apply(&record(number(&case["samples"]) as i64, number(&case["offset"])))
            .expect("long enough");
        let picked: Vec<f64> = filtered
            .iter()
            .step_by(number(&case["every"]) as usize)
            .chain(filtered.last())
            .copied()
            .collect();
        let expected = numbers(&case["values"]);
        let worst = picked.iter().zip(&expected).map(|(a, e)| (a - e).abs()).fold(0.0, f64::max)
            / number(&case["scale"]);
        assert!(
            worst < 2e-10 && picked.len() == expected.len(),
            "{band:?} {order} {sampling_rate} {phase:?} {cutoff:?}: {worst}"
        );
        for (frequency, expected) in
            numbers(&case["frequencies"]).into_iter().zip(numbers(&case["gain"]))
        {
            assert!(
                (filter.gain(frequency) - expected).abs() < 1e-9,
                "{band:?} {order} at {frequency}: {}",
                filter.gain(frequency)
            );
        }
        let pole = number(&case["slowest_pole"]);
        close(filter.time_constant(), -1.0 / (pole.ln() * sampling_rate), 1e-6);
    }
}

/// Definition of the cut-off, for every band, order and rate.
#[test]
fn both_passes_together_are_at_3_db() {
    for order in 1..=8 {
        for sampling_rate in [200.0, 333.0, 1000.0] {
            let edges = [
                (Band::LowPass(20.0), vec![20.0]),
                (Band::HighPass(0.7), vec![0.7]),
                (Band::BandPass(0.4, 10.0), vec![0.4, 10.0]),
                (Band::BandStop(45.0, 55.0), vec![45.0, 55.0]),
            ];
            for (band, edges) in edges {
                for edge in edges {
                    close(zero(band, order, sampling_rate).gain(edge), FRAC_1_SQRT_2, 1e-7);
                    let per_pass =
                        Filter::design(band, order, sampling_rate, Phase::Zero, Cutoff::PerPass)
                            .expect("a good design");
                    close(per_pass.gain(edge), 0.5, 1e-7);
                    let causal = Filter::design(
                        band,
                        order,
                        sampling_rate,
                        Phase::Causal,
                        Cutoff::AsApplied,
                    )
                    .expect("a good design");
                    close(causal.gain(edge), FRAC_1_SQRT_2, 1e-7);
                }
            }
        }
    }
}

/// Closed form: the steady response to a sine is the sine times the gain, without delay.
#[test]
fn a_sine_comes_out_as_the_gain_says() {
    let sampling_rate = 500.0;
    let filter = zero(Band::LowPass(20.0), 4, sampling_rate);
    for frequency in [1.0, 15.0, 20.0, 30.0] {
        let sine: Vec<f64> =
            (0..5000).map(|k| (TAU * frequency * f64::from(k) / sampling_rate).sin()).collect();
        let filtered = filter.apply(&sine).expect("long enough");
        let expected: Vec<f64> = sine.iter().map(|value| value * filter.gain(frequency)).collect();
        all_close(&filtered[1000..4000], &expected[1000..4000], 1.0, 1e-9);
    }
}

#[test]
fn many_signals_are_bit_for_bit_the_single_ones() {
    let records: Vec<Vec<f64>> =
        (0..11).map(|k| record(if k < 8 { 400 } else { 301 }, f64::from(k))).collect();
    for (band, order) in [
        (Band::LowPass(20.0), 1),
        (Band::LowPass(20.0), 5),
        (Band::LowPass(20.0), 7),
        (Band::BandPass(0.4, 10.0), 3),
        (Band::BandPass(0.4, 10.0), 4),
        (Band::BandStop(45.0, 55.0), 9),
    ] {
        for phase in [Phase::Zero, Phase::Causal, Phase::CausalFromRest] {
            let filter = Filter::design(band, order, 250.0, phase, Cutoff::AsApplied)
                .expect("a good design");
            for count in 0..=records.len() {
                let signals: Vec<&[f64]> = records[..count].iter().map(Vec::as_slice).collect();
                let many = filter.apply_many(&signals).expect("long enough");
                let single: Vec<Vec<f64>> = signals
                    .iter()
                    .map(|signal| filter.apply(signal).expect("long enough"))
                    .collect();
                assert!(many == single, "{band:?} {order} {phase:?} {count}");
            }
        }
    }
}

#[test]
fn highest_order_designs_and_runs() {
    for band in [
        Band::LowPass(20.0),
        Band::HighPass(20.0),
        Band::BandPass(20.0, 60.0),
        Band::BandStop(20.0, 60.0),
    ] {
        let filter = zero(band, 20, 200.0);
        let filtered = filter.apply(&record(300, 0.0)).expect("long enough");
        assert!(filtered.iter().all(|value| value.abs() < 10.0), "{band:?}");
    }
}

#[test]
fn padding_is_scipys() {
    // scipy.signal.sosfiltfilt refuses a signal of exactly these lengths.
    for (band, order, padding) in [
        (Band::LowPass(20.0), 4, 15),
        (Band::LowPass(20.0), 2, 9),
        (Band::LowPass(20.0), 1, 6),
        (Band::HighPass(20.0), 3, 12),
        (Band::BandPass(0.4, 10.0), 4, 27),
        (Band::BandPass(0.4, 10.0), 3, 21),
    ] {
        let filter = zero(band, order, 200.0);
        assert_eq!(
            filter.apply(&vec![1.0; padding]),
            Err(TooShort { samples: padding, needed: padding + 1 })
        );
        assert!(filter.apply(&vec![1.0; padding + 1]).is_ok());
    }
    let causal = Filter::design(Band::LowPass(20.0), 4, 200.0, Phase::Causal, Cutoff::PerPass)
        .expect("a good design");
    assert_eq!(causal.apply(&[]), Err(TooShort { samples: 0, needed: 1 }));
    // The first value has stood for ever; the low-pass leaves it.
    all_close(&causal.apply(&[3.0]).expect("long enough"), &[3.0], 3.0, 1e-12);
}

/// Against a run: what is left of a step after 4.6 time constants, in which the slowest part falls
/// to 1 %.
#[test]
fn the_time_constant_says_when_a_transient_is_gone() {
    let filter =
        Filter::design(Band::BandPass(0.4, 10.0), 4, 200.0, Phase::CausalFromRest, Cutoff::PerPass)
            .expect("a good design");
    let step = filter.apply(&vec![1.0; 4000]).expect("long enough");
    let settling_time = filter.time_constant() * 100_f64.ln();
    let settled = (settling_time * 200.0) as usize;
    let peak = |from: &[f64]| from.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    assert!((4.0..6.0).contains(&settling_time), "{settling_time}");
    assert!(
        peak(&step[settled..]) < 0.03 * peak(&step),
        "{}",
        peak(&step[settled..]) / peak(&step)
    );
}

#[test]
fn refuses_what_cannot_be_designed() {
    let design = |band, order, sampling_rate| {
        Filter::design(band, order, sampling_rate, Phase::Zero, Cutoff::AsApplied)
    };
    let says = |band, order, sampling_rate, text: &str| {
        let message =
            design(band, order, sampling_rate).map(|_| ()).expect_err("refused").to_string();
        assert!(message.contains(text), "{message}");
    };
    says(Band::LowPass(20.0), 0, 200.0, "order of a filter must be from 1 to 20, this is 0");
    says(Band::LowPass(20.0), 21, 200.0, "this is 21");
    says(
        Band::LowPass(100.0),
        4,
        200.0,
        "100 Hz does not lie between 0 and half the sampling rate, 100 Hz",
    );
    says(Band::LowPass(0.0), 4, 200.0, "0 Hz");
    says(Band::HighPass(f64::NAN), 4, 200.0, "NaN");
    says(Band::BandPass(0.4, f64::INFINITY), 4, 200.0, "inf");
    says(
        Band::BandPass(10.0, 0.4),
        4,
        200.0,
        "lower edge 10 Hz is not below its upper edge 0.4 Hz",
    );
    says(Band::BandStop(5.0, 5.0), 4, 200.0, "lower edge 5 Hz");
    says(Band::LowPass(20.0), 4, f64::NAN, "sampling rate NaN");
    says(Band::LowPass(20.0), 4, -1.0, "sampling rate -1");
    // So near to the unit circle that rounding changes the gain by more than 1e-4; and not so near.
    for lowest in [1e-9, 1e-7, 1e-6, 1e-5] {
        assert!(
            matches!(design(Band::LowPass(lowest), 4, 100.0), Err(DesignError::Degenerate { .. })),
            "{lowest}"
        );
    }
    let slow = design(Band::LowPass(1e-3), 4, 100.0).expect("designed");
    let constant = slow.apply(&[1.0; 1000]).expect("filtered");
    assert!(constant.iter().all(|value| (value - 1.0).abs() < 1e-5), "{:?}", constant[999]);
}
