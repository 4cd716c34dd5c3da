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
    /// With room for so many values.
    pub fn with_room(values: usize) -> Self {
        Self { kept: vec![0.0; values], ..Self::default() }
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

    /// The values of a rank and of the next, if they are in the window.
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
        let beyond = |rank: u64| if rank < upto_low { self.low } else { self.high };
        let numbers = &mut self.kept[..self.length];
        // The number of a place, and the least of those that follow.
        let mut selected = |place: usize| {
            let (_, value, above) = numbers.select_nth_unstable_by(place, f64::total_cmp);
            (*value, above.iter().copied().fold(f64::INFINITY, f64::min))
        };
        Some(match (kept(rank), kept(next)) {
            (Some(place), Some(_)) => {
                let (value, above) = selected(place);
                (value, if next == rank { value } else { above })
            }
            (Some(place), None) => (selected(place).0, beyond(next)),
            (None, Some(place)) => (beyond(rank), selected(place).0),
            (None, None) => (beyond(rank), beyond(next)),
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of numbers with many equal ones: wherever the bounds are, ranks inside are those of the
    /// sorted numbers, others are refused.
    #[test]
    fn ranks_are_those_of_sorted_numbers() {
        let numbers: Vec<f64> = (0..600).map(|k| f64::from(k * 7919 % 211) / 10.0 - 9.0).collect();
        let mut sorted = numbers.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        for (low, high) in [(-30.0, 30.0), (-4.0, 2.5), (0.0, 0.0), (1.05, 1.06), (3.0, 90.0)] {
            for rank in 0..599 {
                for next in [rank, rank + 1] {
                    let mut window = Window { low, high, ..Window::with_room(3) };
                    for part in numbers.chunks(77) {
                        window.look(&Row::default(), part, &vec![0.0; part.len()]);
                    }
                    let (value, above) = (sorted[rank], sorted[next]);
                    let inside = low <= value && above <= high;
                    let found = window.ranked(rank as u64, next as u64);
                    assert_eq!(found, inside.then_some((value, above)), "{low} {high} {rank}");
                    if inside {
                        let below = sorted.iter().filter(|number| **number <= value).count();
                        assert_eq!(window.counted(|number| number <= value), below as u64);
                    }
                }
            }
        }
    }
}
