//! What no effect of the catalogue moves: parameters of the vehicle that the test engineer admits not to know exactly, each alone and
//! by far more than is declared. Where one of them explains a gap better than the answer does, the cause is outside the catalogue.

use super::bench::Runs;
use super::candidates::{Candidate, Node, Workshop};
use super::fit::{Fitted, Fitter, Mask, less};
use super::search::{Chosen, refit};
use super::settings::Settings;
use super::whiten::Whitener;
use crate::units::Unit;

/// Factors that every suspect is simulated with, 1 being none; and those that are left for the ones that come near.
const COARSE: [f64; 2] = [0.45, 1.8];
const FINE: [f64; 5] = [0.25, 0.35, 0.7, 1.3, 2.5];
/// How many are simulated finely at most, and from which share of the evidence of the answer on.
const MOST: usize = 2;
const NEAR: f64 = 0.15;
/// How often the factor that was found is simulated itself, and what is no other factor.
const ROUNDS: usize = 2;
const ALIKE: f64 = 0.02;
/// So much more evidence than the answer's, and so large a share of it more, is better.
const BETTER: f64 = 8.0;
const BETTER_SHARE: f64 = 0.5;

/// A parameter that explains more than the answer.
#[derive(Clone, Debug)]
pub struct Suspect {
    pub key: String,
    pub factor: f64,
    pub evidence: f64,
    /// Of the member in whose place it would be.
    pub answer: f64,
}

/// Looks for one in the place of the first member, if that is an effect on the simulator. `z` is the difference whitened by the
/// covariance without effects.
#[must_use]
pub fn suspect(
    workshop: &Workshop<'_>,
    settings: &Settings,
    (whitener, z): (&Whitener, &[f64]),
    (candidates, masks, chosen): (&[Candidate], &[Mask], &Chosen),
    runs: &mut Runs,
) -> Option<Suspect> {
    let bench = workshop.bench?;
    let fitter = Fitter::of(whitener, candidates, masks.to_vec(), &chosen.members);
    let mut first = chosen.clone();
    refit(&fitter, z, &mut first, 6);
    let member = first.members.first().filter(|member| !candidates[member.candidate].exact)?;
    let rest = first.left_by_others(z, 0);
    let of = settings.tolerances.iter().filter(|tolerance| tolerance.suspects);
    let there = |key: &&String| (workshop.neutral)(key).is_some_and(|value| value != 0.0);
    let keys: Vec<&String> = of.flat_map(|tolerance| &tolerance.scales).filter(there).collect();
    let everywhere = masks.first()?.clone();
    let fitted = |path: &Candidate| Fitter::new(whitener, std::slice::from_ref(path), vec![everywhere.clone()]).fit(&rest, 0, 0);
    let simulate = |path: &mut Candidate, factors: &[f64], runs: &mut Runs| {
        let (key, value) = (path.size.clone(), (workshop.neutral)(&path.size).unwrap_or(0.0));
        for factor in factors {
            runs.made += workshop.seen.sections.len();
            // A vehicle that cannot run so is no suspect with that factor.
            if let Ok(made) = bench.features(&[(key.clone(), factor * value)]) {
                path.nodes.push(Node { size: *factor, change: less(&made, &workshop.base) });
            }
        }
        path.nodes.sort_by(|a, b| a.size.total_cmp(&b.size));
    };
    (workshop.trying)("what no effect of the catalogue moves");
    let mut paths: Vec<(Candidate, Fitted)> = Vec::new();
    for key in &keys {
        let mut path = Candidate::of_path(key, keys.len());
        simulate(&mut path, &COARSE, runs);
        paths.extend(fitted(&path).map(|fit| (path, fit)));
    }
    paths.retain(|(_, fit)| fit.evidence >= NEAR * member.evidence);
    paths.sort_by(|a, b| b.1.evidence.total_cmp(&a.1.evidence));
    paths.truncate(MOST);
    for (path, fit) in &mut paths {
        simulate(path, &FINE, runs);
        for _ in 0..=ROUNDS {
            *fit = fitted(path)?;
            if path.nodes.iter().any(|node| (node.size - fit.size).abs() <= ALIKE * fit.size) {
                break;
            }
            simulate(path, &[fit.size], runs);
        }
    }
    let (path, fit) = paths.into_iter().max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence))?;
    let (evidence, answer) = (fit.evidence, member.evidence);
    (evidence > answer + BETTER.max(BETTER_SHARE * answer)).then_some(Suspect { key: path.size, factor: fit.size, evidence, answer })
}

impl Candidate {
    /// A parameter of the simulator that no effect of the catalogue moves, by its path alone.
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
        }
    }
}
