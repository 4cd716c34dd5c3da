//! One side of the campaign: the measurement or the simulation.

use super::channels::{AS_NAMED, Channels};
use super::distance::{Distance, Jumps, Match, SideDistance, SideTime, Time};
use super::runs::Drift;
use super::sections::{self, Sections};
use super::stated::Stated;
use crate::data::RecordKind;
use crate::foreign::Options;
use crate::problem::{error, warning};
use crate::source::{Span, Spanned};
use crate::units::Unit;
use crate::yaml::{Entries, FromNode, Hertz, Key, Metres, Node, Reader, Value, fields};

/// Names that only axes have.
const AXES: [&str; 2] = ["time", "distance"];

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
    pub units: Vec<(Key, Unit)>,
    pub time: Time,
    pub distance: Option<Distance>,
    pub matched: Option<Match>,
    pub jumps: Option<Jumps>,
    /// Wanted sampling rate, and where it is stated.
    pub rate: Option<Spanned<Hertz>>,
    pub channels: Channels,
    /// Added to the distance, by section.
    pub offsets: Option<Stated<Metres>>,
    pub turned: Turned,
    /// Of the measurement.
    pub drift: Option<Drift>,
}

fields! {
    /// A side as it is written.
    struct Written in &Sections: "`{key}`" {
        "files" files: Option<Spanned<String>> => "the path of the records, with `{section}` or `{run}`",
        "table" table: Option<Spanned<String>>,
        "format" format: Options = Options::default(),
        "units" units: Entries<Unit>,
        "time" time: Option<SideTime>,
        "distance" distance: Option<SideDistance>,
        "rate" rate: Option<Spanned<Hertz>>,
        "channels" channels: Option<Channels>,
        "offsets" offsets: Option<Spanned<Stated<Metres>>>,
        "turned" turned: Turned = Turned::None,
        "drift" drift: Option<Drift>,
    }
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

/// A side of the mapping, if it is there.
pub fn read(reader: &mut Reader<'_, &Sections>, kind: RecordKind, mapping: &Node) -> Option<Side> {
    let (key, node) = mapping.entry(kind.key())?;
    let written = Written::from_node(reader, key, node)?;
    let sections = reader.with;
    for pattern in written.files.iter().chain(&written.table) {
        sections::check_placeholders(reader, pattern);
    }
    let fixed = |text: &Spanned<String>| !text.value.contains('{');
    if let Some(files) = &written.files
        && fixed(files)
        && written.table.as_ref().is_none_or(fixed)
        && sections.names.len() > 1
        && node.get("distance").is_none()
    {
        let word = sections.word;
        let says =
            format!("every {word} is read from `{}`, each as its own stretch of it", files.value);
        reader.tell(warning("one-file", says, &files.span).help(format!(
            "write `{{{word}}}` where the name of the {word} stands in the path or in `table`"
        )));
    }
    let time = written.time.map(|time| time.0);
    let time = time.unwrap_or_else(|| Time::from_file(Vec::new(), key.span.clone()));
    let SideDistance(distance, matched, jumps) = written.distance.unwrap_or_default();
    if let Some(rate) = written.rate.as_ref().filter(|rate| rate.value.0 <= 0.0) {
        reader.fault("out-of-range", "the rate must be above zero", &rate.span);
    }
    if let (Some(offsets), RecordKind::Measurement) = (&written.offsets, kind)
        && sections.has_column("offset")
    {
        let says = "the table of sections has a column `offset` as well, and both would be added";
        let problem = error("offset-twice", says, &offsets.span);
        reader.tell(problem.help("remove one of them"));
    }
    if let Some(drift) = &written.drift {
        if kind == RecordKind::Simulation {
            let says = "`drift` stands with the measurement, whose distance is corrected";
            let problem = error("contradiction", says, &drift.span);
            reader.tell(problem.help("move it to `measurement`"));
        }
        if node.get("distance").is_none() {
            let says = "`drift` needs a distance, and none is stated: `distance`";
            reader.fault("contradiction", says, &drift.span);
        }
    }
    if node.get("channels").is_none() {
        let says = "`channels` is missing: what each channel of the campaign is in the file";
        let help = format!("write `channels: {AS_NAMED}` if every channel keeps its name");
        reader.tell(error("key-missing", says, &key.span).help(help));
    }
    let channels = written.channels?;
    let names = channels.maps().unwrap_or_default().iter().map(|map| &map.name);
    for Spanned { value: name, span } in names.filter(|name| AXES.contains(&name.value.as_str())) {
        let says = format!("`{name}` stands among the channels");
        let help = format!("write `{name}:` beside `channels:`");
        reader.tell(error("axis-among-channels", says, span).help(help));
    }
    Some(Side {
        kind,
        span: key.span.clone(),
        files: written.files?,
        table: written.table,
        format: written.format,
        units: written.units.0,
        time,
        distance,
        matched,
        jumps,
        rate: written.rate,
        channels,
        offsets: written.offsets.map(|offsets| offsets.value),
        turned: written.turned,
        drift: written.drift,
    })
}

/// `all`, a list of sections, or a column with words.
impl FromNode<&Sections> for Turned {
    fn from_node(reader: &mut Reader<'_, &Sections>, key: &Key, node: &Node) -> Option<Self> {
        let span = node.span.clone();
        match &node.value {
            Value::List(_) => {
                let names: Vec<Spanned<String>> = Vec::from_node(reader, key, node)?;
                for name in &names {
                    sections::known(reader, &name.value, &name.span);
                }
                Some(Self::Sections(names.into_iter().map(|name| name.value).collect(), span))
            }
            Value::Map(entries) => {
                let [(column, words)] = entries.as_slice() else {
                    let says =
                        "`turned` must name one column of the table of sections and its words";
                    reader.fault("wrong-kind", says, &span);
                    return None;
                };
                sections::check_column(reader, &column.text, &column.span);
                let words = match &words.value {
                    Value::List(items) => items.iter().map(|item| item.raw.clone()).collect(),
                    _ => vec![words.raw.clone()],
                };
                Some(Self::Where(column.text.clone(), words, span))
            }
            _ if node.scalar_text() == Some("all") => Some(Self::All(span)),
            _ => {
                let says = "`turned` must be `all`, a list of sections, or a column with words";
                let problem = error("wrong-kind", says, &span);
                reader.tell(
                    problem.help("write `turned: [S01, S02]`, or `turned: {leading end: B}`"),
                );
                None
            }
        }
    }
}
