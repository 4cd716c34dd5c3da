//! Writes a simulated campaign.

use super::origin::Made;
use crate::data::origin::{ORIGIN_FILE, ORIGIN_KEY};
use crate::data::record::Format;
use crate::data::write::{Entry, Outputs, campaign_yaml};
use crate::data::{Campaign, RecordKind};
use crate::problem::Problem;

/// Keys of `campaign.yaml` that are not copied.
const OWN: [&str; 4] = ["name", "simulation", "simulation_ran_on", ORIGIN_KEY];

/// Writes a copy of a campaign with other simulated records. All other files are copied, and an origin is added; none for temporary copies.
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
        outputs.add(&format!("simulation/{}.{}", name.as_ref(), format.ending()), &bytes)?;
    }
    let copied = campaign.other_files(RecordKind::Simulation)?;
    let mut name = campaign.name.clone();
    let mut origin = None;
    if let Some(made) = made {
        let whole = made.origin(campaign, &copied)?;
        // The name contains only effects that are still in the new simulation.
        name.clone_from(&whole.campaign);
        if !whole.effects.is_empty() {
            name = format!("{name}, with {}", whole.effects_in_words(" "));
        }
        origin = Some(whole);
    }
    let entries = campaign.tree.entries().iter().filter(|(key, _)| !OWN.contains(&key.text.as_str()));
    let mut lines: Vec<(&str, Entry<'_>)> = vec![("name", Entry::Text(&name))];
    lines.extend(entries.map(|(key, node)| (key.text.as_str(), Entry::Node(node))));
    lines.push(("simulation", Entry::Text("simulation")));
    lines.push(("simulation_ran_on", Entry::Text("measured track")));
    if let Some(origin) = &origin {
        lines.push((ORIGIN_KEY, Entry::Text(ORIGIN_FILE)));
        outputs.add(ORIGIN_FILE, origin.text().as_bytes())?;
    }
    outputs.add("campaign.yaml", campaign_yaml(&lines).as_bytes())?;
    for (inside, bytes) in copied.iter().filter(|(inside, _)| inside != ORIGIN_FILE) {
        outputs.add(inside, bytes)?;
    }
    Ok(())
}
