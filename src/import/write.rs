//! Writes the campaign: records, tables, vehicle, track, the mapping and an account of what was
//! done.

use std::io;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use indexmap::IndexMap;
use rayon::prelude::*;

use super::mapping::{Channels, Distance, Mapping, Runs, Side, record_path};
use super::process::{BLOCK, Column, Made, Store, Values};
use crate::data::campaign::{CAMPAIGN_FILE, RUNS};
use crate::data::origin::{Imported, ImportedRecord, ORIGIN_FILE, ORIGIN_KEY, Origin, OriginFile};
use crate::data::record::Format;
use crate::data::text::read_any;
use crate::data::write::Values::{self as FileValues, Numbers};
use crate::data::write::{
    Entry, FileColumn, Layout, Outputs, campaign_yaml_with, csv_header, csv_rows, parquet_in_groups,
};
use crate::foreign::File;
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::units::number::significant;
use crate::yaml::{Key, Literal, Node, Value, Words};

/// Significant digits of a channel: those of a 32-bit number, and more than any sensor resolves.
const DIGITS: usize = 9;
/// Significant digits of time and distance, which may begin far from zero: a micrometre at 100 km,
/// a microsecond in a day.
const AXIS_DIGITS: usize = 12;

/// Writes the record in a format; both hold the same numbers. With a store, a few rows of all
/// columns are in memory at a time, and of each worker all rows of one column.
///
/// # Errors
/// `write-failed`.
pub fn write_record(
    columns: &[Column],
    format: Format,
    store: Option<&Arc<Store>>,
    sink: &mut (dyn io::Write + Send),
) -> Result<(), Problem> {
    let of_file = |column: &Column| -> Result<(Layout, Values), Problem> {
        let digits =
            if ["time", "distance"].contains(&column.name.as_str()) { AXIS_DIGITS } else { DIGITS };
        let values = column
            .values
            .all()?
            .iter()
            .map(|value| significant(column.unit.from_si(*value), digits))
            .collect();
        let heading = format!("{} [{}]", column.name, column.unit);
        let column = FileColumn { heading, values: Numbers(values), digits: None };
        let layout = Layout::of(&column);
        let Numbers(values) = column.values else { return Ok((layout, Values::Held(Vec::new()))) };
        Ok((layout, Values::keep(values, store)?))
    };
    let columns: Vec<(Layout, Values)> =
        columns.par_iter().map(of_file).collect::<Result<_, _>>()?;
    let rows = columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let (layouts, columns): (Vec<Layout>, Vec<Values>) = columns.into_iter().unzip();
    let part = |range: Range<usize>| -> Result<Vec<FileValues>, Problem> {
        columns.iter().map(|values| Ok(Numbers(values.part(range.clone())?.into_owned()))).collect()
    };
    let failed = |error: io::Error| {
        Problem::error("write-failed", format!("a record cannot be written: {error}"))
    };
    match format {
        Format::Csv => {
            let headings: Vec<&str> = layouts.iter().map(Layout::heading).collect();
            sink.write_all(csv_header(&headings).as_bytes()).map_err(failed)?;
            for start in (0..rows).step_by(BLOCK) {
                let file = |(heading, values): (&&str, FileValues)| FileColumn {
                    heading: (*heading).to_string(),
                    values,
                    digits: None,
                };
                let some: Vec<FileColumn> =
                    headings.iter().zip(part(start..start + BLOCK)?).map(file).collect();
                sink.write_all(csv_rows(&some).as_bytes()).map_err(failed)?;
            }
            Ok(())
        }
        Format::Parquet => parquet_in_groups(&layouts, rows, part, sink),
    }
}

/// The bytes of a record that is in memory.
///
/// # Errors
/// `write-failed`.
pub fn record_bytes(columns: &[Column], format: Format) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    write_record(columns, format, None, &mut bytes)?;
    Ok(bytes)
}

/// A file that is read, by the path in the mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFile {
    pub path: String,
    pub sha256: String,
    /// What was detected in it.
    pub read_as: String,
}

impl SourceFile {
    /// The format and what was detected in it stand in a line.
    pub fn new(path: &str, file: &File) -> Self {
        let facts = file.facts.iter().map(|(name, value)| format!("{name} {value}"));
        let all: Vec<String> =
            std::iter::once(file.format.word().to_string()).chain(facts).collect();
        Self { path: path.to_string(), sha256: file.sha256.clone(), read_as: all.join("; ") }
    }
}

/// How a record was made: its side, section and file, and the steps.
pub fn account(made: &Made, file: &SourceFile) -> ImportedRecord {
    ImportedRecord {
        side: made.kind.key().into(),
        section: made.section.clone(),
        file: file.path.clone(),
        read_as: file.read_as.clone(),
        steps: made.steps.clone(),
    }
}

/// A file of the campaign that is copied as it is.
#[derive(Debug)]
pub struct Copied {
    /// The path in the mapping, and where it stands there.
    pub written: Spanned<String>,
    /// The path inside the campaign.
    pub inside: String,
    pub bytes: Vec<u8>,
}

/// The small files that the mapping names: those that a check of the campaign reads.
///
/// # Errors
/// A file cannot be read.
pub fn small_files(mapping: &Mapping) -> Result<Vec<Copied>, Problem> {
    let own = mapping
        .protocol
        .as_ref()
        .filter(|protocol| crate::library::shipped(&protocol.value).is_none());
    let vehicle = mapping.vehicle.as_ref().map(|(written, _)| written);
    let all = own.into_iter().chain(vehicle).chain(table(mapping)).chain(&mapping.copies);
    all.map(|written| copied(mapping, written, &written.value, file(&written.value))).collect()
}

fn copied(
    mapping: &Mapping,
    named: &Spanned<String>,
    written: &str,
    inside: String,
) -> Result<Copied, Problem> {
    let (path, shown) = mapping.place(written);
    let bytes = read_any(&path, &shown).map_err(|problem| problem.or_at(&named.span))?;
    Ok(Copied { written: Spanned::new(written.to_string(), named.span.clone()), inside, bytes })
}

/// The name of a file without its folders.
fn file(written: &str) -> String {
    written.rsplit(['/', '\\']).next().unwrap_or(written).to_string()
}

/// The table of sections, of whole records or of runs.
fn table(mapping: &Mapping) -> Option<&Spanned<String>> {
    let of_sections = mapping.sections.table.as_ref().map(|(written, _)| written);
    of_sections.or(mapping.runs.as_ref().and_then(|runs| runs.table.as_ref()))
}

fn text_node(text: impl Into<String>, at: &Span) -> Node {
    let text = text.into();
    Node { raw: text.clone(), value: Value::Text(text), span: at.clone(), exact: false }
}

fn key(text: &str, at: &Span) -> Key {
    Key { text: text.to_string(), span: at.clone(), exact: false }
}

/// `campaign.yaml`, each part with its place in the mapping, without the account of the import.
pub fn campaign_tree(mapping: &Mapping, format: Format) -> Node {
    let mut entries: Vec<(Key, Node)> = Vec::new();
    let mut add = |name: &str, node: Node| entries.push((key(name, &node.span), node));
    add("name", text_node(mapping.name.value.as_str(), &mapping.name.span));
    if let Some(named) = &mapping.protocol {
        let shipped = crate::library::shipped(&named.value).is_some();
        add(
            "protocol",
            text_node(if shipped { named.value.clone() } else { file(&named.value) }, &named.span),
        );
    }
    if let Some((written, _)) = &mapping.vehicle {
        add("vehicle", text_node(file(&written.value), &written.span));
    }
    if let Some(written) = table(mapping) {
        add("sections", text_node(file(&written.value), &written.span));
    }
    if let Some(runs) = &mapping.runs {
        add(RUNS, of_runs(mapping, runs, format));
    } else {
        mapping
            .sides
            .iter()
            .for_each(|side| add(side.kind.key(), text_node(side.kind.key(), &side.span)));
        mapping.track.iter().for_each(|track| add("track", text_node("track", &track.span)));
    }
    entries.extend(mapping.campaign.iter().cloned());
    Node {
        value: Value::Map(entries),
        raw: String::new(),
        span: mapping.source.whole(),
        exact: false,
    }
}

/// Adds all files but the records.
///
/// # Errors
/// A file that the mapping names cannot be read; `write-failed`, `path-outside`.
pub fn add_campaign(
    outputs: &mut Outputs,
    mapping: &Mapping,
    format: Format,
    sources: &[SourceFile],
    records: Vec<ImportedRecord>,
) -> Result<(), Problem> {
    let mut of_copies: Vec<OriginFile> = Vec::new();
    let mut copy = |outputs: &mut Outputs, file: &Copied| -> Result<(), Problem> {
        of_copies.push(OriginFile {
            path: file.written.value.clone(),
            sha256: crate::data::hash::sha256(&file.bytes),
        });
        outputs.add(&file.inside, &file.bytes)
    };
    for file in small_files(mapping)? {
        copy(outputs, &file)?;
    }
    if let Some(pattern) = &mapping.track {
        for name in &mapping.sections.names {
            let written = mapping.sections.fill(&pattern.value, &name.value);
            copy(outputs, &copied(mapping, pattern, &written, track_path(pattern, &name.value))?)?;
        }
    }
    let tree = campaign_tree(mapping, format);
    let text = campaign_yaml_with(&tree, &[], &[(ORIGIN_KEY, Entry::Text(ORIGIN_FILE))]);
    outputs.add(CAMPAIGN_FILE, text.as_bytes())?;
    let sources = sources
        .iter()
        .map(|source| OriginFile { path: source.path.clone(), sha256: source.sha256.clone() });
    let origin = Origin {
        program: Literal(concat!("fishplate ", env!("CARGO_PKG_VERSION")).to_string()),
        command: Literal("import".into()),
        campaign: Literal(mapping.name.value.clone()),
        sources: sources.chain(of_copies).collect(),
        imported: Some(Imported {
            mapping: Literal(mapping.source.text.replace("\r\n", "\n")),
            channels: channels(mapping),
            records,
        }),
        ..Origin::default()
    };
    outputs.add(ORIGIN_FILE, origin.text().as_bytes())
}

/// The track file of a section or a run in the campaign; it keeps its format.
fn track_path(pattern: &Spanned<String>, name: &str) -> String {
    format!("track/{name}.{}", Format::of(Path::new(&pattern.value)).ending())
}

/// The block `runs`: the files of each run, and what the mapping says of it.
fn of_runs(mapping: &Mapping, runs: &Runs, format: Format) -> Node {
    let of_one =
        |(name, facts): (&Spanned<String>, &Vec<(Key, Node)>)| {
            let at = &name.span;
            let record = |side: &Side| {
                (
                    key(side.kind.key(), at),
                    text_node(record_path(side.kind, &name.value, format.ending()), at),
                )
            };
            let mut entries: Vec<(Key, Node)> = mapping.sides.iter().map(record).collect();
            entries.extend(mapping.track.iter().map(|pattern| {
                (key("track", at), text_node(track_path(pattern, &name.value), at))
            }));
            entries.extend(facts.iter().cloned());
            (key(&name.value, at), Node { value: Value::Map(entries), ..text_node("", at) })
        };
    let entries = mapping.sections.names.iter().zip(&runs.facts).map(of_one).collect();
    Node { value: Value::Map(entries), ..text_node("", &mapping.sections.span) }
}

/// What the channels of each side were made of.
fn channels(mapping: &Mapping) -> IndexMap<String, Vec<String>> {
    let of_side = |side: &Side| {
        let mut lines: Vec<String> = match &side.channels {
            Channels::AsNamed => vec!["every channel as named in the file".into()],
            Channels::Maps(maps) => {
                maps.iter().map(|map| format!("{} = {}", map.name.value, map.in_words())).collect()
            }
        };
        if let Some(Distance::Channel(map)) = &side.distance {
            lines.insert(0, format!("distance = {}", map.in_words()));
        }
        let names = |list: &[Spanned<String>]| {
            list.iter().map(|name| name.value.as_str()).collect::<Vec<_>>().join(" or ")
        };
        if !side.time.from.0.is_empty() {
            lines.insert(0, format!("time = {}", names(&side.time.from.0)));
        }
        lines.extend(
            side.units.iter().map(|(key, unit)| format!("unit `{}` read as {unit}", key.text)),
        );
        (side.kind.key().to_string(), lines)
    };
    mapping.sides.iter().map(of_side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::write::{csv, parquet};
    use crate::disk::ScratchFile;
    use crate::units::Unit;

    #[test]
    fn numbers_keep_nine_digits_and_no_more() {
        let unit = |text: &str| Unit::parse(text).expect("known");
        let columns = [
            Column {
                name: "time".into(),
                unit: unit("s"),
                values: Values::Held(vec![86_399.000_5, 86_399.005_5]),
            },
            Column {
                name: "Y".into(),
                unit: unit("kN"),
                values: Values::Held(vec![f64::from(1130.1_f32), -0.0]),
            },
            Column {
                name: "a".into(),
                unit: unit("m/s^2"),
                values: Values::Held(vec![0.1 * 9.806_65 * 3.0, 1e-7]),
            },
        ];
        let text = String::from_utf8(record_bytes(&columns, Format::Csv).expect("written"))
            .expect("a text");
        assert_eq!(
            text,
            "time [s],Y [kN],a [m/s^2]\n86399.0005,1.13009998,2.941995\n86399.0055,0,1e-7\n"
        );
        assert!(record_bytes(&columns, Format::Parquet).expect("written").starts_with(b"PAR1"));
    }

    /// Written in blocks from a file, a record is the same bytes as from memory, and as its columns
    /// written at once.
    #[test]
    fn blocks_do_not_change_the_bytes() {
        let unit = |text: &str| Unit::parse(text).expect("known");
        for rows in [1, 100, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 2 * BLOCK + 5] {
            let times: Vec<f64> = (0..rows).map(|row| row as f64 * 0.005).collect();
            let force: Vec<f64> = times.iter().map(|time| 4000.0 * (time * 7.3).sin()).collect();
            let flag: Vec<f64> =
                (0..rows).map(|row| if row % BLOCK < 70 { 1.0 } else { 0.0 }).collect();
            let columns = [("time", "s", times), ("Y", "kN", force), ("flag", "1", flag)];
            let store = Store::new(ScratchFile::new(&std::env::temp_dir()).expect("a file"));
            let kept = |store: Option<&Arc<Store>>| -> Vec<Column> {
                let column = |(name, text, values): &(&str, &str, Vec<f64>)| Column {
                    name: (*name).to_string(),
                    unit: unit(text),
                    values: Values::keep(values.clone(), store).expect("kept"),
                };
                columns.iter().map(column).collect()
            };
            for format in [Format::Csv, Format::Parquet] {
                let held = record_bytes(&kept(None), format).expect("written");
                let mut stored = Vec::new();
                write_record(&kept(Some(&store)), format, Some(&store), &mut stored)
                    .expect("written");
                assert!(stored == held, "{rows} rows, {format:?}");
                let file = |(name, text, values): &(&str, &str, Vec<f64>)| {
                    let digits = if *name == "time" { AXIS_DIGITS } else { DIGITS };
                    let values = Numbers(
                        values
                            .iter()
                            .map(|value| significant(unit(text).from_si(*value), digits))
                            .collect(),
                    );
                    FileColumn { heading: format!("{name} [{}]", unit(text)), values, digits: None }
                };
                let all: Vec<FileColumn> = columns.iter().map(file).collect();
                let at_once =
                    if format == Format::Csv { csv(&all) } else { parquet(&all).expect("written") };
                assert!(held == at_once, "{rows} rows, {format:?}, at once");
            }
        }
    }
}
