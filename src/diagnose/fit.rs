//! Which candidates explain a difference: sizes, evidence, and the search for a set of them.

use std::collections::HashMap;

use super::candidates::Candidate;
use super::whiten::{Whitener, dot};

/// Sections that an effect is confined to; all of them at number 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Column and values, or nothing for all sections.
    pub confined: Option<(String, Vec<String>)>,
    pub sections: Vec<bool>,
}

/// A candidate with its size, and what it explains.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub candidate: usize,
    pub mask: usize,
    /// Between node `segment` and the next, at `share`.
    pub segment: usize,
    pub share: f64,
    pub size: f64,
    /// Fall of chi-squared.
    pub fall: f64,
    /// Fall less what the freedom of the fit costs: twice the logarithm of the Bayes factor against nothing.
    pub evidence: f64,
    /// Whitened change.
    pub whitened: Vec<f64>,
    /// Length of the whitened change per unit of size.
    pub slope: f64,
}

/// Candidates in whitened form.
#[derive(Debug)]
pub struct Fitter<'a> {
    pub whitener: &'a Whitener,
    pub candidates: &'a [Candidate],
    pub masks: Vec<Mask>,
    /// By candidate and mask: the whitened nodes.
    whitened: HashMap<(usize, usize), Vec<Vec<f64>>>,
}

impl<'a> Fitter<'a> {
    /// Whitens the nodes of all candidates under all masks that they may have.
    #[must_use]
    pub fn new(whitener: &'a Whitener, candidates: &'a [Candidate], masks: Vec<Mask>) -> Self {
        use rayon::prelude::*;
        let keys: Vec<(usize, usize)> = candidates
            .iter()
            .enumerate()
            .flat_map(|(at, candidate)| (0..if candidate.confinable { masks.len() } else { 1 }).map(move |mask| (at, mask)))
            .collect();
        let mut fitter = Self { whitener, candidates, masks, whitened: HashMap::new() };
        let whitened: Vec<_> = keys.par_iter().map(|(at, mask)| ((*at, *mask), fitter.nodes(*at, *mask))).collect();
        fitter.whitened = whitened.into_iter().collect();
        fitter
    }

    fn nodes(&self, candidate: usize, mask: usize) -> Vec<Vec<f64>> {
        let all = |change: &Vec<f64>| {
            if change.is_empty() {
                return Vec::new();
            }
            self.whitener.apply(&self.masks[mask].on(change))
        };
        self.candidates[candidate].nodes.iter().map(|node| all(&node.change)).collect()
    }

    /// The best size of a candidate under a mask for the whitened difference `z`.
    #[must_use]
    pub fn fit(&self, z: &[f64], candidate: usize, mask: usize) -> Option<Fitted> {
        let nodes = self.whitened.get(&(candidate, mask))?;
        let of = &self.candidates[candidate];
        let along: Vec<f64> = nodes.iter().map(|node| if node.is_empty() { 0.0 } else { dot(z, node) }).collect();
        let length: Vec<f64> = nodes.iter().map(|node| if node.is_empty() { 0.0 } else { dot(node, node) }).collect();
        let mut best: Option<(f64, usize, f64)> = None;
        let mut path = 0.0;
        for segment in 0..nodes.len().saturating_sub(1) {
            let across =
                if nodes[segment].is_empty() || nodes[segment + 1].is_empty() { 0.0 } else { dot(&nodes[segment], &nodes[segment + 1]) };
            // |z - (1-t) a - t b|^2 = |z|^2 + c0 + c1 t + c2 t^2
            let (aa, bb) = (length[segment], length[segment + 1]);
            let c0 = aa - 2.0 * along[segment];
            let c2 = (aa - 2.0 * across + bb).max(0.0);
            let c1 = 2.0 * (across - aa) - 2.0 * (along[segment + 1] - along[segment]);
            path += c2.sqrt();
            let t = if of.discrete {
                if c1 + c2 < 0.0 { 1.0 } else { 0.0 }
            } else if c2 > 0.0 {
                (-0.5 * c1 / c2).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let fall = -(c0 + c1 * t + c2 * t * t);
            if best.is_none_or(|(most, ..)| fall > most) {
                best = Some((fall, segment, t));
            }
        }
        let (fall, segment, share) = best?;
        let (from, to) = (&of.nodes[segment], &of.nodes[segment + 1]);
        let size = between(from.size, to.size, share);
        let freedom = 2.0 * (path / std::f64::consts::TAU.sqrt()).max(1.0).ln() + 2.0 * (of.alternatives as f64).ln();
        let mask_freedom = if mask == 0 { 0.0 } else { 2.0 * (self.masks.len() as f64).ln() };
        let n = z.len();
        let (a, b) = (&nodes[segment], &nodes[segment + 1]);
        let get = |node: &Vec<f64>, i: usize| if node.is_empty() { 0.0 } else { node[i] };
        let whitened: Vec<f64> = (0..n).map(|i| (1.0 - share) * get(a, i) + share * get(b, i)).collect();
        let width = (to.size - from.size).abs();
        let difference: f64 = (0..n).map(|i| (get(b, i) - get(a, i)).powi(2)).sum::<f64>().sqrt();
        let slope = if width.is_finite() && width > 0.0 { difference / width } else { 0.0 };
        Some(Fitted { candidate, mask, segment, share, size, fall, evidence: fall - freedom - mask_freedom, whitened, slope })
    }

    /// The best fit of every candidate, each under its best mask.
    #[must_use]
    pub fn all(&self, z: &[f64]) -> Vec<Fitted> {
        use rayon::prelude::*;
        (0..self.candidates.len()).into_par_iter().filter_map(|candidate| self.best(z, candidate)).collect()
    }

    /// The best fit of a candidate under any of its masks.
    #[must_use]
    pub fn best(&self, z: &[f64], candidate: usize) -> Option<Fitted> {
        let masks = if self.candidates[candidate].confinable { self.masks.len() } else { 1 };
        (0..masks).filter_map(|mask| self.fit(z, candidate, mask)).max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    }
}

impl Mask {
    /// A change where the mask is, nothing elsewhere.
    #[must_use]
    pub fn on(&self, change: &[f64]) -> Vec<f64> {
        let mut masked = change.to_vec();
        let size = masked.len() / self.sections.len().max(1);
        for (section, inside) in self.sections.iter().enumerate() {
            if !inside {
                masked[section * size..(section + 1) * size].fill(0.0);
            }
        }
        masked
    }
}

impl Fitted {
    /// Raw change of the features.
    #[must_use]
    pub fn change(&self, candidates: &[Candidate], masks: &[Mask]) -> Vec<f64> {
        let of = &candidates[self.candidate];
        let (a, b) = (&of.nodes[self.segment].change, &of.nodes[self.segment + 1].change);
        let n = a.len().max(b.len());
        let get = |node: &Vec<f64>, i: usize| if node.is_empty() { 0.0 } else { node[i] };
        let raw: Vec<f64> = (0..n).map(|i| (1.0 - self.share) * get(a, i) + self.share * get(b, i)).collect();
        masks[self.mask].on(&raw)
    }
}

/// Between two sizes; one of them may be infinite, where the effect vanishes with growing size: then by the reciprocal.
fn between(from: f64, to: f64, share: f64) -> f64 {
    if to.is_infinite() {
        return if share < 1.0 { from / (1.0 - share) } else { f64::INFINITY };
    }
    from + share * (to - from)
}

/// `a - b`.
#[must_use]
pub fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
