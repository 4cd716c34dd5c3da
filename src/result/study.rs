//! Result of a study: dependence of the verdict on the selection of sections, the synchronisation,
//! and the parameters of the protocol.

use serde::Serialize;

use super::{CampaignInfo, ProtocolInfo, Verdict};

/// A study with its inputs.
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

/// All selections of sections, or a random sample of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SelectionStudy {
    pub strata: Vec<Stratum>,
    /// Number of selections; rounded beyond 2^53.
    pub combinations: f64,
    pub share: Share,
    /// Verdict over all usable sections.
    pub verdict: Verdict,
    /// Why no selection can be assessed, if none can.
    pub lacking: Option<String>,
    pub quantities: Vec<QuantitySpread>,
    pub sections: Vec<Importance>,
    /// The worst selection for each limit that some selection does not meet.
    pub worst: Vec<WorstSelection>,
    /// Absent where it was not computed.
    pub removal: Option<Removal>,
    pub reduction: Option<Reduction>,
    /// Methods used, one sentence each.
    pub methods: Vec<String>,
}

/// A zone, or all sections if there are no zones.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Stratum {
    pub zone: String,
    pub title: String,
    /// Number of sections in a selection.
    pub take: usize,
    /// Usable sections.
    pub sections: Vec<String>,
    /// Sections that are not usable, with the reason.
    pub not_used: Vec<(String, String)>,
}

/// Share of the selections that are validated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Number of validated selections among those evaluated.
    pub validated: u64,
    pub looked_at: u64,
    pub share: f64,
    /// All selections were evaluated.
    pub exact: bool,
    /// 95 % Wilson interval for random selections.
    pub interval: Option<(f64, f64)>,
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QuantitySpread {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub unit: String,
    /// Share of the selections that do not meet one of its limits, and of those in which no other
    /// quantity fails.
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
    /// In the unit of the quantity. Values are divided by it if it is above zero.
    pub limit: f64,
    pub at_least: bool,
    /// `None` where no selection has a value.
    pub spread: Option<Spread>,
    /// Share of the selections that do not meet it.
    pub failing: f64,
    /// The statistic of all sections together.
    pub overall: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub min: f64,
    pub q1: f64,
    pub median: f64,
    pub q3: f64,
    pub max: f64,
    /// Number of selections beyond 1.5 interquartile ranges.
    pub outliers: u64,
    /// Number of selections with a value.
    pub count: f64,
    /// Computed for all selections, not estimated from a sample.
    pub exact: bool,
    /// Largest error of the quartiles where all selections are counted with a finite resolution.
    pub within: Option<f64>,
    /// 95 % intervals of the three quartiles where they are estimated from random selections.
    pub intervals: Option<[(f64, f64); 3]>,
}

impl Spread {
    /// Ends of the whiskers of a box plot.
    pub fn whiskers(&self) -> (f64, f64) {
        let reach = 1.5 * (self.q3 - self.q1);
        (self.min.max(self.q1 - reach), self.max.min(self.q3 + reach))
    }
}

/// Influence of one section on the share.
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

/// The smallest sets of sections whose removal changes the verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Removal {
    pub verdict: Verdict,
    /// Sections of each smallest set; empty if none was found.
    pub sets: Vec<Vec<String>>,
    /// Number of such sets; only the first are listed.
    pub count: usize,
    /// All sets up to this size were tried.
    pub tried: usize,
    /// No more sections can be removed without falling below the number that the protocol requires.
    pub complete: bool,
    /// If no set that was tried changes the verdict: a larger one that does, not necessarily the
    /// smallest.
    pub larger: Option<Vec<String>>,
}

/// A reduced set of sections with nearly the same scatter.
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
    /// In the given order; 0 is included.
    pub offsets: Vec<AtOffset>,
    pub estimates: Vec<Estimated>,
    /// Whether the estimated offsets were corrected first.
    pub corrected: bool,
    /// The selection of the first figure, by section.
    pub selection: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtOffset {
    /// Added to the measurement's axis, in the unit of the axis.
    pub offset: f64,
    /// Verdict over all usable sections.
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    /// Normalised statistics of the single selection.
    pub selected: Vec<Selected>,
    /// The reason if too few sections are usable at this offset.
    pub study: Result<SelectionStudy, String>,
    /// Differences from the case without offset.
    pub changes: Vec<String>,
    /// Selections whose verdict differs from that without offset, or the reason why they cannot be
    /// compared.
    pub flips: Result<Flips, String>,
    /// Sections that cannot be used at this offset, with the reason.
    pub lost: Vec<(String, String)>,
}

/// Selections whose verdict changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Flips {
    /// Number of selections compared: all common ones, or random ones.
    pub compared: f64,
    /// Share of them that are no longer validated.
    pub lost: f64,
    /// Share of them that are newly validated.
    pub gained: f64,
    pub exact: bool,
    /// 95 % Wilson intervals for random selections.
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

/// Estimated offset of a section's measurement against its simulation, in the unit of the axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimated {
    pub section: String,
    pub zone: Option<String>,
    /// To be added to the measurement's axis; `None` if it cannot be estimated.
    pub shift: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub correlation: Option<f64>,
}

/// The verdict as a function of the protocol's parameters, each varied by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterStudy {
    pub base: AtValue,
    pub parameters: Vec<Varied>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Varied {
    pub name: String,
    pub title: String,
    /// Baseline value.
    pub base: String,
    pub values: Vec<AtValue>,
    /// The verdict changes.
    pub decides: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AtValue {
    pub value: String,
    /// Whether it is the baseline value.
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
