//! A set of effects fitted together, and the requirements on its members.

use std::sync::Arc;

use crate::diagnose::fit::fitter::{Fitted, Member};
use crate::diagnose::linearise::{
    candidate::Candidate,
    metric::Metric,
    whiten::{dot, less},
};

/// Requirements on a member.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Least evidence of a member.
    pub first: f64,
    /// The same for an operation on the signals, whose change is exact.
    pub exact: f64,
}

impl Bars {
    /// Least evidence of a candidate.
    pub fn least(&self, candidate: &Candidate) -> f64 {
        if candidate.exact { self.exact } else { self.first }
    }
}

/// A set of effects fitted together, and the residual. `fall` and `evidence` of a member are what
/// the set loses without it.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub members: Vec<Fitted>,
    /// Members within their declared tolerance: fitted with the others, not named.
    pub nuisances: Vec<Fitted>,
    /// The whitened residual.
    pub rest: Vec<f64>,
    /// Evidence of the whole set.
    pub evidence: f64,
    /// The error of the responses of the members.
    pub metric: Arc<Metric>,
}

/// A candidate that does not meet a requirement.
#[derive(Clone, Debug)]
pub struct Refused {
    pub fitted: Fitted,
    pub reason: String,
}

impl Chosen {
    /// The empty set.
    pub fn none(z: &[f64]) -> Self {
        Self {
            members: Vec::new(),
            nuisances: Vec::new(),
            rest: z.to_vec(),
            evidence: 0.0,
            metric: Arc::default(),
        }
    }

    /// All that is fitted, the members first.
    pub fn all(&self) -> impl Iterator<Item = &Fitted> {
        self.members.iter().chain(&self.nuisances)
    }

    /// The same, by candidate and mask.
    pub fn set(&self) -> Vec<Member> {
        self.all().map(|member| (member.candidate, member.mask)).collect()
    }

    /// The residual weighted with the error of the responses, for the fit of a further effect.
    pub fn weighed(&self) -> Vec<f64> {
        self.metric.apply(&self.metric.apply(&self.rest))
    }

    /// The whitened difference less the changes of all but one member.
    pub fn left_by_others(&self, z: &[f64], at: usize) -> Vec<f64> {
        let others = self.all().enumerate().filter(|(other, _)| *other != at);
        others.fold(z.to_vec(), |rest, (_, other)| less(&rest, &other.whitened))
    }
}

/// Whether a size is within the plausible range of the catalogue.
pub fn plausible(candidate: &Candidate, size: f64) -> bool {
    (candidate.range.0..=candidate.range.1).contains(&size)
}

/// Chi-squared of a whitened difference.
pub fn chi_squared(z: &[f64]) -> f64 {
    dot(z, z)
}
