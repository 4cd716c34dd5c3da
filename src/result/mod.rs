//! Result of a certification: plain data, without logic or input/output.
//!
//! Numbers are in the unit named beside them. A value that could not be computed is `None` with a
//! reason, never NaN.

pub mod blind;
pub mod comparison;
pub mod confirmation;
pub mod diagnosis;
mod direction;
pub mod domain;
pub mod exercise;
pub mod finding;
pub mod found;
pub mod impact;
mod kind;
pub mod margin;
pub mod origin;
mod pair;
mod parts;
mod quantity;
mod reason;
mod remark;
pub mod report;
mod scope;
mod shrink;
mod spread;
mod statement;
pub mod study;
mod told;
pub mod verdict;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::words;

pub use confirmation::{Confirmation, ConfirmedValue, StatedValue, Unmatched};
pub use direction::Direction;
pub use domain::{CoordinateRange, DomainResult, DomainSection, WantedPoint};
pub use finding::{Consequence, Finding, Occurrence};
pub use kind::{Kind, VerdictWords};
pub use origin::{FittedTo, ImportedOne, ImportedSide, OriginInfo};
pub use pair::PairValue;
pub use parts::{
    Beyond, Channels, Datum, GivenVerdict, InDraws, LimitNotMet, OfVehicle, OftenNotMet, RecordsOf,
    Sections, ShortZone, Subject, SuspectedFactor, VehicleValue,
};
pub use quantity::{
    Count, EdgeResult, Figures, GroupRegression, GroupResult, LimitFactor, Outside, QuantityResult,
    RegressionAt, RegressionFigure, RegressionPoint, Reported, Sample, StatisticResult,
};
pub use reason::{FindingData, OfSections, Reason, UnusedSection};
pub use remark::{OutlyingSection, Remark, SectionOffset};
pub use report::{Identification, ReportItem};
pub use scope::{OUTCOME, RecordName, Scope, StatisticName, zones};
pub use spread::{ClassSpread, Furthest, OfRecord, Spread};
pub use statement::{RemainsOf, Statement};
pub use verdict::{Outcome, Verdict, VerdictResult};

/// Version of the program that writes results.
pub const THIS: &str = env!("CARGO_PKG_VERSION");
/// The form of the files of results. Those of the first versions state none.
pub const FORMAT: u32 = 1;

/// The language of the texts in results, by ISO 639-1.
pub fn language() -> String {
    "en".into()
}

/// A result as the text of its file: indented, ending in a line break.
pub fn text(result: &impl Serialize) -> String {
    // Serialisation of plain values cannot fail.
    serde_json::to_string_pretty(result).unwrap_or_default() + "\n"
}

/// All results of a certification, in the order of the protocol and of the campaign, in the form
/// of `results.json`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Certification {
    pub fishplate: String,
    pub format: u32,
    /// Of the texts, by ISO 639-1; files of before are in English.
    #[serde(default = "language")]
    pub language: String,
    /// SHA-256 of the template of the report; `None` for that of the program.
    #[serde(default)]
    pub template: Option<String>,
    pub protocol: ProtocolInfo,
    pub campaign: CampaignInfo,
    /// The overall verdict in the words of the report.
    #[serde(rename = "verdict")]
    pub verdict_text: String,
    #[serde(rename = "verdict_data")]
    pub verdict: Verdict,
    /// The same in the protocol's own words, if it has some: `accepted`.
    #[serde(rename = "verdict_word", default, skip_serializing_if = "Option::is_none")]
    pub own_word: Option<String>,
    /// Of several outcomes that the protocol puts in order, the one that applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<String>,
    /// Note on the verdict if the simulation was changed after the comparison.
    #[serde(flatten, with = "told::verdict_note")]
    #[schemars(with = "told::NoneOrNote<Remark>")]
    pub verdict_note: Option<Remark>,
    /// Why the verdict is not "validated"; empty if it is.
    #[serde(flatten, with = "told::reasons")]
    #[schemars(with = "told::Reasons<Reason>")]
    pub reasons: Vec<Reason>,
    /// Values that the verdict rests on and that nobody confirmed.
    #[serde(default)]
    pub provisional: Vec<StatedValue>,
    /// Those that are confirmed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub confirmed: Vec<ConfirmedValue>,
    /// Every page is marked: it was to be final, and values are not confirmed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub draft: bool,
    /// What was done differently than the standard and the protocol say.
    #[serde(default)]
    pub deviations: Vec<DeviationFrom>,
    /// The verdicts with a name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub verdicts: Vec<VerdictResult>,
    /// Rules of verdicts that were judged in draws of the sections.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drawn: Vec<InDraws>,
    pub quantities: Vec<QuantityResult>,
    pub sections: Vec<SectionResult>,
    #[serde(default)]
    pub removed: Removed,
    /// Numbers of the data of the sections used, which the protocol reports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reported: Vec<Reported>,
    /// How sections were found in runs; empty if a table of sections states them.
    #[serde(rename = "found_sections", default, skip_serializing_if = "Vec::is_empty")]
    pub found: Vec<found::FoundSections>,
    /// The sections that were kept, where the protocol reduces them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<study::Reduction>,
    /// Empty if the protocol has no zones.
    pub zones: Vec<ZoneResult>,
    /// Range of each numeric section column over the used sections: the validity domain.
    pub domain: Vec<DomainRange>,
    /// Wanted operation inside and outside what the sections cover; empty if the protocol does not
    /// ask.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub application: Vec<DomainResult>,
    /// Plausibility findings, in the order of the protocol's rules and of the sections.
    pub findings: Vec<Finding>,
    /// Remarks that do not change the verdict (a short filter margin, a converted unit).
    #[serde(flatten, with = "told::notes")]
    #[schemars(with = "told::Notes<Remark>")]
    pub notes: Vec<Remark>,
    /// Plots of the most relevant sections: signals of the records, which the file names.
    #[serde(skip)]
    pub traces: Vec<Trace>,
}

/// The rules that were applied.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct ProtocolInfo {
    pub name: String,
    pub title: String,
    pub sha256: String,
    /// What differs from a shipped protocol; `None` for a shipped one.
    #[serde(default)]
    pub own: Option<OwnProtocol>,
    /// The edition of a shipped protocol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shipped_edition: Option<usize>,
    pub parameters: Vec<ParameterInfo>,
    /// Those with another value than their default, which somebody set.
    #[serde(default)]
    pub parameters_off_default: Vec<ParameterInfo>,
    /// Differences in meaning from the parent, rule by rule; empty without a parent.
    pub deviations: Vec<Deviation>,
    /// The files of the protocol: the protocol first, then its parent, and so on.
    pub files: Vec<ProtocolFile>,
    /// Standard and edition the protocol follows, if it names one.
    pub edition: Option<String>,
    pub source: Option<String>,
    pub scope: Option<String>,
    pub notes: Vec<String>,
    pub filters: Vec<FilterInfo>,
    /// Measured and simulated channels that the protocol declares.
    pub channels: Vec<ChannelInfo>,
    /// Number of nodes of the processing graph.
    pub graph_nodes: usize,
    /// Criterion of the overall verdict, in a sentence.
    pub verdict_rule: String,
    /// The overall verdict in the protocol's own words, or in those of its kind.
    pub verdict_words: VerdictWords,
    /// The processing graph drawn, one SVG text; it follows from the files.
    #[serde(skip)]
    pub graph_svg: String,
}

/// A protocol with a text that is not shipped with the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "code", rename = "own-protocol")]
pub struct OwnProtocol {
    pub extends: Option<String>,
    /// Number of rules that differ from the protocol that it extends.
    pub changed: usize,
    /// Those of them that ask for less.
    pub relaxed: Vec<String>,
    /// A shipped name that one of its texts gives itself.
    pub taken: Option<String>,
}

impl OwnProtocol {
    pub fn text(&self) -> words::Text {
        words::text(self)
    }
}

/// A file of a protocol.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct ProtocolFile {
    pub name: String,
    pub sha256: String,
    /// Name of the attachment of the report that has its text.
    pub attached: String,
    #[serde(skip)]
    pub text: String,
}

impl ProtocolFile {
    /// Name of an attached file of the protocol; number 0 is the protocol, 1 its parent, and so
    /// on. The number distinguishes files of the same name from different folders.
    pub fn attachment(at: usize, name: &str) -> String {
        let plain = |sign: char| sign.is_ascii_alphanumeric() || matches!(sign, '.' | '-' | '_');
        let plain: String = name.chars().map(|sign| if plain(sign) { sign } else { '_' }).collect();
        format!("protocol-{}-{plain}", at + 1)
    }
}

/// Something that was done differently than the standard or the protocol says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DeviationFrom {
    pub from: Departed,
    #[serde(flatten, with = "told::says")]
    #[schemars(with = "told::Says<Remark>")]
    pub what: Remark,
}

/// From what a deviation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Departed {
    Standard,
    Protocol,
}

/// A rule that differs from the parent.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Deviation {
    /// Subject of the rule: `quantity ay_max, limit std`.
    pub rule: String,
    /// Text in the parent; `None` if it is new.
    pub before: Option<String>,
    /// Text in the variant; `None` if it is removed.
    pub after: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterInfo {
    pub name: String,
    pub title: String,
    /// Value used, with its unit.
    pub value: String,
    pub default: String,
    /// `default`, `campaign` or `command line`.
    pub set_by: String,
    /// Why its default is to be confirmed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unconfirmed: Option<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct ChannelInfo {
    pub name: String,
    pub title: String,
    pub unit: String,
    /// Sign convention and other remarks.
    pub note: String,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FilterInfo {
    pub name: String,
    pub title: String,
    /// The steps in words, with numbers: `low-pass 20 Hz, Butterworth order 4, zero-phase`.
    pub steps: String,
    pub source: Option<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct CampaignInfo {
    /// Of a pool: the short names of its campaigns.
    pub name: String,
    /// The campaigns of a pool; empty where there is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub members: Vec<CampaignMember>,
    /// Every input file with its hash, in the order read.
    pub files: Vec<FileHash>,
    /// Vehicle data: first those used by the protocol, then all others.
    pub vehicle: Vec<DataItem>,
    /// Origin of the simulated records, where stated.
    pub origin: Option<OriginInfo>,
    /// Identification of the report, stated or not.
    #[serde(flatten)]
    pub report: Identification,
    /// Measured records that the table of sections does not name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside_table: Vec<String>,
    /// Other keys of campaign.yaml, in their order.
    pub facts: Vec<DataItem>,
}

/// One of several campaigns that were evaluated as one.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct CampaignMember {
    /// What it is called in results.
    pub short_name: String,
    pub name: String,
    /// Its sections, or whole records.
    pub sections: usize,
    pub origin: Option<OriginInfo>,
    #[serde(flatten)]
    pub report: Identification,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FileHash {
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
    /// The record it belongs to; `None` for the campaign's own files.
    pub record: Option<RecordOf>,
    /// How it differs from the record that an import wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changed: Option<Changed>,
}

/// A record that is not as an import wrote it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Changed {
    /// Whether the import wrote a record in this place.
    pub imported: bool,
    /// Why it was changed, as the campaign says.
    pub reason: Option<String>,
}

/// Identification of a record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RecordOf {
    /// `measurement`, `simulation` or `track`.
    pub kind: String,
    pub section: String,
    /// Where the campaign has several of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// Place of a rule in the protocol.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RulePlace {
    /// One of the names in [`ProtocolInfo::files`].
    pub file: String,
    /// Line, from 1.
    pub line: usize,
}

/// A named value of the campaign or the vehicle, as text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DataItem {
    pub name: String,
    pub value: String,
    pub unit: Option<String>,
    /// Whether a rule of the protocol uses it.
    pub used: bool,
    /// The campaign states no unit: `unit` is that of the protocol.
    pub unit_assumed: bool,
    /// Whose it is, where there are several vehicles or campaigns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct SectionResult {
    /// Which of several campaigns, and which of several vehicles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub campaign: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vehicle: Option<String>,
    /// Of a pool with the campaign: `series 2/S01`.
    pub section: String,
    /// The first section of its site; repeats have the same site.
    pub site: String,
    #[serde(with = "zones")]
    #[schemars(with = "Option<zones::InFile>")]
    pub zone: Option<String>,
    pub used: bool,
    #[serde(flatten, with = "told::reason")]
    #[schemars(with = "told::NoneOrReason<Reason>")]
    pub reason: Option<Reason>,
    /// Length in `axis_unit`.
    pub length: f64,
    pub start: f64,
    pub end: f64,
    pub axis_unit: String,
    /// Columns of sections.csv that the protocol declares: title, value, unit.
    pub columns: Vec<DataItem>,
    pub checks: Vec<CheckResult>,
}

impl SectionResult {
    /// Whether it is not used for what was asked, and not for what its data are.
    pub fn is_deselected(&self) -> bool {
        let by_protocol =
            |check: &CheckResult| check.name == SELECTION && check.holds == Some(false);
        !self.used
            && (self.checks.iter().any(by_protocol)
                || self.reason.as_ref().is_some_and(Reason::is_choice))
    }
}

/// Numbers of sections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Removed {
    pub used: usize,
    /// Not used for what their data or records are.
    pub removed: usize,
    /// Of which there are records, but no row in the table of sections.
    pub left_out: usize,
}

impl Removed {
    pub fn of(sections: &[SectionResult], outside_table: &[String]) -> Self {
        let count = |is: fn(&&SectionResult) -> bool| sections.iter().filter(is).count();
        Self {
            used: count(|section| section.used),
            removed: count(|section| !section.used && !section.is_deselected()),
            left_out: outside_table.len(),
        }
    }
}

/// Name of the check by which the protocol selects sections.
pub const SELECTION: &str = "selection";

/// One requirement on a section.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct CheckResult {
    pub name: String,
    pub title: String,
    /// `None`: could not be checked; the reason is in `says`.
    pub holds: Option<bool>,
    /// Why it holds or not.
    #[serde(flatten, with = "told::says")]
    #[schemars(with = "told::Says<Reason>")]
    pub says: Reason,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct ZoneResult {
    #[serde(with = "zones")]
    #[schemars(with = "zones::InFile")]
    pub zone: String,
    pub title: String,
    /// The zone's condition in words.
    pub condition: String,
    /// Number of sections used.
    pub used: usize,
    /// Number of their sites; repeats do not count twice.
    pub sites: usize,
    pub given: usize,
    pub minimum: usize,
    pub holds: bool,
}

impl ZoneResult {
    /// Why the zone has too few sections.
    pub fn lack(&self) -> Option<Reason> {
        (!self.holds).then(|| Reason::ZoneTooSmall {
            zone: self.zone.clone(),
            used: self.used,
            sites: self.sites,
            minimum: self.minimum,
        })
    }
}

/// Range of a numeric section column over the sections used.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct DomainRange {
    pub name: String,
    pub unit: String,
    #[serde(flatten)]
    pub scope: Scope,
    pub low: f64,
    pub high: f64,
    /// Number of sections with a value.
    pub count: usize,
}

/// Simulated and measured signal of one section, filtered as specified for the quantity, thinned
/// for plotting.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
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
    /// The evaluated section on the axis; of a loop the range of the measurement, without bounds
    /// where there is none.
    #[serde(deserialize_with = "unbounded_below")]
    pub start: f64,
    #[serde(deserialize_with = "unbounded_above")]
    pub end: f64,
    pub measured: Curve,
    pub simulated: Curve,
    /// Of several records that are compared with each other: the name of the one above, and all
    /// others.
    pub record: Option<String>,
    pub others: Vec<(String, Curve)>,
}

/// JSON has no infinity: an empty range reaches from the one to the other.
fn unbounded_below<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

fn unbounded_above<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NEG_INFINITY))
}

#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Curve {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
}
