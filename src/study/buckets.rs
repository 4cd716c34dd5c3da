//! Approximate sorting of numbers into buckets of equal width, without comparisons.

/// Buckets of a set of numbers.
#[derive(Clone, Debug, Default)]
pub struct Buckets {
    least: f64,
    greatest: f64,
    per_unit: f64,
    /// Index of the first number of each bucket, with an empty bucket below all numbers and one
    /// above.
    first: Vec<u32>,
    places: Vec<u32>,
}

impl Buckets {
    /// Distributes the numbers to as many buckets; returns their indices in bucket order.
    #[inline(always)]
    pub fn fill(&mut self, numbers: &[f64]) -> &[u32] {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        (self.least, self.greatest) =
            numbers.iter().fold(ends, |(least, greatest), x| (least.min(*x), greatest.max(*x)));
        let (count, width) = (numbers.len(), self.greatest - self.least);
        // Slightly less than the range, so that the largest number is below the upper bucket.
        self.per_unit =
            if width > 0.0 { (count as f64 * (1.0 - 1e-9) / width).min(f64::MAX) } else { 0.0 };
        self.places.clear();
        self.places.extend(numbers.iter().map(|x| ((x - self.least) * self.per_unit + 1.0) as u32));
        // Counting sort: counts of the buckets, shifted by one; then their starts; then the
        // position of the next number of each.
        self.first.clear();
        self.first.resize(count + 3, 0);
        for bucket in &self.places {
            self.first[*bucket as usize + 1] += 1;
        }
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        for place in &mut self.places {
            let next = &mut self.first[*place as usize];
            *place = *next;
            *next += 1;
        }
        // Each position has advanced to the start of the next bucket.
        self.first.copy_within(..count + 2, 1);
        self.first[0] = 0;
        &self.places
    }

    /// Monotonic: equal numbers give the same bucket, and a higher bucket implies a larger number.
    #[inline(always)]
    fn bucket(&self, bound: f64) -> usize {
        let bound = bound.clamp(-1e300, 1e300);
        (((bound - self.least) * self.per_unit + 1.0) as usize).min(self.first.len() - 2)
    }

    /// Range of positions of the numbers that may lie between two bounds: all before are below
    /// `low`, all after are above `high`.
    #[inline(always)]
    pub fn between(&self, low: f64, high: f64) -> (usize, usize) {
        let from = self.first[self.bucket(low)] as usize;
        (from, (self.first[self.bucket(high) + 1] as usize).max(from))
    }

    pub fn least(&self) -> f64 {
        self.least
    }

    pub fn greatest(&self) -> f64 {
        self.greatest
    }
}

/// Indices of the numbers, in approximate order of the numbers.
#[inline(always)]
pub fn ordered(numbers: &[f64]) -> Vec<u32> {
    let mut buckets = Buckets::default();
    let mut order = vec![0; numbers.len()];
    for (at, place) in buckets.fill(numbers).iter().enumerate() {
        order[*place as usize] = at as u32;
    }
    order
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn holds(numbers: &[f64], low: f64, high: f64) {
        let mut buckets = Buckets::default();
        let places = buckets.fill(numbers).to_vec();
        let mut seen = places.clone();
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(at, place)| at == *place as usize), "{places:?}");
        let (from, to) = buckets.between(low, high);
        assert!(from <= to && to <= numbers.len());
        for (number, place) in numbers.iter().zip(&places) {
            assert!(*number < low || *place as usize >= from, "{number} is not below {low}");
            assert!(*number > high || (*place as usize) < to, "{number} is not above {high}");
        }
    }

    #[test]
    fn nothing_one_number_and_equal_ones() {
        holds(&[], 0.0, 1.0);
        holds(&[3.0], 3.0, 3.0);
        holds(&[3.0; 5], f64::NEG_INFINITY, f64::INFINITY);
        holds(&[1e-310, 0.0, 2e-310], 1e-310, 1e-310);
        holds(&[-1e200, 1e200, 0.0], 0.0, 0.0);
        assert_eq!(ordered(&[5.0, -1.0, 3.0]), [1, 2, 0]);
    }

    proptest! {
        #[test]
        fn bounds_hold(numbers in prop::collection::vec(-9_i32..9, 1..60), low in -12_i32..12, width in 0_i32..9) {
            let numbers: Vec<f64> = numbers.into_iter().map(|x| f64::from(x) * 0.1).collect();
            let (low, high) = (f64::from(low) * 0.1, f64::from(low + width) * 0.1);
            holds(&numbers, low, high);
        }
    }
}
