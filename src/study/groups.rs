//! Values that are sums of few parts, by row, with the columns in approximate order of the values.
//!
//! The values are `p + q - c y` for every row `(p, c)` and every column `(q, y)` of a block. A
//! variance has this form, with rows and columns the sums over two halves of a selection, and so
//! has a mean (c = 0).

use super::{
    buckets::{Buckets, ordered},
    fails::Fails,
};

/// Contribution of one half of a selection to a value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    pub p: f64,
    pub c: f64,
    /// Index of the half selection.
    pub at: u32,
}

/// Contribution of the other half.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Column {
    pub q: f64,
    pub y: f64,
    pub at: u32,
}

/// Rows and columns, combined in all pairs.
#[derive(Clone, Debug, Default)]
pub struct Block {
    pub rows: Vec<Row>,
    pub columns: Vec<Column>,
}

/// The value of one row and one column; all comparisons use this number.
#[inline(always)]
pub fn value(row: &Row, q: f64, y: f64) -> f64 {
    (row.p + q) - row.c * y
}

/// Rows of similar `c`, with the columns in approximate order of their values.
#[derive(Debug)]
pub struct Sorted<'a> {
    pub rows: &'a [Row],
    /// Centre of the rows' `c`.
    middle: f64,
    /// Values for `c = middle`, without the rows' part `p`.
    pub keys: &'a Buckets,
    pub q: &'a [f64],
    pub y: &'a [f64],
    pub at: &'a [u32],
    /// Largest |y|.
    reach: f64,
    /// Tolerance for rounding.
    room: f64,
}

/// Visits the rows of a block in groups, with the columns sorted for each group.
#[inline(always)]
pub fn groups(block: &Block, mut visit: impl FnMut(&Sorted<'_>)) {
    let Block { rows, columns } = block;
    if rows.is_empty() || columns.is_empty() {
        return;
    }
    let reach = columns.iter().fold(0.0_f64, |reach, column| reach.max(column.y.abs()));
    let size = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0_f64, |size, value| size.max(value.abs()))
    };
    // The last term is for values that are all zero.
    let room = 1e-14
        * (size(&mut rows.iter().map(|row| row.p))
            + size(&mut columns.iter().map(|column| column.q))
            + size(&mut rows.iter().map(|row| row.c)) * reach)
        + 1e-300;
    let slopes: Vec<f64> = rows.iter().map(|row| row.c).collect();
    let rows: Vec<Row> = ordered(&slopes).into_iter().map(|at| rows[at as usize]).collect();
    let flat = slopes.iter().all(|c| *c == slopes[0]);
    // Small groups give a more accurate order, large groups need fewer sorts. The cost is least
    // near the square root of the number of rows.
    let group = if flat { rows.len() } else { (rows.len() as f64).sqrt().ceil() as usize };
    let mut buckets = Buckets::default();
    let n = columns.len();
    let (mut keys, mut q, mut y, mut at) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0; n]);
    for rows in rows.chunks(group) {
        let least = rows.iter().fold(f64::INFINITY, |least, row| least.min(row.c));
        let greatest = rows.iter().fold(f64::NEG_INFINITY, |greatest, row| greatest.max(row.c));
        let middle = f64::midpoint(least, greatest);
        for (key, column) in keys.iter_mut().zip(columns) {
            *key = column.q - middle * column.y;
        }
        for (column, place) in columns.iter().zip(buckets.fill(&keys)) {
            let place = *place as usize;
            q[place] = column.q;
            y[place] = column.y;
            at[place] = column.at;
        }
        visit(&Sorted { rows, middle, keys: &buckets, q: &q, y: &y, at: &at, reach, room });
    }
}

impl Sorted<'_> {
    /// Largest error of the order of the columns for a row.
    #[inline(always)]
    pub fn slack(&self, row: &Row) -> f64 {
        (row.c - self.middle).abs() * self.reach + self.room
    }

    /// Values of a row between two positions in the order.
    #[inline(always)]
    pub fn values(&self, row: &Row, from: usize, to: usize) -> impl Iterator<Item = (f64, u32)> {
        let row = *row;
        self.q[from..to]
            .iter()
            .zip(&self.y[from..to])
            .zip(&self.at[from..to])
            .map(move |((q, y), at)| (value(&row, *q, *y), *at))
    }

    /// Adds all values outside the limit to the set, and returns their number.
    #[inline(always)]
    pub fn mark(&self, low: f64, high: f64, fails: &mut Fails) -> u64 {
        let (mut count, mut told) = (0, false);
        for row in self.rows {
            let slack = self.slack(row);
            let over = row.p + self.keys.greatest() + slack > high;
            let under = row.p + self.keys.least() - slack < low;
            if (over || under) && !told {
                fails.order(self.at);
                told = true;
            }
            for (bound, above, beyond) in [(high, true, over), (low, false, under)] {
                if !beyond {
                    continue;
                }
                let (from, to) = self.keys.between(bound - row.p - slack, bound - row.p + slack);
                for (value, at) in self.values(row, from, to) {
                    let fail = if above { value > bound } else { value < bound };
                    fails.set(row.at, at, fail);
                    count += u64::from(fail);
                }
                let (from, to) = if above { (to, self.at.len()) } else { (0, from) };
                fails.between(row.at, self.at, from, to);
                count += (to - from) as u64;
            }
        }
        count
    }
}
