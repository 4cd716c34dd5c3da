//! An evenly distributed sample of a large set of values, to estimate its quartiles.

use super::{
    buckets::ordered,
    groups::{Block, value},
};

/// Size of the sample as a multiple of the square root of the number of values.
const SAMPLE: f64 = 6.0;

/// A sorted sample of the values: rows and columns, each in approximate order of their own contributions,
/// at the points of a low-discrepancy sequence (Roberts' R2: powers of the plastic number).
#[inline(always)]
pub fn sample(blocks: &[Block], count: u64) -> Vec<f64> {
    let wanted = ((count as f64).sqrt() * SAMPLE).min(count as f64).max(1.0);
    let mut sample = Vec::with_capacity(wanted as usize + blocks.len());
    for Block { rows, columns } in
        blocks.iter().filter(|block| !block.rows.is_empty() && !block.columns.is_empty())
    {
        let size = rows.len() as f64 * columns.len() as f64;
        let n = (wanted * size / count as f64).ceil() as usize;
        let c = rows.iter().map(|row| row.c).sum::<f64>() / rows.len() as f64;
        let y = columns.iter().map(|column| column.y).sum::<f64>() / columns.len() as f64;
        let row_order = ordered(&rows.iter().map(|row| row.p - row.c * y).collect::<Vec<_>>());
        let column_order =
            ordered(&columns.iter().map(|column| column.q - c * column.y).collect::<Vec<_>>());
        let (mut u, mut v) = (0.5_f64, 0.5_f64);
        for _ in 0..n {
            u = wrapped(u + 0.754_877_666_246_692_7);
            v = wrapped(v + 0.569_840_290_998_053_3);
            let row = &rows[row_order[(u * rows.len() as f64) as usize] as usize];
            let column = &columns[column_order[(v * columns.len() as f64) as usize] as usize];
            sample.push(value(row, column.q, column.y));
        }
    }
    sample.sort_unstable_by(f64::total_cmp);
    sample
}

/// The value at a share of a sorted sample; infinite beyond its ends.
pub fn at(sample: &[f64], share: f64) -> f64 {
    let place = (share * sample.len() as f64).floor();
    if place < 0.0 {
        return f64::NEG_INFINITY;
    }
    sample.get(place as usize).copied().unwrap_or(f64::INFINITY)
}

/// Subtracts 1 from a number of [1, 2).
fn wrapped(x: f64) -> f64 {
    if x >= 1.0 { x - 1.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_places_of_the_sample() {
        let sample: Vec<f64> = (0..100).map(f64::from).collect();
        let found = [-0.01, 0.0, 0.305, 0.999, 1.0].map(|share| at(&sample, share));
        assert_eq!(found, [f64::NEG_INFINITY, 0.0, 30.0, 99.0, f64::INFINITY]);
    }
}
