//! The whitened path of a candidate, and the best fit on it.

use std::sync::{Arc, OnceLock};

use nalgebra::DMatrix;

use super::candidate::{Beside, Candidate, between};
use crate::diagnose::levels::fit::APART;
use crate::diagnose::linearise::whiten::dot;

/// A candidate under a mask: its whitened nodes, and the terms of a fit that do not depend on the
/// difference.
#[derive(Debug)]
pub struct Path {
    /// Sizes of the nodes, and the members present in their simulations.
    sizes: Vec<f64>,
    beside: Option<Arc<Beside>>,
    pub nodes: Vec<Vec<f64>>,
    /// Squared lengths of the nodes, and inner products of each with the next.
    pub lengths: Vec<f64>,
    pub products: Vec<f64>,
    /// Length of the whole path, in standard deviations.
    pub long: f64,
    /// The whitened model error of each node, computed when first needed.
    pub errors: Vec<OnceLock<DMatrix<f64>>>,
}

/// The best fit on a path.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    pub segment: usize,
    pub share: f64,
    pub fall: f64,
}

/// From squared lengths of the nodes, inner products of each with the next, and inner products of
/// each with the difference.
pub fn closest(
    lengths: &[f64],
    products: &[f64],
    along: &[f64],
    discrete: bool,
) -> Option<Closest> {
    let mut best: Option<Closest> = None;
    for segment in 0..products.len() {
        // |z - (1-t) a - t b|^2 = |z|^2 + c0 + c1 t + c2 t^2
        let (aa, bb, across) = (lengths[segment], lengths[segment + 1], products[segment]);
        let c0 = aa - 2.0 * along[segment];
        let c2 = (aa - 2.0 * across + bb).max(0.0);
        let c1 = 2.0 * (across - aa) - 2.0 * (along[segment + 1] - along[segment]);
        let share = if discrete {
            if c1 + c2 < 0.0 { 1.0 } else { 0.0 }
        } else if c2 > 0.0 {
            (-0.5 * c1 / c2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let fall = -(c0 + c1 * share + c2 * share * share);
        if best.as_ref().is_none_or(|best| fall > best.fall) {
            best = Some(Closest { segment, share, fall });
        }
    }
    best
}

/// A path by section, for fits to a selection of sections.
#[derive(Debug)]
pub struct BySection {
    pub lengths: Vec<Vec<f64>>,
    pub products: Vec<Vec<f64>>,
    pub along: Vec<Vec<f64>>,
    pub sizes: Vec<f64>,
    pub discrete: bool,
}

impl BySection {
    /// Fall of chi-squared and size with a weight per section; nothing where no section with a
    /// weight is changed.
    pub fn fit(&self, times: &[f64]) -> Option<(f64, f64)> {
        let sum = |parts: &Vec<f64>| dot(parts, times);
        let [lengths, products, along] = [&self.lengths, &self.products, &self.along]
            .map(|all| all.iter().map(sum).collect::<Vec<f64>>());
        if lengths.iter().all(|length| *length == 0.0) {
            return None;
        }
        let Closest { segment, share, fall, .. } =
            closest(&lengths, &products, &along, self.discrete)?;
        Some((fall, between(self.sizes[segment], self.sizes[segment + 1], share)))
    }
}

/// The squares of the lengths of nodes, and the product of each with the next; an empty node is no
/// change.
pub fn products(nodes: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let product =
        |a: &Vec<f64>, b: &Vec<f64>| if a.is_empty() || b.is_empty() { 0.0 } else { dot(a, b) };
    let lengths = nodes.iter().map(|node| product(node, node));
    (lengths.collect(), nodes.windows(2).map(|pair| product(&pair[0], &pair[1])).collect())
}

impl Path {
    /// From a candidate and its whitened nodes.
    pub fn new(of: &Candidate, nodes: Vec<Vec<f64>>) -> Self {
        let (lengths, products) = products(&nodes);
        let step = |at: usize| (lengths[at] - 2.0 * products[at] + lengths[at + 1]).max(0.0).sqrt();
        let long = (0..products.len()).map(step).sum();
        let sizes = of.nodes.iter().map(|node| node.size).collect();
        let errors = nodes.iter().map(|_| OnceLock::new()).collect();
        Self { sizes, beside: of.beside.clone(), nodes, lengths, products, long, errors }
    }

    /// Whether a candidate is unchanged.
    pub fn is_of(&self, candidate: &Candidate) -> bool {
        let beside = match (&self.beside, &candidate.beside) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        beside && candidate.nodes.iter().map(|node| node.size).eq(self.sizes.iter().copied())
    }

    /// Length of the change per unit of the size, between nodes at some distance on either side.
    /// Between two close nodes, scatter of the features would dominate. 0 where one of the two
    /// sizes is infinite. `nodes` are the whitened nodes, in any metric.
    pub fn slope(&self, of: &Candidate, nodes: &[Vec<f64>], segment: usize, size: f64) -> f64 {
        let near = |at: &usize| (of.nodes[*at].size - size).abs() < APART * size.abs();
        let from = (1..=segment).rev().find(|at| !near(at)).unwrap_or(0);
        let last = of.nodes.len() - 1;
        let to = (segment + 1..last).find(|at| !near(at)).unwrap_or(last);
        let width = (of.nodes[to].size - of.nodes[from].size).abs();
        let difference: f64 = match (&nodes[from], &nodes[to]) {
            (a, b) if a.is_empty() => dot(b, b),
            (a, b) if b.is_empty() => dot(a, a),
            (a, b) => a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum(),
        };
        if width.is_finite() && width > 0.0 { difference.sqrt() / width } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::Node;

    /// Three nodes on a line of slope 2, and one close to the middle node that is off the line: the
    /// slope is that of the line.
    #[test]
    fn nodes_side_by_side_make_no_slope() {
        let nodes = [(0.0, 0.0), (1.0, 2.0), (1.001, 2.5), (2.0, 4.0)];
        let node = |(size, change): (f64, f64)| Node {
            size,
            change: if size == 0.0 { Vec::new() } else { vec![change] },
        };
        let of = Candidate::path("effect", nodes.map(node).to_vec());
        let path = Path::new(&of, of.nodes.iter().map(|node| node.change.clone()).collect());
        assert!((path.slope(&of, &path.nodes, 1, 1.0005) - 2.0).abs() < 1e-12);
        assert!((path.slope(&of, &path.nodes, 0, 0.5) - 2.0).abs() < 1e-12);
    }
}
