//! The text of a draft.

use super::guess::{self, Guess};
use super::look::{Look, short};
use super::{Group, With};
use crate::data::RecordKind;
use crate::data::write::yaml_text;
use crate::import::mapping::agree::record_of;
use crate::run::needs::ChannelNeed;
use crate::units::{Dimension, Unit};
use crate::yaml::Words;

/// Column at which the comments begin, where a line is shorter.
const COMMENTS: usize = 44;

/// A mapping with what is known, and the number of its open places.
pub fn draft(groups: &[Group], with: &With<'_>) -> (String, usize) {
    let mut out = Text::default();
    out.line(
        0,
        "# A draft: decide every `?`, check every guess, then run `fishplate import` with this file. Paths are relative to it.",
        &[],
    );
    out.open(0, "name", "the name of the campaign");
    out.line(0, &format!("protocol: {}", yaml_text(with.protocol)), &[]);
    let sections: Vec<&str> = groups
        .first()
        .map_or_else(Vec::new, |group| group.sections.iter().map(String::as_str).collect());
    out.open(
        0,
        "sections",
        &format!("the table of sections; the files have {}", listed(&sections)),
    );
    if with.needs.vehicle.iter().any(|need| need.required) {
        let needed: Vec<&str> = with
            .needs
            .vehicle
            .iter()
            .filter(|need| need.required)
            .map(|need| need.key.as_str())
            .collect();
        out.open(
            0,
            "vehicle",
            &format!("the vehicle file; the protocol needs {}", needed.join(", ")),
        );
    }
    let mut left: Vec<RecordKind> = vec![RecordKind::Measurement, RecordKind::Simulation];
    for group in groups {
        let stated = group.kind.filter(|kind| left.contains(kind));
        let Some(kind) = stated.or(left.first().copied()) else {
            out.line(0, &format!("# not used, its channels are others: {}", group.files), &[]);
            continue;
        };
        left.retain(|other| *other != kind);
        side(&mut out, group, kind, stated.is_some(), with);
        if group.sections != groups[0].sections {
            out.line(
                0,
                &format!(
                    "# its sections are {}: they must be the names of the table",
                    listed(&group.sections.iter().map(String::as_str).collect::<Vec<_>>())
                ),
                &[],
            );
        }
    }
    (out.text, out.open)
}

fn side(out: &mut Text, group: &Group, kind: RecordKind, stated: bool, with: &With<'_>) {
    out.text.push('\n');
    out.line(0, &format!("{}:", kind.key()), &[]);
    if !stated {
        out.open(
            2,
            "side",
            "is this the measurement or the simulation? Correct the key above and remove this line",
        );
    }
    let facts: Vec<String> =
        group.first.facts.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let detected = if facts.is_empty() { String::new() } else { format!(": {}", facts.join("; ")) };
    out.line(
        2,
        &format!("files: {}", yaml_text(&group.files)),
        &[format!("{}{detected}", group.first.format.word())],
    );
    if let Some(table) = &group.table {
        out.line(2, &format!("table: {}", yaml_text(table)), &[]);
    }
    let needs: Vec<&ChannelNeed> =
        with.needs.channels.iter().filter(|need| need.record == record_of(kind)).collect();
    let used: Vec<&ChannelNeed> = needs
        .iter()
        .copied()
        .filter(|need| !["time", "distance"].contains(&need.column.as_str()))
        .collect();
    let guesses = guess::guesses(&group.looks, &used, with.convention);
    units(out, group, &guesses, &used);
    let looks = &group.looks;
    let mut taken: Vec<&str> = Vec::new();
    let (time, why) = guess::axis(looks, with.convention, "time", Dimension::TIME);
    match time {
        Some(look) => {
            out.channel(2, "time", look, "s, ms or another unit of time", &[why, look.in_words()]);
            taken.push(&look.name);
        }
        None => match looks.first().and_then(|look| look.rate) {
            Some(rate) => out.line(
                2,
                &format!("# no channel of time; the file states {} Hz", short(rate)),
                &[],
            ),
            None => {
                out.open(2, "time", "no channel of time was found: its name, or {rate: ... Hz}")
            }
        },
    }
    distance(out, group, with, &mut taken);
    out.line(2, "channels:", &[]);
    for guess in &guesses {
        let needed = used.iter().any(|need| need.column == guess.channel && need.required);
        taken.extend(guess.candidates.iter().map(String::as_str));
        match &guess.from {
            Some(from) => {
                taken.push(from);
                let need = used.iter().find(|need| need.column == guess.channel);
                match looks.iter().find(|look| look.name == *from) {
                    Some(look) if need.is_none_or(|need| need.unit != "-") => {
                        let hint = need.map_or_else(
                            || "that of the sensor".to_string(),
                            |need| format!("{} in the protocol", need.unit),
                        );
                        out.channel(4, &guess.channel, look, &hint, &guess.reasons);
                    }
                    _ => out.line(
                        4,
                        &format!("{}: {}", yaml_text(&guess.channel), yaml_text(from)),
                        &guess.reasons,
                    ),
                }
            }
            // What rules look at only where it is recorded may be absent.
            None if !needed && guess.candidates.is_empty() => out.line(
                4,
                &format!("# {} is not needed: {}", guess.channel, guess.reasons.join("; ")),
                &[],
            ),
            None => {
                let without = |look: &&Look| {
                    guess.candidates.contains(&look.name) && look.unit_text.is_empty()
                };
                let unit = looks
                    .iter()
                    .find(without)
                    .map(|look| format!("with its unit: {{from: {}, unit: ...}}", look.name));
                out.open(
                    4,
                    &guess.channel,
                    &guess.reasons.iter().cloned().chain(unit).collect::<Vec<_>>().join("; "),
                );
            }
        }
    }
    for look in looks.iter().filter(|look| !taken.contains(&look.name.as_str())) {
        out.line(4, &format!("# not mapped: {} ({})", look.name, look.in_words()), &[]);
    }
}

/// Unit texts that are not known, or are of another dimension than the channel they are guessed
/// for.
fn units(out: &mut Text, group: &Group, guesses: &[Guess], needs: &[&ChannelNeed]) {
    let mut told: Vec<(&str, String)> = Vec::new();
    for look in group.looks.iter().filter(|look| !look.unit_text.is_empty()) {
        let guessed = guesses.iter().find(|guess| guess.from.as_ref() == Some(&look.name));
        let need = guessed.and_then(|guess| needs.iter().find(|need| need.column == guess.channel));
        let wanted = need.and_then(|need| Unit::parse(&need.unit).ok());
        let why = match (&look.unit, wanted) {
            (None, _) => format!("not a known unit; of {}", look.name),
            (Some(unit), Some(wanted)) if unit.dimension != wanted.dimension => {
                let gravity = Unit::parse("gn")
                    .is_ok_and(|gn| gn.dimension == wanted.dimension && unit.text == "g");
                let hint =
                    if gravity { ": gn, if accelerations are in units of gravity" } else { "" };
                format!(
                    "{} for {}, which is {}{hint}",
                    unit.dimension.in_words(),
                    look.name,
                    wanted.dimension.in_words()
                )
            }
            _ => continue,
        };
        if !told.iter().any(|(text, _)| *text == look.unit_text) {
            told.push((&look.unit_text, why));
        }
    }
    if !told.is_empty() {
        out.line(2, "units:", &[]);
    }
    for (text, why) in told {
        out.open(4, text, &why);
    }
}

fn distance<'a>(out: &mut Text, group: &'a Group, with: &With<'_>, taken: &mut Vec<&'a str>) {
    let (found, why) = guess::axis(&group.looks, with.convention, "distance", Dimension::LENGTH);
    if let Some(look) = found {
        out.channel(
            2,
            "distance",
            look,
            "m, km or another unit of length",
            &[why, look.in_words()],
        );
        taken.push(&look.name);
        return;
    }
    let (speed, why) = guess::speed(&group.looks, with.convention);
    match speed {
        Some(look) => {
            out.line(2, "distance:", &[]);
            out.line(4, &format!("from speed: {}", yaml_text(&look.name)), &[why, look.in_words()]);
            if look.unit_text.is_empty() {
                out.open(4, "unit", "the file states none: m/s, km/h or another unit of speed");
            }
            let facts: Vec<String> = group
                .first
                .tables
                .iter()
                .take(group.tables.max(1))
                .flat_map(|table| &table.facts)
                .map(|(name, value)| format!("{name} = {value}"))
                .collect();
            let facts = if facts.is_empty() {
                String::new()
            } else {
                format!("; the file states {}: {{fact: NAME, unit: m}}", facts.join(", "))
            };
            out.open(4, "start", &format!("the distance at the first sample{facts}"));
            taken.push(&look.name);
        }
        None => out.open(2, "distance", "neither a distance that increases nor a speed was found"),
    }
}

fn listed(names: &[&str]) -> String {
    /// Names that are printed.
    const SHOWN: usize = 12;
    let more = names.len().saturating_sub(SHOWN);
    let list = names[..names.len() - more].join(", ");
    if more > 0 { format!("{list} and {more} more") } else { list }
}

#[derive(Default)]
struct Text {
    text: String,
    open: usize,
}

impl Text {
    /// A line with comments beside it; further ones below.
    fn line(&mut self, indent: usize, line: &str, comments: &[String]) {
        let comments: Vec<String> = comments
            .iter()
            .map(|comment| comment.replace(['\n', '\r'], " "))
            .filter(|comment| !comment.is_empty())
            .collect();
        let line = format!("{:indent$}{}", "", line.replace(['\n', '\r'], " "));
        if comments.is_empty() {
            self.text += &format!("{line}\n");
        } else {
            self.text += &format!("{line:COMMENTS$}  # {}\n", comments.join("; "));
        }
    }

    /// A channel of the file; its unit is open if the file states none.
    fn channel(&mut self, indent: usize, key: &str, look: &Look, unit: &str, comments: &[String]) {
        if !look.unit_text.is_empty() {
            return self.line(
                indent,
                &format!("{}: {}", yaml_text(key), yaml_text(&look.name)),
                comments,
            );
        }
        self.open += 1;
        // Within braces, a comma or a brace ends a word.
        let name = yaml_text(&look.name);
        let name = if name.starts_with('"') || !name.contains([',', '[', ']', '{', '}']) {
            name
        } else {
            format!("\"{name}\"")
        };
        let open = format!("the file states no unit: {unit}");
        let comments: Vec<String> = std::iter::once(open).chain(comments.iter().cloned()).collect();
        self.line(indent, &format!("{}: {{from: {name}, unit: \"?\"}}", yaml_text(key)), &comments);
    }

    fn open(&mut self, indent: usize, key: &str, why: &str) {
        self.open += 1;
        self.line(indent, &format!("{}: \"?\"", yaml_text(key)), &[why.to_string()]);
    }
}
