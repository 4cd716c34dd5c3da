//! Number of values, their sum and their sum of squares, from which means and standard deviations
//! of joined sets follow.

/// Sums of a set of values, about a centre that the user knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    pub n: f64,
    pub x: f64,
    pub xx: f64,
}

impl Moments {
    /// Of values about a centre; one near their mean avoids cancellation.
    pub fn about(centre: f64, values: &[f64]) -> Self {
        let centred = values.iter().map(|value| value - centre);
        Self {
            n: values.len() as f64,
            x: centred.clone().sum(),
            xx: centred.map(|value| value * value).sum(),
        }
    }

    /// Of both sets.
    pub fn plus(self, other: Self) -> Self {
        Self { n: self.n + other.n, x: self.x + other.x, xx: self.xx + other.xx }
    }

    /// Of this set without a part of it.
    pub fn minus(self, other: Self) -> Self {
        Self { n: self.n - other.n, x: self.x - other.x, xx: self.xx - other.xx }
    }

    /// Sum of squares about the mean.
    pub fn squares(&self) -> f64 {
        (self.xx - self.x * self.x / self.n).max(0.0)
    }
}

/// A statistic that follows from [`Moments`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    Mean,
    /// Standard deviation with divisor n - `ddof`.
    Deviation {
        ddof: f64,
    },
    RootMeanSquare,
}

impl Moment {
    /// The statistic of this name in protocols; `None` if it needs more than sums.
    pub fn named(name: &str, ddof: usize) -> Option<Self> {
        match name {
            "mean" => Some(Self::Mean),
            "std" => Some(Self::Deviation { ddof: ddof as f64 }),
            "rms" => Some(Self::RootMeanSquare),
            _ => None,
        }
    }
}

/// A statistic over any members of a set.
#[derive(Clone, Debug)]
pub struct Summed {
    pub kind: Moment,
    /// What the moments are about; 0 for a root mean square.
    pub centre: f64,
    /// By which the value is multiplied: one over its limit.
    pub scale: f64,
    /// Of each member.
    pub moments: Vec<Moments>,
}

impl Summed {
    /// From the values of each member, about their common mean.
    pub fn new(kind: Moment, scale: f64, members: &[Vec<f64>]) -> Self {
        let all: Vec<f64> = members.iter().flatten().copied().collect();
        let centre = match kind {
            Moment::RootMeanSquare => 0.0,
            _ => all.iter().sum::<f64>() / all.len().max(1) as f64,
        };
        let moments = members.iter().map(|values| Moments::about(centre, values)).collect();
        Self { kind, centre, scale, moments }
    }

    /// The moments of some members together.
    pub fn total(&self, members: impl IntoIterator<Item = usize>) -> Moments {
        members.into_iter().fold(Moments::default(), |sum, at| sum.plus(self.moments[at]))
    }

    /// The statistic of members with these moments in all; `None` where it is not defined.
    pub fn value(&self, total: Moments) -> Option<f64> {
        let value = match self.kind {
            Moment::Mean => self.centre + total.x / total.n,
            Moment::RootMeanSquare => (total.xx / total.n).sqrt(),
            Moment::Deviation { ddof } if total.n > ddof => {
                (total.squares() / (total.n - ddof)).sqrt()
            }
            Moment::Deviation { .. } => f64::NAN,
        };
        Some(value * self.scale).filter(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::super::statistics::{Divisor, mean, rms, standard_deviation};
    use super::*;

    /// Over any members, what the statistics of their values are.
    #[test]
    fn sums_give_the_statistics_of_the_values() {
        let members = [vec![3.0, 3.5], vec![], vec![-1.0], vec![2.0, 9.0, 4.0]];
        for some in [&[0, 1, 2, 3][..], &[0, 3], &[2, 0], &[3]] {
            let values: Vec<f64> = some.iter().flat_map(|&at| members[at].clone()).collect();
            for (moment, wanted) in [
                (Moment::Mean, mean(&values)),
                (Moment::Deviation { ddof: 1.0 }, standard_deviation(&values, Divisor::Sample)),
                (Moment::RootMeanSquare, rms(&values)),
            ] {
                let summed = Summed::new(moment, 0.5, &members);
                let all = summed.total(0..4);
                let others = summed.total((0..4).filter(|at| !some.contains(at)));
                for total in [summed.total(some.iter().copied()), all.minus(others)] {
                    let found = summed.value(total).zip(wanted);
                    assert!(found.is_some_and(|(a, b)| (a - 0.5 * b).abs() < 1e-12), "{found:?}");
                }
            }
        }
        let scatter = Summed::new(Moment::Deviation { ddof: 1.0 }, 1.0, &members);
        assert_eq!(
            (scatter.value(scatter.total([2])), scatter.value(scatter.total([1]))),
            (None, None)
        );
    }
}
