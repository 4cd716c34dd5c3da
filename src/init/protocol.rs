//! The text of the draft of a protocol.

use std::collections::BTreeSet;

use serde::Serialize;

use super::channels::{Channel, Group, Listed};
use super::filled;
use crate::catalog::{Reducer, Statistic};
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::units::Unit;

const TEMPLATE: &str = include_str!("../../templates/init/protocol.fp");
/// Words that the language reads as something else than a name.
const TAKEN: &str = "and or not is when otherwise of at through larger smaller doubled times for only then least near within start end \
    length time simulated measured zone section site record campaign vehicle each every all where mean";

/// The protocol that the draft extends.
#[derive(Debug)]
pub struct Parent<'a> {
    /// As the report calls it.
    pub name: &'a str,
    /// As `extends` names it.
    pub extends: String,
    /// Names of its blocks, which new blocks must not have.
    pub names: BTreeSet<String>,
}

#[derive(Serialize)]
struct Draft<'a> {
    name: String,
    title: String,
    parent: Option<&'a str>,
    extends: Option<&'a str>,
    axis: Option<Column>,
    time: Option<Column>,
    has_filter: bool,
    cut_off: String,
    filter: String,
    groups: Vec<Block>,
    places: Vec<Place>,
}

#[derive(Serialize)]
struct Column {
    name: String,
    unit: String,
}

#[derive(Serialize)]
struct Block {
    name: String,
    title: String,
    unit: String,
    /// ` kN` after a number.
    number_unit: String,
    place: Option<String>,
    column: String,
    quantity: String,
    std_limit: String,
    mean_limit: String,
}

#[derive(Serialize)]
struct Place {
    name: String,
    members: String,
}

/// The protocol of a folder in canonical form. With a parent, `listed` holds the channels that the
/// parent does not have.
///
/// # Errors
/// `internal`: the template cannot be filled.
pub fn text(
    folder: &str,
    listed: Option<&Listed>,
    parent: Option<&Parent<'_>>,
) -> Result<String, Box<Problem>> {
    let mut names = Names(parent.map(|parent| parent.names.clone()).unwrap_or_default());
    let groups = listed.map(|listed| listed.groups.as_slice()).unwrap_or_default();
    let has_filter = !groups.is_empty() && listed.is_some_and(|listed| listed.time.is_some());
    let (mut places, mut blocks): (Vec<(Vec<String>, Place)>, Vec<Block>) =
        (Vec::new(), Vec::new());
    for group in groups {
        let place =
            (!group.positions.is_empty()).then(|| place(&group.positions, &mut places, &mut names));
        blocks.push(block(group, place, &mut names));
    }
    let column =
        |channel: &Channel| Column { name: channel.name.clone(), unit: channel.unit.text.clone() };
    let draft = Draft {
        name: format!("{}-protocol", block_name(folder)),
        title: format!("Protocol of {}", plain_text(folder)),
        parent: parent.map(|parent| parent.name),
        extends: parent.map(|parent| parent.extends.as_str()),
        axis: listed.map(|listed| column(&listed.axis)),
        time: listed.and_then(|listed| listed.time.as_ref()).map(column),
        has_filter,
        cut_off: names.free("lowpass_frequency"),
        filter: names.free("LP"),
        groups: blocks,
        places: places.into_iter().map(|(_, place)| place).collect(),
    };
    let source = Source::new("protocol.fp", filled(TEMPLATE, &draft)?);
    Ok(syntax::print_text(&syntax::read_text(&source, &mut Problems::default())))
}

/// The place with these positions; channels with the same positions share one.
fn place(
    positions: &[String],
    places: &mut Vec<(Vec<String>, Place)>,
    names: &mut Names,
) -> String {
    if let Some((_, known)) = places.iter().find(|(known, _)| known == positions) {
        return known.name.clone();
    }
    let name = names.free("position");
    places.push((positions.to_vec(), Place { name: name.clone(), members: positions.join(", ") }));
    name
}

fn block(group: &Group, place: Option<String>, names: &mut Names) -> Block {
    let name = names.free(&identifier(&group.stem));
    let unit = group.unit.text.clone();
    let column = match &place {
        Some(place) => format!("{}{}{{{place}}}", group.stem, group.separator),
        None => group.stem.clone(),
    };
    Block {
        number_unit: after_number(&group.unit),
        quantity: names.free(&format!("{name}_rms")),
        std_limit: names.free(&format!("{name}_std_limit")),
        mean_limit: names.free(&format!("{name}_mean_limit")),
        title: group.stem.clone(),
        name,
        unit,
        place,
        column,
    }
}

/// Names that are in use.
#[derive(Default)]
pub(crate) struct Names(BTreeSet<String>);

impl Names {
    /// The name, or with a number behind it the first one that is free.
    pub(crate) fn free(&mut self, name: &str) -> String {
        let usable = |name: &String| {
            !self.0.contains(name)
                && TAKEN.split_whitespace().all(|word| word != name)
                && Reducer::named(name).is_none()
                && Statistic::named(name).is_none()
                && Unit::parse(name).is_err()
        };
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let found =
            std::iter::once(name.to_string()).chain(numbered).find(usable).unwrap_or_default();
        self.0.insert(found.clone());
        found
    }
}

/// A name of letters, digits and `_` that begins with a letter.
pub(crate) fn identifier(text: &str) -> String {
    let plain: String =
        text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = plain.trim_matches('_');
    match plain.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => plain.to_string(),
        Some(_) => format!("channel_{plain}"),
        None => "channel".into(),
    }
}

/// ` kN`; after a number, a product in a unit has its sign.
pub(crate) fn after_number(unit: &Unit) -> String {
    let factors: Vec<&str> = unit.text.split_whitespace().filter(|text| *text != "-").collect();
    if factors.is_empty() { String::new() } else { format!(" {}", factors.join("*")) }
}

/// `Coach C44` -> `coach-c44`
pub(crate) fn block_name(text: &str) -> String {
    let name = identifier(text).to_lowercase().replace('_', "-");
    name.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-")
}

pub(crate) fn plain_text(text: &str) -> String {
    text.chars().filter(|c| !matches!(c, '"' | '\\') && !crate::problem::acts(*c)).collect()
}
