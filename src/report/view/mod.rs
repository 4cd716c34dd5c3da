//! The result of a certification, ready to print: numbers rounded, lists sorted, sentences
//! formulated.
//!
//! PDF and HTML are filled from the same [`ReportData`]; the templates do not calculate. Names and
//! texts of users are passed on unchanged: escaping is the task of the template.

pub mod application;
mod brief;
mod finding;
mod groups;
mod identity;
mod made;
mod notation;
mod protocol;
mod quantity;
mod reports;
mod search;
mod section;
mod spread;
mod summary;
mod verdicts;
mod wording;

use indexmap::IndexSet;
use serde::Serialize;

use crate::report::brief::in_full;
use crate::report::sides::{self, capital};
use crate::report::{estimates, findings, number};
use crate::result::{
    CampaignInfo, CampaignMember, Certification, DataItem, Kind, QuantityResult, Trace, Verdict,
};

pub use brief::{BriefCell, BriefRow, BriefTable, BriefView};
pub use finding::Finding;
pub use groups::{EstimateRow, GroupRow, GroupTable};
pub use identity::{IdentityRow, ReportHead};
pub use made::{MadeRow, MadeView};
pub use notation::{ChannelRow, NotationView, SymbolRow, Term};
pub use protocol::{ProtocolView, SourceFile, view as protocol_view};
pub use quantity::{QuantityView, StatisticView, ValueBlock, ValueRow, WorstPair};
pub use reports::{ReportRow, ReportTable};
pub use search::{ReductionView, SearchView};
pub use section::{CheckTable, ColumnHead, DomainView, SectionRow, SectionTable, ZoneView};
pub use spread::{SpreadClass, SpreadRow, SpreadTable};
pub use summary::{FurtherRow, Limited, SummaryRow};
pub use verdicts::VerdictRow;
pub use wording::Wording;

/// Number of reasons on the cover; the summary lists all.
const REASONS_ON_COVER: usize = 8;

/// All data of a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportData {
    /// Title of the document: `Validation report: <campaign>`, or of what else the protocol is
    /// about.
    pub title: String,
    /// Program and version that wrote the report.
    pub program: String,
    pub words: Wording,
    pub verdict: Finding,
    /// Title of the overall verdict, if it has a name.
    pub verdict_title: Option<String>,
    /// The verdicts with a name.
    pub verdicts: Vec<VerdictRow>,
    /// A note on the verdict.
    pub verdict_note: Option<String>,
    /// The statement for signature by the person responsible for the simulation.
    pub simulation_statement: Option<String>,
    /// The same of the person responsible for the measurement.
    pub measurement_statement: Option<&'static str>,
    /// The verdict as a sentence.
    pub verdict_sentence: String,
    /// Why the model is not validated or not assessable.
    pub reasons: Vec<String>,
    /// The first reasons, for the cover.
    pub cover_reasons: Vec<String>,
    /// Reference to the other reasons, if any.
    pub more_reasons: Option<String>,
    /// The items that an assessor expects in a report, stated or not.
    pub identity: Vec<IdentityRow>,
    /// Symbols of the quantities, which are printed with subscripts.
    pub symbols: Vec<String>,
    pub notation: NotationView,
    /// Short facts for the cover: name and value.
    pub key_facts: Vec<Fact>,
    pub campaign: CampaignView,
    pub protocol: ProtocolView,
    /// Quantities judged by mean and standard deviation over all pairs, one row each, as in EN
    /// 14363.
    pub summary: Vec<SummaryRow>,
    /// All other statistics, one row each.
    pub further: Vec<FurtherRow>,
    /// Estimates of assessed quantities and estimates by group, one row for each limit.
    pub estimates: Vec<EstimateRow>,
    /// Figure of the normalised statistics of all quantities; `None` if there are none.
    pub overview: Option<FigureView>,
    /// In place of a chapter for each of many quantities.
    pub brief: Option<BriefView>,
    /// Quantities with a chapter: all, or of many those that do not meet their limits.
    pub quantities: Vec<QuantityView>,
    /// How sections were found in runs.
    pub searches: Vec<SearchView>,
    pub reduction: Option<ReductionView>,
    pub zones: Vec<ZoneView>,
    /// Numbers of the data of the sections.
    pub reported: Vec<ReportTable>,
    /// Sections by zone, in the order of the zones; sections without a zone last.
    pub section_tables: Vec<SectionTable>,
    pub traces: Vec<TraceView>,
    pub domain: Vec<DomainView>,
    pub domain_figure: Option<FigureView>,
    /// Wanted operation inside and outside what the sections cover.
    pub application: Vec<application::ApplicationView>,
    /// Plausibility findings.
    pub findings: Vec<findings::Row>,
    /// Remarks that do not change the verdict.
    pub notes: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    pub name: String,
    pub value: String,
}

/// A figure: its name, its caption, and a text alternative.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FigureView {
    /// `overview`, `domain`, `application-<index of the domain>`, `graph`, `pairs-<index of the
    /// quantity>`, `trace-<index of the trace>`; indices from 0.
    pub name: String,
    pub caption: String,
    pub alt: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CampaignView {
    pub name: String,
    pub report: ReportHead,
    pub facts: Vec<DataRow>,
    /// Origin of the simulated records, as a sentence.
    pub origin: Option<String>,
    /// How imported records were made, by side.
    pub made: Vec<MadeView>,
    /// Data of the vehicle used by a rule.
    pub vehicle_used: Vec<DataRow>,
    /// Other data of the vehicle.
    pub vehicle_other: Vec<DataRow>,
    pub files: Vec<FileView>,
    /// Total size of the files in bytes, as printed.
    pub bytes: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DataRow {
    pub name: String,
    pub value: String,
    pub unit: String,
    /// The value is a number: aligned to the right.
    pub numeric: bool,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FileView {
    pub path: String,
    pub sha256: String,
    pub bytes: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TraceView {
    pub figure: FigureView,
    pub quantity: String,
    pub section: String,
    pub signal: String,
    pub why: String,
}

/// The certification as printed in both reports.
pub fn view(found: &Certification) -> ReportData {
    let verdict_holds = match found.verdict {
        Verdict::Validated => Some(true),
        Verdict::NotValidated => Some(false),
        Verdict::NotAssessable => None,
    };
    let work = found.protocol.source.as_deref();
    let with_chapter = in_full(&found.quantities).into_iter();
    let quantities: Vec<QuantityView> =
        with_chapter.map(|at| quantity::view(at, &found.quantities[at], work)).collect();
    let (summary, further) = summary::tables(&found.quantities);
    let reasons = verdicts::reasons(found);
    ReportData {
        title: title(found),
        program: concat!("Fishplate ", env!("CARGO_PKG_VERSION")).to_owned(),
        words: wording::wording(found),
        verdict: match verdicts::overall(found) {
            Some(outcome) => verdicts::finding(outcome, found.verdict_word()),
            None => Finding::new(verdict_holds, found.verdict_word(), found.verdict_word(), found.verdict_word()),
        },
        verdict_title: verdicts::title(found),
        verdicts: verdicts::rows(found),
        verdict_note: found.verdict_note.clone(),
        simulation_statement: wording::simulation_statement(found),
        measurement_statement: wording::measurement_statement(found),
        verdict_sentence: wording::sentence(found).to_owned(),
        cover_reasons: reasons.iter().take(REASONS_ON_COVER).cloned().collect(),
        more_reasons: more_reasons(reasons.len()),
        reasons,
        identity: identity::checklist(found),
        symbols: found.quantities.iter().map(|quantity| symbol(&quantity.symbol)).collect(),
        notation: notation::view(found),
        key_facts: key_facts(found),
        campaign: campaign(&found.campaign),
        protocol: protocol::view(&found.protocol),
        summary,
        further,
        estimates: found.quantities.iter().flat_map(groups::rows).collect(),
        overview: overview(found),
        brief: brief::view(&found.quantities, work),
        quantities,
        searches: search::searches(found),
        reduction: search::reduction(found),
        zones: section::zones(found),
        reported: reports::tables(&found.reported),
        section_tables: section::tables(found),
        traces: traces(found),
        domain: section::domain(found),
        domain_figure: (!found.domain.is_empty()).then(|| FigureView {
            name: "domain".into(),
            caption: format!("{}: range of the conditions over the sections used", wording::wording(found).domain),
            alt: format!(
                "Range of {} conditions over the sections used; the numbers are in the table of this chapter.",
                found.domain.len()
            ),
        }),
        application: application::views(found),
        findings: findings::rows(&found.findings),
        notes: found.notes.iter().map(|note| number::raised(note)).collect(),
    }
}

fn title(found: &Certification) -> String {
    format!("{}: {}", wording::wording(found).report, found.campaign.name)
}

/// Replaces the id of a quantity at the start of a sentence by its symbol.
fn in_symbols(reason: &str, found: &Certification) -> String {
    let of = reason.split_once(": ").and_then(|(id, says)| {
        Some((found.quantities.iter().find(|quantity| quantity.id == id)?, says))
    });
    of.map_or_else(
        || reason.to_owned(),
        |(quantity, says)| format!("{}: {says}", symbol(&quantity.symbol)),
    )
}

fn more_reasons(count: usize) -> Option<String> {
    (count > REASONS_ON_COVER).then(|| format!("All {count} reasons are listed in the summary."))
}

fn key_facts(found: &Certification) -> Vec<Fact> {
    let used = found.sections.iter().filter(|section| section.used).count();
    let deciding: Vec<&QuantityResult> =
        found.quantities.iter().filter(|quantity| !quantity.decides_nothing()).collect();
    let holding = deciding.iter().filter(|quantity| quantity.holds == Some(true)).count();
    let failing = deciding.iter().filter(|quantity| quantity.holds == Some(false)).count();
    let open = deciding.len() - holding - failing;
    let mut quantities = format!("{holding} of {} met", deciding.len());
    if failing > 0 {
        quantities.push_str(&format!(", {failing} not met"));
    }
    if open > 0 {
        quantities.push_str(&format!(", {open} not assessed"));
    }
    let rows = |assessed: bool| {
        let of = found.quantities.iter().filter(|quantity| quantity.from.is_some() == assessed);
        of.map(|quantity| quantity.values.len()).sum::<usize>()
    };
    let mut facts = vec![fact("Criteria by quantity", quantities)];
    if !found.campaign.members.is_empty() {
        facts.push(fact("Campaigns", found.campaign.members.len().to_string()));
    }
    facts.push(fact("Sections", format!("{used} of {} used", found.sections.len())));
    match found.kind() {
        Kind::Validation => facts.push(fact("Compared pairs", number::count(rows(false) as u64))),
        Kind::Comparison => facts.push(fact("Compared values", number::count(rows(false) as u64))),
        Kind::Assessment => facts.push(fact("Assessed values", number::count(rows(true) as u64))),
        Kind::Mixed => {
            facts.push(fact("Compared pairs", number::count(rows(false) as u64)));
            facts.push(fact("Assessed values", number::count(rows(true) as u64)));
        }
    }
    // Of wanted operation, which the verdict does not speak of.
    let wanted = || found.application.iter().flat_map(|domain| &domain.points);
    if wanted().next().is_some() {
        let inside = wanted().filter(|point| point.inside == Some(true)).count();
        facts.push(fact(
            "Wanted operation",
            format!("{inside} of {} points inside", wanted().count()),
        ));
    }
    if !found.zones.is_empty() {
        let filled = found.zones.iter().filter(|zone| zone.holds).count();
        facts.push(fact(
            "Test zones",
            format!("{filled} of {} with enough sections", found.zones.len()),
        ));
    }
    facts
}

/// First words of a place inside a document.
const PLACES: [&str; 10] =
    ["Table", "Section", "Clause", "Annex", "Chapter", "Figure", "Equation", "Page", "p.", "§"];

/// Whether a text is only a place inside a document: `Table 1, footnote`.
fn is_place(text: &str) -> bool {
    PLACES.iter().any(|word| {
        text.strip_prefix(word).is_some_and(|rest| {
            rest.trim_start().starts_with(|c: char| c.is_ascii_digit() || c.is_ascii_uppercase())
        })
    })
}

/// The source of a rule, completed by the document that the protocol names.
fn with_work(source: &str, work: Option<&str>) -> String {
    let Some(work) = work.filter(|_| is_place(source)) else { return source.to_owned() };
    // The protocol may itself name a place of the document.
    let whole =
        work.rsplit_once(", ").filter(|(_, last)| is_place(last)).map_or(work, |(whole, _)| whole);
    format!("{whole}, {source}")
}

/// The name of a section, signal or zone, shortened for a table.
fn name(text: &str) -> String {
    cut(text, NAME)
}

/// The symbol of a quantity, shortened for a table.
fn symbol(text: &str) -> String {
    cut(text, SYMBOL)
}

/// Removes the middle of a long text, since names usually differ at their ends.
fn cut(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= most {
        return name.to_owned();
    }
    let half = most / 2;
    letters[..half].iter().chain(&['…']).chain(&letters[letters.len() - half..]).collect()
}

/// Maximum length of a printed name of a section or signal.
const NAME: usize = 80;
/// Maximum length of a printed symbol.
const SYMBOL: usize = 32;

fn fact(name: &str, value: String) -> Fact {
    Fact { name: name.to_owned(), value }
}

/// The campaign as printed.
pub fn campaign(campaign: &CampaignInfo) -> CampaignView {
    let of = |used: bool| {
        let items: Vec<&DataItem> =
            campaign.vehicle.iter().filter(|item| item.used == used).collect();
        common(
            &items,
            campaign
                .vehicle
                .iter()
                .filter_map(|item| item.of.as_deref())
                .collect::<IndexSet<_>>()
                .len(),
        )
    };
    CampaignView {
        name: campaign.name.clone(),
        report: identity::head(&campaign.report),
        facts: campaign
            .members
            .iter()
            .map(member_row)
            .chain(campaign.facts.iter().map(data_row))
            .collect(),
        origin: campaign.origin.as_ref().map(|origin| format!("{}.", origin.says)),
        made: campaign.origin.iter().flat_map(|origin| &origin.imported).map(made::view).collect(),
        vehicle_used: of(true),
        vehicle_other: of(false),
        files: campaign
            .files
            .iter()
            .map(|file| FileView {
                path: file.path.clone(),
                sha256: file.sha256.clone(),
                bytes: number::count(file.bytes),
            })
            .collect(),
        bytes: number::count(campaign.files.iter().map(|file| file.bytes).sum()),
    }
}

/// One of several campaigns.
fn member_row(member: &CampaignMember) -> DataRow {
    let sections = format!("{} sections", member.sections);
    let value = if member.name == member.short_name {
        sections
    } else {
        format!("{}; {sections}", member.name)
    };
    DataRow {
        name: format!("Campaign {}", member.short_name),
        value,
        unit: String::new(),
        numeric: false,
    }
}

/// What several vehicles have alike is one row, what differs a row for each, together.
fn common(items: &[&DataItem], vehicles: usize) -> Vec<DataRow> {
    let mut done: IndexSet<&str> = IndexSet::new();
    let mut rows = Vec::new();
    for item in items.iter().filter(|item| item.of.is_none() || done.insert(&item.name)) {
        let same: Vec<&&DataItem> = items.iter().filter(|other| other.name == item.name).collect();
        let alike = item.of.is_none()
            || same.len() == vehicles
                && same.iter().all(|other| {
                    (&other.value, &other.unit, other.unit_assumed)
                        == (&item.value, &item.unit, item.unit_assumed)
                });
        if alike {
            rows.push(data_row(&DataItem { of: None, ..(*item).clone() }));
        } else {
            rows.extend(same.iter().map(|item| data_row(item)));
        }
    }
    rows
}

fn data_row(item: &DataItem) -> DataRow {
    DataRow {
        name: item
            .of
            .as_ref()
            .map_or_else(|| item.name.clone(), |of| format!("{} ({of})", item.name)),
        value: number::in_text(&item.value),
        unit: item.unit.as_deref().map(number::unit).unwrap_or_default()
            + if item.unit_assumed { " (unit assumed)" } else { "" },
        numeric: number::is_number(&item.value),
    }
}

fn overview(found: &Certification) -> Option<FigureView> {
    let shown = found.quantities.iter().flat_map(estimates::representatives);
    let normalised: Vec<f64> = shown.filter_map(|statistic| statistic.normalised).collect();
    let by_group = found
        .quantities
        .iter()
        .any(|quantity| estimates::condensed(quantity).iter().any(estimates::OfLimit::by_group));
    let beyond = normalised.iter().filter(|value| **value > 1.0).count();
    (!normalised.is_empty()).then(|| FigureView {
        name: "overview".into(),
        caption: if by_group {
            "Estimates of all quantities divided by their limits, of each the largest of its groups; a criterion is met up to 1".into()
        } else {
            "Statistics of all quantities divided by their limits; a criterion is met up to 1".into()
        },
        alt: format!(
            "Chart of {} normalised statistics of {} quantities against the limit 1: {beyond} beyond the limit. The numbers are in the summary table.",
            normalised.len(),
            found.quantities.len()
        ),
    })
}

/// The curves of a trace in words.
fn curves(trace: &Trace, found: &Certification) -> String {
    if !trace.others.is_empty() {
        let names: Vec<&str> = trace
            .record
            .iter()
            .chain(trace.others.iter().map(|(name, _)| name))
            .map(String::as_str)
            .collect();
        return format!("Records {}:", names.join(", "));
    }
    let (simulated, measured) = sides::of_trace(trace, found);
    match (trace.simulated.y.is_empty(), trace.measured.y.is_empty()) {
        (true, false) => capital(measured),
        (false, true) => capital(simulated),
        _ => format!("{} and {measured}", capital(simulated)),
    }
}

fn traces(found: &Certification) -> Vec<TraceView> {
    found
        .traces
        .iter()
        .enumerate()
        .map(|(at, trace)| {
            let quantity = found.quantities.iter().find(|quantity| quantity.id == trace.quantity);
            let zone = trace.zone.as_ref().map(|zone| format!(", zone {zone}")).unwrap_or_default();
            TraceView {
                figure: FigureView {
                    name: format!("trace-{at}"),
                    caption: format!(
                        "{} in section {}{zone}: {}",
                        name(&trace.signal),
                        name(&trace.section),
                        trace.why
                    ),
                    alt: format!(
                        "{} {} [{}] over {} [{}], section {} from {} to {}.",
                        curves(trace, found),
                        trace.signal,
                        number::unit(&trace.unit),
                        trace.axis,
                        number::unit(&trace.axis_unit),
                        trace.section,
                        number::significant(trace.start, 6),
                        number::significant(trace.end, 6)
                    ),
                },
                quantity: quantity
                    .map_or_else(|| trace.quantity.clone(), |quantity| quantity.title.clone()),
                section: name(&trace.section),
                signal: name(&trace.signal),
                why: trace.why.clone(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_told_with_its_work() {
        let work = Some("A & B, A title, with a comma, Table 1");
        assert_eq!(with_work("Table 1", work), "A & B, A title, with a comma, Table 1");
        assert_eq!(with_work("Section 3.2", work), "A & B, A title, with a comma, Section 3.2");
        assert_eq!(with_work("Common practice", work), "Common practice");
        assert_eq!(
            (with_work("Table 1", None), with_work("Tableau", work)),
            ("Table 1".into(), "Tableau".into())
        );
        assert_eq!(with_work("Table 2", Some("ISO 1")), "ISO 1, Table 2");
    }

    #[test]
    fn long_names_keep_their_ends() {
        assert_eq!(name("S01"), "S01");
        assert_eq!(cut("abcdefghij", 4), "ab…ij");
        assert_eq!(cut("äöüß", 4), "äöüß");
    }
}
