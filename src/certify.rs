//! Certification: from a protocol and a campaign to the results of a report.

mod about;
mod again;
mod deviations;
mod opened;
mod origin;

use crate::check::{
    self, Overrides, diff,
    family::Family,
    plan::{DatumKind, Parameter, Plan, Scalar, SetBy},
};
use crate::data::{
    Campaigns,
    hash::{Hasher, sha256},
};
use crate::graph::{self, Graph};
use crate::problem::{Problems, error};
use crate::result::{
    CampaignInfo, Certification, ChannelInfo, DataItem, FORMAT, FileHash, FilterInfo, Finding,
    FindingData, Kind, OriginInfo, ParameterInfo, ProtocolFile, ProtocolInfo, Remark, Removed,
    THIS, language,
};
use crate::run::{self, Outcome, Progress, Settings};
use crate::syntax::document::Block;

pub use about::About;
pub use again::{Rules, Setting, again, confirmations};
pub use opened::{Opened, Set, overrides};
pub use origin::taken_names;

/// A checked and compiled protocol.
#[derive(Debug)]
pub struct Compiled {
    pub family: Family,
    pub plan: Plan,
    pub graph: Graph,
}

impl Compiled {
    /// The same protocol with findings as notes only, so that a diagnosis includes every section.
    pub fn only_telling(&self) -> Self {
        Self {
            family: self.family.clone(),
            plan: self.plan.only_telling(),
            graph: self.graph.clone(),
        }
    }

    /// The text of a section column as one of the words that the protocol declares for it, or a
    /// message; `None` if the protocol declares no words.
    pub fn word(&self, column: &str, text: &str) -> Option<Result<String, String>> {
        let datum = self.plan.columns.iter().find(|datum| datum.key == column)?;
        match (&datum.kind, &datum.default) {
            (DatumKind::Words(_), Some(Scalar::Word(word))) if text.is_empty() => {
                Some(Ok(word.clone()))
            }
            (DatumKind::Words(_), _) => {
                Some(run::scalar(&datum.kind, text).map(|known| match known {
                    Scalar::Word(word) => word,
                    Scalar::Number(_) | Scalar::Flag(_) => text.to_string(),
                }))
            }
            _ => None,
        }
    }
}

/// Checks and compiles a protocol with overridden parameters.
pub fn compile(family: Family, overrides: &Overrides, problems: &mut Problems) -> Option<Compiled> {
    let plan = check::check(&family, overrides, problems)?;
    if plan.quantities.is_empty() {
        let head = family.merged.blocks.iter().find(|block| block.kind.text == "protocol")?;
        let says = "the protocol has no quantity, so nothing would be compared";
        problems.push(error("no-quantity", says, head).help(
            "protocols use a text without quantities for its rules: write `uses` in their head",
        ));
        return None;
    }
    let graph = graph::from_plan(&plan);
    Some(Compiled { family, plan, graph })
}

/// Evaluates a compiled protocol on a campaign, or on several as one.
///
/// # Errors
/// The campaign is not usable as a whole; see [`run::run`].
pub fn certify<'a>(
    compiled: &Compiled,
    campaigns: impl Into<Campaigns<'a>>,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<Certification, Problems> {
    let campaigns = campaigns.into();
    let outcome = run::run(&compiled.plan, &compiled.graph, campaigns, settings, progress)?;
    let about = About::of(&compiled.plan, campaigns, outcome.vehicle.clone());
    Ok(certification(compiled, &about, outcome))
}

/// The result of a run with the descriptions of protocol and campaign.
pub fn certification(compiled: &Compiled, about: &About, outcome: Outcome) -> Certification {
    let campaign = about.info(outcome.files);
    let judged = outcome.judged;
    let protocol = protocol_info(compiled);
    let values = &compiled.plan.values;
    let mut notes: Vec<Remark> = values.not_counted.clone();
    notes.extend(outcome.notes);
    notes.extend(
        campaign.origin.as_ref().map(|origin| Remark::Origin { says: origin.says.clone() }),
    );
    let mut findings = outcome.findings;
    if !campaign.outside_table.is_empty() {
        let sections = campaign.outside_table.clone();
        findings.push(Finding::note("not-in-table", FindingData::NotInTable { sections }));
    }
    let deviations = deviations::all(&compiled.plan, &protocol, &findings, &mut notes);
    Certification {
        fishplate: THIS.into(),
        format: FORMAT,
        language: language(),
        template: None,
        verdict_text: Kind::of(&judged.quantities).verdict_words(judged.verdict).into(),
        verdict: judged.verdict,
        own_word: judged.own_word,
        outcome: judged.outcome,
        verdict_note: campaign.origin.as_ref().and_then(OriginInfo::note),
        removed: Removed::of(&outcome.sections, &campaign.outside_table),
        campaign,
        reasons: judged.reasons,
        provisional: values.provisional.clone(),
        confirmed: values.confirmed.clone(),
        draft: false,
        deviations,
        verdicts: judged.verdicts,
        drawn: judged.drawn,
        quantities: judged.quantities,
        sections: outcome.sections,
        reported: judged.reported,
        found: Vec::new(),
        reduction: outcome.reduction,
        zones: judged.zones,
        domain: outcome.domain,
        application: outcome.application,
        traces: outcome.traces,
        findings,
        protocol,
        notes,
    }
}

/// The campaign as printed in a report; `vehicle` are the data that the protocol reads.
pub fn campaign_info<'a>(
    plan: &Plan,
    campaigns: impl Into<Campaigns<'a>>,
    records: Vec<FileHash>,
    vehicle: Vec<DataItem>,
) -> CampaignInfo {
    About::of(plan, campaigns, vehicle).info(records)
}

/// The protocol as printed in a report.
pub fn protocol_info(compiled: &Compiled) -> ProtocolInfo {
    let Compiled { family, plan, graph } = compiled;
    let files: Vec<ProtocolFile> = family
        .sources
        .iter()
        .enumerate()
        .map(|(at, source)| ProtocolFile {
            attached: ProtocolFile::attachment(at, &source.file_name()),
            name: source.file_name(),
            sha256: sha256(source.text.as_bytes()),
            text: source.text.clone(),
        })
        .collect();
    let mut all = Hasher::default();
    family.sources.iter().for_each(|source| all.add(source.text.as_bytes()));
    ProtocolInfo {
        name: plan.name.clone(),
        title: plan.title.clone(),
        edition: plan.edition.clone(),
        source: plan.source.clone(),
        scope: plan.scope.clone(),
        notes: plan.notes.clone(),
        sha256: all.finish(),
        own: origin::own(family),
        shipped_edition: origin::shipped_edition(family),
        files,
        deviations: family
            .parent()
            .map_or_else(Vec::new, |parent| diff::diff(parent, &family.merged)),
        parameters: plan.parameters.iter().map(parameter_info).collect(),
        parameters_off_default: plan
            .parameters
            .iter()
            .filter(|one| one.set_by != SetBy::Default && one.value != one.default)
            .map(parameter_info)
            .collect(),
        filters: plan
            .filters
            .iter()
            .map(|filter| FilterInfo {
                name: filter.name.clone(),
                title: filter.title.clone(),
                steps: filter
                    .steps
                    .iter()
                    .map(|step| step.words.as_str())
                    .collect::<Vec<_>>()
                    .join(", then "),
                source: filter.source.clone(),
            })
            .collect(),
        channels: family
            .merged
            .blocks
            .iter()
            .filter(|block| block.kind.text == "channel")
            .map(channel_info)
            .collect(),
        graph_nodes: graph.nodes.len(),
        graph_svg: graph::svg(graph),
        verdict_rule: verdict_rule(plan),
        verdict_words: plan.verdict_words(),
    }
}

/// `requirements met when every limit holds`; of a verdict with a name, after its title.
fn verdict_rule(plan: &Plan) -> String {
    let rule = plan.overall();
    match (&rule.name, rule.criterion.strip_prefix(&rule.words[0])) {
        (Some(_), _) => format!("{}: {}", rule.title, rule.criterion),
        (None, Some(rest)) => format!("{}{rest}", plan.verdict_words().good),
        (None, None) => rule.criterion.clone(),
    }
}

fn channel_info(block: &Block) -> ChannelInfo {
    let notes: Vec<&str> =
        block.fields_named("note").map(|field| field.value.text.as_str()).collect();
    ChannelInfo {
        name: block.name_text().to_string(),
        title: block.title.as_ref().map_or_else(String::new, |title| title.text.clone()),
        unit: block.field("in").map_or_else(String::new, |field| field.value.text.clone()),
        note: notes.join(" "),
    }
}

fn parameter_info(parameter: &Parameter) -> ParameterInfo {
    let set_by = match parameter.set_by {
        SetBy::Default => "default",
        SetBy::Campaign => "campaign",
        SetBy::CommandLine => "command line",
    };
    ParameterInfo {
        name: parameter.name.clone(),
        title: parameter.title.clone(),
        value: parameter.value.clone(),
        default: parameter.default.clone(),
        set_by: set_by.into(),
        unconfirmed: parameter.unconfirmed.clone(),
    }
}
