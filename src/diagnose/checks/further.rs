//! What is left for further candidates, nameable or not: tolerances, parameters outside the
//! catalogue, effects that do not meet a requirement.

use crate::diagnose::fit::{
    fitter::{Fitted, Fitter, Member},
    set::{Bars, Chosen},
};
use crate::diagnose::iterate::point::Linearisation;
use crate::diagnose::levels::{
    further::{POSSIBLE, REFUTES, SAME, SPAN},
    search::TOLERANCE_SD,
};
use crate::diagnose::linearise::{
    candidate::{Candidate, Node},
    covariance::Sensitivity,
    mask::Mask,
    whiten::dot,
};
use crate::diagnose::search::{Far, Search, with, without};
use crate::result::diagnosis::UsedTolerance;
use crate::units::Unit;

/// A tolerance as a candidate with a free size.
#[derive(Clone, Debug)]
pub struct Free {
    pub tolerance: String,
    pub parameter: String,
    /// Its size in declared standard deviations: as a further cause, or in place of a member.
    pub deviations: f64,
    /// The evidence that it adds to the answer, or that the answer has less than the set with it in
    /// place of a member.
    pub evidence: f64,
    /// The member that it replaces.
    pub instead: Option<usize>,
}

/// Estimates of the tolerances, by parameter: the mean of the posterior under the allowed
/// difference and the error of the responses.
pub fn used(at: &Linearisation, chosen: &Chosen, far: Far<'_>) -> Vec<UsedTolerance> {
    let rest = chosen.weighed();
    let one = |column: &Sensitivity| {
        (column.shared > 0.0).then(|| UsedTolerance {
            tolerance: column.tolerance.clone(),
            parameter: column.parameter.clone(),
            deviations: column.shared * dot(&at.whitener.apply(&column.column), &rest),
        })
    };
    // One that is fitted with the effects has its own size.
    let fitted = |fit: &Fitted| {
        let of = &at.candidates[fit.candidate];
        let side = (fit.size - of.neutral().unwrap_or(0.0)).signum();
        let deviations = side * far(of, fit.size);
        let tolerance = of.tolerance.clone().unwrap_or_default();
        UsedTolerance { tolerance, parameter: of.size.clone(), deviations }
    };
    let columns = at.columns.iter().flatten().filter_map(one);
    let mut all: Vec<UsedTolerance> = columns.chain(chosen.nuisances.iter().map(fitted)).collect();
    all.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    all
}

/// Tolerances with more evidence than the answer allows, as a further cause or in place of a
/// member: the one with the most evidence first. What is in place of a single member is weighed
/// without effects.
pub fn free(
    (alone, fitted): (&Linearisation, &Linearisation),
    masks: &[Mask],
    chosen: &Chosen,
    bars: &Bars,
    far: Far<'_>,
) -> Vec<Free> {
    let set = &chosen.set()[..];
    let places: Vec<Option<usize>> = (0..chosen.members.len()).map(Some).collect();
    let mut found = match chosen.members.len() {
        1 => {
            let mut found = free_at(alone, masks, set, &places, (bars, far));
            found.extend(free_at(fitted, masks, set, &[None], (bars, far)));
            found
        }
        _ => free_at(fitted, masks, set, &[&[None], &places[..]].concat(), (bars, far)),
    };
    found.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    found
}

/// The same at one linearisation, for these members to be replaced; nothing for a further cause.
fn free_at(
    at: &Linearisation,
    masks: &[Mask],
    set: &[Member],
    places: &[Option<usize>],
    (bars, far): (&Bars, Far<'_>),
) -> Vec<Free> {
    let columns: Vec<&Sensitivity> =
        at.columns.iter().flatten().filter(|column| column.shared > 0.0).collect();
    let mut candidates: Vec<Candidate> =
        set.iter().map(|(candidate, _)| at.candidates[*candidate].clone()).collect();
    let members: Vec<Member> = set.iter().enumerate().map(|(at, (_, mask))| (at, *mask)).collect();
    let first = candidates.len();
    candidates.extend(columns.iter().map(|column| {
        let change = |sign: f64| column.column.iter().map(|x| sign * SPAN * x).collect();
        let nodes = vec![
            Node { size: -SPAN, change: change(-1.0) },
            Node { size: 0.0, change: Vec::new() },
            Node { size: SPAN, change: change(1.0) },
        ];
        Candidate::tolerance(&column.parameter, nodes, columns.len())
    }));
    let fitter = Fitter::new(&at.whitener, &candidates, masks.to_vec());
    let search = Search::new(&fitter, &at.z, bars, far);
    let answer = search.chosen(&members);
    let long = |of: &[f64]| dot(of, of).sqrt();
    let is_alike = |fit: &Fitted, member: &Fitted| {
        dot(&fit.whitened, &member.whitened).abs()
            > SAME * long(&fit.whitened) * long(&member.whitened)
    };
    let one = |column: usize, instead: Option<usize>| {
        let others = instead.map_or_else(|| members.clone(), |at| without(&members, at));
        let set = with(&others, (first + column, 0));
        let evidence = search.evidence(&set) - answer.evidence;
        let fit = search.chosen(&set).members.pop()?;
        // At another linearisation a member may be within its tolerance.
        let own = |member: usize| answer.all().find(|own| own.candidate == member);
        let other = instead.and_then(own).is_none_or(|member| !is_alike(&fit, member));
        // Within its declared tolerance it is no gap, as for an effect that may be named.
        let beyond = fit.size.abs() >= TOLERANCE_SD;
        (evidence > 0.0 && beyond && other).then(|| Free {
            tolerance: columns[column].tolerance.clone(),
            parameter: columns[column].parameter.clone(),
            deviations: fit.size,
            evidence,
            instead,
        })
    };
    let pairs = (0..columns.len()).flat_map(|column| places.iter().map(move |at| (column, *at)));
    pairs.filter_map(|(column, instead)| one(column, instead)).collect()
}

impl Candidate {
    /// A tolerance, with its size in declared standard deviations.
    fn tolerance(parameter: &str, nodes: Vec<Node>, alternatives: usize) -> Self {
        Self {
            effect: parameter.to_string(),
            channels: Vec::new(),
            size: parameter.to_string(),
            unit: Unit::one(),
            range: (f64::NEG_INFINITY, f64::INFINITY),
            fixed: Vec::new(),
            nodes,
            discrete: false,
            exact: false,
            confinable: false,
            tolerance: None,
            alternatives,
            pending: Vec::new(),
            beside: None,
        }
    }
}

/// What is left for further candidates.
#[derive(Clone, Debug)]
pub struct Further {
    /// Evidence that the best candidate adds to the answer, nameable or not.
    pub evidence: f64,
    /// The tolerance with the most evidence.
    pub tolerance: Option<Free>,
    /// The tolerance with the most evidence in place of a member.
    pub instead: Option<Free>,
}

impl Further {
    /// From the candidates of the catalogue and the tolerances. A candidate within its declared
    /// tolerance is no gap: its tolerance is tried with a free size.
    pub fn new(at: &Linearisation, nearest: &[Fitted], free: &[Free], far: Far<'_>) -> Self {
        let beyond = |fit: &&Fitted| far(&at.candidates[fit.candidate], fit.size) >= TOLERANCE_SD;
        let evidence = nearest.iter().filter(beyond).map(|fit| fit.evidence).fold(0.0, f64::max);
        let tolerance = free.iter().find(|free| free.instead.is_none()).cloned();
        Self {
            evidence: tolerance.as_ref().map_or(evidence, |free| free.evidence.max(evidence)),
            tolerance,
            instead: free.iter().find(|free| free.instead.is_some()).cloned(),
        }
    }

    /// The tolerance that refutes an answer, or that is as possible.
    pub fn suspect(&self) -> Option<&Free> {
        self.instead.as_ref().filter(|free| free.evidence > POSSIBLE)
    }

    /// Whether that tolerance refutes the answer.
    pub fn refutes(&self) -> bool {
        self.instead.as_ref().is_some_and(|free| free.evidence > REFUTES)
    }
}
