//! What a study found: how the verdict depends on the sections chosen, on the synchronisation, on the protocol's parameters.

use serde::Serialize;

use super::{CampaignInfo, ProtocolInfo, Verdict};

/// A study with what it was made of.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    pub protocol: ProtocolInfo,
    pub campaign: CampaignInfo,
    pub notes: Vec<String>,
    pub found: Found,
}

#[derive(Clone, Debug, Serialize)]
pub enum Found {
    Sections(SelectionStudy),
    Sync(SyncStudy),
    Parameters(ParameterStudy),
}

/// Every selection of sections, or as many as could be looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SelectionStudy {
    pub strata: Vec<Stratum>,
    /// Number of selections; beyond 2^53 a rounded one.
    pub combinations: f64,
    pub share: Share,
    /// Verdict over all usable sections.
    pub verdict: Verdict,
    pub quantities: Vec<QuantitySpread>,
    pub sections: Vec<Importance>,
    /// The selection that is worst in each limit that some selection breaks.
    pub worst: Vec<WorstSelection>,
    /// Where it was looked for.
    pub removal: Option<Removal>,
    pub reduction: Option<Reduction>,
    /// How it was computed, a sentence each.
    pub methods: Vec<String>,
}

/// A zone, or all sections where there are none.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Stratum {
    pub zone: String,
    pub title: String,
    /// Sections of a selection.
    pub take: usize,
    /// Usable sections.
    pub sections: Vec<String>,
    /// Sections with their reason that are not usable.
    pub not_used: Vec<(String, String)>,
}

/// Selections that are validated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Of the selections looked at.
    pub validated: u64,
    pub looked_at: u64,
    pub share: f64,
    /// All selections were looked at.
    pub exact: bool,
    /// 95 % Wilson interval where they were drawn at random.
    pub interval: Option<(f64, f64)>,
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantitySpread {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub unit: String,
    /// Share of the selections that break one of its limits, and of those that break no other quantity's.
    pub failing: f64,
    pub alone: Option<f64>,
    pub statistics: Vec<StatisticSpread>,
}

/// A statistic divided by its limit, over the selections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatisticSpread {
    pub name: String,
    pub title: String,
    pub scope: String,
    /// In the unit of the quantity; values are divided by it unless it is not above zero.
    pub limit: f64,
    pub at_least: bool,
    /// `None` where no selection has a value.
    pub spread: Option<Spread>,
    /// Share of the selections that break it.
    pub failing: f64,
    /// Values of all sections together.
    pub overall: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub min: f64,
    pub q1: f64,
    pub median: f64,
    pub q3: f64,
    pub max: f64,
    /// Selections beyond 1.5 interquartile ranges.
    pub outliers: u64,
    /// Selections with a value.
    pub count: f64,
    /// Exact over all selections, not estimated from some.
    pub exact: bool,
    /// Where all selections are counted but not told apart to the last digit: how far the quartiles are from the true ones at most.
    pub within: Option<f64>,
    /// 95 % intervals of the three quartiles where they are estimated from selections drawn at random.
    pub intervals: Option<[(f64, f64); 3]>,
}

impl Spread {
    /// Where the whiskers of a box plot end.
    pub fn whiskers(&self) -> (f64, f64) {
        let reach = 1.5 * (self.q3 - self.q1);
        (self.min.max(self.q1 - reach), self.max.min(self.q3 + reach))
    }
}

/// What one section does to the share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Importance {
    pub section: String,
    pub zone: String,
    /// Share validated among selections with it; `None` where there are none.
    pub with: Option<f64>,
    pub without: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorstSelection {
    pub quantity: String,
    pub symbol: String,
    pub title: String,
    pub scope: String,
    pub normalised: f64,
    pub sections: Vec<String>,
}

/// The smallest sets of sections without which all others together give another verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Removal {
    pub verdict: Verdict,
    /// Sections of each smallest set; empty where none was found.
    pub sets: Vec<Vec<String>>,
    /// How many such sets there are; only the first are kept.
    pub count: usize,
    /// Every set of up to so many sections was tried.
    pub tried: usize,
    /// Nothing more can be removed without falling short of what the protocol needs.
    pub complete: bool,
    /// Where none of the sets tried changes it: a larger one that does, not surely the smallest of its kind.
    pub larger: Option<Vec<String>>,
}

/// A smaller set of sections that keeps the scatter of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reduction {
    pub most: usize,
    pub kept: Vec<(String, Vec<String>)>,
    pub left_out: Vec<String>,
    /// Per quantity: symbol, normalised standard deviation of all sections and of those kept.
    pub scatter: Vec<(String, f64, f64)>,
}

/// The verdict with the measurement shifted against the simulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SyncStudy {
    pub axis_unit: String,
    /// In the order asked for, 0 among them.
    pub offsets: Vec<AtOffset>,
    pub estimates: Vec<Estimated>,
    /// Whether the estimates were taken out before the offsets were put in.
    pub corrected: bool,
    /// The one selection of the first figure, by section.
    pub selection: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtOffset {
    /// Added to the measurement's axis, in the unit of the axis.
    pub offset: f64,
    /// Verdict over all usable sections.
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    /// Normalised statistics of the one selection.
    pub selected: Vec<Selected>,
    /// `None` where too few sections are usable at this offset: why.
    pub study: Result<SelectionStudy, String>,
    /// What is otherwise than without offset.
    pub changes: Vec<String>,
    /// Selections whose verdict is otherwise than without offset, or why there is none to compare.
    pub flips: Result<Flips, String>,
    /// Sections that cannot be used at this offset, with the reason.
    pub lost: Vec<(String, String)>,
}

/// Selections whose verdict is another than before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flips {
    /// Selections compared: all that both have, or those drawn at random.
    pub compared: f64,
    /// Share of them validated before and no longer.
    pub lost: f64,
    /// Share of them validated now and not before.
    pub gained: f64,
    pub exact: bool,
    /// 95 % Wilson intervals where they were drawn.
    pub lost_interval: Option<(f64, f64)>,
    pub gained_interval: Option<(f64, f64)>,
}

/// A normalised statistic of one selection.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Selected {
    pub id: String,
    pub symbol: String,
    pub name: String,
    pub scope: String,
    pub normalised: Option<f64>,
    pub holds: bool,
}

/// How a section's measurement lies against its simulation, in the unit of the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimated {
    pub section: String,
    pub zone: Option<String>,
    /// To be added to the measurement's axis; `None` where the signals do not tell.
    pub shift: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub correlation: Option<f64>,
}

/// The verdict along the protocol's parameters, each varied by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterStudy {
    pub base: AtValue,
    pub parameters: Vec<Varied>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Varied {
    pub name: String,
    pub title: String,
    /// Value without variation.
    pub base: String,
    pub values: Vec<AtValue>,
    /// Verdicts differ.
    pub decides: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtValue {
    pub value: String,
    /// It is the one that is used without variation.
    pub is_base: bool,
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    /// Normalised statistics over all usable sections, in the order of the protocol.
    pub statistics: Vec<Selected>,
    /// The largest of them.
    pub largest: Option<(String, f64)>,
    pub share: Option<Share>,
    pub combinations: f64,
    /// Why there is no share.
    pub reason: Option<String>,
}
