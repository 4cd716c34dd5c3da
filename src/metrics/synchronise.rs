//! Shift between two records along the axis: cross-correlation of several signals together, with a
//! confidence interval.

mod sums;

use statrs::distribution::{ContinuousCDF, StudentsT};

use self::sums::Sums;
use super::{random_effects::between, resample::uniform_grid};

/// One signal of both records: axis and samples of each, with increasing axes.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    pub simulated: (&'a [f64], &'a [f64]),
    pub measured: (&'a [f64], &'a [f64]),
    /// Signals with the same group are not independent, such as a force and a sum that contains it.
    pub group: usize,
}

/// The range compared, the largest shift and the grid step, all in the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    pub start: f64,
    pub end: f64,
    pub farthest: f64,
    pub step: f64,
}

/// The shift to be added to the measured axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub shift: f64,
    /// 95 % interval, from the scatter between parts of the range and between signals.
    pub low: f64,
    pub high: f64,
    /// Root mean square correlation of the signals at this shift.
    pub correlation: f64,
}

/// Number of parts of the range that are left out one at a time.
const BLOCKS: usize = 8;
/// Steps of the fine search per coarse step. It also gives the number of coarse steps on either
/// side: the best shift of a single signal must be within this range, or the signal is not used.
const FINER: i64 = 5;
const REACH: i64 = 4;

/// The most likely shift, over the range that both records cover.
///
/// The search uses the grid first, then a finer one near the best point. The criterion is the
/// likelihood for signals that differ by white noise of unknown variance: the sum of -ln(1 - r^2).
/// A signal with high correlation thus has a large weight. Between grid points, the geometric mean
/// of 1 - r^2 is interpolated by a parabola.
///
/// `None` if no signal varies, none is correlated, or the best shift is at the end of the search
/// range.
pub fn estimate(pairs: &[Pair<'_>], search: &Search) -> Option<Estimate> {
    let grid = uniform_grid(search.start, search.end, search.step).ok()?;
    let most = (search.farthest / search.step).floor().max(1.0) as i64;
    // The range that every measured record covers on both sides.
    let reach = |lag: i64| {
        let shift = lag as f64 * search.step;
        pairs.iter().all(|pair| {
            let axis = pair.measured.0;
            axis.first().is_some_and(|first| first + shift <= grid[0])
                && axis.last().is_some_and(|last| last + shift >= grid[grid.len() - 1])
        })
    };
    let lags: Vec<i64> = (-most..=most).filter(|lag| reach(*lag)).collect();
    if lags.len() < 3 || grid.len() < 2 * BLOCKS {
        return None;
    }
    let shifts: Vec<f64> = lags.iter().map(|lag| *lag as f64 * search.step).collect();
    let coarse = Searched::new(pairs, &grid, shifts, true);
    let about = coarse.best(|_, _| false)?.shift;
    let (first, last) = (coarse.shifts[0], coarse.shifts[coarse.shifts.len() - 1]);
    let fine = (-FINER * REACH..=FINER * REACH)
        .map(|k| about + k as f64 * search.step / FINER as f64)
        .filter(|shift| (first..=last).contains(shift));
    let fine = Searched::new(pairs, &grid, fine.collect(), false);
    let Best { shift, correlation } = fine.best(|_, _| false)?;
    let error = error(&fine, shift)?;
    Some(Estimate { shift, low: shift - error, high: shift + error, correlation })
}

/// Half the width of the interval.
///
/// The estimate from all signals is a weighted mean of those from each group of signals. There are
/// two sources of error. First, parts of the section may have other shifts than the whole (a
/// stretched axis). This is the jackknife variance over the parts, which includes the noise of the
/// signals. Second, a group may have another shift than the others along the whole section (a wrong
/// phase in the model), which the parts do not show. This is the variance between groups of a
/// random-effects model. It is multiplied by the sum of the squared weights, which is 1 if one
/// group decides alone. Student's t has one degree of freedom less than the smaller number of parts
/// or groups. For a single group, only the first variance is used.
fn error(searched: &Searched, joint: f64) -> Option<f64> {
    let without = |part: usize, group: Option<usize>, near: f64| {
        searched
            .near(near, |of, at| at == part || group.is_some_and(|group| group != of))
            .map(|best| best.shift)
    };
    let of_parts = jackknife((0..BLOCKS).map(|part| without(part, None, joint)))?;
    let mut groups: Vec<usize> = searched.groups.clone();
    groups.sort_unstable();
    groups.dedup();
    let singles: Vec<(f64, f64, f64)> = groups
        .iter()
        .filter_map(|group| {
            let shift = searched.near(joint, |of, _| of != *group)?.shift;
            let own = jackknife((0..BLOCKS).map(|part| without(part, Some(*group), shift)))?;
            Some((shift, own, searched.weight(*group, joint)))
        })
        .collect();
    if singles.len() < 2 {
        return Some(student(BLOCKS - 1) * of_parts.sqrt());
    }
    let (shifts, own): (Vec<f64>, Vec<f64>) =
        singles.iter().map(|(shift, own, _)| (*shift, *own)).unzip();
    let between = between(&shifts, &own)?;
    let all: f64 = singles.iter().map(|(_, _, weight)| weight).sum();
    let squares: f64 = singles.iter().map(|(_, _, weight)| (weight / all).powi(2)).sum();
    Some(student(BLOCKS.min(singles.len()) - 1) * (of_parts + between * squares).sqrt())
}

/// Jackknife variance from the estimates without one part each. `None` if one of them is missing.
fn jackknife(left_out: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Vec<f64> = left_out.collect::<Option<_>>()?;
    let (n, mean) = (all.len() as f64, all.iter().sum::<f64>() / all.len() as f64);
    Some((n - 1.0) / n * all.iter().map(|one| (one - mean).powi(2)).sum::<f64>())
}

/// 97.5 % quantile of Student's t.
fn student(freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, freedom.max(1) as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

/// The best shift with the correlation there.
struct Best {
    shift: f64,
    correlation: f64,
}

/// Sums of every signal that varies in both records, at every shift of the search.
struct Searched {
    signals: Vec<Vec<[Sums; BLOCKS]>>,
    groups: Vec<usize>,
    shifts: Vec<f64>,
}

impl Searched {
    fn new(pairs: &[Pair<'_>], grid: &[f64], shifts: Vec<f64>, on_grid: bool) -> Self {
        let sums = sums::of_pairs(pairs, grid, &shifts, on_grid);
        let (signals, groups) = sums
            .into_iter()
            .zip(pairs)
            .filter_map(|(sums, pair)| Some((sums?, pair.group)))
            .unzip();
        Self { signals, groups, shifts }
    }

    /// Weight of a group in the best shift: the relative curvature of the unexplained variance of
    /// its signals at this shift.
    fn weight(&self, group: usize, best: f64) -> f64 {
        let near = |at: &usize| (self.shifts[*at] - best).abs();
        let at = (1..self.shifts.len() - 1).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap_or(1);
        let of = self.signals.iter().zip(&self.groups).filter(|(_, of)| **of == group).map(
            |(shifts, _)| {
                let [before, here, after] = [at - 1, at, at + 1].map(|at| {
                    shifts[at].iter().fold(Sums::default(), |all, sums| all.plus(sums)).left()
                });
                let weight = (before - 2.0 * here + after) / here;
                if weight.is_finite() { weight.max(0.0) } else { 0.0 }
            },
        );
        of.sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// The best shift without the parts and groups left out. `None` if no signal is correlated or
    /// the shift is at the end.
    fn best(&self, left_out: impl Fn(usize, usize) -> bool) -> Option<Best> {
        self.peak(left_out, |score| (0..score.len()).max_by(|a, b| score[*a].total_cmp(&score[*b])))
    }

    /// The local optimum nearest to a given shift; periodic signals have several.
    fn near(&self, shift: f64, left_out: impl Fn(usize, usize) -> bool) -> Option<Best> {
        self.peak(left_out, |score| {
            let peaks = (1..score.len().saturating_sub(1))
                .filter(|at| score[*at] >= score[at - 1] && score[*at] > score[at + 1]);
            peaks.min_by(|a, b| {
                (self.shifts[*a] - shift).abs().total_cmp(&(self.shifts[*b] - shift).abs())
            })
        })
    }

    fn peak(
        &self,
        left_out: impl Fn(usize, usize) -> bool,
        pick: impl Fn(&[f64]) -> Option<usize>,
    ) -> Option<Best> {
        let correlations = |at: usize| {
            let left_out = &left_out;
            self.signals.iter().zip(&self.groups).filter_map(move |(shifts, group)| {
                let kept =
                    shifts[at].iter().enumerate().filter(|(part, _)| !left_out(*group, *part));
                let sums = kept.fold(Sums::default(), |all, (_, sums)| all.plus(sums));
                (sums.n > 0.0).then(|| sums.correlation().max(0.0))
            })
        };
        let score: Vec<f64> = (0..self.shifts.len())
            .map(|at| correlations(at).map(|r| -(1.0 - 0.999_999 * r * r).ln()).sum())
            .collect();
        let at = pick(&score)?;
        if at == 0 || at + 1 == score.len() || score[at] <= 0.0 {
            return None;
        }
        // The score has a sharp peak for well correlated signals, which a parabola does not fit.
        // The geometric mean of 1 - r^2 (unexplained variance) is close to a parabola at any noise
        // level.
        let count = correlations(at).count() as f64;
        let left = |at: usize| (-score[at] / count).exp();
        let (before, least, after) = (left(at - 1), left(at), left(at + 1));
        let bend = before - 2.0 * least + after;
        let between = if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        let mean_square = correlations(at).map(|r| r * r).sum::<f64>() / count;
        let step = 0.5 * (self.shifts[at + 1] - self.shifts[at - 1]);
        Some(Best {
            shift: self.shifts[at] + between.clamp(-0.5, 0.5) * step,
            correlation: mean_square.sqrt(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of waves without a common period.
    fn wave(x: f64) -> f64 {
        (0.31 * x).sin() + 0.6 * (0.117 * x + 1.0).sin() + 0.3 * (0.73 * x + 2.0).cos()
    }

    #[test]
    fn a_known_shift_is_found_between_grid_points() {
        let simulated: Vec<f64> = (0..2000).map(|k| k as f64 * 0.2).collect();
        for shift in [-7.3, -0.4, 0.0, 3.13, 11.0] {
            let measured: Vec<f64> = (0..1700).map(|k| k as f64 * 0.23).collect();
            let (s, m) = (
                simulated.iter().map(|x| wave(*x)).collect::<Vec<_>>(),
                measured.iter().map(|x| 40.0 + wave(*x + shift)).collect::<Vec<_>>(),
            );
            let pairs = [Pair { simulated: (&simulated, &s), measured: (&measured, &m), group: 0 }];
            let found =
                estimate(&pairs, &Search { start: 100.0, end: 250.0, farthest: 20.0, step: 0.25 })
                    .expect("found");
            assert!((found.shift - shift).abs() < 0.03, "{shift}: {found:?}");
            assert!(
                found.low - 0.03 <= shift && shift <= found.high + 0.03 && found.correlation > 0.99,
                "{found:?}"
            );
        }
    }

    /// Steps of half a metre: the parabola finds shifts between them.
    #[test]
    fn the_best_shift_lies_between_those_looked_at() {
        let axis: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.05).collect();
        let simulated: Vec<f64> = axis.iter().map(|x| wave(*x)).collect();
        let shifts: Vec<f64> = (-8..=8).map(|k| 0.5 * f64::from(k)).collect();
        for shift in [-1.37, 0.21, 0.9] {
            let measured: Vec<f64> = axis.iter().map(|x| wave(x + shift)).collect();
            let pairs =
                [Pair { simulated: (&axis, &simulated), measured: (&axis, &measured), group: 0 }];
            let best = Searched::new(&pairs, &axis[400..1600], shifts.clone(), false)
                .best(|_, _| false)
                .expect("found");
            assert!((best.shift - shift).abs() < 0.02, "{shift}: {}", best.shift);
        }
    }

    /// A signal that is constant in one record gives no information on the shift or on the
    /// correlation of the others.
    #[test]
    fn a_signal_that_does_not_vary_changes_nothing() {
        let axis: Vec<f64> = (0..1500).map(|k| f64::from(k) * 0.2).collect();
        let (s, m): (Vec<f64>, Vec<f64>) = axis.iter().map(|x| (wave(*x), wave(x + 1.3))).unzip();
        let still = vec![2.0; axis.len()];
        let follows = Pair { simulated: (&axis, &s), measured: (&axis, &m), group: 0 };
        let search = Search { start: 100.0, end: 200.0, farthest: 5.0, step: 0.2 };
        let alone = estimate(&[follows], &search).expect("found");
        for (simulated, measured) in [(&s, &still), (&still, &m)] {
            let other =
                Pair { simulated: (&axis, simulated), measured: (&axis, measured), group: 1 };
            assert_eq!(estimate(&[follows, other], &search), Some(alone));
        }
    }

    /// Signals with phase errors of their own and with waves in one record only. The interval
    /// contains the imposed shift about as often as stated, for signals of equal and of very
    /// different correlation.
    #[test]
    fn the_interval_holds_the_imposed_shift() {
        for noise in [[1.0; 6], [0.1, 0.3, 1.0, 2.0, 0.5, 3.0]] {
            let (held, all, width) = held(noise);
            assert!(all >= 95 && held * 100 >= all * 91, "{held} of {all}");
            // An interval as wide as the search would contain everything; the mean widths here are
            // 0.55 and 0.86 m.
            assert!(width < 1.0, "{width}");
        }
    }

    /// Number of intervals that contain the shift, number of intervals, and their mean width.
    fn held(noise: [f64; 6]) -> (usize, usize, f64) {
        let mut state = 11_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let axis: Vec<f64> = (0..800).map(|k| k as f64 * 0.2).collect();
        let search = Search { start: 30.0, end: 130.0, farthest: 4.0, step: 0.2 };
        let (mut held, mut all, mut width) = (0, 0, 0.0);
        for _ in 0..100 {
            let shift = 3.0 * (2.0 * uniform() - 1.0);
            let mut signals = Vec::new();
            for (group, noise) in noise.iter().enumerate() {
                let mut waves = |amplitude: f64, count: usize| -> Vec<(f64, f64, f64)> {
                    (0..count)
                        .map(|_| {
                            (
                                amplitude * uniform(),
                                std::f64::consts::TAU / (3.0 + 30.0 * uniform().powi(2)),
                                6.3 * uniform(),
                            )
                        })
                        .collect()
                };
                let at = |waves: &[(f64, f64, f64)], x: f64| {
                    waves.iter().map(|(a, k, phase)| a * (k * x + phase).sin()).sum::<f64>()
                };
                let (common, own) = (waves(1.0, 12), waves(0.4 * noise, 12));
                let wrong = 0.3 * (0..6).map(|_| uniform() - 0.5).sum::<f64>();
                let simulated: Vec<f64> = axis.iter().map(|x| at(&common, *x)).collect();
                let measured: Vec<f64> =
                    axis.iter().map(|x| at(&common, x + shift + wrong) + at(&own, *x)).collect();
                // The second signal shares a part with the first.
                let sum: Vec<f64> = measured
                    .iter()
                    .zip(&axis)
                    .map(|(y, x)| y + 0.3 * at(&common, 2.0 * x))
                    .collect();
                signals.push((group, simulated.clone(), measured));
                signals.push((group, simulated, sum));
            }
            let pairs: Vec<Pair<'_>> = signals
                .iter()
                .map(|(group, s, m)| Pair {
                    simulated: (&axis, s),
                    measured: (&axis, m),
                    group: *group,
                })
                .collect();
            if let Some(found) = estimate(&pairs, &search) {
                all += 1;
                width += found.high - found.low;
                held += usize::from((found.low..=found.high).contains(&shift));
            }
        }
        (held, all, width / all as f64)
    }

    #[test]
    fn what_cannot_be_told_is_not_told() {
        let axis: Vec<f64> = (0..1000).map(|k| k as f64).collect();
        let (flat, line) = (vec![3.0; 1000], axis.clone());
        let search = Search { start: 200.0, end: 700.0, farthest: 25.0, step: 0.5 };
        assert_eq!(estimate(&[], &search), None);
        assert_eq!(
            estimate(
                &[Pair { simulated: (&axis, &flat), measured: (&axis, &flat), group: 0 }],
                &search
            ),
            None
        );
        // A straight line has the same correlation at every shift.
        let found = estimate(
            &[Pair { simulated: (&axis, &line), measured: (&axis, &line), group: 0 }],
            &search,
        );
        assert!(found.is_none_or(|found| found.high - found.low >= 0.0));
    }
}
