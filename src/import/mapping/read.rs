//! Reads a mapping and reports every fault with its place.

use std::sync::Arc;

use super::sections::NAME;
use super::{Mapping, Paths, Sections, Side, convention, runs, sections, side, slips};
use crate::data::RecordKind;
use crate::problem::{Problem, Problems, error};
use crate::source::{Source, Span, Spanned};
use crate::yaml::{self, Entries, Key, Metres, Node, OneOrMore, Reader, fields};

fields! {
    /// A mapping as it is written.
    struct Written: "a mapping" {
        "name" name: Option<Spanned<String>> => "the name of the campaign",
        "protocol" protocol: Option<Spanned<String>>,
        "campaign" campaign: Entries<Node>,
        "sections" sections: Option<Node>,
        "runs" runs: Option<Node>,
        "vehicle" vehicle: Option<Spanned<String>>,
        "track" track: Option<Spanned<String>>,
        "copy" copies: OneOrMore<Spanned<String>>,
        "margin" margin: Option<Metres>,
        "turning" turning: Option<Node>,
        "measurement" measurement: Option<Node>,
        "simulation" simulation: Option<Node>,
    }
}

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

/// Reads a mapping, the table of sections and the vehicle file.
///
/// Problems: those of `yaml::load` and of `Table::parse`; `open-place`, `unknown-key`,
/// `key-missing`, `wrong-kind`, `unknown-unit`, `unit-missing`, `unit-mismatch`, `mapped-twice`,
/// `unknown-section`, `unknown-placeholder`, `unknown-column`, `out-of-range`, `path-outside`.
pub fn read(source: &Arc<Source>, paths: Paths, problems: &mut Problems) -> Option<Mapping> {
    let before = problems.errors();
    let tree = loaded(source, problems)?;
    let tree = slips::decimal_commas(tree, problems);
    open_places(&tree, problems)?;
    let mut reader = Reader { with: (), problems };
    let written: Written = reader.file(&tree)?;
    check_campaign(&written.campaign.0, &mut reader);
    let vehicle = written.vehicle.and_then(|written| {
        let (text, _) = reader.keep(paths.read_text(&written))?;
        Some((written, yaml::load(&text, reader.problems)?))
    });
    let (runs, sections) = match written.runs {
        Some(_) => runs::read(&mut reader, &tree).unzip(),
        None => (None, sections::read(&mut reader, &tree, &paths)),
    };
    let turning = convention::turning(&mut reader, &tree, &paths);
    let known = sections.clone().unwrap_or_else(|| Sections::none(source));
    let track = written.track.map(|mut track| {
        if !track.value.contains('{') {
            let word = if tree.get("runs").is_some() { "run" } else { NAME };
            track.value = format!("{}/{{{word}}}.csv", track.value.trim_end_matches('/'));
        }
        track
    });
    let mut reader = Reader { with: &known, problems };
    if let Some(track) = &track {
        sections::check_placeholders(&mut reader, track);
    }
    let sides: Vec<Side> = [RecordKind::Measurement, RecordKind::Simulation]
        .into_iter()
        .filter_map(|kind| side::read(&mut reader, kind, &tree))
        .collect();
    if written.measurement.is_none() && written.simulation.is_none() {
        let says = "the mapping has neither `measurement` nor `simulation`";
        reader.tell(
            error("key-missing", says, &source.span(0..0))
                .help("state where the records of a side are: `files`"),
        );
    }
    let mapping = Mapping {
        source: Arc::clone(source),
        paths,
        name: written.name?,
        protocol: written.protocol,
        campaign: written.campaign.0,
        sections: sections?,
        runs,
        vehicle,
        copies: written.copies.0,
        track,
        margin: written.margin.map(|margin| margin.0),
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
        problems.push(problem.help_if(quotes));
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
            problems.push(error("key-missing", says, at).help(help));
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
                    error("turning-incomplete", says, &map.name.span).also(at, "turned here"),
                );
            }
        }
    }
}

/// A draft marks what is to be decided by `?`; `None` if there is such a place.
fn open_places(node: &Node, problems: &mut Problems) -> Option<()> {
    let before = problems.errors();
    let tell = |text: &str, at: &Span, help: &str, problems: &mut Problems| {
        if !text.is_empty() && text.trim_matches('?').trim().is_empty() {
            let problem = Problem::error("open-place", "this place of the draft is open");
            problems.push(problem.at(at).help(help));
        }
    };
    let help = "decide it, or remove the line; the comments beside it say what was found";
    tell(node.scalar_text().unwrap_or_default(), &node.span, help, problems);
    for item in node.items() {
        open_places(item, problems);
    }
    for (key, value) in node.entries() {
        let help = "write the name of the channel, or remove the line";
        tell(&key.text, &key.span, help, problems);
        open_places(value, problems);
    }
    (problems.errors() == before).then_some(())
}

/// Further keys of campaign.yaml are not those that the import writes itself.
fn check_campaign(entries: &[(Key, Node)], reader: &mut Reader<'_>) {
    for (key, _) in entries.iter().filter(|(key, _)| OWN.contains(&key.text.as_str())) {
        let says = format!("`{}` of the campaign is written by the import", key.text);
        let help = if Written::KEYS.contains(&key.text.as_str()) {
            format!("`{}` stands at the left margin of the mapping", key.text)
        } else {
            "remove it".into()
        };
        reader.tell(error("unknown-key", says, &key.span).help(help));
    }
}
