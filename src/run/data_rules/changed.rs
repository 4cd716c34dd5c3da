//! Records that are not as an import wrote them.

use indexmap::IndexMap;

use crate::result::{
    Changed, Consequence, FileHash, Finding, FindingData, Occurrence, Reason, RecordOf,
};

/// Code of the finding.
const CODE: &str = "record-changed";

/// A finding for each such file. Without a stated reason the campaign is not assessable.
pub fn findings(files: &[FileHash]) -> Vec<Finding> {
    // A run is the record of several sections.
    let once: IndexMap<&str, (&RecordOf, &Changed)> = files
        .iter()
        .filter_map(|file| {
            Some((file.path.as_str(), (file.record.as_ref()?, file.changed.as_ref()?)))
        })
        .collect();
    let finding = |(file, (record, changed)): (&str, (&RecordOf, &Changed))| {
        let Changed { imported, reason } = changed.clone();
        let consequence = match reason {
            Some(_) => Consequence::Note,
            None => Consequence::NotAssessable,
        };
        let first = Occurrence {
            section: Some(record.section.clone()),
            record: Some(record.kind.clone()),
            ..FindingData::RecordChanged { file: file.into(), imported, reason }.into()
        };
        Finding { consequence, ..Finding::note(CODE, first) }
    };
    once.into_iter().map(finding).collect()
}

/// Why nothing can be assessed, if a finding says so.
pub fn reason(findings: &[Finding]) -> Option<Reason> {
    let barring = findings.iter().filter(|finding| {
        finding.code == CODE && finding.consequence == Consequence::NotAssessable
    });
    let records = barring.map(|finding| finding.places().len()).sum();
    (records > 0).then_some(Reason::RecordsChanged { records })
}
