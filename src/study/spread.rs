//! Exact order statistics of a large set of values, storing only candidates for the required ranks.
//!
//! An evenly distributed sample estimates the quartiles. One pass over all rows counts the values
//! below these estimates and stores those near them. If a quartile is not among the stored values,
//! the pass is repeated with wider windows, so that the result is always exact.

use super::{
    fails::Fails,
    groups::{Block, Row, Sorted, groups},
    halves::Form,
    listed::{Listed, ranks},
    pilot::{at, sample},
    window::Window,
};

/// Order statistics of all values.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    pub listed: Listed,
    /// Row and column of the minimum and of the maximum.
    pub at_min: (u32, u32),
    pub at_max: (u32, u32),
}

/// Three for the quartiles, two for the ends of the whiskers.
const WINDOWS: usize = 5;

/// Range in which a limit is met.
#[derive(Debug)]
pub struct Limit<'a> {
    pub low: f64,
    pub high: f64,
    pub fails: &'a mut Fails,
    /// Number of values outside it.
    pub count: u64,
}

/// Half the width of a window, as a share of the values, for sums of two and of more parts.
/// Determined by trial, since the error of the sample has no simple law; a pass that misses is
/// repeated.
const MARGIN: (f64, f64) = (0.0008, 0.0045);
/// Sample size for which the margins hold: six times the square root of 13.8 million.
const MARGIN_FOR: f64 = 18_600.0;

/// Order statistics of all values of some blocks, mapped by their form. Values outside the limit
/// are marked in the same pass.
///
/// The result is the same on every processor: vector instructions give the same sums, and no
/// operations are fused.
pub fn order(blocks: &[Block], form: Form, limit: Option<&mut Limit<'_>>) -> Option<Order> {
    pulp::Arch::new().dispatch(|| swept(blocks, form, limit))
}

#[inline(always)]
fn swept(blocks: &[Block], form: Form, mut limit: Option<&mut Limit<'_>>) -> Option<Order> {
    let count: u64 =
        blocks.iter().map(|block| block.rows.len() as u64 * block.columns.len() as u64).sum();
    if count == 0 {
        return None;
    }
    let sample = sample(blocks, count);
    let flat = blocks.iter().all(|block| block.rows.iter().all(|row| row.c == 0.0));
    let mut margin =
        if flat { MARGIN.0 } else { MARGIN.1 } * (MARGIN_FOR / sample.len() as f64).powf(0.6);
    loop {
        let mut sweep = Sweep::new(&sample, margin, count, form);
        for block in blocks {
            groups(block, |sorted| {
                sorted.rows.iter().for_each(|row| sweep.row(sorted, row));
                if let Some(limit) = &mut limit {
                    limit.count += sorted.mark(limit.low, limit.high, limit.fails);
                }
            });
        }
        limit = None;
        let found = sweep.finish(count, form);
        if found.is_some() {
            return found;
        }
        margin *= 4.0;
    }
}

/// One pass over all rows.
struct Sweep {
    windows: [Window; WINDOWS],
    min: (f64, (u32, u32)),
    max: (f64, (u32, u32)),
}

impl Sweep {
    fn new(sample: &[f64], margin: f64, count: u64, form: Form) -> Self {
        // The windows of the quartiles hold twice the margin; no memory is taken before it is used.
        let room = (2.5 * margin * count as f64) as usize;
        let mut windows: [Window; WINDOWS] = std::array::from_fn(|_| Window::with_room(room));
        for (window, share) in windows.iter_mut().zip([0.25, 0.5, 0.75]) {
            (window.low, window.high) = (at(sample, share - margin), at(sample, share + margin));
        }
        // Possible ends of the whiskers, from the bounds of the quartiles.
        let (q1, q3) = (
            (form.map(windows[0].low), form.map(windows[0].high)),
            (form.map(windows[2].low), form.map(windows[2].high)),
        );
        let fence = |low: f64, high: f64| {
            let room = 1e-9 * (low.abs() + high.abs());
            let (low, high) = form.bounds(low - room, high + room);
            if low.is_nan() || high.is_nan() {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                (low, high)
            }
        };
        (windows[3].low, windows[3].high) =
            fence(q1.0 - 1.5 * (q3.1 - q1.0), q1.1 - 1.5 * (q3.0 - q1.1));
        (windows[4].low, windows[4].high) =
            fence(q3.0 + 1.5 * (q3.0 - q1.1), q3.1 + 1.5 * (q3.1 - q1.0));
        Self { windows, min: (f64::INFINITY, (0, 0)), max: (f64::NEG_INFINITY, (0, 0)) }
    }

    #[inline(always)]
    fn row(&mut self, sorted: &Sorted<'_>, row: &Row) {
        let slack = sorted.slack(row);
        self.extremes(sorted, row, slack);
        for window in &mut self.windows {
            let (from, to) =
                sorted.keys.between(window.low - row.p - slack, window.high - row.p + slack);
            window.below += from as u64;
            window.look(row, &sorted.q[from..to], &sorted.y[from..to]);
        }
    }

    /// Only rows that may contain a new extreme are evaluated.
    #[inline(always)]
    fn extremes(&mut self, sorted: &Sorted<'_>, row: &Row, slack: f64) {
        if row.p + sorted.keys.least() - slack <= self.min.0 {
            let (_, to) = sorted.keys.between(f64::NEG_INFINITY, sorted.keys.least() + 2.0 * slack);
            for (value, at) in sorted.values(row, 0, to) {
                let found = (value, (row.at, at));
                if found.0 < self.min.0 || (found.0 == self.min.0 && found.1 < self.min.1) {
                    self.min = found;
                }
            }
        }
        if row.p + sorted.keys.greatest() + slack >= self.max.0 {
            let (from, _) =
                sorted.keys.between(sorted.keys.greatest() - 2.0 * slack, f64::INFINITY);
            for (value, at) in sorted.values(row, from, sorted.at.len()) {
                let found = (value, (row.at, at));
                if found.0 > self.max.0 || (found.0 == self.max.0 && found.1 < self.max.1) {
                    self.max = found;
                }
            }
        }
    }

    /// `None` where a window does not contain its rank.
    #[inline(always)]
    fn finish(&mut self, count: u64, form: Form) -> Option<Order> {
        let mut quartiles = [0.0; 3];
        for ((quartile, window), (rank, rest)) in
            quartiles.iter_mut().zip(&mut self.windows).zip(ranks(count))
        {
            let next = if rest > 0.0 { rank + 1 } else { rank };
            let (value, next) = window.ranked(rank, next)?;
            let (value, next) = (form.map(value), form.map(next));
            *quartile = value + rest * (next - value);
        }
        let range = quartiles[2] - quartiles[0];
        let (low, high) = (quartiles[0] - 1.5 * range, quartiles[2] + 1.5 * range);
        let [.., under, over] = &self.windows;
        let below_low = under.counted(|value| form.map(value) < low);
        let up_to_high = over.counted(|value| form.map(value) <= high);
        let listed = Listed {
            count: count as f64,
            min: form.map(self.min.0),
            max: form.map(self.max.0),
            quartiles,
            outliers: (below_low + (count - up_to_high)) as f64,
        };
        Some(Order { listed, at_min: self.min.1, at_max: self.max.1 })
    }
}
