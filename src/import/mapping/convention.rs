//! Conventions: how channels are called, and which are exchanged when the other end of the vehicle
//! leads. They are data: a shipped file, a file of the user, or a block of the mapping.

use std::sync::Arc;

use super::Paths;
use crate::disk;
use crate::library;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Spanned};
use crate::yaml::{self, Entries, FromNode, Key, Node, OneOrMore, Reader, Value, fields};

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

fields! {
    /// A shipped or own convention.
    #[derive(Default)]
    pub struct Convention: "a convention" {
        "convention" name: String => "its name",
        "title" title: Option<String>,
        /// Axes and channels, and whole foreign names of each.
        "names" names: Entries<OneOrMore<String>> = Entries(Vec::new()),
        /// What words of names stand for.
        "quantities" quantities: Vec<Quantity>,
        "places" places: Entries<Place> = Entries(Vec::new()),
        "orders" orders: Vec<Order>,
        /// They say nothing.
        "other words" other: OneOrMore<String> = OneOrMore(Vec::new()),
        /// Groups of channels with a common mean, and what that is.
        "common mean" common: Vec<Common>,
        "opposite mean" opposite: Vec<Opposite>,
        "turning" turning: Option<Turning>,
    }
}

fields! {
    /// What is recorded at several places, and how it is called.
    pub struct Quantity: "a quantity" {
        /// With its places: `Y_{wheelset}{side}`.
        "channel" channel: String => "its channel, with places in braces",
        /// Phrases, one of which is in a name; their words stand in any order.
        "words" words: OneOrMore<String> => "what it is called",
        /// Further phrases that may be in it.
        "of" of: OneOrMore<String> = OneOrMore(Vec::new()),
    }
}

fields! {
    /// A place, with the words that stand before its members.
    #[derive(Default)]
    pub struct Place: "a place" {
        "words" words: OneOrMore<String> = OneOrMore(Vec::new()),
        "members" members: Entries<OneOrMore<String>>,
    }
}

fields! {
    /// What two digits stand for.
    pub struct Order: "an order of digits" {
        "title" title: String => "what the order is",
        "places" places: OneOrMore<String> => "the place of each digit",
        /// Places whose digits are no names of members, with the member of each.
        "digits" digits: Entries<Entries<String>> = Entries(Vec::new()),
    }
}

fields! {
    /// Channels of a group that carry the same load.
    pub struct Common: "a group with a common mean" {
        "title" title: String => "what the group is",
        "channels" channels: OneOrMore<String>,
        /// Largest ratio of the mean of one to the median of all.
        "within" within: Spanned<f64>,
        /// What it means if a mean is above that of the group.
        "above" above: String = String::new(),
    }
}

fields! {
    /// Pairs of channels whose means have opposite signs.
    pub struct Opposite: "a group with opposite means" {
        "title" title: String => "what the group is",
        "pairs" pairs: Entries<String>,
    }
}

fields! {
    /// The block `turning`.
    struct Written: "`turning`" {
        "exchange" exchange: Entries<Spanned<String>>,
        "reverse sign" reverse: OneOrMore<String>,
    }
}

/// A convention by path, or by shipped name.
///
/// # Errors
/// `no-such-convention`; those of the file.
pub fn find(name: &Spanned<String>, paths: &Paths, problems: &mut Problems) -> Option<Convention> {
    let source = paths.place(&name.value, &name.span).and_then(|place| {
        match disk::may_be_file(&place.path) {
            true => Ok(paths.read_text(name)?.0),
            false => shipped(&name.value),
        }
    });
    let source = problems.value(source.map_err(|problem| problem.or_at(&name.span)))?;
    let before = problems.errors();
    let tree = yaml::load(&source, problems)?;
    let mut reader = Reader { with: (), problems };
    let mut convention: Convention = reader.file(&tree)?;
    for group in convention.common.iter().filter(|group| group.within.value <= 1.0) {
        reader.fault("wrong-kind", "`within` must be a factor above 1", &group.within.span);
    }
    if let Some(turning) = &mut convention.turning {
        turning.from.clone_from(&convention.name);
    }
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

/// `turning: bogie-vehicle`, or the block itself.
pub fn turning(reader: &mut Reader<'_>, map: &Node, paths: &Paths) -> Option<Turning> {
    let (key, node) = map.entry("turning")?;
    if matches!(node.value, Value::Map(_)) {
        return Turning::from_node(reader, key, node);
    }
    let named = Spanned::from_node(reader, key, node)?;
    let found = find(&named, paths, reader.problems)?;
    if found.turning.is_none() {
        let says = format!("the convention `{}` states no `turning`", named.value);
        reader.fault("key-missing", says, &named.span);
    }
    found.turning
}

impl<C> FromNode<C> for Turning {
    fn from_node(reader: &mut Reader<'_, C>, key: &Key, node: &Node) -> Option<Self> {
        let written = Written::from_node(reader, key, node)?;
        let mut exchange: Vec<(String, String)> = Vec::new();
        for (Key { text: one, .. }, other) in written.exchange.0 {
            let taken = |name: &str| exchange.iter().any(|(one, two)| one == name || two == name);
            if taken(&one) || taken(&other.value) || one == other.value {
                let says = format!(
                    "`{one}` and `{}`: a channel is exchanged with one other channel",
                    other.value
                );
                reader.fault("mapped-twice", says, &other.span);
            } else {
                exchange.push((one, other.value));
            }
        }
        Some(Self { exchange, reverse: written.reverse.0, from: "the mapping".into() })
    }
}
