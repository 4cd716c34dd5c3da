//! What a certification run found: plain data, no logic, no I/O.
//!
//! Numbers are in the display unit named beside them. What could not be computed is `None` with a reason, never NaN.

pub mod blind;
pub mod diagnosis;
pub mod finding;
pub mod origin;
pub mod report;
pub mod study;

use serde::Serialize;

pub use finding::{Consequence, Finding};
pub use origin::{FittedTo, OriginInfo};
pub use report::ReportItem;

/// Everything a report prints, in the order of the protocol and of the campaign.
#[derive(Clone, Debug, Serialize)]
pub struct Certification {
    pub protocol: ProtocolInfo,
    pub campaign: CampaignInfo,
    pub verdict: Verdict,
    /// What belongs beside the verdict: how the simulation was made, where it was changed after the comparison.
    pub verdict_note: Option<String>,
    /// Why the verdict is not "validated"; empty if it is.
    pub reasons: Vec<String>,
    pub quantities: Vec<QuantityResult>,
    pub sections: Vec<SectionResult>,
    /// Empty if the protocol knows no zones.
    pub zones: Vec<ZoneResult>,
    /// Range of each numeric section column over the used sections: the validity domain.
    pub domain: Vec<DomainRange>,
    /// Distance or time plots of the sections that matter most.
    pub traces: Vec<Trace>,
    /// What is not plausible in the data, in the order of the protocol's rules and of the sections.
    pub findings: Vec<Finding>,
    /// Remarks that do not change the verdict (a short filter margin, a unit converted).
    pub notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    #[serde(rename = "validated")]
    Validated,
    #[serde(rename = "not validated")]
    NotValidated,
    #[serde(rename = "not assessable")]
    NotAssessable,
}

impl Certification {
    /// `validated, with a simulation fitted to the same measurements`
    pub fn verdict_in_words(&self) -> String {
        let note = self.verdict_note.as_ref().map_or(String::new(), |note| format!(", {note}"));
        format!("{}{note}", self.verdict.in_words())
    }
}

impl Verdict {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Validated => "validated",
            Self::NotValidated => "not validated",
            Self::NotAssessable => "not assessable",
        }
    }
}

/// The rules that were applied.
#[derive(Clone, Debug, Serialize)]
pub struct ProtocolInfo {
    pub name: String,
    pub title: String,
    /// Standard and edition the protocol follows, if it names one.
    pub edition: Option<String>,
    pub source: Option<String>,
    pub scope: Option<String>,
    pub notes: Vec<String>,
    pub sha256: String,
    /// The files the protocol came from, the protocol first, then its parent, and so on.
    pub files: Vec<ProtocolFile>,
    /// What differs in meaning from the parent, rule by rule; empty without a parent.
    pub deviations: Vec<Deviation>,
    pub parameters: Vec<ParameterInfo>,
    pub filters: Vec<FilterInfo>,
    /// Measured and simulated channels that the protocol declares.
    pub channels: Vec<ChannelInfo>,
    /// Number of nodes of the processing graph.
    pub graph_nodes: usize,
    /// The processing graph drawn, one SVG text.
    pub graph_svg: String,
    /// What "validated" asks for, in a sentence.
    pub verdict_rule: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct ProtocolFile {
    pub name: String,
    pub sha256: String,
    pub text: String,
}

/// One rule that a variant changed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Deviation {
    /// What it is about: `quantity ay_max, limit std`.
    pub rule: String,
    /// Text in the parent; `None` if it is new.
    pub before: Option<String>,
    /// Text in the variant; `None` if it is removed.
    pub after: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
pub struct ParameterInfo {
    pub name: String,
    pub title: String,
    /// Value used, with its unit.
    pub value: String,
    pub default: String,
    /// `default`, `campaign` or `command line`.
    pub set_by: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct ChannelInfo {
    pub name: String,
    pub title: String,
    pub unit: String,
    /// Sign convention and other remarks.
    pub note: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct FilterInfo {
    pub name: String,
    pub title: String,
    /// The steps in words, numbers filled in: `low-pass 20 Hz, Butterworth order 4, zero-phase`.
    pub steps: String,
    pub source: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
pub struct CampaignInfo {
    pub name: String,
    /// Every input file with its hash, in the order read.
    pub files: Vec<FileHash>,
    /// Vehicle data: those the protocol uses first, then all others of the file.
    pub vehicle: Vec<DataItem>,
    /// Other keys of campaign.yaml, in its order.
    pub facts: Vec<DataItem>,
    /// What made the simulated records, where the campaign says so.
    pub origin: Option<OriginInfo>,
    /// What the campaign says the report is known by, stated or not.
    #[serde(serialize_with = "as_tree")]
    pub report: Vec<ReportItem>,
}

fn as_tree<S: serde::Serializer>(items: &[ReportItem], to: S) -> Result<S::Ok, S::Error> {
    report::tree(items).serialize(to)
}

#[derive(Clone, Debug, Serialize)]
pub struct FileHash {
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
    /// What it is a record of; `None` for the campaign's own files.
    pub record: Option<RecordOf>,
}

/// Which record a file is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RecordOf {
    /// `measurement`, `simulation` or `track`.
    pub kind: String,
    pub section: String,
}

/// Where a rule stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RulePlace {
    /// Name of one of [`ProtocolInfo::files`].
    pub file: String,
    /// From 1.
    pub line: usize,
}

/// A named value of the campaign or the vehicle, as text.
#[derive(Clone, Debug, Serialize)]
pub struct DataItem {
    pub name: String,
    pub value: String,
    pub unit: Option<String>,
    /// Whether a rule of the protocol reads it.
    pub used: bool,
    /// The campaign states no unit: `unit` is the protocol's.
    pub unit_assumed: bool,
}

/// One quantity of the protocol: what was done, what came out, whether it holds.
#[derive(Clone, Debug, Serialize)]
pub struct QuantityResult {
    pub id: String,
    pub title: String,
    /// As printed in tables, if the protocol gives one (`(Y/Q)max`); else the id.
    pub symbol: String,
    /// Unit of the compared values, `-` for a plain number.
    pub unit: String,
    /// Signals in words: `Y at wheelsets 1, 3`.
    pub of: String,
    /// Filter in words, or `none`.
    pub filter: String,
    /// Processing in words: `median`, `larger of |p0.15|, |p99.85|`.
    pub processing: String,
    /// How simulated and measured are compared: `simulated - measured`, or the metric.
    pub comparison: String,
    pub clause: Option<String>,
    pub source: Option<String>,
    pub notes: Vec<String>,
    /// True if `values` hold simulated and measured values; false where a metric gives one number for the two signals.
    pub has_sides: bool,
    pub statistics: Vec<StatisticResult>,
    /// Number of sites that the values are of.
    pub n: usize,
    pub values: Vec<PairValue>,
    /// All statistics hold; `None` if not assessable.
    pub holds: Option<bool>,
    /// Why it is not assessable.
    pub reason: Option<String>,
    /// Where the protocol defines it.
    pub rule: RulePlace,
}

/// One statistic over section x signal pairs against its limit.
#[derive(Clone, Debug, Serialize)]
pub struct StatisticResult {
    /// `mean`, `std`, `p95`, `each`, ...
    pub name: String,
    /// In words: `mean`, `standard deviation (n-1)`, `95 % value`, `each value`.
    pub title: String,
    /// Pairs it is taken over: `all`, `zone 1`.
    pub scope: String,
    /// Number of pairs.
    pub count: usize,
    /// Number of sites that the pairs are of. Pairs of one site (its positions, its repeats) are not independent of each other.
    pub n: usize,
    /// Unit of value and limit.
    pub unit: String,
    pub value: Option<f64>,
    /// 95 % confidence interval where defined, with sites independent of each other and n - 1 degrees of freedom (mean: Student t,
    /// standard deviation: chi-square).
    pub interval: Option<(f64, f64)>,
    /// The interval has the limit inside: another choice of sites could well have met it, or not.
    pub marginal: bool,
    pub limit: Option<f64>,
    /// |value| / limit.
    pub normalised: Option<f64>,
    pub holds: Option<bool>,
    /// Factors that are in the limit because of vehicle data.
    pub factors: Vec<LimitFactor>,
    /// The limit as the protocol words it: `2/3 of std`.
    pub limit_text: String,
    pub reason: Option<String>,
    /// Where the protocol states the limit.
    pub rule: RulePlace,
}

/// A factor by which vehicle data multiply a limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitFactor {
    pub by: f64,
    /// `vehicle category is freight`
    pub because: String,
}

/// One section and signal.
#[derive(Clone, Debug, Serialize)]
pub struct PairValue {
    /// Name of the section (or of the record, without sections).
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    pub simulated: Option<f64>,
    pub measured: Option<f64>,
    /// Difference, or the value of the metric.
    pub difference: f64,
    /// Samples (or windows) the measured value was taken from.
    pub samples: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct SectionResult {
    pub section: String,
    /// The first section of its site: repeats have the same.
    pub site: String,
    pub zone: Option<String>,
    pub used: bool,
    pub reason: Option<String>,
    /// Length in `axis_unit`.
    pub length: f64,
    pub start: f64,
    pub end: f64,
    pub axis_unit: String,
    /// Columns of sections.csv the protocol declares, as printed: title, value, unit.
    pub columns: Vec<DataItem>,
    pub checks: Vec<CheckResult>,
}

/// One requirement on a section.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    pub name: String,
    pub title: String,
    /// `None`: could not be checked, see `says`.
    pub holds: Option<bool>,
    /// What was found: `length 250 m, at least 250 m`.
    pub says: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct ZoneResult {
    pub zone: String,
    pub title: String,
    /// The zone's condition in words.
    pub condition: String,
    /// Sections used.
    pub used: usize,
    /// Sites that these are of: repeats do not count twice.
    pub sites: usize,
    pub given: usize,
    pub minimum: usize,
    pub holds: bool,
}

/// Extent of a numeric section column over the used sections.
#[derive(Clone, Debug, Serialize)]
pub struct DomainRange {
    pub name: String,
    pub unit: String,
    /// `all` or the zone.
    pub scope: String,
    pub low: f64,
    pub high: f64,
    /// Sections with a value.
    pub count: usize,
}

/// Simulated and measured signal of one section, filtered as the quantity asks, thinned for plotting.
#[derive(Clone, Debug, Serialize)]
pub struct Trace {
    pub quantity: String,
    pub section: String,
    pub zone: Option<String>,
    pub signal: String,
    /// Why it is shown: `largest difference of Y_max`.
    pub why: String,
    pub unit: String,
    pub axis: String,
    pub axis_unit: String,
    /// The evaluated section on the axis.
    pub start: f64,
    pub end: f64,
    pub measured: Curve,
    pub simulated: Curve,
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct Curve {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
}
