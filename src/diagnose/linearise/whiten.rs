//! Factorisation of the covariance, and whitening of differences.
//!
//! `C = blockdiag(C_i) + G G'`: one block per section, and columns `G` common to all sections. A
//! difference `r` is whitened to `z = (I - U (1 - 1/sqrt(1 + S^2)) U') L^-1 r` with `C_i = L_i
//! L_i'` and `L^-1 G = U S V'`, so that `z'z = r' C^-1 r`.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::diagnose::levels::whiten::TOGETHER;
use crate::diagnose::linearise::response::ResponseError;

/// The factored covariance.
#[derive(Clone, Debug)]
pub struct Whitener {
    blocks: Vec<Cholesky<f64, Dyn>>,
    /// Orthonormal columns, and `1 - 1/sqrt(1 + s^2)` of each.
    shared: DMatrix<f64>,
    shrink: DVector<f64>,
    size: usize,
    response: ResponseError,
}

/// The components of a covariance.
#[derive(Clone, Debug)]
pub struct Covariance {
    /// Variances of the features of all sections.
    pub diagonal: Vec<f64>,
    /// Columns of single sections: section, values of its features.
    pub inside: Vec<(usize, Vec<f64>)>,
    /// Columns over all sections.
    pub shared: Vec<Vec<f64>>,
    /// Features per section.
    pub size: usize,
    /// The model error of simulated effects, which depends on the effects that are fitted.
    pub response: ResponseError,
}

impl Covariance {
    /// Factors the covariance.
    ///
    /// Variances are kept above a small share of the largest one, so that the blocks are positive
    /// definite.
    pub fn whitener(&self) -> Whitener {
        let sections = self.diagonal.len() / self.size;
        let blocks = (0..sections).map(|section| self.block(section)).collect();
        let (shared, shrink) = (DMatrix::zeros(self.diagonal.len(), 0), DVector::zeros(0));
        let mut whitener =
            Whitener { blocks, shared, shrink, size: self.size, response: self.response.clone() };
        let columns: Vec<DVector<f64>> =
            self.shared.iter().map(|column| DVector::from_vec(whitener.apply(column))).collect();
        if !columns.is_empty() {
            let all = DMatrix::from_columns(&columns);
            // Eigenvectors of the small Gram matrix give the left singular vectors.
            let eigen = (all.transpose() * &all).symmetric_eigen();
            let largest = eigen.eigenvalues.max();
            let kept: Vec<usize> =
                (0..columns.len()).filter(|i| eigen.eigenvalues[*i] > largest * 1e-12).collect();
            let scaled: Vec<DVector<f64>> = kept
                .iter()
                .map(|i| eigen.eigenvectors.column(*i) / eigen.eigenvalues[*i].sqrt())
                .collect();
            whitener.shrink = DVector::from_iterator(
                kept.len(),
                kept.iter().map(|i| 1.0 - 1.0 / (1.0 + eigen.eigenvalues[*i]).sqrt()),
            );
            whitener.shared = if kept.is_empty() {
                whitener.shared
            } else {
                all * DMatrix::from_columns(&scaled)
            };
        }
        whitener
    }
}

impl Covariance {
    /// The covariance of one section, without the common columns.
    fn block(&self, section: usize) -> Cholesky<f64, Dyn> {
        let range = section * self.size..(section + 1) * self.size;
        let columns: Vec<&[f64]> = self
            .inside
            .iter()
            .filter(|(of, _)| *of == section)
            .map(|(_, values)| values.as_slice())
            .collect();
        let mut block = DMatrix::from_diagonal(&DVector::from_iterator(
            self.size,
            self.diagonal[range].iter().map(|v| v.max(1e-12)),
        ));
        if !columns.is_empty() {
            let all = DMatrix::from_fn(self.size, columns.len(), |i, j| columns[j][i]);
            block += &all * all.transpose();
        }
        Cholesky::new_with_substitute(block, 1e-9).expect("a substitute makes every pivot positive")
    }
}

/// The factored covariance of a few features.
#[derive(Debug)]
pub struct Among(Cholesky<f64, Dyn>);

impl Covariance {
    /// The marginal covariance of the listed features, given as section and number.
    pub fn among(&self, places: &[(usize, usize)]) -> Among {
        let all = |column: &[f64]| {
            DVector::from_iterator(
                places.len(),
                places.iter().map(|(at, feature)| column[at * self.size + feature]),
            )
        };
        let mut full =
            DMatrix::from_diagonal(&all(&self.diagonal).map(|variance| variance.max(1e-12)));
        for (section, column) in &self.inside {
            let of =
                |(at, feature): &(usize, usize)| if at == section { column[*feature] } else { 0.0 };
            let one = DVector::from_iterator(places.len(), places.iter().map(of));
            full.ger(1.0, &one, &one, 1.0);
        }
        for column in &self.shared {
            let one = all(column);
            full.ger(1.0, &one, &one, 1.0);
        }
        Among(
            Cholesky::new_with_substitute(full, 1e-12)
                .expect("a substitute makes every pivot positive"),
        )
    }
}

impl Among {
    /// `r' C^-1 r`.
    pub fn chi_squared(&self, values: &[f64]) -> f64 {
        let values = DVector::from_column_slice(values);
        values.dot(&self.0.solve(&values))
    }

    /// `r' C^-1 r` without each block of so many features in turn: with `P = C^-1` it falls by
    /// `(P r)_b' P_bb^-1 (P r)_b`.
    pub fn without_each(&self, values: &[f64], size: usize) -> Vec<f64> {
        let precision = self.0.inverse();
        let values = DVector::from_column_slice(values);
        let weighed = &precision * &values;
        let all = values.dot(&weighed);
        let fall = |at: usize| {
            let own = weighed.rows(at, size).into_owned();
            let block = precision.view((at, at), (size, size)).into_owned();
            Cholesky::new_with_substitute(block, 1e-12)
                .map_or(0.0, |own_of| own.dot(&own_of.solve(&own)))
        };
        (0..values.len() / size).map(|block| all - fall(block * size)).collect()
    }

    /// Generalised least squares of `values` on two columns: coefficient of the second column and
    /// its standard error. Nothing if the columns are collinear.
    pub fn slope(&self, columns: [&[f64]; 2], values: &[f64]) -> Option<(f64, f64)> {
        let [one, two] = columns.map(DVector::from_column_slice);
        let values = DVector::from_column_slice(values);
        let (first, second) = (self.0.solve(&one), self.0.solve(&two));
        let (aa, ab, bb) = (one.dot(&first), one.dot(&second), two.dot(&second));
        let determinant = aa * bb - ab * ab;
        let (a, b) = (values.dot(&first), values.dot(&second));
        (determinant > 1e-9 * aa * bb)
            .then(|| ((aa * b - ab * a) / determinant, (aa / determinant).sqrt()))
    }
}

impl Whitener {
    /// Number of features of all sections.
    pub fn features(&self) -> usize {
        self.blocks.len() * self.size
    }

    /// The relative error of a simulated change that all features share.
    pub fn common(&self) -> f64 {
        self.response.common
    }

    /// Columns of the model error of a simulated change, not whitened.
    pub fn response_error(&self, change: &[f64]) -> Vec<Vec<f64>> {
        self.response.columns(change, self.size)
    }

    /// Whitened differences, a column each. Faster than one by one.
    pub fn apply_all(&self, differences: &[Vec<f64>]) -> DMatrix<f64> {
        use rayon::prelude::*;
        let part = |columns: &[Vec<f64>]| {
            let mut z = DMatrix::from_fn(self.features(), columns.len(), |i, j| columns[j][i]);
            for (section, block) in self.blocks.iter().enumerate() {
                block
                    .l_dirty()
                    .solve_lower_triangular_mut(&mut z.rows_mut(section * self.size, self.size));
            }
            if self.shared.ncols() > 0 {
                let mut weights = self.shared.transpose() * &z;
                weights
                    .column_iter_mut()
                    .for_each(|mut column| column.component_mul_assign(&self.shrink));
                z.gemm(-1.0, &self.shared, &weights, 1.0);
            }
            z
        };
        let parts: Vec<DMatrix<f64>> = differences.par_chunks(TOGETHER).map(part).collect();
        let mut all = DMatrix::zeros(self.features(), differences.len());
        for (at, part) in parts.iter().enumerate() {
            all.columns_mut(at * TOGETHER, part.ncols()).copy_from(part);
        }
        all
    }

    /// The whitened difference; of the same length as `difference`.
    pub fn apply(&self, difference: &[f64]) -> Vec<f64> {
        let mut z = DVector::zeros(difference.len());
        for (section, block) in self.blocks.iter().enumerate() {
            let at = section * self.size;
            if difference[at..at + self.size].iter().all(|x| *x == 0.0) {
                continue;
            }
            let mut part = DVector::from_column_slice(&difference[at..at + self.size]);
            block.l_dirty().solve_lower_triangular_mut(&mut part);
            z.rows_mut(at, self.size).copy_from(&part);
        }
        if self.shared.ncols() > 0 {
            let weights = self.shared.tr_mul(&z).component_mul(&self.shrink);
            z.gemv(-1.0, &self.shared, &weights, 1.0);
        }
        z.data.into()
    }
}

/// `a - b`.
pub fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// `a + b`.
pub fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Inner product.
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Eight partial sums, always in the same order, so that the result is reproducible.
    let mut sums = [0.0; 8];
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a8.zip(b8) {
        for i in 0..8 {
            sums[i] += x[i] * y[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whitened length is r' C^-1 r with the covariance written out in full.
    #[test]
    fn whitened_length_is_that_of_the_full_covariance() {
        let covariance = Covariance {
            diagonal: vec![1.0, 2.0, 0.5, 3.0],
            inside: vec![(0, vec![0.5, -1.0]), (1, vec![2.0, 0.3])],
            shared: vec![vec![1.0, 0.0, 1.0, 0.5], vec![0.2, 0.4, -0.3, 1.0]],
            size: 2,
            response: ResponseError::default(),
        };
        let r = [1.0, -2.0, 0.5, 0.7];
        let mut full = DMatrix::from_diagonal(&DVector::from_row_slice(&covariance.diagonal));
        let mut add = |column: Vec<f64>| {
            full += DVector::from_vec(column.clone()) * DVector::from_vec(column).transpose()
        };
        add(vec![0.5, -1.0, 0.0, 0.0]);
        add(vec![0.0, 0.0, 2.0, 0.3]);
        covariance.shared.iter().for_each(|column| add(column.clone()));
        let direct = (DVector::from_row_slice(&r).transpose()
            * full.try_inverse().expect("regular")
            * DVector::from_row_slice(&r))[0];
        let z = covariance.whitener().apply(&r);
        assert!((dot(&z, &z) - direct).abs() < 1e-10 * direct);
        let other = [0.3, 0.1, -2.0, 4.0];
        let all = covariance.whitener().apply_all(&[r.to_vec(), other.to_vec()]);
        for (column, one) in [r, other].iter().enumerate() {
            let alone = DVector::from(covariance.whitener().apply(one));
            assert!((all.column(column) - alone).norm() < 1e-12);
        }
        let among = covariance.among(&[(0, 0), (0, 1), (1, 0), (1, 1)]);
        assert!((among.chi_squared(&r) - direct).abs() < 1e-10 * direct);
        // Without the first section: the covariance of the second alone.
        let rest = covariance.part(&[1], &[0, 1]).whitener().apply(&r[2..]);
        assert!((among.without_each(&r, 2)[0] - dot(&rest, &rest)).abs() < 1e-10 * direct);
    }
}
