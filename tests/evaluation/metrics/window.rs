use fishplate::catalog::{InWindow, Reducer};
use fishplate::metrics::percentile::Method;
use fishplate::metrics::sampling::Traits;
use fishplate::metrics::statistics::rms_about_trend;
use fishplate::metrics::window::{Ends, Kind, Sliding, SlidingError};

use crate::metrics::all_close;

fn window(width: f64, step: f64, kind: Kind<'static>, ends: Ends) -> Sliding<'static> {
    Sliding { width, step: Some(step), kind, ends, short_sections: false }
}

/// Closed form: over a straight line the integral mean is the middle, the mean square that of a
/// uniform distribution.
#[test]
fn over_a_straight_line() {
    let axis: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.37).collect();
    let line: Vec<f64> = axis.iter().map(|x| 3.0 * x - 20.0).collect();
    let means = window(2.0, 0.5, Kind::Mean, Ends::Integral);
    let starts = means.starts(&axis, 1.0, 30.0).expect("a section");
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
        window(0.1, 0.1, Kind::Mean, Ends::Samples)
            .starts(&axis, 0.0, 0.3)
            .map(|starts| starts.len()),
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
        window(0.0, 1.0, Kind::Mean, Ends::Samples).starts(&axis, 0.0, 1.0),
        Err(SlidingError::Window { .. })
    ));
    assert!(matches!(
        window(1.0, 1e-12, Kind::Mean, Ends::Samples).starts(&axis, 0.0, 10.0),
        Err(SlidingError::Window { .. })
    ));
    assert!(matches!(means.starts(&axis, f64::NAN, 1.0), Err(SlidingError::Section { .. })));
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

/// NumPy 1.26 over the same windows (`min`, `max`, `ptp`, `std(ddof=1)`, `percentile`, `polyfit`),
/// at even steps and from every sample: the first, the last and the largest value, and their sum.
#[test]
fn every_value_of_a_window_is_numpys() {
    let axis: Vec<f64> = (0..=100).map(f64::from).map(|k| 0.1 * k + 0.02 * f64::sin(k)).collect();
    let noise = |k: u32| f64::from((79 * k) % 101) / 101.0;
    let values: Vec<f64> = (0..=100_u32)
        .map(|k| (0.37 * f64::from(k)).sin() + 0.01 * f64::from(k) + noise(k))
        .collect();
    for (step, count, name, wanted) in NUMPYS {
        let percent = name.strip_prefix('p').and_then(|percent| percent.parse().ok());
        let reducer =
            percent.map_or_else(|| Reducer::named(name), |p| Some(Reducer::Percentile(p)));
        let reducer = reducer.expect("a reducer");
        let itself = |axis: &[f64], x: &[f64]| reducer.run(axis, &Traits::of(x), Method::Linear);
        let kind = match reducer.in_window().expect("a reducer of windows") {
            InWindow::Fast(kind) => kind,
            InWindow::Itself => Kind::Reduced(&itself),
        };
        let step = Some(step).filter(|step| *step > 0.0);
        let window = Sliding { width: 1.0, step, kind, ends: Ends::Samples, short_sections: false };
        let found = window.over(&axis, &values, 0.5, 9.5).expect("values");
        assert_eq!(found.len(), count, "{name}");
        let largest = found.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        let found = [found[0], found[count - 1], largest, found.iter().sum()];
        all_close(&found, &wanted, wanted[3].abs().max(1.0), 1e-12);
    }
}

/// A step of 0 stands for every sample.
#[rustfmt::skip]
const NUMPYS: [(f64, usize, &str, [f64; 4]); 22] = [
    (0.3, 27, "minimum", [-0.6969229940859943, 1.1020528674886738, 1.1020528674886738, 0.1648431896549244]),
    (0.3, 27, "maximum", [1.5496347791667797, 2.6220101774322564, 2.6220101774322564, 53.61666819393694]),
    (0.3, 27, "peak", [1.5496347791667797, 2.6220101774322564, 2.6220101774322564, 53.68642275665847]),
    (0.3, 27, "range", [2.246557773252774, 1.5199573099435826, 2.54430029574157, 53.451825004282014]),
    (0.3, 27, "std", [0.7120395604706152, 0.5304179125150202, 0.9703330484558867, 18.14208959319425]),
    (0.3, 27, "median", [0.19784737007671582, 1.8195589788787132, 2.0348138516607372, 26.848144731225386]),
    (0.3, 27, "p90", [1.165360448985157, 2.502253075857897, 2.526204496172769, 46.931966664191684]),
    (0.3, 27, "slope", [-2.093479394862724, 1.1315654354481124, 3.3714481119881596, 5.7810741876925045]),
    (0.3, 27, "rms_about_trend", [0.3972948776034371, 0.36310959841181195, 0.587417230403673, 9.753711279371165]),
    (0.3, 27, "mean", [0.26982551815334044, 1.8412440983486784, 1.846796957470211, 26.268609471513113]),
    (0.3, 27, "rms", [0.7235141845819811, 1.909436131567978, 1.909436131567978, 32.44093339719382]),
    (0.0, 80, "minimum", [-0.6969229940859943, 1.2441025095368996, 1.2441025095368996, -2.329100223092508]),
    (0.0, 80, "maximum", [1.5496347791667797, 2.6220101774322564, 2.6220101774322564, 165.60961294601623]),
    (0.0, 80, "peak", [1.5496347791667797, 2.6220101774322564, 2.6220101774322564, 165.67936750873776]),
    (0.0, 80, "range", [2.246557773252774, 1.3779076678953568, 2.709449173895513, 167.93871316910872]),
    (0.0, 80, "std", [0.6373112319801421, 0.4910352087561904, 0.9701661246239375, 56.08213467386557]),
    (0.0, 80, "median", [0.21343341005047067, 1.8416423533026203, 1.9744083371134078, 81.09002673299145]),
    (0.0, 80, "p90", [1.0692918664397513, 2.514228786015333, 2.514228786015333, 141.2268631353596]),
    (0.0, 80, "slope", [-1.1414383647562356, 0.16900052452809033, 2.962246461370878, 19.716186266949776]),
    (0.0, 80, "rms_about_trend", [0.4886205877006941, 0.4632977120387899, 0.596450067192336, 31.89884740956091]),
    (0.0, 80, "mean", [0.26922372714463694, 1.918240848553792, 1.918240848553792, 79.68404891876678]),
    (0.0, 80, "rms", [0.6646223556491319, 1.9739939137886884, 1.9739939137886884, 98.37194605056723]),
];

/// A value that is not finite is told, also where the extremes beside it would hide it; a value
/// that is not defined in a window, too.
#[test]
fn no_window_hides_what_is_not_a_number() {
    let axis: Vec<f64> = (0..6).map(f64::from).collect();
    let range = window(2.0, 1.0, Kind::Extremes(|low, high| high - low), Ends::Samples);
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..5 {
            let mut values = [1.0, 3.0, 2.0, 7.0, 0.0, 11.0];
            values[place] = wrong;
            let from = place.saturating_sub(1) as f64;
            assert_eq!(
                range.over(&axis, &values, 0.0, 5.0),
                Err(SlidingError::NotFinite { from }),
                "{wrong} at {place}"
            );
        }
    }
    let trend = |axis: &[f64], x: &[f64]| rms_about_trend(axis, x);
    let of_two = Sliding { kind: Kind::Reduced(&trend), ..range };
    assert_eq!(
        of_two.over(&axis, &[1.0; 6], 0.0, 5.0),
        Err(SlidingError::Undefined { from: 0.0, samples: 2 })
    );
}
