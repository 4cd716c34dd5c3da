//! One sampled record: the requested columns as numbers in SI units.
//!
//! Records are almost all of the data of a campaign. A row of a text is therefore parsed in one pass
//! over its bytes (`rows`); only an irregular row is parsed again cell by cell to determine the
//! fault (`fault`).

mod columnar;
mod decoded;
mod fault;
pub(crate) mod guard;
mod header_fault;
mod held;
mod known;
mod layout;
mod memory;
mod raw;
mod recent;
mod rows;
mod source;
mod stored;
mod stretch;
mod text;

pub use super::format::Format;
pub(crate) use columnar::numbers;
pub use held::Held;
pub use known::Known;
pub(crate) use layout::guarded;
pub use memory::{Frame, ReadFrom};
pub use raw::read_raw;
pub use source::RecordSource;
pub use stored::Stored;
pub use stretch::{Block, Run};

use std::path::Path;

use super::{
    cells::{self, Heading},
    faults::Faults,
    text::empty,
};
use crate::data::prelude::*;

/// A column requested by the caller.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Name without the unit.
    pub name: String,
    /// Required dimension; `None` accepts any unit.
    pub dimension: Option<Dimension>,
    /// Whether the column must exist.
    pub required: bool,
}

impl Wanted {
    pub fn new(name: impl Into<String>, dimension: Dimension) -> Self {
        Self { name: name.into(), dimension: Some(dimension), required: true }
    }

    /// Columns of whatever dimension, all of which must be there.
    pub fn all<'a>(headings: impl IntoIterator<Item = &'a Heading>) -> Vec<Self> {
        let names = headings.into_iter().map(|heading| heading.name.clone());
        names.map(|name| Self { name, dimension: None, required: true }).collect()
    }

    /// The same column, optional.
    pub fn if_there(self) -> Self {
        Self { required: false, ..self }
    }
}

/// The requested columns of a record, of equal length.
#[derive(Clone, Debug)]
pub struct Record {
    /// Name of the file for messages.
    pub shown: String,
    /// In the order of the request.
    pub columns: Vec<Column>,
    /// Every column name in the file.
    pub channels: Vec<String>,
    /// Number of samples.
    pub rows: usize,
    /// Number of samples of the file before these: 0 but for a [stretch](RecordSource::stretch).
    pub first_row: usize,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file.
    pub bytes: usize,
    from: RecordSource,
}

/// A channel: one finite value per sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub name: String,
    /// Unit in the file.
    pub unit: Unit,
    /// In SI units.
    pub values: Vec<f64>,
    /// Index of the column in the file, from 0.
    pub position: usize,
}

impl Column {
    /// The same column without its values.
    fn empty(&self) -> Self {
        let Self { name, unit, position, .. } = self;
        Self { name: name.clone(), unit: unit.clone(), values: Vec::new(), position: *position }
    }
}

impl Record {
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The number of sample `row` (from 0) in messages: the line of a text, whose header is line 1;
    /// else the row, from 1.
    pub fn row_shown(&self, row: usize) -> usize {
        self.first_row + row + self.from.first_row()
    }

    /// The place in the file of sample `row` (from 0), or of its cell in a column. The file is read
    /// again.
    pub fn place(&self, row: usize, column: Option<&Column>) -> Option<Span> {
        self.from.place(self.first_row + row, column)
    }
}

/// As [`RecordSource::read`], of a file by its path; `shown` is its name in messages.
///
/// # Errors
/// As [`RecordSource::read`].
pub fn read_record(path: &Path, shown: &str, wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
    RecordSource::at(path, shown).read(wanted)
}

/// As [`RecordSource::headings`], of a file by its path.
///
/// # Errors
/// As [`RecordSource::headings`].
pub fn read_headings(path: &Path, shown: &str) -> Result<Vec<Heading>, Vec<Problem>> {
    RecordSource::at(path, shown).headings()
}

/// The headings in the first line of a text, such as `Y_1R [kN], ay_I [m/s^2]`.
///
/// # Errors
/// As of a header; `file-empty`.
pub fn listed_headings(text: &str, shown: &str) -> Result<Vec<Heading>, Vec<Problem>> {
    if text.trim().is_empty() {
        return Err(empty(shown).into());
    }
    let line = text.split('\n').next().unwrap_or_default();
    let line = Source::new(shown, line.trim_end_matches('\r')).whole();
    let mut problems = Vec::new();
    cells::headings(&line, &mut problems).ok_or(problems)
}

fn find_columns(
    headings: &[Heading],
    wanted: &[Wanted],
    shown: &str,
) -> Result<Vec<Column>, Vec<Problem>> {
    let mut columns: Vec<Column> = Vec::with_capacity(wanted.len());
    let mut lacking: Vec<&str> = Vec::new();
    let mut wrong: Vec<(&Heading, Problem)> = Vec::new();
    for Wanted { name, dimension, required } in wanted {
        let Some(position) = headings.iter().position(|heading| heading.name == *name) else {
            lacking.extend(required.then_some(name.as_str()));
            continue;
        };
        match headings[position].unit(*dimension) {
            // A column requested twice is read once.
            Ok(_) if columns.iter().any(|column| column.position == position) => {}
            Ok(unit) => {
                columns.push(Column { name: name.clone(), unit, values: Vec::new(), position });
            }
            Err(problem) => wrong.push((&headings[position], problem)),
        }
    }
    let mut faults = Faults::new(shown);
    for problem in header_fault::alike(wrong) {
        faults.push(|| problem);
    }
    if !lacking.is_empty() {
        faults.push(|| header_fault::missing(headings, &lacking, wanted, shown));
    }
    faults.finish(columns)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FORCE: Dimension = Dimension::of([1, 1, -2, 0, 0, 0]);

    fn read(bytes: &[u8], wanted: &[Wanted]) -> Result<Record, Vec<Problem>> {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(file.path(), bytes).expect("writable");
        read_record(file.path(), "r.csv", wanted)
    }

    fn wanted() -> [Wanted; 2] {
        [Wanted::new("time", Dimension::TIME), Wanted::new("Y", FORCE)]
    }

    /// Code and `line:column` of each problem.
    fn faults(text: &str) -> Vec<(&'static str, String)> {
        let problems = read(text.as_bytes(), &wanted()).expect_err(text);
        problems
            .iter()
            .map(|problem| {
                (
                    problem.code,
                    problem.at.as_ref().map_or(String::new(), |at| at.to_string()[6..].to_string()),
                )
            })
            .collect()
    }

    #[test]
    fn wanted_columns_in_si_and_in_the_order_asked_for() {
        let text = "\u{feff}\"Y [kN]\",note [-],time [ms],x\r\n1.5,\"a, b\",5,-\r\n -2e1 ,,\"10\",\r\n\r\n";
        let record =
            read(text.as_bytes(), &wanted()).unwrap_or_else(|problems| panic!("{problems:?}"));
        assert_eq!(
            record.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(),
            ["time", "Y"]
        );
        assert_eq!(record.columns[0].values, [0.005, 0.01]);
        assert_eq!(record.columns[1].values, [1500.0, -20_000.0]);
        assert_eq!(
            (record.rows, record.channels.len(), record.columns[1].unit.text.as_str()),
            (2, 4, "kN")
        );
        assert_eq!(record.bytes, text.len());
    }

    #[test]
    fn an_optional_column_may_be_missing() {
        let wanted = [
            Wanted::new("time", Dimension::TIME),
            Wanted::new("Z", FORCE).if_there(),
            Wanted::new("time", Dimension::TIME),
        ];
        assert_eq!(read(b"time [s]\n1", &wanted).map(|record| record.columns.len()).ok(), Some(1));
        assert_eq!(read(b"time [s]\n1\n2\n", &[]).map(|record| record.rows).ok(), Some(2));
    }

    #[test]
    fn each_fault_at_its_row_and_column() {
        for (text, code, at) in [
            ("time [s],Y [kN]\n0,1\n0.1,NaN\n", "not-finite", "3:5"),
            ("time [s],Y [kN]\n0,1\n0.1,1e999\n", "not-finite", "3:5"),
            ("time [s],Y [kN]\n0,1\n0.1,\n", "not-a-number", "3:5"),
            ("time [s],Y [kN]\n0,1\n0.1,#N/A\n", "not-a-number", "3:5"),
            ("time [s],Y [kN]\n0,1\n0.1,1 000\n", "not-a-number", "3:5"),
            ("time [s],Y [kN]\n0,1\n0.1,\"1,23\"\n", "decimal-comma", "3:6"),
            ("time [s],Y [kN]\n0,0,1,5\n", "decimal-comma", "2:1"),
            ("time [s],Y [kN]\n0,1\n0.1,1,9.5\n0.2,3\n", "ragged-row", "3:7"),
            ("time [s],Y [kN]\n0\n1,2\n", "ragged-row", "2:1"),
            ("time [s],Y [kN]\n0,1\n0.1", "truncated-row", "3:1"),
            ("time [s],Y [kN]\n0,1\n\n0.1,2\n", "blank-line", "3:1"),
            ("time [s],Y [kN]\n0,1\n\"0,1\n", "stray-quote", "3:1"),
            ("time [s],Y [kN]\n", "no-rows", ""),
            ("time [s],Y [kN]\n\n\n", "no-rows", ""),
            ("", "file-empty", ""),
            ("\n\n", "file-empty", ""),
            ("time [s];Y [kN]\n0;1\n", "semicolon-separated", "1:9"),
            ("time [s]\tY [kN]\n0\t1\n", "tab-separated", "1:9"),
            ("time [s],Y [kN]\r0,1\r1,1\r", "line-ends", "1:1"),
            ("time [s],Y\n0,1\n", "unit-missing", "1:10"),
            ("time [s],Y [kn]\n0,1\n", "unknown-unit", "1:13"),
            ("time [s],Y [m/s^2]\n0,1\n", "unit-mismatch", "1:13"),
            ("time [s],Y_1 [kN]\n0,1\n", "unknown-channel", "1:1"),
            ("time [s],Y [kN],Y [N]\n0,1,2\n", "duplicate-column", "1:17"),
            ("time [s],\"Y [kN]\n0,1\n", "stray-quote", "1:10"),
        ] {
            assert_eq!(faults(text), [(code, at.to_string())], "{text}");
        }
    }

    #[test]
    fn a_problem_far_down_keeps_only_its_line_and_many_are_counted() {
        let mut text = String::from("time [s],Y [kN]\n");
        for n in 0..30_000 {
            text += if n >= 29_990 { "1,x\n" } else { "1,2\n" };
        }
        let problems = read(text.as_bytes(), &wanted()).expect_err("ten faults");
        assert_eq!(problems.len(), 6);
        assert_eq!(
            problems[0].at.as_ref().map(|at| (at.to_string(), at.source.text.as_str())),
            Some(("r.csv:29992:3".into(), "1,x"))
        );
        assert_eq!(problems[5].says, "and 5 more problems in `r.csv`");
    }

    #[test]
    fn a_place_is_found_again() {
        let mut file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::io::Write::write_all(&mut file, "Y [kN],time [s]\r\n1,2\r\n3,45\r\n".as_bytes())
            .expect("writable");
        let record = read_record(file.path(), "r.csv", &wanted()).expect("good");
        let place = record.place(1, record.column("time")).expect("there");
        assert_eq!((place.to_string(), place.text()), ("r.csv:3:3".into(), "45"));
    }

    const SAMPLE: &str =
        "time [s],\"x [-]\",Y [kN]\r\n0.000,a,-1.25\r\n0.005,\"b, c\",1e-3\n0.010,,7\n";

    #[test]
    fn every_prefix_is_survived() {
        (0..=SAMPLE.len()).for_each(|at| drop(read(&SAMPLE.as_bytes()[..at], &wanted())));
    }

    proptest! {
        #[test]
        fn flipped_bytes_are_survived(flips in prop::collection::vec((0..SAMPLE.len(), any::<u8>()), 1..5)) {
            let mut bytes = SAMPLE.as_bytes().to_vec();
            for (at, byte) in flips {
                bytes[at] = byte;
            }
            match read(&bytes, &wanted()) {
                Ok(record) => prop_assert!(record.columns.iter().all(|column| column.values.len() == record.rows)),
                Err(problems) => problems.iter().for_each(|problem| drop(problem.render(false))),
            }
        }

        /// The `csv` crate and the standard library read the same numbers.
        #[test]
        fn reads_as_the_csv_crate(rows in prop::collection::vec((-1e6..1e6f64, "[a-z]{0,3}", any::<i16>(), 0..6usize), 1..20)) {
            let mut text = String::from("time [s],note [-],Y [N]\n");
            for (time, note, y, decimals) in &rows {
                text += &format!("{time:.decimals$},{note},{y}\n");
            }
            let record = read(text.as_bytes(), &wanted()).expect("well formed");
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            for (at, line) in reader.records().enumerate() {
                let line = line.expect("well formed");
                prop_assert_eq!(record.columns[0].values[at].to_bits(), line[0].parse::<f64>().expect("a number").to_bits());
                prop_assert_eq!(record.columns[1].values[at], line[2].parse::<f64>().expect("a number"));
            }
            prop_assert_eq!(record.rows, rows.len());
        }
    }
}
