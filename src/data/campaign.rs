//! A campaign folder: description, vehicle, sections, and the places of the records.
//!
//! Only the keys of the folder layout are defined here; all others are facts, which are printed or requested by name.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use super::cells::name_and_unit;
use super::folder::{Folder, Place, check_file_name};
use super::identification::{self, REPORT_KEY, Stated};
use super::origin::{ORIGIN_KEY, Origin};
use super::record::{Record, Wanted, read_record};
use super::table::{Cell, Table};
use super::text::{other_format, read_any, read_text};
use crate::disk;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span, Spanned};
use crate::yaml::{self, Key, Node, Value};

/// The file that makes a folder a campaign.
pub const CAMPAIGN_FILE: &str = "campaign.yaml";
/// The column of the section table with the names of the sections; the first column if it is missing.
const SECTION_KEY: &str = "section";

/// The kinds of records of a campaign, each in its own folder with one file per section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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

/// An entry of `campaign.yaml` beyond the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// The key of the enclosing map; empty at the top level.
    pub group: String,
    /// The key without its unit.
    pub name: String,
    /// The text in brackets after the name.
    pub unit: Option<String>,
    /// As written.
    pub text: String,
    pub span: Span,
}

/// A value that the campaign sets for a parameter of the protocol.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: Key,
    pub value: Node,
}

/// A file that was read, and its fingerprint.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadFile {
    /// Path inside the campaign, with `/`.
    pub path: String,
    pub sha256: String,
    pub bytes: u64,
}

#[derive(Clone, Debug)]
pub struct Campaign {
    pub name: String,
    pub source: Arc<Source>,
    /// The whole of `campaign.yaml`.
    pub tree: Node,
    pub facts: Vec<Fact>,
    pub parameters: Vec<Parameter>,
    /// Contents of the block `report`.
    pub report: Vec<Stated>,
    /// Name or path of the default protocol.
    pub protocol: Option<Spanned<String>>,
    /// Origin of the simulated records, if they were written by a program.
    pub origin: Option<Origin>,
    /// The whole vehicle file; an empty map if the campaign has none.
    pub vehicle: Node,
    /// Absent if the campaign has no section table; every measured record is then evaluated as a whole.
    pub sections: Option<Table>,
    /// The names of the sections in the order of the table, or of the measured records, sorted.
    pub names: Vec<Cell>,
    /// `campaign.yaml`, the vehicle file and the section table, if present.
    pub files: Vec<ReadFile>,
    folder: Folder,
    record_folders: Vec<(RecordKind, Spanned<String>)>,
    /// Files in a folder of records that belong to no section, by kind; listed if a record is missing.
    strangers: [OnceLock<Vec<String>>; RecordKind::ALL.len()],
}

/// Maximum number of name comparisons for suggestions of missing records.
const MOST_COMPARISONS: usize = 1_000_000;

impl Campaign {
    /// Opens a campaign by its folder or its `campaign.yaml`. Records are read later.
    ///
    /// Problems: those of [`read_text`], [`yaml::load`] and [`Table::read`]; `folder-missing`, `path-outside`, `path-invalid`,
    /// `key-missing`, `wrong-kind`, `no-records`.
    pub fn open(path: &Path, problems: &mut Problems) -> Option<Self> {
        let before = problems.errors();
        let named = path.file_name().is_some_and(|name| name == CAMPAIGN_FILE) && !disk::is_folder(path).unwrap_or(false);
        let folder = Folder::open(if named { parent(path) } else { path }).map_err(|problem| problems.push(problem)).ok()?;
        let nowhere = Source::new(path.display().to_string(), "").whole();
        let place = folder.place(CAMPAIGN_FILE, &nowhere).map_err(|problem| problems.push(problem)).ok()?;
        let mut opening = Opening { folder, files: Vec::new(), problems };
        if disk::is_folder(&opening.folder.real().join(disk::UNFINISHED)).unwrap_or(false) {
            let says = format!("`{}` is incomplete: the run that wrote this campaign was interrupted", path.display());
            opening.problems.push(Problem::error("unfinished-set", says).help("repeat that run, with the same `--out`"));
            return None;
        }
        // Disk errors are reported when the file is read.
        if matches!(disk::is_file(&place.path), Ok(false)) {
            let says = format!("there is no file `{}`", place.shown);
            opening.problems.push(Problem::error("file-missing", says).help("a campaign is a folder with a file `campaign.yaml`"));
            return None;
        }
        let (source, tree) = opening.yaml(&place, None)?;
        if !matches!(tree.value, Value::Map(_)) {
            problems.push(
                Problem::error("wrong-kind", format!("a campaign must be a map of keys and values, not {}", tree.kind_in_words()))
                    .at(&tree.span),
            );
            return None;
        }
        let name = opening.text(&tree, "name").map(|name| name.value);
        if name.is_none() && tree.get("name").is_none() {
            opening.problems.push(Problem::error("key-missing", "the campaign has no `name`").at(&tree.span.part(0..0)));
        }
        opening.misspelt(&tree);
        let vehicle = opening.vehicle(&tree);
        let sections = opening.sections(&tree);
        let record_folders = RecordKind::ALL.into_iter().filter_map(|kind| Some((kind, opening.text(&tree, kind.key())?))).collect();
        let protocol = opening.text(&tree, "protocol");
        let parameters = opening.parameters(&tree);
        let origin = opening.origin(&tree);
        let report = identification::read(&tree, opening.problems);
        let Opening { folder, files, .. } = opening;
        let mut campaign = Self {
            name: name.unwrap_or_default(),
            facts: facts(&tree),
            parameters,
            report,
            protocol,
            origin,
            vehicle: vehicle.unwrap_or_else(|| Node {
                value: Value::Map(Vec::new()),
                span: tree.span.clone(),
                raw: String::new(),
                exact: false,
            }),
            names: Vec::new(),
            sections,
            source,
            tree,
            files,
            folder,
            record_folders,
            strangers: Default::default(),
        };
        if problems.errors() == before {
            campaign.find_names(problems);
        }
        (problems.errors() == before).then_some(campaign)
    }

    fn find_names(&mut self, problems: &mut Problems) {
        self.names = match &self.sections {
            Some(table) => table.names().cloned().collect(),
            None => match self.measured() {
                Ok(names) => names,
                Err(problem) => return problems.push(problem),
            },
        };
        for name in &self.names {
            if let Err(problem) = check_file_name(&name.value, &name.span) {
                problems.push(problem);
            }
        }
    }

    /// The names of the measured records.
    fn measured(&self) -> Result<Vec<Cell>, Problem> {
        let kind = RecordKind::Measurement;
        let (place, span) = self.record_folder(kind)?;
        let entries = disk::names(&place.path).map_err(|error| no_folder(&error, &place.shown).at(span))?;
        let mut names: Vec<String> = entries
            .iter()
            .filter_map(|name| Some(name.to_str()?.strip_suffix(".csv")?.to_string()))
            .filter(|name| !name.starts_with('.'))
            .collect();
        if names.is_empty() {
            let others: Vec<String> = entries.into_iter().filter_map(|name| name.into_string().ok()).collect();
            if let Some(problem) = others.iter().find_map(|name| other_format(Path::new(name), &format!("{}/{name}", place.inside))) {
                return Err(problem.at(span));
            }
            return Err(Problem::error("no-records", format!("there is no CSV file in `{}`", place.shown)).at(span));
        }
        names.sort();
        Ok(names.into_iter().map(|name| Spanned::new(name, span.clone())).collect())
    }

    fn record_folder(&self, kind: RecordKind) -> Result<(Place, &Span), Problem> {
        let Some((_, written)) = self.record_folders.iter().find(|(known, _)| *known == kind) else {
            return Err(Problem::error("key-missing", format!("the campaign has no `{}`, the folder of its records", kind.key()))
                .at(&self.tree.span.part(0..0)));
        };
        Ok((self.folder.place(&written.value, &written.span)?, &written.span))
    }

    /// Whether the campaign names a folder for records of a kind.
    pub fn has(&self, kind: RecordKind) -> bool {
        self.record_folders.iter().any(|(known, _)| *known == kind)
    }

    /// The place of the record of a section, which must exist.
    ///
    /// # Errors
    /// `key-missing`, `folder-missing`, `path-outside`, `file-missing` (with the nearest name in that folder).
    pub fn record_place(&self, kind: RecordKind, section: &Cell) -> Result<Place, Problem> {
        check_file_name(&section.value, &section.span)?;
        let (folder, span) = self.record_folder(kind)?;
        let place = self.folder.place(&format!("{}/{}.csv", folder.inside, section.value), &section.span)?;
        let unreadable = |error| Problem::error("file-unreadable", format!("`{}` cannot be read: {error}", place.inside)).at(&section.span);
        if disk::is_file(&place.path).map_err(unreadable)? {
            return Ok(place);
        }
        if !disk::is_folder(&folder.path).map_err(unreadable)? {
            return Err(Problem::error("folder-missing", format!("there is no folder `{}`", folder.inside)).at(span));
        }
        let others = self.strangers[kind as usize].get_or_init(|| self.strangers(&folder.path));
        let in_other_format = |name: &String| {
            let same = Path::new(name).file_stem().and_then(|stem| stem.to_str()) == Some(&section.value);
            other_format(Path::new(name), &format!("{}/{name}", folder.inside)).filter(|_| same)
        };
        if let Some(problem) = others.iter().find_map(in_other_format) {
            return Err(problem.at(&section.span));
        }
        let problem = Problem::error("file-missing", format!("there is no file `{}`", place.inside)).at(&section.span);
        if others.len().saturating_mul(self.names.len()) > MOST_COMPARISONS {
            return Err(problem);
        }
        Err(problem.suggest(&format!("{}.csv", section.value), others.iter().map(String::as_str)))
    }

    /// Files of a folder that are not records of sections. Records of other sections are not suggested.
    fn strangers(&self, folder: &Path) -> Vec<String> {
        let sections: HashSet<&str> = self.names.iter().map(|name| name.value.as_str()).collect();
        let names = disk::names(folder).unwrap_or_default().into_iter().filter_map(|name| name.into_string().ok());
        names.filter(|name| !name.strip_suffix(".csv").is_some_and(|name| sections.contains(name))).collect()
    }

    /// The folders and files of the campaign, without symbolic links.
    pub fn inputs(&self) -> Inputs {
        let real = |place: &Place| disk::real(&place.path).ok().flatten().unwrap_or_else(|| place.path.clone());
        let folders = RecordKind::ALL.into_iter().filter_map(|kind| Some(real(&self.record_folder(kind).ok()?.0)));
        let named = self.files.iter().filter_map(|file| self.folder.place(&file.path, &self.tree.span.part(0..0)).ok());
        let files = named.chain(self.vehicle_files().unwrap_or_default());
        Inputs { folder: self.folder.real().to_path_buf(), folders: folders.collect(), files: files.map(|place| real(&place)).collect() }
    }

    /// Reads the wanted columns of a section's record. Problems are part of the results and must not depend on the place of the campaign:
    /// they name the record by its path inside the campaign.
    ///
    /// # Errors
    /// As [`Campaign::record_place`] and [`read_record`].
    pub fn read(&self, kind: RecordKind, section: &Cell, wanted: &[Wanted]) -> Result<(Record, ReadFile), Vec<Problem>> {
        let place = self.record_place(kind, section).map_err(|problem| vec![problem])?;
        let record = read_record(&place.path, &place.inside, wanted)?;
        let file = ReadFile { path: place.inside, sha256: record.sha256.clone(), bytes: record.bytes as u64 };
        Ok((record, file))
    }

    /// All files of the campaign except its `campaign.yaml` and the records of one kind, with their paths inside and their bytes, for a
    /// copy of the campaign.
    ///
    /// # Errors
    /// A file cannot be read, or is outside the campaign.
    pub fn other_files(&self, but: RecordKind) -> Result<Vec<(String, Vec<u8>)>, Problem> {
        let mut inside: Vec<String> = self.files.iter().map(|file| file.path.clone()).filter(|path| path != CAMPAIGN_FILE).collect();
        for kind in RecordKind::ALL.into_iter().filter(|kind| *kind != but && self.has(*kind)) {
            for name in &self.names {
                inside.push(self.record_place(kind, name)?.inside);
            }
        }
        for place in self.vehicle_files()? {
            if !inside.contains(&place.inside) {
                inside.push(place.inside);
            }
        }
        let read = |inside: String| {
            let place = self.folder.place(&inside, &self.tree.span.part(0..0))?;
            Ok((inside, read_any(&place.path, &place.shown)?))
        };
        inside.into_iter().map(read).collect()
    }

    /// Files that the vehicle file names, if they exist.
    ///
    /// # Errors
    /// A path leads out of the campaign.
    pub fn vehicle_files(&self) -> Result<Vec<Place>, Problem> {
        let mut named = vec!["profile.csv".to_string(), "profile_worn.csv".to_string()];
        let maps = self.vehicle.entries().iter().flat_map(|(_, node)| node.entries());
        named.extend(maps.filter_map(|(_, node)| Some(node.scalar_text()?.to_string())).filter(|text| text.ends_with(".csv")));
        let mut found: Vec<Place> = Vec::new();
        for written in named {
            let place = self.folder.place(&written, &self.tree.span.part(0..0))?;
            let unreadable = |error| Problem::error("file-unreadable", format!("`{}` cannot be read: {error}", place.shown));
            if disk::is_file(&place.path).map_err(unreadable)? && !found.contains(&place) {
                found.push(place);
            }
        }
        Ok(found)
    }

    /// The path inside the campaign of a file named in a message.
    pub fn inside<'a>(&self, shown: &'a str) -> &'a str {
        self.folder.inside(shown)
    }

    /// The place of a file named by the campaign or its vehicle; it need not exist.
    ///
    /// # Errors
    /// `path-outside`, `path-invalid`.
    pub fn place(&self, written: &Spanned<String>) -> Result<Place, Problem> {
        self.folder.place(&written.value, &written.span)
    }
}

/// Absolute paths of a campaign's inputs.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// Folder of the campaign.
    pub folder: PathBuf,
    /// Folders of its records.
    pub folders: Vec<PathBuf>,
    pub files: Vec<PathBuf>,
}

/// Size of a file that was read before.
fn size(place: &Place) -> Result<u64, Problem> {
    match disk::kind(&place.path) {
        Ok(Some(disk::Kind::File(size))) => Ok(size),
        Ok(_) => Err(Problem::error("file-missing", format!("`{}` was removed while it was read", place.shown))),
        Err(error) => Err(Problem::error("file-unreadable", format!("`{}` cannot be read: {error}", place.shown))),
    }
}

fn no_folder(error: &std::io::Error, shown: &str) -> Problem {
    match disk::missing(error) {
        true => Problem::error("folder-missing", format!("there is no folder `{shown}`")),
        false => Problem::error("folder-unreadable", format!("`{shown}` cannot be read: {error}")),
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Shows a problem of a whole file where the file is named.
fn named_at(problem: Problem, span: Option<&Span>) -> Problem {
    match span {
        Some(span) if problem.at.is_none() => problem.at(span),
        _ => problem,
    }
}

struct Opening<'a> {
    folder: Folder,
    files: Vec<ReadFile>,
    problems: &'a mut Problems,
}

impl Opening<'_> {
    fn keep<T>(&mut self, result: Result<T, Problem>) -> Option<T> {
        result.map_err(|problem| self.problems.push(problem)).ok()
    }

    fn yaml(&mut self, place: &Place, named: Option<&Span>) -> Option<(Arc<Source>, Node)> {
        let (source, sha256) = self.keep(read_text(&place.path, &place.shown).map_err(|problem| named_at(problem, named)))?;
        let bytes = self.keep(size(place))?;
        self.files.push(ReadFile { path: place.inside.clone(), sha256, bytes });
        let tree = yaml::load(&source, self.problems)?;
        Some((source, tree))
    }

    /// The text of a key, if present; it must be a single value.
    fn text(&mut self, tree: &Node, key: &str) -> Option<Spanned<String>> {
        let node = tree.get(key)?;
        match node.scalar_text() {
            Some(text) if !text.trim().is_empty() => Some(Spanned::new(text.to_string(), node.span.clone())),
            _ => {
                let says = format!("`{key}` must be text, not {}", node.kind_in_words());
                self.problems.push(Problem::error("wrong-kind", says).at(&node.span));
                None
            }
        }
    }

    /// Reports a misspelt key of the layout, which would otherwise be printed as a fact and have no effect.
    fn misspelt(&mut self, tree: &Node) {
        let layout = || LAYOUT.into_iter().chain(RecordKind::ALL.into_iter().map(RecordKind::key));
        for (key, _) in tree.entries() {
            let off = |known: &&str| strsim::damerau_levenshtein(&key.text.to_lowercase(), known) <= 1;
            if layout().any(|known| known == key.text) {
                continue;
            }
            if let Some(near) = layout().find(off) {
                let problem = Problem::error("unknown-key", format!("a campaign has no key `{}`", key.text)).at(&key.span);
                self.problems.push(problem.help(format!("did you mean `{near}`?")));
            }
        }
    }

    fn vehicle(&mut self, tree: &Node) -> Option<Node> {
        let written = self.text(tree, "vehicle")?;
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let (_, vehicle) = self.yaml(&place, Some(&written.span))?;
        if matches!(vehicle.value, Value::Map(_)) {
            return Some(vehicle);
        }
        let says = format!("a vehicle must be a map of keys and values, not {}", vehicle.kind_in_words());
        self.problems.push(Problem::error("wrong-kind", says).at(&vehicle.span));
        None
    }

    fn sections(&mut self, tree: &Node) -> Option<Table> {
        let written = self.text(tree, "sections")?;
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let mut found = Problems::default();
        let table = Table::read(&place.path, &place.shown, Some(SECTION_KEY), &mut found);
        for problem in found.0 {
            self.problems.push(named_at(problem, Some(&written.span)));
        }
        let table = table?;
        let bytes = self.keep(size(&place))?;
        self.files.push(ReadFile { path: place.inside, sha256: table.sha256.clone(), bytes });
        Some(table)
    }

    /// From a file, or from `campaign.yaml` itself.
    fn origin(&mut self, tree: &Node) -> Option<Origin> {
        let node = tree.get(ORIGIN_KEY)?;
        if matches!(node.value, Value::Map(_)) {
            return Origin::read(node, self.problems);
        }
        let written = self.text(tree, ORIGIN_KEY)?;
        let place = self.folder.place(&written.value, &written.span);
        let place = self.keep(place)?;
        let (_, found) = self.yaml(&place, Some(&written.span))?;
        Origin::read(&found, self.problems)
    }

    fn parameters(&mut self, tree: &Node) -> Vec<Parameter> {
        let Some(node) = tree.get("parameters") else { return Vec::new() };
        if !matches!(node.value, Value::Map(_) | Value::Null) {
            let says = format!("`parameters` must be a map of names and values, not {}", node.kind_in_words());
            self.problems.push(Problem::error("wrong-kind", says).at(&node.span));
        }
        for (key, value) in node.entries() {
            if value.scalar_text().is_none() {
                let says = format!("the parameter `{}` must be a single value, not {}", key.text, value.kind_in_words());
                self.problems.push(Problem::error("wrong-kind", says).at(&value.span));
            }
        }
        node.entries().iter().map(|(name, value)| Parameter { name: name.clone(), value: value.clone() }).collect()
    }
}

/// Keys of `campaign.yaml` in addition to those of the records.
const LAYOUT: [&str; 7] = ["name", "vehicle", "sections", "parameters", "protocol", ORIGIN_KEY, REPORT_KEY];

/// Scalars at the top level and one map below it, in the order written.
fn facts(tree: &Node) -> Vec<Fact> {
    let layout = |key: &str| LAYOUT.contains(&key) || RecordKind::ALL.iter().any(|kind| kind.key() == key);
    let mut facts = Vec::new();
    for (key, node) in tree.entries().iter().filter(|(key, _)| !layout(&key.text)) {
        facts.extend(fact("", key, node));
        facts.extend(node.entries().iter().filter_map(|(inner, node)| fact(&key.text, inner, node)));
    }
    facts
}

fn fact(group: &str, key: &Key, node: &Node) -> Option<Fact> {
    let text = match &node.value {
        // A list of scalars is printed on one line; deeper structures are not facts.
        Value::List(items) => items.iter().map(Node::scalar_text).collect::<Option<Vec<_>>>()?.join(", "),
        _ => node.scalar_text()?.to_string(),
    };
    let (name, unit) = name_and_unit(&key.text);
    let unit = unit.map(|range| key.text[range].trim().to_string());
    Some(Fact { group: group.to_string(), name: name.to_string(), unit, text, span: node.span.clone() })
}
