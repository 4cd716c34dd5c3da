//! A mapping proposed from the files themselves: every channel with what was found in it, guesses
//! with their reasons as comments, and `?` where a person must decide. A draft with open places
//! does not pass the import.
//!
//! | file | content |
//! |---|---|
//! | `mod` | groups of files with the same channels, the pattern of their names |
//! | `look` | what is in a channel: unit, rate, range, mean |
//! | `alike` | both sides beside each other: order of digits, signs, direction, shift |
//! | `names` | what the words of a name say |
//! | `guess` | which channel it may be, by name and by content |
//! | `text` | the text of the draft |

mod alike;
mod guess;
mod look;
mod names;
mod text;

use std::path::Path;

use super::mapping::Convention;
use crate::data::RecordKind;
use crate::foreign::{self, Channel, File, Options, Table};
use crate::problem::Problem;
use crate::run::needs::Needs;
use crate::yaml::Words;
use look::{Look, look};

pub use text::draft;

/// Files with the same channels: one side of the campaign.
#[derive(Debug)]
pub struct Group {
    /// The side, where the path says it.
    pub kind: Option<RecordKind>,
    /// Path with `{section}`.
    pub files: String,
    /// `{section}`, where the sections are tables of one file.
    pub table: Option<String>,
    /// Names of the sections, as the paths or tables have them.
    pub sections: Vec<String>,
    /// The first of them.
    pub first: File,
    /// Number of its tables that belong to the first section.
    pub tables: usize,
    pub looks: Vec<Look>,
}

impl Group {
    /// The channels that were looked at, in the same order.
    fn channels(&self) -> impl Iterator<Item = &Channel> {
        used(&self.first).take(self.tables).flat_map(|table| &table.channels)
    }
}

/// The tables of a file that have rows.
fn used(file: &File) -> impl Iterator<Item = &Table> {
    file.tables.iter().filter(|table| !table.channels.is_empty() && table.rows > 1)
}

/// What the draft is made with.
#[derive(Debug)]
pub struct With<'a> {
    pub needs: &'a Needs,
    pub protocol: &'a str,
    pub convention: &'a Convention,
}

/// Reads the files and puts those with the same channels together.
///
/// # Errors
/// Those of the files.
pub fn groups(paths: &[&Path]) -> Result<Vec<Group>, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut by_channels: Vec<(Vec<String>, Vec<&Path>)> = Vec::new();
    for path in paths {
        match foreign::outline(path, &path.display().to_string(), &Options::default()) {
            Ok(file) => {
                let key = key(&file, side(&path.display().to_string()));
                match by_channels.iter_mut().find(|(known, _)| *known == key) {
                    Some((_, same)) => same.push(path),
                    None => by_channels.push((key, vec![path])),
                }
            }
            Err(found) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    by_channels.into_iter().map(|(_, paths)| group(&paths)).collect()
}

/// The path of a file from a folder. Both are relative to the working folder, or absolute.
fn from_folder(path: &str, folder: &Path) -> String {
    use std::path::Component;
    if folder.as_os_str().is_empty() || folder == Path::new(".") {
        return path.to_string();
    }
    let parts = |path: &Path| -> Option<Vec<String>> {
        let parts = path.components().filter(|part| *part != Component::CurDir);
        let name = |part: Component<'_>| {
            (part != Component::ParentDir).then(|| part.as_os_str().to_string_lossy().into_owned())
        };
        parts.map(name).collect()
    };
    // A path that leads upwards is made absolute first; without a working folder it stays as it is.
    let absolute = |path: &Path| std::path::absolute(path).ok();
    let both = match (parts(Path::new(path)), parts(folder)) {
        (Some(path), Some(of))
            if Path::new(&path.join("/")).is_absolute() == folder.is_absolute() =>
        {
            Some((path, of))
        }
        _ => absolute(Path::new(path))
            .zip(absolute(folder))
            .and_then(|(path, folder)| parts(&path).zip(parts(&folder))),
    };
    let Some((path_parts, folder_parts)) = both else { return path.to_string() };
    let same = path_parts.iter().zip(&folder_parts).take_while(|(one, other)| one == other).count();
    let up = std::iter::repeat_n("..", folder_parts.len() - same);
    up.chain(path_parts[same..].iter().map(String::as_str)).collect::<Vec<_>>().join("/")
}

/// Writes the paths of the groups relative to the folder that the draft will lie in.
pub fn relative_to(groups: &mut [Group], folder: &Path) {
    groups.iter_mut().for_each(|group| group.files = from_folder(&group.files, folder));
}

/// Side, format and channels of a file; tables with the same channels count once.
fn key(file: &File, side: Option<RecordKind>) -> Vec<String> {
    let mut tables: Vec<String> =
        file.tables.iter().filter(|table| !table.channels.is_empty()).map(names).collect();
    tables.dedup();
    let side = side.map_or("", RecordKind::key);
    [side, file.format.word()].into_iter().map(str::to_owned).chain(tables).collect()
}

fn names(table: &Table) -> String {
    table.channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join("\n")
}

fn group(paths: &[&Path]) -> Result<Group, Vec<Problem>> {
    let first = foreign::read(paths[0], &paths[0].display().to_string(), &Options::default())?;
    let shown: Vec<String> =
        paths.iter().map(|path| path.display().to_string().replace('\\', "/")).collect();
    let used: Vec<&Table> = used(&first).collect();
    let alike = used.len() > 1 && used.iter().all(|table| names(table) == names(used[0]));
    let (mut table, mut tables) = (None, used.len());
    let (files, sections) = match (&shown[..], alike) {
        ([one], true) => {
            (table, tables) = (Some("{section}".to_string()), 1);
            (one.clone(), used.iter().map(|table| table.name.clone()).collect())
        }
        ([one], false) => {
            let stem = paths[0].file_stem().unwrap_or_default();
            (one.clone(), vec![stem.to_string_lossy().into_owned()])
        }
        _ => pattern(&shown),
    };
    let looks = used.iter().take(tables).flat_map(|table| look(table)).collect();
    Ok(Group { kind: side(&shown[0]), files, table, sections, tables, looks, first })
}

/// Words in a path that say which side it is.
const MEASUREMENT: [&str; 4] = ["mess", "meas", "test", "fahrt"];
const SIMULATION: [&str; 2] = ["sim", "mks"];

fn side(path: &str) -> Option<RecordKind> {
    let lower = path.to_lowercase();
    let has = |words: &[&str]| words.iter().any(|word| lower.contains(word));
    match (has(&MEASUREMENT), has(&SIMULATION)) {
        (true, false) => Some(RecordKind::Measurement),
        (false, true) => Some(RecordKind::Simulation),
        _ => None,
    }
}

/// What differs between the paths is `{section}`, as whole words.
fn pattern(paths: &[String]) -> (String, Vec<String>) {
    let first: Vec<char> = paths[0].chars().collect();
    let all: Vec<Vec<char>> = paths.iter().map(|path| path.chars().collect()).collect();
    let shortest = all.iter().map(Vec::len).min().unwrap_or(0);
    let mut before =
        (0..shortest).take_while(|&at| all.iter().all(|path| path[at] == first[at])).count();
    let from_end = |path: &[char], at: usize| path[path.len() - 1 - at];
    let mut after = (0..shortest - before)
        .take_while(|&at| all.iter().all(|path| from_end(path, at) == from_end(&first, at)))
        .count();
    while before > 0 && first[before - 1].is_alphanumeric() {
        before -= 1;
    }
    while after > 0 && first[first.len() - after].is_alphanumeric() {
        after -= 1;
    }
    let text = |part: &[char]| part.iter().collect::<String>();
    let sections = all.iter().map(|path| text(&path[before..path.len() - after])).collect();
    (
        format!("{}{{section}}{}", text(&first[..before]), text(&first[first.len() - after..])),
        sections,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_the_section() {
        let of =
            |paths: &[&str]| pattern(&paths.iter().map(ToString::to_string).collect::<Vec<_>>());
        assert_eq!(
            of(&["raw/Messung_S01.csv", "raw/Messung_S06.csv"]),
            ("raw/Messung_{section}.csv".into(), vec!["S01".into(), "S06".into()])
        );
        assert_eq!(of(&["S1.dat", "S11.dat"]).1, ["S1", "S11"]);
        assert_eq!(
            of(&["a/x.csv", "b/x.csv"]),
            ("{section}/x.csv".into(), vec!["a".into(), "b".into()])
        );
        let from = |path: &str, folder: &str| from_folder(path, Path::new(folder));
        assert_eq!(from("raw/a.csv", ""), "raw/a.csv");
        assert_eq!(from("raw/a.csv", "raw"), "a.csv");
        assert_eq!(from("raw/a.csv", "target/x"), "../../raw/a.csv");
        assert_eq!(from("/raw/a.csv", "/raw/x"), "../a.csv");
        assert_eq!(side("raw/Messung_S01.csv"), Some(RecordKind::Measurement));
        assert_eq!((side("x/S01.csv"), side("sim/test.csv")), (None, None));
    }
}
