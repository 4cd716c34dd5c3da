//! A further covariance of low rank beside the allowed difference, in whitened space: the model
//! error of simulated effects.

use nalgebra::{DMatrix, DVector};

use crate::diagnose::levels::metric::NEGLIGIBLE;

/// A further covariance `U U'` in whitened space: `v` becomes `(I + U U')^-1/2 v`.
#[derive(Clone, Debug, Default)]
pub struct Metric {
    /// Orthonormal columns, and `1 - 1/sqrt(1 + s^2)` of each.
    basis: Option<DMatrix<f64>>,
    shrink: DVector<f64>,
    /// `log |I + U' U|`.
    pub log_determinant: f64,
}

/// Orthonormal columns and singular values of some columns, without negligible ones.
fn singular(columns: &DMatrix<f64>) -> Option<(DMatrix<f64>, Vec<f64>)> {
    if columns.ncols() == 0 {
        return None;
    }
    // Eigenvectors of the small Gram matrix give the left singular vectors.
    let eigen = (columns.transpose() * columns).symmetric_eigen();
    let kept: Vec<usize> =
        (0..columns.ncols()).filter(|at| eigen.eigenvalues[*at] > NEGLIGIBLE).collect();
    if kept.is_empty() {
        return None;
    }
    let scaled: Vec<DVector<f64>> = kept
        .iter()
        .map(|at| eigen.eigenvectors.column(*at) / eigen.eigenvalues[*at].sqrt())
        .collect();
    let values = kept.iter().map(|at| eigen.eigenvalues[*at].sqrt()).collect();
    Some((columns * DMatrix::from_columns(&scaled), values))
}

/// The columns `U` in fewer columns with the same `U U'`.
pub fn reduced(columns: &DMatrix<f64>) -> DMatrix<f64> {
    match singular(columns) {
        Some((mut basis, values)) => {
            basis.column_iter_mut().zip(values).for_each(|(mut column, value)| column *= value);
            basis
        }
        None => DMatrix::zeros(columns.nrows(), 0),
    }
}

impl Metric {
    /// For the columns `U`.
    pub fn new(columns: &DMatrix<f64>) -> Self {
        let Some((basis, values)) = singular(columns) else { return Self::default() };
        let shrink = DVector::from_iterator(
            values.len(),
            values.iter().map(|s| 1.0 - 1.0 / (1.0 + s * s).sqrt()),
        );
        let log_determinant = values.iter().map(|s| (s * s).ln_1p()).sum();
        Self { basis: Some(basis), shrink, log_determinant }
    }

    /// `(I + U U')^-1/2 v`.
    pub fn apply(&self, v: &[f64]) -> Vec<f64> {
        let Some(basis) = self.basis.as_ref().filter(|_| !v.is_empty()) else { return v.to_vec() };
        let mut z = DVector::from_column_slice(v);
        let weights = basis.tr_mul(&z).component_mul(&self.shrink);
        z.gemv(-1.0, basis, &weights, 1.0);
        z.data.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::whiten::dot;

    /// With the covariance written out: a' (I + U U')^-1 a, and log |I + U U'| over all features.
    #[test]
    fn the_metric_is_that_of_the_full_covariance() {
        let columns = DMatrix::from_column_slice(4, 2, &[1.0, 0.5, 0.0, 2.0, 0.3, -1.0, 0.2, 0.0]);
        let full = DMatrix::identity(4, 4) + &columns * columns.transpose();
        let metric = Metric::new(&columns);
        let a = [1.0, -2.0, 0.5, 0.7];
        let z = metric.apply(&a);
        let v = DVector::from_column_slice(&a);
        let direct = v.dot(&(full.clone().try_inverse().expect("regular") * &v));
        assert!((dot(&z, &z) - direct).abs() < 1e-12 * direct);
        assert!((metric.log_determinant - full.determinant().ln()).abs() < 1e-12);
        let fewer = reduced(&columns);
        assert!((&fewer * fewer.transpose() - &columns * columns.transpose()).norm() < 1e-12);
        assert_eq!(Metric::new(&DMatrix::zeros(4, 0)).apply(&a), a);
    }
}
