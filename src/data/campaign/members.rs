//! The records of a campaign: one folder of each kind, or several simulations or runs with a name
//! each.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use serde::{Deserialize, Serialize};

use super::opening::Reader;
use crate::data::{
    folder::Folder,
    place::CampaignPath,
    prelude::*,
    record::{Format, Held, Known, Stored},
};
use crate::store;

/// The kinds of records that a campaign has, each in a folder of its own with a file per section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum RecordKind {
    Measurement,
    Simulation,
    Track,
}

impl RecordKind {
    pub const ALL: [Self; 3] = [Self::Measurement, Self::Simulation, Self::Track];

    /// The key in `campaign.yaml`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Measurement => "measurement",
            Self::Simulation => "simulation",
            Self::Track => "track",
        }
    }
}

/// One of the records of a section: its kind, and which of several of that kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct WhichRecord {
    pub kind: RecordKind,
    pub number: usize,
}

impl From<RecordKind> for WhichRecord {
    /// The first of the kind.
    fn from(kind: RecordKind) -> Self {
        Self { kind, number: 0 }
    }
}

/// A folder of records.
#[derive(Clone, Debug)]
pub struct RecordFolder {
    pub kind: RecordKind,
    /// Where there are several of the kind.
    pub name: Option<Arc<str>>,
    /// What a list or a map calls it, also if it is the only one.
    pub called: Option<Arc<str>>,
    pub folder: Spanned<String>,
    /// Files that belong to no section; listed if a record is missing.
    pub strangers: OnceLock<Vec<String>>,
    /// Where the folder is, once it was looked for.
    pub place: OnceLock<CampaignPath>,
    /// What is known of the records by section, if the folder is in a store, and their parts.
    objects: Arc<Mutex<(BTreeMap<String, Known>, Held)>>,
}

impl RecordFolder {
    fn new(
        kind: RecordKind,
        called: Option<Arc<str>>,
        several: bool,
        folder: Spanned<String>,
    ) -> Self {
        Self {
            kind,
            name: called.clone().filter(|_| several),
            called,
            folder,
            strangers: OnceLock::new(),
            place: OnceLock::new(),
            objects: Arc::default(),
        }
    }

    /// Whether the folder is in a store: its records are objects, and it is never listed.
    pub fn in_store(&self) -> bool {
        store::is_url(&self.folder.value)
    }

    /// The record of a section in a store, which must exist.
    ///
    /// # Errors
    /// As [`Known::stored`].
    pub fn object(&self, section: &str) -> Result<Stored, Problem> {
        let Spanned { value: folder, span } = &self.folder;
        let url = format!("{}/{}", folder.trim_end_matches('/'), Format::Parquet.file(section));
        let known = {
            // Nothing is half-written under the lock, so a panic of another thread does no harm.
            let mut objects = self.objects.lock().unwrap_or_else(PoisonError::into_inner);
            let (known, held) = &mut *objects;
            known.entry(section.to_string()).or_insert_with(|| Known::with(held)).clone()
        };
        known.stored(&url, span)
    }
}

/// Longest name of a record [bytes]: a file name of any system.
const LONGEST: usize = 200;

/// The folders of one kind: a folder, a list of folders, or a map of names and folders.
///
/// Problems: `wrong-kind`, `no-records` for an empty list, `name-invalid`, `duplicate-name`, and
/// those of [`Folder::place`].
pub fn record_folders(
    reader: &mut Reader<'_, '_>,
    key: &Key,
    node: &Node,
) -> Option<Vec<RecordFolder>> {
    let kind = RecordKind::ALL.into_iter().find(|kind| kind.key() == key.text)?;
    let several = matches!(node.value, Value::List(_) | Value::Map(_));
    if !several || kind == RecordKind::Track {
        let folder = Spanned::from_node(reader, key, node)?;
        return Some(vec![RecordFolder::new(kind, None, false, folder)]);
    }
    let mut found: Vec<Named> = Vec::new();
    let items = node.items().iter().map(|item| (None, item));
    let entries = node.entries().iter().map(|(name, item)| (Some(name), item));
    for (name, item) in items.chain(entries) {
        let written = Spanned::from_node(reader, name.unwrap_or(key), item);
        let Some(folder) = written else { continue };
        let inside = inside(&reader.with.folder, &folder);
        let Some(inside) = reader.keep(inside) else { continue };
        let (name, span) = match name {
            Some(name) => (name.text.trim(), &name.span),
            None => (inside.rsplit('/').next().unwrap_or_default(), &folder.span),
        };
        let name = Spanned::new(name.to_string(), span.clone());
        found.push(Named { name, folder, inside });
    }
    if node.items().is_empty() && node.entries().is_empty() {
        let help = format!("`{0}: {0}`, or a list of folders", key.text);
        reader
            .tell(problem!("no-records", &node.span, "`{}` names no folder", key.text).help(help));
    }
    check_names(reader, &found, &key.text);
    let several = found.len() > 1;
    let folder = |Named { name, folder, .. }: Named| {
        RecordFolder::new(kind, Some(name.value.into()), several, folder)
    };
    Some(found.into_iter().map(folder).collect())
}

/// A folder of several.
struct Named {
    name: Spanned<String>,
    folder: Spanned<String>,
    /// Its path inside the campaign, or its URL without a `/` at its end.
    inside: String,
}

/// Names and folders of records are different, and the names can be used. They are joined by commas
/// where records are compared: `simpack, run1`.
fn check_names(reader: &mut Reader<'_, '_>, found: &[Named], key: &str) {
    for (at, Named { name, folder, inside }) in found.iter().enumerate() {
        let text = &name.value;
        if text.is_empty()
            || text.len() > LONGEST
            || text.contains(',')
            || text.contains(char::is_control)
        {
            let help =
                format!("a name has 1 to {LONGEST} bytes, without commas and control characters");
            reader.tell(
                problem!("name-invalid", &name.span, "`{text}` cannot be the name of a record")
                    .help(help),
            );
        }
        let before = &found[..at];
        if let Some(first) = before.iter().find(|known| known.name.value == *text) {
            let help = format!("give each its own name: `{key}: {{name: folder, other: folder}}`");
            let problem =
                problem!("duplicate-name", &name.span, "two records are named `{text}`").help(help);
            reader.tell(problem.also(&first.name.span, "the first"));
        } else if let Some(first) = before.iter().find(|known| known.inside == *inside) {
            let problem = problem!(
                "duplicate-name",
                &folder.span,
                "the folder `{}` is given twice",
                folder.value
            );
            reader.tell(problem.also(&first.folder.span, "the first"));
        }
    }
}

/// The path inside the campaign, or the URL without a `/` at its end.
fn inside(folder: &Folder, written: &Spanned<String>) -> Result<String, Problem> {
    if store::is_url(&written.value) {
        return Ok(written.value.trim_end_matches('/').to_string());
    }
    folder.place(&written.value, &written.span).map(|place| place.inside)
}

/// What needs one record of a kind, and finds several.
pub fn several(kind: RecordKind, folders: &[&RecordFolder], at: &Span) -> Problem {
    let names: Vec<&str> = folders.iter().filter_map(|folder| folder.name.as_deref()).collect();
    let (kind, first, count) = (kind.key(), &folders[0].folder.value, names.len());
    let names = names.join(", ");
    let help = format!("name one folder: `{kind}: {first}`; there are {names}");
    problem!(
        "several-records",
        at,
        "the campaign has {count} records of the {kind}, and one is needed here"
    )
    .help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::campaign::opening::Opening;
    use crate::problem::Problems;
    use crate::source::Source;
    use crate::yaml;

    fn of_text(text: &str) -> (Vec<(Option<String>, String)>, Vec<&'static str>) {
        let temp = tempfile::tempdir().expect("a folder");
        let folder = Folder::open(temp.path()).expect("there");
        let mut problems = Problems::default();
        let tree = yaml::load(&Source::new("campaign.yaml", text), &mut problems).expect("YAML");
        let with = Opening { folder, files: Vec::new(), tree: None };
        let mut reader = Reader { with, problems: &mut problems };
        let found =
            tree.entry("simulation").and_then(|(key, node)| record_folders(&mut reader, key, node));
        assert!(
            problems.0.iter().all(|problem| problem.at.is_some()),
            "{}",
            problems.render(false)
        );
        let found = found
            .unwrap_or_default()
            .into_iter()
            .map(|one| (one.name.map(|name| name.to_string()), one.folder.value))
            .collect();
        (found, problems.0.iter().map(|problem| problem.code).collect())
    }

    fn named(name: &str, folder: &str) -> (Option<String>, String) {
        (Some(name.to_string()), folder.to_string())
    }

    #[test]
    fn one_folder_has_no_name_and_several_have() {
        let one = (vec![(None, "a".to_string())], vec![]);
        for text in ["simulation: a\n", "simulation: [a]\n", "simulation: {x: a}\n"] {
            assert_eq!(of_text(text), one, "{text}");
        }
        assert_eq!(
            of_text("simulation: [s/a, ./b/]\n"),
            (vec![named("a", "s/a"), named("b", "./b/")], vec![])
        );
        assert_eq!(
            of_text("simulation:\n  x: s/a\n  y: t/a\n"),
            (vec![named("x", "s/a"), named("y", "t/a")], vec![])
        );
        assert_eq!(of_text("measurement: a\n"), (vec![], vec![]));
        let stored = of_text("simulation: ['s3://b/x/', b]\n");
        assert_eq!(stored, (vec![named("x", "s3://b/x/"), named("b", "b")], vec![]));
    }

    #[test]
    fn what_names_no_records_is_told() {
        for (text, code) in [
            ("simulation: []\n", "no-records"),
            ("simulation: {}\n", "no-records"),
            ("simulation: [a, a]\n", "duplicate-name"),
            ("simulation: [s/a, t/a]\n", "duplicate-name"),
            ("simulation: {x: a, y: ./a}\n", "duplicate-name"),
            ("simulation: {x: 's3://b/a', y: 's3://b/a/'}\n", "duplicate-name"),
            ("simulation: [a, [b]]\n", "wrong-kind"),
            ("simulation: {x: }\n", "wrong-kind"),
            ("simulation: [a, ../b]\n", "path-outside"),
            ("simulation: {'x, y': a, z: b}\n", "name-invalid"),
            ("simulation: [., b]\n", "name-invalid"),
        ] {
            assert_eq!(of_text(text).1, [code], "{text}");
        }
    }
}
