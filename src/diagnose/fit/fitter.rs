//! Fit of candidates to a difference: sizes and evidence.

use std::collections::HashMap;

use nalgebra::DMatrix;

use crate::diagnose::levels::causes::INTERPOLATION;
use crate::diagnose::linearise::{
    candidate::{Candidate, Node, between, blend},
    mask::{Mask, allowed},
    metric::reduced,
    path::{BySection, Closest, Path, closest},
    whiten::{Whitener, dot},
};

/// A candidate and a mask, by number.
pub type Member = (usize, usize);

/// A fitted candidate.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub candidate: usize,
    pub mask: usize,
    /// The size is between node `segment` and the next, at `share`.
    pub segment: usize,
    pub share: f64,
    pub size: f64,
    /// Fall of chi-squared.
    pub fall: f64,
    /// Fall less the penalty of the free parameters: twice the logarithm of the Bayes factor
    /// against no effect.
    pub evidence: f64,
    /// Whitened change.
    pub whitened: Vec<f64>,
    /// Length of the whitened change per unit of the size.
    pub slope: f64,
}

/// Whitened candidates.
#[derive(Debug)]
pub struct Fitter<'a> {
    pub whitener: &'a Whitener,
    pub candidates: &'a [Candidate],
    pub masks: Vec<Mask>,
    /// The whitened nodes by candidate and mask.
    pub whitened: Known,
}

/// Whitened nodes of candidates under masks.
pub type Known = HashMap<(usize, usize), Path>;

/// The best fit on a path.
#[derive(Clone, Copy, Debug)]
struct Best {
    segment: usize,
    share: f64,
    fall: f64,
    evidence: f64,
}

impl<'a> Fitter<'a> {
    /// Whitens the nodes of all candidates under all their masks.
    pub fn new(whitener: &'a Whitener, candidates: &'a [Candidate], masks: Vec<Mask>) -> Self {
        Self::knowing(whitener, candidates, masks, Known::new())
    }

    /// As [`Self::new`], reusing the results of an earlier fitter. Candidates may have more nodes
    /// since, and there may be more masks.
    pub fn knowing(
        whitener: &'a Whitener,
        candidates: &'a [Candidate],
        masks: Vec<Mask>,
        known: Known,
    ) -> Self {
        let every =
            (0..candidates.len()).flat_map(|at| (0..masks.len()).map(move |mask| (at, mask)));
        let keys: Vec<(usize, usize)> =
            every.filter(|(at, mask)| allowed(candidates, *at, *mask)).collect();
        Self::whitening(whitener, candidates, masks, known, keys)
    }

    /// For fits of some members alone, each under its own mask.
    pub fn of(
        whitener: &'a Whitener,
        candidates: &'a [Candidate],
        masks: Vec<Mask>,
        members: &[Fitted],
    ) -> Self {
        let keys = members.iter().map(|member| (member.candidate, member.mask)).collect();
        Self::whitening(whitener, candidates, masks, Known::new(), keys)
    }

    fn whitening(
        whitener: &'a Whitener,
        candidates: &'a [Candidate],
        masks: Vec<Mask>,
        mut known: Known,
        mut keys: Vec<(usize, usize)>,
    ) -> Self {
        use rayon::prelude::*;
        known.retain(|(candidate, _), path| path.is_of(&candidates[*candidate]));
        keys.retain(|key| !known.contains_key(key));
        let mut fitter = Self { whitener, candidates, masks, whitened: known };
        let changes: Vec<Vec<f64>> = keys
            .par_iter()
            .flat_map_iter(|(at, mask)| {
                let changed = candidates[*at].nodes.iter().filter(|node| !node.change.is_empty());
                changed.map(|node| fitter.masks[*mask].on(&node.change)).collect::<Vec<_>>()
            })
            .collect();
        let all = whitener.apply_all(&changes);
        let mut next = all.column_iter();
        for (at, mask) in keys {
            let of = &candidates[at];
            let whitened = |node: &Node| match node.change.is_empty() {
                true => Vec::new(),
                false => next.next().expect("one for each change").iter().copied().collect(),
            };
            let nodes = of.nodes.iter().map(whitened).collect();
            fitter.whitened.insert((at, mask), Path::new(of, nodes));
        }
        fitter
    }

    /// The best fit of a candidate under a mask to the whitened difference `z`.
    fn meet(&self, z: &[f64], candidate: usize, mask: usize) -> Option<Best> {
        let path = self.whitened.get(&(candidate, mask))?;
        let of = &self.candidates[candidate];
        let along: Vec<f64> = path
            .nodes
            .iter()
            .map(|node| if node.is_empty() { 0.0 } else { dot(z, node) })
            .collect();
        let Closest { segment, share, fall } =
            closest(&path.lengths, &path.products, &along, of.discrete)?;
        Some(Best { segment, share, fall, evidence: fall - self.price((candidate, mask)) })
    }

    /// The price of a member: of its size, along a path of that length, of the choice among the
    /// candidates of the effect, and of the mask.
    pub fn price(&self, member: Member) -> f64 {
        let long = self.whitened.get(&member).map_or(0.0, |path| path.long);
        let alternatives = self.candidates[member.0].alternatives as f64;
        2.0 * (long / std::f64::consts::TAU.sqrt()).max(1.0).ln()
            + 2.0 * alternatives.ln()
            + self.price_of_mask(member.1)
    }

    /// Columns of the whitened model error of a member at a fit on its path, from the nearer of the
    /// two nodes.
    pub fn model_error(&self, member: Member, place: (usize, f64)) -> DMatrix<f64> {
        match self.candidates[member.0].exact {
            true => DMatrix::zeros(self.whitener.features(), 0),
            false => self.error_of_any(member, place),
        }
    }

    /// The same, whether the change of the member is exact or not.
    pub fn error_of_any(&self, member: Member, (segment, share): (usize, f64)) -> DMatrix<f64> {
        let rows = self.whitener.features();
        let Some(path) = self.whitened.get(&member) else {
            return DMatrix::zeros(rows, 0);
        };
        let near = if share < 0.5 { segment } else { segment + 1 };
        let node = if path.nodes[near].is_empty() { 2 * segment + 1 - near } else { near };
        if path.nodes[node].is_empty() {
            return DMatrix::zeros(rows, 0);
        }
        let columns = path.errors[node].get_or_init(|| {
            let change = self.masks[member.1].on(&self.candidates[member.0].nodes[node].change);
            reduced(&self.whitener.apply_all(&self.whitener.response_error(&change)))
        });
        let there = blend(&path.nodes[segment], &path.nodes[segment + 1], share, rows);
        let length = path.lengths[node];
        columns * if length > 0.0 { (dot(&there, &there) / length).sqrt() } else { 0.0 }
    }

    /// A member at a fit on its path.
    pub fn at(&self, (candidate, mask): Member, (segment, share): (usize, f64)) -> Fitted {
        self.fitted(candidate, mask, Best { segment, share, fall: 0.0, evidence: 0.0 })
    }

    /// A candidate under a mask and the whitened difference `z`, by section.
    pub fn by_section(&self, z: &[f64], candidate: usize, mask: usize) -> Option<BySection> {
        let path = self.whitened.get(&(candidate, mask))?;
        let sections = self.masks[0].sections.len().max(1);
        let size = z.len() / sections;
        let parts = |a: &[f64], b: &[f64]| -> Vec<f64> {
            let part = |at: usize| {
                if a.is_empty() || b.is_empty() {
                    0.0
                } else {
                    dot(&a[at * size..][..size], &b[at * size..][..size])
                }
            };
            (0..sections).map(part).collect()
        };
        let of = &self.candidates[candidate];
        Some(BySection {
            lengths: path.nodes.iter().map(|node| parts(node, node)).collect(),
            products: path.nodes.windows(2).map(|pair| parts(&pair[0], &pair[1])).collect(),
            along: path.nodes.iter().map(|node| parts(node, z)).collect(),
            sizes: of.nodes.iter().map(|node| node.size).collect(),
            discrete: of.discrete,
        })
    }

    /// Penalty of the choice of a mask.
    fn price_of_mask(&self, mask: usize) -> f64 {
        if mask == 0 { 0.0 } else { 2.0 * (self.masks.len() as f64).ln() }
    }

    /// The largest evidence of any candidate for `z`, in all sections.
    pub fn most(&self, z: &[f64]) -> f64 {
        (0..self.candidates.len())
            .filter_map(|at| self.meet(z, at, 0))
            .map(|best| best.evidence)
            .fold(0.0, f64::max)
    }

    /// The best size of a candidate under a mask for the whitened difference `z`.
    pub fn fit(&self, z: &[f64], candidate: usize, mask: usize) -> Option<Fitted> {
        let best = self.meet(z, candidate, mask)?;
        Some(self.fitted(candidate, mask, best))
    }

    fn fitted(&self, candidate: usize, mask: usize, best: Best) -> Fitted {
        let Best { segment, share, fall, evidence } = best;
        let path = &self.whitened[&(candidate, mask)];
        let of = &self.candidates[candidate];
        let (from, to) = (&of.nodes[segment], &of.nodes[segment + 1]);
        let whitened =
            blend(&path.nodes[segment], &path.nodes[segment + 1], share, self.whitener.features());
        let size = between(from.size, to.size, share);
        let slope = path.slope(of, &path.nodes, segment, size);
        Fitted { candidate, mask, segment, share, size, fall, evidence, whitened, slope }
    }

    /// The best fit of every candidate, each under its best mask.
    pub fn all(&self, z: &[f64]) -> Vec<Fitted> {
        use rayon::prelude::*;
        (0..self.candidates.len())
            .into_par_iter()
            .filter_map(|candidate| self.best(z, candidate))
            .collect()
    }

    /// The best fit of a candidate under any of its masks.
    pub fn best(&self, z: &[f64], candidate: usize) -> Option<Fitted> {
        let met =
            (0..self.masks.len()).filter_map(|mask| Some((mask, self.meet(z, candidate, mask)?)));
        let (mask, best) = met.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence))?;
        Some(self.fitted(candidate, mask, best))
    }
}

impl Fitted {
    /// Standard error of the size, by the fit and by the interpolation between simulated sizes; 0
    /// where it has none.
    pub fn error(&self) -> f64 {
        if self.slope > 0.0 {
            (1.0 / self.slope).hypot(INTERPOLATION * self.size.abs().min(1e12))
        } else {
            0.0
        }
    }

    /// Standard error of the size by the error of the response that all features share: it is
    /// another size, and not seen in the residual.
    pub fn common_error(&self, candidates: &[Candidate], common: f64) -> f64 {
        let of = &candidates[self.candidate];
        let change = of
            .neutral()
            .filter(|neutral| neutral.is_finite())
            .map_or(self.size, |neutral| self.size - neutral)
            .abs();
        if of.exact { 0.0 } else { common * change }
    }

    /// Derivative of the features with respect to the size, at the fitted size.
    pub fn tangent(&self, candidates: &[Candidate], masks: &[Mask]) -> Vec<f64> {
        let [from, to] =
            [self.segment, self.segment + 1].map(|node| &candidates[self.candidate].nodes[node]);
        // Derivative of `between` with respect to the share.
        let width = if to.size.is_infinite() {
            from.size / (1.0 - self.share).powi(2)
        } else {
            to.size - from.size
        };
        let get = |node: &Vec<f64>, i: usize| node.get(i).copied().unwrap_or(0.0);
        let raw = |i: usize| (get(&to.change, i) - get(&from.change, i)) / width;
        masks[self.mask]
            .on(&(0..from.change.len().max(to.change.len())).map(raw).collect::<Vec<f64>>())
    }

    /// Change of the features, not whitened.
    pub fn change(&self, candidates: &[Candidate], masks: &[Mask]) -> Vec<f64> {
        let of = &candidates[self.candidate];
        let (a, b) = (&of.nodes[self.segment].change, &of.nodes[self.segment + 1].change);
        let n = a.len().max(b.len());
        let get = |node: &Vec<f64>, i: usize| if node.is_empty() { 0.0 } else { node[i] };
        let raw: Vec<f64> =
            (0..n).map(|i| (1.0 - self.share) * get(a, i) + self.share * get(b, i)).collect();
        masks[self.mask].on(&raw)
    }
}
