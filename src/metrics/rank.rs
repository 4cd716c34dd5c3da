//! Rank correlation.

use std::cmp::Ordering;

/// Spearman's rank correlation: the correlation of ranks, equal values sharing the mean of their
/// ranks.
///
/// `None` with fewer than three pairs, of which any two correlate fully, or where all values of one
/// side are equal.
pub fn spearman<T: Copy + PartialOrd>(pairs: &[(T, T)]) -> Option<f64> {
    if pairs.len() < 3 {
        return None;
    }
    let (a, b): (Vec<T>, Vec<T>) = pairs.iter().copied().unzip();
    let (a, b) = (ranks(&a), ranks(&b));
    // The mean of ranks is the same with and without ties.
    let mean = (pairs.len() as f64 + 1.0) / 2.0;
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    let correlation = product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt();
    correlation.is_finite().then(|| correlation.clamp(-1.0, 1.0))
}

/// Ranks from 1; equal values have the mean of their ranks.
pub fn ranks<T: PartialOrd>(values: &[T]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].partial_cmp(&values[b]).unwrap_or(Ordering::Equal));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for equal in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let rank = first as f64 + (equal.len() as f64 + 1.0) / 2.0;
        equal.iter().for_each(|&at| ranks[at] = rank);
        first += equal.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scipy.stats.rankdata` and `spearmanr` of SciPy 1.17.
    #[test]
    fn ties_share_ranks_as_in_scipy() {
        assert_eq!(ranks(&[0.3, 1.2, 0.3, 5.0, 1.2, 1.2]), [1.5, 4.0, 1.5, 6.0, 4.0, 4.0]);
        let a = [0.3, 1.2, 0.3, 5.0, 1.2, 1.2, 0.9];
        let b = [2.0, 1.0, 2.0, 7.0, 3.0, 3.0, 0.5];
        let pairs: Vec<(f64, f64)> = a.into_iter().zip(b).collect();
        let found = spearman(&pairs).expect("a correlation");
        assert!((found - SCIPY).abs() < 1e-15, "{found}");
        assert_eq!(spearman(&[(1.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(spearman(&[(1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]), None);
        assert_eq!(spearman(&[(1.0, 9.0), (2.0, 4.0), (3.0, 1.0)]), Some(-1.0));
    }

    const SCIPY: f64 = 0.590_717_348_824_197;
}
