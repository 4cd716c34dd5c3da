//! Exact order statistics of a great many values: none is kept that cannot be one of those wanted.
//!
//! A small even sample says where the quartiles lie; one sweep over all rows counts what lies below those places and keeps what
//! lies within them. Where the sample misled, the sweep is made again with wider windows, so that the result is exact in any case.

use super::fails::Fails;
use super::groups::{Block, Row, Sorted, below, groups, value};
use super::halves::Form;

/// Order statistics of all values.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    pub count: u64,
    pub min: f64,
    pub max: f64,
    /// 25, 50, 75 %, linear between order statistics.
    pub quartiles: [f64; 3],
    /// Values more than 1.5 interquartile ranges below the first or above the third quartile.
    pub outliers: u64,
    /// Row and column of the least and of the greatest value.
    pub at_min: (u32, u32),
    pub at_max: (u32, u32),
}

/// Values looked for: those between the two bounds are kept, those below counted, ties with a bound counted by themselves.
#[derive(Clone, Debug, Default)]
struct Window {
    low: f64,
    high: f64,
    below: u64,
    at_low: u64,
    at_high: u64,
    kept: Vec<f64>,
}

/// Three for the quartiles, two for the ends of the whiskers.
const WINDOWS: usize = 5;

/// Where a limit holds.
#[derive(Debug)]
pub struct Limit<'a> {
    pub low: f64,
    pub high: f64,
    pub fails: &'a mut Fails,
    /// How many values broke it.
    pub count: u64,
}

/// Rank of each quartile among `count` values, and how far it lies toward the next.
pub fn ranks(count: u64) -> [(u64, f64); 3] {
    [0.25, 0.5, 0.75].map(|share| {
        let rank = (count - 1) as f64 * share;
        (rank.floor() as u64, rank - rank.floor())
    })
}

/// Share of the values on each side of a quartile's place in the sample that the sweep keeps, for sums of two and of more parts.
const MARGIN: (f64, f64) = (0.0008, 0.004);
/// Values of the sample for the root of the number of all; the margins are for as many as 13.8 million.
const SAMPLE: f64 = 5.0;
const MARGIN_FOR: f64 = 18_600.0;

/// Some of the values: rows and columns, each in the order of their own parts, at the points of a sequence that fills
/// the unit square evenly (Roberts' R2: powers of the plastic number).
fn pilot(blocks: &[Block], count: u64) -> Vec<f64> {
    let wanted = ((count as f64).sqrt() * SAMPLE).min(count as f64).max(1.0);
    let mut sample = Vec::with_capacity(wanted as usize + blocks.len());
    for block in blocks.iter().filter(|block| !block.rows.is_empty() && !block.columns.is_empty()) {
        let size = block.rows.len() as f64 * block.columns.len() as f64;
        let n = (wanted * size / count as f64).ceil() as usize;
        let (mut rows, mut columns) = (block.rows.clone(), block.columns.clone());
        let c = rows.iter().map(|row| row.c).sum::<f64>() / rows.len() as f64;
        let y = columns.iter().map(|column| column.y).sum::<f64>() / columns.len() as f64;
        rows.sort_unstable_by(|a, b| (a.p - a.c * y).total_cmp(&(b.p - b.c * y)).then(a.at.cmp(&b.at)));
        columns.sort_unstable_by(|a, b| (a.q - c * a.y).total_cmp(&(b.q - c * b.y)).then(a.at.cmp(&b.at)));
        let (mut u, mut v) = (0.5_f64, 0.5_f64);
        for _ in 0..n {
            u = (u + 0.754_877_666_246_692_7).fract();
            v = (v + 0.569_840_290_998_053_3).fract();
            let row = &rows[(u * rows.len() as f64) as usize];
            let column = &columns[(v * columns.len() as f64) as usize];
            sample.push(value(row, column.q, column.y));
        }
    }
    sample
}

/// Order statistics of all values of some blocks, mapped by their form; what a limit forbids is marked on the way.
pub fn order(blocks: &mut [Block], form: Form, limit: Option<&mut Limit<'_>>) -> Option<Order> {
    let count: u64 = blocks.iter().map(|block| block.rows.len() as u64 * block.columns.len() as u64).sum();
    if count == 0 {
        return None;
    }
    let mut sample = pilot(blocks, count);
    let flat = blocks.iter().all(|block| block.rows.iter().all(|row| row.c == 0.0));
    let mut margin = if flat { MARGIN.0 } else { MARGIN.1 } * (MARGIN_FOR / sample.len() as f64).powf(0.6);
    let mut limit = limit;
    loop {
        let mut sweep = Sweep::new(&mut sample, margin, form);
        for block in blocks.iter_mut() {
            groups(block, |sorted| {
                sorted.rows.iter().for_each(|row| sweep.row(sorted, row));
                if let Some(limit) = &mut limit {
                    limit.count += sorted.mark(limit.low, limit.high, limit.fails);
                }
            });
        }
        limit = None;
        if let Some(found) = sweep.finish(count, form) {
            return Some(found);
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
    fn new(sample: &mut [f64], margin: f64, form: Form) -> Self {
        let mut windows: [Window; WINDOWS] = std::array::from_fn(|_| Window::default());
        // Six places of the sample are looked at: it need not be sorted for that.
        let mut at = |share: f64| {
            let at = share * sample.len() as f64;
            if at < 0.0 {
                f64::NEG_INFINITY
            } else if at as usize >= sample.len() {
                f64::INFINITY
            } else {
                *sample.select_nth_unstable_by(at as usize, f64::total_cmp).1
            }
        };
        for (window, share) in windows.iter_mut().zip([0.25, 0.5, 0.75]) {
            (window.low, window.high) = (at(share - margin), at(share + margin));
        }
        // Where the whiskers may end, from the least and the greatest that the quartiles can be.
        let (q1, q3) = ((form.map(windows[0].low), form.map(windows[0].high)), (form.map(windows[2].low), form.map(windows[2].high)));
        let fence = |low: f64, high: f64| {
            let room = 1e-9 * (low.abs() + high.abs());
            let (low, high) = form.bounds(low - room, high + room);
            if low.is_nan() || high.is_nan() { (f64::NEG_INFINITY, f64::INFINITY) } else { (low, high) }
        };
        (windows[3].low, windows[3].high) = fence(q1.0 - 1.5 * (q3.1 - q1.0), q1.1 - 1.5 * (q3.0 - q1.1));
        (windows[4].low, windows[4].high) = fence(q3.0 + 1.5 * (q3.0 - q1.1), q3.1 + 1.5 * (q3.1 - q1.0));
        Self { windows, min: (f64::INFINITY, (0, 0)), max: (f64::NEG_INFINITY, (0, 0)) }
    }

    #[inline(always)]
    fn row(&mut self, sorted: &Sorted<'_>, row: &Row) {
        let slack = sorted.slack(row);
        self.extremes(sorted, row, slack);
        let mut bounds = [0.0; 2 * WINDOWS];
        for (at, window) in self.windows.iter().enumerate() {
            bounds[2 * at] = window.low - row.p - slack;
            bounds[2 * at + 1] = window.high - row.p + slack;
        }
        let found = below(sorted.keys, &bounds);
        for (at, window) in self.windows.iter_mut().enumerate() {
            // Keys equal to the upper bound are below or at the window only by rounding: room is kept for that in the slack.
            let (from, to) = (found[2 * at], found[2 * at + 1].max(found[2 * at]));
            window.below += from as u64;
            let columns = &sorted.columns[from..to];
            let mut length = window.kept.len();
            window.kept.resize(length + columns.len(), 0.0);
            let (mut under, mut at_low, mut at_high) = (0_u64, 0_u64, 0_u64);
            for column in columns {
                let value = value(row, column.q, column.y);
                under += u64::from(value < window.low);
                at_low += u64::from(value == window.low);
                at_high += u64::from(value == window.high);
                window.kept[length] = value;
                length += usize::from((value > window.low) & (value < window.high));
            }
            window.below += under;
            window.at_low += at_low;
            window.at_high += at_high;
            window.kept.truncate(length);
        }
    }

    /// Only a row that can hold a new extreme is looked into.
    #[inline(always)]
    fn extremes(&mut self, sorted: &Sorted<'_>, row: &Row, slack: f64) {
        let (keys, last) = (sorted.keys, sorted.keys.len() - 1);
        if row.p + keys[0] - slack <= self.min.0 {
            let near = keys.iter().zip(sorted.columns).take_while(|(key, _)| **key <= keys[0] + 2.0 * slack);
            for (_, column) in near {
                let found = (value(row, column.q, column.y), (row.at, column.at));
                if found.0 < self.min.0 || (found.0 == self.min.0 && found.1 < self.min.1) {
                    self.min = found;
                }
            }
        }
        if row.p + keys[last] + slack >= self.max.0 {
            let near = keys.iter().zip(sorted.columns).rev().take_while(|(key, _)| **key >= keys[last] - 2.0 * slack);
            for (_, column) in near {
                let found = (value(row, column.q, column.y), (row.at, column.at));
                if found.0 > self.max.0 || (found.0 == self.max.0 && found.1 < self.max.1) {
                    self.max = found;
                }
            }
        }
    }

    /// `None` where a window missed what it looked for.
    fn finish(mut self, count: u64, form: Form) -> Option<Order> {
        let mut quartiles = [0.0; 3];
        for (at, (rank, rest)) in ranks(count).into_iter().enumerate() {
            let value = form.map(self.windows[at].ranked(rank)?);
            let next = if rest > 0.0 { form.map(self.windows[at].ranked(rank + 1)?) } else { value };
            quartiles[at] = value + rest * (next - value);
        }
        let range = quartiles[2] - quartiles[0];
        let (low, high) = (quartiles[0] - 1.5 * range, quartiles[2] + 1.5 * range);
        let [.., under, over] = &self.windows;
        let below_low = under.counted(|value| form.map(value) < low);
        let up_to_high = over.counted(|value| form.map(value) <= high);
        Some(Order {
            count,
            min: form.map(self.min.0),
            max: form.map(self.max.0),
            quartiles,
            outliers: below_low + (count - up_to_high),
            at_min: self.min.1,
            at_max: self.max.1,
        })
    }
}

impl Window {
    /// The value of a rank, if it is in the window.
    fn ranked(&mut self, rank: u64) -> Option<f64> {
        let rank = rank.checked_sub(self.below)?;
        if rank < self.at_low {
            return Some(self.low);
        }
        let inside = (rank - self.at_low) as usize;
        if inside < self.kept.len() {
            return Some(*self.kept.select_nth_unstable_by(inside, f64::total_cmp).1);
        }
        // With equal bounds ties are counted at both.
        let at_high = if self.low == self.high { 0 } else { self.at_high };
        ((inside - self.kept.len()) < at_high as usize).then_some(self.high)
    }

    /// Values that meet a condition which holds below the window and fails above it.
    fn counted(&self, holds: impl Fn(f64) -> bool) -> u64 {
        let ties = |value: f64, count: u64| if holds(value) { count } else { 0 };
        let high = if self.low == self.high { 0 } else { ties(self.high, self.at_high) };
        self.below + ties(self.low, self.at_low) + self.kept.iter().filter(|value| holds(**value)).count() as u64 + high
    }
}
