//! What `campaign.yaml` says of the layout of the folder.

use super::{
    Parameter, VehicleState,
    confirmed::Confirmed,
    members::{RecordFolder, record_folders},
    opening::{Opening, Reader},
    runs::{Run, runs},
    uncertainty::{Uncertainty, uncertainties},
};
use crate::data::{
    identification::at_the_margin,
    origin::Origin,
    prelude::*,
    table::{Table, not_portable},
};

/// The column of the section table that names the sections; without it, the first column does.
const SECTION_KEY: &str = "section";

/// The column of that table that names the points of operation.
pub const POINT_KEY: &str = "point";

fields! {
    /// The keys of `campaign.yaml` that say how the folder is laid out; all others are facts.
    pub struct Layout in Opening<'_>: "a campaign" or Free {
        "name" name: Option<Spanned<String>> => "what the campaign is called",
        "short name" short_name: Option<Spanned<String>>,
        "vehicle" vehicles (vehicles): Option<Vec<VehicleState>>,
        "sections" sections (sections): Option<Table>,
        /// The table of wanted operation.
        "application" application (application): Option<Table>,
        "measurement" measurement (record_folders): Option<Vec<RecordFolder>>,
        "simulation" simulation (record_folders): Option<Vec<RecordFolder>>,
        "track" track (record_folders): Option<Vec<RecordFolder>>,
        "runs" runs (runs): Option<Vec<Run>>,
        "protocol" protocol: Option<Spanned<String>>,
        "parameters" parameters (parameters): Option<Vec<Parameter>>,
        "confirmed" confirmed: Option<Vec<Confirmed>>,
        /// Of the channels.
        "uncertainty" uncertainties (uncertainties): Option<Vec<Uncertainty>>,
        "origin" origin (origin): Option<Origin>,
        /// Records that were changed after an import.
        "edited" edited: Vec<Edited>,
        "report" report: Option<Node>,
    }
}

fields! {
    /// A record that was changed after an import, and why.
    pub struct Edited in Opening<'_>: "an edited record" {
        "record" record: Spanned<String>,
        "reason" reason: String,
    }
}

/// The vehicle file, or one for each state.
fn vehicles(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Vec<VehicleState>> {
    let Value::Map(states) = &node.value else {
        let data = vehicle(reader, key, node)?;
        return Some(vec![VehicleState { state: None, data }]);
    };
    if states.is_empty() {
        let problem = error("wrong-kind", "`vehicle` names no file", &node.span);
        reader.tell(problem.help("`vehicle: vehicle.yaml`, or a file for each state: `vehicle: {tare: tare.yaml, laden: laden.yaml}`"));
    }
    let of_state = |(state, file): &(Key, Node)| {
        let data = vehicle(reader, state, file)?;
        Some(VehicleState { state: Some(state.text.trim().to_string()), data })
    };
    Some(states.iter().filter_map(of_state).collect())
}

/// A file of comments only is a vehicle without data; what needs some says so.
fn vehicle(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Node> {
    let vehicle = reader.named_yaml(key, node)?;
    if matches!(vehicle.value, Value::Map(_) | Value::Null) {
        return Some(vehicle);
    }
    reader.tell(vehicle.is_not("a vehicle", "a map of keys and values"));
    None
}

/// The table of sections.
fn sections(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Table> {
    let table = reader.table(key, node, Some(SECTION_KEY))?;
    not_portable(&table, reader.problems);
    Some(table)
}

/// The table of wanted operation. No other column has names: of two equal speeds in the first one,
/// the second would be a fault.
fn application(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Table> {
    reader.table(key, node, None)?.named_by(POINT_KEY, reader.problems)
}

/// A file with the origin, or what stands in `campaign.yaml` itself.
fn origin(reader: &mut Reader<'_, '_>, key: &Key, node: &Node) -> Option<Origin> {
    if matches!(node.value, Value::Map(_)) {
        return Origin::from_node(reader, key, node);
    }
    let tree = reader.named_yaml(key, node)?;
    reader.file(&tree)
}

/// Values of the protocol's parameters.
fn parameters(reader: &mut Reader<'_, '_>, _: &Key, node: &Node) -> Option<Vec<Parameter>> {
    if !matches!(node.value, Value::Map(_) | Value::Null) {
        reader.tell(node.is_not("`parameters`", "a map of names and values"));
    }
    for (key, value) in node.entries() {
        // What the campaign lacks was meant, whatever the protocol calls its parameters.
        let campaign_key = MEANT.contains(&key.text.as_str());
        if campaign_key && reader.with.tree.is_none_or(|tree| tree.get(&key.text).is_none()) {
            let problem = problem!(
                "unknown-key",
                &key.span,
                "`{}` stands among the parameters of the protocol",
                key.text
            );
            reader.tell(problem.help(at_the_margin(&key.text)));
        } else if value.scalar_text().is_none() {
            let what = format!("the parameter `{}`", key.text);
            reader.tell(value.is_not(&what, "a single value"));
        }
    }
    let entries = node.entries().iter().cloned();
    Some(entries.map(|(name, value)| Parameter { name, value }).collect())
}

/// Keys of the campaign that are taken for parameters where they are indented below them.
const MEANT: [&str; 7] =
    ["vehicle", "sections", "application", "protocol", "measurement", "simulation", "track"];
