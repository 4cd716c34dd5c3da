//! Identification of a report, as stated by the campaign.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::{Map, Value};

/// An item that an assessor expects in a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ReportItem {
    /// Path in the block `report` of the campaign: its key, preceded by the key of the enclosing
    /// map, if any.
    pub path: Vec<String>,
    pub title: String,
    /// Clause of ISO/IEC 17025:2017 that requires it, if any.
    pub clause: Option<String>,
    /// `None`: not stated.
    pub value: Option<String>,
}

/// What identifies a report.
///
/// In files `report` has the structure of the campaign, and `report_data` is the list of items.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(into = "InFile", from = "InFile")]
pub struct Identification(pub Vec<ReportItem>);

/// See [`Identification`].
#[derive(Serialize, Deserialize, JsonSchema)]
struct InFile {
    report: Value,
    report_data: Vec<ReportItem>,
}

impl From<Identification> for InFile {
    fn from(Identification(report_data): Identification) -> Self {
        Self { report: tree(&report_data), report_data }
    }
}

impl From<InFile> for Identification {
    fn from(file: InFile) -> Self {
        Self(file.report_data)
    }
}

impl std::ops::Deref for Identification {
    type Target = [ReportItem];

    fn deref(&self) -> &[ReportItem] {
        &self.0
    }
}

/// All items in the structure of the campaign; missing ones are `null`.
fn tree(items: &[ReportItem]) -> Value {
    let mut root = Map::new();
    for item in items {
        let mut at = &mut root;
        let Some((last, groups)) = item.path.split_last() else { continue };
        for group in groups {
            let inner = at.entry(group.clone()).or_insert_with(|| Value::Object(Map::new()));
            let Value::Object(inner) = inner else { return Value::Null };
            at = inner;
        }
        at.insert(last.clone(), item.value.clone().into());
    }
    Value::Object(root)
}

/// The value under a path, if stated.
pub fn stated<'a>(items: &'a [ReportItem], path: &[&str]) -> Option<&'a str> {
    items.iter().find(|item| item.path == path)?.value.as_deref()
}
