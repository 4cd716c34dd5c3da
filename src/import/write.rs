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
use crate::data::RecordKind;
use crate::data::campaign::{CAMPAIGN_FILE, RUNS};
use crate::data::hash::sha256;
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
/// Least significant digits of time and distance, which may begin far from zero: a micrometre at
/// 100 km, a microsecond in a day. Of seconds since 1970, more are needed.
const AXIS_DIGITS: usize = 12;
/// Digits of a step of an axis: a thousandth of it at least. Steps are even to one part in a
/// hundred or better.
const STEP_DIGITS: f64 = 4.0;
/// Digits that a double has.
const MOST_DIGITS: f64 = 17.0;

/// Significant digits of an axis: a thousandth of its mean step is told.
fn axis_digits(values: &[f64]) -> usize {
    let (Some(first), Some(last)) = (values.first(), values.last()) else { return AXIS_DIGITS };
    let step = (last - first).abs() / (values.len().max(2) - 1) as f64;
    let digits = (first.abs().max(last.abs()) / step).log10().ceil() + STEP_DIGITS;
    if digits.is_finite() { AXIS_DIGITS.max(digits.min(MOST_DIGITS) as usize) } else { AXIS_DIGITS }
}

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
        let values = column.values.all()?;
        let is_axis = ["time", "distance"].contains(&column.name.as_str());
        let digits = if is_axis { axis_digits(&values) } else { DIGITS };
        let values =
            values.iter().map(|value| significant(column.unit.from_si(*value), digits)).collect();
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
            let headings: Vec<&str> =
                layouts.iter().map(|layout| layout.heading.as_str()).collect();
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
    pub file: OriginFile,
    /// The format and what was detected in it, in a line.
    pub read_as: String,
}

impl SourceFile {
    pub fn new(path: &str, file: &File) -> Self {
        let facts = file.facts.iter().map(|(name, value)| format!("{name} {value}"));
        let all: Vec<String> =
            std::iter::once(file.format.word().to_string()).chain(facts).collect();
        let file = OriginFile { path: path.to_string(), sha256: file.sha256.clone() };
        Self { file, read_as: all.join("; ") }
    }
}

/// How the record that was added last was made: its side, section and file, and the steps.
pub fn account(made: &Made, source: &SourceFile, outputs: &Outputs) -> ImportedRecord {
    let file =
        |(path, sha256): (&str, &str)| OriginFile { path: path.into(), sha256: sha256.into() };
    ImportedRecord {
        side: made.kind.key().into(),
        section: made.section.clone(),
        file: source.file.path.clone(),
        read_as: source.read_as.clone(),
        steps: made.steps.clone(),
        written: outputs.hashes().next_back().map(file),
    }
}

/// A file of the campaign that is copied as it is.
#[derive(Debug)]
pub struct Copied {
    /// The path in the mapping, and where it stands there.
    pub written: Spanned<String>,
    /// Its name in messages.
    pub shown: String,
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
    all.map(|written| copied(mapping, written, &written.value, file(&written.value).to_string()))
        .collect()
}

fn copied(
    mapping: &Mapping,
    named: &Spanned<String>,
    written: &str,
    inside: String,
) -> Result<Copied, Problem> {
    let place = mapping.paths.place(written, &named.span)?;
    let read = read_any(&place.path, &place.shown);
    let (shown, bytes) = (place.shown, read.map_err(|problem| problem.or_at(&named.span))?);
    let written = Spanned::new(written.to_string(), named.span.clone());
    Ok(Copied { written, shown, inside, bytes })
}

/// The name of a file without its folders.
fn file(written: &str) -> &str {
    written.rsplit(['/', '\\']).next().unwrap_or(written)
}

/// The table of sections, of whole records or of runs.
fn table(mapping: &Mapping) -> Option<&Spanned<String>> {
    let of_sections = mapping.sections.table.as_ref().map(|(written, _)| written);
    of_sections.or(mapping.runs.as_ref().and_then(|runs| runs.table.as_ref()))
}

/// A text under a key.
fn entry(name: &str, text: impl Into<String>, at: &Span) -> (Key, Node) {
    let text = text.into();
    let node = Node { raw: text.clone(), value: Value::Text(text), span: at.clone(), exact: false };
    (Key { text: name.to_string(), span: at.clone(), exact: false }, node)
}

/// A map under a key.
fn map(name: &str, entries: Vec<(Key, Node)>, at: &Span) -> (Key, Node) {
    let (key, node) = entry(name, "", at);
    (key, Node { value: Value::Map(entries), ..node })
}

/// `campaign.yaml`, each part with its place in the mapping, without the account of the import.
pub fn campaign_tree(mapping: &Mapping, format: Format) -> Node {
    let mut entries = vec![entry("name", mapping.name.value.as_str(), &mapping.name.span)];
    if let Some(Spanned { value: named, span }) = &mapping.protocol {
        let shipped = crate::library::shipped(named).is_some();
        entries.push(entry("protocol", if shipped { named } else { file(named) }, span));
    }
    let vehicle = mapping.vehicle.as_ref().map(|(written, _)| written);
    for (name, written) in [("vehicle", vehicle), ("sections", table(mapping))] {
        entries.extend(written.map(|written| entry(name, file(&written.value), &written.span)));
    }
    if let Some(runs) = &mapping.runs {
        entries.push(of_runs(mapping, runs, format));
    } else {
        let sides = mapping.sides.iter().map(|side| (side.kind.key(), &side.span));
        let track = mapping.track.iter().map(|track| ("track", &track.span));
        entries.extend(sides.chain(track).map(|(name, at)| entry(name, name, at)));
    }
    entries.extend(mapping.campaign.iter().cloned());
    map("", entries, &mapping.source.whole()).1
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
    mut records: Vec<ImportedRecord>,
) -> Result<(), Problem> {
    let mut sources: Vec<OriginFile> = sources.iter().map(|source| source.file.clone()).collect();
    let mut copy = |outputs: &mut Outputs, file: Copied| -> Result<OriginFile, Problem> {
        outputs.add(&file.inside, &file.bytes)?;
        let inside = OriginFile { path: file.inside, sha256: sha256(&file.bytes) };
        sources.push(OriginFile { path: file.written.value, ..inside.clone() });
        Ok(inside)
    };
    for file in small_files(mapping)? {
        copy(outputs, file)?;
    }
    if let Some(pattern) = &mapping.track {
        for name in &mapping.sections.names {
            let file = mapping.sections.fill(&pattern.value, &name.value);
            let copied = copied(mapping, pattern, &file, track_path(pattern, &name.value))?;
            records.push(ImportedRecord {
                side: RecordKind::Track.key().into(),
                section: name.value.clone(),
                file,
                read_as: "copied".into(),
                steps: Vec::new(),
                written: Some(copy(outputs, copied)?),
            });
        }
    }
    let tree = campaign_tree(mapping, format);
    let text = campaign_yaml_with(&tree, &[], &[(ORIGIN_KEY, Entry::Text(ORIGIN_FILE))]);
    outputs.add(CAMPAIGN_FILE, text.as_bytes())?;
    let origin = Origin {
        program: Literal(concat!("fishplate ", env!("CARGO_PKG_VERSION")).to_string()),
        command: Literal("import".into()),
        campaign: Literal(mapping.name.value.clone()),
        sources,
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
fn of_runs(mapping: &Mapping, runs: &Runs, format: Format) -> (Key, Node) {
    let of_run = |(name, facts): (&Spanned<String>, &Vec<(Key, Node)>)| {
        let Spanned { value: name, span: at } = name;
        let records = mapping
            .sides
            .iter()
            .map(|side| entry(side.kind.key(), record_path(side.kind, name, format.ending()), at));
        let track = mapping.track.iter();
        let track = track.map(|pattern| entry("track", track_path(pattern, name), at));
        map(name, records.chain(track).chain(facts.iter().cloned()).collect(), at)
    };
    let entries = mapping.sections.names.iter().zip(&runs.facts).map(of_run).collect();
    map(RUNS, entries, &mapping.sections.span)
}

/// What the channels of each side were made of.
fn channels(mapping: &Mapping) -> IndexMap<String, Vec<String>> {
    let of_side = |side: &Side| {
        let mut lines = Vec::new();
        if !side.time.from.0.is_empty() {
            let names = side.time.from.0.iter().map(|name| name.value.as_str());
            lines.push(format!("time = {}", names.collect::<Vec<_>>().join(" or ")));
        }
        if let Some(Distance::Channel(map)) = &side.distance {
            lines.push(format!("distance = {}", map.in_words()));
        }
        match &side.channels {
            Channels::AsNamed => lines.push("every channel as named in the file".into()),
            Channels::Maps(maps) => lines
                .extend(maps.iter().map(|map| format!("{} = {}", map.name.value, map.in_words()))),
        }
        let units = side.units.iter();
        lines.extend(units.map(|(key, unit)| format!("unit `{}` read as {unit}", key.text)));
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
