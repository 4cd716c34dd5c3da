//! A study that is asked for, of any kind.

use super::{
    Settings, Synchronisation, Vary, all_choices, countable, parameters, sections, synchronisation,
};
use crate::certify::{Compiled, Opened};
use crate::problem::Problems;
use crate::result::study::Study;
use crate::run::Progress;

#[derive(Clone, Debug)]
pub enum Asked {
    Sections,
    Sync(Synchronisation),
    /// Without any, every parameter with a choice of words is varied.
    Parameters(Vec<Vary>),
}

impl Asked {
    /// Whether the study can be made; the number of its steps.
    ///
    /// # Errors
    /// The verdict does not rest on limits alone; `several-records`: a selection takes one value of
    /// each section and signal.
    pub fn ready(&self, opened: &Opened) -> Result<usize, Problems> {
        let (compiled, campaigns) = (&opened.compiled, opened.campaigns());
        countable(compiled)?;
        match self {
            Self::Sections | Self::Sync(_) => {
                campaigns.one_of_each()?;
                Ok(campaigns.sections())
            }
            Self::Parameters(_) => {
                Ok(1 + self.vary(compiled).iter().map(|vary| vary.values.len()).sum::<usize>())
            }
        }
    }

    fn vary(&self, compiled: &Compiled) -> Vec<Vary> {
        match self {
            Self::Parameters(vary) if vary.is_empty() => all_choices(&compiled.plan),
            Self::Parameters(vary) => vary.clone(),
            Self::Sections | Self::Sync(_) => Vec::new(),
        }
    }

    /// # Errors
    /// Of the evaluation.
    pub fn run(
        &self,
        opened: &Opened,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Result<Study, Problems> {
        let Opened { compiled, overrides, .. } = opened;
        let campaigns = opened.campaigns();
        match self {
            Self::Sections => sections(compiled, campaigns, settings, progress),
            Self::Sync(asked) => synchronisation(compiled, campaigns, settings, asked, progress),
            Self::Parameters(_) => {
                parameters(compiled, campaigns, overrides, settings, &self.vary(compiled), progress)
            }
        }
    }
}
