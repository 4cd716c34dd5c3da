//! The text of the draft of a protocol.

use std::collections::BTreeSet;

use serde_json::{Value as Json, json};

use super::{
    channels::{Channel, Group, Listed},
    filled,
};
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

/// The protocol of a folder in canonical form. With a parent, `listed` holds the channels that the
/// parent does not have.
///
/// # Errors
/// `internal`: the template cannot be filled.
pub fn text(
    folder: &str,
    listed: Option<&Listed>,
    parent: Option<&Parent<'_>>,
) -> Result<String, Problem> {
    let mut names = Names(parent.map(|parent| parent.names.clone()).unwrap_or_default());
    let groups = listed.map(|listed| listed.groups.as_slice()).unwrap_or_default();
    let time = listed.and_then(|listed| listed.time.as_ref());
    let mut places: Vec<(&[String], String)> = Vec::new();
    let blocks: Vec<Json> =
        groups.iter().map(|group| block(group, &mut places, &mut names)).collect();
    let places: Vec<Json> = places
        .into_iter()
        .map(|(positions, name)| json!({"name": name, "members": positions.join(", ")}))
        .collect();
    let column = |channel: &Channel| json!({"name": channel.name, "unit": channel.unit.text});
    let draft = json!({
        "name": format!("{}-protocol", block_name(folder)),
        "title": format!("Protocol of {}", plain_text(folder)),
        "parent": parent.map(|parent| parent.name),
        "extends": parent.map(|parent| &parent.extends),
        "axis": listed.map(|listed| column(&listed.axis)),
        "time": time.map(column),
        "has_filter": !groups.is_empty() && time.is_some(),
        "cut_off": names.free("lowpass_frequency"),
        "filter": names.free("LP"),
        "groups": blocks,
        "places": places,
    });
    let source = Source::new("protocol.fp", filled(TEMPLATE, &draft)?);
    Ok(syntax::print_text(&syntax::read_text(&source, &mut Problems::default())))
}

/// The blocks of a group. Channels with the same positions share a place.
fn block<'a>(
    group: &'a Group,
    places: &mut Vec<(&'a [String], String)>,
    names: &mut Names,
) -> Json {
    let positions = group.positions.as_slice();
    if !positions.is_empty() && places.iter().all(|(known, _)| *known != positions) {
        places.push((positions, names.free("position")));
    }
    let place = places.iter().find(|(known, _)| *known == positions).map(|(_, name)| name);
    let Group { stem, separator, unit, .. } = group;
    let name = names.free(&identifier(stem));
    json!({
        "number_unit": after_number(unit),
        "quantity": names.free(&format!("{name}_rms")),
        "std_limit": names.free(&format!("{name}_std_limit")),
        "mean_limit": names.free(&format!("{name}_mean_limit")),
        "title": stem,
        "name": name,
        "unit": unit.text,
        "place": place,
        "column": match place {
            Some(place) => format!("{stem}{separator}{{{place}}}"),
            None => stem.clone(),
        },
    })
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
