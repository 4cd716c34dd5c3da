//! By what a report is known, as the campaign states it.

use serde_json::{Map, Value};

/// Something that an assessor expects a report to state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportItem {
    /// Where it stands in the block `report` of the campaign: its key, with that of a map before it if it stands in one.
    pub path: Vec<String>,
    pub title: String,
    /// Clause of ISO/IEC 17025:2017 that asks for it, if one does.
    pub clause: Option<String>,
    /// `None`: not stated.
    pub value: Option<String>,
}

/// All of them as the campaign writes them, keys in their order; what is not stated is `null`.
#[must_use]
pub fn tree(items: &[ReportItem]) -> Value {
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

/// What is stated under a path.
#[must_use]
pub fn stated<'a>(items: &'a [ReportItem], path: &[&str]) -> Option<&'a str> {
    items.iter().find(|item| item.path == path)?.value.as_deref()
}
