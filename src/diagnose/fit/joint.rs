//! The joint fit of a set of effects, and its evidence.
//!
//! All sizes of a set are fitted together by generalised least squares under `C + U U'`: the
//! allowed difference `C` and the model error `U` of the simulated members. The evidence of the set
//! is twice the logarithm of its Bayes factor against no effect (Laplace): `z'z - r' (C + U U')^-1
//! r - log |I + U' C^-1 U|`, less the prices of the sizes and choices of its members.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use crate::diagnose::fit::fitter::{Fitted, Fitter, Member};
use crate::diagnose::levels::joint::{ALIKE, CONVERGED, ROUNDS, TURNS};
use crate::diagnose::linearise::{
    candidate::blend,
    metric::Metric,
    path::{Closest, Path, closest, products},
    whiten::{dot, less},
};

/// A set of effects fitted together.
#[derive(Clone, Debug)]
pub struct Joint {
    /// In the order of the set. `fall` and `evidence` are those of the whole set.
    pub members: Vec<Fitted>,
    /// The residual, whitened by the allowed difference alone.
    pub rest: Vec<f64>,
    pub metric: Arc<Metric>,
    /// Twice the fall of the negative logarithm of the likelihood.
    pub fall: f64,
    pub evidence: f64,
}

/// A path in the metric of a set.
struct Seen {
    nodes: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    products: Vec<f64>,
    discrete: bool,
}

impl Seen {
    fn new(path: &Path, metric: &Metric, discrete: bool) -> Self {
        let nodes: Vec<Vec<f64>> = path.nodes.iter().map(|node| metric.apply(node)).collect();
        let (lengths, products) = products(&nodes);
        Self { nodes, lengths, products, discrete }
    }

    fn along(&self, z: &[f64]) -> Vec<f64> {
        self.nodes.iter().map(|node| if node.is_empty() { 0.0 } else { dot(node, z) }).collect()
    }

    fn at(&self, (segment, share): (usize, f64), len: usize) -> Vec<f64> {
        blend(&self.nodes[segment], &self.nodes[segment + 1], share, len)
    }
}

/// Fits the sizes in turn until chi-squared converges: segment and share of each.
fn alternate(z: &[f64], paths: &[Seen]) -> Option<Vec<(usize, f64)>> {
    let mut changes: Vec<Vec<f64>> = Vec::new();
    let mut fits = Vec::new();
    let mut rest = z.to_vec();
    let mut before = f64::INFINITY;
    for turn in 0..TURNS {
        for (at, path) in paths.iter().enumerate() {
            if let Some(change) = changes.get(at) {
                rest.iter_mut().zip(change).for_each(|(rest, change)| *rest += change);
            }
            let Closest { segment, share, .. } =
                closest(&path.lengths, &path.products, &path.along(&rest), path.discrete)?;
            let change = path.at((segment, share), z.len());
            rest = less(&rest, &change);
            if turn == 0 {
                changes.push(change);
                fits.push((segment, share));
            } else {
                changes[at] = change;
                fits[at] = (segment, share);
            }
        }
        let now = dot(&rest, &rest);
        if paths.len() < 2 || before - now <= CONVERGED * now {
            break;
        }
        before = now;
    }
    Some(fits)
}

/// Fits a set of effects to the whitened difference `z`; nothing if a member has no path.
pub fn fit(fitter: &Fitter<'_>, z: &[f64], set: &[Member]) -> Option<Joint> {
    let paths: Vec<&Path> =
        set.iter().map(|member| fitter.whitened.get(member)).collect::<Option<_>>()?;
    let mut metric = Metric::default();
    let mut fits: Vec<(usize, f64)> = Vec::new();
    let mut seen = Vec::new();
    for round in 0..=ROUNDS {
        seen = paths
            .iter()
            .zip(set)
            .map(|(path, member)| Seen::new(path, &metric, fitter.candidates[member.0].discrete))
            .collect();
        let now = alternate(&metric.apply(z), &seen)?;
        let moved =
            |(a, b): (&(usize, f64), &(usize, f64))| a.0 != b.0 || (a.1 - b.1).abs() > ALIKE;
        let converged = !fits.is_empty() && !fits.iter().zip(&now).any(moved);
        fits = now;
        if round == ROUNDS || converged {
            break;
        }
        let columns: Vec<DMatrix<f64>> =
            set.iter().zip(&fits).map(|(member, fit)| fitter.model_error(*member, *fit)).collect();
        if columns.iter().all(|columns| columns.ncols() == 0) {
            break;
        }
        metric = self::metric(z.len(), &columns);
    }
    let slopes = slopes(&paths, &seen, fitter, set, &fits);
    let price: f64 = set.iter().map(|member| fitter.price(*member)).sum();
    let mut members: Vec<Fitted> = set
        .iter()
        .zip(&fits)
        .zip(slopes)
        .map(|((member, fit), slope)| Fitted { slope, ..fitter.at(*member, *fit) })
        .collect();
    let rest = members.iter().fold(z.to_vec(), |rest, member| less(&rest, &member.whitened));
    let weighed = metric.apply(&rest);
    let fall = dot(z, z) - dot(&weighed, &weighed) - metric.log_determinant;
    members.iter_mut().for_each(|member| (member.fall, member.evidence) = (fall, fall - price));
    Some(Joint { members, rest, metric: Arc::new(metric), fall, evidence: fall - price })
}

/// The metric of the error of the responses of several members.
pub fn metric(features: usize, columns: &[DMatrix<f64>]) -> Metric {
    let mut all = DMatrix::zeros(features, columns.iter().map(DMatrix::ncols).sum());
    let mut at = 0;
    for part in columns {
        all.columns_mut(at, part.ncols()).copy_from(part);
        at += part.ncols();
    }
    Metric::new(&all)
}

/// The reciprocal standard error of each size, with the other sizes free.
fn slopes(
    paths: &[&Path],
    seen: &[Seen],
    fitter: &Fitter<'_>,
    set: &[Member],
    fits: &[(usize, f64)],
) -> Vec<f64> {
    let alone: Vec<f64> = (0..set.len())
        .map(|at| {
            let of = &fitter.candidates[set[at].0];
            let (segment, share) = fits[at];
            paths[at].slope(of, &seen[at].nodes, segment, of.size_at(segment, share))
        })
        .collect();
    if set.len() < 2 {
        return alone;
    }
    let tangents: Vec<DVector<f64>> = seen
        .iter()
        .zip(fits)
        .map(|(path, (segment, _))| {
            let (a, b) = (&path.nodes[*segment], &path.nodes[segment + 1]);
            let len = a.len().max(b.len());
            let tangent = DVector::from(less(&blend(a, b, 1.0, len), &blend(a, b, 0.0, len)));
            let norm = tangent.norm();
            if norm > 0.0 { tangent / norm } else { tangent }
        })
        .collect();
    let gram = DMatrix::from_fn(set.len(), set.len(), |i, j| tangents[i].dot(&tangents[j]));
    // The diagonal of the inverse is the variance inflation by the other sizes.
    let inverse =
        gram.pseudo_inverse(1e-9).unwrap_or_else(|_| DMatrix::identity(set.len(), set.len()));
    alone.iter().enumerate().map(|(at, slope)| slope / inverse[(at, at)].max(1.0).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::candidate::{Candidate, Node};
    use crate::diagnose::linearise::mask::Mask;
    use crate::diagnose::linearise::response::ResponseError;
    use crate::diagnose::linearise::whiten::Covariance;

    fn path(effect: &str, change: Vec<f64>) -> Candidate {
        Candidate::path(
            effect,
            vec![Node { size: 0.0, change: Vec::new() }, Node { size: 10.0, change }],
        )
    }

    fn everywhere(sections: usize) -> Vec<Mask> {
        vec![Mask::everywhere(sections)]
    }

    /// Ten sections of two features of unit variance. Two changes with a cosine of 0.9 are present
    /// with sizes 3 and 3. Together they explain all of chi-squared, 10 (5.7^2 + 0.19 * 9) = 342.
    /// The reciprocal standard error of each size is that of its component across the other change:
    /// (10 * 1 * 0.19)^1/2.
    #[test]
    fn similar_changes_are_fitted_together() {
        const SECTIONS: usize = 10;
        let per_section = |a: f64, b: f64| (0..SECTIONS).flat_map(|_| [a, b]).collect::<Vec<f64>>();
        let side = 0.19_f64.sqrt();
        let candidates =
            [path("first", per_section(10.0, 0.0)), path("second", per_section(9.0, 10.0 * side))];
        let covariance = Covariance {
            diagonal: vec![1.0; 20],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 2,
            response: ResponseError::default(),
        };
        let whitener = covariance.whitener();
        let fitter = Fitter::new(&whitener, &candidates, everywhere(SECTIONS));
        let z = per_section(3.0 + 2.7, 3.0 * side);
        let both = fit(&fitter, &z, &[(0, 0), (1, 0)]).expect("two paths");
        assert!((both.fall - 342.0).abs() < 0.5, "{}", both.fall);
        for member in &both.members {
            assert!((member.size - 3.0).abs() < 0.01, "{}", member.size);
            assert!((member.slope - 1.9_f64.sqrt()).abs() < 1e-6, "{}", member.slope);
        }
        let prices = 2.0 * (10.0 * 10.0_f64.sqrt() / std::f64::consts::TAU.sqrt()).ln() * 2.0;
        assert!((both.fall - both.evidence - prices).abs() < 1e-9);
    }

    /// One feature in each of four sections, of unit variance, changed by 10 at size 10, with a
    /// common relative error of 0.5: at size 10 the covariance is I + 25 * 1 1'. A difference of 10
    /// is fitted without a residual, so that the evidence is z'z - log(1 + 25 * 4) less the price,
    /// and the reciprocal standard error of the size (4 / (1 + 100))^1/2.
    #[test]
    fn the_model_error_of_an_effect_costs_evidence_and_widens_its_size() {
        let candidates = [path("effect", vec![10.0; 4])];
        let response = ResponseError::of(&[(&[0], 0.5)], 4);
        let covariance = Covariance {
            diagonal: vec![1.0; 4],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 1,
            response,
        };
        let whitener = covariance.whitener();
        let fitter = Fitter::new(&whitener, &candidates, everywhere(4));
        let found = fit(&fitter, &[10.0; 4], &[(0, 0)]).expect("a path");
        assert!((found.fall - (400.0 - 101.0_f64.ln())).abs() < 1e-9, "{}", found.fall);
        assert!((found.members[0].slope - (4.0_f64 / 101.0).sqrt()).abs() < 1e-9);
        let exact = [Candidate { exact: true, ..candidates[0].clone() }];
        let fitter = Fitter::new(&whitener, &exact, everywhere(4));
        let found = fit(&fitter, &[10.0; 4], &[(0, 0)]).expect("a path");
        assert!((found.fall - 400.0).abs() < 1e-9 && (found.members[0].slope - 2.0).abs() < 1e-9);
    }

    /// Levels give a size of 1, all other features 0.5, both nearly without noise. The model errors
    /// are 0.05 and 0.2, so that the joint size is (1 / 0.05^2 + 0.5 / 0.2^2) / (1 / 0.05^2 + 1 /
    /// 0.2^2) = 0.9706, with the relative error 1 / (1 / 0.05^2 + 1 / 0.2^2)^1/2.
    #[test]
    fn levels_say_more_of_a_size_than_other_features() {
        const SECTIONS: usize = 3;
        let per_section =
            |level: f64, rest: f64| (0..SECTIONS).flat_map(|_| [level, rest]).collect::<Vec<f64>>();
        let nodes = vec![
            Node { size: 0.0, change: Vec::new() },
            Node { size: 2.0, change: per_section(20.0, 20.0) },
        ];
        let candidates = [Candidate::path("effect", nodes)];
        let response = ResponseError::of(&[(&[0], 0.05), (&[1], 0.2)], SECTIONS);
        let covariance = Covariance {
            diagonal: vec![1e-6; 2 * SECTIONS],
            inside: Vec::new(),
            shared: Vec::new(),
            size: 2,
            response,
        };
        let whitener = covariance.whitener();
        let fitter = Fitter::new(&whitener, &candidates, everywhere(SECTIONS));
        let found =
            fit(&fitter, &whitener.apply(&per_section(10.0, 5.0)), &[(0, 0)]).expect("a path");
        let weights = [0.05_f64.powi(-2), 0.2_f64.powi(-2)];
        let (size, error) =
            (found.members[0].size, 1.0 / found.members[0].slope / found.members[0].size);
        assert!(
            (size - (weights[0] + 0.5 * weights[1]) / (weights[0] + weights[1])).abs() < 1e-4,
            "{size}"
        );
        assert!((error - (weights[0] + weights[1]).powf(-0.5)).abs() < 1e-3, "{error}");
    }
}
