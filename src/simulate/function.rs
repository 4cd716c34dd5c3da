//! A function of the calling program as a simulator: one call makes one record, in memory.

use std::{fmt, sync::Arc};

use super::{Simulator, Task, made::read_made};
use crate::data::{
    Campaign, RecordKind,
    record::{Frame, RecordSource},
};
use crate::effects::Signals;
use crate::problem::Problem;

/// Makes a record; it is called from several threads.
pub type Call<'a> = &'a (dyn Fn(&Task<'_>) -> Result<Frame, Problem> + Sync);

pub struct Function<'a> {
    campaign: &'a Campaign,
    /// Name in reports, and in catalogues that list its parameters.
    name: String,
    call: Call<'a>,
}

impl fmt::Debug for Function<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Function").field("name", &self.name).finish_non_exhaustive()
    }
}

impl<'a> Function<'a> {
    pub fn new(campaign: &'a Campaign, name: impl Into<String>, call: Call<'a>) -> Self {
        Self { campaign, name: name.into(), call }
    }
}

impl Simulator for Function<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn catalogue_name(&self) -> Option<&str> {
        Some(&self.name)
    }

    fn run(&self, task: &Task<'_>) -> Result<Signals, Problem> {
        let made = RecordSource::Memory(Arc::new((self.call)(task)?));
        let source = self.campaign.record_source(RecordKind::Simulation, &task.section.cell);
        let known = source.ok().and_then(|source| source.headings().ok()).unwrap_or_default();
        read_made(&made, &known, &[]).map(|(signals, _)| signals).map_err(|problem| {
            let says = format!("the record of {}: {}", self.name, problem.says);
            task.section.named(Problem { says, ..problem })
        })
    }
}
