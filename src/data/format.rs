//! The formats of records.

use std::path::Path;

/// Format of a record, which is told by the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Csv,
    Parquet,
}

impl Format {
    pub const ALL: [Self; 2] = [Self::Csv, Self::Parquet];

    /// Of a file; every other ending is read as CSV.
    pub fn of(path: &Path) -> Self {
        let parquet = path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case(Self::Parquet.ending()));
        if parquet { Self::Parquet } else { Self::Csv }
    }

    /// Without the point.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }

    /// The name of a file with the ending of the format.
    pub fn file(self, name: &str) -> String {
        format!("{name}.{}", self.ending())
    }

    /// The name of a record without its ending.
    pub fn stem(name: &str) -> Option<&str> {
        Self::ALL
            .into_iter()
            .find_map(|format| name.strip_suffix(format.ending())?.strip_suffix('.'))
    }
}
