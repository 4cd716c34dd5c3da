//! What `campaign.yaml` says of the layout of the folder, read key by key.

use std::sync::Arc;

use super::facts::{APPLICATION, LAYOUT};
use super::{Parameter, ReadFile, RecordKind, VehicleState};
use crate::data::folder::{Folder, Place};
use crate::data::origin::{ORIGIN_KEY, Origin};
use crate::data::table::Table;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span, Spanned};
use crate::yaml::{self, Node, Value};

/// The column of the section table that names the sections; without it, the first column does.
const SECTION_KEY: &str = "section";

/// The column of that table that names the points of operation.
pub const POINT_KEY: &str = "point";

/// A campaign that is being opened, and what was wrong with it so far.
pub(super) struct Opening<'a> {
    pub(super) folder: Folder,
    pub(super) files: Vec<ReadFile>,
    pub(super) problems: &'a mut Problems,
}

impl Opening<'_> {
    fn keep<T>(&mut self, result: Result<T, Problem>) -> Option<T> {
        result.map_err(|problem| self.problems.push(problem)).ok()
    }

    pub(super) fn yaml(
        &mut self,
        place: &Place,
        named: Option<&Span>,
    ) -> Option<(Arc<Source>, Node)> {
        let read = self.folder.read_text(place);
        let (source, sha256, bytes) =
            self.keep(read.map_err(|problem| named_at(problem, named)))?;
        self.files.push(ReadFile { path: place.inside.clone(), sha256, bytes });
        let tree = yaml::load(&source, self.problems)?;
        Some((source, tree))
    }

    /// The text of a key, if it is there; it must be a single value then.
    pub(super) fn text(&mut self, tree: &Node, key: &str) -> Option<Spanned<String>> {
        let node = tree.get(key)?;
        match node.scalar_text() {
            Some(text) if !text.trim().is_empty() => {
                Some(Spanned::new(text.to_string(), node.span.clone()))
            }
            _ => {
                let says = format!("`{key}` must be text; this is {}", node.kind_in_words());
                self.problems.push(Problem::error("wrong-kind", says).at(&node.span));
                None
            }
        }
    }

    /// A key of the layout that is one letter off would be printed as a fact and otherwise ignored.
    pub(super) fn misspelt(&mut self, tree: &Node) {
        let layout = || LAYOUT.into_iter().chain(RecordKind::ALL.into_iter().map(RecordKind::key));
        for (key, _) in tree.entries() {
            let off =
                |known: &&str| strsim::damerau_levenshtein(&key.text.to_lowercase(), known) <= 1;
            if layout().any(|known| known == key.text) {
                continue;
            }
            if let Some(near) = layout().find(off) {
                let problem =
                    Problem::error("unknown-key", format!("a campaign has no key `{}`", key.text))
                        .at(&key.span);
                self.problems.push(problem.help(format!("did you mean `{near}`?")));
            }
        }
    }

    /// The vehicle file, or one for each state.
    pub(super) fn vehicles(&mut self, tree: &Node) -> Vec<VehicleState> {
        let Some(node) = tree.get("vehicle") else { return Vec::new() };
        let Value::Map(states) = &node.value else {
            let written = self.text(tree, "vehicle");
            let data = written.and_then(|written| self.vehicle(&written));
            return data.map(|data| VehicleState { state: None, data }).into_iter().collect();
        };
        if states.is_empty() {
            let problem = Problem::error("wrong-kind", "`vehicle` names no file").at(&node.span);
            self.problems
                .push(problem.help("`vehicle: vehicle.yaml`, or a file for each state: `vehicle: {tare: tare.yaml, laden: laden.yaml}`"));
        }
        let mut found = Vec::new();
        for (state, _) in states {
            let written = self.text(node, &state.text);
            let data = written.and_then(|written| self.vehicle(&written));
            found.extend(
                data.map(|data| VehicleState { state: Some(state.text.trim().to_string()), data }),
            );
        }
        found
    }

    fn vehicle(&mut self, written: &Spanned<String>) -> Option<Node> {
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let (_, vehicle) = self.yaml(&place, Some(&written.span))?;
        // A file of comments only is a vehicle without data; what needs some says so.
        if matches!(vehicle.value, Value::Map(_) | Value::Null) {
            return Some(vehicle);
        }
        let says =
            format!("a vehicle is a map of keys and values; this is {}", vehicle.kind_in_words());
        self.problems.push(Problem::error("wrong-kind", says).at(&vehicle.span));
        None
    }

    pub(super) fn sections(&mut self, tree: &Node) -> Option<Table> {
        self.table(tree, "sections", Some(SECTION_KEY))
    }

    pub(super) fn application(&mut self, tree: &Node) -> Option<Table> {
        // No other column has names: of two equal speeds in the first one, the second would be a
        // fault.
        self.table(tree, APPLICATION, None)?.named_by(POINT_KEY, self.problems)
    }

    fn table(&mut self, tree: &Node, key: &str, names: Option<&str>) -> Option<Table> {
        let written = self.text(tree, key)?;
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let mut found = Problems::default();
        let read = self.folder.read_text(&place).map_err(|problem| found.push(problem)).ok();
        let table = read.and_then(|(source, sha256, bytes)| {
            Some((Table::parse(source, sha256, names, &mut found)?, bytes))
        });
        for problem in found.0 {
            self.problems.push(named_at(problem, Some(&written.span)));
        }
        let (table, bytes) = table?;
        self.files.push(ReadFile { path: place.inside, sha256: table.sha256.clone(), bytes });
        Some(table)
    }

    /// A file, or what stands in `campaign.yaml` itself.
    pub(super) fn origin(&mut self, tree: &Node) -> Option<Origin> {
        let node = tree.get(ORIGIN_KEY)?;
        if matches!(node.value, Value::Map(_)) {
            return Origin::read(node, self.problems);
        }
        let written = self.text(tree, ORIGIN_KEY)?;
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let (_, found) = self.yaml(&place, Some(&written.span))?;
        Origin::read(&found, self.problems)
    }

    pub(super) fn parameters(&mut self, tree: &Node) -> Vec<Parameter> {
        let Some(node) = tree.get("parameters") else { return Vec::new() };
        if !matches!(node.value, Value::Map(_) | Value::Null) {
            let says = format!(
                "`parameters` must be a map of names and values; this is {}",
                node.kind_in_words()
            );
            self.problems.push(Problem::error("wrong-kind", says).at(&node.span));
        }
        for (key, value) in node.entries() {
            // What the campaign lacks was meant, whatever the protocol calls its parameters.
            let layout = ["vehicle", "sections", APPLICATION, "protocol"]
                .into_iter()
                .chain(RecordKind::ALL.map(RecordKind::key));
            if layout.into_iter().any(|known| known == key.text) && tree.get(&key.text).is_none() {
                let says = format!("`{}` stands among the parameters of the protocol", key.text);
                let problem = Problem::error("unknown-key", says).at(&key.span);
                self.problems.push(problem.help(format!(
                    "`{}` is a key of the campaign: it stands at the left margin",
                    key.text
                )));
                continue;
            }
            if value.scalar_text().is_none() {
                let says = format!(
                    "the parameter `{}` must be a single value; this is {}",
                    key.text,
                    value.kind_in_words()
                );
                self.problems.push(Problem::error("wrong-kind", says).at(&value.span));
            }
        }
        node.entries()
            .iter()
            .map(|(name, value)| Parameter { name: name.clone(), value: value.clone() })
            .collect()
    }
}

/// A problem of a file as a whole is shown where the file is named.
fn named_at(problem: Problem, span: Option<&Span>) -> Problem {
    match span {
        Some(span) if problem.at.is_none() => problem.at(span),
        _ => problem,
    }
}
