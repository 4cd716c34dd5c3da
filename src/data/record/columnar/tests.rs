use proptest::prelude::*;

use super::*;
use crate::data::record::{Known, Record, read_headings, read_record, read_stretch, stream};
use crate::data::write::{FileColumn, Values, parquet};
use crate::units::Dimension;

const FORCE: Dimension = Dimension([1, 1, -2, 0, 0, 0]);

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
            let run = stream(path, name, &wanted(), |block| {
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
                let part =
                    read_stretch(path, name, &wanted(), "time", range.clone(), &Known::default())
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
            let none = read_stretch(path, name, &wanted(), "time", 500.0..600.0, &Known::default())
                .expect_err("outside");
            assert_eq!(none[0].code, "outside-record");
        });
    }
}

#[test]
fn an_axis_that_returns_has_no_stretch() {
    let there_and_back = |row: usize| if row < 100 { row as f64 } else { 200.0 - row as f64 };
    let columns = || {
        vec![numbers("time [s]", (0..200).map(there_and_back)), numbers("Y [kN]", vec![1.0; 200])]
    };
    with(&parquet(&columns()).expect("written"), "r.parquet", |path| {
        let problems =
            read_stretch(path, "r.parquet", &wanted(), "time", 10.0..20.0, &Known::default())
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
        drop(read_stretch(path, "r.parquet", &wanted(), "time", 0.1..0.2, &Known::default()));
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
        let told = std::fs::read_to_string("/proc/thread-self/io").expect("what a thread reads");
        let line = told.lines().find_map(|line| line.strip_prefix("rchar: ")).expect("a line");
        line.trim().parse::<u64>().expect("a number")
    };
    let path = Path::new("examples/run/records/north-measured.parquet");
    let size = std::fs::metadata(path).expect("there").len();
    let wanted = [Wanted::new("distance", Dimension::LENGTH), Wanted::new("Y_1R", FORCE)];
    let (known, before) = (Known::default(), read());
    for start in 0..20 {
        let start = 1_200.0 + 50.0 * f64::from(start);
        read_stretch(path, "north", &wanted, "distance", start..start + 100.0, &known)
            .expect("inside");
    }
    let more = read() - before;
    assert!((size..size + 20_000).contains(&more), "{more} bytes of a file of {size}");
}

/// Stretches of one file: what they have in common is decoded once.
mod stretches {
    use std::path::PathBuf;
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Float64Array, RecordBatch};
    use parquet::arrow::ArrowWriter;
    use parquet::file::properties::WriterProperties;

    use super::{Dimension, FORCE, Problem};
    use crate::data::record::decoded::ROWS;
    use crate::data::record::{Known, Record, Wanted, read_stretch};

    /// Rows of the file: some row groups, and some blocks in the largest of them.
    const LENGTH: usize = 100_000;

    fn force(row: usize) -> f64 {
        (row as f64 * 0.01).sin()
    }

    /// A file with row groups of so many rows, and its stretches from one time to another [s]; a
    /// row is 5 ms.
    struct File {
        path: PathBuf,
        known: Known,
        _folder: tempfile::TempDir,
    }

    impl File {
        fn new(group: usize, time: impl Fn(usize) -> f64, force: impl Fn(usize) -> f64) -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("r.parquet");
            let array = |value: &dyn Fn(usize) -> f64| {
                Arc::new(Float64Array::from_iter_values((0..LENGTH).map(value))) as ArrayRef
            };
            let columns = [
                ("time [s]", array(&time)),
                ("Y [kN]", array(&force)),
                ("Q [kN]", array(&|row| -force(row))),
            ];
            let batch = RecordBatch::try_from_iter(columns).expect("columns of one length");
            let properties =
                WriterProperties::builder().set_max_row_group_row_count(Some(group)).build();
            let mut bytes = Vec::new();
            let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))
                .expect("a writer");
            writer.write(&batch).expect("written");
            writer.close().expect("closed");
            std::fs::write(&path, bytes).expect("written");
            Self { path, known: Known::default(), _folder: folder }
        }

        fn sound(group: usize) -> Self {
            Self::new(group, |row| row as f64 * 0.005, force)
        }

        fn stretch(&self, from: f64, to: f64, names: &[&str]) -> Result<Record, Vec<Problem>> {
            let of = |name: &&str| Wanted::new(*name, FORCE);
            let wanted: Vec<Wanted> = [Wanted::new("time", Dimension::TIME)]
                .into_iter()
                .chain(names.iter().map(of))
                .collect();
            read_stretch(&self.path, "r.parquet", &wanted, "time", from..to, &self.known)
        }

        /// Columns of blocks that were decoded.
        fn made(&self) -> usize {
            self.known.held.decoded.made()
        }
    }

    #[test]
    fn a_row_group_is_decoded_once_for_all_sections() {
        let file = File::sound(20_000);
        // 100 s are a row group; a section each 2 s, with what is beside it.
        for section in 0..240 {
            let from = 2.0 * f64::from(section);
            let record = file.stretch(from, from + 10.0, &["Y"]).expect("inside");
            assert!((2000..=2001).contains(&record.rows), "{} rows", record.rows);
        }
        assert_eq!(file.made(), 5 * 2, "five row groups of two columns");
        file.stretch(0.0, 10.0, &["Q", "Y"]).expect("inside");
        assert_eq!(file.made(), 5 * 2 + 1, "a column that was not asked for before");
    }

    #[test]
    fn a_stretch_is_the_same_in_row_groups_of_any_length() {
        let files = [7_000, 20_000, 60_000, LENGTH].map(File::sound);
        for (from, to) in [
            (0.0, 3.0),
            (95.0, 105.0),
            (160.0, 170.0),
            (320.0, 330.0),
            (20.0, 470.0),
            (490.0, 600.0),
        ] {
            let [one, others @ ..] =
                files.each_ref().map(|file| file.stretch(from, to, &["Y", "Q"]).expect("inside"));
            let rows: Vec<usize> =
                (0..LENGTH).filter(|row| (from..=to).contains(&(*row as f64 * 0.005))).collect();
            assert_eq!((one.first_row, one.rows), (rows[0], rows.len()));
            for (at, row) in rows.iter().enumerate() {
                assert_eq!(one.columns[1].values[at], force(*row) * 1000.0);
                assert_eq!(one.columns[2].values[at], -force(*row) * 1000.0);
            }
            for other in others {
                assert_eq!(
                    (one.columns.as_slice(), one.first_row),
                    (other.columns.as_slice(), other.first_row)
                );
            }
        }
        let whole = &files[3];
        assert_eq!(whole.made(), 3 * LENGTH.div_ceil(ROWS), "a long row group is parted");
    }

    /// Only rows of the stretch concern it; the axis must be sound wherever it is looked at.
    #[test]
    fn a_fault_beside_a_stretch_does_not_concern_it() {
        let time = |row: usize| row as f64 * 0.005;
        let file = File::new(20_000, time, |row| if row == 10_000 { f64::NAN } else { force(row) });
        for _ in 0..2 {
            let good = file.stretch(60.0, 70.0, &["Y"]).expect("inside");
            assert_eq!((good.rows, good.columns[1].values[0]), (2001, force(12_000) * 1000.0));
            assert!(file.stretch(45.0, 55.0, &[]).is_ok());
            let fault = file.stretch(45.0, 55.0, &["Y"]).expect_err("no number");
            assert_eq!(
                (fault[0].code, fault[0].at.as_ref().map(ToString::to_string)),
                ("not-finite", Some("r.parquet:10001:10".into()))
            );
        }
        let file = File::new(20_000, |row| if row == 10_000 { f64::NAN } else { time(row) }, force);
        assert_eq!(file.stretch(60.0, 70.0, &["Y"]).expect_err("no number")[0].code, "not-finite");
        assert!(file.stretch(160.0, 170.0, &["Y"]).is_ok());
    }

    #[test]
    fn the_axis_is_searched_in_all_blocks_of_a_row_group() {
        let back = |row: usize| {
            if row < 70_000 { row as f64 * 0.005 } else { (row - 70_000) as f64 * 0.005 }
        };
        let file = File::new(LENGTH, back, force);
        assert_eq!(
            file.stretch(10.0, 20.0, &["Y"]).expect_err("twice")[0].code,
            "axis-not-increasing"
        );
        assert!(file.stretch(200.0, 210.0, &["Y"]).is_ok());
    }
}

/// Written by Arrow C++ with a checksum for each page, uncompressed: a changed byte of a value
/// would else be another number.
#[test]
fn checksums_of_pages_are_looked_at() {
    let whole = include_bytes!("../../../../tests/cases/data/checksums.parquet");
    let wanted =
        [Wanted::new("distance", Dimension::LENGTH), Wanted::new("ay", Dimension::ACCELERATION)];
    let read =
        |bytes: &[u8]| with(bytes, "r.parquet", |path| read_record(path, "r.parquet", &wanted));
    let record = read(whole).expect("sound");
    assert_eq!(
        record.columns[0].values,
        (0..40).map(|row| 0.5 * f64::from(row)).collect::<Vec<_>>()
    );
    let value = 2.5_f64.to_le_bytes();
    let at = whole.windows(8).position(|bytes| bytes == value).expect("the sixth distance");
    let mut changed = whole.to_vec();
    changed[at + 6] ^= 1;
    let problems = read(&changed).expect_err("another number");
    assert!(
        problems[0].code == "file-damaged" && problems[0].says.contains("CRC"),
        "{}",
        problems[0].says
    );
}

/// Arrow writes durations as whole numbers of their unit; those of a text have no unit but that of
/// the heading.
#[test]
fn durations_are_no_numbers() {
    use arrow_array::{ArrayRef, DurationMillisecondArray, Float64Array, RecordBatch};
    let time: ArrayRef =
        std::sync::Arc::new(DurationMillisecondArray::from_iter_values((0..50).map(|row| 5 * row)));
    let force: ArrayRef =
        std::sync::Arc::new(Float64Array::from_iter_values((0..50).map(f64::from)));
    let batch =
        RecordBatch::try_from_iter([("time [s]", time), ("Y [kN]", force)]).expect("two columns");
    let mut bytes = Vec::new();
    let mut writer =
        ::parquet::arrow::ArrowWriter::try_new(&mut bytes, batch.schema(), None).expect("a writer");
    writer.write(&batch).expect("written");
    writer.close().expect("closed");
    let problems = read_bytes(&bytes).expect_err("milliseconds");
    assert!(
        problems[0].code == "not-a-number" && problems[0].says.contains("holds durations"),
        "{}",
        problems[0].says
    );
}
