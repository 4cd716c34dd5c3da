use fishplate::metrics::resample::{ResampleError, interpolate, resample, uniform_grid};

use crate::metrics::all_close;

/// Closed form: between samples of a straight line lies the line.
#[test]
fn a_straight_line_stays_one() {
    let axis: Vec<f64> = (0..50).map(|k| f64::from(k * k) / 100.0).collect();
    let line: Vec<f64> = axis.iter().map(|x| 4.0 - 2.0 * x).collect();
    let (grid, values) = resample(&axis, &line, 0.1).expect("a grid");
    assert_eq!(grid.len(), 241);
    all_close(&values, &grid.iter().map(|x| 4.0 - 2.0 * x).collect::<Vec<f64>>(), 1.0, 1e-13);
}

/// By hand; the samples themselves come back to the bit, in whatever order they are asked for.
#[test]
fn points_in_any_order() {
    let axis: Vec<f64> = (0..40).map(f64::from).collect();
    let signal: Vec<f64> = (0..40).map(|k| f64::from(k * k)).collect();
    assert_eq!(
        interpolate(&axis, &signal, &[39.0, 0.5, 3.25, 0.0, 30.5, 2.0, 38.5]),
        Ok(vec![1521.0, 0.5, 10.75, 0.0, 930.5, 4.0, 1482.5])
    );
    assert_eq!(interpolate(&axis, &signal, &axis), Ok(signal.clone()));
    assert_eq!(interpolate(&[1.0], &[5.0], &[1.0]), Ok(vec![5.0]));
    assert_eq!(uniform_grid(0.0, 0.3, 0.1).map(|grid| grid.len()), Ok(4));
    assert_eq!(uniform_grid(2.0, 2.0, 0.1), Ok(vec![2.0]));
}

#[test]
fn refuses_with_the_reason() {
    let axis = [0.0, 1.0, 2.0];
    assert_eq!(
        interpolate(&axis, &axis, &[2.1]),
        Err(ResampleError::Outside { point: 2.1, first: 0.0, last: 2.0 })
    );
    assert!(matches!(interpolate(&axis, &axis, &[f64::NAN]), Err(ResampleError::Outside { .. })));
    assert_eq!(
        interpolate(&[0.0, 2.0, 2.0], &axis, &[1.0]),
        Err(ResampleError::Axis { sample: 2 })
    );
    assert_eq!(
        interpolate(&axis, &[1.0], &[1.0]),
        Err(ResampleError::Lengths { axis: 3, signal: 1 })
    );
    assert_eq!(resample(&[], &[], 1.0), Err(ResampleError::Empty));
    for step in [0.0, -1.0, f64::NAN, 1e-12] {
        assert!(matches!(uniform_grid(0.0, 1.0, step), Err(ResampleError::Grid { .. })), "{step}");
    }
    assert!(matches!(uniform_grid(1.0, 0.0, 0.1), Err(ResampleError::Grid { .. })));
}
