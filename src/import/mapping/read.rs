//! Reads a mapping and reports every fault with its place.

use std::path::Path;
use std::sync::Arc;

use super::reader::{Reader, at, metre};
use super::{Mapping, Sections, convention, runs, sections, side, slips};
use crate::data::RecordKind;
use crate::data::text::read_text;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Spanned};
use crate::yaml::{self, Key, Node, Value};

const TOP: [&str; 12] = [
    "name",
    "protocol",
    "campaign",
    "sections",
    "runs",
    "vehicle",
    "track",
    "copy",
    "margin",
    "turning",
    "measurement",
    "simulation",
];
/// Keys of `campaign.yaml` that the import writes itself.
const OWN: [&str; 9] = [
    "name",
    "protocol",
    "sections",
    "runs",
    "vehicle",
    "track",
    "measurement",
    "simulation",
    "origin",
];

/// Reads a mapping, the table of sections and the vehicle file. Paths are relative to `folder`.
///
/// Problems: those of `yaml::load` and of `Table::read`; `open-place`, `unknown-key`,
/// `key-missing`, `wrong-kind`, `unknown-unit`, `unit-missing`, `unit-mismatch`, `mapped-twice`,
/// `unknown-section`, `unknown-placeholder`, `unknown-column`, `out-of-range`.
pub fn read(source: &Arc<Source>, folder: &Path, problems: &mut Problems) -> Option<Mapping> {
    let before = problems.errors();
    let tree = loaded(source, problems)?;
    let tree = slips::decimal_commas(tree, problems);
    let mut reader = Reader { problems };
    let closed = reader.problems.errors();
    open_places(&tree, reader.problems);
    if reader.problems.errors() > closed {
        return None;
    }
    reader.keys(&tree, &TOP, "a mapping");
    if reader.problems.errors() > before && !matches!(tree.value, Value::Map(_)) {
        return None;
    }
    let name = reader.need_text(&tree, "name", "the name of the campaign");
    let protocol = reader.text(&tree, "protocol");
    let campaign = campaign(&tree, &mut reader);
    let vehicle = reader.text(&tree, "vehicle").and_then(|written| {
        let path = folder.join(&written.value);
        let read = read_text(&path, &path.display().to_string())
            .map_err(|problem| reader.problems.push(at(problem, &written.span)));
        let node = yaml::load(&read.ok()?.0, reader.problems)?;
        Some((written, node))
    });
    let (runs, sections) = match tree.get("runs") {
        Some(node) => runs::read(&mut reader, &tree, node)
            .map_or((None, None), |(runs, sections)| (Some(runs), Some(sections))),
        None => (None, sections::read(&mut reader, &tree, folder)),
    };
    let turning =
        tree.get("turning").and_then(|node| convention::turning(&mut reader, node, folder));
    let margin = reader.number(&tree, "margin", &metre());
    let copies = reader.texts(&tree, "copy");
    let track = reader.text(&tree, "track").map(|written| {
        if written.value.contains('{') {
            written
        } else {
            let word = if tree.get("runs").is_some() { "run" } else { "section" };
            Spanned::new(
                format!("{}/{{{word}}}.csv", written.value.trim_end_matches('/')),
                written.span,
            )
        }
    });
    let known = sections.clone().unwrap_or_else(|| Sections::none(source));
    if let Some(track) = &track {
        known.check_placeholders(track, &mut reader);
    }
    let sides: Vec<_> = [RecordKind::Measurement, RecordKind::Simulation]
        .into_iter()
        .filter_map(|kind| {
            tree.entry(kind.key())
                .and_then(|(key, node)| side::read(&mut reader, kind, key, node, &known))
        })
        .collect();
    if RecordKind::ALL.iter().take(2).all(|kind| tree.get(kind.key()).is_none()) {
        let says = "the mapping has neither `measurement` nor `simulation`";
        reader.problems.push(
            Problem::error("key-missing", says)
                .at(&source.span(0..0))
                .help("state where the records of a side are: `files`"),
        );
    }
    let mapping = Mapping {
        source: Arc::clone(source),
        folder: folder.to_path_buf(),
        name: name?,
        protocol,
        campaign,
        sections: sections?,
        runs,
        vehicle,
        copies,
        track,
        margin,
        turning,
        sides,
    };
    turned(&mapping, problems);
    (problems.errors() == before).then_some(mapping)
}

/// The tree of the text. Of a value that begins with a brace and was not quoted, the help says so.
fn loaded(source: &Arc<Source>, problems: &mut Problems) -> Option<Node> {
    let mut found = Problems::default();
    let tree = yaml::load(source, &mut found);
    for problem in found.0 {
        let quotes = problem.at.as_ref().and_then(|at| slips::unquoted(source, at));
        problems.push(match quotes {
            Some(help) => problem.help(help),
            None => problem,
        });
    }
    tree
}

/// A section that is turned needs to know what is exchanged, and both channels of each exchange.
fn turned(mapping: &Mapping, problems: &mut Problems) {
    for side in &mapping.sides {
        let Some(at) = side.turned.span() else { continue };
        let Some(turning) = &mapping.turning else {
            let says = format!(
                "sections of the {} are turned, and the mapping has no `turning`",
                side.kind.key()
            );
            let help = "state which channels are exchanged: `turning: bogie-vehicle`, or `turning: {exchange: {...}, reverse sign: [...]}`";
            problems.push(Problem::error("key-missing", says).at(at).help(help));
            continue;
        };
        let Some(maps) = side.channels.maps() else { continue };
        let mapped = |name: &str| maps.iter().any(|map| map.name.value == name);
        for map in maps {
            let other = turning.partner(&map.name.value);
            if !mapped(other) {
                let says = format!(
                    "in turned sections `{}` is recorded as `{other}`, which is not mapped",
                    map.name.value
                );
                problems.push(
                    Problem::error("turning-incomplete", says)
                        .at(&map.name.span)
                        .also(at, "turned here"),
                );
            }
        }
    }
}

/// A draft marks what is to be decided by `?`.
fn open_places(node: &Node, problems: &mut Problems) {
    let open = |text: &str| !text.is_empty() && text.trim_matches('?').trim().is_empty();
    if node.scalar_text().is_some_and(open) {
        let problem =
            Problem::error("open-place", "this place of the draft is open").at(&node.span);
        problems.push(
            problem
                .help("decide it, or remove the line; the comments beside it say what was found"),
        );
    }
    node.items().iter().for_each(|item| open_places(item, problems));
    for (key, value) in node.entries() {
        if open(&key.text) {
            let problem =
                Problem::error("open-place", "this place of the draft is open").at(&key.span);
            problems.push(problem.help("write the name of the channel, or remove the line"));
        }
        open_places(value, problems);
    }
}

/// Further keys of campaign.yaml.
fn campaign(tree: &Node, reader: &mut Reader<'_>) -> Vec<(Key, Node)> {
    let Some(node) = tree.get("campaign") else { return Vec::new() };
    if !matches!(node.value, Value::Map(_)) {
        reader.fault(
            "wrong-kind",
            format!(
                "`campaign` must be a map of keys for campaign.yaml, not {}",
                node.kind_in_words()
            ),
            &node.span,
        );
    }
    for (key, _) in node.entries().iter().filter(|(key, _)| OWN.contains(&key.text.as_str())) {
        let says = format!("`{}` of the campaign is written by the import", key.text);
        let help = if TOP.contains(&key.text.as_str()) {
            format!("`{}` stands at the left margin of the mapping", key.text)
        } else {
            "remove it".into()
        };
        reader.problems.push(Problem::error("unknown-key", says).at(&key.span).help(help));
    }
    node.entries().to_vec()
}
