//! How far the verdict of a campaign is from another one.

mod channels;
mod choices;
mod probability;
mod search;

use super::{Settings, joined};
use crate::certify::Compiled;
use crate::check::Overrides;
use crate::data::Campaigns;
use crate::problem::Problems;
use crate::result::{
    Remark,
    margin::MarginStudy,
    study::{Study, StudyResult},
};
use crate::run::{Progress, hold};

/// Number of draws, if no other is asked for: a share is then known to about 0.02.
pub const DRAWS: usize = 2000;

/// Settings of a study of the margin.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    pub draws: usize,
}

/// Changes the measurement, the parameters, the sections and the limits until the verdict flips;
/// with declared uncertainties, draws what the measurement may have been.
///
/// # Errors
/// As [`crate::run::run`]; those of the declared uncertainties.
pub fn margin(
    compiled: &Compiled,
    campaigns: Campaigns<'_>,
    overrides: &Overrides,
    settings: &Settings,
    asked: Margins,
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let Compiled { plan, graph, .. } = compiled;
    let channels = channels::channels(plan, graph);
    let declared = probability::declared(campaigns, &channels)?;
    let moves = !plan.quantities.iter().any(|quantity| quantity.evaluation.of_repeats());
    let again = |holding: &crate::run::Holding<'_>| {
        let verdict = holding.base.judge(plan).verdict;
        let margins = channels::margins(plan, holding, &channels, (verdict, moves), progress);
        let draws = (asked.draws, settings.selections.seed);
        let probability = probability::drawn(plan, holding, &declared.uncertainties, draws);
        (margins, probability)
    };
    let (evaluated, (mut margin, probability)) =
        hold(plan, graph, campaigns, moves, progress, again)?;
    let judged = evaluated.judge(plan);
    let varied = choices::Varied { compiled, overrides, campaigns };
    margin.extend(varied.margins(judged.verdict, progress));
    margin.push(choices::sections(&evaluated, plan, settings));
    margin.extend(choices::limits(plan, &judged));
    let found = MarginStudy {
        verdict: judged.verdict,
        reasons: judged.reasons,
        margin,
        probability_right: probability.as_ref().map(|(share, _)| *share),
        probability: probability.map(|(_, probability)| probability),
    };
    let mut study = joined(compiled, campaigns, &evaluated, StudyResult::Margin(found));
    let unused = |channel: String| Remark::UncertaintyNotUsed { channel };
    study.notes.extend(declared.not_used.into_iter().map(unused));
    Ok(study)
}
