//! The campaign as a report prints it. Everything but the records is known before any record is
//! read.

use serde::{Deserialize, Serialize};

use super::pool;
use crate::check::plan::Plan;
use crate::data::campaign::Fact;
use crate::data::identification::Stated;
use crate::data::origin::{ImportedRecord, Origin};
use crate::data::{Campaigns, qualified};
use crate::result::{
    CampaignInfo, CampaignMember, DataItem, FileHash, FittedTo, Identification, ImportedOne,
    ImportedSide, OriginInfo, ReportItem,
};
use crate::yaml::{Node, Value};

/// The campaigns of a run without their records, and the vehicle data.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct About {
    members: Vec<Member>,
    vehicle: Vec<DataItem>,
}

/// One campaign.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Member {
    short_name: String,
    name: String,
    sections: usize,
    /// Its own files; of several campaigns, each with its campaign.
    files: Vec<FileHash>,
    origin: Option<Origin>,
    facts: Vec<DataItem>,
    report: Vec<ReportItem>,
}

impl About {
    /// `vehicle` are the data that the protocol reads.
    pub fn of<'a>(
        plan: &Plan,
        campaigns: impl Into<Campaigns<'a>>,
        vehicle: Vec<DataItem>,
    ) -> Self {
        let campaigns = campaigns.into();
        let mut members = Vec::new();
        for (number, campaign) in campaigns.iter().enumerate() {
            let file = |file: &crate::data::campaign::ReadFile| FileHash {
                path: qualified(campaigns.name_of(number), &file.path),
                sha256: file.sha256.clone(),
                bytes: file.bytes,
                record: None,
            };
            members.push(Member {
                short_name: campaign.short_name.value.clone(),
                name: campaign.name.clone(),
                sections: campaign.names.len(),
                files: campaign.files.iter().map(file).collect(),
                origin: campaign.origin.clone(),
                facts: campaign.facts.iter().map(fact_item).collect(),
                report: campaign.report.iter().map(report_item).collect(),
            });
        }
        Self { members, vehicle: vehicles(plan, campaigns, &vehicle) }
    }

    /// The name of the campaign, or of each of several.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.members.iter().map(|member| {
            if self.members.len() == 1 { member.name.as_str() } else { member.short_name.as_str() }
        })
    }

    /// The files of the campaigns beside their records.
    pub fn files(&self) -> impl Iterator<Item = &FileHash> {
        self.members.iter().flat_map(|member| &member.files)
    }

    /// With all files read, the records last, and the vehicle data, those used by the protocol
    /// first.
    pub fn info(&self, records: Vec<FileHash>) -> CampaignInfo {
        let files: Vec<FileHash> = self.files().cloned().chain(records).collect();
        let origin =
            |member: &Member| member.origin.as_ref().map(|origin| origin_info(origin, &files));
        if let [only] = self.members.as_slice() {
            return CampaignInfo {
                name: only.name.clone(),
                members: Vec::new(),
                origin: origin(only),
                files,
                vehicle: self.vehicle.clone(),
                facts: only.facts.clone(),
                report: Identification(only.report.clone()),
            };
        }
        let member = |member: &Member| CampaignMember {
            short_name: member.short_name.clone(),
            name: member.name.clone(),
            sections: member.sections,
            origin: origin(member),
            report: Identification(member.report.clone()),
        };
        let members: Vec<CampaignMember> = self.members.iter().map(member).collect();
        let of = |member: &Member| {
            let short_name = || Some(member.short_name.clone());
            member.facts.iter().map(|fact| DataItem { of: short_name(), ..fact.clone() }).collect()
        };
        CampaignInfo {
            name: pool::name(&members),
            origin: pool::origin(&members),
            files,
            vehicle: self.vehicle.clone(),
            facts: pool::facts(self.members.iter().map(of)),
            report: Identification(pool::report(&members)),
            members,
        }
    }
}

/// The origin of the simulated records, compared with the files of this run.
fn origin_info(origin: &Origin, files: &[FileHash]) -> OriginInfo {
    let these = origin
        .fitted_to
        .iter()
        .filter(|fitted| files.iter().any(|file| file.sha256 == fitted.sha256))
        .count();
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
        (all, these) => {
            format!(", fitted to {all} measured records, {these} of which are the same")
        }
    };
    let imported = imported(origin);
    let only_imported =
        !imported.is_empty() && origin.effects.is_empty() && origin.fitted_to.is_empty();
    let says = if only_imported {
        let files = origin.sources.len();
        format!(
            "The records were imported from {files} files of other systems by {}; see How the records were made",
            origin.program
        )
    } else {
        format!(
            "The simulated records were written by {made_by}, {effects}{fitted} (origin of the campaign)"
        )
    };
    OriginInfo {
        says,
        imported,
        made_by,
        effects: origin.effects.iter().map(|effect| effect.in_words(" = ")).collect(),
        fitted_to: origin
            .fitted_to
            .iter()
            .map(|file| FittedTo { path: file.path.clone(), sha256: file.sha256.clone() })
            .collect(),
        fitted_to_these: these,
    }
}

/// How imported records were made, by side.
fn imported(origin: &Origin) -> Vec<ImportedSide> {
    let Some(imported) = &origin.imported else { return Vec::new() };
    let record = |record: &ImportedRecord| ImportedOne {
        section: record.section.clone(),
        file: record.file.clone(),
        sha256: origin
            .sources
            .iter()
            .find(|source| source.path == record.file)
            .map_or_else(String::new, |source| source.sha256.clone()),
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
    let name = if fact.group.is_empty() {
        plain
    } else {
        format!("{}: {plain}", fact.group.replace('_', " "))
    };
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
fn vehicle_items(
    plan: &Plan,
    vehicle: &Node,
    used: Vec<DataItem>,
    of: Option<String>,
) -> Vec<DataItem> {
    let mut rest = Vec::new();
    flatten("", vehicle, &mut rest);
    rest.iter_mut().for_each(|item| item.of.clone_from(&of));
    let unused =
        rest.into_iter().filter(|item| !plan.vehicle.iter().any(|datum| datum.key == item.name));
    used.into_iter().chain(unused).collect()
}

fn flatten(prefix: &str, node: &Node, items: &mut Vec<DataItem>) {
    match &node.value {
        Value::Map(entries) => {
            for (key, value) in entries {
                let name = if prefix.is_empty() {
                    key.text.clone()
                } else {
                    format!("{prefix}.{}", key.text)
                };
                flatten(&name, value, items);
            }
        }
        Value::List(list) => {
            let value = list.iter().map(|item| item.raw.as_str()).collect::<Vec<_>>().join(", ");
            items.push(DataItem {
                name: prefix.to_string(),
                value,
                unit: None,
                used: false,
                unit_assumed: false,
                of: None,
            });
        }
        _ => {
            let (value, unit) = number_and_unit(&node.raw);
            items.push(DataItem {
                name: prefix.to_string(),
                value,
                unit,
                used: false,
                unit_assumed: false,
                of: None,
            });
        }
    }
}

/// `9.5 m` in its parts; any other text is a value as it is.
fn number_and_unit(text: &str) -> (String, Option<String>) {
    match text.split_once(' ') {
        Some((number, unit)) if number.parse::<f64>().is_ok_and(f64::is_finite) => {
            (number.to_string(), Some(unit.trim().to_string()))
        }
        _ => (text.to_string(), None),
    }
}
