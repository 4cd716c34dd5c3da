//! Confidence bounds of statistics of values that are independent between sites, but not within a
//! site.
//!
//! A site is one test location: a section with its repeats and all its signals. Values are grouped
//! by site. There are three methods: drawing sites ([`bootstrap`]), and closed forms for the mean
//! ([`Mean`]) and the standard deviation ([`StandardDeviation`]). Their coverage is given in `docs/definitions.md`.

use std::{
    collections::HashMap,
    fmt,
    sync::{Arc, LazyLock, Mutex, PoisonError},
};

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::{
    interval::Interval,
    percentile::{Method, percentile},
    random::SplitMix64,
    statistics::{self, Divisor},
    student::student_quantile,
    sum::{sum, sum_of},
    weighted,
};

/// Number of draws of a bootstrap. 50 of them lie beyond each of the 2.5 % and 97.5 % values.
pub const REPLICATES: usize = 2000;

/// Seed of the draws: an arbitrary number, the same for all results that are compared.
pub const SEED: u64 = 14363;

/// Numbers of sites whose draws are kept: zones differ in theirs. Draws of 100 sites are 1.6 MB.
const MOST_KEPT: usize = 16;

/// Confidence bounds of a statistic.
pub trait Bounds {
    /// The bound that the true value is below with this probability (0 to 1), in the unit of the
    /// statistic.
    ///
    /// # Errors
    /// A probability not between 0 and 1; a bound beyond the range of numbers.
    fn bound(&self, probability: f64) -> Result<f64, ClusterError>;

    /// Two-sided interval with equal tails.
    ///
    /// # Errors
    /// As [`Self::bound`].
    fn interval(&self, confidence: f64) -> Result<Interval, ClusterError> {
        let upper = 0.5 + confidence / 2.0;
        Ok(Interval { low: self.bound(1.0 - upper)?, high: self.bound(upper)? })
    }
}

/// Values by site, in the order in which the sites first appear.
///
/// # Errors
/// Lists of different length, fewer than two sites.
pub fn by_site<T: Copy>(values: &[T], site: &[usize]) -> Result<Vec<Vec<T>>, ClusterError> {
    if values.len() != site.len() {
        return Err(ClusterError::Length { values: values.len(), sites: site.len() });
    }
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut groups: Vec<Vec<T>> = Vec::new();
    for (value, site) in values.iter().zip(site) {
        let at = *numbers.entry(*site).or_insert(groups.len());
        if at == groups.len() {
            groups.push(Vec::new());
        }
        groups[at].push(*value);
    }
    enough(groups.len())?;
    Ok(groups)
}

/// Draws of sites with replacement, as many as there are sites. All statistics of a campaign use
/// the same draws.
#[derive(Clone, Debug)]
pub struct Draws {
    sites: usize,
    /// Site indices from 0, draw after draw.
    drawn: Vec<usize>,
}

impl Draws {
    /// `replicates` draws of `sites` sites, by SplitMix64 from `seed`; the same on every machine.
    ///
    /// # Errors
    /// Fewer than two sites, no draw.
    pub fn new(sites: usize, replicates: usize, seed: u64) -> Result<Self, ClusterError> {
        Self::within(&[sites], replicates, seed)
    }

    /// As [`Self::new`], of sites in several strata one after the other, of which `strata` has the
    /// numbers of sites: each draw has as many of every stratum as there are.
    ///
    /// # Errors
    /// Fewer than two sites in a stratum, no draw.
    pub fn within(strata: &[usize], replicates: usize, seed: u64) -> Result<Self, ClusterError> {
        strata.iter().try_for_each(|sites| enough(*sites))?;
        let sites = strata.iter().sum();
        enough(sites)?;
        if replicates == 0 {
            return Err(ClusterError::NoDraw);
        }
        let mut random = SplitMix64::new(seed);
        let mut drawn = Vec::with_capacity(sites * replicates);
        for _ in 0..replicates {
            let mut first = 0;
            for &sites in strata {
                let one = |_| first + (random.share() * sites as f64) as usize;
                drawn.extend((0..sites).map(one));
                first += sites;
            }
        }
        Ok(Self { sites, drawn })
    }

    /// [`REPLICATES`] draws of `sites` sites from [`SEED`], made once for all statistics of as many
    /// sites.
    ///
    /// # Errors
    /// Fewer than two sites.
    pub fn usual(sites: usize) -> Result<Arc<Self>, ClusterError> {
        static MADE: LazyLock<Mutex<HashMap<usize, Arc<Draws>>>> = LazyLock::new(Mutex::default);
        let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(draws) = made().get(&sites) {
            return Ok(Arc::clone(draws));
        }
        let draws = Arc::new(Self::new(sites, REPLICATES, SEED)?);
        let mut made = made();
        if made.len() >= MOST_KEPT {
            made.clear();
        }
        made.insert(sites, Arc::clone(&draws));
        Ok(draws)
    }

    /// The sites of each draw.
    pub fn iter(&self) -> impl Iterator<Item = &[usize]> {
        self.drawn.chunks(self.sites)
    }
}

/// The statistic of each draw. Bounds are its percentiles (type 7).
#[derive(Clone, Debug, PartialEq)]
pub struct Replicates(Vec<f64>);

impl Replicates {
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Bounds for Replicates {
    fn bound(&self, probability: f64) -> Result<f64, ClusterError> {
        inside(probability)?;
        percentile(&self.0, 100.0 * probability, Method::Linear)
            .map_err(|_| ClusterError::OutOfRange)
    }
}

/// A statistic of the values of the drawn sites, for each draw (Efron and Tibshirani, "An
/// Introduction to the Bootstrap", 1993, chapters 8 and 13).
///
/// # Errors
/// A number of sites other than that of the draws; a draw for which the statistic is not defined.
pub fn bootstrap<T: Copy>(
    sites: &[Vec<T>],
    draws: &Draws,
    statistic: impl Fn(&[T]) -> Option<f64>,
) -> Result<Replicates, ClusterError> {
    if sites.len() != draws.sites {
        return Err(ClusterError::OtherSites { sites: sites.len(), draws: draws.sites });
    }
    let mut replicates = Vec::with_capacity(draws.drawn.len() / draws.sites);
    let mut values = Vec::new();
    for (number, draw) in draws.iter().enumerate() {
        values.clear();
        draw.iter().for_each(|site| values.extend_from_slice(&sites[*site]));
        let value = statistic(&values).filter(|value| value.is_finite());
        replicates.push(value.ok_or(ClusterError::Undefined { draw: number + 1 })?);
    }
    Ok(Replicates(replicates))
}

/// A statistic with its standard error; bounds from Student's t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub standard_error: f64,
    /// Number of sites minus one.
    pub degrees: f64,
}

impl Bounds for Estimate {
    fn bound(&self, probability: f64) -> Result<f64, ClusterError> {
        inside(probability)?;
        let t = student_quantile(probability, self.degrees).ok_or(ClusterError::OutOfRange)?;
        in_range(self.value + t * self.standard_error)
    }
}

/// The mean of all values, with bounds in closed form: variance G/(G - 1) sum(S_j^2)/n^2 for G
/// sites and n values, where S_j is the sum of the deviations of site j from the mean (Liang and
/// Zeger, Biometrika 73, 1986). With one value per site, this is the usual interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    pub estimate: Estimate,
    /// Number of independent values with the same variance of the mean: variance of the values
    /// divided by that of the mean, at most the number of values.
    pub effective_values: f64,
    /// Variance of the mean divided by its variance for independent values (Kish, "Survey
    /// Sampling", 1965).
    pub design_effect: f64,
}

impl Mean {
    /// # Errors
    /// Fewer than two sites; sums that overflow; a value that is not finite.
    pub fn of(sites: &[Vec<f64>]) -> Result<Self, ClusterError> {
        enough(sites.len())?;
        let values = sites.concat();
        let out_of_range = || ClusterError::OutOfRange;
        let mean = statistics::mean(&values).ok_or_else(out_of_range)?;
        let of_values = statistics::variance(&values, Divisor::Sample).ok_or_else(out_of_range)?;
        let sums: Vec<f64> =
            sites.iter().map(|values| sum_of(values, |value| value - mean)).collect();
        let (groups, count) = (sites.len() as f64, values.len() as f64);
        // For equal values, only rounding errors remain.
        let squares = if of_values > 0.0 { sum_of(&sums, |sum| sum * sum) } else { 0.0 };
        let standard_error = in_range((groups / (groups - 1.0) * squares).sqrt() / count)?;
        let variance = standard_error * standard_error;
        Ok(Self {
            estimate: Estimate { value: mean, standard_error, degrees: groups - 1.0 },
            effective_values: if variance > 0.0 { count.min(of_values / variance) } else { count },
            design_effect: if of_values > 0.0 { count * variance / of_values } else { 1.0 },
        })
    }
}

/// The mean of values with weights by the same form: variance G/(G - 1) sum(S_j^2)/sum(w)^2, S_j
/// being the sum of a site's weighted deviations from it. Each value stands before its weight; a
/// site without weight does not count.
///
/// # Errors
/// As [`Mean::of`], of the sites that count.
pub fn weighted_mean(sites: &[Vec<(f64, f64)>]) -> Result<Estimate, ClusterError> {
    let sites: Vec<&Vec<(f64, f64)>> =
        sites.iter().filter(|site| site.iter().any(|(_, weight)| *weight > 0.0)).collect();
    enough(sites.len())?;
    let (values, weights): (Vec<f64>, Vec<f64>) =
        sites.iter().flat_map(|site| site.iter().copied()).filter(|(_, w)| *w > 0.0).unzip();
    let value = weighted::mean(&values, &weights).ok_or(ClusterError::OutOfRange)?;
    let sums: Vec<f64> = sites
        .iter()
        .map(|site| site.iter().map(|(own, weight)| weight * (own - value)).sum())
        .collect();
    let groups = sites.len() as f64;
    // Of equal values nothing but rounding is left.
    let squares = if values.iter().all(|own| *own == values[0]) {
        0.0
    } else {
        sum_of(&sums, |sum| sum * sum)
    };
    let standard_error = in_range((groups / (groups - 1.0) * squares).sqrt() / sum(&weights))?;
    Ok(Estimate { value, standard_error, degrees: groups - 1.0 })
}

impl Bounds for Mean {
    fn bound(&self, probability: f64) -> Result<f64, ClusterError> {
        self.estimate.bound(probability)
    }
}

/// The standard deviation (n - 1) of all values, with bounds in closed form. Its square has
/// approximately a chi-square distribution with nu = 2 sigma^4/var(sigma^2) degrees of freedom,
/// where sigma^2 = sum(V_j)/n, var(sigma^2) = G/(G - 1) sum((V_j - n_j sigma^2)^2)/n^2, and V_j is
/// the sum of squares of the deviations of site j from the mean (method of moments after
/// Satterthwaite, Biometrics Bulletin 2, 1946).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardDeviation {
    pub value: f64,
    /// `None` if all sites have equal sums of squares. Their scatter then gives no information, and
    /// the bounds are the value itself.
    pub degrees: Option<f64>,
}

impl StandardDeviation {
    /// # Errors
    /// As [`Mean::of`].
    pub fn of(sites: &[Vec<f64>]) -> Result<Self, ClusterError> {
        enough(sites.len())?;
        let values = sites.concat();
        let out_of_range = || ClusterError::OutOfRange;
        let mean = statistics::mean(&values).ok_or_else(out_of_range)?;
        let value =
            statistics::standard_deviation(&values, Divisor::Sample).ok_or_else(out_of_range)?;
        if value == 0.0 {
            return Ok(Self { value, degrees: None });
        }
        let squares: Vec<f64> = sites
            .iter()
            .map(|values| sum_of(values, |value| (value - mean) * (value - mean)))
            .collect();
        let (groups, count) = (sites.len() as f64, values.len() as f64);
        let of_one = in_range(sum(&squares) / count)?;
        let beyond: Vec<f64> = squares
            .iter()
            .zip(sites)
            .map(|(sum, values)| sum - values.len() as f64 * of_one)
            .collect();
        let variance = in_range(
            groups / (groups - 1.0) * sum_of(&beyond, |part| part * part) / (count * count),
        )?;
        let degrees = 2.0 * of_one * of_one / variance;
        Ok(Self { value, degrees: (degrees < MOST_DEGREES).then_some(degrees) })
    }
}

/// Degrees of freedom above which the scatter of the sums of squares is rounding; the interval is
/// then narrower than 1e-6 of the value and is replaced by the value.
const MOST_DEGREES: f64 = 1e13;

impl Bounds for StandardDeviation {
    fn bound(&self, probability: f64) -> Result<f64, ClusterError> {
        inside(probability)?;
        let Some(degrees) = self.degrees else { return Ok(self.value) };
        let chi_squared = ChiSquared::new(degrees).map_err(|_| ClusterError::OutOfRange)?;
        in_range(self.value * (degrees / chi_squared.inverse_cdf(1.0 - probability)).sqrt())
    }
}

fn enough(sites: usize) -> Result<(), ClusterError> {
    if sites < 2 { Err(ClusterError::TooFew { sites }) } else { Ok(()) }
}

fn inside(probability: f64) -> Result<(), ClusterError> {
    if probability > 0.0 && probability < 1.0 {
        Ok(())
    } else {
        Err(ClusterError::Probability { probability })
    }
}

fn in_range(value: f64) -> Result<f64, ClusterError> {
    if value.is_finite() { Ok(value) } else { Err(ClusterError::OutOfRange) }
}

/// Reason why there is no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClusterError {
    Length {
        values: usize,
        sites: usize,
    },
    TooFew {
        sites: usize,
    },
    NoDraw,
    OtherSites {
        sites: usize,
        draws: usize,
    },
    /// The statistic is not defined for this draw, from 1.
    Undefined {
        draw: usize,
    },
    Probability {
        probability: f64,
    },
    OutOfRange,
}

impl fmt::Display for ClusterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Length { values, sites } => {
                write!(f, "there are {values} values but {sites} site numbers")
            }
            Self::TooFew { sites: 0 } => f.write_str("there is no site; at least 2 are needed"),
            Self::TooFew { .. } => f.write_str("there is 1 site; at least 2 are needed"),
            Self::NoDraw => f.write_str("the number of draws is zero; at least one draw is needed"),
            Self::OtherSites { sites, draws } => {
                write!(f, "the values are of {sites} sites, the draws of {draws}")
            }
            Self::Undefined { draw } => {
                write!(f, "the statistic is not defined for draw {draw} of the sites")
            }
            Self::Probability { probability } => {
                write!(f, "a probability must be between 0 and 1, this is {probability}")
            }
            Self::OutOfRange => f.write_str("a value is not finite, or a sum overflows"),
        }
    }
}

/// Interval of the mean of values that are independent between sites, but not within a site; see
/// [`Mean`].
///
/// `site` is the site of each value. `None` for fewer than two sites, lists of different length, a
/// value that is not finite, or a confidence not between 0 and 1.
pub fn mean_interval(values: &[f64], site: &[usize], confidence: f64) -> Option<Interval> {
    Mean::of(&by_site(values, site).ok()?).ok()?.interval(confidence).ok()
}

/// Interval of the standard deviation, with equal tails: chi-square with G - 1 degrees of freedom
/// for G sites. The values of one site count as one value, as their dependence is not known. With
/// one value per site, this is the usual interval. [`StandardDeviation::of`] is narrower, but its
/// coverage is below the stated confidence.
///
/// `site` and `None` as in [`mean_interval`].
pub fn standard_deviation_interval(
    values: &[f64],
    site: &[usize],
    confidence: f64,
) -> Option<Interval> {
    let value = statistics::standard_deviation(values, Divisor::Sample)?;
    let degrees = by_site(values, site).ok()?.len() as f64 - 1.0;
    StandardDeviation { value, degrees: Some(degrees) }.interval(confidence).ok()
}
