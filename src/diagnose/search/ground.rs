//! The simulation without effects and the allowed difference: the common input of candidates and weighings.

use std::sync::Mutex;

use super::candidates::Workshop;
use super::place::{Place, Places, Tolerances};
use crate::diagnose::allowed::covariance::{Sensitivity, covariance, discrepancies, expect};
use crate::diagnose::allowed::declared::Declared;
use crate::diagnose::allowed::recorded::{Recorded, as_recorded};
use crate::diagnose::allowed::sensitivity::sensitivities;
use crate::diagnose::allowed::standing::{Standing, learnt};
use crate::diagnose::allowed::whiten::{Covariance, less};
use crate::diagnose::inputs::{Inputs, value_of};
use crate::diagnose::observe::bench::{Bench, Runs};
use crate::diagnose::observe::observations::Observations;
use crate::problem::Problems;

/// The simulation without effects, and its allowed difference.
#[derive(Debug, Default)]
pub struct Ground {
    /// Features of the simulator without effects.
    pub base: Vec<f64>,
    /// Features of the campaign's simulation.
    pub simulated: Vec<f64>,
    /// The campaign's simulation as it would have been recorded.
    pub recorded: Recorded,
    /// Sensitivities to the tolerances.
    pub columns: Vec<Option<Sensitivity>>,
    /// Estimate of the standing discrepancies.
    pub standing: Standing,
    /// Measured - simulated, without the expected deviation of the tolerances.
    pub whole: Vec<f64>,
}

impl Ground {
    /// Simulates without effects, and with each tolerance.
    ///
    /// Problems: references that cannot be read; a section that cannot be simulated.
    pub fn find(inputs: &Inputs<'_>, seen: &Observations, admitted: &Declared, runs: &mut Runs, problems: &mut Problems) -> Option<Self> {
        let settings = inputs.settings;
        let declared = |name: &str| admitted.get(name);
        let value = |key: &str| value_of(inputs.campaign, key);
        let simulated = seen.all(true, |observed| &observed.simulated);
        let measured = seen.all(false, |observed| &observed.measured);
        let mut whole = less(&measured, &simulated);
        let standing = learnt(inputs, runs, problems)?;
        standing.take_off(&discrepancies(seen, settings).0, &mut whole);
        let bench = bench(inputs, seen);
        (inputs.trying)("simulation without effects");
        let base = match bench.as_ref().map(|bench| bench.features(&[])).transpose() {
            Ok(base) => base.unwrap_or_else(|| simulated.clone()),
            Err(problem) => {
                problems.push(problem);
                return None;
            }
        };
        (inputs.trying)("sensitivities to the tolerances");
        let columns = match &bench {
            Some(bench) => sensitivities(bench, settings, &base, &value, &declared, &|_| true, runs),
            None => Vec::new(),
        };
        let recorded = as_recorded(seen, bench.as_ref(), settings, &value, &declared, runs);
        Some(Self { base, simulated, recorded, columns, standing, whole })
    }

    /// The weighing without effects, and the covariance of noise and tolerances alone.
    #[must_use]
    pub fn alone(&self, inputs: &Inputs<'_>, seen: &Observations, admitted: &Declared) -> (Place, Covariance) {
        let columns: Vec<Sensitivity> = self.columns.iter().flatten().cloned().collect();
        let mut difference = self.whole.clone();
        expect(&columns, &mut difference);
        let declared = |name: &str| admitted.get(name);
        let with = |standing| covariance(seen, inputs.settings, &self.simulated, &columns, &declared, standing);
        (Place::new(with(Some(&self.standing)), difference), with(None))
    }

    /// Runs `R` with candidates and weighings on this basis.
    pub fn work<R>(
        &self,
        inputs: &Inputs<'_>,
        seen: &Observations,
        admitted: &Declared,
        places: Places,
        with: impl FnOnce(&Tolerances<'_>) -> R,
    ) -> R {
        let declared = |name: &str| admitted.get(name);
        let value = |key: &str| value_of(inputs.campaign, key);
        let bench = bench(inputs, seen);
        let (catalogue, trying) = (inputs.catalogue, inputs.trying);
        let workshop = Workshop { seen, catalogue, bench: bench.as_ref(), ground: self, neutral: &value, trying };
        let (settings, places) = (inputs.settings, Mutex::new(places));
        with(&Tolerances { workshop: &workshop, settings, value: &value, declared: &declared, places })
    }
}

fn bench<'a>(inputs: &Inputs<'a>, seen: &'a Observations) -> Option<Bench<'a>> {
    inputs.simulator.map(|simulator| Bench { seen, simulator, cache: inputs.cache.clone(), set: Vec::new() })
}
