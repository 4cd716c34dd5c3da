//! Ordinary least squares with several regressors, one, or none, and confidence bounds at a point.
//!
//! The model is value = intercept + sum of coefficient x regressor + error, with independent normal
//! errors of equal variance. Source: Draper and Smith, "Applied Regression Analysis", 3rd ed.
//! (1998), chapters 1, 3 and 5.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::{
    statistics::{is_constant, mean},
    student::student_quantile,
    sum::{sum_of, sum_of_pairs},
};

/// Regressors are collinear if the smallest singular value of the columns (including the intercept,
/// each scaled to length 1) is below this share of the largest. In double precision, their
/// coefficients can then not be distinguished.
const COLLINEAR: f64 = 1e-10;

/// A fitted regression.
#[derive(Clone, Debug)]
pub struct Regression {
    mean: f64,
    /// For each regressor: mean, length of its centred column, coefficient.
    regressors: Vec<Regressor>,
    /// Matrix, row by row, that maps a centred and scaled point to a vector whose squared length is
    /// its part of the leverage.
    whitening: Vec<Vec<f64>>,
    count: usize,
    residual_standard_deviation: f64,
}

#[derive(Clone, Copy, Debug)]
struct Regressor {
    mean: f64,
    length: f64,
    coefficient: f64,
}

/// The quantity that a bound is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A further single value at the point: fit -+ t s sqrt(1 + h).
    Prediction,
    /// The mean of the values at the point: fit -+ t s sqrt(h).
    Mean,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Upper,
    Lower,
}

/// Share of the error probability (1 - confidence) that is beyond the bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tails {
    /// All of it: for 95 %, the 95 % quantile of Student's t.
    One,
    /// Half of it: for 95 %, the 97.5 % quantile.
    Two,
}

impl Regression {
    /// Fit of `values` by `regressors`, each with one number per value, in any units, with an
    /// intercept. Without regressors, it is the mean, and its bounds are those of a sample.
    ///
    /// # Errors
    /// Lists of different length; fewer values than the number of coefficients plus one; a number
    /// that is not finite; a regressor that does not vary; collinear regressors; squares that
    /// overflow.
    pub fn fit(values: &[f64], regressors: &[Vec<f64>]) -> Result<Self, RegressionError> {
        check(values, regressors)?;
        let count = values.len();
        let overflow = || RegressionError::OutOfRange;
        let mean_of_values = mean(values).ok_or_else(overflow)?;
        let mut found = Vec::with_capacity(regressors.len());
        for column in regressors {
            let mean = mean(column).ok_or_else(overflow)?;
            let length = length(column, mean).ok_or_else(overflow)?;
            found.push(Regressor { mean, length, coefficient: 0.0 });
        }
        let mut fit = Self {
            mean: mean_of_values,
            regressors: found,
            whitening: Vec::new(),
            count,
            residual_standard_deviation: 0.0,
        };
        if !fit.regressors.is_empty() {
            fit.solve(values, regressors)?;
        }
        // Constant values are fitted exactly; residuals would be rounding.
        if !is_constant(values) {
            let mut residuals = Vec::with_capacity(count);
            for (row, value) in values.iter().enumerate() {
                let point: Vec<f64> = regressors.iter().map(|column| column[row]).collect();
                residuals.push(value - fit.at(&point)?);
            }
            fit.residual_standard_deviation =
                (sum_of(&residuals, |left| left * left) / fit.degrees_of_freedom() as f64).sqrt();
        }
        in_range(fit.residual_standard_deviation)?;
        Ok(fit)
    }

    /// By singular values of the centred columns, each scaled to length 1.
    fn solve(&mut self, values: &[f64], regressors: &[Vec<f64>]) -> Result<(), RegressionError> {
        refuse_collinear(regressors)?;
        let count = values.len();
        let columns = DMatrix::from_fn(count, regressors.len(), |row, of| {
            let Regressor { mean, length, .. } = self.regressors[of];
            (regressors[of][row] - mean) / length
        });
        let above = DVector::from_iterator(count, values.iter().map(|value| value - self.mean));
        let parts = columns.svd(true, true);
        let (Some(left), Some(right)) = (parts.u, parts.v_t) else {
            return Err(RegressionError::Collinear);
        };
        let singular = parts.singular_values;
        if singular.iter().any(|value| *value <= 0.0 || !value.is_finite()) {
            return Err(RegressionError::Collinear);
        }
        self.whitening = right
            .row_iter()
            .zip(&singular)
            .map(|(row, value)| row.iter().map(|part| part / value).collect())
            .collect();
        let along = left.tr_mul(&above);
        for (of, regressor) in self.regressors.iter_mut().enumerate() {
            let scaled: f64 =
                self.whitening.iter().zip(&along).map(|(row, along)| row[of] * along).sum();
            regressor.coefficient = scaled / regressor.length;
        }
        if is_constant(values) {
            self.regressors.iter_mut().for_each(|regressor| regressor.coefficient = 0.0);
        }
        Ok(())
    }

    /// The intercept, then the coefficient of each regressor.
    pub fn coefficients(&self) -> Vec<f64> {
        let intercept =
            self.regressors.iter().fold(self.mean, |left, of| left - of.coefficient * of.mean);
        std::iter::once(intercept).chain(self.regressors.iter().map(|of| of.coefficient)).collect()
    }

    /// Number of values minus number of coefficients.
    pub fn degrees_of_freedom(&self) -> usize {
        self.count - 1 - self.regressors.len()
    }

    /// Square root of the sum of squared residuals divided by the degrees of freedom, in the unit
    /// of the values.
    pub fn residual_standard_deviation(&self) -> f64 {
        self.residual_standard_deviation
    }

    /// The fitted value at a point: one number per regressor.
    ///
    /// # Errors
    /// Not as many numbers as regressors; one that is not finite; a result that overflows.
    pub fn at(&self, point: &[f64]) -> Result<f64, RegressionError> {
        let centred = self.centred(point)?;
        let fitted = self
            .regressors
            .iter()
            .zip(&centred)
            .fold(self.mean, |sum, (of, scaled)| sum + of.coefficient * of.length * scaled);
        in_range(fitted)
    }

    /// Leverage of a point: x (X'X)^-1 x', with the intercept. Its square root is the standard
    /// error of the fit divided by the residual standard deviation. It is 1/n at the mean of the
    /// regressors.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn leverage(&self, point: &[f64]) -> Result<f64, RegressionError> {
        let centred = self.centred(point)?;
        let squares: f64 = self
            .whitening
            .iter()
            .map(|row| row.iter().zip(&centred).map(|(a, b)| a * b).sum::<f64>().powi(2))
            .sum();
        in_range(1.0 / self.count as f64 + squares)
    }

    /// The bound at a point, on one side, with this confidence (0 to 1), for a further value or for
    /// the mean.
    ///
    /// # Errors
    /// As [`Self::at`]; a confidence not between 0 and 1.
    pub fn bound(
        &self,
        point: &[f64],
        kind: Kind,
        side: Side,
        tails: Tails,
        confidence: f64,
    ) -> Result<f64, RegressionError> {
        if !(confidence > 0.0 && confidence < 1.0) {
            return Err(RegressionError::Confidence { confidence });
        }
        let probability = if tails == Tails::One { confidence } else { 0.5 + confidence / 2.0 };
        let t = student_quantile(probability, self.degrees_of_freedom() as f64)
            .ok_or(RegressionError::Confidence { confidence })?;
        let of_one_value = if kind == Kind::Prediction { 1.0 } else { 0.0 };
        let reach =
            t * self.residual_standard_deviation * (of_one_value + self.leverage(point)?).sqrt();
        in_range(self.at(point)? + if side == Side::Upper { reach } else { -reach })
    }

    fn centred(&self, point: &[f64]) -> Result<Vec<f64>, RegressionError> {
        if point.len() != self.regressors.len() {
            return Err(RegressionError::Point {
                found: point.len(),
                regressors: self.regressors.len(),
            });
        }
        if let Some(at) = point.iter().position(|part| !part.is_finite()) {
            return Err(RegressionError::PointNotFinite { regressor: at + 1 });
        }
        Ok(self
            .regressors
            .iter()
            .zip(point)
            .map(|(of, part)| (part - of.mean) / of.length)
            .collect())
    }
}

fn check(values: &[f64], regressors: &[Vec<f64>]) -> Result<(), RegressionError> {
    let count = values.len();
    if let Some(at) = regressors.iter().position(|column| column.len() != count) {
        return Err(RegressionError::Length {
            regressor: at + 1,
            found: regressors[at].len(),
            values: count,
        });
    }
    let coefficients = regressors.len() + 1;
    if count <= coefficients {
        return Err(RegressionError::TooFew { values: count, coefficients });
    }
    let columns = std::iter::once(values).chain(regressors.iter().map(Vec::as_slice));
    for (regressor, column) in columns.enumerate() {
        if let Some(at) = column.iter().position(|value| !value.is_finite()) {
            return Err(RegressionError::NotFinite { regressor, value: at + 1 });
        }
    }
    match regressors.iter().position(|column| is_constant(column)) {
        Some(at) => Err(RegressionError::Constant { regressor: at + 1 }),
        None => Ok(()),
    }
}

fn refuse_collinear(regressors: &[Vec<f64>]) -> Result<(), RegressionError> {
    let count = regressors[0].len();
    let lengths: Vec<f64> = regressors
        .iter()
        .map(|column| length(column, 0.0))
        .collect::<Option<_>>()
        .ok_or(RegressionError::OutOfRange)?;
    let with_intercept = DMatrix::from_fn(count, regressors.len() + 1, |row, of| match of {
        0 => 1.0 / (count as f64).sqrt(),
        of => regressors[of - 1][row] / lengths[of - 1],
    });
    let singular = with_intercept.singular_values();
    let (least, greatest) = singular
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), &value| (low.min(value), high.max(value)));
    if least >= COLLINEAR * greatest { Ok(()) } else { Err(RegressionError::Collinear) }
}

/// Square root of the sum of squares about a centre; `None` where it cannot be a divisor.
fn length(column: &[f64], center: f64) -> Option<f64> {
    let length = sum_of_pairs(column, column, |a, b| (a - center) * (b - center)).sqrt();
    (length.is_finite() && length > 0.0).then_some(length)
}

fn in_range(value: f64) -> Result<f64, RegressionError> {
    if value.is_finite() { Ok(value) } else { Err(RegressionError::OutOfRange) }
}

/// Reason why there is no regression, or no value at a point. Values and regressors are counted
/// from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RegressionError {
    Length {
        regressor: usize,
        found: usize,
        values: usize,
    },
    TooFew {
        values: usize,
        coefficients: usize,
    },
    /// `regressor` 0 stands for the values themselves.
    NotFinite {
        regressor: usize,
        value: usize,
    },
    Constant {
        regressor: usize,
    },
    Collinear,
    OutOfRange,
    Point {
        found: usize,
        regressors: usize,
    },
    PointNotFinite {
        regressor: usize,
    },
    Confidence {
        confidence: f64,
    },
}

impl fmt::Display for RegressionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = |count: usize| if count == 1 { "" } else { "s" };
        match *self {
            Self::Length { regressor, found, values } => {
                write!(
                    f,
                    "regressor {regressor} has {found} number{} for {values} value{}",
                    s(found),
                    s(values)
                )
            }
            Self::TooFew { values, coefficients } => {
                let at_least = coefficients + 1;
                write!(
                    f,
                    "{values} value{} for {coefficients} coefficient{}: at least {at_least} needed",
                    s(values),
                    s(coefficients)
                )
            }
            Self::NotFinite { regressor: 0, value } => write!(f, "value {value} is not finite"),
            Self::NotFinite { regressor, value } => {
                write!(f, "number {value} of regressor {regressor} is not finite")
            }
            Self::Constant { regressor } => write!(f, "regressor {regressor} does not vary"),
            Self::Collinear => f.write_str(
                "the regressors are collinear: one of them depends linearly on the others",
            ),
            Self::OutOfRange => f.write_str("the sum of the squares overflows"),
            Self::Point { found, regressors } => {
                write!(
                    f,
                    "the point has {found} number{} for {regressors} regressor{}",
                    s(found),
                    s(regressors)
                )
            }
            Self::PointNotFinite { regressor } => {
                write!(f, "number {regressor} of the point is not finite")
            }
            Self::Confidence { confidence } => {
                write!(f, "a confidence level must be between 0 and 1, this is {confidence}")
            }
        }
    }
}
