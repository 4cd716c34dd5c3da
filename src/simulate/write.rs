//! Writes a simulated campaign.

use std::sync::Arc;

use super::{campaign::frame, origin::Made};
use crate::data::{
    Campaign, RecordKind,
    campaign::{CAMPAIGN_FILE, Memory},
    origin::{ORIGIN_FILE, ORIGIN_KEY},
    record::Format,
    write::{Entry, Outputs, campaign_yaml, campaign_yaml_with},
};
use crate::effects::Signals;
use crate::problem::{Problem, Problems};
use crate::units::Unit;

/// The folder of the simulated records.
const FOLDER: &str = "simulation";
/// Keys of `campaign.yaml` that are not copied.
const OWN: [&str; 4] = ["name", "simulation", "simulation_ran_on", ORIGIN_KEY];

/// A campaign whose simulated records are these, by section; nothing is written.
///
/// # Errors
/// A value is not finite; problems of opening a campaign.
pub fn with_records<'a>(
    campaign: &Campaign,
    records: impl Iterator<Item = (&'a str, &'a Signals)>,
    units: &dyn Fn(&str) -> Unit,
) -> Result<Campaign, Problems> {
    let mut memory = Memory::default();
    for (section, signals) in records {
        let name = format!("{FOLDER}/{section}");
        let frame = frame(&name, signals, units)?;
        memory.records.insert(name, Arc::new(frame));
    }
    memory
        .texts
        .insert(CAMPAIGN_FILE.to_string(), text_of(campaign, &campaign.name, false).into_bytes());
    let mut problems = Problems::default();
    campaign.replaced(memory, &mut problems).ok_or(problems)
}

/// `campaign.yaml` of a campaign with other simulated records.
fn text_of(campaign: &Campaign, name: &str, origin: bool) -> String {
    let mut new = vec![
        ("simulation", Entry::Text(FOLDER)),
        ("simulation_ran_on", Entry::Text("measured track")),
    ];
    new.extend(origin.then_some((ORIGIN_KEY, Entry::Text(ORIGIN_FILE))));
    campaign_yaml(&[("name", Entry::Text(name))]) + &campaign_yaml_with(&campaign.tree, &OWN, &new)
}

/// Writes a copy of a campaign with other simulated records. All other files are copied, and an
/// origin is added; none for temporary copies.
///
/// # Errors
/// Of reading the campaign, or of writing; no file is in its place before [`Outputs::commit`].
pub fn write_campaign(
    outputs: &mut Outputs,
    campaign: &Campaign,
    (format, records): (Format, impl Iterator<Item = (impl AsRef<str>, Vec<u8>)>),
    made: Option<&Made<'_>>,
) -> Result<(), Problem> {
    for (name, bytes) in records {
        outputs.add(&format!("{FOLDER}/{}.{}", name.as_ref(), format.ending()), &bytes)?;
    }
    let copied = campaign.other_files(&[RecordKind::Simulation])?;
    let mut name = campaign.name.clone();
    let mut origin = None;
    if let Some(made) = made {
        let whole = made.origin(campaign, &copied)?;
        // The name contains only effects that are still in the new simulation.
        name.clone_from(&whole.campaign.0);
        if !whole.effects.is_empty() {
            name = format!("{name}, with {}", whole.effects_in_words(" "));
        }
        origin = Some(whole);
    }
    if let Some(origin) = &origin {
        outputs.add(ORIGIN_FILE, origin.text().as_bytes())?;
    }
    outputs.add(CAMPAIGN_FILE, text_of(campaign, &name, origin.is_some()).as_bytes())?;
    for (inside, bytes) in copied.iter().filter(|(inside, _)| inside != ORIGIN_FILE) {
        outputs.add(inside, bytes)?;
    }
    Ok(())
}
