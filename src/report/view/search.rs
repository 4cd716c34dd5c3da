//! How the sections were found in runs, and which were kept.

use serde::Serialize;

use crate::report::found::{drift_in_words, in_words};
use crate::report::number;
use crate::result::Certification;
use crate::result::found::{FoundInRun, FoundSections};
use crate::result::study::Reduction;

/// The search in the runs of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SearchView {
    /// Which of several campaigns, with a colon; else empty.
    pub campaign: String,
    pub sentence: String,
    pub runs: Vec<RunRow>,
    pub rejected: Vec<RejectedRow>,
    /// The shift of the measurement of each run, in a sentence.
    pub drifts: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunRow {
    pub run: String,
    pub start: String,
    pub end: String,
    pub tried: String,
    pub found: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RejectedRow {
    pub reason: String,
    pub places: String,
    pub share: String,
}

/// The sections that were kept, and the scatter of all and of these.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ReductionView {
    pub sentence: String,
    pub groups: Vec<GroupRow>,
    pub scatter: Vec<ScatterRow>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GroupRow {
    pub group: String,
    pub kept: String,
    pub sections: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ScatterRow {
    pub symbol: String,
    pub all: String,
    pub kept: String,
}

pub fn searches(found: &Certification) -> Vec<SearchView> {
    found.found.iter().map(search).collect()
}

fn search(found: &FoundSections) -> SearchView {
    let tried = found.tried();
    let length = |x: f64| format!("{} {}", number::significant(x, 7), found.axis_unit);
    let run = |run: &FoundInRun| RunRow {
        run: run.run.clone(),
        start: length(run.start),
        end: length(run.end),
        tried: number::count(run.tried as u64),
        found: run.found.to_string(),
    };
    let rejected = found.rejected().into_iter().map(|rejected| RejectedRow {
        share: format!("{:.1} %", 100.0 * rejected.places as f64 / tried.max(1) as f64),
        places: number::count(rejected.places as u64),
        reason: super::capital(&rejected.reason),
    });
    SearchView {
        campaign: found.campaign.as_ref().map_or_else(String::new, |name| format!("{name}: ")),
        sentence: format!("{}.", in_words(found)),
        runs: found.runs.iter().map(run).collect(),
        rejected: rejected.collect(),
        drifts: found
            .runs
            .iter()
            .filter_map(|run| drift_in_words(run, &found.axis_unit))
            .map(|says| format!("{}.", super::capital(&says)))
            .collect(),
    }
}

pub fn reduction(found: &Certification) -> Option<ReductionView> {
    found.reduction.as_ref().map(view)
}

fn view(reduction: &Reduction) -> ReductionView {
    let highest =
        |of: fn(&(String, f64, f64)) -> f64| reduction.scatter.iter().map(of).fold(0.0, f64::max);
    let (all, kept) = (highest(|row| row.1), highest(|row| row.2));
    let (left, used): (usize, usize) =
        (reduction.left_out.len(), reduction.kept.iter().map(|(_, kept)| kept.len()).sum());
    ReductionView {
        sentence: format!(
            "{used} of {} sections were kept, at most {} of each group, so that the highest standard deviation divided by its limit stays \
             almost the same: {} of all sections, {} of those kept.",
            used + left,
            reduction.most,
            number::fixed(all, 3),
            number::fixed(kept, 3)
        ),
        groups: reduction
            .kept
            .iter()
            .map(|(group, kept)| GroupRow {
                group: group.clone(),
                kept: kept.len().to_string(),
                sections: kept.join(", "),
            })
            .collect(),
        scatter: reduction
            .scatter
            .iter()
            .map(|(symbol, all, kept)| ScatterRow {
                symbol: symbol.clone(),
                all: number::fixed(*all, 3),
                kept: number::fixed(*kept, 3),
            })
            .collect(),
    }
}
