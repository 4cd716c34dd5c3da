//! Candidate causes: for every effect of the catalogue, the change of the features with its size.

use std::sync::Arc;

use crate::diagnose::observe::bench::{Bench, Set};
use crate::effects::{Action, Effect, Parameter};
use crate::units::Unit;

/// The change of the features with the size of an effect, as a piecewise linear path through the
/// simulated sizes.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub effect: String,
    /// The channels of an operation.
    pub channels: Vec<String>,
    /// The parameter that is the size, and its plausible range.
    pub size: String,
    pub unit: Unit,
    pub range: (f64, f64),
    /// Other parameters, constant.
    pub fixed: Vec<(String, f64)>,
    /// In increasing order of size; `change` is empty at the neutral size.
    pub nodes: Vec<Node>,
    /// Without interpolation between nodes.
    pub discrete: bool,
    /// An operation on the recorded signals: its change has no model error.
    pub exact: bool,
    pub confinable: bool,
    /// The declared tolerance of the same parameter.
    pub tolerance: Option<String>,
    /// Number of candidates of the same effect, which enters the penalty of the evidence.
    pub alternatives: usize,
    /// Sizes that are simulated only if the coarser ones give enough evidence.
    pub pending: Vec<f64>,
    /// The other members that are present in its simulations, if any.
    pub beside: Option<Arc<Beside>>,
}

impl Candidate {
    /// A candidate for an effect and one of its parameters, in all sections and without channels.
    pub fn new(effect: &Effect, parameter: &Parameter, mut nodes: Vec<Node>) -> Self {
        nodes.sort_by(|a, b| a.size.total_cmp(&b.size));
        Self {
            effect: effect.name.clone(),
            channels: Vec::new(),
            size: parameter.name.clone(),
            unit: parameter.unit.clone(),
            range: (parameter.low, parameter.high),
            fixed: Vec::new(),
            nodes,
            discrete: false,
            exact: matches!(effect.action, Action::Signals(..)),
            confinable: effect.confinable,
            tolerance: effect.tolerance.clone(),
            alternatives: 1,
            pending: Vec::new(),
            beside: None,
        }
    }

    /// A candidate from a path, for tests.
    #[cfg(test)]
    pub fn path(effect: &str, nodes: Vec<Node>) -> Self {
        Self {
            effect: effect.into(),
            channels: Vec::new(),
            size: "size".into(),
            unit: Unit::one(),
            range: (0.0, 10.0),
            fixed: Vec::new(),
            nodes,
            discrete: false,
            exact: false,
            confinable: true,
            tolerance: None,
            alternatives: 1,
            pending: Vec::new(),
            beside: None,
        }
    }

    /// Range of the change of a feature between half and one and a half times the distance of a
    /// size from neutral.
    pub fn range_near(&self, size: f64, place: usize) -> f64 {
        let reach = 0.5 * (size - self.neutral().unwrap_or(0.0)).abs();
        let near = self.nodes.iter().filter(|node| (node.size - size).abs() <= reach);
        let changes = near.map(|node| node.change.get(place).copied().unwrap_or(0.0));
        let (low, high) = changes
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), change| {
                (low.min(change), high.max(change))
            });
        (high - low).max(0.0)
    }

    /// The size without influence.
    pub fn neutral(&self) -> Option<f64> {
        self.nodes.iter().find(|node| node.change.is_empty()).map(|node| node.size)
    }

    /// Whether it is the same cause, possibly by another parameter.
    pub fn is_like(&self, other: &Self) -> bool {
        self.effect == other.effect && self.channels == other.channels
    }

    /// Whether two sizes are on the same side of neutral.
    pub fn same_side(&self, size: f64, other: f64) -> bool {
        self.neutral().is_none_or(|neutral| (size < neutral) == (other < neutral))
    }

    /// Whether sizes on the side of `size` remain to be simulated.
    pub fn pending_towards(&self, size: f64) -> bool {
        self.pending.iter().any(|pending| self.same_side(*pending, size))
    }

    /// Whether it exchanges two channels.
    pub fn effect_is_swap(&self) -> bool {
        self.discrete
            && self.channels.len() == 2
            && self.nodes.len() == 2
            && !self.size.contains(crate::effects::CHANNEL)
    }
}

/// A size and the change of the features.
#[derive(Clone, Debug)]
pub struct Node {
    pub size: f64,
    /// Change of all features; empty at the neutral size.
    pub change: Vec<f64>,
}

/// Members that are present in a simulation.
#[derive(Debug)]
pub struct Beside {
    pub set: Vec<Set>,
    /// Features of the simulation with them.
    pub base: Vec<f64>,
}

impl Beside {
    /// A bench with these members set.
    pub fn on<'a>(&self, bench: &Bench<'a>) -> Bench<'a> {
        Bench {
            set: bench.set.iter().chain(&self.set).cloned().collect(),
            cache: bench.cache.clone(),
            ..*bench
        }
    }
}

/// Interpolates between two changes of this many features, each empty where it is zero.
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
    pub fn size_at(&self, segment: usize, share: f64) -> f64 {
        between(self.nodes[segment].size, self.nodes[segment + 1].size, share)
    }
}

/// Interpolates between two sizes. One may be infinite, where the effect vanishes with increasing
/// size: then the reciprocal is interpolated.
pub fn between(from: f64, to: f64, share: f64) -> f64 {
    if to.is_infinite() {
        return if share < 1.0 { from / (1.0 - share) } else { f64::INFINITY };
    }
    from + share * (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lags of 0, 1, 2 and then 30 at the sizes 0 to 3: the range is at most 1 around size 1, and
    /// larger around 2.5.
    #[test]
    fn what_jumps_between_sizes_is_seen_near_them() {
        let node = |(size, lag): (f64, f64)| Node {
            size,
            change: if size == 0.0 { Vec::new() } else { vec![5.0, lag] },
        };
        let of = Candidate::path(
            "effect",
            [(0.0, 0.0), (1.0, 1.0), (1.5, 2.0), (3.0, 30.0)].map(node).to_vec(),
        );
        assert_eq!(
            [
                of.range_near(1.0, 1),
                of.range_near(2.5, 1),
                of.range_near(2.5, 0),
                of.range_near(0.0, 1)
            ],
            [1.0, 28.0, 0.0, 0.0]
        );
    }
}
