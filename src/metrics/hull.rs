//! The convex hull of points in any number of dimensions: whether another point lies in it, and the
//! nearest point of it.
//!
//! The hull is never built. The nearest point is the combination of the points, with weights that
//! are not negative and have the sum 1, whose distance is smallest: a quadratic program, solved
//! exactly in a finite number of steps. Source: P. Wolfe, "Finding the nearest point in a
//! polytope", Mathematical Programming 11 (1976).

use nalgebra::{DMatrix, DVector};

/// A point this far from the hull or nearer lies in it, where every coordinate has the range 1:
/// what 16 digits leave of a difference of numbers of that size, with room for the digits that a
/// table gives.
pub const INSIDE: f64 = 1e-9;
/// Points lie in a plane of fewer dimensions when the smallest singular value of their coordinates,
/// each about its mean, is below this part of the largest: the rest is rounding. The same as of
/// collinear regressors.
const FLAT: f64 = 1e-10;
/// The search ends when no point lies further towards the wanted one than this part of the squared
/// size of the points: rounding of a sum of squares.
const ROUNDING: f64 = 1e-14;
/// Weights below this are zero: rounding of the equations for them.
const NO_WEIGHT: f64 = 1e-12;
/// Most steps of the search for each point and dimension. It is finite without a bound; rounding
/// alone could make it go round.
const STEPS: usize = 20;

/// The nearest point of a hull.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    pub point: Vec<f64>,
    /// Euclidean; 0 inside.
    pub distance: f64,
}

impl Nearest {
    /// Whether the point that was looked for lies in the hull. Coordinates have ranges of about 1.
    pub fn is_inside(&self) -> bool {
        self.distance <= INSIDE
    }
}

/// The point of the hull of some points that is nearest to `wanted`; `None` without points, or if a
/// number is not finite.
pub fn nearest(points: &[Vec<f64>], wanted: &[f64]) -> Option<Nearest> {
    let finite = points
        .iter()
        .all(|point| point.len() == wanted.len() && point.iter().all(|value| value.is_finite()));
    if !finite || wanted.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let from: Vec<DVector<f64>> = points
        .iter()
        .map(|point| {
            DVector::from_iterator(
                wanted.len(),
                point.iter().zip(wanted).map(|(point, wanted)| point - wanted),
            )
        })
        .collect();
    let size = from.iter().map(DVector::norm_squared).fold(0.0, f64::max);
    let first = (0..from.len())
        .min_by(|a, b| from[*a].norm_squared().total_cmp(&from[*b].norm_squared()))?;
    let mut used = vec![first];
    let mut weights = vec![1.0];
    let mut found = from[first].clone();
    for _ in 0..STEPS * (points.len() + wanted.len()) {
        let next =
            (0..from.len()).min_by(|a, b| found.dot(&from[*a]).total_cmp(&found.dot(&from[*b])))?;
        if found.dot(&from[next]) >= found.norm_squared() - ROUNDING * size || used.contains(&next)
        {
            break;
        }
        used.push(next);
        weights.push(0.0);
        settle(&from, &mut used, &mut weights);
        found = combined(&from, &used, &weights);
    }
    let distance = found.norm();
    let point = found.iter().zip(wanted).map(|(part, wanted)| part + wanted).collect();
    distance.is_finite().then_some(Nearest { point, distance })
}

/// Moves the weights to the nearest point of the plane through the points used; a point whose
/// weight would become negative on the way is used no longer.
fn settle(from: &[DVector<f64>], used: &mut Vec<usize>, weights: &mut Vec<f64>) {
    while used.len() > 1 {
        let Some(wanted) = of_plane(from, used) else { return };
        if wanted.iter().all(|weight| *weight > NO_WEIGHT) {
            *weights = wanted;
            return;
        }
        // As far towards it as all weights stay non-negative; the first that reaches 0 leaves.
        let reach = |(weight, wanted): (&f64, &f64)| {
            if weight - wanted > 0.0 { weight / (weight - wanted) } else { f64::INFINITY }
        };
        let share = weights
            .iter()
            .zip(&wanted)
            .filter(|(_, wanted)| **wanted <= NO_WEIGHT)
            .map(reach)
            .fold(1.0, f64::min);
        let moved: Vec<f64> = weights
            .iter()
            .zip(&wanted)
            .map(|(weight, wanted)| weight + share * (wanted - weight))
            .collect();
        let least = (0..moved.len()).min_by(|a, b| moved[*a].total_cmp(&moved[*b]));
        let kept: Vec<usize> =
            (0..moved.len()).filter(|at| moved[*at] > NO_WEIGHT && Some(*at) != least).collect();
        let sum: f64 = kept.iter().map(|at| moved[*at]).sum();
        if kept.is_empty() || sum <= 0.0 {
            return;
        }
        *weights = kept.iter().map(|at| moved[*at] / sum).collect();
        *used = kept.iter().map(|at| used[*at]).collect();
    }
    if let [one] = weights.as_mut_slice() {
        *one = 1.0;
    }
}

/// The weights, of any sign and with the sum 1, of the point nearest to the origin in the plane
/// through some points.
fn of_plane(from: &[DVector<f64>], used: &[usize]) -> Option<Vec<f64>> {
    let (first, rest) = used.split_first()?;
    let edges = DMatrix::from_columns(
        &rest.iter().map(|at| &from[*at] - &from[*first]).collect::<Vec<_>>(),
    );
    let along = edges.svd(true, true).solve(&-&from[*first], FLAT).ok()?;
    let mut weights = vec![1.0 - along.sum()];
    weights.extend(along.iter());
    weights.iter().all(|weight| weight.is_finite()).then_some(weights)
}

fn combined(from: &[DVector<f64>], used: &[usize], weights: &[f64]) -> DVector<f64> {
    let mut sum = DVector::zeros(from[used[0]].len());
    used.iter().zip(weights).for_each(|(at, weight)| sum.axpy(*weight, &from[*at], 1.0));
    sum
}

/// In how many dimensions points extend: 0 if all are the same, 1 on a line, 2 in a plane.
pub fn dimensions(points: &[Vec<f64>]) -> usize {
    let Some(width) = points.first().map(Vec::len).filter(|width| *width > 0) else { return 0 };
    let mean: Vec<f64> = (0..width)
        .map(|at| points.iter().map(|point| point[at]).sum::<f64>() / points.len() as f64)
        .collect();
    let about = DMatrix::from_fn(points.len(), width, |row, at| points[row][at] - mean[at]);
    let singular = about.singular_values();
    let largest = singular.iter().copied().fold(0.0, f64::max);
    singular.iter().filter(|value| **value > FLAT * largest.max(1.0)).count()
}

/// For each point whether it is a corner of the hull; of several that are the same, the first.
pub fn corners(points: &[Vec<f64>]) -> Vec<bool> {
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= INSIDE);
    let corner = |at: usize| {
        if points[..at].iter().any(|before| same(before, &points[at])) {
            return false;
        }
        let others: Vec<Vec<f64>> =
            points.iter().filter(|other| !same(other, &points[at])).cloned().collect();
        nearest(&others, &points[at]).is_none_or(|found| !found.is_inside())
    };
    (0..points.len()).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn square() -> Vec<Vec<f64>> {
        vec![
            vec![0.0, 0.0],
            vec![1.0, 0.0],
            vec![1.0, 1.0],
            vec![0.0, 1.0],
            vec![0.5, 0.5],
            vec![0.5, 0.0],
        ]
    }

    #[track_caller]
    fn assert_nearest(points: &[Vec<f64>], wanted: &[f64], point: &[f64], distance: f64) {
        let found = nearest(points, wanted).expect("a point");
        assert!((found.distance - distance).abs() < 1e-12, "{found:?}");
        assert!(found.point.iter().zip(point).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn the_nearest_point_is_inside_on_an_edge_or_a_corner() {
        assert_nearest(&square(), &[0.3, 0.9], &[0.3, 0.9], 0.0);
        assert_nearest(&square(), &[0.25, 1.5], &[0.25, 1.0], 0.5);
        assert_nearest(&square(), &[4.0, 5.0], &[1.0, 1.0], 5.0);
        assert_nearest(&[vec![2.0]], &[5.0], &[2.0], 3.0);
        assert_nearest(
            &[vec![0.0, 0.0, 0.0], vec![3.0, 3.0, 3.0]],
            &[2.0, 1.0, 0.0],
            &[1.0, 1.0, 1.0],
            2f64.sqrt(),
        );
        assert_eq!(nearest(&[], &[1.0]), None);
        assert_eq!(nearest(&[vec![f64::NAN]], &[1.0]), None);
    }

    #[test]
    fn flat_points_and_corners_are_found() {
        assert_eq!(corners(&square()), [true, true, true, true, false, false]);
        assert_eq!(dimensions(&square()), 2);
        assert_eq!(dimensions(&[vec![0.0, 1.0], vec![0.5, 1.5], vec![1.0, 2.0]]), 1);
        assert_eq!(dimensions(&[vec![0.1, 0.1], vec![0.1, 0.1]]), 0);
        assert_eq!(
            corners(&[vec![0.0], vec![0.0], vec![1.0], vec![0.5]]),
            [true, false, true, false]
        );
    }

    proptest! {
        /// No point of the hull is nearer: seen from the nearest point, all points lie on the far
        /// side.
        #[test]
        fn nothing_is_nearer(points in prop::collection::vec(prop::collection::vec(0.0..1.0f64, 3), 1..30), wanted in prop::collection::vec(-1.0..2.0f64, 3)) {
            let found = nearest(&points, &wanted).expect("a point");
            let away: Vec<f64> = found.point.iter().zip(&wanted).map(|(a, b)| a - b).collect();
            for point in &points {
                let behind: f64 = point.iter().zip(&found.point).zip(&away).map(|((p, n), a)| (p - n) * a).sum();
                prop_assert!(behind >= -1e-10, "{behind}");
            }
            // The point itself is a point of the hull.
            prop_assert!(nearest(&points, &found.point).expect("a point").distance < 1e-9);
        }

        #[test]
        fn a_mixture_of_the_points_is_inside(points in prop::collection::vec(prop::collection::vec(0.0..1.0f64, 4), 1..20), weights in prop::collection::vec(0.01..1.0f64, 20)) {
            let sum: f64 = weights.iter().take(points.len()).sum();
            let mixed: Vec<f64> = (0..4).map(|at| points.iter().zip(&weights).map(|(p, w)| p[at] * w / sum).sum()).collect();
            prop_assert!(nearest(&points, &mixed).expect("a point").is_inside());
        }
    }
}
