//! Studies: dependence of the verdict on sections, synchronisation and parameters.
//!
//! Joins the stages as `certify` does: `run` evaluates records, `study` evaluates selections.

mod margin;
mod parameters;
mod rule;
mod scale;
mod synchronisation;

use crate::certify::{Compiled, Opened, campaign_info, protocol_info};
use crate::check::plan::{Decision, Plan};
use crate::data::Campaigns;
use crate::problem::{Problem, Problems, problem};
use crate::result::{
    CampaignInfo, Reason,
    study::{Reduction, SelectionStudy, Study, StudyResult},
};
use crate::run::{Evaluated, Progress, Shifts, evaluate};
use crate::study::{self, case::Case, reduced, selections};

pub use margin::{DRAWS, Margins, margin};
pub use parameters::{Vary, all_choices, parameters};
pub use synchronisation::{Synchronisation, synchronisation};

/// Common settings of the studies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    pub selections: study::Settings,
    /// Sections per zone in a selection, if different from the protocol's number.
    pub take: Option<usize>,
    /// Sections per zone that are kept before selections are formed.
    pub reduce: Option<usize>,
}

/// A study that is asked for, of any kind.
#[derive(Clone, Debug)]
pub enum Asked {
    Sections,
    Sync(Synchronisation),
    /// Without any, every parameter with a choice of words is varied.
    Parameters(Vec<Vary>),
    Margin(Margins),
}

impl Asked {
    /// Whether the study can be made; the number of its steps.
    ///
    /// # Errors
    /// The verdict does not rest on limits alone; `several-records`: a selection takes one value of
    /// each section and signal.
    pub fn ready(&self, opened: &Opened) -> Result<usize, Problems> {
        let (compiled, campaigns) = (&opened.compiled, opened.campaigns());
        match self {
            Self::Margin(_) => judged_once(compiled)?,
            _ => countable(compiled)?,
        }
        match self {
            Self::Margin(_) => Ok(campaigns.sections() + compiled.plan.parameters.len()),
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
            Self::Sections | Self::Sync(_) | Self::Margin(_) => Vec::new(),
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
            Self::Margin(asked) => {
                margin(compiled, campaigns, overrides, settings, *asked, progress)
            }
            Self::Parameters(_) => {
                parameters(compiled, campaigns, overrides, settings, &self.vary(compiled), progress)
            }
        }
    }
}

/// Study of all selections of sections.
///
/// # Errors
/// As [`crate::run::run`]; `too-few-sections`: a zone has fewer usable sections than a selection
/// takes.
pub fn sections<'a>(
    compiled: &Compiled,
    campaigns: impl Into<Campaigns<'a>>,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let campaigns = campaigns.into();
    let evaluated = unshifted(compiled, campaigns, progress)?;
    sections_of(compiled, &evaluated, campaign_of(compiled, campaigns, &evaluated), settings)
}

/// Every record as it is, without an offset.
fn unshifted(
    compiled: &Compiled,
    campaigns: Campaigns<'_>,
    progress: Progress<'_>,
) -> Result<Evaluated, Problems> {
    let Compiled { plan, graph, .. } = compiled;
    Ok(evaluate(plan, graph, campaigns, &Shifts::NONE, progress)?.swap_remove(0))
}

/// The same of sections that were evaluated before.
///
/// # Errors
/// `too-few-sections`.
pub fn sections_of(
    compiled: &Compiled,
    evaluated: &Evaluated,
    campaign: CampaignInfo,
    settings: &Settings,
) -> Result<Study, Problems> {
    let (case, reduction) = case_of(evaluated, &compiled.plan, settings).map_err(too_few)?;
    let found = SelectionStudy { reduction, ..selections(&case, &settings.selections) };
    let notes = evaluated.notes.iter().chain(&found.lacking).cloned().collect();
    Ok(Study::new(protocol_info(compiled), campaign, notes, StudyResult::Sections(found)))
}

/// A margin is found by judging the campaign many times.
///
/// # Errors
/// `study-verdict`: each of them would be thousands of draws.
fn judged_once(compiled: &Compiled) -> Result<(), Problems> {
    let Some(rule) = compiled.plan.by_draws() else { return Ok(()) };
    let says = "a verdict of the protocol is decided by draws of the sections, and a margin would \
                draw anew for each change";
    let problem = Problem::error("study-verdict", says).at(&rule.span);
    Err(Problems(vec![problem.help("study a variant without `in ... of draws`")]))
}

/// A study counts limits of selections: the overall verdict must rest on limits alone.
///
/// # Errors
/// `study-verdict`: it is over other verdicts, or a person decides it.
pub fn countable(compiled: &Compiled) -> Result<(), Problems> {
    let overall = compiled.plan.overall();
    let why = match &overall.decision {
        decision if decision.by_draws() => "is decided by draws of the sections",
        Decision::Limits { .. } => return Ok(()),
        Decision::Verdicts(_) => "is over other verdicts",
        Decision::Person(_) => "is judged by a person",
        Decision::Ordered(_) => "has several outcomes in order",
    };
    let name = overall.name.as_ref().map_or_else(String::new, |name| format!(" `{name}`"));
    let problem = problem!(
        "study-verdict",
        &overall.span,
        "the overall verdict{name} {why}: a study can only count limits"
    );
    let help =
        "write a variant of the protocol whose overall verdict is one by limits, and study that";
    Err(problem.help(help).into())
}

fn too_few(reason: Reason) -> Problems {
    Problem::error("too-few-sections", reason.text())
        .help("provide more sections, or reduce the number per selection with `--take`")
        .into()
}

/// The sections to select from, reduced if required.
fn case_of(
    evaluated: &Evaluated,
    plan: &Plan,
    settings: &Settings,
) -> Result<(Case, Option<Reduction>), Reason> {
    let case = Case::of(&evaluated.pool(plan), settings.take)?;
    Ok(match settings.reduce {
        None => (case, None),
        Some(most) => {
            let (smaller, reduction) = reduced(&case, most);
            (smaller, Some(reduction))
        }
    })
}

fn joined(
    compiled: &Compiled,
    campaigns: Campaigns<'_>,
    evaluated: &Evaluated,
    found: StudyResult,
) -> Study {
    let campaign = campaign_of(compiled, campaigns, evaluated);
    Study::new(protocol_info(compiled), campaign, evaluated.notes.clone(), found)
}

fn campaign_of(
    compiled: &Compiled,
    campaigns: Campaigns<'_>,
    evaluated: &Evaluated,
) -> CampaignInfo {
    let vehicle = evaluated.facts.items(&compiled.plan);
    campaign_info(&compiled.plan, campaigns, evaluated.files.clone(), vehicle)
}
