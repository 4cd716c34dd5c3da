//! Standing discrepancy of the simulation, estimated from campaigns of known state.
//!
//! Every discrepancy common to all sections is a column times a random coefficient of unit variance. A part of that coefficient is the
//! same in all campaigns with a vehicle (the standing part); the rest varies from campaign to campaign. Campaigns of known state estimate
//! the standing part. Its mean is subtracted; its remaining covariance and the varying part stay in the covariance (Gauss-Markov; as in
//! Kennedy and O'Hagan 2001, with a discrepancy of declared form).

use std::collections::HashMap;

use super::covariance::{Keyed, covariance, discrepancies, expect};
use super::declared::Declared;
use super::sensitivity::sensitivities;
use super::whiten::{Covariance, less};
use crate::data::Campaign;
use crate::diagnose::inputs::{Inputs, Reference, value_of};
use crate::diagnose::observe::bench::{Bench, Runs};
use crate::diagnose::observe::observations::Observations;
use crate::diagnose::settings::{Over, Settings};
use crate::problem::{Problem, Problems};
use crate::yaml::{Key, Node};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Standard deviation of the part of a discrepancy that varies between campaigns, as a share of the whole: engineering judgement.
const OWN: f64 = 0.5;

/// Posterior of the common discrepancies; empty without a reference campaign.
#[derive(Clone, Debug, Default)]
pub struct Standing {
    /// Index of each column in the mean and in the root.
    places: HashMap<String, usize>,
    mean: Vec<f64>,
    /// A square root of the covariance of the coefficients.
    root: Option<DMatrix<f64>>,
}

/// Data of one reference campaign: its covariance without the standing part, the columns, and measured - simulated.
#[derive(Debug)]
pub struct Shown {
    pub covariance: Covariance,
    pub columns: Vec<Keyed>,
    pub difference: Vec<f64>,
}

impl Standing {
    /// Estimates the standing part from reference campaigns.
    #[must_use]
    pub fn learn(all: &[Shown]) -> Self {
        let mut places = HashMap::new();
        for column in all.iter().flat_map(|shown| &shown.columns) {
            let next = places.len();
            places.entry(column.key.clone()).or_insert(next);
        }
        let count = places.len();
        if count == 0 {
            return Self::default();
        }
        let stands = (1.0 - OWN * OWN).sqrt();
        let (mut precision, mut pull) = (DMatrix::identity(count, count), DVector::zeros(count));
        for shown in all {
            let whitener = shown.covariance.whitener();
            let mut seen = DMatrix::zeros(shown.difference.len(), count);
            for column in &shown.columns {
                seen.set_column(places[&column.key], &(DVector::from_vec(whitener.apply(&column.values)) * stands));
            }
            precision += seen.tr_mul(&seen);
            pull += seen.tr_mul(&DVector::from_vec(whitener.apply(&shown.difference)));
        }
        let factored = Cholesky::new_with_substitute(precision, 1e-9).expect("a substitute makes every pivot positive");
        let mean = factored.solve(&pull) * stands;
        let left = factored.inverse() * (stands * stands) + DMatrix::identity(count, count) * (OWN * OWN);
        let root = Cholesky::new_with_substitute(left, 1e-12).expect("a substitute makes every pivot positive").l();
        Self { places, mean: mean.data.into(), root: Some(root) }
    }

    /// Subtracts the mean of the standing part from a difference.
    pub fn take_off(&self, columns: &[Keyed], difference: &mut [f64]) {
        for (column, at) in columns.iter().filter_map(|column| Some((column, self.places.get(&column.key)?))) {
            difference.iter_mut().zip(&column.values).for_each(|(difference, value)| *difference -= self.mean[*at] * value);
        }
    }

    /// The columns, recombined so that their coefficients are again independent and of unit variance.
    #[must_use]
    pub fn weighed(&self, columns: Vec<Keyed>) -> Vec<Vec<f64>> {
        let Some(root) = &self.root else { return columns.into_iter().map(|column| column.values).collect() };
        let (known, unknown): (Vec<Keyed>, Vec<Keyed>) = columns.into_iter().partition(|column| self.places.contains_key(&column.key));
        let mut all: Vec<Vec<f64>> = unknown.into_iter().map(|column| column.values).collect();
        let Some(first) = known.first() else { return all };
        for number in 0..root.ncols() {
            let mut sum = vec![0.0; first.values.len()];
            for column in &known {
                let weight = root[(self.places[&column.key], number)];
                sum.iter_mut().zip(&column.values).for_each(|(sum, value)| *sum += weight * value);
            }
            all.push(sum);
        }
        all
    }
}

/// The standing part, from all references of a diagnosis.
///
/// Problems: records that cannot be read; no section or channel to compare.
pub fn learnt(inputs: &Inputs<'_>, runs: &mut Runs, problems: &mut Problems) -> Option<Standing> {
    let shown: Option<Vec<Shown>> = inputs.references.iter().map(|reference| shown(inputs, reference, runs, problems)).collect();
    Some(Standing::learn(&shown?))
}

/// Numbers of a vehicle file that differ from another file, with the other value, by their paths.
fn differing<'a>(own: &'a Node, other: Option<&'a Node>, path: &str) -> Vec<(String, &'a Node, Option<&'a Node>)> {
    let of = |(key, node): &'a (Key, Node)| {
        let (path, there) = (format!("{path}{}", key.text), other.and_then(|other| other.get(&key.text)));
        let below = differing(node, there, &format!("{path}."));
        let number = |node| crate::simulate::number_of(node, &path);
        let differs = number(node).is_some() && number(node) != there.and_then(number);
        differs.then_some((path, node, there)).into_iter().chain(below)
    };
    own.entries().iter().flat_map(of).collect()
}

/// Warns where the vehicle file of a reference differs from the campaign's: the standing part is a property of one vehicle.
fn check_vehicle(inputs: &Inputs<'_>, reference: &Campaign, problems: &mut Problems) {
    let found = differing(&inputs.campaign.vehicle, Some(&reference.vehicle), "");
    let Some((path, own, there)) = found.first() else { return };
    let more = if found.len() > 1 { format!(" ({} more numbers differ)", found.len() - 1) } else { String::new() };
    let has = there.map_or("not there".to_string(), |there| there.raw.clone());
    let says = format!("the reference `{}` has another vehicle: `{path}` is {has} there{more}", reference.name);
    problems.push(
        Problem::warning("reference", says).at(&own.span).help("the standing discrepancy is estimated as if the vehicle were the same"),
    );
}

fn shown(inputs: &Inputs<'_>, reference: &Reference<'_>, runs: &mut Runs, problems: &mut Problems) -> Option<Shown> {
    (inputs.trying)(&format!("standing discrepancy from `{}`", reference.campaign.name));
    let (campaign, settings) = (reference.campaign, inputs.settings);
    check_vehicle(inputs, campaign, problems);
    let admitted = Declared::read(campaign, settings, problems);
    let declared = |name: &str| admitted.get(name);
    let unit = |channel: &str| reference.simulator?.unit(channel);
    let sections = crate::simulate::sections(campaign, problems)?;
    let seen = Observations::read(campaign, sections, inputs.catalogue, settings, &declared, &unit, problems)?;
    let simulated = seen.all(true, |observed| &observed.simulated);
    let mut difference = less(&seen.all(false, |observed| &observed.measured), &simulated);
    let bench = reference.simulator.map(|simulator| Bench { seen: &seen, simulator, cache: reference.cache.clone(), set: Vec::new() });
    let columns = match &bench {
        Some(bench) => {
            let base = bench.features(&[]).map_err(|problem| problems.push(problem)).ok()?;
            let value = |key: &str| value_of(campaign, key);
            sensitivities(bench, settings, &base, &value, &declared, &|_| true, runs).into_iter().flatten().collect()
        }
        None => Vec::new(),
    };
    expect(&columns, &mut difference);
    let own = own(settings);
    let covariance = covariance(&seen, &own, &simulated, &columns, &declared, Some(&Standing::default()));
    Some(Shown { covariance, columns: discrepancies(&seen, settings).0, difference })
}

/// The settings with only the part of each discrepancy that varies between campaigns; scatter between sections is kept in full.
fn own(settings: &Settings) -> Settings {
    let mut own = settings.clone();
    let shared = own.discrepancies.iter_mut().filter(|discrepancy| discrepancy.over != Over::Sections);
    shared.for_each(|discrepancy| discrepancy.sd.iter_mut().for_each(|sd| *sd *= OWN));
    own
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn numbers_that_another_vehicle_has_not() {
        let read = |text: &str| crate::yaml::load(&Source::new("vehicle.yaml", text), &mut Problems::default()).expect("a map");
        let own = read("name: A\nfriction: 0.35\nbody:\n  mass: 32000.0\n  height: 1.8\n");
        let other = read("name: B\nfriction: 0.350\nbody:\n  mass: 28000\n");
        let found: Vec<(String, Option<&str>)> =
            differing(&own, Some(&other), "").into_iter().map(|(path, _, there)| (path, there.map(|there| there.raw.as_str()))).collect();
        assert_eq!(found, [("body.mass".to_string(), Some("28000")), ("body.height".to_string(), None)]);
        assert!(differing(&own, Some(&own), "").is_empty());
    }
}
