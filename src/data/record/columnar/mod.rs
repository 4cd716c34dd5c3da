//! Records as Parquet files: only the wanted columns are read, row group by row group.
//!
//! | file | content |
//! |---|---|
//! | `mod` | record, headings, place of a sample |
//! | `open` | the file and the wanted columns |
//! | `groups` | the numbers of a row group |
//! | `runs` | long records: block by block, or a stretch of them |
//!
//! What the footer says is in `record/layout`; `record/guard` checks declared sizes before the
//! decoder reserves memory for them.

mod groups;
mod open;
mod runs;

use std::path::Path;

pub(crate) use groups::numbers;
pub use groups::{append, wrong};
pub use open::At;
use open::{Opened, Store};
pub use runs::{stream, stretch};

use super::{Column, Known, Run, Wanted, find_columns, guard};
use crate::data::{
    cells::Heading,
    faults::Faults,
    hash::sha256,
    prelude::*,
    text::{LARGEST_RECORD, read_file},
    write::{FileColumn, Values},
};

/// First and last bytes of each Parquet file.
pub const MAGIC: &[u8; 4] = b"PAR1";

/// Reads the wanted columns of a record.
pub fn read(at: At<'_>, shown: &str, wanted: &[Wanted]) -> Result<Run, Vec<Problem>> {
    let (mut opened, hash) = match at {
        At::Disk(path) => {
            let bytes = read_file(path, shown, LARGEST_RECORD)?;
            let hash = sha256(&bytes);
            (Opened::open(Store::Memory(bytes.into()), shown)?, hash)
        }
        At::Object(stored) => runs::open_object(stored, shown, &Known::default())?,
    };
    let mut columns = opened.find(wanted)?;
    let rows = opened.layout.rows();
    if rows == 0 {
        return Err(no_rows(shown).into());
    }
    opened.numbers_within(columns.len())?;
    columns.iter_mut().for_each(|column| column.values.reserve_exact(rows));
    opened.all_rows(&mut columns)?;
    Ok(opened.run(columns, hash))
}

pub fn no_rows(shown: &str) -> Problem {
    problem!("no-rows", "`{shown}` has columns and no samples")
}

/// Every column as it is in the file: numbers in the unit of the file, or texts.
pub fn raw(path: &Path, shown: &str) -> Result<Vec<FileColumn>, Vec<Problem>> {
    let mut opened = open_file(At::Disk(path), shown)?;
    let headings = opened.layout.headings.clone();
    opened.numbers_within(headings.len())?;
    let raw = |(position, heading): (usize, Heading)| -> Result<FileColumn, Vec<Problem>> {
        let (name, unit) = (heading.name, Unit::one());
        let mut column = [Column { name, unit, values: Vec::new(), position }];
        if let Some(problem) = opened.other_codec(&column[0]) {
            return Err(problem.into());
        }
        let values = if opened.is_text(position) {
            Values::Texts(opened.texts(&column[0])?)
        } else {
            if let Some(problem) = opened.not_numbers(&column[0]) {
                return Err(problem.into());
            }
            opened.all_rows(&mut column)?;
            let [column] = column;
            Values::Numbers(column.values)
        };
        let digits = opened.layout.fields.get(position).and_then(|field| field.digits);
        Ok(FileColumn { heading: heading.span.text().to_string(), values, digits })
    };
    headings.into_iter().enumerate().map(raw).collect()
}

/// The headings of a record.
pub fn headings(at: At<'_>, shown: &str) -> Result<Vec<Heading>, Vec<Problem>> {
    Ok(open_file(at, shown)?.layout.headings.clone())
}

fn open_file<'a>(at: At<'_>, shown: &'a str) -> Result<Opened<'a>, Problem> {
    Opened::open(Store::at(at, shown)?, shown)
}

/// The place of a sample, from 0, or of its value in a column.
pub fn place(at: At<'_>, shown: &str, row: usize, column: Option<&Column>) -> Option<Span> {
    let Some(column) = column else {
        return Some(Source::excerpt(shown, format!("row {}", row + 1), row + 1).whole());
    };
    let mut opened = open_file(at, shown).ok()?;
    let group = opened.layout.groups().into_iter().find(|rows| rows.contains(&row))?;
    let first = group.start;
    let mut alone = [column.empty()];
    opened.rows(group, &mut alone, &mut Faults::new(shown), &mut |_, _| {}).ok()?;
    let value = column.unit.from_si(*alone[0].values.get(row - first)?);
    Some(value_at(shown, &opened.layout.headings[column.position], row, &value.to_string()))
}

/// A Parquet file has no text: the place shows `name [unit] = value`, in the line with the number
/// of the row, from 1.
pub fn value_at(shown: &str, heading: &Heading, row: usize, value: &str) -> Span {
    let name = format!("{} = ", heading.span.text());
    let from = name.len();
    let text = name + value;
    let end = text.len();
    Source::excerpt(shown, text, row + 1).span(from..end)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::data::record::{Known, Record, RecordSource, read_headings, read_record};
    use crate::data::write::{FileColumn, Values, parquet};
    use crate::units::Dimension;

    const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0, 0]);

    fn wanted() -> [Wanted; 2] {
        [Wanted::new("time", Dimension::TIME), Wanted::new("Y", FORCE)]
    }

    fn numbers(heading: &str, values: impl IntoIterator<Item = f64>) -> FileColumn {
        FileColumn {
            heading: heading.into(),
            values: Values::Numbers(values.into_iter().collect()),
            digits: None,
        }
    }

    fn sample(rows: usize) -> Vec<u8> {
        let texts = FileColumn {
            heading: "note [-]".into(),
            values: Values::Texts(vec!["a, b".into(); rows]),
            digits: None,
        };
        let time = numbers("time [ms]", (0..rows).map(|row| 5.0 * row as f64));
        let force = numbers("Y [kN]", (0..rows).map(|row| (row as f64).sin() * 8.0));
        parquet(&[force, texts, time]).expect("written")
    }

    fn with<T>(bytes: &[u8], name: &str, run: impl FnOnce(&Path) -> T) -> T {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("writable");
        run(&path)
    }

    fn read_bytes(bytes: &[u8]) -> Result<Record, Vec<Problem>> {
        with(bytes, "r.parquet", |path| read_record(path, "r.parquet", &wanted()))
    }

    fn code(bytes: &[u8]) -> Option<&'static str> {
        read_bytes(bytes).err().map(|problems| problems[0].code)
    }

    #[test]
    fn wanted_columns_in_si_and_in_the_order_asked_for() {
        let bytes = sample(40_000);
        let record = read_bytes(&bytes).unwrap_or_else(|problems| panic!("{problems:?}"));
        assert_eq!(
            record.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(),
            ["time", "Y"]
        );
        assert_eq!(
            (record.rows, record.bytes, record.channels.as_slice()),
            (40_000, bytes.len(), ["Y", "note", "time"].map(String::from).as_slice())
        );
        assert_eq!(record.columns[0].values[39_999], 5.0 * 39_999.0 * 0.001);
        assert!(
            record.columns[1]
                .values
                .iter()
                .enumerate()
                .all(|(row, value)| *value == (row as f64).sin() * 8.0 * 1000.0)
        );
        assert_eq!(record.sha256, sha256(&bytes));
        assert_eq!(record.columns[1].unit.text, "kN");
        assert_eq!(bytes, sample(40_000), "the same numbers give the same bytes");
    }

    #[test]
    fn a_place_is_row_and_value() {
        with(&sample(20_000), "r.parquet", |path| {
            let record = read_record(path, "r.parquet", &wanted()).expect("good");
            let place = record.place(17_000, record.column("time")).expect("there");
            assert_eq!((place.to_string(), place.text()), ("r.parquet:17001:13".into(), "85000"));
            assert_eq!(record.row_shown(0), 1);
            assert!(record.place(20_000, record.column("time")).is_none());
        });
    }

    #[test]
    fn blocks_and_stretches_are_the_record() {
        let csv = |record: &Record| -> String {
            let row = |row: usize| {
                format!(
                    "{},{}\n",
                    record.columns[0].values[row],
                    record.columns[1].values[row] / 1000.0
                )
            };
            "time [s],Y [kN]\n".to_string() + &(0..record.rows).map(row).collect::<String>()
        };
        let bytes = sample(40_000);
        let whole = read_bytes(&bytes).expect("good");
        for (name, bytes) in [("r.parquet", bytes.clone()), ("r.csv", csv(&whole).into_bytes())] {
            with(&bytes, name, |path| {
                let mut joined: Vec<Vec<f64>> = vec![Vec::new(); 2];
                let known = Known::default();
                let source = RecordSource::at(path, name);
                let run = source.stream(&wanted(), "time", &known, |block| {
                    assert_eq!(
                        (block.first_row, block.rows),
                        (joined[0].len(), block.columns[0].values.len())
                    );
                    joined
                        .iter_mut()
                        .zip(block.columns)
                        .for_each(|(all, column)| all.extend(&column.values));
                });
                let run = run.expect("good");
                assert_eq!(
                    (run.rows, run.sha256.as_str(), run.bytes),
                    (40_000, sha256(&bytes).as_str(), bytes.len() as u64)
                );
                assert_eq!(joined[0], whole.columns[0].values, "{name}");
                for range in [100.0..101.0, 0.0..0.0, 199.9..1e9, 81.9..82.0] {
                    let part = RecordSource::at(path, name)
                        .stretch(&wanted(), "time", range.clone(), &Known::default())
                        .expect("inside");
                    let (first, rows) = (part.first_row, part.rows);
                    let times = &whole.columns[0].values;
                    assert!(first == 0 || times[first - 1] < range.start);
                    assert!(
                        times.get(first + rows).is_none_or(|time| *time > range.end),
                        "{name} {range:?}"
                    );
                    assert_eq!(part.columns[0].values, times[first..first + rows]);
                    assert_eq!(part.columns[1].values.len(), rows);
                    assert_eq!(
                        part.place(0, part.column("time")).map(|place| place.line()),
                        Some(part.row_shown(0))
                    );
                }
                let none = RecordSource::at(path, name)
                    .stretch(&wanted(), "time", 500.0..600.0, &Known::default())
                    .expect_err("outside");
                assert_eq!(none[0].code, "outside-record");
            });
        }
    }

    #[test]
    fn an_axis_that_returns_has_no_stretch() {
        let there_and_back = |row: usize| if row < 100 { row as f64 } else { 200.0 - row as f64 };
        let columns = || {
            vec![
                numbers("time [s]", (0..200).map(there_and_back)),
                numbers("Y [kN]", vec![1.0; 200]),
            ]
        };
        with(&parquet(&columns()).expect("written"), "r.parquet", |path| {
            let problems = RecordSource::at(path, "r.parquet")
                .stretch(&wanted(), "time", 10.0..20.0, &Known::default())
                .expect_err("twice");
            assert_eq!(problems[0].code, "axis-not-increasing");
            assert!(problems[0].says.contains("row 181"), "{}", problems[0].says);
        });
    }

    #[test]
    fn each_fault_at_its_row_and_column() {
        let with_values = |heading: &str, values: Vec<f64>| {
            let times = numbers("time [s]", (0..values.len()).map(|row| row as f64));
            parquet(&[times, numbers(heading, values)]).expect("written")
        };
        let problems = read_bytes(&with_values("Y [kN]", vec![1.0, f64::NAN, 2.0, f64::INFINITY]))
            .expect_err("not finite");
        let told: Vec<_> = problems
            .iter()
            .map(|problem| (problem.code, problem.at.as_ref().map(ToString::to_string)))
            .collect();
        let at = |line: usize| ("not-finite", Some(format!("r.parquet:{line}:10")));
        assert_eq!(told, [at(2), at(4)]);
        assert_eq!(problems[0].label.as_deref(), Some("row 2, in row group 1"));
        assert_eq!(code(&with_values("Y", vec![1.0])), Some("unit-missing"));
        assert_eq!(code(&with_values("Y [m]", vec![1.0])), Some("unit-mismatch"));
        assert_eq!(code(&with_values("Z [kN]", vec![1.0])), Some("unknown-channel"));
        assert_eq!(code(&with_values("time [kN]", vec![1.0])), Some("duplicate-column"));
        assert_eq!(code(&with_values("Y [kN]", Vec::new())), Some("no-rows"));
        let text = FileColumn {
            heading: "Y [kN]".into(),
            values: Values::Texts(vec!["1".into()]),
            digits: None,
        };
        let problems = read_bytes(&parquet(&[numbers("time [s]", [0.0]), text]).expect("written"))
            .expect_err("text");
        assert_eq!(
            (problems[0].code, problems[0].at.as_ref().map(ToString::to_string)),
            ("not-a-number", Some("r.parquet:1:11".into()))
        );
    }

    #[test]
    fn another_file_with_this_ending() {
        assert_eq!(code(b""), Some("file-empty"));
        assert_eq!(code(b"time [s],Y [kN]\n0,1\n"), Some("format-mislabelled"));
        assert_eq!(code(b"\x00\x01"), Some("format-mislabelled"));
        assert_eq!(code(b"PAR1"), Some("file-damaged"));
        assert_eq!(code(b"PAR1PAR1"), Some("file-damaged"));
        assert_eq!(code(b"PAR1\xff\xff\xff\xffPAR1"), Some("file-damaged"));
        assert_eq!(code(b"PARE0000PARE"), Some("format-not-read"));
        with(&sample(10), "r.csv", |path| {
            let problems = read_record(path, "r.csv", &wanted()).expect_err("mislabelled");
            assert_eq!(problems[0].code, "format-mislabelled");
            assert!(read_headings(path, "r.csv").is_err());
        });
    }

    #[test]
    fn every_prefix_is_survived() {
        let bytes = sample(50);
        (0..bytes.len()).for_each(|end| assert!(read_bytes(&bytes[..end]).is_err(), "{end}"));
    }

    /// A changed byte is told, wherever it is, but for the name of the program that wrote the file.
    #[test]
    fn every_changed_byte_is_told() {
        let time = numbers("time [ms]", (0..300).map(|row| 5.0 * f64::from(row)));
        let force = numbers("Y [kN]", (0..300).map(|row| f64::from(row).sin() * 8.0));
        let bytes = parquet(&[time, force]).expect("written");
        let sound = read_bytes(&bytes).expect("good");
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            if let Ok(record) = read_bytes(&changed) {
                let values = |record: &Record| {
                    record.columns.iter().map(|column| column.values.clone()).collect::<Vec<_>>()
                };
                let footer = at > bytes.len() - 200;
                let of_writer =
                    footer && !changed.windows(16).any(|part| part == b"fishplate, crc32");
                assert!(of_writer && values(&record) == values(&sound), "byte {at}");
            }
        }
    }

    /// The sum of the sizes that the tests ask for is far below what a declared size could ask for.
    fn survived(bytes: &[u8]) {
        with(bytes, "r.parquet", |path| {
            match read_record(path, "r.parquet", &wanted()) {
                Ok(record) => {
                    assert!(record.columns.iter().all(|column| column.values.len() == record.rows));
                    assert!(
                        record
                            .columns
                            .iter()
                            .flat_map(|column| &column.values)
                            .all(|value| value.is_finite())
                    );
                }
                Err(problems) => problems.iter().for_each(|problem| drop(problem.render(false))),
            }
            drop(RecordSource::at(path, "r.parquet").stretch(
                &wanted(),
                "time",
                0.1..0.2,
                &Known::default(),
            ));
        });
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        #[test]
        fn flipped_bytes_are_survived(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
            let mut bytes = sample(50);
            for (at, byte) in flips {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
            survived(&bytes);
        }

        /// Footers, which declare sizes, are hit more often than by chance.
        #[test]
        fn flipped_bytes_of_the_footer_are_survived(flips in prop::collection::vec((0..400_usize, any::<u8>()), 1..4)) {
            let mut bytes = sample(50);
            for (back, byte) in flips {
                let at = bytes.len() - 9 - back;
                bytes[at] = byte;
            }
            survived(&bytes);
        }
    }

    /// Neighbouring stretches have row groups in common; the hash needs every byte of the file.
    #[cfg(target_os = "linux")]
    #[test]
    fn stretches_of_a_small_file_read_each_byte_once() {
        // What this thread has read, in bytes, from the cache of the system or not.
        let read = || {
            let told =
                std::fs::read_to_string("/proc/thread-self/io").expect("what a thread reads");
            let line = told.lines().find_map(|line| line.strip_prefix("rchar: ")).expect("a line");
            line.trim().parse::<u64>().expect("a number")
        };
        let path = Path::new("examples/run/records/north-measured.parquet");
        let size = std::fs::metadata(path).expect("there").len();
        let wanted = [Wanted::new("distance", Dimension::LENGTH), Wanted::new("Y_1R", FORCE)];
        let (known, before) = (Known::default(), read());
        for start in 0..20 {
            let start = 1_200.0 + 50.0 * f64::from(start);
            RecordSource::at(path, "north")
                .stretch(&wanted, "distance", start..start + 100.0, &known)
                .expect("inside");
        }
        let more = read() - before;
        assert!((size..size + 20_000).contains(&more), "{more} bytes of a file of {size}");
    }

    /// Arrow writes durations as whole numbers of their unit; those of a text have no unit but that of
    /// the heading.
    #[test]
    fn durations_are_no_numbers() {
        use arrow_array::{ArrayRef, DurationMillisecondArray, Float64Array, RecordBatch};
        let time: ArrayRef = std::sync::Arc::new(DurationMillisecondArray::from_iter_values(
            (0..50).map(|row| 5 * row),
        ));
        let force: ArrayRef =
            std::sync::Arc::new(Float64Array::from_iter_values((0..50).map(f64::from)));
        let batch = RecordBatch::try_from_iter([("time [s]", time), ("Y [kN]", force)])
            .expect("two columns");
        let mut bytes = Vec::new();
        let mut writer = ::parquet::arrow::ArrowWriter::try_new(&mut bytes, batch.schema(), None)
            .expect("a writer");
        writer.write(&batch).expect("written");
        writer.close().expect("closed");
        let problems = read_bytes(&bytes).expect_err("milliseconds");
        assert!(
            problems[0].code == "not-a-number" && problems[0].says.contains("holds durations"),
            "{}",
            problems[0].says
        );
    }
}
