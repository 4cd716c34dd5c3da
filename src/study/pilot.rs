//! An evenly distributed sample of a large set of values, to estimate its quartiles.

use super::buckets::ordered;
use super::groups::{Block, value};

/// Size of the sample as a multiple of the square root of the number of values.
const SAMPLE: f64 = 6.0;

/// A sample of the values: rows and columns, each in approximate order of their own contributions,
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
    sample
}

/// Subtracts 1 from a number of [1, 2).
fn wrapped(x: f64) -> f64 {
    if x >= 1.0 { x - 1.0 } else { x }
}

/// Values at some positions in the order of a sample; infinite beyond its ends.
pub fn places<const N: usize>(sample: &mut [f64], shares: [f64; N]) -> [f64; N] {
    let places = shares.map(|share| (share * sample.len() as f64).floor());
    let mut found = places.map(|place| if place < 0.0 { f64::NEG_INFINITY } else { f64::INFINITY });
    let inside = places
        .iter()
        .enumerate()
        .filter(|(_, place)| **place >= 0.0 && **place < sample.len() as f64);
    let mut inside: Vec<(usize, usize)> = inside.map(|(at, place)| (at, *place as usize)).collect();
    inside.sort_unstable_by_key(|(_, place)| *place);
    select(sample, 0, &inside, &mut found);
    found
}

/// Selects several order statistics: the middle one first, then those before it among the smaller
/// numbers and those after it among the larger ones. `wanted` is sorted; the numbers begin at
/// position `begin`.
fn select(numbers: &mut [f64], begin: usize, wanted: &[(usize, usize)], found: &mut [f64]) {
    let Some((_, place)) = wanted.get(wanted.len() / 2).copied() else { return };
    let (less, value, more) = numbers.select_nth_unstable_by(place - begin, f64::total_cmp);
    let before = wanted.partition_point(|(_, other)| *other < place);
    let upto = wanted.partition_point(|(_, other)| *other <= place);
    for (at, _) in &wanted[before..upto] {
        found[*at] = *value;
    }
    select(less, begin, &wanted[..before], found);
    select(more, place + 1, &wanted[upto..], found);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_those_of_the_sorted_sample() {
        let mut sample: Vec<f64> = (0..100).map(|k| f64::from(k * 37 % 100)).collect();
        let found = places(&mut sample, [-0.01, 0.3, 0.2, 0.2, 0.999, 1.0]);
        assert_eq!(found, [f64::NEG_INFINITY, 30.0, 20.0, 20.0, 99.0, f64::INFINITY]);
    }
}
