//! Sums with a rounding error that hardly grows with the number of values.

/// Longest block that is added directly; longer ones are halved.
const BLOCK: usize = 128;

/// Pairwise sum; its error is of the order of log(n) rounding units.
pub fn sum(values: &[f64]) -> f64 {
    sum_of(values, |value| value)
}

/// Pairwise sum of `term` over values.
pub fn sum_of(values: &[f64], term: impl Fn(f64) -> f64 + Copy) -> f64 {
    sum_of_pairs(values, values, |value, _| term(value))
}

/// Pairwise sum of `term` over two signals, up to the end of the shorter one.
pub fn sum_of_pairs(left: &[f64], right: &[f64], term: impl Fn(f64, f64) -> f64 + Copy) -> f64 {
    let length = left.len().min(right.len());
    let (left, right) = (&left[..length], &right[..length]);
    if length > BLOCK {
        // Multiples of the number of lanes keep all blocks but the last full.
        let half = length / 2 / 8 * 8;
        return sum_of_pairs(&left[..half], &right[..half], term)
            + sum_of_pairs(&left[half..], &right[half..], term);
    }
    // Eight independent sums: no addition waits for the previous one, and each is a further
    // halving.
    let mut lanes = [0.0; 8];
    let (left_eights, left_rest) = left.as_chunks::<8>();
    let (right_eights, right_rest) = right.as_chunks::<8>();
    for (l, r) in left_eights.iter().zip(right_eights) {
        for lane in 0..8 {
            lanes[lane] += term(l[lane], r[lane]);
        }
    }
    let rest: f64 = left_rest.iter().zip(right_rest).map(|(&l, &r)| term(l, r)).sum();
    ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
        + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]))
        + rest
}

/// Cumulative sums in twice the precision, so that the difference of two of them is as accurate as
/// the sum between them.
#[derive(Debug)]
pub struct RunningSums(Vec<(f64, f64)>);

impl RunningSums {
    pub fn new(terms: impl ExactSizeIterator<Item = f64>) -> Self {
        let mut sums = Vec::with_capacity(terms.len() + 1);
        let (mut high, mut low) = (0.0_f64, 0.0_f64);
        sums.push((high, low));
        for term in terms {
            // Knuth's two-sum: the part of the term that is lost by rounding.
            let next = high + term;
            let taken = next - high;
            low += (high - (next - taken)) + (term - taken);
            high = next;
            sums.push((high, low));
        }
        Self(sums)
    }

    /// Sum of the terms `from..to`.
    pub fn between(&self, from: usize, to: usize) -> f64 {
        let ((high_from, low_from), (high_to, low_to)) = (self.0[from], self.0[to]);
        (high_to - high_from) + (low_to - low_from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_every_element_once() {
        for length in [0, 1, 7, 8, 127, 128, 129, 1000, 1001, 4097] {
            let values: Vec<f64> = (1..=length).map(f64::from).collect();
            // Closed form n (n + 1) / 2, exact in integers.
            assert_eq!(sum(&values), f64::from(length * (length + 1) / 2));
        }
    }

    #[test]
    fn small_terms_survive_a_large_sum() {
        // A million tenths: direct addition has an error of 1e-6, pairwise addition of a few
        // rounding units.
        let tenths = vec![0.1; 1_000_000];
        assert!((sum(&tenths) - 1e5).abs() < 1e-10);
        let sums =
            RunningSums::new([1e16].into_iter().chain([0.1; 10]).collect::<Vec<_>>().into_iter());
        assert!((sums.between(1, 11) - 1.0).abs() < 1e-15);
    }
}
