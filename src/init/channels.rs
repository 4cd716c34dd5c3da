//! Channels in a list or header, and groups of channels that are numbered alike: `Y_1R`, `Y_1L`,
//! `Y_2R`.

use std::collections::BTreeSet;

use crate::data::Heading;
use crate::problem::{Problem, Problems, error, problem};
use crate::units::{Dimension, Unit};

/// Columns that serve as axis and time if they are in the list.
const DISTANCE: &str = "distance";
const TIME: &str = "time";
/// Characters that have a meaning of their own in the text of a `column`.
const NOT_IN_NAMES: [char; 4] = ['"', '\\', '{', '}'];

/// A column with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    pub name: String,
    pub unit: Unit,
}

/// Columns that differ in their position only, or a single one.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// `Y` of `Y_1R`; the whole name of a single column.
    pub stem: String,
    /// What stands between stem and position.
    pub separator: &'static str,
    /// The unit of the first column.
    pub unit: Unit,
    /// In the order of the list; empty for a single column.
    pub positions: Vec<String>,
}

/// Axis, time and groups of a list of channels.
#[derive(Clone, Debug)]
pub struct Listed {
    /// The axis of sections.
    pub axis: Channel,
    /// Filters need it.
    pub time: Option<Channel>,
    pub groups: Vec<Group>,
}

/// Problems: `unit-missing`, `unknown-unit`, `name-missing`, `channel-name`, each with its place.
pub fn channels(headings: &[Heading], problems: &mut Problems) -> Vec<Channel> {
    let channel = |Heading { name, span, .. }: &Heading| {
        if name.is_empty() {
            return Err(error("name-missing", "a channel has no name", span)
                .help("write name and unit: `Y_1R [kN]`"));
        }
        if name.contains(NOT_IN_NAMES) || name.chars().any(crate::problem::acts) {
            return Err(problem!(
                "channel-name",
                span,
                "the channel `{name}` has a quotation mark, a backslash or a brace in its name"
            )
            .help("rename the column in the records"));
        }
        Ok(name.clone())
    };
    let mut keep = |heading: &Heading| {
        let found =
            channel(heading).and_then(|name| Ok(Channel { name, unit: heading.unit(None)? }));
        problems.value(found)
    };
    headings.iter().filter_map(&mut keep).collect()
}

/// Axis and time are the channels `distance` and `time`. A list that has neither gets both, unless
/// it is the header of a record.
pub fn listed(channels: Vec<Channel>, of_record: bool) -> Result<Listed, Problem> {
    let named = |name: &str, dimension: Dimension| {
        channels
            .iter()
            .find(|channel| channel.name == name && channel.unit.dimension == dimension)
            .cloned()
    };
    let (mut time, mut axis) = (named(TIME, Dimension::TIME), named(DISTANCE, Dimension::LENGTH));
    let new = |name: &str, unit: &str| {
        Unit::parse(unit).ok().map(|unit| Channel { name: name.into(), unit })
    };
    if !of_record {
        axis = axis.or_else(|| if time.is_none() { new(DISTANCE, "m") } else { None });
        time = time.or_else(|| new(TIME, "s"));
    }
    let Some(axis) = axis.or_else(|| time.clone()) else {
        return Err(problem!(
            "no-axis",
            "the record has neither a column `{DISTANCE}`, a length, nor a column `{TIME}`"
        )
        .help("sections are cut along one of them: rename the column, with its unit"));
    };
    let mut rest = channels;
    rest.retain(|Channel { name, .. }| {
        *name != axis.name && time.as_ref().is_none_or(|time| *name != time.name)
    });
    Ok(Listed { axis, time, groups: groups(&rest) })
}

/// Groups in the order of their first columns.
pub fn groups(channels: &[Channel]) -> Vec<Group> {
    let mut found: Vec<Group> = Vec::new();
    let mut taken: BTreeSet<&str> = BTreeSet::new();
    for channel in channels {
        if taken.contains(channel.name.as_str()) {
            continue;
        }
        let mut group = Group {
            stem: channel.name.clone(),
            separator: "",
            unit: channel.unit.clone(),
            positions: Vec::new(),
        };
        if let Some((stem, separator, _)) = position(&channel.name) {
            let alike = |other: &&Channel| {
                other.unit.dimension == channel.unit.dimension
                    && position(&other.name)
                        .is_some_and(|(its, between, _)| (its, between) == (stem, separator))
            };
            let members: Vec<&str> =
                channels.iter().filter(alike).map(|member| member.name.as_str()).collect();
            if members.len() > 1 {
                taken.extend(&members);
                let places = members.iter().filter_map(|member| position(member));
                group.positions = places.map(|(.., at)| at.to_string()).collect();
                (group.stem, group.separator) = (stem.into(), separator);
            }
        }
        found.push(group);
    }
    found
}

/// Stem, separator and position of a numbered name: `Y_1R`, `ay_II`, `v2`.
fn position(name: &str) -> Option<(&str, &'static str, &str)> {
    if let Some((stem, at)) =
        name.rsplit_once('_').filter(|(stem, at)| !stem.is_empty() && is_position(at))
    {
        return Some((stem, "_", at));
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    (!stem.is_empty() && stem.len() < name.len() && !stem.ends_with('_'))
        .then(|| (stem, "", &name[stem.len()..]))
}

/// A number, a number with a letter for the side, or a Roman number.
fn is_position(text: &str) -> bool {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let numbered = !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit())
        && text.len() <= digits.len() + 1;
    numbered || (!text.is_empty() && text.chars().all(|c| matches!(c, 'I' | 'V' | 'X')))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, unit: &str) -> Channel {
        Channel { name: name.into(), unit: Unit::parse(unit).expect("a unit") }
    }

    #[test]
    fn numbered_channels_of_one_dimension_are_a_group() {
        let all = [
            channel("Y_1R", "kN"),
            channel("ay_I", "m/s^2"),
            channel("Y_1L", "N"),
            channel("v2", "km/h"),
            channel("ay_II", "m/s^2"),
            channel("Y_2R", "m"),
            channel("v3", "km/h"),
            channel("roll", "rad"),
        ];
        let found: Vec<_> = groups(&all)
            .into_iter()
            .map(|group| (group.stem, group.separator, group.positions.join(" ")))
            .collect();
        let expected = [
            ("Y", "_", "1R 1L"),
            ("ay", "_", "I II"),
            ("v", "", "2 3"),
            ("Y_2R", "", ""),
            ("roll", "", ""),
        ]
        .map(|(a, b, c)| (a.into(), b, c.into()));
        assert_eq!(found, expected);
    }

    #[test]
    fn positions_of_names() {
        assert_eq!(position("Y_1R"), Some(("Y", "_", "1R")));
        assert_eq!(position("z_bogie_12"), Some(("z_bogie", "_", "12")));
        assert_eq!(position("a_1RL"), None);
        assert_eq!(position("_1"), None);
        assert_eq!(position("12"), None);
        assert_eq!(position(""), None);
    }

    #[test]
    fn axis_and_time() {
        let names = |found: &Listed| {
            (found.axis.name.clone(), found.time.as_ref().map(|time| time.name.clone()))
        };
        let some = |names: &[(&str, &str)]| {
            names.iter().map(|(name, unit)| channel(name, unit)).collect::<Vec<_>>()
        };
        let of = |list: &[(&str, &str)], record| {
            listed(some(list), record).map(|found| names(&found)).ok()
        };
        assert_eq!(of(&[("Y", "kN")], false), Some(("distance".into(), Some("time".into()))));
        assert_eq!(of(&[("Y", "kN")], true), None);
        assert_eq!(
            of(&[("time", "s"), ("Y", "kN")], false),
            Some(("time".into(), Some("time".into())))
        );
        assert_eq!(of(&[("distance", "km"), ("Y", "kN")], true), Some(("distance".into(), None)));
    }
}
