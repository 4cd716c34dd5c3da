//! Order statistics where the values or their counts can be listed: single values, and sums by
//! sorting.

use super::{groups::Block, halves::Form};
use crate::result::study::{Intervals, Spread};

/// From values in any order with their counts; `None` if there are none.
pub fn weighted(list: &[(f64, f64)]) -> Option<Listed> {
    let count: f64 = list.iter().map(|(_, times)| times).sum();
    if count < 1.0 {
        return None;
    }
    let mut upto = Vec::with_capacity(list.len());
    let mut sum = 0.0;
    for (_, times) in list {
        sum += times;
        upto.push(sum);
    }
    let ranked = |rank: f64| list[upto.partition_point(|upto| *upto <= rank).min(list.len() - 1)].0;
    let quartiles = [0.25, 0.5, 0.75].map(|share| {
        let rank = (count - 1.0) * share;
        let (low, high) = (ranked(rank.floor()), ranked(rank.floor() + 1.0));
        let rest = rank - rank.floor();
        if rest > 0.0 { low + rest * (high - low) } else { low }
    });
    let reach = 1.5 * (quartiles[2] - quartiles[0]);
    let (low, high) = (quartiles[0] - reach, quartiles[2] + reach);
    let outliers = list
        .iter()
        .filter(|(value, _)| *value < low || *value > high)
        .map(|(_, times)| times)
        .sum();
    Some(Listed { count, min: list[0].0, max: list[list.len() - 1].0, quartiles, outliers })
}

/// Order statistics; counts may exceed the integers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Listed {
    pub count: f64,
    pub min: f64,
    pub max: f64,
    /// 25, 50, 75 %, interpolated linearly between order statistics.
    pub quartiles: [f64; 3],
    /// Number of values more than 1.5 interquartile ranges below the first or above the third
    /// quartile.
    pub outliers: f64,
}

impl From<Listed> for Spread {
    fn from(listed: Listed) -> Self {
        let [q1, median, q3] = listed.quartiles;
        Self {
            min: listed.min,
            q1,
            median,
            q3,
            max: listed.max,
            outliers: listed.outliers as u64,
            count: listed.count,
            exact: true,
            within: None,
            intervals: Intervals::default(),
        }
    }
}

/// Rank of each quartile among `count` values, and the fraction towards the next.
pub fn ranks(count: u64) -> [(u64, f64); 3] {
    [0.25, 0.5, 0.75].map(|share| {
        let rank = (count - 1) as f64 * share;
        (rank.floor() as u64, rank - rank.floor())
    })
}

/// Number of values kept around a rank.
const KEPT: u64 = 1 << 17;

/// Order statistics of sums of two numbers, by sorted rows and columns; counts are obtained by one
/// pass along both.
pub fn sums(blocks: &[Block], form: Form) -> Option<Listed> {
    let sorted: Vec<(Vec<f64>, Vec<f64>)> = blocks
        .iter()
        .map(|block| {
            let mut rows: Vec<f64> = block.rows.iter().map(|row| row.p).collect();
            let mut columns: Vec<f64> = block.columns.iter().map(|column| column.q).collect();
            rows.sort_unstable_by(f64::total_cmp);
            columns.sort_unstable_by(f64::total_cmp);
            (rows, columns)
        })
        .filter(|(rows, columns)| !rows.is_empty() && !columns.is_empty())
        .collect();
    let count: u64 =
        sorted.iter().map(|(rows, columns)| rows.len() as u64 * columns.len() as u64).sum();
    if count == 0 {
        return None;
    }
    let ends = |pick: fn(&[f64]) -> f64| {
        sorted.iter().map(move |(rows, columns)| pick(rows) + pick(columns))
    };
    let min = ends(|values| values[0]).fold(f64::INFINITY, f64::min);
    let max = ends(|values| values[values.len() - 1]).fold(f64::NEG_INFINITY, f64::max);
    let ranked = |rank: u64| form.map(of_rank(&sorted, rank, (min, max)));
    let quartiles = ranks(count).map(|(rank, rest)| {
        let low = ranked(rank);
        if rest > 0.0 { low + rest * (ranked(rank + 1) - low) } else { low }
    });
    let reach = 1.5 * (quartiles[2] - quartiles[0]);
    let (low, high) = form.bounds(quartiles[0] - reach, quartiles[2] + reach);
    let outliers = below(&sorted, low, false) + (count - below(&sorted, high, true));
    Some(Listed {
        count: count as f64,
        min: form.map(min),
        max: form.map(max),
        quartiles,
        outliers: outliers as f64,
    })
}

/// Number of sums below a value, or up to it.
fn below(sorted: &[(Vec<f64>, Vec<f64>)], value: f64, or_equal: bool) -> u64 {
    let mut count = 0;
    for (rows, columns) in sorted {
        let mut place = columns.len();
        for row in rows {
            while place > 0
                && (row + columns[place - 1] > value
                    || (!or_equal && row + columns[place - 1] == value))
            {
                place -= 1;
            }
            count += place as u64;
        }
    }
    count
}

fn of_rank(sorted: &[(Vec<f64>, Vec<f64>)], rank: u64, (min, max): (f64, f64)) -> f64 {
    // The value lies above `low` and not above `high`.
    let (mut low, mut high) = (min - 1.0 - min.abs(), max);
    let (mut under, mut upto) = (0, below(sorted, max, true));
    while upto - under > KEPT {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            return high;
        }
        let count = below(sorted, middle, true);
        if count > rank {
            (high, upto) = (middle, count);
        } else {
            (low, under) = (middle, count);
        }
    }
    let mut kept = Vec::new();
    for (rows, columns) in sorted {
        let (mut from, mut to) = (columns.len(), columns.len());
        for row in rows {
            while to > 0 && row + columns[to - 1] > high {
                to -= 1;
            }
            from = from.min(to);
            while from > 0 && row + columns[from - 1] > low {
                from -= 1;
            }
            // The positions only decrease; values above `low` are visited again.
            kept.extend(
                columns[from..to].iter().map(|column| row + column).filter(|sum| *sum > low),
            );
        }
    }
    *kept.select_nth_unstable_by((rank - under) as usize, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::groups::{Column, Row};

    #[test]
    fn sums_agree_with_lists() {
        let mut seed = 7_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 33) % 50) as f64 / 10.0 - 2.0
        };
        let rows: Vec<f64> = (0..37).map(|_| next()).collect();
        let columns: Vec<f64> = (0..23).map(|_| next()).collect();
        let listed = |join: &dyn Fn(f64, f64) -> f64| {
            let mut all: Vec<(f64, f64)> = rows
                .iter()
                .flat_map(|row| columns.iter().map(move |column| (*row, *column)))
                .map(|(a, b)| (join(a, b), 1.0))
                .collect();
            all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            weighted(&all).expect("values")
        };
        let block = Block {
            rows: rows.iter().map(|p| Row { p: *p, c: 0.0, at: 0 }).collect(),
            columns: columns.iter().map(|q| Column { q: *q, y: 0.0, at: 0 }).collect(),
        };
        assert_eq!(sums(&[block], Form::Value), Some(listed(&|a, b| a + b)));
        assert_eq!((sums(&[], Form::Value), weighted(&[])), (None, None));
    }
}
