//! Sums of two signals at many shifts, part by part of the range.

use std::ops::Range;

use super::{BLOCKS, Pair};
use crate::metrics::resample::Located;

/// Sums of which a correlation is computed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    pub n: f64,
    x: f64,
    y: f64,
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Sums {
    #[cfg(test)]
    fn of(x: &[f64], y: &[f64]) -> Self {
        let mut sums = Self { n: x.len() as f64, ..Self::default() };
        for (x, y) in x.iter().zip(y) {
            sums.x += x;
            sums.y += y;
            sums.xx += x * x;
            sums.yy += y * y;
            sums.xy += x * y;
        }
        sums
    }

    pub fn plus(self, other: &Self) -> Self {
        Self {
            n: self.n + other.n,
            x: self.x + other.x,
            y: self.y + other.y,
            xx: self.xx + other.xx,
            yy: self.yy + other.yy,
            xy: self.xy + other.xy,
        }
    }

    /// Residual sum of squares of the regression line.
    pub fn left(&self) -> f64 {
        let r = self.correlation();
        (self.xx - self.x * self.x / self.n) * (1.0 - r * r)
    }

    /// 0 where the correlation is not defined.
    pub fn correlation(&self) -> f64 {
        let (xx, yy) = (self.xx - self.x * self.x / self.n, self.yy - self.y * self.y / self.n);
        let r = (self.xy - self.x * self.y / self.n) / (xx.max(0.0).sqrt() * yy.max(0.0).sqrt());
        if r.is_finite() { r.clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// Sums of each part of the range.
type Parts = [Sums; BLOCKS];

/// Shifts whose sums are computed side by side.
const LANES: usize = 4;

/// For each pair the sums at each shift, the smallest shift first; `None` if one of its signals
/// does not vary.
///
/// Signals of a record share their axis, on which points are located once for all of them. Shifts
/// that are multiples of the grid step need one interpolation in total, others one each.
pub fn of_pairs(
    pairs: &[Pair<'_>],
    grid: &[f64],
    shifts: &[f64],
    on_grid: bool,
) -> Vec<Option<Vec<Parts>>> {
    let mut grids: Vec<(&[f64], Option<Located>)> = Vec::new();
    let mut all: Vec<Option<Compared<'_>>> =
        pairs.iter().map(|pair| Compared::new(pair, grid, &mut grids)).collect();
    let mut axes: Vec<&[f64]> = Vec::new();
    for compared in all.iter().flatten() {
        if !axes.iter().any(|known| std::ptr::eq(*known, compared.axis)) {
            axes.push(compared.axis);
        }
    }
    for axis in axes {
        let (Some(first), Some(last)) = (axis.first(), axis.last()) else { continue };
        // The grid has the range of the record; rounding may put its ends just outside.
        let located = |points: &mut dyn Iterator<Item = f64>| {
            Located::on(axis, &points.map(|x| x.clamp(*first, *last)).collect::<Vec<_>>())
        };
        let mut on_axis: Vec<&mut Compared<'_>> =
            all.iter_mut().flatten().filter(|compared| std::ptr::eq(compared.axis, axis)).collect();
        if on_grid {
            let (farthest, step) = (shifts.last().copied().unwrap_or(0.0), grid[1] - grid[0]);
            let Ok(wide) = located(
                &mut (0..grid.len() + shifts.len() - 1)
                    .map(|k| grid[0] - farthest + k as f64 * step),
            ) else {
                continue;
            };
            on_axis.iter_mut().for_each(|compared| compared.add_on_grid(&wide, shifts.len()));
        } else {
            for shift in shifts {
                let Ok(points) = located(&mut grid.iter().map(|x| x - shift)) else { break };
                on_axis.iter_mut().for_each(|compared| compared.add(&points));
            }
        }
    }
    let whole = |compared: &Compared<'_>| compared.varies && compared.at.len() == shifts.len();
    all.into_iter().map(|compared| compared.filter(whole).map(|compared| compared.at)).collect()
}

/// A pair of signals, and its sums so far.
struct Compared<'a> {
    /// On the grid, without its mean.
    simulated: Vec<f64>,
    /// The sums of the simulated signal alone, which are the same at every shift.
    alone: Parts,
    axis: &'a [f64],
    measured: &'a [f64],
    /// Of the measured samples.
    mean: f64,
    /// Whether the measured signal varies where it is compared.
    varies: bool,
    at: Vec<Parts>,
}

/// The points of the grid in a part.
fn part(block: usize, points: usize) -> Range<usize> {
    block * points / BLOCKS..(block + 1) * points / BLOCKS
}

impl<'a> Compared<'a> {
    /// `grids` are the places of the grid on the axes of the simulated signals.
    fn new(
        pair: &Pair<'a>,
        grid: &[f64],
        grids: &mut Vec<(&'a [f64], Option<Located>)>,
    ) -> Option<Self> {
        let ((simulated_axis, simulated), (axis, measured)) = (pair.simulated, pair.measured);
        if simulated_axis.len() != simulated.len() || axis.len() != measured.len() {
            return None;
        }
        let at = grids
            .iter()
            .position(|(known, _)| std::ptr::eq(*known, simulated_axis))
            .unwrap_or_else(|| {
                grids.push((simulated_axis, Located::on(simulated_axis, grid).ok()));
                grids.len() - 1
            });
        let simulated = centred(grids[at].1.as_ref()?.values(simulated))?;
        let alone = std::array::from_fn(|block| {
            let part = &simulated[part(block, grid.len())];
            let mut sums = Sums { n: part.len() as f64, ..Sums::default() };
            for x in part {
                sums.x += x;
                sums.xx += x * x;
            }
            sums
        });
        let mean = measured.iter().sum::<f64>() / measured.len() as f64;
        Some(Self { simulated, alone, axis, measured, mean, varies: false, at: Vec::new() })
    }

    /// The measured signal at some points, without its mean.
    fn measured(&mut self, points: &Located) -> Vec<f64> {
        let mut values = points.values(self.measured);
        values.iter_mut().for_each(|value| *value -= self.mean);
        let most = 1e-12 * (1.0 + self.mean.abs());
        self.varies |= values.iter().any(|value| (value - values[0]).abs() > most);
        values
    }

    /// The sums at the next shift.
    fn add(&mut self, points: &Located) {
        let y = self.measured(points);
        self.at.push(self.of_parts(&y));
    }

    fn of_parts(&self, y: &[f64]) -> Parts {
        std::array::from_fn(|block| {
            let part = part(block, y.len());
            let mut sums = self.alone[block];
            for (x, y) in self.simulated[part.clone()].iter().zip(&y[part]) {
                sums.y += y;
                sums.yy += y * y;
                sums.xy += x * y;
            }
            sums
        })
    }

    /// The sums at all shifts, from the measured signal on the grid and as far beside it as the
    /// shifts reach.
    fn add_on_grid(&mut self, wide: &Located, shifts: usize) {
        let wide = self.measured(wide);
        let points = self.simulated.len();
        let mut at = 0;
        while at < shifts {
            // The largest shift has the first points.
            let first = shifts - 1 - at;
            if first + 1 < LANES {
                self.at.push(self.of_parts(&wide[first..][..points]));
                at += 1;
                continue;
            }
            let from = first + 1 - LANES;
            let lanes: [_; BLOCKS] = std::array::from_fn(|block| {
                let part = part(block, points);
                let y = &wide[from + part.start..from + part.end + LANES - 1];
                sums_of_lanes(&self.simulated[part], y)
            });
            // Later points belong to smaller shifts.
            for lane in (0..LANES).rev() {
                self.at.push(std::array::from_fn(|block| {
                    let [y, yy, xy] = lanes[block][lane];
                    Sums { y, yy, xy, ..self.alone[block] }
                }));
            }
            at += LANES;
        }
    }
}

/// The sums of y, y^2 and xy with y from each of the first samples on: each in the order of the
/// samples, several at a time.
fn sums_of_lanes(x: &[f64], y: &[f64]) -> [[f64; 3]; LANES] {
    let (mut sum, mut squares, mut products) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for (x, y) in x.iter().zip(y.array_windows::<LANES>()) {
        for lane in 0..LANES {
            sum[lane] += y[lane];
            squares[lane] += y[lane] * y[lane];
            products[lane] += x * y[lane];
        }
    }
    std::array::from_fn(|lane| [sum[lane], squares[lane], products[lane]])
}

/// The values minus their mean, so that sums of squares keep their digits.
fn centred(mut values: Vec<f64>) -> Option<Vec<f64>> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values.iter().any(|value| value.abs() > 1e-12 * (1.0 + mean.abs())).then_some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::resample::interpolate;

    #[test]
    fn sums_of_parts_are_those_of_the_whole() {
        let (x, y) = ([1.0, 2.0, 4.0, 7.0, 11.0], [3.0, 1.0, 4.0, 1.0, 5.0]);
        let parts = |sums: Sums| [sums.n, sums.x, sums.y, sums.xx, sums.yy, sums.xy];
        let both = Sums::of(&x[..2], &y[..2]).plus(&Sums::of(&x[2..], &y[2..]));
        assert_eq!(parts(both), [5.0, 25.0, 14.0, 191.0, 52.0, 83.0]);
        assert_eq!(parts(both), parts(Sums::of(&x, &y)));
        // Sums of squares about the means 66 and 12.8, sum of products 13.
        assert!((both.correlation() - 13.0 / (66.0_f64 * 12.8).sqrt()).abs() < 1e-14);
        assert!((both.left() - (66.0 - 169.0 / 12.8)).abs() < 1e-12, "{}", both.left());
    }

    /// The same sums, each pair and each shift by itself, to the last bit.
    #[test]
    fn pairs_and_shifts_together_give_the_same_sums() {
        let axis: Vec<f64> =
            (0..700).map(|k| f64::from(k) * 0.21 + 0.05 * f64::from(k % 3)).collect();
        let other: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.25).collect();
        let wave = |x: &f64| (0.3 * x).sin() + (1.7 * x).cos();
        let of = |axis: &[f64], phase: f64| {
            axis.iter().map(|x| 5.0 + wave(&(x + phase))).collect::<Vec<_>>()
        };
        let (a, b, c, still) = (of(&axis, 0.0), of(&other, 0.4), of(&other, 2.0), vec![3.0; 600]);
        let pair = |measured| Pair { simulated: (&axis, &a), measured, group: 0 };
        let pairs =
            [pair((&other, &b)), pair((&axis, &a)), pair((&other, &still)), pair((&other, &c))];
        let grid: Vec<f64> = (0..200).map(|k| 20.0 + 0.5 * f64::from(k)).collect();
        for (shifts, on_grid) in
            [(-5..=5, true), (-7..=5, true), (-3..=4, false)].map(|(shifts, on_grid)| {
                (
                    shifts
                        .map(|k| f64::from(k) * if on_grid { 0.5 } else { 0.11 })
                        .collect::<Vec<_>>(),
                    on_grid,
                )
            })
        {
            let together = of_pairs(&pairs, &grid, &shifts, on_grid);
            assert!(together[2].is_none() && together.len() == 4);
            for (found, pair) in together
                .iter()
                .zip(&pairs)
                .filter_map(|(found, pair)| Some((found.as_ref()?, pair)))
            {
                let x = centred(
                    interpolate(pair.simulated.0, pair.simulated.1, &grid).expect("inside"),
                )
                .expect("varies");
                let mean = pair.measured.1.iter().sum::<f64>() / pair.measured.1.len() as f64;
                for (at, shift) in shifts.iter().enumerate() {
                    // As the points on the grid are computed.
                    let (farthest, step) = (shifts[shifts.len() - 1], grid[1] - grid[0]);
                    let points: Vec<f64> = match on_grid {
                        true => (0..grid.len())
                            .map(|k| grid[0] - farthest + (k + shifts.len() - 1 - at) as f64 * step)
                            .collect(),
                        false => grid.iter().map(|x| x - shift).collect(),
                    };
                    let mut y =
                        interpolate(pair.measured.0, pair.measured.1, &points).expect("inside");
                    y.iter_mut().for_each(|y| *y -= mean);
                    for (block, sums) in found[at].iter().enumerate() {
                        let part = part(block, grid.len());
                        let Sums { n, x: a, y: b, xx, yy, xy } =
                            Sums::of(&x[part.clone()], &y[part]);
                        assert_eq!(
                            [sums.n, sums.x, sums.y, sums.xx, sums.yy, sums.xy],
                            [n, a, b, xx, yy, xy],
                            "{shift}"
                        );
                    }
                }
            }
        }
    }
}
