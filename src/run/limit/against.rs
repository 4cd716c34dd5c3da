//! A number against a limit.

use crate::result::Direction;

/// Relative tolerance for rounding of units and sums. A value equal to its limit meets the limit.
const EQUAL: f64 = 1e-12;

/// Share of the limit used, and whether the limit is met.
pub fn against(value: f64, bound: f64, direction: Direction) -> (Option<f64>, bool) {
    let room = EQUAL * bound.abs();
    let holds = match direction {
        Direction::Magnitude => value.abs() <= bound + room,
        Direction::AtMost => value <= bound + room,
        Direction::AtLeast => value >= bound - room,
    };
    (direction.share(value, bound), holds)
}

/// Whether an interval contains values on both sides of a limit, so that the data do not decide.
/// For a limited magnitude, minus the limit counts as well.
pub fn spans((low, high): (f64, f64), bound: f64, direction: Direction) -> bool {
    let inside = |bound: f64| low < bound && bound < high;
    inside(bound) || direction == Direction::Magnitude && inside(-bound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use Direction::{AtLeast, AtMost, Magnitude};

    #[test]
    fn a_value_equal_to_its_limit_passes() {
        // 0.1 + 0.2 is one unit in the last place above 0.3.
        assert_eq!(against(0.1 + 0.2, 0.3, Magnitude), (Some((0.1 + 0.2) / 0.3), true));
        assert_eq!(against(-5.0, 5.0, Magnitude), (Some(1.0), true));
        assert!(!against(5.000_001, 5.0, Magnitude).1);
        assert_eq!(against(0.9, 0.9, AtLeast), (Some(1.0), true));
        assert_eq!(against(-0.2, -0.2, AtLeast), (Some(1.0), true));
        assert_eq!(against(0.1 + 0.2, 0.3, AtMost), (Some((0.1 + 0.2) / 0.3), true));
    }

    /// A correlation below zero, an estimated maximum below zero, and limits below zero.
    #[test]
    fn signs_count_where_the_limit_says_so() {
        assert_eq!(against(-55.4, 46.4, Magnitude), (Some(55.4 / 46.4), false));
        assert_eq!(against(-55.4, 46.4, AtMost), (Some(-55.4 / 46.4), true));
        assert_eq!(against(46.5, 46.4, AtMost), (Some(46.5 / 46.4), false));
        assert_eq!(against(0.4, 0.8, AtLeast), (Some(2.0), false));
        assert_eq!(against(0.0, 0.8, AtLeast), (None, false));
        assert_eq!(against(-0.84, 0.8, AtLeast), (None, false));
        assert_eq!(against(-2.0, -3.0, AtLeast), (Some(2.0 / 3.0), true));
        assert_eq!(against(-4.0, -3.0, AtLeast), (Some(4.0 / 3.0), false));
        assert_eq!(against(4.0, -3.0, AtLeast), (Some(0.0), true));
        assert_eq!(against(0.0, 0.0, AtLeast), (Some(0.0), true));
        assert_eq!(against(-1.0, 0.0, AtLeast), (None, false));
    }

    /// Shares say nothing of values below a least value of zero, nor of those above it.
    #[test]
    fn the_worst_value_is_the_farthest_beyond() {
        let worse = |a: f64, b: f64, bound: f64| {
            let of = |value| AtLeast.badness(value, bound, against(value, bound, AtLeast).1);
            of(a) > of(b)
        };
        assert!(worse(-3.6, -2.6, 0.0) && !worse(-2.6, -3.6, 0.0));
        assert!(worse(1.0, 2.0, 0.0) && worse(-0.1, 2.0, 0.0));
        assert!(worse(-0.5, -0.1, 0.8) && worse(-0.1, 0.1, 0.8) && worse(0.1, 0.2, 0.8));
    }

    #[test]
    fn an_interval_with_the_limit_inside_decides_nothing() {
        assert!(spans((0.9, 1.1), 1.0, Magnitude));
        assert!(spans((-1.1, -0.9), 1.0, Magnitude));
        assert!(spans((-2.0, 2.0), 1.0, Magnitude));
        assert!(!spans((-0.9, 0.9), 1.0, Magnitude));
        assert!(!spans((1.1, 2.0), 1.0, Magnitude));
        assert!(!spans((-1.1, -0.9), 1.0, AtMost));
        assert!(spans((0.8, 0.95), 0.9, AtLeast));
        assert!(!spans((-0.95, -0.8), 0.9, AtLeast));
    }
}
