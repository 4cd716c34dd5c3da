//! A simulator whose runs become features.

use rayon::prelude::*;

use super::cache::Cache;
use super::observe::Observations;
use crate::problem::Problem;
use crate::simulate::{Simulator, Task};

/// Runs that were made, and those that failed.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    pub made: usize,
    pub failed: Vec<String>,
}

/// A simulator whose runs become features, and are kept.
pub struct Bench<'a> {
    pub seen: &'a Observations,
    pub simulator: &'a dyn Simulator,
    pub cache: Option<Cache>,
}

impl std::fmt::Debug for Bench<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bench").field("simulator", &self.simulator.name()).finish_non_exhaustive()
    }
}

impl Bench<'_> {
    /// Features of the simulator with settings, all sections.
    ///
    /// # Errors
    /// The first section that fails.
    pub fn features(&self, settings: &[(String, f64)]) -> Result<Vec<f64>, Problem> {
        if let Some(known) = self.cache.as_ref().and_then(|cache| cache.get(settings, self.seen.len())) {
            return Ok(known);
        }
        let each = |at: usize| {
            let signals =
                self.simulator.run(&Task { section: &self.seen.sections[at].section, settings, shift: 0.0, inside_only: true })?;
            Ok(self.seen.of(at, &signals, true))
        };
        let parts: Result<Vec<Vec<f64>>, Problem> = (0..self.seen.sections.len()).into_par_iter().map(each).collect();
        let features = parts?.concat();
        if let Some(cache) = &self.cache {
            cache.put(settings, &features);
        }
        Ok(features)
    }
}
