//! Numerical methods: slices in, numbers out, no I/O.
//!
//! Values are in SI. Quantities and limits are defined by protocols, not here. Where a number is
//! not defined (no values, a division by zero, a sample that is not finite), the result is `None`
//! or an error with the reason.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`filter`] | signal at a constant rate | filtered signal |
//! | [`window`] | signal over an axis | one mean or rms per sliding window |
//! | [`resample`] | signal over an axis | the signal at other points |
//! | [`percentile`] | values | order statistics, interpolated |
//! | [`statistics`], [`interval`] | values | mean, scatter, extremes, regression; confidence intervals |
//! | [`weighted`] | values and weights | mean, scatter, order statistics |
//! | [`cluster`] | values by site | bounds of any statistic: bootstrap over sites, closed forms |
//! | [`reduction`] | groups of members and their scatter | fewer members with nearly the same scatter |
//! | [`regression`] | values and regressors | least squares, bounds at a point |
//! | [`normal`] | probability | quantiles of the normal distribution |
//! | [`student`] | probability | quantiles of Student's t |
//! | [`sampling`] | values | signs of recording faults: held, saturated, quantised, spikes, gaps |
//! | [`spectrum`] | values | single lines: interference |
//! | [`pair`] | simulated and measured signal | measures of agreement |
//! | [`hull`] | points | the nearest point of their convex hull, its corners |
//! | [`random_effects`] | estimates with variances | the variance between them |
//! | [`synchronise`] | signals of two records | the shift between them |
//! | [`drift`] | signals of two long records | the shift along them |
//! | [`fourier`] | a length | the plan of a Fourier transform |
//! | [`coherence`] | simulated and measured signal | the linear dependence as a function of frequency |
//! | [`welch`] | signal at a constant rate | power spectral density |
//! | [`rainflow`] | signal | the ranges of its half cycles |
//! | [`along`] | signal over an axis | derivative, integral, shifted signal |
//! | [`moments`] | values of the members of a set | mean and scatter of any of them, from sums |
//! | [`rank`] | pairs of values | rank correlation |
//! | [`disturb`] | signal | the signal with an offset, a gain, a delay or noise of a stated size |
//! | [`random`] | seed | numbers that are the same on every machine |
//! | [`hysteresis`] | two loops of output over input | their difference, branch by branch |

pub mod along;
pub mod cluster;
pub mod coherence;
pub mod disturb;
pub mod drift;
pub mod filter;
pub mod fourier;
pub mod hull;
pub mod hysteresis;
mod incomplete_beta;
pub mod interval;
pub mod moments;
pub mod normal;
pub mod pair;
pub mod percentile;
pub mod rainflow;
pub mod random;
pub mod random_effects;
pub mod rank;
pub mod reduction;
pub mod regression;
pub mod resample;
pub mod robust;
pub mod sampling;
pub mod sinc;
pub mod spectrum;
pub mod statistics;
pub mod student;
mod sum;
pub mod synchronise;
pub mod weighted;
pub mod welch;
pub mod window;

/// A number for a message, with six significant digits to hide rounding of unit conversions.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
