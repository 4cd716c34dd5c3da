//! Conventions: how channels are called, and which are exchanged when the other end of the vehicle
//! leads. They are data: a shipped file, a file of the user, or a block of the mapping.

use std::path::Path;
use std::sync::Arc;

use super::reader::{Reader, at};
use crate::data::text::read_text;
use crate::library;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Spanned};
use crate::yaml::{self, Node, Value};

/// What is exchanged when the vehicle is turned.
#[derive(Clone, Debug, Default)]
pub struct Turning {
    /// Pairs of channels.
    pub exchange: Vec<(String, String)>,
    /// Channels with the opposite sign.
    pub reverse: Vec<String>,
    /// The name of a convention, or `the mapping`.
    pub from: String,
}

impl Turning {
    /// The channel that is recorded in place of another; the channel itself if none is.
    pub fn partner<'a>(&'a self, name: &'a str) -> &'a str {
        let other = |(one, other): &'a (String, String)| match name {
            _ if one == name => Some(other.as_str()),
            _ if other == name => Some(one.as_str()),
            _ => None,
        };
        self.exchange.iter().find_map(other).unwrap_or(name)
    }

    pub fn reverses(&self, name: &str) -> bool {
        self.reverse.iter().any(|known| known == name)
    }
}

/// A shipped or own convention.
#[derive(Debug, Default)]
pub struct Convention {
    pub name: String,
    /// Channel, and foreign names of it.
    pub names: Vec<(String, Vec<String>)>,
    /// Groups of channels with a common mean, and what that is.
    pub common: Vec<Common>,
    pub opposite: Vec<Opposite>,
    pub turning: Option<Turning>,
}

/// Channels of a group that carry the same load.
#[derive(Debug)]
pub struct Common {
    pub title: String,
    pub channels: Vec<String>,
    /// Largest ratio of the mean of one to the median of all.
    pub within: f64,
    /// What it means if a mean is above that of the group.
    pub above: String,
}

/// Pairs of channels whose means have opposite signs.
#[derive(Debug)]
pub struct Opposite {
    pub title: String,
    pub pairs: Vec<(String, String)>,
}

/// A convention by path, relative to a folder, or by shipped name.
///
/// # Errors
/// `no-such-convention`; those of the file.
pub fn find(name: &Spanned<String>, folder: &Path, problems: &mut Problems) -> Option<Convention> {
    let path = folder.join(&name.value);
    let source = if crate::disk::may_be_file(&path) {
        read_text(&path, &path.display().to_string()).map(|(source, _)| source)
    } else {
        shipped(&name.value)
    };
    let source = source.map_err(|problem| problems.push(at(problem, &name.span))).ok()?;
    let before = problems.errors();
    let tree = yaml::load(&source, problems)?;
    let convention = convention(&mut Reader { problems }, &tree);
    (problems.errors() == before).then_some(convention)
}

fn shipped(name: &str) -> Result<Arc<Source>, Problem> {
    let found = library::CONVENTIONS.iter().find(|shipped| shipped.name == name);
    found.map(|shipped| Source::new(format!("conventions/{name}.yaml"), shipped.text)).ok_or_else(
        || {
            let problem = Problem::error(
                "no-such-convention",
                format!("there is no file and no shipped convention `{name}`"),
            );
            problem.suggest(name, library::CONVENTIONS.iter().map(|shipped| shipped.name))
        },
    )
}

fn convention(reader: &mut Reader<'_>, tree: &Node) -> Convention {
    reader.keys(
        tree,
        &["convention", "title", "names", "common mean", "opposite mean", "turning"],
        "a convention",
    );
    let name = reader
        .need_text(tree, "convention", "its name")
        .map_or_else(String::new, |name| name.value);
    let mut names = Vec::new();
    for (key, node) in tree.get("names").map_or(&[][..], Node::entries) {
        let list = match &node.value {
            Value::List(items) => items
                .iter()
                .filter_map(|item| reader.text_of(item, &key.text))
                .map(|text| text.value)
                .collect(),
            _ => reader.text_of(node, &key.text).into_iter().map(|text| text.value).collect(),
        };
        names.push((key.text.clone(), list));
    }
    let mut common = Vec::new();
    for node in tree.get("common mean").map_or(&[][..], Node::items) {
        reader.keys(node, &["title", "channels", "within", "above"], "a group with a common mean");
        let within = node.get("within").and_then(Node::number);
        if within.is_none_or(|within| within <= 1.0) {
            reader.fault("wrong-kind", "`within` must be a factor above 1", &node.span);
        }
        common.push(Common {
            title: reader
                .need_text(node, "title", "what the group is")
                .map_or_else(String::new, |text| text.value),
            channels: reader.texts(node, "channels").into_iter().map(|text| text.value).collect(),
            within: within.unwrap_or(1.0),
            above: reader.text(node, "above").map_or_else(String::new, |text| text.value),
        });
    }
    let mut opposite = Vec::new();
    for node in tree.get("opposite mean").map_or(&[][..], Node::items) {
        reader.keys(node, &["title", "pairs"], "a group with opposite means");
        let pairs = node.get("pairs").map_or(&[][..], Node::entries);
        opposite.push(Opposite {
            title: reader
                .need_text(node, "title", "what the group is")
                .map_or_else(String::new, |text| text.value),
            pairs: pairs.iter().map(|(key, node)| (key.text.clone(), node.raw.clone())).collect(),
        });
    }
    let turning =
        tree.get("turning").map(|node| Turning { from: name.clone(), ..block(reader, node) });
    Convention { name, names, common, opposite, turning }
}

/// `turning: bogie-vehicle`, or the block itself.
pub(super) fn turning(reader: &mut Reader<'_>, node: &Node, folder: &Path) -> Option<Turning> {
    if matches!(node.value, Value::Map(_)) {
        return Some(Turning { from: "the mapping".into(), ..block(reader, node) });
    }
    let named = reader.text_of(node, "turning")?;
    let found = find(&named, folder, reader.problems)?;
    if found.turning.is_none() {
        reader.fault(
            "key-missing",
            format!("the convention `{}` states no `turning`", named.value),
            &named.span,
        );
    }
    found.turning
}

fn block(reader: &mut Reader<'_>, node: &Node) -> Turning {
    reader.keys(node, &["exchange", "reverse sign"], "`turning`");
    let mut exchange: Vec<(String, String)> = Vec::new();
    for (key, value) in node.get("exchange").map_or(&[][..], Node::entries) {
        let Some(other) = reader.text_of(value, &key.text) else { continue };
        let taken = |name: &str| exchange.iter().any(|(one, two)| one == name || two == name);
        if taken(&key.text) || taken(&other.value) || key.text == other.value {
            let says = format!(
                "`{}` and `{}`: a channel is exchanged with one other channel",
                key.text, other.value
            );
            reader.fault("mapped-twice", says, &other.span);
            continue;
        }
        exchange.push((key.text.clone(), other.value));
    }
    let reverse = reader.texts(node, "reverse sign").into_iter().map(|text| text.value).collect();
    Turning { exchange, reverse, from: String::new() }
}
