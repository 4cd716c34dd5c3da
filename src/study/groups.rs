//! Values that are sums of few parts, row by row with their columns in the order of the values.
//!
//! The values are `p + q - c y` for every row `(p, c)` with every column `(q, y)` of a block. A variance is of this form, with
//! rows and columns the sums over two halves of a selection, and so is a mean (c = 0).

use super::fails::Fails;

/// Part of a value that one half of a selection gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    pub p: f64,
    pub c: f64,
    /// Which half selection it is.
    pub at: u32,
}

/// Part of a value that the other half gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Column {
    pub q: f64,
    pub y: f64,
    pub at: u32,
}

/// Every row with every column.
#[derive(Clone, Debug, Default)]
pub struct Block {
    pub rows: Vec<Row>,
    pub columns: Vec<Column>,
}

/// The value of one row and one column: every comparison is of this number.
#[inline(always)]
pub fn value(row: &Row, q: f64, y: f64) -> f64 {
    (row.p + q) - row.c * y
}

/// Rows in one group: more rows, fewer orders to keep; fewer rows, less uncertain orders.
const GROUP: usize = 160;

/// Rows of about the same `c`, and the columns in the order of their values for them.
#[derive(Debug)]
pub struct Sorted<'a> {
    pub rows: &'a [Row],
    middle: f64,
    pub keys: &'a [f64],
    pub columns: &'a [Column],
    /// Largest |y|.
    reach: f64,
    /// Room for rounding.
    room: f64,
}

/// Visits the rows of a block in groups, the columns sorted for each.
pub fn groups(block: &mut Block, mut visit: impl FnMut(&Sorted<'_>)) {
    let Block { rows, columns } = block;
    if rows.is_empty() || columns.is_empty() {
        return;
    }
    let reach = columns.iter().fold(0.0_f64, |reach, column| reach.max(column.y.abs()));
    let size = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |size, value| size.max(value.abs()));
    // The last term is for values that are all zero.
    let room = 1e-14
        * (size(&mut rows.iter().map(|row| row.p))
            + size(&mut columns.iter().map(|column| column.q))
            + size(&mut rows.iter().map(|row| row.c)) * reach)
        + 1e-300;
    rows.sort_unstable_by(|a, b| a.c.total_cmp(&b.c).then(a.at.cmp(&b.at)));
    let flat = rows[0].c == rows[rows.len() - 1].c;
    let group = if flat { rows.len() } else { GROUP };
    let mut keys = vec![0.0; columns.len()];
    let mut order: Vec<(f64, Column)> = columns.iter().map(|column| (0.0, *column)).collect();
    for (number, rows) in rows.chunks(group).enumerate() {
        let middle = f64::midpoint(rows[0].c, rows[rows.len() - 1].c);
        for (key, column) in &mut order {
            *key = column.q - middle * column.y;
        }
        if number == 0 {
            sort(&mut order);
        } else {
            nearly_sorted(&mut order);
        }
        for (at, (key, column)) in order.iter().enumerate() {
            keys[at] = *key;
            columns[at] = *column;
        }
        visit(&Sorted { rows, middle, keys: &keys, columns, reach, room });
    }
}

/// Insertion sort: over all groups two columns change places at most once. Where one group asks for too much, a sort from scratch.
fn nearly_sorted(order: &mut [(f64, Column)]) {
    let mut left = 16 * order.len();
    for at in 1..order.len() {
        let moved = order[at];
        let mut to = at;
        while to > 0 && order[to - 1].0 > moved.0 {
            order[to] = order[to - 1];
            to -= 1;
        }
        order[to] = moved;
        left = left.saturating_sub(at - to);
        if left == 0 {
            return sort(order);
        }
    }
}

fn sort(order: &mut [(f64, Column)]) {
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.at.cmp(&b.1.at)));
}

impl Sorted<'_> {
    /// By how much the order of the columns is uncertain for a row.
    #[inline(always)]
    pub fn slack(&self, row: &Row) -> f64 {
        (row.c - self.middle).abs() * self.reach + self.room
    }
}

/// How many keys are below each bound.
#[inline(always)]
pub fn below<const N: usize>(keys: &[f64], bounds: &[f64; N]) -> [usize; N] {
    let mut base = [0_usize; N];
    let mut size = keys.len();
    while size > 1 {
        let half = size / 2;
        for (base, bound) in base.iter_mut().zip(bounds) {
            *base += if keys[*base + half - 1] < *bound { half } else { 0 };
        }
        size -= half;
    }
    for (base, bound) in base.iter_mut().zip(bounds) {
        *base += usize::from(keys[*base] < *bound);
    }
    base
}

impl Sorted<'_> {
    /// Marks every value below or above what is allowed; how many they are.
    pub fn mark(&self, low: f64, high: f64, fails: &mut Fails) -> u64 {
        let (first, last) = (self.keys[0], self.keys[self.keys.len() - 1]);
        let mut count = 0;
        let mut told = false;
        for row in self.rows {
            let slack = self.slack(row);
            let (over, under) = (row.p + last + slack > high, row.p + first - slack < low);
            if (over || under) && !told {
                fails.order(self.columns);
                told = true;
            }
            if over {
                let [from, to] = below(self.keys, &[high - row.p - slack, high - row.p + slack]);
                for column in self.columns[from..to].iter().filter(|column| value(row, column.q, column.y) > high) {
                    fails.one(row.at, column.at);
                    count += 1;
                }
                fails.after(row.at, self.columns, to);
                count += (self.columns.len() - to) as u64;
            }
            if under {
                let [from, to] = below(self.keys, &[low - row.p - slack, low - row.p + slack]);
                for column in self.columns[from..to].iter().filter(|column| value(row, column.q, column.y) < low) {
                    fails.one(row.at, column.at);
                    count += 1;
                }
                fails.before(row.at, self.columns, from);
                count += from as u64;
            }
        }
        count
    }
}
