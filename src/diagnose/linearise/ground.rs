//! The simulation without effects and the allowed difference: the common input of candidates and
//! weighings.

use crate::diagnose::inputs::{Inputs, value_of};
use crate::diagnose::linearise::{
    covariance::{Sensitivity, discrepancies},
    declared::Declared,
    recorded::{Recorded, as_recorded},
    references::learnt,
    sensitivity::sensitivities,
    standing::Standing,
    whiten::less,
};
use crate::diagnose::observe::{
    bench::{Bench, Runs},
    observations::Observations,
};
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
    pub fn find(
        inputs: &Inputs<'_>,
        seen: &Observations,
        admitted: &Declared,
        runs: &mut Runs,
        problems: &mut Problems,
    ) -> Option<Self> {
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
            Some(bench) => {
                sensitivities(bench, settings, &base, &value, &declared, &|_| true, runs)
            }
            None => Vec::new(),
        };
        let recorded = as_recorded(seen, bench.as_ref(), settings, &value, &declared, runs);
        Some(Self { base, simulated, recorded, columns, standing, whole })
    }
}

/// The simulator on the sections; nothing without a simulator.
pub fn bench<'a>(inputs: &Inputs<'a>, seen: &'a Observations) -> Option<Bench<'a>> {
    inputs.simulator.map(|simulator| Bench {
        seen,
        simulator,
        cache: inputs.cache.clone(),
        set: Vec::new(),
    })
}
