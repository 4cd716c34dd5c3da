//! How imported records were made, for print: what is the same for all records of a side once.

use serde::Serialize;

use crate::result::{ImportedOne, ImportedSide};

/// One side.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MadeView {
    /// `measurement`
    pub side: String,
    /// `Y_1L = -ST1 Y li`, one for each channel.
    pub channels: Vec<String>,
    /// What was detected in every file; empty if it differs.
    pub read_as: String,
    /// Steps of every record.
    pub steps: Vec<String>,
    pub rows: Vec<MadeRow>,
}

/// One record.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MadeRow {
    pub section: String,
    pub file: String,
    pub sha256: String,
    /// What is not the same for all, in a line.
    pub steps: String,
}

pub(super) fn view(side: &ImportedSide) -> MadeView {
    let all = |holds: &dyn Fn(&ImportedOne) -> bool| side.records.iter().all(holds);
    let first = side.records.first();
    let read_as = first.map_or("", |first| first.read_as.as_str());
    let read_as = if all(&|record| record.read_as == read_as) { read_as } else { "" };
    let common = |step: &&String| all(&|record| record.steps.contains(step));
    let steps: Vec<String> =
        first.map_or(&[][..], |first| &first.steps).iter().filter(common).cloned().collect();
    let row = |record: &ImportedOne| {
        let own = record.steps.iter().filter(|step| !steps.contains(step)).map(String::as_str);
        let own: Vec<&str> = Some(record.read_as.as_str())
            .filter(|of| *of != read_as)
            .into_iter()
            .chain(own)
            .collect();
        MadeRow {
            section: record.section.clone(),
            file: record.file.clone(),
            sha256: record.sha256.clone(),
            steps: own.join("; "),
        }
    };
    let rows = side.records.iter().map(row).collect();
    MadeView {
        side: side.side.clone(),
        channels: side.channels.clone(),
        read_as: read_as.to_owned(),
        steps,
        rows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_common_is_said_once() {
        let one = |section: &str, rows: &str| ImportedOne {
            section: section.into(),
            file: format!("{section}.csv"),
            sha256: String::new(),
            read_as: "csv".into(),
            steps: vec![rows.into(), "distance = Weg".into()],
        };
        let side = ImportedSide {
            side: "measurement".into(),
            channels: Vec::new(),
            records: vec![one("S01", "5 rows"), one("S02", "6 rows")],
        };
        let found = view(&side);
        assert_eq!(
            (found.read_as.as_str(), &found.steps[..]),
            ("csv", &["distance = Weg".to_string()][..])
        );
        assert_eq!(
            found.rows.iter().map(|row| row.steps.as_str()).collect::<Vec<_>>(),
            ["5 rows", "6 rows"]
        );
        let mut other = side.clone();
        other.records[1].read_as = "mdf4".into();
        assert_eq!(view(&other).rows[1].steps, "mdf4; 6 rows");
        assert!(view(&ImportedSide { records: Vec::new(), ..side }).rows.is_empty());
    }
}
