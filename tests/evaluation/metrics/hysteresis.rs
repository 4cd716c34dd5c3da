use std::f64::consts::{PI, TAU};

use fishplate::metrics::hysteresis::{Loop, matching};

use crate::metrics::{close, record};

const THRESHOLD: f64 = 0.05;

fn ellipse(
    cycles: usize,
    begin: f64,
    half_width: f64,
    half_height: f64,
    samples: usize,
) -> (Vec<f64>, Vec<f64>) {
    let angle = |k: usize| begin + TAU * cycles as f64 * k as f64 / samples as f64;
    // Run through clockwise: the output leads, as a force that is resisted.
    (0..=samples).map(|k| (half_width * angle(k).sin(), half_height * angle(k).cos())).unzip()
}

/// Straight flanks of slope 2, one above and one below the diagonal by `friction`; vertical at the
/// ends.
fn parallelogram(cycles: usize, friction: f64, per_flank: usize) -> (Vec<f64>, Vec<f64>) {
    let mut points = Vec::new();
    for _ in 0..cycles {
        let along = |k: usize| -1.0 + 2.0 * k as f64 / per_flank as f64;
        points.extend((0..=per_flank).map(|k| (along(k), 2.0 * along(k) + friction)));
        points.extend((0..=per_flank).map(|k| (-along(k), -2.0 * along(k) - friction)));
    }
    points.into_iter().unzip()
}

fn of((x, y): &(Vec<f64>, Vec<f64>)) -> Loop<'_> {
    Loop { x, y }
}

/// Closed form: the flanks lie apart by the difference of the friction, all along.
#[test]
fn parallelograms() {
    for cycles in 1..4 {
        let simulated = parallelogram(cycles, 0.5, 70);
        let measured = parallelogram(2, 0.3, 90);
        let result = matching(of(&simulated), of(&measured), THRESHOLD).expect("comparable");
        close(result.maximum, 0.2, 1e-12);
        close(result.mean, 0.2, 1e-12);
        close(result.range, 4.6, 1e-12);
    }
}

/// Closed form: ellipses of heights 2 and 1.5 lie apart by 0.5 sqrt(1 - x^2), pi/4 of the maximum
/// in the mean. The tolerance is the straight line's between samples near the ends, where an
/// ellipse is steep.
#[test]
fn ellipses_wherever_the_record_begins() {
    for begin in [0.0, 0.5 * PI, 2.5] {
        for cycles in 1..4 {
            let simulated = ellipse(cycles, begin, 1.0, 2.0, 3000 * cycles);
            let measured = ellipse(2, 1.0, 1.0, 1.5, 7000);
            let result = matching(of(&simulated), of(&measured), THRESHOLD).expect("comparable");
            close(result.maximum, 0.5, 2e-3);
            close(result.mean, 0.5 * PI / 4.0, 2e-3);
            close(result.range, 3.0, 1e-5);
        }
    }
}

/// A first loading from rest is not on the loop and counts nowhere, as the loop reaches everywhere.
#[test]
fn the_way_in_does_not_count() {
    let (x, y) = parallelogram(2, 0.3, 100);
    let way_in: Vec<f64> = (0..50).map(|k| f64::from(k) / 50.0 - 1e-9).collect();
    let x: Vec<f64> = way_in
        .iter()
        .copied()
        .chain((0..=100).map(|k| 1.0 - f64::from(k) / 50.0))
        .chain(x)
        .collect();
    let y: Vec<f64> = vec![9.0; 50]
        .into_iter()
        .chain((0..=100).map(|k| 2.0 - f64::from(k) / 25.0 - 0.3))
        .chain(y)
        .collect();
    let reference = parallelogram(1, 0.3, 80);
    let result = matching(Loop { x: &x, y: &y }, of(&reference), THRESHOLD).expect("comparable");
    assert!(result.maximum < 1e-8, "{}", result.maximum);
}

/// Noise on the input well below the threshold makes no turning points and moves the result by its
/// own size.
#[test]
fn noise_on_the_input() {
    let (mut x, y) = parallelogram(2, 0.5, 500);
    for (x, noise) in x.iter_mut().zip(record(4000, 0.0)) {
        *x += 0.01 * noise;
    }
    let measured = parallelogram(1, 0.3, 500);
    let result = matching(Loop { x: &x, y: &y }, of(&measured), THRESHOLD).expect("comparable");
    close(result.mean, 0.2, 0.05);
}

/// Over the common input only: a simulation of smaller swing is compared on its own range.
#[test]
fn common_input_only() {
    let simulated = ellipse(1, 0.0, 0.5, 0.0, 400);
    let measured = parallelogram(1, 0.3, 400);
    let result = matching(of(&simulated), of(&measured), THRESHOLD).expect("comparable");
    // |2 x + 0.3| and |2 x - 0.3| on -0.5..0.5: at most 1.3, mean (1.3^2 + 0.7^2) / 4.
    close(result.maximum, 1.3, 1e-12);
    close(result.mean, (1.69 + 0.49) / 4.0, 1e-3);
}

/// A measured output that does not move has no range.
#[test]
fn a_still_output_has_no_range() {
    let simulated = parallelogram(1, 0.3, 50);
    let still = vec![0.0; simulated.0.len()];
    let result = matching(of(&simulated), Loop { x: &simulated.0, y: &still }, THRESHOLD)
        .expect("comparable");
    assert_eq!(result.range, 0.0);
}

#[test]
fn refuses_with_the_reason() {
    let good = parallelogram(1, 0.3, 50);
    let ramp: Vec<f64> = (0..50).map(f64::from).collect();
    let far: Vec<f64> = good.0.iter().map(|x| x + 100.0).collect();
    let says = |simulated: Loop, measured: Loop, threshold: f64, text: &str| {
        let reason = matching(simulated, measured, threshold).expect_err("refused").reason;
        assert!(reason.contains(text), "{reason}");
    };
    says(
        Loop { x: &ramp, y: &ramp },
        of(&good),
        THRESHOLD,
        "the simulated loop has no falling branch",
    );
    says(of(&good), Loop { x: &[], y: &[] }, THRESHOLD, "the measured loop has no rising branch");
    says(of(&good), Loop { x: &[1.0; 5], y: &[1.0; 5] }, THRESHOLD, "no rising branch");
    says(of(&good), Loop { x: &ramp, y: &[1.0] }, THRESHOLD, "50 inputs and 1 outputs");
    says(of(&good), Loop { x: &[0.0, f64::NAN], y: &[0.0; 2] }, THRESHOLD, "not finite");
    says(of(&good), Loop { x: &far, y: &good.1 }, THRESHOLD, "no common input while it is rising");
    for threshold in [0.0, 1.0, f64::NAN] {
        says(of(&good), of(&good), threshold, "threshold");
    }
}
