//! Parquet and Arrow files: a table each, with units in the metadata of the fields.
//!
//! Both readers allocate what a file declares. What it declares is therefore checked before: for
//! Parquet as in a record of a campaign (`data::record::guard`), for Arrow in `ipc`.

mod ipc;
mod values;

use std::fmt::Display;
use std::io::Cursor;

use arrow_array::RecordBatch;
use arrow_ipc::reader::FileReader;
use arrow_schema::Schema;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReaderBuilder,
};
use parquet::file::metadata::ParquetMetaData;

use super::text::name_and_unit;
use super::{Channel, Input, Read, Table, Want, filled};
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

/// A Parquet file as a table.
pub fn parquet(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let bad = |why: &dyn Display| input.damaged("the footer", why);
    guard::footer(footer(input.bytes).map_err(|why| bad(&why))?).map_err(|why| bad(&why))?;
    let bytes = input.bytes.clone();
    let metadata = ArrowReaderMetadata::load(&bytes, ArrowReaderOptions::new())
        .map_err(|error| bad(&error))?;
    let of_file = metadata.metadata().file_metadata();
    let rows =
        usize::try_from(of_file.num_rows()).map_err(|_| bad(&"a negative number of rows"))?;
    let pairs = of_file.key_value_metadata().into_iter().flatten();
    let pairs = pairs.filter_map(|pair| Some((&pair.key, pair.value.as_ref()?)));
    let mut columns = Columns::new(input, metadata.schema(), rows, pairs)?;
    if input.want == Want::Values {
        let mask = ProjectionMask::roots(metadata.parquet_schema(), columns.places.iter().copied());
        compressed(input, metadata.metadata(), &mask)?;
        pages(input, metadata.metadata(), &mask)?;
        let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(bytes, metadata);
        let reader = builder
            .with_projection(mask)
            .with_batch_size(BATCH)
            .build()
            .map_err(|error| input.damaged("the columns", error))?;
        let mut found = 0;
        columns.table.channels.iter_mut().for_each(|channel| channel.values.reserve_exact(rows));
        for batch in reader {
            let place = format!("row {}", found + 1);
            let batch = batch.map_err(|error| input.damaged(&place, error))?;
            columns.add(&batch).map_err(|why| input.damaged(&place, why))?;
            found += batch.num_rows();
        }
        if found != rows {
            let why = format!("{rows} rows are declared, {found} are there");
            return Err(input.damaged("the columns", why).into());
        }
    }
    columns.finish(input)
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

/// Refuses columns with a compression that is not read.
fn compressed(
    input: &Input<'_>,
    metadata: &ParquetMetaData,
    mask: &ProjectionMask,
) -> Result<(), Problem> {
    let columns = metadata.row_groups().iter().flat_map(|group| group.columns().iter().enumerate());
    for (_, chunk) in columns.filter(|(leaf, _)| mask.leaf_included(*leaf)) {
        let codec = chunk.compression();
        if !guard::is_read(codec) {
            let name = guard::codec_name(codec);
            let says = format!("`{}` is compressed with {name}, which is not read", input.shown);
            let help = "write it with zstd or snappy, for example `to_parquet(file, compression=\"zstd\")`";
            return Err(Problem::error("format-not-read", says).help(help));
        }
    }
    Ok(())
}

/// Checks the pages of the columns that are read.
fn pages(
    input: &Input<'_>,
    metadata: &ParquetMetaData,
    mask: &ProjectionMask,
) -> Result<(), Problem> {
    for (group, row_group) in metadata.row_groups().iter().enumerate() {
        for (leaf, chunk) in
            row_group.columns().iter().enumerate().filter(|(leaf, _)| mask.leaf_included(*leaf))
        {
            let part = guard::range(chunk).and_then(|range| {
                let (from, to) = (usize::try_from(range.start), usize::try_from(range.end));
                input.bytes.get(from.ok()?..to.ok()?)
            });
            let part = part.ok_or_else(|| "its values are beyond the file".to_string());
            part.and_then(|part| guard::pages(part, chunk)).map_err(|why| {
                let path = chunk.column_path().string();
                let place = format!("row group {}, column {} (`{path}`)", group + 1, leaf + 1);
                input.damaged(&place, why)
            })?;
        }
    }
    Ok(())
}

/// An Arrow file as a table.
pub fn arrow(input: &Input<'_>) -> Result<Read, Vec<Problem>> {
    let rows = ipc::check(input)?;
    let reader = |columns: Option<Vec<usize>>| {
        FileReader::try_new(Cursor::new(&input.bytes[..]), columns)
            .map_err(|error| input.damaged("the footer", error))
    };
    let whole = reader(None)?;
    let schema = whole.schema();
    let pairs = whole.custom_metadata().iter().chain(schema.metadata());
    let mut columns = Columns::new(input, &schema, rows, pairs)?;
    if input.want == Want::Values {
        for (index, batch) in reader(Some(columns.places.clone()))?.enumerate() {
            let place = format!("batch {}", index + 1);
            let batch = batch.map_err(|error| input.damaged(&place, error))?;
            columns.add(&batch).map_err(|why| input.damaged(&place, why))?;
        }
    }
    columns.finish(input)
}

/// The columns that are read.
struct Columns {
    table: Table,
    /// Their positions in the file.
    places: Vec<usize>,
    /// Of each column of times, the first.
    origins: Vec<Option<i64>>,
}

impl Columns {
    /// The channels of a schema, without values.
    fn new<'a>(
        input: &Input<'_>,
        schema: &Schema,
        rows: usize,
        pairs: impl Iterator<Item = (&'a String, &'a String)>,
    ) -> Result<Self, Problem> {
        let is_fact = |(key, value): &(&String, &String)| {
            !NOT_FACTS.contains(&key.as_str())
                && value.len() <= LONGEST_FACT
                && key.len() <= LONGEST_FACT
        };
        let pairs = pairs.filter(is_fact);
        let mut facts: Vec<(String, String)> =
            pairs.map(|(key, value)| (key.clone(), value.clone())).collect();
        facts.sort();
        let mut table = Table { first_row: 1, rows, facts, ..Table::default() };
        let mut places = Vec::new();
        for (index, field) in schema.fields().iter().enumerate() {
            if let Err(why) = values::readable(field.data_type()) {
                table.left_out.push((field.name().clone(), why));
                continue;
            }
            places.push(index);
            // The unit in the metadata, or else in brackets after the name.
            let stated = |keys: &[&str]| keys.iter().find_map(|key| field.metadata().get(*key));
            let (name, unit) = match stated(UNITS) {
                Some(unit) => (field.name().clone(), filled(unit)),
                None => name_and_unit(field.name()),
            };
            let unit = unit.or_else(|| values::is_time(field.data_type()).then(|| "s".into()));
            let comment = stated(&["comment", "description"]).cloned();
            table.channels.push(Channel { name, unit, comment, ..Channel::default() });
        }
        input.budget().take(places.len(), rows, "the table")?;
        let origins = vec![None; places.len()];
        Ok(Self { table, places, origins })
    }

    fn add(&mut self, batch: &RecordBatch) -> Result<(), String> {
        let (found, wanted) = (batch.num_columns(), self.places.len());
        if found != wanted {
            return Err(format!("{found} columns in place of {wanted}"));
        }
        let channels = self.table.channels.iter_mut().zip(&mut self.origins);
        for ((channel, origin), column) in channels.zip(batch.columns()) {
            values::add(&mut channel.values, column.as_ref(), origin)
                .map_err(|why| format!("`{}`: {why}", channel.name))?;
        }
        Ok(())
    }

    fn finish(self, input: &Input<'_>) -> Result<Read, Vec<Problem>> {
        let read = Read { tables: vec![self.table], facts: Vec::new() };
        input.with_channels(read, "columns of numbers")
    }
}
