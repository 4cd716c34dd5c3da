//! By how much one record lies ahead of another along the axis: cross-correlation of several signals at once, with an interval.

use super::resample::{interpolate, uniform_grid};

/// One signal of both records: axis and samples of each, the axes increasing.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    pub simulated: (&'a [f64], &'a [f64]),
    pub measured: (&'a [f64], &'a [f64]),
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
    /// 95 % interval: jackknife over eighths of the stretch.
    pub low: f64,
    pub high: f64,
    /// Root of the mean square correlation of the signals there.
    pub correlation: f64,
}

/// Parts of the stretch that are left out in turn.
const BLOCKS: usize = 8;
/// 97.5 % value of Student's t with `BLOCKS` - 1 degrees of freedom.
const STUDENT: f64 = 2.364_624;

/// The shift at which the signals are most likely one another's, as far as both records reach.
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
    let signals: Vec<Vec<[Sums; BLOCKS]>> = pairs.iter().filter_map(|pair| sums(pair, &grid, &lags, search.step)).collect();
    if signals.is_empty() {
        return None;
    }
    let (shift, correlation) = best(&signals, &lags, search.step, None)?;
    let left_out: Vec<f64> =
        (0..BLOCKS).map(|block| best(&signals, &lags, search.step, Some(block)).map(|(shift, _)| shift)).collect::<Option<_>>()?;
    let mean = left_out.iter().sum::<f64>() / BLOCKS as f64;
    let spread = left_out.iter().map(|shift| (shift - mean).powi(2)).sum::<f64>();
    let error = (spread * (BLOCKS - 1) as f64 / BLOCKS as f64).sqrt();
    Some(Estimate { shift, low: shift - STUDENT * error, high: shift + STUDENT * error, correlation })
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

/// Sums of each part of the stretch at each lag. `None` where a signal does not vary.
fn sums(pair: &Pair<'_>, grid: &[f64], lags: &[i64], step: f64) -> Option<Vec<[Sums; BLOCKS]>> {
    let (first, last) = (*lags.first()?, *lags.last()?);
    let wide: Vec<f64> = (-last..grid.len() as i64 - first).map(|k| grid[0] + k as f64 * step).collect();
    // The grid reaches as far as the records do; rounding may put its ends just beyond.
    let inside: Vec<f64> = wide.iter().map(|x| x.clamp(pair.measured.0[0], pair.measured.0[pair.measured.0.len() - 1])).collect();
    let simulated = centred(interpolate(pair.simulated.0, pair.simulated.1, grid).ok()?)?;
    let measured = centred(interpolate(pair.measured.0, pair.measured.1, &inside).ok()?)?;
    let at_lag = |lag: &i64| {
        // Measured at x - lag: the point `last - lag` of the wide grid stands under the first of the stretch.
        let from = (last - lag) as usize;
        std::array::from_fn(|block| {
            let range = block * grid.len() / BLOCKS..(block + 1) * grid.len() / BLOCKS;
            Sums::of(&simulated[range.clone()], &measured[from + range.start..from + range.end])
        })
    };
    Some(lags.iter().map(at_lag).collect())
}

/// Less its mean, so that sums of squares keep their digits.
fn centred(mut values: Vec<f64>) -> Option<Vec<f64>> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values.iter().any(|value| value.abs() > 1e-12 * (1.0 + mean.abs())).then_some(values)
}

/// The best shift and the correlation there, one part left out if asked for.
fn best(signals: &[Vec<[Sums; BLOCKS]>], lags: &[i64], step: f64, without: Option<usize>) -> Option<(f64, f64)> {
    let correlations = |at: usize| {
        signals.iter().map(move |lags| {
            let kept = lags[at].iter().enumerate().filter(|(block, _)| Some(*block) != without);
            kept.fold(Sums::default(), |all, (_, sums)| all.plus(sums)).correlation().max(0.0)
        })
    };
    let score: Vec<f64> = (0..lags.len()).map(|at| correlations(at).map(|r| -(1.0 - 0.999_999 * r * r).ln()).sum()).collect();
    let at = (0..score.len()).max_by(|a, b| score[*a].total_cmp(&score[*b]))?;
    if at == 0 || at + 1 == score.len() || score[at] <= 0.0 {
        return None;
    }
    // The score has a sharp peak where signals follow closely, which a parabola does not fit; what is left unexplained, the
    // geometric mean of 1 - r^2, is a parabola there at any size of noise.
    let left = |at: usize| (-score[at] / signals.len() as f64).exp();
    let (before, least, after) = (left(at - 1), left(at), left(at + 1));
    let bend = before - 2.0 * least + after;
    let between = if bend > 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
    let mean_square = correlations(at).map(|r| r * r).sum::<f64>() / signals.len() as f64;
    Some(((lags[at] as f64 + between.clamp(-0.5, 0.5)) * step, mean_square.sqrt()))
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
            let pairs = [Pair { simulated: (&simulated, &s), measured: (&measured, &m) }];
            let found = estimate(&pairs, &Search { start: 100.0, end: 250.0, farthest: 20.0, step: 0.25 }).expect("found");
            assert!((found.shift - shift).abs() < 0.03, "{shift}: {found:?}");
            assert!(found.low - 0.03 <= shift && shift <= found.high + 0.03 && found.correlation > 0.99, "{found:?}");
        }
    }

    #[test]
    fn what_cannot_be_told_is_not_told() {
        let axis: Vec<f64> = (0..1000).map(|k| k as f64).collect();
        let (flat, line) = (vec![3.0; 1000], axis.clone());
        let search = Search { start: 200.0, end: 700.0, farthest: 25.0, step: 0.5 };
        assert_eq!(estimate(&[], &search), None);
        assert_eq!(estimate(&[Pair { simulated: (&axis, &flat), measured: (&axis, &flat) }], &search), None);
        // A straight line is as well correlated at every shift.
        let found = estimate(&[Pair { simulated: (&axis, &line), measured: (&axis, &line) }], &search);
        assert!(found.is_none_or(|found| found.high - found.low >= 0.0));
    }
}
