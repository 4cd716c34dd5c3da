//! Drift of one axis against another along a long record: shifts in windows, and the curve through
//! them.

use super::{
    statistics::median,
    synchronise::{Estimate, Pair, Search, estimate},
};

/// Where a drift is looked for, in the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windows {
    /// Length of a window.
    pub length: f64,
    /// From the start of a window to that of the next.
    pub every: f64,
    /// Largest difference of the shift from that of the window before.
    pub farthest: f64,
    /// Step of the comparison.
    pub step: f64,
}

impl Windows {
    /// Windows of a length: one after the other, and compared in steps shorter than the waves of
    /// the track.
    pub fn of(length: f64, farthest: f64) -> Self {
        Self { length, every: length, farthest, step: STEP }
    }
}

/// Step of the comparison in m. Both records have waves of the track from 3 m on in common.
const STEP: f64 = 0.25;

/// Signals of one record over a common axis that increases.
#[derive(Clone, Copy, Debug)]
pub struct Signals<'a> {
    pub axis: &'a [f64],
    /// In the same order for both records.
    pub values: &'a [Vec<f64>],
}

/// What is added to the measured axis at a place of the simulated one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Middle of the window, on the simulated axis.
    pub at: f64,
    pub estimate: Estimate,
}

/// Least correlation of a window whose shift is used: with less, more than three quarters of the
/// signals are not explained.
const LEAST_CORRELATION: f64 = 0.5;
/// A shift is used if its 95 % interval is not wider than this to either side, as a share of the
/// largest shift: 1 m of 20 m.
const UNCERTAIN: f64 = 0.05;
/// A shift is left out if it differs from the median of the five around it by more than this share
/// of the largest shift. It comes from another wave of the track: the drift itself changes by a few
/// metres in a kilometre.
const STRANGE: f64 = 0.15;

/// Looks for the shift window by window; each search begins at the shift of the window before.
#[derive(Clone, Debug)]
pub struct Tracker {
    pub windows: Windows,
    points: Vec<Point>,
    looked: usize,
}

impl Tracker {
    pub fn new(windows: Windows) -> Self {
        Self { windows, points: Vec::new(), looked: 0 }
    }

    /// The last shift that was certain.
    pub fn expected(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.estimate.shift)
    }

    /// Number of windows that were looked at.
    pub fn looked(&self) -> usize {
        self.looked
    }

    /// The part of the measured axis that a window needs.
    pub fn reach(&self, start: f64) -> (f64, f64) {
        let beside = self.windows.farthest + 2.0 * self.windows.step;
        (start - self.expected() - beside, start + self.windows.length - self.expected() + beside)
    }

    /// Looks at the window that begins at a place of the simulated axis. Both records reach beyond
    /// it as [`Tracker::reach`] says, or end before.
    pub fn look(&mut self, start: f64, simulated: Signals<'_>, measured: Signals<'_>) {
        let Windows { length, farthest, step, .. } = self.windows;
        self.looked += 1;
        let near = self.expected();
        let moved: Vec<f64> = measured.axis.iter().map(|at| at + near).collect();
        let pairs: Vec<Pair<'_>> = simulated
            .values
            .iter()
            .zip(measured.values)
            .enumerate()
            .map(|(group, (s, m))| Pair {
                simulated: (simulated.axis, s),
                measured: (&moved, m),
                group,
            })
            .collect();
        let search = Search { start, end: start + length, farthest, step };
        let Some(found) = estimate(&pairs, &search) else { return };
        let certain = found.correlation >= LEAST_CORRELATION
            && (found.high - found.low) / 2.0 <= UNCERTAIN * farthest;
        if certain {
            let estimate = Estimate {
                shift: found.shift + near,
                low: found.low + near,
                high: found.high + near,
                ..found
            };
            self.points.push(Point { at: start + length / 2.0, estimate });
        }
    }

    /// The shifts that are used.
    pub fn finish(self) -> Vec<Point> {
        let strange = |at: usize| {
            let around = &self.points[at.saturating_sub(2)..self.points.len().min(at + 3)];
            let shifts: Vec<f64> = around.iter().map(|point| point.estimate.shift).collect();
            median(&shifts).is_some_and(|middle| {
                (self.points[at].estimate.shift - middle).abs() > STRANGE * self.windows.farthest
            })
        };
        (0..self.points.len()).filter(|&at| !strange(at)).map(|at| self.points[at]).collect()
    }
}

/// The shift along the measured axis: linear between points, and beyond the outer ones as between
/// the two next to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve(Vec<(f64, f64)>);

impl Curve {
    /// `None` for no point, or where the measured axis would go back.
    pub fn new(points: &[Point]) -> Option<Self> {
        let knots: Vec<(f64, f64)> = points
            .iter()
            .map(|point| (point.at - point.estimate.shift, point.estimate.shift))
            .collect();
        let increases = |pair: &[(f64, f64)]| {
            pair[1].0 > pair[0].0 && pair[1].0 + pair[1].1 > pair[0].0 + pair[0].1
        };
        (!knots.is_empty() && knots.windows(2).all(increases)).then_some(Self(knots))
    }

    /// What is added to the measured axis there.
    pub fn at(&self, measured: f64) -> f64 {
        let knots = &self.0;
        if let [(_, only)] = knots[..] {
            return only;
        }
        let after = knots.partition_point(|(at, _)| *at < measured).clamp(1, knots.len() - 1);
        let ((x0, y0), (x1, y1)) = (knots[after - 1], knots[after]);
        y0 + (y1 - y0) * (measured - x0) / (x1 - x0)
    }
}

/// The parts of a signal inside a range of its axis, with one sample beside.
pub fn within(axis: &[f64], (from, to): (f64, f64)) -> std::ops::Range<usize> {
    let first = axis.partition_point(|at| *at < from).saturating_sub(1);
    first..(axis.partition_point(|at| *at <= to) + 1).min(axis.len()).max(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves without a common period, and a sensor that counts too much by up to 9 m in 4 km, not
    /// linearly.
    fn wave(x: f64, which: f64) -> f64 {
        (0.31 * x + which).sin()
            + 0.6 * (0.117 * x + 2.0 * which).sin()
            + 0.3 * (0.73 * x + which).cos()
    }

    fn counted(x: f64) -> f64 {
        x + 0.002 * x + 0.8 * (x / 500.0).sin()
    }

    fn tracked(noise: impl Fn(usize, f64) -> f64) -> (Tracker, Vec<f64>) {
        let simulated: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 0.2).collect();
        let measured: Vec<f64> = simulated.iter().map(|x| counted(*x)).collect();
        let s: Vec<Vec<f64>> =
            [0.0, 1.0, 2.0].map(|which| simulated.iter().map(|x| wave(*x, which)).collect()).into();
        let of = |which: f64| {
            simulated.iter().enumerate().map(|(k, x)| wave(*x, which) + noise(k, *x)).collect()
        };
        let m: Vec<Vec<f64>> = [0.0, 1.0, 2.0].map(of).into();
        let mut tracker = Tracker::new(Windows { every: 200.0, ..Windows::of(100.0, 10.0) });
        for k in 0..19 {
            let start = 30.0 + 200.0 * f64::from(k);
            let (signals_s, signals_m) =
                (Signals { axis: &simulated, values: &s }, Signals { axis: &measured, values: &m });
            tracker.look(start, signals_s, signals_m);
        }
        (tracker, measured)
    }

    /// The drift inside a window is a third of a metre, and 8 m over the record.
    #[test]
    fn a_drift_is_followed_along_the_record() {
        let (tracker, measured) = tracked(|k, _| 0.2 * ((k * 7919 % 101) as f64 / 50.0 - 1.0));
        let points = tracker.finish();
        assert!(points.len() >= 18, "{}", points.len());
        let curve = Curve::new(&points).expect("increasing");
        for x in (50..3900).step_by(10).map(f64::from) {
            let at = counted(x);
            assert!((at + curve.at(at) - x).abs() < 0.15, "{x}: {}", at + curve.at(at) - x);
        }
        assert!(counted(3900.0) - 3900.0 > 8.0 && measured.len() == 20_000);
    }

    /// Where the records do not agree, no shift is given and that between the neighbours is used.
    #[test]
    fn what_is_not_certain_is_left_out() {
        let (tracker, _) = tracked(|k, x| {
            if (1000.0..1500.0).contains(&x) {
                9.0 * ((k * 7919 % 101) as f64 / 50.0 - 1.0)
            } else {
                0.0
            }
        });
        let looked = tracker.looked();
        let points = tracker.finish();
        assert!(
            points.len() < looked
                && points.iter().all(|point| !(1100.0..1400.0).contains(&point.at)),
            "{points:?}"
        );
        let curve = Curve::new(&points).expect("increasing");
        assert!((curve.at(counted(1250.0)) + counted(1250.0) - 1250.0).abs() < 0.5);
    }

    #[test]
    fn a_strange_point_is_left_out_and_a_curve_never_goes_back() {
        let point = |at: f64, shift: f64| Point {
            at,
            estimate: Estimate { shift, low: shift, high: shift, correlation: 1.0 },
        };
        let mut tracker = Tracker::new(Windows::of(100.0, 20.0));
        tracker.points = [0.0, 0.1, 8.0, 0.3, 0.4]
            .iter()
            .zip(0..)
            .map(|(shift, at)| point(100.0 * f64::from(at), *shift))
            .collect();
        assert_eq!(
            tracker.finish().iter().map(|point| point.at).collect::<Vec<_>>(),
            [0.0, 100.0, 300.0, 400.0]
        );
        assert_eq!(Curve::new(&[]), None);
        assert_eq!(Curve::new(&[point(0.0, 0.0), point(10.0, 12.0)]), None);
        let curve = Curve::new(&[point(0.0, 0.0), point(100.0, -1.0)]).expect("increasing");
        // A hundred and one metres counted are a hundred; beyond, it goes on in the same way.
        assert!((curve.at(101.0) + 1.0).abs() < 1e-12 && (curve.at(202.0) + 2.0).abs() < 1e-12);
        assert_eq!(Curve::new(&[point(0.0, 3.0)]).map(|curve| curve.at(77.0)), Some(3.0));
        assert_eq!(within(&[0.0, 1.0, 2.0, 3.0, 4.0], (1.5, 2.5)), 1..4);
        assert_eq!(within(&[0.0, 1.0], (5.0, 9.0)), 1..2);
    }
}
