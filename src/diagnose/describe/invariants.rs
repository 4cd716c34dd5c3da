//! Sums and differences of quasi-static values that only some causes can change: the sum of all
//! vertical forces is a weight, independent of wheels and rails.

use crate::diagnose::levels::invariants::WORTH;
use crate::diagnose::linearise::whiten::Covariance;
use crate::diagnose::observe::layout::Kind;
use crate::diagnose::run::Found;
use crate::diagnose::settings::Settings;
use crate::result::{Statement, diagnosis::Invariant};
use crate::simulate::Units;

/// Symmetry of a deviation: the same in all sections, or with a sign that changes with the curve;
/// and whether it is the latter.
const PARITIES: [(&str, bool); 2] =
    [("alike in all sections", false), ("turns with the curve", true)];

impl Covariance {
    /// Variance of the sum of all features, each times its weight.
    pub fn variance(&self, weights: &[f64]) -> f64 {
        let sum = |column: &[f64], weights: &[f64]| {
            column.iter().zip(weights).map(|(x, weight)| x * weight).sum::<f64>().powi(2)
        };
        let own: f64 = self
            .diagonal
            .iter()
            .zip(weights)
            .map(|(variance, weight)| variance * weight * weight)
            .sum();
        let inside: f64 = self
            .inside
            .iter()
            .map(|(at, column)| sum(column, &weights[at * self.size..][..self.size]))
            .sum();
        own + inside + self.shared.iter().map(|column| sum(column, weights)).sum::<f64>()
    }
}

/// All invariants of the catalogue whose channels were recorded, simulated - measured, before and
/// after the causes are added.
pub fn invariants(settings: &Settings, found: &Found, units: &Units) -> Vec<Invariant> {
    let seen = &found.seen;
    let rest = found.left();
    let beside = found.wider();
    let sections = seen.first_runs();
    let side = |at: usize| settings.side(&seen.sections[at].section);
    let mut all = Vec::new();
    for (name, members) in &settings.invariants {
        let feature = |channel: &str| {
            let channel = seen.layout.channels.iter().position(|known| known.name == channel)?;
            seen.find(channel, Kind::Level)
        };
        let Some(features) = members
            .iter()
            .map(|(channel, weight)| Some((feature(channel)?, *weight)))
            .collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        for (parity, turns) in PARITIES {
            let times = |at: usize| if turns { side(at) } else { 1.0 };
            let turned = sections.iter().filter(|at| times(**at) != 0.0).count();
            if turned == 0 {
                continue;
            }
            let mut weights = vec![0.0; seen.len()];
            for at in &sections {
                for (feature, weight) in &features {
                    weights[seen.place(*at, *feature)] = weight * times(*at) / turned as f64;
                }
            }
            let mean = |values: &[f64]| {
                values.iter().zip(&weights).map(|(value, weight)| value * weight).sum::<f64>()
            };
            let unit = units
                .iter()
                .find(|(known, _)| members.first().is_some_and(|(channel, _)| channel == known));
            all.push(Invariant {
                name: name.clone(),
                parity: parity.into(),
                unit: unit.map_or_else(|| "-".into(), |(_, unit)| unit.text.clone()),
                before: -mean(&found.alone.difference),
                after: -mean(&rest),
                allowed: found.alone.covariance.variance(&weights).sqrt(),
                allowed_after: beside.variance(&weights).sqrt(),
            });
        }
    }
    all
}

/// Deviation of an invariant with the causes added, in standard deviations.
fn off(one: &Invariant) -> f64 {
    if one.allowed_after > 0.0 { one.after.abs() / one.allowed_after } else { 0.0 }
}

/// A sentence on the invariant with the largest deviation after the causes; nothing if none is
/// large enough.
pub fn worst(all: &[Invariant]) -> Option<Statement> {
    let one = all.iter().max_by(|a, b| off(a).total_cmp(&off(b))).filter(|one| off(one) > WORTH)?;
    Some(Statement::LargestSum {
        name: one.name.clone(),
        after: one.after,
        unit: one.unit.clone(),
        times: off(one),
        parity: one.parity.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::linearise::response::ResponseError;

    /// w' C w with the covariance written out: C = [[1 + 4, 2 + 3], [2 + 3, 2 + 1 + 9]].
    #[test]
    fn variance_of_a_sum() {
        let covariance = Covariance {
            diagonal: vec![1.0, 2.0],
            inside: vec![(0, vec![2.0, 1.0])],
            shared: vec![vec![0.0, 3.0]],
            size: 2,
            response: ResponseError::default(),
        };
        assert!((covariance.variance(&[1.0, -1.0]) - (5.0 - 2.0 * 2.0 + 12.0)).abs() < 1e-12);
    }
}
