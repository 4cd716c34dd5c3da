//! What the campaigns of a pool have in common, as a report prints it.

use crate::result::{CampaignMember, DataItem, FittedTo, ImportedSide, OriginInfo, ReportItem};

/// Campaigns that the name of a pool lists before it counts them.
const NAMED: usize = 4;

/// `series 1 + series 2`
pub(super) fn name(members: &[CampaignMember]) -> String {
    let names: Vec<&str> = members.iter().map(|member| member.short_name.as_str()).collect();
    if names.len() <= NAMED {
        return names.join(" + ");
    }
    format!("{} + {} more campaigns", names[..NAMED - 1].join(" + "), names.len() - NAMED + 1)
}

/// Items that identify the one report, which none of the campaigns can state for all.
const OF_ONE_REPORT: [&[&str]; 3] = [&["number"], &["revision"], &["dates", "issue"]];

/// What all state alike once, anything else with the campaign that states it.
pub(super) fn report(members: &[CampaignMember]) -> Vec<ReportItem> {
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
pub(super) fn origin(members: &[CampaignMember]) -> Option<OriginInfo> {
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
pub(super) fn facts(of_campaigns: impl Iterator<Item = Vec<DataItem>>) -> Vec<DataItem> {
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
