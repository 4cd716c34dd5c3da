//! Values near a required order statistic: those inside the window are stored, those below it
//! counted.

use super::groups::{Row, value};

/// Values between two bounds are stored; values equal to a bound are counted separately.
#[derive(Clone, Debug, Default)]
pub struct Window {
    pub low: f64,
    pub high: f64,
    /// Number of values below `low`.
    pub below: u64,
    at_low: u64,
    at_high: u64,
    /// Only the first `length` of these are valid.
    kept: Vec<f64>,
    length: usize,
}

impl Window {
    /// With a buffer returned by another window.
    pub fn with(kept: Vec<f64>) -> Self {
        Self { kept, ..Self::default() }
    }

    pub fn memory(self) -> Vec<f64> {
        self.kept
    }

    /// Counts and stores the values of a row.
    #[inline(always)]
    pub fn look(&mut self, row: &Row, q: &[f64], y: &[f64]) {
        let start = self.length;
        if self.kept.len() < start + q.len() {
            self.kept.resize(self.kept.len() * 3 / 2 + q.len(), 0.0);
        }
        let (low, high) = (self.low, self.high);
        let (mut under, mut at_low, mut at_high) = (0_u64, 0_u64, 0_u64);
        let kept = &mut self.kept[start..start + q.len()];
        // Two loops: the first one is vectorised.
        for ((q, y), kept) in q.iter().zip(y).zip(&mut *kept) {
            let value = value(row, *q, *y);
            *kept = value;
            under += u64::from(value < low);
            at_low += u64::from(value == low);
            at_high += u64::from(value == high);
        }
        self.length += keep(kept, |value| (value > low) & (value < high));
        self.below += under;
        self.at_low += at_low;
        self.at_high += at_high;
    }

    /// The values of a rank and of the next, if they are in the window. The window is empty
    /// afterwards.
    #[inline(always)]
    pub fn ranked(&mut self, rank: u64, next: u64) -> Option<(f64, f64)> {
        // With equal bounds, ties would be counted twice.
        let at_high = if self.low == self.high { 0 } else { self.at_high };
        let (upto_low, upto_kept) =
            (self.below + self.at_low, self.below + self.at_low + self.length as u64);
        if rank < self.below || next >= upto_kept + at_high {
            return None;
        }
        let kept =
            |rank: u64| (upto_low..upto_kept).contains(&rank).then(|| (rank - upto_low) as usize);
        let numbers = &mut self.kept[..self.length];
        let found = match (kept(rank), kept(next)) {
            (None, None) => [None, None],
            (Some(rank), Some(next)) => two(numbers, rank, next, self.low, self.high).map(Some),
            (Some(rank), None) => [Some(two(numbers, rank, rank, self.low, self.high)[0]), None],
            (None, Some(next)) => [None, Some(two(numbers, next, next, self.low, self.high)[0])],
        };
        self.length = 0;
        let of = |rank: u64, found: Option<f64>| {
            found.unwrap_or(if rank < upto_low { self.low } else { self.high })
        };
        Some((of(rank, found[0]), of(next, found[1])))
    }

    /// Number of values that meet a condition that holds below the window and fails above it.
    pub fn counted(&self, holds: impl Fn(f64) -> bool) -> u64 {
        let ties = |value: f64, count: u64| if holds(value) { count } else { 0 };
        let high = if self.low == self.high { 0 } else { ties(self.high, self.at_high) };
        let kept = self.kept[..self.length].iter().filter(|value| holds(**value)).count();
        self.below + ties(self.low, self.at_low) + kept as u64 + high
    }
}

/// Moves the wanted numbers to the front; returns their count.
#[inline(always)]
fn keep(numbers: &mut [f64], wanted: impl Fn(f64) -> bool) -> usize {
    let mut length = 0;
    for at in 0..numbers.len() {
        let number = numbers[at];
        // Unconditional, which is faster than a branch.
        numbers[length] = number;
        length += usize::from(wanted(number));
    }
    length
}

/// The numbers of two ranks, the second not before the first, among numbers between two bounds.
#[inline(always)]
fn two(numbers: &mut [f64], rank: usize, next: usize, low: f64, high: f64) -> [f64; 2] {
    const BUCKETS: usize = 1024;
    let per_unit = BUCKETS as f64 / (high - low);
    let bucket = |x: f64| (((x - low) * per_unit) as u32 as usize).min(BUCKETS - 1);
    let (mut inside, mut before) = (0..BUCKETS, 0);
    // Numbers of a narrow window are nearly uniform: all but one or two buckets can be excluded.
    if numbers.len() > 4 * BUCKETS && per_unit.is_finite() {
        let mut counts = [0_u32; BUCKETS];
        numbers.iter().for_each(|x| counts[bucket(*x)] += 1);
        while before + counts[inside.start] as usize <= rank {
            before += counts[inside.start] as usize;
            inside.start += 1;
        }
        inside.end = inside.start;
        let mut upto = before;
        while upto <= next {
            upto += counts[inside.end] as usize;
            inside.end += 1;
        }
    }
    let length = keep(numbers, |x| inside.contains(&bucket(x)));
    let numbers = &mut numbers[..length];
    numbers.sort_unstable_by(f64::total_cmp);
    [numbers[rank - before], numbers[next - before]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_sorted_numbers() {
        for (count, bounds) in
            [(9, (-1.0, 1.0)), (30_000, (-1.0, 1.0)), (30_000, (f64::NEG_INFINITY, f64::INFINITY))]
        {
            let numbers: Vec<f64> =
                (0..count).map(|k| ((k * 7919) % 30_011) as f64 / 30_011.0 - 0.5).collect();
            let mut sorted = numbers.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            for rank in [0, count / 3, count - 2] {
                let found = two(&mut numbers.clone(), rank, rank + 1, bounds.0, bounds.1);
                assert_eq!(found, [sorted[rank], sorted[rank + 1]]);
            }
        }
    }
}
