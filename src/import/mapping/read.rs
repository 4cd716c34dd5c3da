//! Reads a mapping and reports every fault with its place.

use std::path::Path;
use std::sync::Arc;

use super::{Mapping, Sections, convention, runs, sections, side};
use crate::data::RecordKind;
use crate::data::text::read_text;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span, Spanned};
use crate::units::{Unit, number};
use crate::yaml::{self, Key, Node, Value};

const TOP: [&str; 12] =
    ["name", "protocol", "campaign", "sections", "runs", "vehicle", "track", "copy", "margin", "turning", "measurement", "simulation"];
/// Keys of `campaign.yaml` that the import writes itself.
const OWN: [&str; 9] = ["name", "protocol", "sections", "runs", "vehicle", "track", "measurement", "simulation", "origin"];

/// Reads a mapping, the table of sections and the vehicle file. Paths are relative to `folder`.
///
/// Problems: those of `yaml::load` and of `Table::read`; `open-place`, `unknown-key`, `key-missing`, `wrong-kind`, `unknown-unit`,
/// `unit-missing`, `unit-mismatch`, `mapped-twice`, `unknown-section`, `unknown-placeholder`, `unknown-column`, `out-of-range`.
pub fn read(source: &Arc<Source>, folder: &Path, problems: &mut Problems) -> Option<Mapping> {
    let before = problems.errors();
    let tree = yaml::load(source, problems)?;
    let mut reader = Reader { problems };
    reader.open_places(&tree);
    if reader.problems.errors() > before {
        return None;
    }
    reader.keys(&tree, &TOP, "a mapping");
    if reader.problems.errors() > before && !matches!(tree.value, Value::Map(_)) {
        return None;
    }
    let name = reader.need_text(&tree, "name", "the name of the campaign");
    let protocol = reader.text(&tree, "protocol");
    let campaign = reader.campaign(&tree);
    let vehicle = reader.text(&tree, "vehicle").and_then(|written| {
        let path = folder.join(&written.value);
        let read = read_text(&path, &path.display().to_string()).map_err(|problem| reader.problems.push(at(problem, &written.span)));
        let node = yaml::load(&read.ok()?.0, reader.problems)?;
        Some((written, node))
    });
    let (runs, sections) = match tree.get("runs") {
        Some(node) => runs::read(&mut reader, &tree, node).map_or((None, None), |(runs, sections)| (Some(runs), Some(sections))),
        None => (None, sections::read(&mut reader, &tree, folder)),
    };
    let turning = tree.get("turning").and_then(|node| convention::turning(&mut reader, node, folder));
    let margin = reader.number(&tree, "margin", &metre());
    let copies = reader.texts(&tree, "copy");
    let track = reader.text(&tree, "track").map(|written| {
        if written.value.contains('{') {
            written
        } else {
            let word = if tree.get("runs").is_some() { "run" } else { "section" };
            Spanned::new(format!("{}/{{{word}}}.csv", written.value.trim_end_matches('/')), written.span)
        }
    });
    let known = sections.clone().unwrap_or_else(|| Sections::none(source));
    if let Some(track) = &track {
        reader.pattern(track, &known);
    }
    let sides: Vec<_> = [RecordKind::Measurement, RecordKind::Simulation]
        .into_iter()
        .filter_map(|kind| tree.entry(kind.key()).and_then(|(key, node)| side::read(&mut reader, kind, key, node, &known)))
        .collect();
    if RecordKind::ALL.iter().take(2).all(|kind| tree.get(kind.key()).is_none()) {
        let says = "the mapping has neither `measurement` nor `simulation`";
        reader
            .problems
            .push(Problem::error("key-missing", says).at(&source.span(0..0)).help("state where the records of a side are: `files`"));
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

/// A section that is turned needs to know what is exchanged, and both channels of each exchange.
fn turned(mapping: &Mapping, problems: &mut Problems) {
    for side in &mapping.sides {
        let Some(at) = side.turned.span() else { continue };
        let Some(turning) = &mapping.turning else {
            let says = format!("sections of the {} are turned, and the mapping has no `turning`", side.kind.key());
            let help = "state which channels are exchanged: `turning: bogie-vehicle`, or `turning: {exchange: {...}, reverse sign: [...]}`";
            problems.push(Problem::error("key-missing", says).at(at).help(help));
            continue;
        };
        let Some(maps) = side.channels.maps() else { continue };
        let mapped = |name: &str| maps.iter().any(|map| map.name.value == name);
        for map in maps {
            let other = turning.partner(&map.name.value);
            if !mapped(other) {
                let says = format!("in turned sections `{}` is recorded as `{other}`, which is not mapped", map.name.value);
                problems.push(Problem::error("turning-incomplete", says).at(&map.name.span).also(at, "turned here"));
            }
        }
    }
}

pub(super) fn at(problem: Problem, span: &Span) -> Problem {
    if problem.at.is_some() { problem } else { problem.at(span) }
}

pub(super) fn metre() -> Unit {
    Unit { text: "m".into(), factor: 1.0, dimension: crate::units::Dimension::LENGTH }
}

pub(super) fn second() -> Unit {
    Unit { text: "s".into(), factor: 1.0, dimension: crate::units::Dimension::TIME }
}

pub(super) fn hertz() -> Unit {
    Unit { text: "Hz".into(), factor: 1.0, dimension: crate::units::Dimension::FREQUENCY }
}

pub(super) struct Reader<'a> {
    pub problems: &'a mut Problems,
}

impl Reader<'_> {
    /// A draft marks what is to be decided by `?`.
    fn open_places(&mut self, node: &Node) {
        let open = |text: &str| !text.is_empty() && text.trim_matches('?').trim().is_empty();
        if node.scalar_text().is_some_and(open) {
            let problem = Problem::error("open-place", "this place of the draft is open").at(&node.span);
            self.problems.push(problem.help("decide it, or remove the line; the comments beside it say what was found"));
        }
        node.items().iter().for_each(|item| self.open_places(item));
        for (key, value) in node.entries() {
            if open(&key.text) {
                let problem = Problem::error("open-place", "this place of the draft is open").at(&key.span);
                self.problems.push(problem.help("write the name of the channel, or remove the line"));
            }
            self.open_places(value);
        }
    }

    pub fn fault(&mut self, code: &'static str, says: impl Into<String>, span: &Span) {
        self.problems.push(Problem::error(code, says).at(span));
    }

    /// Whether the node is a map; unknown keys are reported.
    pub fn keys(&mut self, node: &Node, known: &[&str], what: &str) -> bool {
        if !matches!(node.value, Value::Map(_)) {
            self.fault("wrong-kind", format!("{what} must be a map of keys and values, not {}", node.kind_in_words()), &node.span);
            return false;
        }
        for (key, _) in node.entries() {
            if !known.contains(&key.text.as_str()) {
                let problem = Problem::error("unknown-key", format!("{what} has no key `{}`", key.text)).at(&key.span);
                self.problems.push(problem.suggest(&key.text, known.iter().copied()));
            }
        }
        true
    }

    pub fn text_of(&mut self, node: &Node, key: &str) -> Option<Spanned<String>> {
        match node.scalar_text().map(str::trim) {
            Some(text) if !text.is_empty() => Some(Spanned::new(text.to_string(), node.span.clone())),
            _ => {
                self.fault("wrong-kind", format!("`{key}` must be text, not {}", node.kind_in_words()), &node.span);
                None
            }
        }
    }

    pub fn text(&mut self, node: &Node, key: &str) -> Option<Spanned<String>> {
        let found = node.get(key)?;
        self.text_of(found, key)
    }

    pub fn need_text(&mut self, node: &Node, key: &str, means: &str) -> Option<Spanned<String>> {
        if node.get(key).is_none() {
            let problem = Problem::error("key-missing", format!("`{key}` is missing: {means}")).at(&node.span.part(0..0));
            self.problems.push(problem.help(format!("write `{key}: ...`")));
            return None;
        }
        self.text(node, key)
    }

    /// A text or a list of texts.
    pub fn texts(&mut self, node: &Node, key: &str) -> Vec<Spanned<String>> {
        let Some(found) = node.get(key) else { return Vec::new() };
        match &found.value {
            Value::List(items) => items.iter().filter_map(|item| self.text_of(item, key)).collect(),
            _ => self.text_of(found, key).into_iter().collect(),
        }
    }

    /// A number with its unit, in SI.
    pub fn number(&mut self, node: &Node, key: &str, unit: &Unit) -> Option<f64> {
        let found = node.get(key)?;
        self.number_of(found, key, unit)
    }

    pub fn number_of(&mut self, node: &Node, key: &str, unit: &Unit) -> Option<f64> {
        let written = self.text_of(node, key)?;
        match number::read(&written.value, unit) {
            Ok(read) if read.unit_stated || unit.dimension == Unit::one().dimension => Some(read.si),
            Ok(_) => {
                let problem = Problem::error("unit-missing", format!("`{key}` has no unit; it is {}", unit.dimension.in_words()));
                self.problems.push(problem.at(&written.span).help(format!("write `{} {unit}`, if that is meant", written.value)));
                None
            }
            Err(refused) => {
                let problem = Problem::error("wrong-number", format!("`{key}`: {}", refused.says)).at(&written.span);
                self.problems.push(match refused.help {
                    Some(help) => problem.help(help),
                    None => problem,
                });
                None
            }
        }
    }

    pub fn unit(&mut self, written: &Spanned<String>) -> Option<Unit> {
        Unit::parse(&written.value)
            .map_err(|unknown| {
                let problem = Problem::error("unknown-unit", format!("`{}` is not a known unit", unknown.word)).at(&written.span);
                self.problems.push(match unknown.near {
                    Some(near) => problem.help(format!("did you mean `{near}`?")),
                    None => problem,
                });
            })
            .ok()
    }

    /// Placeholders of a path must be known: `{section}`, of runs `{run}`, or a column of the table of sections.
    pub fn pattern(&mut self, written: &Spanned<String>, sections: &Sections) {
        for name in placeholders(&written.value) {
            if name != sections.word && !sections.has_column(name) {
                let says = match sections.word {
                    "run" => format!("`{{{name}}}` is not `{{run}}`"),
                    word => format!("`{{{name}}}` is neither `{{{word}}}` nor a column of the table of sections"),
                };
                let problem = Problem::error("unknown-placeholder", says);
                let known = std::iter::once(sections.word).chain(sections.columns());
                self.problems.push(problem.at(&written.span).suggest(name, known));
            }
        }
    }

    fn campaign(&mut self, tree: &Node) -> Vec<(Key, Node)> {
        let Some(node) = tree.get("campaign") else { return Vec::new() };
        if !matches!(node.value, Value::Map(_)) {
            self.fault(
                "wrong-kind",
                format!("`campaign` must be a map of keys for campaign.yaml, not {}", node.kind_in_words()),
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
            self.problems.push(Problem::error("unknown-key", says).at(&key.span).help(help));
        }
        node.entries().to_vec()
    }
}

/// The names in braces of a text.
pub(super) fn placeholders(text: &str) -> Vec<&str> {
    text.split('{').skip(1).filter_map(|rest| rest.split_once('}').map(|(name, _)| name)).collect()
}
