//! Records and tables: CSV with units in the header, and records as Parquet files.

use std::path::{Path, PathBuf};

use fishplate::data::checks::check_axis;
use fishplate::data::record::{
    Known, Record, RecordSource, Wanted, read_headings, read_raw, read_record,
};
use fishplate::data::table::Table;
use fishplate::data::text::read_text;
use fishplate::problem::Problems;

use super::promise;

/// A folder of this thread, in memory where the system has such a place.
pub fn folder() -> PathBuf {
    thread_local! {
        static FOLDER: tempfile::TempDir = {
            let memory = Path::new("/dev/shm");
            if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }
                .expect("a temporary folder")
        };
    }
    FOLDER.with(|folder| folder.path().to_path_buf())
}

/// Writes a file that a target reads.
#[track_caller]
pub fn write(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).expect("written");
}

/// A record, all of its columns. What is accepted holds the numbers that the standard library reads
/// from its cells, and none of them is NaN or infinite.
pub fn record(input: &[u8]) {
    let path = folder().join("record.csv");
    write(&path, input);
    let headings = match read_headings(&path, "record.csv") {
        Ok(headings) => headings,
        Err(problems) => return promise::told(&problems),
    };
    let any = |name: &String| Wanted { name: name.clone(), dimension: None, required: true };
    let names: Vec<String> = headings.into_iter().map(|heading| heading.name).collect();
    let wanted: Vec<Wanted> = names.iter().filter(|name| !name.is_empty()).map(any).collect();
    match read_record(&path, "record.csv", &wanted) {
        Err(problems) => {
            assert!(!problems.is_empty(), "refused without a word");
            promise::told(&problems);
        }
        Ok(record) => {
            for column in &record.columns {
                assert_eq!(column.values.len(), record.rows, "{}", column.name);
                assert!(column.values.iter().all(|value| value.is_finite()), "{}", column.name);
            }
            same_as_std(&record, input);
            if let [clock, axis, ..] = record.columns.as_slice()
                && let Err(problems) = check_axis(&record, &clock.name, &axis.name, None)
            {
                promise::told(&problems);
            }
        }
    }
}

/// A Parquet file, all of its columns. What is accepted holds finite numbers, the same whole, in
/// blocks and as a stretch; what is refused says why, without a panic of the decoder.
pub fn parquet(input: &[u8]) {
    let path = folder().join("record.parquet");
    write(&path, input);
    let headings = match read_headings(&path, "record.parquet") {
        Ok(headings) => headings,
        Err(problems) => return promise::told(&problems),
    };
    if let Err(problems) = read_raw(&path, "record.parquet") {
        promise::told(&problems);
    }
    for heading in headings.into_iter().filter(|heading| !heading.name.is_empty()) {
        let wanted = [Wanted { name: heading.name.clone(), dimension: None, required: true }];
        let record = match read_record(&path, "record.parquet", &wanted) {
            Ok(record) => record,
            Err(problems) => {
                assert!(!problems.is_empty(), "refused without a word");
                promise::told(&problems);
                continue;
            }
        };
        let values = &record.columns[0].values;
        assert_eq!(values.len(), record.rows, "{}", heading.name);
        assert!(values.iter().all(|value| value.is_finite()), "{}", heading.name);
        let mut rows = 0;
        let (source, known) = (RecordSource::at(&path, "record.parquet"), Known::default());
        let run = source.stream(&wanted, &heading.name, &known, |block| {
            assert_eq!(block.columns[0].values, values[rows..rows + block.rows]);
            rows += block.rows;
        });
        assert!(run.is_ok() && rows == record.rows, "{}", heading.name);
        let stretch = source.stretch(&wanted, &heading.name, 0.0..1.0, &Known::default());
        if let Err(problems) = stretch {
            promise::told(&problems);
        }
    }
}

/// The rows as `str::parse` reads them. Quotes are left to other tests: they may hide a comma.
#[track_caller]
fn same_as_std(record: &Record, input: &[u8]) {
    let text = std::str::from_utf8(input).expect("an accepted record is UTF-8");
    if text.contains('"') {
        return;
    }
    let lines: Vec<&str> = text.lines().skip(1).collect();
    for column in &record.columns {
        for (row, value) in column.values.iter().enumerate() {
            let cell = lines[row].split(',').nth(column.position).expect("a cell").trim();
            let number: f64 =
                cell.parse().unwrap_or_else(|_| panic!("`{cell}` was read as {value}"));
            let wanted = column.unit.to_si(number);
            assert_eq!(wanted.to_bits(), value.to_bits(), "`{cell}`: {wanted} and {value}");
        }
    }
}

/// A table such as `sections.csv`. Every row has as many cells as there are columns, names differ,
/// numbers are finite, and each cell stands where it says.
pub fn table(input: &[u8]) {
    let path = folder().join("table.csv");
    write(&path, input);
    let mut problems = Problems::default();
    let table = problems
        .value(read_text(&path, "table.csv"))
        .and_then(|(text, hash)| Table::parse(text, hash, Some("section"), &mut problems));
    promise::told(&problems.0);
    assert!(table.is_some() != problems.any_error(), "neither read nor refused");
    let Some(table) = table else { return };
    for row in &table.rows {
        assert_eq!(row.len(), table.columns.len());
        for cell in row.iter().filter(|cell| !cell.span.text().contains('"')) {
            assert_eq!(cell.span.text().trim(), cell.value);
        }
    }
    for (row, name) in table.names().enumerate() {
        assert_eq!(table.row_named(&name.value), Some(row), "{}", name.value);
    }
    for column in 0..table.columns.len() {
        match table.numbers(column, None) {
            Ok(numbers) => assert!(numbers.iter().flatten().all(|number| number.is_finite())),
            Err(problems) => promise::told(&problems),
        }
    }
}
