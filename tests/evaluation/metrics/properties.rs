use fishplate::metrics::{
    filter::{Band, Cutoff, Filter, Phase},
    pair::{area_between, sprague_geers_phase, theil_u1},
    percentile::{Method, percentile, percentiles},
    resample::interpolate,
    window::{Ends, Kind, Sliding},
};
use proptest::{collection::vec, prelude::*, sample::select};

fn bands() -> impl Strategy<Value = Band> {
    prop_oneof![
        (0.5..90.0).prop_map(Band::LowPass),
        (0.5..90.0).prop_map(Band::HighPass),
        (0.5..40.0, 1.0..50.0).prop_map(|(low, width)| Band::BandPass(low, low + width)),
        (0.5..40.0, 1.0..50.0).prop_map(|(low, width)| Band::BandStop(low, low + width)),
    ]
}

fn phases() -> impl Strategy<Value = Phase> {
    select(vec![Phase::Zero, Phase::Causal, Phase::CausalFromRest])
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak, value| value.abs().max(peak))
}

proptest! {
    #[test]
    fn percentile_is_monotone_in_percent(values in vec(-1e6..1e6, 1..200), a in 0.0..=100.0, b in 0.0..=100.0, method in select(Method::NAMES.map(|(method, _)| method).to_vec())) {
        let (low, high) = if a <= b { (a, b) } else { (b, a) };
        let found = percentiles(&values, &[low, high], method).expect("values");
        prop_assert!(found[0] <= found[1]);
        prop_assert_eq!(found[0].to_bits(), percentile(&values, low, method).expect("values").to_bits());
        let (least, greatest) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), &v| (l.min(v), g.max(v)));
        prop_assert!(least <= found[0] && found[1] <= greatest);
    }

    #[test]
    fn filter_is_linear(
        x in vec(-1.0..1.0, 150..250), y in vec(-1.0..1.0, 250), band in bands(), order in 1..6_usize, phase in phases(), factor in -5.0..5.0_f64
    ) {
        let filter = Filter::design(band, order, 200.0, phase, Cutoff::AsApplied).expect("a good design");
        let mixed: Vec<f64> = x.iter().zip(&y).map(|(x, y)| factor * x + y).collect();
        let results = filter.apply_many(&[&x, &y[..x.len()], &mixed]).expect("long enough");
        let scale = 1.0 + peak(&results[0]) * factor.abs() + peak(&results[1]);
        for ((x, y), mixed) in results[0].iter().zip(&results[1]).zip(&results[2]) {
            prop_assert!((factor * x + y - mixed).abs() < 1e-8 * scale, "{} {}", factor * x + y, mixed);
        }
    }

    #[test]
    fn constant_passes_a_low_pass_and_not_a_high_pass(level in -1e5..1e5_f64, edge in 0.5..95.0, order in 1..9_usize, length in 60..400_usize) {
        let signal = vec![level; length];
        for phase in [Phase::Zero, Phase::Causal] {
            let through = |band| Filter::design(band, order, 200.0, phase, Cutoff::AsApplied).expect("a good design").apply(&signal).expect("long enough");
            prop_assert!(through(Band::LowPass(edge)).iter().all(|value| (value - level).abs() <= 1e-8 * level.abs()));
            prop_assert!(through(Band::HighPass(edge)).iter().all(|value| value.abs() <= 1e-8 * level.abs()));
        }
    }

    #[test]
    fn sliding_mean_of_a_constant(level in -1e6..1e6_f64, distances in vec(0.01..0.4, 40..300), width in 0.5..3.0, step in 0.1..2.0) {
        let axis: Vec<f64> = distances.iter().scan(0.0, |at, d| { *at += d; Some(*at) }).collect();
        let signal = vec![level; axis.len()];
        let (start, end) = (axis[0], axis[axis.len() - 1]);
        for ends in [Ends::Samples, Ends::Integral] {
            for (kind, expected) in [(Kind::Mean, level), (Kind::Rms, level.abs())] {
                if let Ok(values) = (Sliding { width, step: Some(step), kind, ends, short_sections: false }).over(&axis, &signal, start, end) {
                    prop_assert!(values.iter().all(|value| (value - expected).abs() <= 1e-12 * level.abs()));
                } else {
                    prop_assert!(end - start < width);
                }
            }
        }
    }

    #[test]
    fn interpolation_stays_between_its_neighbours(values in vec(-10.0..10.0, 2..50), at in vec(0.0..1.0, 1..50)) {
        let axis: Vec<f64> = (0..values.len()).map(|k| k as f64).collect();
        let points: Vec<f64> = at.iter().map(|share| share * (values.len() - 1) as f64).collect();
        for (point, found) in points.iter().zip(interpolate(&axis, &values, &points).expect("inside")) {
            let (before, after): (f64, f64) = (values[point.floor() as usize], values[point.ceil() as usize]);
            prop_assert!(before.min(after) - 1e-12 <= found && found <= before.max(after) + 1e-12);
        }
    }

    #[test]
    fn pairs_keep_their_bounds(s in vec(-1e3..1e3, 1..100), m in vec(-1e3..1e3, 100)) {
        let m = &m[..s.len()];
        prop_assert!((0.0..=1.0).contains(&sprague_geers_phase(&s, m).expect("not zero")));
        prop_assert!((0.0..=1.0 + 1e-12).contains(&theil_u1(&s, m).expect("not zero")));
        let (there, back) = (area_between(&s, m).expect("values"), area_between(m, &s).expect("values"));
        prop_assert!((there - back).abs() <= 1e-9 * there.max(1.0));
    }
}
