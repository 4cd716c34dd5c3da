//! Fit of candidates to a difference: sizes and evidence.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};

use super::beside::Placed;
use super::candidates::Candidate;
use crate::diagnose::allowed::metric::reduced;
use crate::diagnose::allowed::whiten::{Whitener, dot};

/// Sections to which an effect is confined; mask 0 is all sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// Column and values; nothing for all sections.
    pub confined: Option<(String, Vec<String>)>,
    pub sections: Vec<bool>,
    /// The candidate whose fit selected the sections, if they were selected from the data: the selection has a penalty.
    pub asked_by: Option<usize>,
}

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
    /// Fall less the penalty of the free parameters: twice the logarithm of the Bayes factor against no effect.
    pub evidence: f64,
    /// Whitened change.
    pub whitened: Vec<f64>,
    /// Length of the whitened change per unit of the size.
    pub slope: f64,
    /// Whether views give rather different sizes, though none gives zero.
    pub doubtful: bool,
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

/// A candidate under a mask: its whitened nodes, and the terms of a fit that do not depend on the difference.
#[derive(Debug)]
pub struct Path {
    /// Sizes of the nodes, and the members simulated with them.
    sizes: Vec<f64>,
    beside: Option<Placed>,
    pub nodes: Vec<Vec<f64>>,
    /// Squared lengths of the nodes, and inner products of each with the next.
    lengths: Vec<f64>,
    products: Vec<f64>,
    /// Length of the whole path, in standard deviations.
    long: f64,
    /// The whitened model error of each node, computed when first needed.
    errors: Vec<OnceLock<DMatrix<f64>>>,
}

/// Least distance of nodes from a size, as a share of it, for the estimate of the slope.
const APART: f64 = 0.05;

/// The best fit on a path.
#[derive(Clone, Copy, Debug)]
struct Best {
    segment: usize,
    share: f64,
    fall: f64,
    evidence: f64,
}

/// The best fit on a path.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    pub segment: usize,
    pub share: f64,
    pub fall: f64,
}

/// From squared lengths of the nodes, inner products of each with the next, and inner products of each with the difference.
#[must_use]
pub fn closest(lengths: &[f64], products: &[f64], along: &[f64], discrete: bool) -> Option<Closest> {
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
    lengths: Vec<Vec<f64>>,
    products: Vec<Vec<f64>>,
    along: Vec<Vec<f64>>,
    sizes: Vec<f64>,
    discrete: bool,
}

impl BySection {
    /// Fall of chi-squared and size with a weight per section; nothing where no section with a weight is changed.
    #[must_use]
    pub fn fit(&self, times: &[f64]) -> Option<(f64, f64)> {
        self.fit_among(times, 0..self.sizes.len())
    }

    /// As [`Self::fit`], among sizes on the same side of neutral as `size`.
    #[must_use]
    pub fn fit_beside(&self, times: &[f64], size: f64) -> Option<(f64, f64)> {
        let nothing = self.lengths.iter().position(|sections| sections.iter().all(|length| *length == 0.0));
        let nodes = match nothing {
            Some(at) if size > self.sizes[at] => at..self.sizes.len(),
            Some(at) if size < self.sizes[at] => 0..at + 1,
            _ => 0..self.sizes.len(),
        };
        self.fit_among(times, nodes)
    }

    fn fit_among(&self, times: &[f64], nodes: Range<usize>) -> Option<(f64, f64)> {
        let sum = |parts: &Vec<f64>| dot(parts, times);
        let segments = nodes.start..nodes.end.saturating_sub(1);
        let [lengths, products, along] = [&self.lengths[nodes.clone()], &self.products[segments], &self.along[nodes.clone()]]
            .map(|all| all.iter().map(sum).collect::<Vec<f64>>());
        if lengths.iter().all(|length| *length == 0.0) {
            return None;
        }
        let Closest { segment, share, fall, .. } = closest(&lengths, &products, &along, self.discrete)?;
        let sizes = &self.sizes[nodes];
        Some((fall, between(sizes[segment], sizes[segment + 1], share)))
    }
}

impl Path {
    fn new(of: &Candidate, nodes: Vec<Vec<f64>>) -> Self {
        let product = |a: &Vec<f64>, b: &Vec<f64>| if a.is_empty() || b.is_empty() { 0.0 } else { dot(a, b) };
        let lengths: Vec<f64> = nodes.iter().map(|node| product(node, node)).collect();
        let products: Vec<f64> = nodes.windows(2).map(|pair| product(&pair[0], &pair[1])).collect();
        let step = |at: usize| (lengths[at] - 2.0 * products[at] + lengths[at + 1]).max(0.0).sqrt();
        let long = (0..products.len()).map(step).sum();
        let sizes = of.nodes.iter().map(|node| node.size).collect();
        let errors = nodes.iter().map(|_| OnceLock::new()).collect();
        Self { sizes, beside: of.beside.clone(), nodes, lengths, products, long, errors }
    }

    /// Whether a candidate is unchanged.
    fn is_of(&self, candidate: &Candidate) -> bool {
        let beside = match (&self.beside, &candidate.beside) {
            (Some(a), Some(b)) => a.same_place(b),
            (a, b) => a.is_none() && b.is_none(),
        };
        beside && candidate.nodes.iter().map(|node| node.size).eq(self.sizes.iter().copied())
    }

    /// Length of the change per unit of the size, between nodes at some distance on either side. Between two close nodes, scatter of the
    /// features would dominate. 0 where one of the two sizes is infinite. `nodes` are the whitened nodes, in any metric.
    #[must_use]
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

impl<'a> Fitter<'a> {
    /// Whitens the nodes of all candidates under all their masks.
    #[must_use]
    pub fn new(whitener: &'a Whitener, candidates: &'a [Candidate], masks: Vec<Mask>) -> Self {
        Self::knowing(whitener, candidates, masks, Known::new())
    }

    /// As [`Self::new`], reusing the results of an earlier fitter. Candidates may have more nodes since, and there may be more masks.
    #[must_use]
    pub fn knowing(whitener: &'a Whitener, candidates: &'a [Candidate], masks: Vec<Mask>, known: Known) -> Self {
        let every = (0..candidates.len()).flat_map(|at| (0..masks.len()).map(move |mask| (at, mask)));
        let keys: Vec<(usize, usize)> = every.filter(|(at, mask)| allowed(candidates, &masks, *at, *mask)).collect();
        Self::whitening(whitener, candidates, masks, known, keys)
    }

    /// For fits of some members alone, each under its own mask.
    #[must_use]
    pub fn of(whitener: &'a Whitener, candidates: &'a [Candidate], masks: Vec<Mask>, members: &[Fitted]) -> Self {
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
        let whitened: Vec<_> =
            keys.par_iter().map(|(at, mask)| ((*at, *mask), Path::new(&candidates[*at], fitter.nodes(*at, *mask)))).collect();
        fitter.whitened.extend(whitened);
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

    /// The best fit of a candidate under a mask to the whitened difference `z`.
    fn meet(&self, z: &[f64], candidate: usize, mask: usize) -> Option<Best> {
        let path = self.whitened.get(&(candidate, mask))?;
        let of = &self.candidates[candidate];
        let along: Vec<f64> = path.nodes.iter().map(|node| if node.is_empty() { 0.0 } else { dot(z, node) }).collect();
        let Closest { segment, share, fall } = closest(&path.lengths, &path.products, &along, of.discrete)?;
        Some(Best { segment, share, fall, evidence: fall - self.price((candidate, mask)) })
    }

    /// The price of a member: of its size, along a path of that length, of the choice among the candidates of the effect, and of the mask.
    #[must_use]
    pub fn price(&self, member: Member) -> f64 {
        let long = self.whitened.get(&member).map_or(0.0, |path| path.long);
        let alternatives = self.candidates[member.0].alternatives as f64;
        2.0 * (long / std::f64::consts::TAU.sqrt()).max(1.0).ln() + 2.0 * alternatives.ln() + self.price_of_mask(member.1)
    }

    /// Columns of the whitened model error of a member at a fit on its path, from the nearer of the two nodes.
    #[must_use]
    pub fn model_error(&self, member: Member, (segment, share): (usize, f64)) -> DMatrix<f64> {
        let rows = self.whitener.features();
        let (Some(path), false) = (self.whitened.get(&member), self.candidates[member.0].exact) else { return DMatrix::zeros(rows, 0) };
        let near = if share < 0.5 { segment } else { segment + 1 };
        let node = if path.nodes[near].is_empty() { 2 * segment + 1 - near } else { near };
        if path.nodes[node].is_empty() {
            return DMatrix::zeros(rows, 0);
        }
        let columns = path.errors[node].get_or_init(|| {
            let change = self.masks[member.1].on(&self.candidates[member.0].nodes[node].change);
            let columns: Vec<DVector<f64>> =
                self.whitener.response_error(&change).iter().map(|column| DVector::from(self.whitener.apply(column))).collect();
            if columns.is_empty() { DMatrix::zeros(rows, 0) } else { reduced(&DMatrix::from_columns(&columns)) }
        });
        let there = blend(&path.nodes[segment], &path.nodes[segment + 1], share, rows);
        let length = path.lengths[node];
        columns * if length > 0.0 { (dot(&there, &there) / length).sqrt() } else { 0.0 }
    }

    /// A member at a fit on its path.
    #[must_use]
    pub fn at(&self, (candidate, mask): Member, (segment, share): (usize, f64)) -> Fitted {
        self.fitted(candidate, mask, Best { segment, share, fall: 0.0, evidence: 0.0 })
    }

    /// A candidate under a mask and the whitened difference `z`, by section.
    #[must_use]
    pub fn by_section(&self, z: &[f64], candidate: usize, mask: usize) -> Option<BySection> {
        let path = self.whitened.get(&(candidate, mask))?;
        let sections = self.masks[0].sections.len().max(1);
        let size = z.len() / sections;
        let parts = |a: &[f64], b: &[f64]| -> Vec<f64> {
            let part = |at: usize| if a.is_empty() || b.is_empty() { 0.0 } else { dot(&a[at * size..][..size], &b[at * size..][..size]) };
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
        let fixed = self.masks.iter().filter(|mask| mask.asked_by.is_none()).count();
        match self.masks[mask].asked_by {
            _ if mask == 0 => 0.0,
            None => 2.0 * (fixed as f64).ln(),
            Some(_) => 2.0 * std::f64::consts::LN_2 * self.masks[mask].sections.len() as f64,
        }
    }

    /// The largest evidence of any candidate for `z`, in all sections.
    #[must_use]
    pub fn most(&self, z: &[f64]) -> f64 {
        (0..self.candidates.len()).filter_map(|at| self.meet(z, at, 0)).map(|best| best.evidence).fold(0.0, f64::max)
    }

    /// The best size of a candidate under a mask for the whitened difference `z`.
    #[must_use]
    pub fn fit(&self, z: &[f64], candidate: usize, mask: usize) -> Option<Fitted> {
        let best = self.meet(z, candidate, mask)?;
        Some(self.fitted(candidate, mask, best))
    }

    fn fitted(&self, candidate: usize, mask: usize, best: Best) -> Fitted {
        let Best { segment, share, fall, evidence } = best;
        let path = &self.whitened[&(candidate, mask)];
        let of = &self.candidates[candidate];
        let (from, to) = (&of.nodes[segment], &of.nodes[segment + 1]);
        let whitened = blend(&path.nodes[segment], &path.nodes[segment + 1], share, self.whitener.features());
        let size = between(from.size, to.size, share);
        let slope = path.slope(of, &path.nodes, segment, size);
        Fitted { candidate, mask, segment, share, size, fall, evidence, whitened, slope, doubtful: false }
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
        let met = (0..self.masks.len()).filter_map(|mask| Some((mask, self.meet(z, candidate, mask)?)));
        let (mask, best) = met.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence))?;
        Some(self.fitted(candidate, mask, best))
    }

    /// The sections in which an effect seems to be present, where it is not present in all: those whose fitted size is more than half of
    /// the largest ones.
    #[must_use]
    pub fn seems_in(&self, z: &[f64], fit: &Fitted) -> Option<Vec<bool>> {
        let sections = self.masks[0].sections.len();
        let size = z.len() / sections.max(1);
        let whole = self.fit(z, fit.candidate, 0)?;
        let part = |values: &[f64], at: usize| values[at * size..(at + 1) * size].to_vec();
        // The share of the fitted change in each section, and its standard error.
        let asked: Vec<Option<(f64, f64)>> = (0..sections)
            .map(|at| {
                let (change, rest) = (part(&whole.whitened, at), part(z, at));
                let length = dot(&change, &change);
                (length > 0.0).then(|| (dot(&change, &rest) / length, length))
            })
            .collect();
        let strong: f64 = asked.iter().flatten().map(|(share, length)| share.max(0.0) * length).sum::<f64>();
        let weight: f64 =
            asked.iter().flatten().filter(|(share, _)| *share > 0.0).map(|(share, length)| share.max(0.0).powi(2) * length).sum();
        let typical = if strong > 0.0 { weight / strong } else { 0.0 };
        let inside: Vec<bool> = asked.iter().map(|asked| asked.is_some_and(|(share, _)| share > 0.5 * typical)).collect();
        let some = inside.iter().filter(|inside| **inside).count();
        // Excluding the few sections that fit worst always improves the fit: that is no confinement. One or two sections are not
        // significant.
        (some > 2 && 4 * some <= 3 * asked.iter().flatten().count()).then_some(inside)
    }
}

fn allowed(candidates: &[Candidate], masks: &[Mask], candidate: usize, mask: usize) -> bool {
    mask == 0 || masks[mask].asked_by.map_or(candidates[candidate].confinable, |by| by == candidate)
}

impl Mask {
    /// Bias of sections selected from the data by their size: the expected mean of that many largest values of a standard normal sample, in
    /// standard deviations. 0 where nothing was selected.
    #[must_use]
    pub fn picked(&self) -> f64 {
        use statrs::distribution::{Continuous, ContinuousCDF, Normal};
        let inside = self.sections.iter().filter(|inside| **inside).count();
        let share = inside as f64 / self.sections.len().max(1) as f64;
        if self.asked_by.is_none() || inside == 0 || share >= 1.0 {
            return 0.0;
        }
        // The mean of the upper tail of a normal distribution.
        let normal = Normal::standard();
        normal.pdf(normal.inverse_cdf(1.0 - share)) / share
    }

    /// A change in the sections of the mask, zero elsewhere.
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
    /// Derivative of the features with respect to the size, at the fitted size.
    #[must_use]
    pub fn tangent(&self, candidates: &[Candidate], masks: &[Mask]) -> Vec<f64> {
        let [from, to] = [self.segment, self.segment + 1].map(|node| &candidates[self.candidate].nodes[node]);
        // Derivative of `between` with respect to the share.
        let width = if to.size.is_infinite() { from.size / (1.0 - self.share).powi(2) } else { to.size - from.size };
        let get = |node: &Vec<f64>, i: usize| node.get(i).copied().unwrap_or(0.0);
        let raw = |i: usize| (get(&to.change, i) - get(&from.change, i)) / width;
        masks[self.mask].on(&(0..from.change.len().max(to.change.len())).map(raw).collect::<Vec<f64>>())
    }

    /// Change of the features, not whitened.
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

/// Interpolates between two changes of this many features, each empty where it is zero.
#[must_use]
pub fn blend(a: &[f64], b: &[f64], share: f64, len: usize) -> Vec<f64> {
    match (a.is_empty(), b.is_empty()) {
        (true, true) => vec![0.0; len],
        (true, false) => b.iter().map(|b| share * b).collect(),
        (false, true) => a.iter().map(|a| (1.0 - share) * a).collect(),
        (false, false) => a.iter().zip(b).map(|(a, b)| (1.0 - share) * a + share * b).collect(),
    }
}

impl Candidate {
    /// The size at a share of a segment of the path.
    #[must_use]
    pub fn size_at(&self, segment: usize, share: f64) -> f64 {
        between(self.nodes[segment].size, self.nodes[segment + 1].size, share)
    }
}

/// Interpolates between two sizes. One may be infinite, where the effect vanishes with increasing size: then the reciprocal is
/// interpolated.
fn between(from: f64, to: f64, share: f64) -> f64 {
    if to.is_infinite() {
        return if share < 1.0 { from / (1.0 - share) } else { f64::INFINITY };
    }
    from + share * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::candidates::Node;

    /// Three nodes on a line of slope 2, and one close to the middle node that is off the line: the slope is that of the line.
    #[test]
    fn nodes_side_by_side_make_no_slope() {
        let nodes = [(0.0, 0.0), (1.0, 2.0), (1.001, 2.5), (2.0, 4.0)];
        let node = |(size, change): (f64, f64)| Node { size, change: if size == 0.0 { Vec::new() } else { vec![change] } };
        let of = Candidate::path("effect", nodes.map(node).to_vec());
        let path = Path::new(&of, of.nodes.iter().map(|node| node.change.clone()).collect());
        assert!((path.slope(&of, &path.nodes, 1, 1.0005) - 2.0).abs() < 1e-12);
        assert!((path.slope(&of, &path.nodes, 0, 0.5) - 2.0).abs() < 1e-12);
    }

    /// The mean of the upper half of a standard normal distribution is (2 / pi)^1/2 = 0.798, of the upper quarter 1.271 (tables of
    /// selection intensity, Falconer and Mackay 1996, appendix A).
    #[test]
    fn sections_that_were_picked_are_off_by_chance() {
        let mask = |inside: usize, asked_by| Mask { confined: None, sections: (0..16).map(|at| at < inside).collect(), asked_by };
        assert!((mask(8, Some(0)).picked() - std::f64::consts::FRAC_2_PI.sqrt()).abs() < 1e-9);
        assert!((mask(4, Some(0)).picked() - 1.271).abs() < 1e-3);
        assert_eq!((mask(8, None).picked(), mask(16, Some(0)).picked()), (0.0, 0.0));
    }
}
