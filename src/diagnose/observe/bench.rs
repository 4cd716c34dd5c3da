//! A simulator whose results are converted to features.

use rayon::prelude::*;

use crate::diagnose::observe::{cache::Cache, observations::Observations};
use crate::effects::Operator;
use crate::problem::Problem;
use crate::simulate::{Plan, Simulator, Task};
use crate::yaml::Words;

/// Computed and failed simulations.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    pub made: usize,
    pub failed: Vec<String>,
}

impl Runs {
    /// Adds those that were made at the same time.
    pub fn add(&mut self, other: Self) {
        self.made += other.made;
        self.failed.extend(other.failed);
    }
}

/// Settings common to all simulations of a bench, in some sections or in all.
#[derive(Clone, Debug)]
pub struct Set {
    /// Parameters of the simulator and operations on its signals.
    pub plan: Plan,
    /// By section; all sections where absent.
    pub sections: Option<Vec<bool>>,
}

/// A simulator whose results are converted to features and kept in a cache.
pub struct Bench<'a> {
    pub seen: &'a Observations,
    pub simulator: &'a dyn Simulator,
    pub cache: Option<Cache>,
    /// Common settings. A later one overrides an earlier one.
    pub set: Vec<Set>,
}

impl std::fmt::Debug for Bench<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bench").field("simulator", &self.simulator.name()).finish_non_exhaustive()
    }
}

impl Bench<'_> {
    /// The settings that apply in a section.
    fn there(&self, section: usize) -> impl DoubleEndedIterator<Item = &Plan> {
        self.set
            .iter()
            .filter(move |set| set.sections.as_ref().is_none_or(|sections| sections[section]))
            .map(|set| &set.plan)
    }

    /// The value that is set for a parameter in a section, if any.
    pub fn value(&self, section: usize, key: &str) -> Option<f64> {
        self.there(section)
            .rev()
            .flat_map(|plan| &plan.settings)
            .find(|(known, _)| known == key)
            .map(|(_, value)| *value)
    }

    /// The operations on the signals of a section, in the order of the measuring chain.
    fn chain(&self, section: usize) -> Plan {
        let mut operators: Vec<_> =
            self.there(section).flat_map(|plan| plan.operators.clone()).collect();
        operators.sort_by_key(|(operator, ..)| *operator);
        Plan { operators, ..Plan::default() }
    }

    /// Features of all sections with `settings` in addition to the common settings.
    ///
    /// # Errors
    /// The error of the first section that fails.
    pub fn features(&self, settings: &[(String, f64)]) -> Result<Vec<f64>, Problem> {
        self.moved(&|_| settings.to_vec())
    }

    /// The same with settings by section.
    ///
    /// # Errors
    /// The error of the first section that fails.
    pub fn moved(
        &self,
        settings: &(dyn Fn(usize) -> Vec<(String, f64)> + Sync),
    ) -> Result<Vec<f64>, Problem> {
        let keys = self.set.iter().flat_map(|set| &set.plan.settings).map(|(key, _)| key);
        let each: Vec<Vec<(String, f64)>> = (0..self.seen.sections.len())
            .map(|at| {
                let mut all = settings(at);
                for key in keys.clone() {
                    if let (Some(value), false) =
                        (self.value(at, key), all.iter().any(|(known, _)| known == key))
                    {
                        all.push((key.clone(), value));
                    }
                }
                all
            })
            .collect();
        let chains: Vec<Plan> = (0..each.len()).map(|at| self.chain(at)).collect();
        let operated = |chain: &Plan| {
            let of = |(operator, value, channels): &(Operator, f64, Vec<String>)| {
                (format!("{} of {}", operator.word(), channels.join(", ")), *value)
            };
            chain.operators.iter().map(of).collect::<Vec<_>>()
        };
        let made_by: Vec<Vec<(String, f64)>> = each
            .iter()
            .zip(&chains)
            .map(|(settings, chain)| [settings.clone(), operated(chain)].concat())
            .collect();
        if let Some(known) = self
            .cache
            .as_ref()
            .and_then(|cache| cache.get(self.seen.identity(), &made_by, self.seen.len()))
        {
            return Ok(known);
        }
        let run = |at: usize| {
            let task = Task {
                section: &self.seen.sections[at].section,
                settings: &each[at],
                shift: 0.0,
                inside_only: chains[at].shift() == 0.0,
            };
            let mut signals = self.simulator.run(&task)?;
            chains[at].operate(&mut signals, task.section)?;
            Ok(self.seen.of(at, &signals, true))
        };
        let parts: Result<Vec<Vec<f64>>, Problem> =
            (0..self.seen.sections.len()).into_par_iter().map(run).collect();
        let features = parts?.concat();
        if let Some(cache) = &self.cache {
            cache.put(self.seen.identity(), &made_by, &features);
        }
        Ok(features)
    }
}
