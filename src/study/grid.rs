//! Order statistics of means over all selections where even the half selections are too many to
//! list.
//!
//! The contribution of each section to the mean is rounded to a grid. The number of choices of a
//! zone for each sum of contributions is counted by dynamic programming, and a convolution joins
//! the zones. The rounding error of a selection is bounded by the remainders of its sections, so
//! that every quartile lies between two bounds, which are reported.

use realfft::num_complex::Complex;

use super::{
    case::{Case, Kind, Measure},
    halves::Form,
};
use crate::metrics::{fourier, moments::Moment};
use crate::result::study::{Intervals, Spread};

/// Largest and smallest number of grid cells.
const CELLS: (usize, usize) = (1 << 20, 1 << 12);
/// Largest number of additions; more sections get a coarser grid.
const WORK: f64 = 2e9;
/// Tolerance for rounding in sums of shares over all cells.
const UNSURE: f64 = 1e-9;

/// A statistic that is a sum of contributions of the sections, or the root of one.
#[derive(Debug)]
pub struct Additive {
    /// Per zone the number of sections taken, and the contribution of each section in increasing
    /// order.
    strata: Vec<(usize, Vec<(f64, usize)>)>,
    form: Form,
}

impl Additive {
    /// `None` for other statistics, and where the number of values differs between selections.
    pub fn of(case: &Case, measure: &Measure) -> Option<Self> {
        let (form, weight) = match measure.kind {
            Kind::Sum(Moment::Mean) => (Form::Value, measure.scale),
            Kind::Sum(Moment::RootMeanSquare) => (Form::Square, measure.scale * measure.scale),
            _ => return None,
        };
        let mut pairs = 0;
        for stratum in &case.strata {
            let mut counts = stratum.members.iter().map(|&at| measure.values[at].len());
            let count = counts.next()?;
            if counts.any(|other| other != count) {
                return None;
            }
            pairs += stratum.take * count;
        }
        if pairs == 0 {
            return None;
        }
        let part = |at: usize| {
            let values = measure.values[at].iter();
            weight / pairs as f64
                * if form == Form::Square {
                    values.map(|value| value * value).sum::<f64>()
                } else {
                    values.sum()
                }
        };
        let strata = case.strata.iter().map(|stratum| {
            let mut parts: Vec<(f64, usize)> =
                stratum.members.iter().map(|&at| (part(at), at)).collect();
            parts.sort_by(|a, b| a.0.total_cmp(&b.0));
            (stratum.take, parts)
        });
        Some(Self { strata: strata.collect(), form })
    }

    /// The selections with the smallest and the largest value.
    pub fn ends(&self) -> (Vec<usize>, Vec<usize>) {
        let of = |greatest: bool| {
            let mut sections: Vec<usize> = self
                .strata
                .iter()
                .flat_map(|(take, parts)| ends(parts, *take, greatest))
                .map(|(_, at)| *at)
                .collect();
            sections.sort_unstable();
            sections
        };
        (of(false), of(true))
    }

    /// Exact minimum and maximum, quartiles and outliers with bounds. `None` where the number of
    /// choices exceeds the floating-point range.
    pub fn spread(&self, combinations: f64) -> Option<Spread> {
        let sum_of = |greatest: bool| -> f64 {
            self.strata
                .iter()
                .map(|(take, parts)| {
                    ends(parts, *take, greatest).iter().map(|(part, _)| part).sum::<f64>()
                })
                .sum()
        };
        let (least, greatest) = (sum_of(false), sum_of(true));
        let counted = self.counted()?;
        let (value, edges) =
            (|sum: f64| self.form.map(sum), |at: usize| counted.edges(at, least, greatest));
        let mut upto = Vec::with_capacity(counted.shares.len());
        let mut sum = 0.0;
        for share in &counted.shares {
            sum += share.max(0.0);
            upto.push(sum);
        }
        let unsure = UNSURE + 1.0 / combinations;
        let quartiles = [0.25, 0.5, 0.75].map(|share| {
            let place = |share: f64| upto.partition_point(|upto| *upto < share).min(upto.len() - 1);
            (value(edges(place(share - unsure)).0), value(edges(place(share + unsure)).1))
        });
        let [q1, median, q3] = quartiles.map(|(low, high)| f64::midpoint(low, high));
        let reach = 1.5 * (q3 - q1);
        let beyond = counted.shares.iter().enumerate().filter(|(at, _)| {
            let (low, high) = edges(*at);
            let middle = value(f64::midpoint(low, high));
            middle < q1 - reach || middle > q3 + reach
        });
        let outliers =
            (combinations * beyond.map(|(_, share)| share.max(0.0)).sum::<f64>()).round() as u64;
        let within = quartiles.iter().map(|(low, high)| 0.5 * (high - low)).fold(0.0, f64::max);
        Some(Spread {
            min: value(least),
            q1,
            median,
            q3,
            max: value(greatest),
            outliers,
            count: combinations,
            exact: false,
            within: Some(within),
            intervals: Intervals::default(),
        })
    }

    fn counted(&self) -> Option<Counted> {
        let taken: usize = self.strata.iter().map(|(take, _)| take).sum();
        let work: f64 =
            self.strata.iter().map(|(take, parts)| *take as f64 * parts.len() as f64).sum();
        let mut cells = CELLS.0;
        while cells > CELLS.1 && work * cells as f64 > WORK {
            cells /= 2;
        }
        if taken >= cells / 2 {
            return None;
        }
        let span: f64 = self
            .strata
            .iter()
            .map(|(take, parts)| {
                ends(parts, *take, true).iter().map(|(part, _)| part - parts[0].0).sum::<f64>()
            })
            .sum();
        // Rounding adds at most half a cell per section taken.
        let step = if span > 0.0 { span / (cells - taken - 1) as f64 } else { 1.0 };
        let forward = fourier::forward(cells);
        let (mut all, mut first, mut rest) =
            (vec![Complex::new(1.0, 0.0); cells / 2 + 1], 0.0, (0.0, 0.0));
        for (take, parts) in &self.strata {
            let places: Vec<usize> = parts
                .iter()
                .map(|(part, _)| ((part - parts[0].0) / step).round() as usize)
                .collect();
            let mut rests: Vec<f64> = parts
                .iter()
                .zip(&places)
                .map(|((part, _), place)| part - parts[0].0 - *place as f64 * step)
                .collect();
            rests.sort_unstable_by(f64::total_cmp);
            first += *take as f64 * parts[0].0;
            rest.0 += rests[..*take].iter().sum::<f64>();
            rest.1 += rests[rests.len() - take..].iter().sum::<f64>();
            let mut shares = choices(&places, *take);
            let total: f64 = shares.iter().sum();
            if !total.is_finite() {
                return None;
            }
            shares.iter_mut().for_each(|share| *share /= total);
            shares.resize(cells, 0.0);
            let mut spectrum = forward.make_output_vec();
            forward.process(&mut shares, &mut spectrum).ok()?;
            all.iter_mut().zip(spectrum).for_each(|(all, of)| *all *= of);
        }
        let mut shares = vec![0.0; cells];
        fourier::inverse(cells).process(&mut all, &mut shares).ok()?;
        shares.iter_mut().for_each(|share| *share /= cells as f64);
        Some(Counted { shares, first, step, rest })
    }
}

/// The `take` smallest or largest contributions.
fn ends(parts: &[(f64, usize)], take: usize, greatest: bool) -> &[(f64, usize)] {
    if greatest { &parts[parts.len() - take..] } else { &parts[..take] }
}

/// For every sum of positions, the number of choices of `take` of them with this sum.
fn choices(places: &[usize], take: usize) -> Vec<f64> {
    // The positions are sorted: the last ones are the largest.
    let length = places[places.len() - take..].iter().sum::<usize>() + 1;
    let mut counts = vec![vec![0.0_f64; length]; take + 1];
    counts[0][0] = 1.0;
    for (known, place) in places.iter().enumerate() {
        for taken in (1..=take.min(known + 1)).rev() {
            let (before, now) = counts.split_at_mut(taken);
            now[0][*place..]
                .iter_mut()
                .zip(&before[taken - 1])
                .for_each(|(now, before)| *now += before);
        }
    }
    counts.swap_remove(take)
}

/// Share of the selections in every cell.
struct Counted {
    shares: Vec<f64>,
    /// Sum at the first cell, distance of cells, and largest deviation of a selection below and
    /// above its cell.
    first: f64,
    step: f64,
    rest: (f64, f64),
}

impl Counted {
    /// Lowest and highest sum of the selections of a cell.
    fn edges(&self, at: usize, least: f64, greatest: f64) -> (f64, f64) {
        let middle = self.first + at as f64 * self.step;
        (
            (middle + self.rest.0).clamp(least, greatest),
            (middle + self.rest.1).clamp(least, greatest),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_of_places_are_counted() {
        // 1 + 2, 1 + 4, 2 + 4 and 2 with the other 2.
        let counts = choices(&[1, 2, 2, 4], 2);
        assert_eq!(counts, [0.0, 0.0, 0.0, 2.0, 1.0, 1.0, 2.0]);
        assert_eq!(choices(&[0, 0, 0], 3), [1.0]);
    }
}
