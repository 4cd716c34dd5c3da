//! Result of a study: dependence of the verdict on the selection of sections, the synchronisation,
//! and the parameters of the protocol.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::{
    CampaignInfo, FORMAT, ProtocolInfo, Reason, Remark, Scope, StatisticName, THIS, UnusedSection,
    Verdict, margin::MarginStudy, told,
};

/// A study with its inputs, in the form of `study.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Study {
    pub fishplate: String,
    pub format: u32,
    #[serde(rename = "study")]
    pub kind: Kind,
    pub protocol: ProtocolInfo,
    pub campaign: CampaignInfo,
    #[serde(flatten)]
    pub found: StudyResult,
    #[serde(flatten, with = "told::notes")]
    #[schemars(with = "told::Notes<Remark>")]
    pub notes: Vec<Remark>,
}

/// What a study is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Sections,
    Sync,
    Parameters,
    Margin,
}

impl Study {
    pub fn new(
        protocol: ProtocolInfo,
        campaign: CampaignInfo,
        notes: Vec<Remark>,
        found: StudyResult,
    ) -> Self {
        let kind = match &found {
            StudyResult::Sections(_) => Kind::Sections,
            StudyResult::Sync(_) => Kind::Sync,
            StudyResult::Parameters(_) => Kind::Parameters,
            StudyResult::Margin(_) => Kind::Margin,
        };
        Self { fishplate: THIS.into(), format: FORMAT, kind, protocol, campaign, found, notes }
    }
}

/// The result of a study of one kind.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[expect(clippy::large_enum_variant, reason = "a study is one value")]
pub enum StudyResult {
    Sections(SelectionStudy),
    Sync(SyncStudy),
    Parameters(ParameterStudy),
    Margin(MarginStudy),
}

/// All selections of sections, or a random sample of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SelectionStudy {
    #[serde(flatten)]
    pub counted: Counted,
    /// Verdict over all usable sections.
    #[serde(rename = "verdict_all_sections")]
    pub verdict: Verdict,
    pub quantities: Vec<QuantitySpread>,
    /// Number of usable sections, and of those in a selection.
    pub sections_per_zone: IndexMap<String, usize>,
    pub taken_per_zone: IndexMap<String, usize>,
    #[serde(rename = "zones")]
    pub strata: Vec<Stratum>,
    pub sections: Vec<Importance>,
    /// The worst selection for each limit that some selection does not meet.
    #[serde(rename = "worst_selections")]
    pub worst: Vec<WorstSelection>,
    /// Absent where it was not computed.
    #[serde(rename = "smallest_removal")]
    pub removal: Option<Removal>,
    pub reduction: Option<Reduction>,
    /// Methods used, one sentence each.
    pub methods: Vec<String>,
    /// Why no selection can be assessed, if none can.
    #[serde(flatten, with = "told::lacking")]
    #[schemars(with = "told::NoneOrLacking<Remark>")]
    pub lacking: Option<Remark>,
}

/// How many selections there are, and the share of them that is validated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Counted {
    /// Number of selections; rounded beyond 2^53.
    #[serde(serialize_with = "whole")]
    pub combinations: f64,
    #[serde(flatten)]
    pub share: Share,
}

/// Counts are integers as long as they are exact.
fn whole<S: Serializer>(count: &f64, to: S) -> Result<S::Ok, S::Error> {
    if *count < 9_007_199_254_740_992.0 {
        to.serialize_u64(*count as u64)
    } else {
        to.serialize_f64(*count)
    }
}

/// A zone, or all sections if there are no zones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stratum {
    pub zone: String,
    pub title: String,
    /// Number of sections in a selection.
    pub take: usize,
    /// Usable sections.
    pub sections: Vec<String>,
    /// Sections that are not usable, with the reason.
    #[serde(flatten, with = "told::not_used")]
    #[schemars(with = "told::NotUsed<Reason>")]
    pub not_used: Vec<(String, Reason)>,
}

/// Share of the selections that are validated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Share {
    /// Number of validated selections; `None` if not all were evaluated.
    #[serde(rename = "validated")]
    pub validated_of_all: Option<u64>,
    /// Why there is no such number.
    #[serde(flatten, with = "told::reason", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<told::OneReason<Reason>>")]
    pub reason: Option<Reason>,
    #[serde(rename = "share_validated")]
    pub share: f64,
    /// All selections were evaluated.
    pub exact: bool,
    /// 95 % Wilson interval for random selections.
    #[serde(rename = "interval_95")]
    pub interval: Option<(f64, f64)>,
    pub looked_at: u64,
    /// Number of validated selections among those evaluated.
    #[serde(rename = "validated_of_those")]
    pub validated: u64,
    pub seed: Option<u64>,
}

impl Share {
    /// Of all selections.
    pub fn exact(validated: u64, looked_at: u64) -> Self {
        Self {
            validated_of_all: Some(validated),
            reason: None,
            share: validated as f64 / looked_at as f64,
            exact: true,
            interval: None,
            looked_at,
            validated,
            seed: None,
        }
    }
}

/// The statistics of a quantity over the selections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QuantitySpread {
    pub id: String,
    pub title: String,
    pub symbol: String,
    pub unit: String,
    /// Mean and standard deviation of all values, if they have a limit.
    pub mean: Option<Spread>,
    pub std: Option<Spread>,
    /// Share of the selections that do not meet one of its limits, and of those in which no other
    /// quantity fails.
    #[serde(rename = "share_failing")]
    pub failing: f64,
    #[serde(rename = "share_failing_alone")]
    pub alone: Option<f64>,
    pub statistics: Vec<StatisticSpread>,
}

/// A statistic divided by its limit, over the selections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StatisticSpread {
    pub name: StatisticName,
    pub title: String,
    #[serde(flatten)]
    pub scope: Scope,
    /// In the unit of the quantity. Values are divided by it if it is above zero.
    pub limit: f64,
    pub at_least: bool,
    /// The statistic of all sections together.
    #[serde(rename = "all_sections")]
    pub overall: Option<f64>,
    /// Share of the selections that do not meet it.
    #[serde(rename = "share_failing")]
    pub failing: f64,
    /// `None` where no selection has a value.
    #[serde(rename = "normalised")]
    pub spread: Option<Spread>,
    /// Why there is none.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
}

/// A statistic over the selections.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Spread {
    pub min: f64,
    pub q1: f64,
    pub median: f64,
    pub q3: f64,
    pub max: f64,
    /// Number of selections beyond 1.5 interquartile ranges.
    pub outliers: u64,
    /// Number of selections with a value.
    #[serde(serialize_with = "whole")]
    pub count: f64,
    /// Computed for all selections, not estimated from a sample.
    pub exact: bool,
    /// Largest error of the quartiles where all selections are counted with a finite resolution.
    #[serde(rename = "quartiles_within")]
    pub within: Option<f64>,
    /// 95 % intervals of the three quartiles where they are estimated from random selections.
    #[serde(flatten)]
    pub intervals: Intervals,
}

/// See [`Spread::intervals`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Intervals {
    pub q1_interval_95: Option<(f64, f64)>,
    pub median_interval_95: Option<(f64, f64)>,
    pub q3_interval_95: Option<(f64, f64)>,
}

impl Intervals {
    /// In increasing order.
    pub fn all(&self) -> [Option<(f64, f64)>; 3] {
        [self.q1_interval_95, self.median_interval_95, self.q3_interval_95]
    }
}

impl From<[Option<(f64, f64)>; 3]> for Intervals {
    fn from([q1_interval_95, median_interval_95, q3_interval_95]: [Option<(f64, f64)>; 3]) -> Self {
        Self { q1_interval_95, median_interval_95, q3_interval_95 }
    }
}

impl Spread {
    /// Ends of the whiskers of a box plot.
    pub fn whiskers(&self) -> (f64, f64) {
        let reach = 1.5 * (self.q3 - self.q1);
        (self.min.max(self.q1 - reach), self.max.min(self.q3 + reach))
    }
}

/// Influence of one section on the share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Importance {
    pub section: String,
    pub zone: String,
    /// Share validated among selections with it; `None` where there are none.
    pub with: Option<f64>,
    pub without: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorstSelection {
    pub quantity: String,
    pub symbol: String,
    pub title: String,
    #[serde(flatten)]
    pub scope: Scope,
    pub normalised: f64,
    pub sections: Vec<String>,
}

/// The smallest sets of sections whose removal changes the verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reduction {
    pub most: usize,
    pub kept: Vec<(String, Vec<String>)>,
    pub left_out: Vec<String>,
    /// Per quantity: symbol, normalised standard deviation of all sections and of those kept.
    pub scatter: Vec<(String, f64, f64)>,
}

/// The verdict with the measurement shifted against the simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SyncStudy {
    pub axis_unit: String,
    /// In the given order; 0 is included.
    pub offsets: Vec<AtOffset>,
    /// The selection of the first figure, by section.
    #[serde(rename = "one_selection")]
    pub selection: Vec<String>,
    #[serde(rename = "estimated_offsets")]
    pub estimates: Vec<Estimated>,
    /// Whether the estimated offsets were corrected first.
    pub corrected: bool,
}

/// The verdict at one offset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AtOffset {
    #[serde(flatten)]
    pub offset: Offset,
    #[serde(flatten)]
    pub selections: Selections,
    /// Differences from the case without offset.
    #[serde(flatten, with = "told::changes")]
    #[schemars(with = "told::Changes<Remark>")]
    pub changes: Vec<Remark>,
    #[serde(rename = "selections_changed")]
    pub flips: Flipped,
    /// Verdict over all usable sections.
    #[serde(rename = "verdict_all_sections")]
    pub verdict: Verdict,
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
    /// Normalised statistics of the single selection.
    #[serde(rename = "one_selection")]
    pub selected: Vec<Selected>,
    /// Over the selections at this offset.
    pub quantities: Vec<QuantitySpread>,
    /// Sections that cannot be used at this offset.
    #[serde(rename = "sections_lost")]
    pub lost: Vec<UnusedSection>,
}

/// Added to the measurement's axis, in the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Offset {
    #[serde(rename = "offset_m")]
    Metres(f64),
    #[serde(rename = "offset")]
    Other(f64),
}

impl Offset {
    /// In the unit of the axis.
    pub fn value(self) -> f64 {
        let (Self::Metres(value) | Self::Other(value)) = self;
        value
    }
}

/// The selections at an offset, or why none can be made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Selections {
    Counted(Counted),
    Impossible {
        share_validated: (),
        #[serde(flatten, with = "told::reason")]
        #[schemars(with = "told::OneReason<Reason>")]
        reason: Reason,
    },
}

impl From<Result<Counted, Reason>> for Selections {
    fn from(found: Result<Counted, Reason>) -> Self {
        found.map_or_else(|reason| Self::Impossible { share_validated: (), reason }, Self::Counted)
    }
}

impl Selections {
    /// # Errors
    /// No selection can be made; the reason.
    pub fn counted(&self) -> Result<&Counted, &Reason> {
        match self {
            Self::Counted(counted) => Ok(counted),
            Self::Impossible { reason, .. } => Err(reason),
        }
    }
}

/// Selections whose verdict differs from that without offset, or why they cannot be compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Flipped {
    Compared(Flips),
    Impossible {
        #[serde(flatten, with = "told::reason")]
        #[schemars(with = "told::OneReason<Reason>")]
        reason: Reason,
    },
}

impl Flipped {
    /// What was compared.
    pub fn compared(&self) -> Option<&Flips> {
        match self {
            Self::Compared(flips) => Some(flips),
            Self::Impossible { .. } => None,
        }
    }
}

/// Selections whose verdict changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Flips {
    /// Number of selections compared: all common ones, or random ones.
    #[serde(serialize_with = "whole")]
    pub compared: f64,
    /// Share of them that are no longer validated.
    #[serde(rename = "share_no_longer_validated")]
    pub lost: f64,
    /// Share of them that are newly validated.
    #[serde(rename = "share_newly_validated")]
    pub gained: f64,
    pub exact: bool,
    /// 95 % Wilson intervals for random selections.
    #[serde(rename = "no_longer_interval_95")]
    pub lost_interval: Option<(f64, f64)>,
    #[serde(rename = "newly_interval_95")]
    pub gained_interval: Option<(f64, f64)>,
}

/// A normalised statistic of one selection.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Selected {
    pub id: String,
    pub symbol: String,
    #[serde(rename = "statistic")]
    pub name: StatisticName,
    #[serde(flatten)]
    pub scope: Scope,
    pub normalised: Option<f64>,
    pub holds: bool,
}

/// Estimated offset of a section's measurement against its simulation, in the unit of the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterStudy {
    #[serde(rename = "as_it_is")]
    pub base: AtValue,
    pub parameters: Vec<Varied>,
}

/// A parameter, and the verdict with each of its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Varied {
    pub name: String,
    pub title: String,
    /// Baseline value.
    #[serde(rename = "as_it_is")]
    pub base: String,
    /// The verdict changes.
    pub decides: bool,
    pub values: Vec<AtValue>,
}

/// The verdict with one value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AtValue {
    pub value: String,
    /// Whether it is the baseline value.
    #[serde(rename = "as_it_is")]
    pub is_base: bool,
    pub verdict: Verdict,
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
    /// The largest of the statistics.
    pub largest: Option<Largest>,
    #[serde(serialize_with = "whole")]
    pub combinations: f64,
    /// Share of the selections that are validated; `None` where no selection can be made.
    #[serde(rename = "share_validated")]
    pub share: Option<f64>,
    /// All selections were evaluated.
    pub exact: Option<bool>,
    #[serde(rename = "interval_95")]
    pub interval: Option<(f64, f64)>,
    /// Why there is no share.
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Normalised statistics over all usable sections, in the order of the protocol.
    pub statistics: Vec<Selected>,
}

/// The largest normalised statistic.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Largest {
    /// `std of ay_max`
    pub statistic: String,
    pub normalised: f64,
}
