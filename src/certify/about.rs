//! The campaign as a report prints it, and what the campaigns of a pool have in common. Everything but
//! the records is known before any record is read.

use serde::{Deserialize, Serialize};

use crate::check::plan::Plan;
use crate::data::{
    Campaigns,
    campaign::{Fact, ReadFile},
    identification::Stated,
    origin::{ImportedRecord, Origin},
    qualified,
};
use crate::result::{
    CampaignInfo, CampaignMember, DataItem, FileHash, FittedTo, Identification, ImportedOne,
    ImportedSide, OriginInfo, ReportItem,
};
use crate::run::file_hash;
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
    /// Measured records that its table of sections does not name.
    #[serde(default)]
    outside_table: Vec<String>,
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
            let file = |file: &ReadFile| file_hash(file, campaigns.name_of(number), None);
            members.push(Member {
                short_name: campaign.short_name.value.clone(),
                name: campaign.name.clone(),
                sections: campaign.names.len(),
                files: campaign.files.iter().map(file).collect(),
                origin: campaign.origin.clone(),
                facts: campaign.facts.iter().map(fact_item).collect(),
                report: campaign.report.iter().map(report_item).collect(),
                outside_table: campaign.outside_table(),
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
                outside_table: only.outside_table.clone(),
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
        let outside = |member: &Member| -> Vec<String> {
            let name = |inside: &String| qualified(Some(&member.short_name), inside);
            member.outside_table.iter().map(name).collect()
        };
        let of = |member: &Member| {
            let short_name = || Some(member.short_name.clone());
            member.facts.iter().map(|fact| DataItem { of: short_name(), ..fact.clone() }).collect()
        };
        CampaignInfo {
            name: pool_name(&members),
            origin: pool_origin(&members),
            files,
            vehicle: self.vehicle.clone(),
            facts: pool_facts(self.members.iter().map(of)),
            report: Identification(pool_report(&members)),
            outside_table: self.members.iter().flat_map(outside).collect(),
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
    let parts = [origin.program.0.as_str(), origin.command.0.as_str()];
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
            origin.program.0
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
    let side = |(side, channels): (&String, &Vec<String>)| ImportedSide {
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
        ..DataItem::default()
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
    let (value, unit) = match &node.value {
        Value::Map(entries) => {
            for (key, value) in entries {
                let name = match prefix {
                    "" => key.text.clone(),
                    prefix => format!("{prefix}.{}", key.text),
                };
                flatten(&name, value, items);
            }
            return;
        }
        Value::List(list) => {
            (list.iter().map(|item| item.raw.as_str()).collect::<Vec<_>>().join(", "), None)
        }
        _ => number_and_unit(&node.raw),
    };
    items.push(DataItem { name: prefix.to_string(), value, unit, ..DataItem::default() });
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

/// Campaigns that the name of a pool lists before it counts them.
const NAMED: usize = 4;

/// `series 1 + series 2`
fn pool_name(members: &[CampaignMember]) -> String {
    let names: Vec<&str> = members.iter().map(|member| member.short_name.as_str()).collect();
    if names.len() <= NAMED {
        return names.join(" + ");
    }
    format!("{} + {} more campaigns", names[..NAMED - 1].join(" + "), names.len() - NAMED + 1)
}

/// Items that identify the one report, which none of the campaigns can state for all.
const OF_ONE_REPORT: [&[&str]; 3] = [&["number"], &["revision"], &["dates", "issue"]];

/// What all state alike once, anything else with the campaign that states it.
fn pool_report(members: &[CampaignMember]) -> Vec<ReportItem> {
    let Some(first) = members.first() else { return Vec::new() };
    let one = |(at, item): (usize, &ReportItem)| {
        let values: Vec<(&str, Option<&str>)> = members
            .iter()
            .map(|member| {
                (
                    member.short_name.as_str(),
                    member.report.get(at).and_then(|item| item.value.as_deref()),
                )
            })
            .collect();
        let alike = values.iter().all(|(_, value)| *value == item.value.as_deref());
        let of_report = OF_ONE_REPORT.iter().any(|path| item.path == *path);
        let stated: Vec<String> = values
            .iter()
            .filter_map(|(of, value)| value.map(|value| format!("{of}: {value}")))
            .filter(|_| !of_report)
            .collect();
        let value = if alike {
            item.value.clone()
        } else {
            Some(stated.join("; ")).filter(|text| !text.is_empty())
        };
        ReportItem { value, ..item.clone() }
    };
    first.report.iter().enumerate().map(one).collect()
}

/// The origins of all simulations as one.
fn pool_origin(members: &[CampaignMember]) -> Option<OriginInfo> {
    let stated: Vec<(&str, &OriginInfo)> = members
        .iter()
        .filter_map(|member| Some((member.short_name.as_str(), member.origin.as_ref()?)))
        .collect();
    if stated.is_empty() {
        return None;
    }
    let join = |texts: &mut dyn Iterator<Item = String>| texts.collect::<Vec<_>>().join("; ");
    Some(OriginInfo {
        made_by: join(&mut stated.iter().map(|(of, origin)| format!("{of}: {}", origin.made_by))),
        says: join(&mut stated.iter().map(|(of, origin)| format!("{of}: {}", origin.says))),
        effects: stated
            .iter()
            .flat_map(|(of, origin)| {
                origin.effects.iter().map(move |effect| format!("{effect} ({of})"))
            })
            .collect(),
        fitted_to: stated
            .iter()
            .flat_map(|(_, origin)| &origin.fitted_to)
            .cloned()
            .collect::<Vec<FittedTo>>(),
        fitted_to_these: stated.iter().map(|(_, origin)| origin.fitted_to_these).sum(),
        imported: stated
            .iter()
            .flat_map(|(of, origin)| {
                origin.imported.iter().map(move |side| ImportedSide {
                    side: format!("{of}, {}", side.side),
                    ..side.clone()
                })
            })
            .collect(),
    })
}

/// Facts that all campaigns state alike once, the others with their campaign.
fn pool_facts(of_campaigns: impl Iterator<Item = Vec<DataItem>>) -> Vec<DataItem> {
    let all: Vec<Vec<DataItem>> = of_campaigns.collect();
    let same =
        |a: &DataItem, b: &DataItem| (&a.name, &a.value, &a.unit) == (&b.name, &b.value, &b.unit);
    let common =
        |item: &DataItem| all.iter().all(|facts| facts.iter().any(|other| same(item, other)));
    let mut found: Vec<DataItem> = Vec::new();
    for item in all.iter().flatten() {
        let item = if common(item) { DataItem { of: None, ..item.clone() } } else { item.clone() };
        if !found.contains(&item) {
            found.push(item);
        }
    }
    found
}
