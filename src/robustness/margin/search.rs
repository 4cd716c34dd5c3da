//! The nearest change that flips a verdict: looked for on a grid, one side at a time, then bisected.

use crate::result::{
    Reason, Verdict,
    margin::{Margin, Searched},
};
use crate::units::number::significant;

/// Width of the bracket at which a bisection ends, as a share of the change, or of a step of the
/// grid where that is larger.
pub const CLOSE: f64 = 1e-3;

/// Digits of a point of the grid.
const DIGITS: usize = 12;

/// Tolerance for the number of steps that fit.
const ROUNDING: f64 = 1e-9;

/// A grid of changes on both sides of none.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// The largest changes, both from 0 on.
    pub below: f64,
    pub above: f64,
    pub step: f64,
    /// Between two steps lie no other changes.
    pub whole: bool,
}

/// The verdict at a change; or why it has none, where the search ends.
pub type At<'a> = &'a dyn Fn(f64) -> Result<Verdict, Reason>;

/// What was found on one side.
struct Side {
    /// The largest change with the verdict as it is, and the verdict just beyond.
    flip: Option<(f64, Verdict)>,
    /// How far the verdict was looked at.
    reached: f64,
    ended: Option<Reason>,
}

impl Grid {
    /// The margin with what is found on both sides.
    pub fn margin(&self, margin: Margin, verdict: Verdict, at: At<'_>) -> Margin {
        let (low, high) =
            (self.side(verdict, -1.0, self.below, at), self.side(verdict, 1.0, self.above, at));
        Margin {
            low: low.flip.map(|(at, _)| at),
            high: high.flip.map(|(at, _)| at),
            verdict_low: low.flip.map(|(_, verdict)| verdict),
            verdict_high: high.flip.map(|(_, verdict)| verdict),
            exact: self.whole,
            searched: Some(Searched { from: low.reached, to: high.reached, step: self.step }),
            reason: low.ended.or(high.ended),
            ..margin
        }
    }

    fn side(&self, verdict: Verdict, sign: f64, farthest: f64, at: At<'_>) -> Side {
        let steps = (farthest / self.step * (1.0 + ROUNDING)).floor() as usize;
        let mut inner = 0.0;
        for number in 1..=steps {
            // Multiples of a decimal step are printed as they are meant.
            let outer = significant(sign * number as f64 * self.step, DIGITS);
            match at(outer) {
                Ok(found) if found == verdict => inner = outer,
                Ok(found) => {
                    let flip = self.bisected(verdict, [inner, outer], found, at);
                    return Side { flip: Some(flip), reached: outer, ended: None };
                }
                Err(reason) => return Side { flip: None, reached: inner, ended: Some(reason) },
            }
        }
        Side { flip: None, reached: inner, ended: None }
    }

    fn bisected(
        &self,
        verdict: Verdict,
        [mut inner, mut outer]: [f64; 2],
        mut beyond: Verdict,
        at: At<'_>,
    ) -> (f64, Verdict) {
        if self.whole {
            return (inner, beyond);
        }
        while (outer - inner).abs() > CLOSE * outer.abs().max(self.step) {
            let middle = 0.5 * (inner + outer);
            match at(middle) {
                Ok(found) if found == verdict => inner = middle,
                Ok(found) => (outer, beyond) = (middle, found),
                Err(_) => break,
            }
        }
        (inner, beyond)
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a number.
pub fn round_step(most: f64) -> f64 {
    let power = 10_f64.powf(most.log10().floor());
    let digit = [5.0, 2.0].into_iter().find(|digit| digit * power <= most * (1.0 + ROUNDING));
    // Powers below one have no exact decimals: the digits printed are those meant.
    let exact = format!("{:e}", digit.unwrap_or(1.0) * power);
    format!("{:.0e}", exact.parse::<f64>().unwrap_or(power)).parse().unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::margin::Changed;

    fn found(grid: Grid, at: impl Fn(f64) -> Result<Verdict, Reason>) -> Margin {
        grid.margin(Margin::new(Changed::Gain, "x", "%"), Verdict::Validated, &at)
    }

    const GRID: Grid = Grid { below: 10.0, above: 10.0, step: 1.0, whole: false };

    #[test]
    fn a_flip_is_bisected_from_the_side_on_which_the_verdict_stays() {
        let margin = found(GRID, |x| {
            Ok(if (-9.03..=4.2).contains(&x) { Verdict::Validated } else { Verdict::NotValidated })
        });
        let (low, high) = (margin.low.expect("a flip"), margin.high.expect("a flip"));
        assert!((-9.03..=-9.03 * (1.0 - CLOSE)).contains(&low), "{low}");
        assert!((4.2 * (1.0 - 1.01 * CLOSE)..=4.2).contains(&high), "{high}");
        assert_eq!(margin.verdict_low, Some(Verdict::NotValidated));
        assert_eq!(margin.searched, Some(Searched { from: -10.0, to: 5.0, step: 1.0 }));
    }

    #[test]
    fn of_a_verdict_that_changes_back_and_forth_the_nearest_flip_on_the_grid_counts() {
        // It changes at 2.5 and back at 4.5, and again at 7.
        let margin = found(GRID, |x| {
            let other = (2.5..4.5).contains(&x) || x > 7.0;
            Ok(if other { Verdict::NotValidated } else { Verdict::Validated })
        });
        let high = margin.high.expect("a flip");
        assert!((high - 2.5).abs() < 0.003, "{high}");
        assert_eq!(margin.low, None);
        // What lies between two points of the grid is not seen, and the margin is not exact.
        let narrow = found(GRID, |x| {
            let other = (2.4..2.6).contains(&x) || x > 7.0;
            Ok(if other { Verdict::NotValidated } else { Verdict::Validated })
        });
        assert!((narrow.high.expect("a flip") - 7.0).abs() < 0.01);
        assert!(!narrow.exact);
    }

    #[test]
    fn a_search_ends_where_there_is_no_verdict() {
        let margin = found(GRID, |x| match x > 3.5 {
            true => Err(Reason::SectionAlone),
            false => Ok(Verdict::Validated),
        });
        assert_eq!((margin.high, margin.reason), (None, Some(Reason::SectionAlone)));
        assert_eq!(margin.searched, Some(Searched { from: -10.0, to: 3.0, step: 1.0 }));
        let counts = Grid { below: 3.0, above: 8.0, step: 1.0, whole: true };
        let margin = found(counts, |x| {
            Ok(if x < 6.0 { Verdict::Validated } else { Verdict::NotAssessable })
        });
        assert_eq!((margin.low, margin.high, margin.exact), (None, Some(5.0), true));
    }

    #[test]
    fn steps_are_round() {
        for (most, step) in [(0.9, 0.5), (1.0, 1.0), (2.3, 2.0), (74.0, 50.0), (0.000_31, 0.0002)] {
            assert_eq!(round_step(most), step, "{most}");
        }
    }
}
