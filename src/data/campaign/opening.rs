//! What `campaign.yaml` says of the layout of the folder.

use std::sync::Arc;

use super::runs::Runs;
use super::{Parameter, ReadFile, VehicleState};
use crate::data::folder::{Folder, Place};
use crate::data::identification::Report;
use crate::data::members::Folders;
use crate::data::origin::Origin;
use crate::data::table::Table;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span, Spanned};
use crate::yaml::{self, FromNode, Key, Node, Reader, Value, fields};

/// The column of the section table that names the sections; without it, the first column does.
const SECTION_KEY: &str = "section";

/// The column of that table that names the points of operation.
pub const POINT_KEY: &str = "point";

/// The keys of `campaign.yaml` that are no facts.
pub(in crate::data) const LAYOUT: &[&str] = Layout::KEYS;

/// The folder of a campaign that is being opened, and what was read in it so far.
#[derive(Debug)]
pub struct Opening<'a> {
    pub(in crate::data) folder: Folder,
    pub(in crate::data) files: Vec<ReadFile>,
    /// The whole of `campaign.yaml`.
    pub(in crate::data) tree: Option<&'a Node>,
}

fields! {
    /// The keys of `campaign.yaml` that say how the folder is laid out; all others are facts.
    pub(super) struct Layout in Opening<'_>: "a campaign" or Free {
        "name" name: Option<Spanned<String>> => "what the campaign is called",
        "short name" short_name: Option<Spanned<String>>,
        "vehicle" vehicles: Vehicles = Vehicles::default(),
        "sections" sections: Option<SectionTable>,
        /// The table of wanted operation.
        "application" application: Option<Application>,
        "measurement" measurement: Folders = Folders::default(),
        "simulation" simulation: Folders = Folders::default(),
        "track" track: Folders = Folders::default(),
        "runs" runs: Runs = Runs::default(),
        "protocol" protocol: Option<Spanned<String>>,
        "parameters" parameters: Parameters = Parameters::default(),
        "origin" origin: Option<OriginStated>,
        "report" report: Report = Report::default(),
    }
}

impl Reader<'_, Opening<'_>> {
    /// The tree of a YAML file. `named`: where the file is named, if it is.
    pub(super) fn yaml(
        &mut self,
        place: &Place,
        named: Option<&Span>,
    ) -> Option<(Arc<Source>, Node)> {
        let read = self.with.folder.read_text(place).map_err(|problem| match named {
            Some(span) => problem.or_at(span),
            None => problem,
        });
        let (source, sha256, bytes) = self.keep(read)?;
        self.with.files.push(ReadFile { path: place.inside.clone(), sha256, bytes });
        let tree = yaml::load(&source, self.problems)?;
        Some((source, tree))
    }

    /// The place of a file that `campaign.yaml` names.
    fn place(&mut self, written: &Spanned<String>) -> Option<Place> {
        let place = self.with.folder.place(&written.value, &written.span);
        self.keep(place)
    }

    /// The tree of a YAML file that `campaign.yaml` names.
    fn named_yaml(&mut self, key: &Key, node: &Node) -> Option<Node> {
        let written = Spanned::from_node(self, key, node)?;
        let place = self.place(&written)?;
        Some(self.yaml(&place, Some(&written.span))?.1)
    }

    fn table(&mut self, key: &Key, node: &Node, names: Option<&str>) -> Option<Table> {
        let written = Spanned::from_node(self, key, node)?;
        let place = self.place(&written)?;
        let mut found = Problems::default();
        let read = self.with.folder.read_text(&place).map_err(|problem| found.push(problem)).ok();
        let table = read.and_then(|(source, sha256, bytes)| {
            Some((Table::parse(source, sha256, names, &mut found)?, bytes))
        });
        for problem in found.0 {
            self.problems.push(problem.or_at(&written.span));
        }
        let (table, bytes) = table?;
        self.with.files.push(ReadFile { path: place.inside, sha256: table.sha256.clone(), bytes });
        Some(table)
    }
}

/// The vehicle file, or one for each state.
#[derive(Clone, Debug, Default)]
pub(super) struct Vehicles(pub Vec<VehicleState>);

impl FromNode<Opening<'_>> for Vehicles {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        let Value::Map(states) = &node.value else {
            let data = vehicle(reader, key, node)?;
            return Some(Self(vec![VehicleState { state: None, data }]));
        };
        if states.is_empty() {
            let problem = Problem::error("wrong-kind", "`vehicle` names no file").at(&node.span);
            reader.tell(problem.help("`vehicle: vehicle.yaml`, or a file for each state: `vehicle: {tare: tare.yaml, laden: laden.yaml}`"));
        }
        let mut found = Vec::new();
        for (state, file) in states {
            let data = vehicle(reader, state, file);
            let state = Some(state.text.trim().to_string());
            found.extend(data.map(|data| VehicleState { state, data }));
        }
        Some(Self(found))
    }
}

/// A file of comments only is a vehicle without data; what needs some says so.
fn vehicle(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Node> {
    let vehicle = reader.named_yaml(key, node)?;
    if matches!(vehicle.value, Value::Map(_) | Value::Null) {
        return Some(vehicle);
    }
    reader.tell(vehicle.is_not("a vehicle", "a map of keys and values"));
    None
}

/// The table of sections.
#[derive(Clone, Debug)]
pub(super) struct SectionTable(pub Table);

impl FromNode<Opening<'_>> for SectionTable {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        reader.table(key, node, Some(SECTION_KEY)).map(Self)
    }
}

/// The table of wanted operation.
#[derive(Clone, Debug)]
pub(super) struct Application(pub Table);

impl FromNode<Opening<'_>> for Application {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        // No other column has names: of two equal speeds in the first one, the second would be a
        // fault.
        reader.table(key, node, None)?.named_by(POINT_KEY, reader.problems).map(Self)
    }
}

/// A file with the origin, or what stands in `campaign.yaml` itself.
#[derive(Clone, Debug)]
pub(super) struct OriginStated(pub Origin);

impl FromNode<Opening<'_>> for OriginStated {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        if matches!(node.value, Value::Map(_)) {
            return Origin::from_node(reader, key, node).map(Self);
        }
        let tree = reader.named_yaml(key, node)?;
        reader.file(&tree).map(Self)
    }
}

/// Values of the protocol's parameters.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters(pub Vec<Parameter>);

impl FromNode<Opening<'_>> for Parameters {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, _: &Key, node: &Node) -> Option<Self> {
        if !matches!(node.value, Value::Map(_) | Value::Null) {
            reader.tell(node.is_not("`parameters`", "a map of names and values"));
        }
        for (key, value) in node.entries() {
            // What the campaign lacks was meant, whatever the protocol calls its parameters.
            let campaign_key = MEANT.contains(&key.text.as_str());
            if campaign_key && reader.with.tree.is_none_or(|tree| tree.get(&key.text).is_none()) {
                let says = format!("`{}` stands among the parameters of the protocol", key.text);
                let problem = Problem::error("unknown-key", says).at(&key.span);
                reader.tell(problem.help(at_the_margin(&key.text)));
            } else if value.scalar_text().is_none() {
                let what = format!("the parameter `{}`", key.text);
                reader.tell(value.is_not(&what, "a single value"));
            }
        }
        let entries = node.entries().iter().cloned();
        Some(Self(entries.map(|(name, value)| Parameter { name, value }).collect()))
    }
}

/// Keys of the campaign that are taken for parameters where they are indented below them.
const MEANT: [&str; 7] =
    ["vehicle", "sections", "application", "protocol", "measurement", "simulation", "track"];

/// Help for a key of the campaign that was indented into a block.
pub(in crate::data) fn at_the_margin(key: &str) -> String {
    format!("`{key}` is a key of the campaign: it stands at the left margin")
}
