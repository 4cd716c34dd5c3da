//! Numbers from signals: slices in, numbers out, no I/O.
//!
//! Values are in SI and carry no quantity: what a signal is and which limit holds is a protocol's business. Where a number
//! is not defined (nothing to average, a division by zero, a sample that is not finite) there is none: `None` or an error
//! with the reason, never a stand-in.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`filter`] | signal at a constant rate | filtered signal |
//! | [`window`] | signal over an axis | one mean or rms per sliding window |
//! | [`resample`] | signal over an axis | the signal at other points |
//! | [`percentile`] | values | order statistics, interpolated |
//! | [`statistics`], [`interval`] | values | mean, scatter, extremes, regression; confidence intervals |
//! | [`cluster`] | values by site | bounds of any statistic: drawing sites, leaving one out, closed forms |
//! | [`regression`] | values and regressors | least squares, bounds at a point |
//! | [`student`] | probability | quantiles of Student's t |
//! | [`sampling`] | values | how they were recorded: held, saturated, quantised |
//! | [`pair`] | simulated and measured signal | how well they agree |
//! | [`random_effects`] | estimates with variances | by how much they scatter beyond these |
//! | [`synchronise`] | signals of two records | by how much one lies ahead of the other |
//! | [`coherence`] | simulated and measured signal | how far one follows the other linearly, by frequency |
//! | [`along`] | signal over an axis | derivative, integral, the signal elsewhere |
//! | [`hysteresis`] | two loops of output over input | how well they agree, branch by branch |

pub mod along;
pub mod cluster;
pub mod coherence;
pub mod filter;
pub mod hysteresis;
mod incomplete_beta;
pub mod interval;
pub mod pair;
pub mod percentile;
pub mod random_effects;
pub mod regression;
pub mod resample;
pub mod sampling;
pub mod statistics;
pub mod student;
mod sum;
pub mod synchronise;
pub mod window;

/// A number of a message: six digits, so that a conversion between units leaves no tail.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
