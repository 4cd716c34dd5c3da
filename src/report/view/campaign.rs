//! Data of the campaign and of its vehicles.

use indexmap::IndexSet;

use crate::report::{document::*, number};
use crate::result::{CampaignInfo, CampaignMember, DataItem};

/// Items from which on a table of short ones stands in two halves, and letters of a short one.
const ABREAST: usize = 30;
const SHORT: usize = 60;
/// Items on the cover.
const ON_COVER: usize = 8;

/// The campaign, and its vehicles with the data that a rule uses first.
pub fn chapter(campaign: &CampaignInfo) -> Chapter {
    let tables = [
        ("Campaign", facts(campaign)),
        ("Vehicle data used by the protocol", vehicle(campaign, true)),
        ("Other vehicle data, as given", vehicle(campaign, false)),
    ];
    let known = tables.into_iter().filter(|(_, items)| !items.is_empty());
    let mut blocks: Vec<Block> =
        known.map(|(caption, items)| table(caption, &items).into()).collect();
    if blocks.is_empty() {
        blocks.push(Block::text("No vehicle data were given."));
    }
    Chapter::new("vehicle", "Vehicle and campaign", blocks)
}

/// A named value as printed.
#[derive(Clone, Debug)]
pub struct Item {
    name: String,
    value: String,
    unit: String,
}

impl Item {
    fn with_unit(&self) -> String {
        match self.unit.as_str() {
            "" | number::NONE => self.value.clone(),
            unit => format!("{}\u{a0}{unit}", self.value),
        }
    }
}

/// The first of some items, for the cover.
pub fn on_cover(items: &[Item]) -> Vec<Fact> {
    items.iter().take(ON_COVER).map(|item| Fact::new(&item.name, item.with_unit())).collect()
}

fn table(caption: &str, items: &[Item]) -> Table {
    let row = |item: &Item| {
        let (value, unit) = (Cell::text(&item.value), Cell::text(&item.unit));
        cells![Cell::text(&item.name), Cell::text(item.with_unit()), value, unit]
    };
    let brief = items.iter().all(|item| item.name.len() + item.value.len() < SHORT);
    let abreast = brief && items.len() > ABREAST;
    let table = Table::new(caption)
        .text("Name")
        .wide(1.0)
        .breaks(if abreast { 16 } else { 40 })
        .text("Value")
        .wide(if abreast { 0.8 } else { 1.6 })
        .only(Medium::Paper)
        .text("Value")
        .only(Medium::Screen)
        .short("Unit")
        .only(Medium::Screen)
        .rows(items.iter().map(row))
        .class("sortable data");
    if abreast { table.abreast(ABREAST) } else { table }
}

/// Facts of the campaign; of several, first what they are.
pub fn facts(campaign: &CampaignInfo) -> Vec<Item> {
    campaign.members.iter().map(member).chain(campaign.facts.iter().map(item)).collect()
}

/// Data of the vehicle, those that a rule uses or all others. What several vehicles have alike is
/// one item, what differs an item for each, together.
pub fn vehicle(campaign: &CampaignInfo, used: bool) -> Vec<Item> {
    let items: Vec<&DataItem> = campaign.vehicle.iter().filter(|item| item.used == used).collect();
    let vehicles: IndexSet<&str> =
        campaign.vehicle.iter().filter_map(|item| item.of.as_deref()).collect();
    let mut done: IndexSet<&str> = IndexSet::new();
    let mut all = Vec::new();
    for one in items.iter().filter(|item| item.of.is_none() || done.insert(&item.name)) {
        let same: Vec<&&DataItem> = items.iter().filter(|other| other.name == one.name).collect();
        let data = |item: &DataItem| (item.value.clone(), item.unit.clone(), item.unit_assumed);
        let alike = one.of.is_none()
            || same.len() == vehicles.len() && same.iter().all(|other| data(other) == data(one));
        if alike {
            all.push(item(&DataItem { of: None, ..(*one).clone() }));
        } else {
            all.extend(same.iter().map(|one| item(one)));
        }
    }
    all
}

fn item(item: &DataItem) -> Item {
    let unit = item.unit.as_deref().map(number::unit).unwrap_or_default();
    let name = item.of.as_ref().map(|vehicle| format!("{} ({vehicle})", item.name));
    Item {
        name: name.unwrap_or_else(|| item.name.clone()),
        value: number::in_text(&item.value),
        unit: unit + if item.unit_assumed { " (unit assumed)" } else { "" },
    }
}

/// One of several campaigns.
fn member(member: &CampaignMember) -> Item {
    let sections = format!("{} sections", member.sections);
    let full = format!("{}; {sections}", member.name);
    Item {
        name: format!("Campaign {}", member.short_name),
        value: if member.name == member.short_name { sections } else { full },
        unit: String::new(),
    }
}
