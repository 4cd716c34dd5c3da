//! Parquet and Arrow files: a table each, with units in the metadata of the fields.
//!
//! Both readers allocate what a file declares. What it declares is therefore checked before: for
//! Parquet as in a record of a campaign (`data::record::guard`), for Arrow in `ipc`.

mod ipc;
mod values;

use std::io::Cursor;

use arrow_array::RecordBatch;
use arrow_ipc::reader::FileReader;
use arrow_schema::{Field, Schema};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder,
};
use parquet::file::metadata::ParquetMetaData;

use super::guard::damaged;
use super::load::Budget;
use super::text::name_and_unit;
use super::{Channel, Format, Input, Place, Read, Table, Want};
use crate::data::record::guard;
use crate::problem::Problem;

/// Rows read at a time.
const BATCH: usize = 8192;

/// Keys of the metadata of a field under which programs write the unit.
const UNITS: &[&str] = &["unit", "units", "Unit", "Units", "UNIT", "unit_string"];

/// Entries of the metadata of a file that describe its encoding.
const NOT_FACTS: &[&str] = &["ARROW:schema", "pandas", "geo"];

/// Longest fact that is kept.
const LONGEST_FACT: usize = 200;

pub(super) fn parquet(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let shown = input.shown;
    let bad =
        |place: &str, why: &dyn std::fmt::Display| damaged(Format::Parquet, shown, place, why);
    guard::footer(footer(input.bytes).map_err(|why| bad("the footer", &why))?)
        .map_err(|why| bad("the footer", &why))?;
    let bytes = input.bytes.clone();
    let metadata = ArrowReaderMetadata::load(&bytes, ArrowReaderOptions::new())
        .map_err(|error| bad("the footer", &error))?;
    let rows = usize::try_from(metadata.metadata().file_metadata().num_rows())
        .map_err(|_| bad("the footer", &"a negative number of rows"))?;
    let schema = metadata.schema().clone();
    let (mut table, columns) = table(&schema);
    Budget::new(input.bytes.len(), shown).take(columns.len(), rows, "the table")?;
    table.rows = rows;
    let pairs = metadata.metadata().file_metadata().key_value_metadata().into_iter().flatten();
    table.facts = facts(pairs.filter_map(|pair| Some((pair.key.clone(), pair.value.clone()?))));
    if input.want == Want::Values {
        let mask = ProjectionMask::roots(metadata.parquet_schema(), columns.iter().copied());
        pages(input.bytes, metadata.metadata(), &mask).map_err(|(place, why)| bad(&place, &why))?;
        let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(bytes, metadata);
        let reader = builder
            .with_projection(mask)
            .with_batch_size(BATCH)
            .build()
            .map_err(|error| bad("the columns", &error))?;
        let (mut found, mut origins) = (0, vec![None; table.channels.len()]);
        table.channels.iter_mut().for_each(|channel| channel.values.reserve_exact(rows));
        for batch in reader {
            let batch = batch.map_err(|error| bad(&format!("row {}", found + 1), &error))?;
            add(&mut table, &mut origins, &batch)
                .map_err(|why| bad(&format!("row {}", found + 1), &why))?;
            found += batch.num_rows();
        }
        if found != rows {
            return Err(bad(
                "the columns",
                &format!("{rows} rows are declared, {found} are there"),
            )
            .into());
        }
    }
    finish(table, shown)
}

/// Bytes after the footer: its length and the mark.
const END: usize = 8;

fn footer(bytes: &[u8]) -> Result<&[u8], String> {
    let Some((body, end)) = bytes.split_last_chunk::<END>().filter(|(_, end)| end[4..] == *b"PAR1")
    else {
        return Err("the file does not end as it should".into());
    };
    let length = u32::from_le_bytes([end[0], end[1], end[2], end[3]]) as usize;
    let footer = body.len().checked_sub(length).and_then(|from| body.get(from..));
    footer.ok_or_else(|| format!("{length} bytes are declared, {} are there", body.len()))
}

/// Checks the pages of the columns that are read. The error has its place.
fn pages(
    bytes: &[u8],
    metadata: &ParquetMetaData,
    mask: &ProjectionMask,
) -> Result<(), (String, String)> {
    for (group, row_group) in metadata.row_groups().iter().enumerate() {
        for (leaf, chunk) in
            row_group.columns().iter().enumerate().filter(|(leaf, _)| mask.leaf_included(*leaf))
        {
            let place = || {
                format!(
                    "row group {}, column {} (`{}`)",
                    group + 1,
                    leaf + 1,
                    chunk.column_path().string()
                )
            };
            let part = guard::range(chunk).and_then(|range| {
                bytes.get(usize::try_from(range.start).ok()?..usize::try_from(range.end).ok()?)
            });
            let part =
                part.ok_or_else(|| (place(), "its values are beyond the file".to_string()))?;
            guard::pages(part, chunk).map_err(|why| (place(), why))?;
        }
    }
    Ok(())
}

pub(super) fn arrow(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let shown = input.shown;
    let bad = |place: &str, why: &dyn std::fmt::Display| damaged(Format::Arrow, shown, place, why);
    let rows = ipc::check(input.bytes, shown)?;
    let reader = FileReader::try_new(Cursor::new(&input.bytes[..]), None)
        .map_err(|error| bad("the footer", &error))?;
    let (mut table, columns) = table(&reader.schema());
    Budget::new(input.bytes.len(), shown).take(columns.len(), rows, "the table")?;
    table.rows = rows;
    let schema = reader.schema();
    table.facts = facts(
        reader
            .custom_metadata()
            .iter()
            .chain(schema.metadata())
            .map(|(key, value)| (key.clone(), value.clone())),
    );
    drop(reader);
    if input.want == Want::Values {
        let reader = FileReader::try_new(Cursor::new(&input.bytes[..]), Some(columns))
            .map_err(|error| bad("the footer", &error))?;
        let mut origins = vec![None; table.channels.len()];
        for (index, batch) in reader.enumerate() {
            let place = format!("batch {}", index + 1);
            let batch = batch.map_err(|error| bad(&place, &error))?;
            add(&mut table, &mut origins, &batch).map_err(|why| bad(&place, &why))?;
        }
    }
    finish(table, shown)
}

/// The channels of a schema without values, and the positions of their columns.
fn table(schema: &Schema) -> (Table, Vec<usize>) {
    let mut table = Table { first_row: 1, ..Table::default() };
    let mut columns = Vec::new();
    for (index, field) in schema.fields().iter().enumerate() {
        if let Err(why) = values::readable(field.data_type()) {
            table.left_out.push((field.name().clone(), why));
            continue;
        }
        columns.push(index);
        let (name, unit) = name_and_unit_of(field);
        let comment =
            ["comment", "description"].iter().find_map(|key| field.metadata().get(*key)).cloned();
        let unit = unit.or_else(|| values::is_time(field.data_type()).then(|| "s".into()));
        table.channels.push(Channel {
            name,
            unit,
            comment,
            values: Vec::new(),
            place: Place { column: index + 1, span: None },
        });
    }
    (table, columns)
}

/// The unit in the metadata, or else in brackets after the name.
fn name_and_unit_of(field: &Field) -> (String, Option<String>) {
    match UNITS.iter().find_map(|key| field.metadata().get(*key)) {
        Some(unit) => {
            (field.name().clone(), Some(unit.trim().to_string()).filter(|unit| !unit.is_empty()))
        }
        None => name_and_unit(field.name()),
    }
}

fn add(table: &mut Table, origins: &mut [Option<i64>], batch: &RecordBatch) -> Result<(), String> {
    if batch.num_columns() != table.channels.len() {
        return Err(format!(
            "{} columns in place of {}",
            batch.num_columns(),
            table.channels.len()
        ));
    }
    for ((channel, origin), column) in table.channels.iter_mut().zip(origins).zip(batch.columns()) {
        values::add(&mut channel.values, column.as_ref(), origin)
            .map_err(|why| format!("`{}`: {why}", channel.name))?;
    }
    Ok(())
}

fn facts(pairs: impl Iterator<Item = (String, String)>) -> Vec<(String, String)> {
    let mut facts: Vec<(String, String)> = pairs
        .filter(|(key, value)| {
            !NOT_FACTS.contains(&key.as_str())
                && value.len() <= LONGEST_FACT
                && key.len() <= LONGEST_FACT
        })
        .collect();
    facts.sort();
    facts
}

fn finish(table: Table, shown: &str) -> Result<Read, Vec<Problem>> {
    if table.channels.is_empty() {
        return Err(
            Problem::error("no-numbers", format!("`{shown}` has no columns of numbers")).into()
        );
    }
    Ok(Read { tables: vec![table], facts: Vec::new() })
}
