//! The text of a draft.

use std::path::{Component, Path};

use super::alike::Both;
use super::guess::{self, Guess, Named};
use super::look::{Look, short};
use super::names::Names;
use super::{Group, With};
use crate::data::RecordKind;
use crate::data::write::yaml_text;
use crate::import::mapping::Convention;
use crate::import::mapping::agree::{is_gravity, record_of};
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
    if groups.iter().map(|group| group.files.as_str()).chain([with.protocol]).any(is_outside) {
        let line = "# It names files outside its folder: move it beside them, or add `--allow-outside` to the import.";
        out.line(0, line, &[]);
    }
    out.open(0, "name", "the name of the campaign");
    out.entry(0, "protocol", with.protocol, &[]);
    let sections = groups.first().map_or(&[][..], |group| &group.sections);
    let why = format!("the table of sections; the files have {}", listed(sections));
    out.open(0, "sections", &why);
    let needed: Vec<&str> = with
        .needs
        .vehicle
        .iter()
        .filter(|need| need.required)
        .map(|need| need.key.as_str())
        .collect();
    if !needed.is_empty() {
        let why = format!("the vehicle file; the protocol needs {}", needed.join(", "));
        out.open(0, "vehicle", &why);
    }
    let names = names(groups, with.convention);
    let mut left: Vec<RecordKind> = vec![RecordKind::Measurement, RecordKind::Simulation];
    for (at, group) in groups.iter().enumerate() {
        let stated = group.kind.filter(|kind| left.contains(kind));
        let Some(kind) = stated.or(left.first().copied()) else {
            out.line(0, &format!("# not used, its channels are others: {}", group.files), &[]);
            continue;
        };
        left.retain(|other| *other != kind);
        let other = groups.iter().zip(&names).enumerate().find(|(other, _)| *other != at);
        let both = other.and_then(|(_, (other, of_other))| {
            Both::new([group, other], [&names[at], of_other], with.convention)
        });
        side(&mut out, group, (kind, stated.is_some()), with, (&names[at], both.as_ref()));
        if group.sections != groups[0].sections {
            let names = listed(&group.sections);
            let line = format!("# its sections are {names}: they must be the names of the table");
            out.line(0, &line, &[]);
        }
    }
    (out.text, out.open)
}

/// Whether a path leads out of the folder of the draft.
fn is_outside(path: &str) -> bool {
    let parts = Path::new(path).components();
    parts.into_iter().any(|part| !matches!(part, Component::Normal(_) | Component::CurDir))
}

/// What the names of each group say. Where digits may be read by several orders, the other side of
/// the campaign may decide.
fn names(groups: &[Group], convention: &Convention) -> Vec<Names> {
    let mut all: Vec<Names> =
        groups.iter().map(|group| Names::read(&group.looks, convention)).collect();
    for at in 0..all.len() {
        let others = (0..all.len()).filter(|other| *other != at && all[*other].orders.len() < 2);
        let decides = |other: usize| {
            Both::new([&groups[at], &groups[other]], [&all[at], &all[other]], convention)?.order()
        };
        let open = all[at].orders.len() > 1;
        if let Some((order, why)) = others.filter(|_| open).find_map(decides) {
            all[at].keep(&[order]);
            all[at].decided = Some(why);
        }
    }
    all
}

fn side(
    out: &mut Text,
    group: &Group,
    (kind, stated): (RecordKind, bool),
    with: &With<'_>,
    (names, both): (&Names, Option<&Both<'_>>),
) {
    out.text.push('\n');
    out.line(0, &format!("{}:", kind.key()), &[]);
    if !stated {
        out.open(
            2,
            "side",
            "is this the measurement or the simulation? Correct the key above and remove this line",
        );
    }
    let facts = group.first.facts.iter().map(|(name, value)| format!("{name} {value}"));
    let facts = facts.collect::<Vec<_>>().join("; ");
    let format = group.first.format.word();
    let detected = if facts.is_empty() { format.into() } else { format!("{format}: {facts}") };
    out.entry(2, "files", &group.files, &[detected]);
    if let Some(table) = &group.table {
        out.entry(2, "table", table, &[]);
    }
    let used: Vec<&ChannelNeed> = with
        .needs
        .channels
        .iter()
        .filter(|need| need.record == record_of(kind))
        .filter(|need| !["time", "distance"].contains(&need.column.as_str()))
        .collect();
    let named = Named { looks: &group.looks, convention: with.convention, names };
    let mut guesses = guess::guesses(named, &used);
    let signs = both.map(Both::signs).unwrap_or_default();
    for guess in &mut guesses {
        guess.reasons.extend(signs.get(&guess.channel).cloned());
    }
    // Told once for both sides.
    let section = group.sections.first().map_or("", String::as_str);
    for line in
        both.filter(|_| kind == RecordKind::Measurement).iter().flat_map(|both| both.lines(section))
    {
        out.line(2, &format!("# {line}"), &[]);
    }
    units(out, group, &guesses, &used);
    let looks = &group.looks;
    let mut taken: Vec<&str> = Vec::new();
    let (time, why) = guess::axis(looks, with.convention, "time", Dimension::TIME);
    match (time, looks.first().and_then(|look| look.rate)) {
        (Some(look), _) => {
            out.channel(2, "time", look, "s, ms or another unit of time", &[why, look.in_words()]);
            taken.push(&look.name);
        }
        (None, Some(rate)) => {
            let line = format!("# no channel of time; the file states {} Hz", short(rate));
            out.line(2, &line, &[]);
        }
        (None, None) => {
            out.open(2, "time", "no channel of time was found: its name, or {rate: ... Hz}")
        }
    }
    distance(out, group, with, &mut taken);
    out.line(2, "channels:", &[]);
    for guess in &guesses {
        taken.extend(guess.candidates.iter().chain(&guess.from).map(String::as_str));
        channel(out, looks, guess, used.iter().find(|need| need.column == guess.channel));
    }
    for look in looks.iter().filter(|look| !taken.contains(&look.name.as_str())) {
        out.line(4, &format!("# not mapped: {} ({})", look.name, look.in_words()), &[]);
    }
    let tables = group.first.tables.iter().filter(|table| !table.channels.is_empty());
    for (name, why) in tables.take(group.tables.max(1)).flat_map(|table| &table.left_out) {
        out.line(4, &format!("# left out: {name} ({why})"), &[]);
    }
}

/// What was guessed for a channel.
fn channel(out: &mut Text, looks: &[Look], guess: &Guess, need: Option<&&ChannelNeed>) {
    let Guess { channel, from, candidates, reasons } = guess;
    let Some(from) = from else {
        // What rules look at only where it is recorded may be absent.
        if candidates.is_empty() && need.is_none_or(|need| !need.required) {
            let line = format!("# {channel} is not needed: {}", reasons.join("; "));
            return out.line(4, &line, &[]);
        }
        let mut without = looks
            .iter()
            .filter(|look| candidates.contains(&look.name) && look.unit_text.is_empty());
        let unit =
            without.next().map(|look| format!("with its unit: {{from: {}, unit: ...}}", look.name));
        let why = reasons.iter().cloned().chain(unit).collect::<Vec<_>>().join("; ");
        return out.open(4, channel, &why);
    };
    match looks.iter().find(|look| look.name == *from) {
        Some(look) if need.is_none_or(|need| need.unit != "-") => {
            let hint = need.map_or("that of the sensor".into(), |need| {
                format!("{} in the protocol", need.unit)
            });
            out.channel(4, channel, look, &hint, reasons);
        }
        _ => out.entry(4, channel, from, reasons),
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
                let hint = if is_gravity(&unit.text, &wanted) {
                    ": gn, if accelerations are in units of gravity"
                } else {
                    ""
                };
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
        let unit = "m, km or another unit of length";
        out.channel(2, "distance", look, unit, &[why, look.in_words()]);
        return taken.push(&look.name);
    }
    let (speed, why) = guess::speed(&group.looks, with.convention);
    let Some(look) = speed else {
        let why = "neither a distance that increases nor a speed was found";
        return out.open(2, "distance", why);
    };
    out.line(2, "distance:", &[]);
    out.entry(4, "from speed", &look.name, &[why, look.in_words()]);
    if look.unit_text.is_empty() {
        out.open(4, "unit", "the file states none: m/s, km/h or another unit of speed");
    }
    let tables = group.first.tables.iter().take(group.tables.max(1));
    let facts = tables.flat_map(|table| &table.facts);
    let facts: Vec<String> = facts.map(|(name, value)| format!("{name} = {value}")).collect();
    let facts = match facts.is_empty() {
        true => String::new(),
        false => format!("; the file states {}: {{fact: NAME, unit: m}}", facts.join(", ")),
    };
    out.open(4, "start", &format!("the distance at the first sample{facts}"));
    taken.push(&look.name);
}

fn listed(names: &[String]) -> String {
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
    /// A line with comments beside it.
    fn line(&mut self, indent: usize, line: &str, comments: &[String]) {
        let plain = |text: &str| text.replace(['\n', '\r'], " ");
        let comments: Vec<String> =
            comments.iter().filter(|comment| !comment.is_empty()).map(|text| plain(text)).collect();
        let line = format!("{:indent$}{}", "", plain(line));
        self.text += &if comments.is_empty() {
            format!("{line}\n")
        } else {
            format!("{line:COMMENTS$}  # {}\n", comments.join("; "))
        };
    }

    /// A key with its value.
    fn entry(&mut self, indent: usize, key: &str, value: &str, comments: &[String]) {
        self.line(indent, &format!("{}: {}", yaml_text(key), yaml_text(value)), comments);
    }

    /// A channel of the file; its unit is open if the file states none.
    fn channel(&mut self, indent: usize, key: &str, look: &Look, unit: &str, comments: &[String]) {
        if !look.unit_text.is_empty() {
            return self.entry(indent, key, &look.name, comments);
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
