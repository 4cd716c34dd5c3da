//! Causes outside the catalogue: parameters of the vehicle with a tolerance, each alone and far
//! beyond the declared one. If one of them explains a gap much better than the answer, the cause is
//! outside the catalogue. If it is only slightly better, the data do not discriminate.

use rayon::prelude::*;

use crate::diagnose::features::bench::Runs;
use crate::diagnose::inference::chosen::Chosen;
use crate::diagnose::inference::fit::{Fitted, Fitter};
use crate::diagnose::inference::joint::fit;
use crate::diagnose::inference::sets::refit;
use crate::diagnose::levels::suspects::{
    ALIKE, BETTER, BETTER_SHARE, COARSE, FINE, MOST, NEAR, ROUNDS, SAME,
};
use crate::diagnose::response::candidate::{Candidate, Node};
use crate::diagnose::response::mask::Mask;
use crate::diagnose::response::workshop::Workshop;
use crate::diagnose::selection::place::Place as Weighing;
use crate::diagnose::settings::Settings;
use crate::diagnose::uncertainty::whiten::{dot, less};
use crate::units::Unit;

/// A parameter that explains more than the answer.
#[derive(Clone, Debug)]
pub struct Suspect {
    pub key: String,
    pub factor: f64,
    pub evidence: f64,
    /// Evidence of the member or members it is compared with.
    pub answer: f64,
    /// Whether these are several members together.
    pub of_all: bool,
}

impl Suspect {
    /// Whether it rejects the answer, instead of being equally likely.
    #[must_use]
    pub fn beats(&self) -> bool {
        // One cause in place of several needs no additional share of the evidence.
        self.evidence
            > self.answer
                + if self.of_all { BETTER } else { BETTER.max(BETTER_SHARE * self.answer) }
    }
}

/// The member or members that a parameter is compared with.
struct Place {
    /// The whitened difference without the other members, the change of the first one, and the
    /// evidence.
    rest: Vec<f64>,
    whitened: Vec<f64>,
    answer: f64,
    of_all: bool,
}

impl Place {
    /// The strongest member, and all together where there are several.
    fn of(chosen: &Chosen, z: &[f64]) -> Vec<Self> {
        let Some(first) = chosen.members.first() else { return Vec::new() };
        let strongest = Self {
            rest: chosen.left_by_others(z, 0),
            whitened: first.whitened.clone(),
            answer: first.evidence,
            of_all: false,
        };
        let all = Self {
            rest: z.to_vec(),
            whitened: first.whitened.clone(),
            answer: chosen.evidence,
            of_all: true,
        };
        if chosen.members.len() > 1 { vec![strongest, all] } else { vec![strongest] }
    }

    /// Whether a parameter is the same cause as a member. One in place of several never is.
    fn is(&self, fit: &Fitted) -> bool {
        let length = |of: &[f64]| dot(of, of).sqrt();
        !self.of_all
            && dot(&fit.whitened, &self.whitened).abs()
                > SAME * length(&fit.whitened) * length(&self.whitened)
    }
}

/// Tests parameters in place of the strongest member, unless that is an operation on the signals of
/// one channel alone, and in place of all members. The weighing is that without effects.
#[must_use]
pub fn suspect(
    workshop: &Workshop<'_>,
    settings: &Settings,
    Weighing { whitener, z, .. }: &Weighing,
    (candidates, masks, chosen): (&[Candidate], &[Mask], &Chosen),
    runs: &mut Runs,
) -> Option<Suspect> {
    let bench = workshop.bench?;
    let fitter = Fitter::of(whitener, candidates, masks.to_vec(), &chosen.members);
    let mut now = chosen.clone();
    refit(&fitter, z, &mut now);
    let first = &candidates[now.members.first()?.candidate];
    if first.exact && first.channels.len() < 2 {
        return None;
    }
    let of = settings.tolerances.iter().filter(|tolerance| tolerance.suspects);
    let there = |key: &&String| (workshop.neutral)(key).is_some_and(|value| value != 0.0);
    let keys: Vec<&String> = of.flat_map(|tolerance| &tolerance.scales).filter(there).collect();
    let everywhere = masks.first()?.clone();
    let fitted = |path: &Candidate, place: &Place| {
        let fitter = Fitter::new(whitener, std::slice::from_ref(path), vec![everywhere.clone()]);
        fit(&fitter, &place.rest, &[(0, 0)])?.members.pop()
    };
    let simulate = |path: &mut Candidate, factors: &[f64], runs: &mut Runs| {
        let (key, value) = (path.size.clone(), (workshop.neutral)(&path.size).unwrap_or(0.0));
        runs.made += factors.len() * workshop.seen.sections.len();
        // A factor with which the vehicle cannot be simulated is skipped.
        let made = |factor: &f64| {
            let made = bench.features(&[(key.clone(), factor * value)]).ok()?;
            Some(Node { size: *factor, change: less(&made, &workshop.ground.base) })
        };
        path.nodes.par_extend(factors.par_iter().filter_map(made));
        path.nodes.sort_by(|a, b| a.size.total_cmp(&b.size));
    };
    (workshop.trying)("parameters outside the catalogue");
    let mut coarse: Vec<Candidate> =
        keys.iter().map(|key| Candidate::of_path(key, keys.len())).collect();
    // All at once, so that many workers have a simulation.
    let made = |path: &mut Candidate| {
        let mut runs = Runs::default();
        simulate(path, &COARSE, &mut runs);
        runs
    };
    coarse
        .par_iter_mut()
        .map(made)
        .collect::<Vec<Runs>>()
        .into_iter()
        .for_each(|made| runs.add(made));
    let mut best: Option<Suspect> = None;
    for place in Place::of(&now, z) {
        let mut paths: Vec<(Candidate, Fitted)> = coarse
            .iter()
            .filter_map(|path| fitted(path, &place).map(|fit| (path.clone(), fit)))
            .collect();
        paths.retain(|(_, fit)| fit.evidence >= NEAR * place.answer);
        paths.sort_by(|a, b| b.1.evidence.total_cmp(&a.1.evidence));
        paths.truncate(MOST);
        for (path, now) in &mut paths {
            simulate(path, &FINE, runs);
            for _ in 0..=ROUNDS {
                *now = fitted(path, &place)?;
                if path.nodes.iter().any(|node| (node.size - now.size).abs() <= ALIKE * now.size) {
                    break;
                }
                simulate(path, &[now.size], runs);
            }
        }
        for (path, fit) in paths.into_iter().filter(|(_, fit)| !place.is(fit)) {
            let suspect = Suspect {
                key: path.size,
                factor: fit.size,
                evidence: fit.evidence,
                answer: place.answer,
                of_all: place.of_all,
            };
            // Of comparable causes the simpler one is preferred: an operation on the signals, or
            // one cause instead of several.
            let near = match place.of_all {
                true => suspect.evidence > suspect.answer,
                false => !first.exact && suspect.evidence > suspect.answer + BETTER,
            };
            let share = |of: &Suspect| of.evidence / of.answer;
            if (suspect.beats() || near)
                && best.as_ref().is_none_or(|best| share(&suspect) > share(best))
            {
                best = Some(suspect);
            }
        }
    }
    best
}

impl Candidate {
    /// A simulator parameter that no effect of the catalogue changes, as a candidate.
    fn of_path(key: &str, alternatives: usize) -> Self {
        Self {
            effect: key.to_string(),
            channels: Vec::new(),
            size: key.to_string(),
            unit: Unit::one(),
            range: (0.0, f64::INFINITY),
            fixed: Vec::new(),
            nodes: vec![Node { size: 1.0, change: Vec::new() }],
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
