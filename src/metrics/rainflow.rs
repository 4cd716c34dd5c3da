//! Cycles of a signal by rainflow counting.

/// The ranges of the half cycles of a signal, as ASTM E1049-85, 5.4.4 counts them: a cycle is two
/// half cycles of the same range, one after the other. None where the signal does not change.
pub fn half_cycles(values: &[f64]) -> Vec<f64> {
    let mut found = Vec::new();
    // The reversals whose ranges are not counted yet.
    let mut open: Vec<f64> = Vec::new();
    for reversal in reversals(values) {
        open.push(reversal);
        while let [.., first, second, last] = open[..] {
            let range = (second - first).abs();
            if (last - second).abs() < range {
                break;
            }
            found.push(range);
            if open.len() == 3 {
                // The range begins where the signal does: half a cycle.
                open.remove(0);
            } else {
                found.push(range);
                open.truncate(open.len() - 3);
                open.push(last);
            }
        }
    }
    found.extend(open.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    found
}

/// The first value, those at which the signal turns, and the last one.
fn reversals(values: &[f64]) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for &value in values {
        match found[..] {
            [.., last] if value == last => {}
            // It goes on in the same direction.
            [.., before, last] if (last > before) == (value > last) => {
                let end = found.len() - 1;
                found[end] = value;
            }
            _ => found.push(value),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(mut values: Vec<f64>) -> Vec<f64> {
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    /// The worked example of ASTM E1049-85, figure 6: ranges of 3 (0.5 cycles), 4 (1.5), 6 (0.5),
    /// 8 (1) and 9 (0.5).
    #[test]
    fn the_example_of_the_standard() {
        let peaks = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
        let expected = [3.0, 4.0, 4.0, 4.0, 6.0, 8.0, 8.0, 9.0];
        assert_eq!(sorted(half_cycles(&peaks)), expected);
        // Samples between the reversals, and some that repeat, change nothing.
        let between = |pair: &[f64]| [pair[0], pair[0], pair[0] + 0.25 * (pair[1] - pair[0])];
        let mut sampled: Vec<f64> = peaks.windows(2).flat_map(between).collect();
        sampled.extend([-2.0, -2.0]);
        assert_eq!(sorted(half_cycles(&sampled)), expected);
    }

    #[test]
    fn signals_without_cycles() {
        assert!(half_cycles(&[]).is_empty());
        assert!(half_cycles(&[3.0; 5]).is_empty());
        assert_eq!(half_cycles(&[1.0, 2.0, 4.0]), [3.0]);
    }

    /// Half cycles of the swings of the signal: whatever is counted, the ranges of all reversals
    /// add up to those of the half cycles.
    #[test]
    fn no_swing_is_lost() {
        let values: Vec<f64> = (0..500_u64).map(|k| ((7 * k * k + 3 * k) % 101) as f64).collect();
        let swings: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        assert!((half_cycles(&values).iter().sum::<f64>() - swings).abs() < 1e-9);
    }
}
