//! Standing discrepancy of the simulation, estimated from campaigns of known state.
//!
//! Every discrepancy common to all sections is a column times a random coefficient of unit
//! variance. A part of that coefficient is the same in all campaigns with a vehicle (the standing
//! part); the rest varies from campaign to campaign. Campaigns of known state estimate the standing
//! part. Its mean is subtracted; its remaining covariance and the varying part stay in the
//! covariance (Gauss-Markov; as in Kennedy and O'Hagan 2001, with a discrepancy of declared form).

use std::collections::HashMap;

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::diagnose::levels::standing::OWN;
use crate::diagnose::linearise::whiten::Covariance;

/// A column common to all sections, with a key that identifies its discrepancy.
#[derive(Clone, Debug)]
pub struct Keyed {
    pub key: String,
    pub values: Vec<f64>,
}

/// Posterior of the common discrepancies; empty without a reference campaign.
#[derive(Clone, Debug, Default)]
pub struct Standing {
    /// Index of each column in the mean and in the root.
    places: HashMap<String, usize>,
    mean: Vec<f64>,
    /// A square root of the covariance of the coefficients.
    root: Option<DMatrix<f64>>,
}

/// Data of one reference campaign: its covariance without the standing part, the columns, and
/// measured - simulated.
#[derive(Debug)]
pub struct Shown {
    pub covariance: Covariance,
    pub columns: Vec<Keyed>,
    pub difference: Vec<f64>,
}

impl Standing {
    /// Estimates the standing part from reference campaigns.
    pub fn learn(all: &[Shown]) -> Self {
        let mut places = HashMap::new();
        for column in all.iter().flat_map(|shown| &shown.columns) {
            let next = places.len();
            places.entry(column.key.clone()).or_insert(next);
        }
        let count = places.len();
        if count == 0 {
            return Self::default();
        }
        let stands = (1.0 - OWN * OWN).sqrt();
        let (mut precision, mut pull) = (DMatrix::identity(count, count), DVector::zeros(count));
        for shown in all {
            let whitener = shown.covariance.whitener();
            let mut seen = DMatrix::zeros(shown.difference.len(), count);
            for column in &shown.columns {
                seen.set_column(
                    places[&column.key],
                    &(DVector::from_vec(whitener.apply(&column.values)) * stands),
                );
            }
            precision += seen.tr_mul(&seen);
            pull += seen.tr_mul(&DVector::from_vec(whitener.apply(&shown.difference)));
        }
        let factored = Cholesky::new_with_substitute(precision, 1e-9)
            .expect("a substitute makes every pivot positive");
        let mean = factored.solve(&pull) * stands;
        let left =
            factored.inverse() * (stands * stands) + DMatrix::identity(count, count) * (OWN * OWN);
        let root = Cholesky::new_with_substitute(left, 1e-12)
            .expect("a substitute makes every pivot positive")
            .l();
        Self { places, mean: mean.data.into(), root: Some(root) }
    }

    /// Subtracts the mean of the standing part from a difference.
    pub fn take_off(&self, columns: &[Keyed], difference: &mut [f64]) {
        for (column, at) in
            columns.iter().filter_map(|column| Some((column, self.places.get(&column.key)?)))
        {
            difference
                .iter_mut()
                .zip(&column.values)
                .for_each(|(difference, value)| *difference -= self.mean[*at] * value);
        }
    }

    /// The columns, recombined so that their coefficients are again independent and of unit
    /// variance.
    pub fn weighed(&self, columns: Vec<Keyed>) -> Vec<Vec<f64>> {
        let Some(root) = &self.root else {
            return columns.into_iter().map(|column| column.values).collect();
        };
        let (known, unknown): (Vec<Keyed>, Vec<Keyed>) =
            columns.into_iter().partition(|column| self.places.contains_key(&column.key));
        let mut all: Vec<Vec<f64>> = unknown.into_iter().map(|column| column.values).collect();
        let Some(first) = known.first() else { return all };
        for number in 0..root.ncols() {
            let mut sum = vec![0.0; first.values.len()];
            for column in &known {
                let weight = root[(self.places[&column.key], number)];
                sum.iter_mut().zip(&column.values).for_each(|(sum, value)| *sum += weight * value);
            }
            all.push(sum);
        }
        all
    }
}
