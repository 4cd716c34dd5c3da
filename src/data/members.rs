//! The folders of records of a campaign: one of each kind, or several simulations or runs with a
//! name each.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

use super::campaign::{Opening, RecordKind};
use super::folder::{Folder, Place};
use super::record::{Format, Held, Known, Stored};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
use crate::store;
use crate::yaml::{FromNode, Key, Node, Reader, Value};

/// A folder of records.
#[derive(Clone, Debug)]
pub(super) struct RecordFolder {
    pub kind: RecordKind,
    /// Where there are several of the kind.
    pub name: Option<Arc<str>>,
    /// What a list or a map calls it, also if it is the only one.
    pub called: Option<Arc<str>>,
    pub folder: Spanned<String>,
    /// Files that belong to no section; listed if a record is missing.
    pub strangers: OnceLock<Vec<String>>,
    /// Where the folder is, once it was looked for.
    pub place: OnceLock<Place>,
    /// What is known of the records, if the folder is in a store.
    objects: Arc<Mutex<Objects>>,
}

/// Records in a store, by section.
#[derive(Debug, Default)]
struct Objects {
    known: BTreeMap<String, Known>,
    held: Held,
}

impl RecordFolder {
    /// Whether the folder is in a store: its records are objects, and it is never listed.
    pub fn in_store(&self) -> bool {
        store::is_url(&self.folder.value)
    }

    /// The record of a section in a store, which must exist.
    ///
    /// # Errors
    /// As [`Known::stored`].
    pub fn object(&self, section: &str) -> Result<Stored, Problem> {
        let url = format!(
            "{}/{section}.{}",
            self.folder.value.trim_end_matches('/'),
            Format::Parquet.ending()
        );
        let known = {
            // Nothing is half-written under the lock, so a panic of another thread does no harm.
            let mut objects = self.objects.lock().unwrap_or_else(PoisonError::into_inner);
            let Objects { known, held } = &mut *objects;
            known.entry(section.to_string()).or_insert_with(|| Known::with(held)).clone()
        };
        known.stored(&url, &self.folder.span)
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

/// Longest name of a record [bytes]: a file name of any system.
const LONGEST: usize = 200;

/// The folders of one kind: a folder, a list of folders, or a map of names and folders.
///
/// Problems: `wrong-kind`, `no-records` for an empty list, `name-invalid`, `duplicate-name`, and
/// those of [`Folder::place`].
#[derive(Clone, Debug, Default)]
pub(super) struct Folders(pub Vec<RecordFolder>);

impl FromNode<Opening<'_>> for Folders {
    fn from_node(reader: &mut Reader<'_, Opening<'_>>, key: &Key, node: &Node) -> Option<Self> {
        let kind = RecordKind::ALL.into_iter().find(|kind| kind.key() == key.text)?;
        let several = matches!(node.value, Value::List(_) | Value::Map(_));
        if !several || kind == RecordKind::Track {
            return Some(Self(vec![of(kind, None, None, Spanned::from_node(reader, key, node)?)]));
        }
        let mut found: Vec<(Spanned<String>, Spanned<String>)> = Vec::new();
        let items = node.items().iter().map(|item| (None, item));
        let entries = node.entries().iter().map(|(name, item)| (Some(name), item));
        for (name, item) in items.chain(entries) {
            let Some(written) = Spanned::from_node(reader, name.unwrap_or(key), item) else {
                continue;
            };
            let inside = inside(&reader.with.folder, &written);
            let Some(inside) = reader.keep(inside) else { continue };
            let name = match name {
                Some(name) => Spanned::new(name.text.trim().to_string(), name.span.clone()),
                None => {
                    let last = inside.rsplit('/').next().unwrap_or_default();
                    Spanned::new(last.to_string(), written.span.clone())
                }
            };
            found.push((name, written));
        }
        if node.items().is_empty() && node.entries().is_empty() {
            let says = format!("`{}` names no folder", key.text);
            let help = format!("`{0}: {0}`, or a list of folders", key.text);
            reader.tell(Problem::error("no-records", says).at(&node.span).help(help));
        }
        reader.are_different(&found, &key.text);
        let one = found.len() == 1;
        let named = |(name, folder): (Spanned<String>, Spanned<String>)| {
            let called: Arc<str> = name.value.into();
            of(kind, (!one).then(|| Arc::clone(&called)), Some(called), folder)
        };
        Some(Self(found.into_iter().map(named).collect()))
    }
}

impl Reader<'_, Opening<'_>> {
    /// Names and folders of records are different, and the names can be used.
    fn are_different(&mut self, found: &[(Spanned<String>, Spanned<String>)], key: &str) {
        for (at, (name, written)) in found.iter().enumerate() {
            self.keep(check_name(name));
            let before = &found[..at];
            let (problem, first) = if let Some((first, _)) =
                before.iter().find(|(known, _)| known.value == name.value)
            {
                let says = format!("two records are named `{}`", name.value);
                let help =
                    format!("give each its own name: `{key}: {{name: folder, other: folder}}`");
                (Problem::error("duplicate-name", says).at(&name.span).help(help), first)
            } else if let Some((_, first)) =
                before.iter().find(|(_, known)| same_folder(&self.with.folder, known, written))
            {
                let says = format!("the folder `{}` is given twice", written.value);
                (Problem::error("duplicate-name", says).at(&written.span), first)
            } else {
                continue;
            };
            self.tell(problem.also(&first.span, "the first"));
        }
    }
}

fn of(
    kind: RecordKind,
    name: Option<Arc<str>>,
    called: Option<Arc<str>>,
    folder: Spanned<String>,
) -> RecordFolder {
    RecordFolder {
        kind,
        name,
        called,
        folder,
        strangers: OnceLock::new(),
        place: OnceLock::new(),
        objects: Arc::default(),
    }
}

/// Names are joined by commas where records are compared: `simpack, run1`.
fn check_name(name: &Spanned<String>) -> Result<(), Problem> {
    let fine = |name: &str| {
        !name.is_empty()
            && name.len() <= LONGEST
            && !name.contains(',')
            && !name.contains(char::is_control)
    };
    if fine(&name.value) {
        return Ok(());
    }
    let says = format!("`{}` cannot be the name of a record", name.value);
    let help = format!("a name has 1 to {LONGEST} bytes, without commas and control characters");
    Err(Problem::error("name-invalid", says).at(&name.span).help(help))
}

fn same_folder(folder: &Folder, a: &Spanned<String>, b: &Spanned<String>) -> bool {
    let inside = |written: &Spanned<String>| inside(folder, written).ok();
    inside(a).is_some_and(|a| inside(b) == Some(a))
}

/// The path inside the campaign, or the URL without a `/` at its end.
fn inside(folder: &Folder, written: &Spanned<String>) -> Result<String, Problem> {
    if store::is_url(&written.value) {
        return Ok(written.value.trim_end_matches('/').to_string());
    }
    folder.place(&written.value, &written.span).map(|place| place.inside)
}

/// What needs one record of a kind, and finds several.
pub(super) fn several(kind: RecordKind, folders: &[&RecordFolder], at: &Span) -> Problem {
    let names: Vec<&str> = folders.iter().filter_map(|folder| folder.name.as_deref()).collect();
    let says = format!(
        "the campaign has {} records of the {}, and one is needed here",
        names.len(),
        kind.key()
    );
    let help = format!(
        "name one folder: `{}: {}`; there are {}",
        kind.key(),
        folders[0].folder.value,
        names.join(", ")
    );
    Problem::error("several-records", says).at(at).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let found: Folders = reader.optional(&tree, "simulation").unwrap_or_default();
        assert!(
            problems.0.iter().all(|problem| problem.at.is_some()),
            "{}",
            problems.render(false)
        );
        let found = found
            .0
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
