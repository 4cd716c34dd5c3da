//! Selections as pairs of two halves: every choice of sections of some zones with every choice of
//! the others.
//!
//! A sum over a selection is the sum of two numbers, one for each half. A selection therefore costs
//! one addition.

use super::{
    case::{Case, Kind, Measure, choose},
    groups::{Block, Column, Row},
};
use crate::metrics::moments::{Moment, Moments, Summed};

/// All choices of sections from some strata.
#[derive(Clone, Debug)]
pub struct Half {
    /// Number of sections of one choice.
    pub width: usize,
    /// `width` sections for each choice.
    pub sections: Vec<u32>,
    pub count: usize,
    /// Choices of each stratum, whose combinations are listed.
    factors: Vec<Vec<Vec<u32>>>,
}

/// All pairs of a row and a column are all selections.
#[derive(Clone, Debug)]
pub struct Halves {
    pub rows: Half,
    pub columns: Half,
}

impl Halves {
    /// Numbers of choices of both halves, balanced as evenly as the zones allow; the first is the
    /// larger.
    pub fn sizes(case: &Case) -> (f64, f64) {
        let (rows, columns, _) = split(case);
        (rows, columns)
    }

    pub fn of(case: &Case) -> Self {
        let (_, _, in_rows) = split(case);
        let half = |wanted: bool| {
            let mut half = Half { width: 0, sections: Vec::new(), count: 1, factors: Vec::new() };
            for (stratum, _) in
                case.strata.iter().zip(&in_rows).filter(|(_, in_rows)| **in_rows == wanted)
            {
                half = half.with(&subsets(&stratum.members, stratum.take), stratum.take);
            }
            half
        };
        Self { rows: half(true), columns: half(false) }
    }

    /// The sections of a row and a column, in order.
    pub fn selection(&self, row: u32, column: u32) -> Vec<usize> {
        let halves = [self.rows.choice(row as usize), self.columns.choice(column as usize)];
        let mut sections: Vec<usize> = halves.concat().iter().map(|&at| at as usize).collect();
        sections.sort_unstable();
        sections
    }
}

/// The strata of the rows: the split whose larger half is smallest, with the larger half as rows.
fn split(case: &Case) -> (f64, f64, Vec<bool>) {
    let sizes: Vec<f64> =
        case.strata.iter().map(|stratum| choose(stratum.members.len(), stratum.take)).collect();
    let all: f64 = sizes.iter().product();
    // Beyond 16 zones, the first 16 are split and the others are added to the columns.
    let shared = sizes.len().min(16);
    let product = |mask: u32| {
        (0..shared).filter(|at| mask >> at & 1 == 1).map(|at| sizes[at]).product::<f64>()
    };
    let best = (0..1_u32 << shared)
        .filter(|mask| product(*mask) * product(*mask) >= all)
        .min_by(|a, b| product(*a).total_cmp(&product(*b)));
    let mask = best.unwrap_or((1 << shared) - 1);
    let rows = product(mask);
    (rows, all / rows, (0..sizes.len()).map(|at| at < shared && mask >> at & 1 == 1).collect())
}

/// Every choice of `take` members, in the order of the members.
pub fn subsets(members: &[usize], take: usize) -> Vec<Vec<u32>> {
    let mut found = Vec::new();
    let mut chosen: Vec<usize> = (0..take).collect();
    if take > members.len() {
        return found;
    }
    loop {
        found.push(chosen.iter().map(|&at| members[at] as u32).collect());
        // The last position that can still advance.
        let Some(place) =
            (0..take).rev().find(|&place| chosen[place] < members.len() - take + place)
        else {
            return found;
        };
        chosen[place] += 1;
        for next in place + 1..take {
            chosen[next] = chosen[next - 1] + 1;
        }
    }
}

impl Half {
    fn with(&self, choices: &[Vec<u32>], take: usize) -> Self {
        let mut sections = Vec::with_capacity(self.count * choices.len() * (self.width + take));
        for at in 0..self.count {
            for choice in choices {
                sections.extend_from_slice(self.choice(at));
                sections.extend_from_slice(choice);
            }
        }
        let factors = self.factors.iter().cloned().chain([choices.to_vec()]).collect();
        Self { width: self.width + take, sections, count: self.count * choices.len(), factors }
    }

    /// Sections of one choice.
    pub fn choice(&self, at: usize) -> &[u32] {
        &self.sections[at * self.width..(at + 1) * self.width]
    }

    /// Moments of every choice from those of sections: first within strata, then over all
    /// combinations.
    fn moments(&self, summed: &Summed) -> Vec<Moments> {
        self.factors.iter().fold(vec![Moments::default()], |all, choices| {
            let more: Vec<Moments> = choices
                .iter()
                .map(|choice| summed.total(choice.iter().map(|&at| at as usize)))
                .collect();
            all.iter().flat_map(|sums| more.iter().map(|more| sums.plus(*more))).collect()
        })
    }

    /// Every choice of the half.
    pub fn choices(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.count).map(|at| self.choice(at))
    }
}

/// A statistic over selections, in terms of the two halves.
#[derive(Clone, Debug)]
pub enum Parts {
    /// Sums, which `form` maps to the value; and the choices of rows and columns without a value.
    Sums { blocks: Vec<Block>, form: Form, undefined: Vec<(Vec<u32>, Vec<u32>)> },
    /// The larger of both halves; negated for the smallest. `None` where a half has no value.
    Extremes { rows: Vec<Option<f64>>, columns: Vec<Option<f64>>, negative: bool },
    /// Not a function of the halves.
    Pooled,
}

/// Meaning of the sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Value,
    /// The square of the value.
    Square,
}

impl Form {
    pub fn map(self, sum: f64) -> f64 {
        match self {
            Self::Value => sum,
            Self::Square => sum.max(0.0).sqrt(),
        }
    }

    /// Bounds of the sum for values between two bounds.
    pub fn bounds(self, low: f64, high: f64) -> (f64, f64) {
        match self {
            Self::Value => (low, high),
            Self::Square => (if low > 0.0 { low * low } else { f64::NEG_INFINITY }, high * high),
        }
    }
}

impl Measure {
    /// The statistic in terms of the two halves.
    pub fn parts(&self, halves: &Halves) -> Parts {
        if let Kind::Sum(moment) = self.kind {
            return self.sums(&Summed::new(moment, self.scale, &self.values), halves);
        }
        let Some((sign, of_section)) = self.extremes() else { return Parts::Pooled };
        let of = |half: &Half| {
            let largest = |choice: &[u32]| {
                choice.iter().filter_map(|&at| of_section[at as usize]).reduce(f64::max)
            };
            half.choices().map(largest).collect()
        };
        let (rows, columns) = (of(&halves.rows), of(&halves.columns));
        Parts::Extremes { rows, columns, negative: sign < 0.0 }
    }

    fn sums(&self, summed: &Summed, halves: &Halves) -> Parts {
        let (rows, columns) = (halves.rows.moments(summed), halves.columns.moments(summed));
        let form = if summed.kind == Moment::Mean { Form::Value } else { Form::Square };
        let shift = if summed.kind == Moment::Mean { summed.centre * self.scale } else { 0.0 };
        let square = self.scale * self.scale;
        let (mut blocks, mut undefined) = (Vec::new(), Vec::new());
        // Choices with the same number of values have the same divisor.
        for of_rows in by_count(&rows) {
            for of_columns in by_count(&columns) {
                let n = of_rows.0 + of_columns.0;
                let weights = match summed.kind {
                    Moment::Mean if n > 0.0 => Weights { x: self.scale / n, ..Weights::default() },
                    Moment::RootMeanSquare if n > 0.0 => {
                        Weights { xx: square / n, ..Weights::default() }
                    }
                    Moment::Deviation { ddof } if n > ddof && n >= 1.0 => {
                        let xx = square / (n - ddof);
                        Weights { x: 0.0, xx, product: xx / n }
                    }
                    _ => {
                        undefined.push((of_rows.1.clone(), of_columns.1));
                        continue;
                    }
                };
                blocks.push(block((&rows, &of_rows.1), (&columns, &of_columns.1), weights, shift));
            }
        }
        Parts::Sums { blocks, form, undefined }
    }
}

/// Weights of a sum, a sum of squares and the square of a sum.
#[derive(Clone, Copy, Debug, Default)]
struct Weights {
    x: f64,
    xx: f64,
    product: f64,
}

/// The numbers of values of choices in increasing order, each with its choices.
fn by_count(choices: &[Moments]) -> Vec<(f64, Vec<u32>)> {
    let mut counts: Vec<f64> = choices.iter().map(|choice| choice.n).collect();
    counts.sort_unstable_by(f64::total_cmp);
    counts.dedup();
    let of = |count: f64| {
        let same = (0..choices.len()).filter(|&at| choices[at].n == count);
        (count, same.map(|at| at as u32).collect())
    };
    counts.into_iter().map(of).collect()
}

fn block(
    (rows, of_rows): (&[Moments], &[u32]),
    (columns, of_columns): (&[Moments], &[u32]),
    weights: Weights,
    shift: f64,
) -> Block {
    let part = |sums: &Moments| {
        weights.x * sums.x + weights.xx * sums.xx - weights.product * sums.x * sums.x
    };
    let row = |&at: &u32| {
        let sums = &rows[at as usize];
        Row { p: part(sums) + shift, c: 2.0 * weights.product * sums.x, at }
    };
    let column = |&at: &u32| {
        let sums = &columns[at as usize];
        Column { q: part(sums), y: if weights.product == 0.0 { 0.0 } else { sums.x }, at }
    };
    Block {
        rows: of_rows.iter().map(row).collect(),
        columns: of_columns.iter().map(column).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subsets_are_all_and_once() {
        assert_eq!(subsets(&[4, 7, 9], 2), [vec![4, 7], vec![4, 9], vec![7, 9]]);
        assert_eq!(subsets(&[1, 2], 0), [Vec::<u32>::new()]);
        assert_eq!(subsets(&[1], 2), Vec::<Vec<u32>>::new());
        assert_eq!(subsets(&(0..9).collect::<Vec<_>>(), 3).len(), 84);
        assert_eq!(
            [choose(9, 3), choose(40, 3), choose(5, 5), choose(5, 0)],
            [84.0, 9880.0, 1.0, 1.0]
        );
    }
}
