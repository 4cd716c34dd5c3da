//! By how much one record lies ahead of another along the axis: cross-correlation of several signals at once, with an interval.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::resample::{interpolate, uniform_grid};

/// One signal of both records: axis and samples of each, the axes increasing.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    pub simulated: (&'a [f64], &'a [f64]),
    pub measured: (&'a [f64], &'a [f64]),
    /// Signals with the same number are not independent of one another, such as a force and a sum that it is part of.
    pub group: usize,
}

/// The stretch compared, the farthest shift looked for and the grid of both, all in the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    pub start: f64,
    pub end: f64,
    pub farthest: f64,
    pub step: f64,
}

/// What is to be added to the measured axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub shift: f64,
    /// 95 % interval, from what parts of the stretch and what single signals say.
    pub low: f64,
    pub high: f64,
    /// Root of the mean square correlation of the signals there.
    pub correlation: f64,
}

/// Parts of the stretch that are left out in turn.
const BLOCKS: usize = 8;
/// Steps of the fine search for one of the coarse one.
const FINER: i64 = 10;

/// The shift at which the signals are most likely one another's, as far as both records reach.
///
/// It is looked for on the grid first, then ten times as finely about the best point.
///
/// The criterion is the likelihood of signals that differ by white noise of unknown size each: the sum of -ln(1 - r^2), so that
/// a signal that follows closely says more than one that hardly does. Between points of the grid the geometric mean of 1 - r^2
/// is taken as a parabola.
/// `None`: no signal varies, none follows, or the best shift lies at the end of what was looked at.
pub fn estimate(pairs: &[Pair<'_>], search: &Search) -> Option<Estimate> {
    let grid = uniform_grid(search.start, search.end, search.step).ok()?;
    let most = (search.farthest / search.step).floor().max(1.0) as i64;
    // As far as every measured record reaches on both sides.
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
    let fine = (-FINER..=FINER).map(|k| about + k as f64 * search.step / FINER as f64).filter(|shift| (first..=last).contains(shift));
    let fine = Searched::new(pairs, &grid, fine.collect(), false);
    let Best { shift, correlation } = fine.best(|_, _| false)?;
    let error = error(&fine, &coarse)?;
    Some(Estimate { shift, low: shift - error, high: shift + error, correlation })
}

/// Half the width of the interval.
///
/// Parts of the stretch and signals are both drawn from what might have been recorded, and a deviation can be common to a part
/// (the axis of a record stretched there) or to a signal (a phase that the model has wrong). So the variance is that of estimates
/// clustered both ways: jackknife without each part, plus without each group of signals, less without each group in each part,
/// which both hold (Cameron, Gelbach and Miller, "Robust inference with multiway clustering", 2011), and not below either.
/// Student's t has one degree of freedom less than the fewer of the two are. One group alone is taken at its word.
fn error(fine: &Searched, coarse: &Searched) -> Option<f64> {
    // What is left may be best farther away than the fine search reaches.
    let without = |left_out: &dyn Fn(usize, usize) -> bool| fine.best(left_out).or_else(|| coarse.best(left_out)).map(|best| best.shift);
    let mut groups: Vec<usize> = fine.groups.clone();
    groups.sort_unstable();
    groups.dedup();
    let count = groups.len();
    let of_parts = jackknife((0..BLOCKS).map(|part| without(&|_, at| at == part)))?;
    if count < 2 {
        return Some(student(BLOCKS - 1) * of_parts.sqrt());
    }
    let of_groups = jackknife(groups.iter().map(|group| without(&|of, _| of == *group)))?;
    let of_both = jackknife((0..count * BLOCKS).map(|cell| without(&|of, at| (of, at) == (groups[cell / BLOCKS], cell % BLOCKS))))?;
    let variance = (of_parts + of_groups - of_both).max(of_parts).max(of_groups);
    Some(student(BLOCKS.min(count) - 1) * variance.sqrt())
}

/// Variance of an estimate from those without one of its parts each. `None` where one of them is not to be had.
fn jackknife(left_out: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Vec<f64> = left_out.collect::<Option<_>>()?;
    let (n, mean) = (all.len() as f64, all.iter().sum::<f64>() / all.len() as f64);
    Some((n - 1.0) / n * all.iter().map(|one| (one - mean).powi(2)).sum::<f64>())
}

/// 97.5 % value of Student's t.
fn student(freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, freedom.max(1) as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

/// What a correlation is made of.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Sums {
    fn of(x: &[f64], y: &[f64]) -> Self {
        let mut sums = Self { n: x.len() as f64, ..Self::default() };
        for (x, y) in x.iter().zip(y) {
            sums.x += x;
            sums.y += y;
            sums.xx += x * x;
            sums.yy += y * y;
            sums.xy += x * y;
        }
        sums
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            n: self.n + other.n,
            x: self.x + other.x,
            y: self.y + other.y,
            xx: self.xx + other.xx,
            yy: self.yy + other.yy,
            xy: self.xy + other.xy,
        }
    }

    /// 0 where it is not defined.
    fn correlation(&self) -> f64 {
        let (xx, yy) = (self.xx - self.x * self.x / self.n, self.yy - self.y * self.y / self.n);
        let r = (self.xy - self.x * self.y / self.n) / (xx.max(0.0).sqrt() * yy.max(0.0).sqrt());
        if r.is_finite() { r.clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// Sums of each part of the stretch at each shift, the least first. `None` where a signal does not vary.
///
/// Shifts that are steps of the grid need one interpolation for all, others one each.
fn sums(pair: &Pair<'_>, grid: &[f64], shifts: &[f64], on_grid: bool) -> Option<Vec<[Sums; BLOCKS]>> {
    let (axis, values) = pair.measured;
    let (first, last) = (*axis.first()?, *axis.last()?);
    let simulated = centred(interpolate(pair.simulated.0, pair.simulated.1, grid).ok()?)?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let mut varies = false;
    // The grid reaches as far as the record does; rounding may put its ends just beyond.
    let mut under = |points: &mut dyn Iterator<Item = f64>| {
        let points: Vec<f64> = points.map(|x| x.clamp(first, last)).collect();
        let mut measured = interpolate(axis, values, &points).ok()?;
        measured.iter_mut().for_each(|value| *value -= mean);
        varies |= measured.iter().any(|value| (value - measured[0]).abs() > 1e-12 * (1.0 + mean.abs()));
        Some(measured)
    };
    let of_parts = |measured: &[f64]| {
        std::array::from_fn(|block| {
            let range = block * grid.len() / BLOCKS..(block + 1) * grid.len() / BLOCKS;
            Sums::of(&simulated[range.clone()], &measured[range])
        })
    };
    let found: Vec<[Sums; BLOCKS]> = if on_grid {
        let (farthest, step) = (*shifts.last()?, grid[1] - grid[0]);
        let wide = under(&mut (0..grid.len() + shifts.len() - 1).map(|k| grid[0] - farthest + k as f64 * step))?;
        (0..shifts.len()).map(|at| of_parts(&wide[shifts.len() - 1 - at..][..grid.len()])).collect()
    } else {
        shifts.iter().map(|shift| Some(of_parts(&under(&mut grid.iter().map(|x| x - shift))?))).collect::<Option<_>>()?
    };
    varies.then_some(found)
}

/// Less its mean, so that sums of squares keep their digits.
fn centred(mut values: Vec<f64>) -> Option<Vec<f64>> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values.iter().any(|value| value.abs() > 1e-12 * (1.0 + mean.abs())).then_some(values)
}

/// The best shift with the correlation there.
struct Best {
    shift: f64,
    correlation: f64,
}

/// Sums of every signal that varies in both records, at every shift looked at.
struct Searched {
    signals: Vec<Vec<[Sums; BLOCKS]>>,
    groups: Vec<usize>,
    shifts: Vec<f64>,
}

impl Searched {
    fn new(pairs: &[Pair<'_>], grid: &[f64], shifts: Vec<f64>, on_grid: bool) -> Self {
        let (signals, groups) = pairs.iter().filter_map(|pair| sums(pair, grid, &shifts, on_grid).map(|sums| (sums, pair.group))).unzip();
        Self { signals, groups, shifts }
    }

    /// The best shift, parts of signals of some groups left out. `None`: nothing follows, or it lies at the end.
    fn best(&self, left_out: impl Fn(usize, usize) -> bool) -> Option<Best> {
        let correlations = |at: usize| {
            let left_out = &left_out;
            self.signals.iter().zip(&self.groups).filter_map(move |(shifts, group)| {
                let kept = shifts[at].iter().enumerate().filter(|(part, _)| !left_out(*group, *part));
                let sums = kept.fold(Sums::default(), |all, (_, sums)| all.plus(sums));
                (sums.n > 0.0).then(|| sums.correlation().max(0.0))
            })
        };
        let score: Vec<f64> = (0..self.shifts.len()).map(|at| correlations(at).map(|r| -(1.0 - 0.999_999 * r * r).ln()).sum()).collect();
        let at = (0..score.len()).max_by(|a, b| score[*a].total_cmp(&score[*b]))?;
        if at == 0 || at + 1 == score.len() || score[at] <= 0.0 {
            return None;
        }
        // The score has a sharp peak where signals follow closely, which a parabola does not fit; what is left unexplained, the
        // geometric mean of 1 - r^2, is a parabola there at any size of noise.
        let count = correlations(at).count() as f64;
        let left = |at: usize| (-score[at] / count).exp();
        let (before, least, after) = (left(at - 1), left(at), left(at + 1));
        let bend = before - 2.0 * least + after;
        let between = if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
        let mean_square = correlations(at).map(|r| r * r).sum::<f64>() / count;
        let step = 0.5 * (self.shifts[at + 1] - self.shifts[at - 1]);
        Some(Best { shift: self.shifts[at] + between.clamp(-0.5, 0.5) * step, correlation: mean_square.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uneven waves, sampled at points of its own.
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
            let found = estimate(&pairs, &Search { start: 100.0, end: 250.0, farthest: 20.0, step: 0.25 }).expect("found");
            assert!((found.shift - shift).abs() < 0.03, "{shift}: {found:?}");
            assert!(found.low - 0.03 <= shift && shift <= found.high + 0.03 && found.correlation > 0.99, "{found:?}");
        }
    }

    /// Signals that lie wrong by a phase of their own, with waves that only one record has: the interval holds what was
    /// imposed about as often as it says.
    #[test]
    fn the_interval_holds_the_imposed_shift() {
        let mut state = 11_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let axis: Vec<f64> = (0..800).map(|k| k as f64 * 0.2).collect();
        let search = Search { start: 30.0, end: 130.0, farthest: 4.0, step: 0.2 };
        let (mut held, mut all) = (0, 0);
        for _ in 0..100 {
            let shift = 3.0 * (2.0 * uniform() - 1.0);
            let mut signals = Vec::new();
            for group in 0..6 {
                let mut waves = |amplitude: f64, count: usize| -> Vec<(f64, f64, f64)> {
                    (0..count)
                        .map(|_| (amplitude * uniform(), std::f64::consts::TAU / (3.0 + 30.0 * uniform().powi(2)), 6.3 * uniform()))
                        .collect()
                };
                let at = |waves: &[(f64, f64, f64)], x: f64| waves.iter().map(|(a, k, phase)| a * (k * x + phase).sin()).sum::<f64>();
                let (common, own) = (waves(1.0, 12), waves(0.4, 12));
                let wrong = 0.3 * (0..6).map(|_| uniform() - 0.5).sum::<f64>();
                let simulated: Vec<f64> = axis.iter().map(|x| at(&common, *x)).collect();
                let measured: Vec<f64> = axis.iter().map(|x| at(&common, x + shift + wrong) + at(&own, *x)).collect();
                // The second shares a part of the first.
                let sum: Vec<f64> = measured.iter().zip(&axis).map(|(y, x)| y + 0.3 * at(&common, 2.0 * x)).collect();
                signals.push((group, simulated.clone(), measured));
                signals.push((group, simulated, sum));
            }
            let pairs: Vec<Pair<'_>> =
                signals.iter().map(|(group, s, m)| Pair { simulated: (&axis, s), measured: (&axis, m), group: *group }).collect();
            if let Some(found) = estimate(&pairs, &search) {
                all += 1;
                held += usize::from((found.low..=found.high).contains(&shift));
            }
        }
        assert!(all >= 95 && held * 100 >= all * 90, "{held} of {all}");
    }

    #[test]
    fn what_cannot_be_told_is_not_told() {
        let axis: Vec<f64> = (0..1000).map(|k| k as f64).collect();
        let (flat, line) = (vec![3.0; 1000], axis.clone());
        let search = Search { start: 200.0, end: 700.0, farthest: 25.0, step: 0.5 };
        assert_eq!(estimate(&[], &search), None);
        assert_eq!(estimate(&[Pair { simulated: (&axis, &flat), measured: (&axis, &flat), group: 0 }], &search), None);
        // A straight line is as well correlated at every shift.
        let found = estimate(&[Pair { simulated: (&axis, &line), measured: (&axis, &line), group: 0 }], &search);
        assert!(found.is_none_or(|found| found.high - found.low >= 0.0));
    }
}
