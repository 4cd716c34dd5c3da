//! One side of the campaign: the measurement or the simulation.

use super::channels::{self, Channels};
use super::distance::{self, Distance, Match, Time};
use super::format;
use super::reader::{Reader, hertz, metre};
use super::runs::{self, Drift};
use super::sections::{self, Sections};
use super::stated::{self, Stated};
use crate::data::RecordKind;
use crate::foreign::Options;
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::units::Unit;
use crate::yaml::{Key, Node, Value};

const KEYS: [&str; 11] = [
    "files", "table", "format", "units", "time", "distance", "rate", "channels", "offsets",
    "turned", "drift",
];

#[derive(Debug)]
pub struct Side {
    pub kind: RecordKind,
    /// The key.
    pub span: Span,
    /// Path with placeholders.
    pub files: Spanned<String>,
    /// Name of the sheet, group or struct, with placeholders; every one of the file if it is not
    /// stated.
    pub table: Option<Spanned<String>>,
    pub format: Options,
    /// Unit texts of the files, and what they mean.
    pub units: Vec<(String, Unit)>,
    pub time: Time,
    pub distance: Option<Distance>,
    pub matched: Option<Match>,
    /// Wanted sampling rate in Hz, and where it is stated.
    pub rate: Option<Spanned<f64>>,
    pub channels: Channels,
    /// Added to the distance, by section.
    pub offsets: Option<Stated>,
    pub turned: Turned,
    /// Of the measurement.
    pub drift: Option<Drift>,
}

/// Sections that were run with the other end of the vehicle leading.
#[derive(Clone, Debug)]
pub enum Turned {
    None,
    All(Span),
    Sections(Vec<String>, Span),
    /// Those with one of the words in a column.
    Where(String, Vec<String>, Span),
}

impl Turned {
    pub fn span(&self) -> Option<&Span> {
        match self {
            Self::None => None,
            Self::All(span) | Self::Sections(_, span) | Self::Where(_, _, span) => Some(span),
        }
    }

    pub fn has(&self, section: &str, sections: &Sections) -> bool {
        match self {
            Self::None => false,
            Self::All(_) => true,
            Self::Sections(names, _) => names.iter().any(|name| name == section),
            Self::Where(column, words, _) => {
                sections.cell(section, column).is_some_and(|cell| words.contains(&cell.value))
            }
        }
    }
}

pub(super) fn read(
    reader: &mut Reader<'_>,
    kind: RecordKind,
    key: &Key,
    node: &Node,
    sections: &Sections,
) -> Option<Side> {
    let of_format = |key: &Key, value: &Node| {
        let known = format::KEYS.contains(&key.text.as_str());
        known.then(|| {
            format!("`{0}` stands in `format`: `format: {{{0}: {1}}}`", key.text, value.raw)
        })
    };
    if !reader.keys_or(node, &KEYS, &format!("`{}`", kind.key()), of_format) {
        return None;
    }
    let files = reader.need_text(
        node,
        "files",
        &format!("the path of the records, with `{{{}}}`", sections.word),
    );
    let table = reader.text(node, "table");
    for pattern in files.iter().chain(&table) {
        sections.check_placeholders(pattern, reader);
    }
    if let Some(files) = files.as_ref().filter(|files| {
        !files.value.contains('{') && table.as_ref().is_none_or(|table| !table.value.contains('{'))
    }) && sections.names.len() > 1
    {
        let problem = Problem::warning(
            "one-file",
            format!(
                "every {} is read from `{}`, each as its own stretch of it",
                sections.word, files.value
            ),
        );
        if node.get("distance").is_none() {
            reader.problems.push(problem.at(&files.span).help(format!(
                "write `{{{0}}}` where the name of the {0} stands in the path or in `table`",
                sections.word
            )));
        }
    }
    let format =
        node.get("format").map_or_else(Options::default, |node| format::read(reader, node));
    let units = units(reader, node);
    let time = distance::time(reader, node.get("time"), &key.span, sections);
    let (distance, matched) = node
        .entry("distance")
        .map_or((None, None), |(key, node)| distance::distance(reader, key, node, sections));
    let rate = reader
        .number(node, "rate", &hertz())
        .map(|rate| Spanned::new(rate, stated::place(node.get("rate"), &node.span)));
    if let Some(rate) = rate.as_ref().filter(|rate| rate.value <= 0.0) {
        reader.fault("out-of-range", "the rate must be above zero", &rate.span);
    }
    let offsets = node
        .get("offsets")
        .and_then(|node| stated::read(reader, node, "offsets", &metre(), sections));
    if let (Some(_), true, RecordKind::Measurement) =
        (&offsets, sections.has_column("offset"), kind)
    {
        let problem = Problem::error(
            "offset-twice",
            "the table of sections has a column `offset` as well, and both would be added",
        );
        reader.problems.push(
            problem.at(&stated::place(node.get("offsets"), &node.span)).help("remove one of them"),
        );
    }
    let turned = turned(reader, node, sections);
    let drift = runs::drift(reader, node, sections);
    if let (Some(drift), RecordKind::Simulation) = (&drift, kind) {
        let problem = Problem::error(
            "contradiction",
            "`drift` stands with the measurement, whose distance is corrected",
        )
        .at(&drift.span);
        reader.problems.push(problem.help("move it to `measurement`"));
    }
    if let Some(drift) = drift.as_ref().filter(|_| node.get("distance").is_none()) {
        reader.fault(
            "contradiction",
            "`drift` needs a distance, and none is stated: `distance`",
            &drift.span,
        );
    }
    let Some(channels) = node.get("channels") else {
        let problem = Problem::error(
            "key-missing",
            "`channels` is missing: what each channel of the campaign is in the file",
        );
        reader.problems.push(problem.at(&key.span).help(format!(
            "write `channels: {}` if every channel keeps its name",
            channels::AS_NAMED
        )));
        return None;
    };
    let channels = channels::read(reader, channels)?;
    for map in channels.maps().unwrap_or_default() {
        if ["time", "distance"].contains(&map.name.value.as_str()) {
            let problem = Problem::error(
                "axis-among-channels",
                format!("`{}` stands among the channels", map.name.value),
            )
            .at(&map.name.span);
            reader
                .problems
                .push(problem.help(format!("write `{}:` beside `channels:`", map.name.value)));
        }
    }
    Some(Side {
        kind,
        span: key.span.clone(),
        files: files?,
        table,
        format,
        units,
        time,
        distance,
        matched,
        rate,
        channels,
        offsets,
        turned,
        drift,
    })
}

/// `units: {g: gn}`: what the unit texts of the files mean, where they are not those of this
/// program or mean something else here.
fn units(reader: &mut Reader<'_>, node: &Node) -> Vec<(String, Unit)> {
    let Some(node) = node.get("units") else { return Vec::new() };
    if !matches!(node.value, Value::Map(_)) {
        reader.fault(
            "wrong-kind",
            format!("`units` must be a map of unit texts, not {}", node.kind_in_words()),
            &node.span,
        );
    }
    let mut found = Vec::new();
    for (key, node) in node.entries() {
        if let Some(unit) = reader.text_of(node, "units").and_then(|written| reader.unit(&written))
        {
            found.push((key.text.clone(), unit));
        }
    }
    found
}

fn turned(reader: &mut Reader<'_>, node: &Node, sections: &Sections) -> Turned {
    let Some(node) = node.get("turned") else { return Turned::None };
    let span = node.span.clone();
    match &node.value {
        Value::List(items) => {
            let names: Vec<Spanned<String>> =
                items.iter().filter_map(|item| reader.text_of(item, "turned")).collect();
            names
                .iter()
                .for_each(|name| sections::known(reader, sections, &name.value, &name.span));
            Turned::Sections(names.into_iter().map(|name| name.value).collect(), span)
        }
        Value::Map(entries) => {
            let [(column, words)] = entries.as_slice() else {
                reader.fault(
                    "wrong-kind",
                    "`turned` must name one column of the table of sections and its words",
                    &span,
                );
                return Turned::None;
            };
            if !sections.has_column(&column.text) {
                let problem = Problem::error(
                    "unknown-column",
                    format!("the table of sections has no column `{}`", column.text),
                );
                reader
                    .problems
                    .push(problem.at(&column.span).suggest(&column.text, sections.columns()));
            }
            let words = match &words.value {
                Value::List(items) => items.iter().map(|item| item.raw.clone()).collect(),
                _ => vec![words.raw.clone()],
            };
            Turned::Where(column.text.clone(), words, span)
        }
        _ if node.scalar_text() == Some("all") => Turned::All(span),
        _ => {
            let problem = Problem::error(
                "wrong-kind",
                "`turned` must be `all`, a list of sections, or a column with words",
            )
            .at(&span);
            reader
                .problems
                .push(problem.help("write `turned: [S01, S02]`, or `turned: {leading end: B}`"));
            Turned::None
        }
    }
}
