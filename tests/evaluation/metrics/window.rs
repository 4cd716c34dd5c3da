use fishplate::metrics::window::{Ends, Kind, Sliding, SlidingError};

use crate::metrics::all_close;

fn window(width: f64, step: f64, kind: Kind, ends: Ends) -> Sliding {
    Sliding { width, step, kind, ends, short_sections: false }
}

/// Closed form: over a straight line the integral mean is the middle, the mean square that of a
/// uniform distribution.
#[test]
fn over_a_straight_line() {
    let axis: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.37).collect();
    let line: Vec<f64> = axis.iter().map(|x| 3.0 * x - 20.0).collect();
    let means = window(2.0, 0.5, Kind::Mean, Ends::Integral);
    let starts = means.starts(1.0, 30.0).expect("a section");
    let middles: Vec<f64> = starts.iter().map(|a| 3.0 * (a + 1.0) - 20.0).collect();
    all_close(&means.over(&axis, &line, 1.0, 30.0).expect("values"), &middles, 1.0, 1e-12);
    let squares: Vec<f64> =
        middles.iter().map(|middle| (middle * middle + 36.0 / 12.0).sqrt()).collect();
    let rms = window(2.0, 0.5, Kind::Rms, Ends::Integral);
    all_close(&rms.over(&axis, &line, 1.0, 30.0).expect("values"), &squares, 1.0, 1e-12);
}

/// By hand: windows hold 0 1, 1 2, ...; the sample on the upper edge belongs to the next.
#[test]
fn samples_on_the_edges() {
    let axis: Vec<f64> = (0..6).map(f64::from).collect();
    let values = [1.0, 3.0, 5.0, 7.0, 9.0, 11.0];
    let means = window(2.0, 1.0, Kind::Mean, Ends::Samples);
    assert_eq!(means.over(&axis, &values, 0.0, 5.0), Ok(vec![2.0, 4.0, 6.0, 8.0]));
    let rms = window(2.0, 3.0, Kind::Rms, Ends::Samples);
    all_close(
        &rms.over(&axis, &values, 0.0, 5.0).expect("values"),
        &[5_f64.sqrt(), 65_f64.sqrt()],
        1.0,
        1e-15,
    );
    // 0.1 three times is a hair more than 0.3: the last window still lies inside.
    assert_eq!(
        window(0.1, 0.1, Kind::Mean, Ends::Samples).starts(0.0, 0.3).map(|starts| starts.len()),
        Ok(3)
    );
}

#[test]
fn a_large_value_elsewhere_costs_no_digits() {
    let axis: Vec<f64> = (0..1000).map(f64::from).collect();
    let mut values = vec![0.1; 1000];
    values[3] = 1e12;
    let means = window(10.0, 10.0, Kind::Mean, Ends::Samples)
        .over(&axis, &values, 0.0, 990.0)
        .expect("values");
    all_close(&means[1..], &vec![0.1; means.len() - 1], 0.1, 1e-14);
}

#[test]
fn refuses_with_the_reason() {
    let axis = [0.0, 1.0, 2.0, 6.0, 7.0];
    let values = [1.0; 5];
    let means = window(2.0, 1.0, Kind::Mean, Ends::Samples);
    assert_eq!(
        means.over(&axis, &values, 0.0, 7.0),
        Err(SlidingError::Empty { from: 3.0, width: 2.0 })
    );
    assert_eq!(
        means.over(&axis, &values, 0.0, 1.5),
        Err(SlidingError::SectionTooShort { length: 1.5, width: 2.0 })
    );
    assert_eq!(
        means.over(&axis, &values[..4], 0.0, 7.0),
        Err(SlidingError::Lengths { axis: 5, signal: 4 })
    );
    assert!(matches!(means.over(&axis, &values, -5.0, 7.0), Err(SlidingError::Record { .. })));
    assert!(matches!(means.over(&axis, &values, 0.0, 20.0), Err(SlidingError::Record { .. })));
    assert!(matches!(
        means.over(&[0.0], &[0.0], 0.0, 5.0),
        Err(SlidingError::TooFewSamples { samples: 1 })
    ));
    assert_eq!(
        means.over(&[0.0, 1.0, 1.0], &[0.0; 3], 0.0, 2.0),
        Err(SlidingError::Axis { sample: 2 })
    );
    assert_eq!(
        means.over(&[0.0, f64::NAN, 1.0], &[0.0; 3], 0.0, 2.0),
        Err(SlidingError::Axis { sample: 1 })
    );
    assert_eq!(
        means.over(&[0.0, 1.0, 2.0], &[0.0, f64::NAN, 0.0], 0.0, 2.0),
        Err(SlidingError::NotFinite { from: 0.0 })
    );
    assert!(matches!(
        window(0.0, 1.0, Kind::Mean, Ends::Samples).starts(0.0, 1.0),
        Err(SlidingError::Window { .. })
    ));
    assert!(matches!(
        window(1.0, 1e-12, Kind::Mean, Ends::Samples).starts(0.0, 10.0),
        Err(SlidingError::Window { .. })
    ));
    assert!(matches!(means.starts(f64::NAN, 1.0), Err(SlidingError::Section { .. })));
}

/// By hand: a section shorter than the window is one window, with the samples at both of its ends.
#[test]
fn a_short_section_is_one_window() {
    let axis: Vec<f64> = (0..6).map(f64::from).collect();
    let values = [1.0, 3.0, 5.0, 7.0, 9.0, 11.0];
    let of = |ends, width| Sliding { short_sections: true, ..window(width, 1.0, Kind::Mean, ends) };
    assert_eq!(of(Ends::Samples, 10.0).over(&axis, &values, 1.0, 4.0), Ok(vec![6.0]));
    assert_eq!(of(Ends::Integral, 10.0).over(&axis, &values, 1.0, 4.0), Ok(vec![6.0]));
    // A section as long as the window, or longer, has the windows that it has anyway.
    for (ends, width) in [(Ends::Samples, 3.0), (Ends::Samples, 2.0), (Ends::Integral, 3.0)] {
        assert_eq!(
            of(ends, width).over(&axis, &values, 1.0, 4.0),
            window(width, 1.0, Kind::Mean, ends).over(&axis, &values, 1.0, 4.0)
        );
    }
    assert!(of(Ends::Samples, 10.0).over(&axis, &values, 4.0, 4.0).is_err());
}
