//! Certification: from a protocol and a campaign to the results of a report.

mod pool;

use indexmap::IndexMap;
use sha2::{Digest, Sha256};

use crate::check::plan::{DatumKind, Parameter, Plan, Scalar, SetBy};
use crate::check::{self, Overrides, diff, family::Family};
use crate::data::campaign::Fact;
use crate::data::hash::{hexadecimal, sha256};
use crate::data::identification::Stated;
use crate::data::origin::{ImportedRecord, Origin};
use crate::data::{Campaign, Campaigns, qualified};
use crate::graph::{self, Graph};
use crate::problem::Problems;
use crate::result::{
    CampaignInfo, CampaignMember, Certification, ChannelInfo, DataItem, FileHash, FilterInfo, FittedTo, ImportedOne, ImportedSide,
    OriginInfo, ParameterInfo, ProtocolFile, ProtocolInfo, ReportItem,
};
use crate::run::{self, Progress, Settings};
use crate::syntax::document::Block;
use crate::yaml::{Node, Value};

/// A checked and compiled protocol.
#[derive(Debug)]
pub struct Compiled {
    pub family: Family,
    pub plan: Plan,
    pub graph: Graph,
}

impl Compiled {
    /// The same protocol with findings as notes only, so that a diagnosis includes every section.
    #[must_use]
    pub fn only_telling(&self) -> Self {
        Self { family: self.family.clone(), plan: self.plan.only_telling(), graph: self.graph.clone() }
    }

    /// The text of a section column as one of the words that the protocol declares for it, or a message; `None` if the protocol declares no
    /// words.
    #[must_use]
    pub fn word(&self, column: &str, text: &str) -> Option<Result<String, String>> {
        let datum = self.plan.columns.iter().find(|datum| datum.key == column)?;
        match (&datum.kind, &datum.default) {
            (DatumKind::Words(_), Some(Scalar::Word(word))) if text.is_empty() => Some(Ok(word.clone())),
            (DatumKind::Words(_), _) => Some(run::scalar(&datum.kind, text).map(|known| match known {
                Scalar::Word(word) => word,
                Scalar::Number(_) | Scalar::Flag(_) => text.to_string(),
            })),
            _ => None,
        }
    }
}

/// Checks and compiles a protocol with overridden parameters.
pub fn compile(family: Family, overrides: &Overrides, problems: &mut Problems) -> Option<Compiled> {
    let plan = check::check(&family, overrides, problems)?;
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
    let campaign = campaign_info(&compiled.plan, campaigns, outcome.files, outcome.vehicle);
    let mut notes = outcome.notes;
    notes.extend(campaign.origin.as_ref().map(|origin| format!("{}.", origin.says)));
    Ok(Certification {
        protocol: protocol_info(compiled),
        verdict: outcome.verdict,
        own_word: outcome.own_word,
        verdict_note: campaign.origin.as_ref().and_then(OriginInfo::note),
        campaign,
        reasons: outcome.reasons,
        verdicts: outcome.verdicts,
        quantities: outcome.quantities,
        sections: outcome.sections,
        found: Vec::new(),
        reduction: outcome.reduction,
        zones: outcome.zones,
        domain: outcome.domain,
        application: outcome.application,
        traces: outcome.traces,
        findings: outcome.findings,
        notes: parameters_set(&compiled.plan).into_iter().chain(unconfirmed(&compiled.plan)).chain(notes).collect(),
    })
}

/// The campaign as printed in a report: all files read, with the records last, and the vehicle data, with those used by the protocol first.
pub fn campaign_info<'a>(plan: &Plan, campaigns: impl Into<Campaigns<'a>>, records: Vec<FileHash>, vehicle: Vec<DataItem>) -> CampaignInfo {
    let campaigns = campaigns.into();
    let mut files = Vec::new();
    for (number, campaign) in campaigns.iter().enumerate() {
        let path = |path: &str| qualified(campaigns.name_of(number), path);
        files.extend(campaign.files.iter().map(|file| FileHash {
            path: path(&file.path),
            sha256: file.sha256.clone(),
            bytes: file.bytes,
            record: None,
        }));
    }
    files.extend(records);
    if !campaigns.pooled() {
        let campaign = campaigns.get(0);
        return CampaignInfo {
            name: campaign.name.clone(),
            members: Vec::new(),
            origin: campaign.origin.as_ref().map(|origin| origin_info(origin, &files)),
            files,
            vehicle: vehicles(plan, campaigns, &vehicle),
            facts: campaign.facts.iter().map(fact_item).collect(),
            report: campaign.report.iter().map(report_item).collect(),
        };
    }
    let member = |campaign: &Campaign| CampaignMember {
        short_name: campaign.short_name.value.clone(),
        name: campaign.name.clone(),
        sections: campaign.names.len(),
        origin: campaign.origin.as_ref().map(|origin| origin_info(origin, &files)),
        report: campaign.report.iter().map(report_item).collect(),
    };
    let members: Vec<CampaignMember> = campaigns.iter().map(member).collect();
    CampaignInfo {
        name: pool::name(&members),
        origin: pool::origin(&members),
        files,
        vehicle: vehicles(plan, campaigns, &vehicle),
        facts: pool::facts(
            campaigns
                .iter()
                .map(|campaign| (campaign.short_name.value.as_str(), &campaign.facts))
                .map(|(of, facts)| facts.iter().map(|fact| DataItem { of: Some(of.to_string()), ..fact_item(fact) }).collect()),
        ),
        report: pool::report(&members),
        members,
    }
}

/// The origin of the simulated records, compared with the files of this run.
fn origin_info(origin: &Origin, files: &[FileHash]) -> OriginInfo {
    let these = origin.fitted_to.iter().filter(|fitted| files.iter().any(|file| file.sha256 == fitted.sha256)).count();
    let parts = [origin.program.as_str(), origin.command.as_str()];
    let made_by = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
    let effects = match origin.effects.len() {
        0 => "without effects added".to_string(),
        1 => format!("with the effect {}", origin.effects_in_words(" = ")),
        _ => format!("with the effects {}", origin.effects_in_words(" = ")),
    };
    let fitted = match (origin.fitted_to.len(), these) {
        (0, _) => String::new(),
        (all, 0) => format!(", fitted to {all} measured records of another campaign"),
        (all, these) if these == all => format!(", fitted to the same {all} measured records"),
        (all, these) => format!(", fitted to {all} measured records, {these} of which are the same"),
    };
    let imported = imported(origin);
    let only_imported = !imported.is_empty() && origin.effects.is_empty() && origin.fitted_to.is_empty();
    let says = if only_imported {
        let files = origin.sources.len();
        format!("The records were imported from {files} files of other systems by {}; see How the records were made", origin.program)
    } else {
        format!("The simulated records were written by {made_by}, {effects}{fitted} (origin of the campaign)")
    };
    OriginInfo {
        says,
        imported,
        made_by,
        effects: origin.effects.iter().map(|effect| effect.in_words(" = ")).collect(),
        fitted_to: origin.fitted_to.iter().map(|file| FittedTo { path: file.path.clone(), sha256: file.sha256.clone() }).collect(),
        fitted_to_these: these,
    }
}

/// How imported records were made, by side.
fn imported(origin: &Origin) -> Vec<ImportedSide> {
    let Some(imported) = &origin.imported else { return Vec::new() };
    let record = |record: &ImportedRecord| ImportedOne {
        section: record.section.clone(),
        file: record.file.clone(),
        sha256: origin.sources.iter().find(|source| source.path == record.file).map_or_else(String::new, |source| source.sha256.clone()),
        read_as: record.read_as.clone(),
        steps: record.steps.clone(),
    };
    let side = |(side, channels): &(String, Vec<String>)| ImportedSide {
        side: side.clone(),
        channels: channels.clone(),
        records: imported.records.iter().filter(|one| one.side == *side).map(record).collect(),
    };
    imported.channels.iter().map(side).collect()
}

/// The protocol as printed in a report.
pub fn protocol_info(compiled: &Compiled) -> ProtocolInfo {
    let Compiled { family, plan, graph } = compiled;
    let files: Vec<ProtocolFile> = family
        .sources
        .iter()
        .map(|source| ProtocolFile { name: source.file_name(), sha256: sha256(source.text.as_bytes()), text: source.text.clone() })
        .collect();
    let mut all = Sha256::new();
    for source in &family.sources {
        all.update(source.text.as_bytes());
    }
    ProtocolInfo {
        name: plan.name.clone(),
        title: plan.title.clone(),
        edition: plan.edition.clone(),
        source: plan.source.clone(),
        scope: plan.scope.clone(),
        notes: plan.notes.clone(),
        sha256: hexadecimal(&all.finalize()),
        files,
        deviations: family.parent.as_ref().map_or_else(Vec::new, |parent| diff::diff(parent, &family.merged)),
        parameters: plan.parameters.iter().map(parameter_info).collect(),
        filters: plan
            .filters
            .iter()
            .map(|filter| FilterInfo {
                name: filter.name.clone(),
                title: filter.title.clone(),
                steps: filter.steps.iter().map(|step| step.words.as_str()).collect::<Vec<_>>().join(", then "),
                source: filter.source.clone(),
            })
            .collect(),
        channels: family.merged.blocks.iter().filter(|block| block.kind.text == "channel").map(channel_info).collect(),
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
    let notes: Vec<&str> = block.fields_named("note").map(|field| field.value.text.as_str()).collect();
    ChannelInfo {
        name: block.name_text().to_string(),
        title: block.title.as_ref().map_or_else(String::new, |title| title.text.clone()),
        unit: block.field("in").map_or_else(String::new, |field| field.value.text.clone()),
        note: notes.join(" "),
    }
}

/// A note on parameters with values other than the default, since the verdict depends on them.
fn parameters_set(plan: &Plan) -> Option<String> {
    let set = |parameter: &&Parameter| parameter.set_by != SetBy::Default && parameter.value != parameter.default;
    let one = |parameter: &Parameter| {
        let info = parameter_info(parameter);
        format!("`{}` {} (default {}, set by the {})", info.name, info.value, info.default, info.set_by)
    };
    let all: Vec<String> = plan.parameters.iter().filter(set).map(one).collect();
    (!all.is_empty()).then(|| format!("Parameters not at their default: {}.", all.join("; ")))
}

/// A note for each reason why numbers are to be confirmed, with these numbers.
fn unconfirmed(plan: &Plan) -> Vec<String> {
    let of_parameter = |parameter: &Parameter| {
        let why = parameter.unconfirmed.clone()?;
        Some((format!("`{}` {}", parameter.name, parameter.value), why))
    };
    let others = plan.unconfirmed.iter().map(|(name, why)| (format!("`{name}`"), why.clone()));
    let mut by_reason: IndexMap<String, Vec<String>> = IndexMap::new();
    for (what, why) in plan.parameters.iter().filter_map(of_parameter).chain(others) {
        by_reason.entry(why).or_default().push(what);
    }
    let one = |(why, what): (&String, &Vec<String>)| format!("To be confirmed against the standard: {}. {why}", what.join(", "));
    by_reason.iter().map(one).collect()
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

fn report_item((field, value): &Stated) -> ReportItem {
    ReportItem {
        path: field.group.into_iter().chain([field.key]).map(str::to_string).collect(),
        title: field.title.into(),
        clause: field.clause.map(str::to_string),
        value: value.clone(),
    }
}

fn fact_item(fact: &Fact) -> DataItem {
    let plain = fact.name.replace('_', " ");
    let name = if fact.group.is_empty() { plain } else { format!("{}: {plain}", fact.group.replace('_', " ")) };
    DataItem {
        name,
        value: fact.text.clone(),
        unit: fact.unit.clone().filter(|unit| unit != "-"),
        used: false,
        unit_assumed: false,
        of: None,
    }
}

/// The data of every vehicle: of each campaign and each state.
fn vehicles(plan: &Plan, campaigns: Campaigns<'_>, used: &[DataItem]) -> Vec<DataItem> {
    let mut all = Vec::new();
    for (number, campaign) in campaigns.iter().enumerate() {
        for vehicle in &campaign.vehicles {
            let of = campaigns.vehicle_name(number, vehicle);
            let own = used.iter().filter(|item| item.of == of).cloned().collect();
            all.extend(vehicle_items(plan, &vehicle.data, own, of));
        }
    }
    all
}

/// Values used by the protocol with their units, then all others of the file.
fn vehicle_items(plan: &Plan, vehicle: &Node, used: Vec<DataItem>, of: Option<String>) -> Vec<DataItem> {
    let mut rest = Vec::new();
    flatten("", vehicle, &mut rest);
    rest.iter_mut().for_each(|item| item.of.clone_from(&of));
    let unused = rest.into_iter().filter(|item| !plan.vehicle.iter().any(|datum| datum.key == item.name));
    used.into_iter().chain(unused).collect()
}

fn flatten(prefix: &str, node: &Node, items: &mut Vec<DataItem>) {
    match &node.value {
        Value::Map(entries) => {
            for (key, value) in entries {
                let name = if prefix.is_empty() { key.text.clone() } else { format!("{prefix}.{}", key.text) };
                flatten(&name, value, items);
            }
        }
        Value::List(list) => {
            let value = list.iter().map(|item| item.raw.as_str()).collect::<Vec<_>>().join(", ");
            items.push(DataItem { name: prefix.to_string(), value, unit: None, used: false, unit_assumed: false, of: None });
        }
        _ => {
            let (value, unit) = number_and_unit(&node.raw);
            items.push(DataItem { name: prefix.to_string(), value, unit, used: false, unit_assumed: false, of: None });
        }
    }
}

/// `9.5 m` in its parts; any other text is a value as it is.
fn number_and_unit(text: &str) -> (String, Option<String>) {
    match text.split_once(' ') {
        Some((number, unit)) if number.parse::<f64>().is_ok_and(f64::is_finite) => (number.to_string(), Some(unit.trim().to_string())),
        _ => (text.to_string(), None),
    }
}
