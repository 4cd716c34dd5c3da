//! A simulated campaign as a folder.

use crate::data::write::{Entry, Outputs, campaign_yaml};
use crate::data::{Campaign, RecordKind};
use crate::problem::Problem;

/// A campaign like another, with other simulated records. Everything that the other has is copied beside them.
///
/// # Errors
/// Of reading the other, and of writing; nothing is in its place before [`Outputs::commit`].
pub fn write_campaign(
    outputs: &mut Outputs,
    campaign: &Campaign,
    records: impl Iterator<Item = (impl AsRef<str>, String)>,
) -> Result<(), Problem> {
    for (name, text) in records {
        outputs.add(&format!("simulation/{}.csv", name.as_ref()), text.as_bytes())?;
    }
    let entries = campaign.tree.entries().iter().filter(|(key, _)| !["simulation", "simulation_ran_on"].contains(&key.text.as_str()));
    let mut lines: Vec<(&str, Entry<'_>)> = entries.map(|(key, node)| (key.text.as_str(), Entry::Node(node))).collect();
    lines.push(("simulation", Entry::Text("simulation")));
    lines.push(("simulation_ran_on", Entry::Text("measured track")));
    outputs.add("campaign.yaml", campaign_yaml(&lines).as_bytes())?;
    for (inside, bytes) in campaign.other_files(RecordKind::Simulation)? {
        outputs.add(&inside, &bytes)?;
    }
    Ok(())
}
