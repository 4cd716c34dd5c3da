//! Journal of a set of files: written before the commit point, and read by the next run if a run
//! was interrupted after it.

use std::{
    io,
    path::{Component, Path},
};

/// Name of the journal next to the files that are not in their places yet.
pub const JOURNAL: &str = "journal";
/// First line: the format version.
const HEAD: &str = "fishplate set 1";

/// The files that a set installs in its folder and removes from it. Paths are relative, without
/// links, with `/`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Journal {
    /// In the order of their numbers, which are the names of the files until they are in place.
    pub installs: Vec<String>,
    pub removes: Vec<String>,
}

impl Journal {
    pub fn text(&self) -> String {
        let lines = |what: &str, paths: &[String]| {
            paths.iter().map(|path| format!("{what} {path}\n")).collect::<String>()
        };
        format!("{HEAD}\n{}{}end\n", lines("put", &self.installs), lines("remove", &self.removes))
    }

    pub fn read(text: &str) -> io::Result<Self> {
        let wrong = || io::Error::new(io::ErrorKind::InvalidData, "its journal cannot be read");
        let mut journal = Self::default();
        let mut lines = text.lines();
        if lines.next() != Some(HEAD) {
            return Err(wrong());
        }
        for line in lines {
            match line.split_once(' ') {
                Some(("put", path)) if plain(path) => journal.installs.push(path.to_string()),
                Some(("remove", path)) if plain(path) => journal.removes.push(path.to_string()),
                None if line == "end" => return Ok(journal),
                _ => break,
            }
        }
        Err(wrong())
    }
}

/// Whether a path stays inside the folder, and fits a line.
pub fn plain(path: &str) -> bool {
    let parts = Path::new(path).components();
    !path.is_empty()
        && !path.contains(['\n', '\r', '\0'])
        && parts.into_iter().all(|part| matches!(part, Component::Normal(_)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_less() {
        let journal =
            Journal { installs: vec!["a b.csv".into(), "t/x".into()], removes: vec!["old".into()] };
        let text = journal.text();
        assert_eq!(Journal::read(&text).ok(), Some(journal));
        for cut in 0..text.len() - 1 {
            assert!(Journal::read(&text[..cut]).is_err(), "{}", &text[..cut]);
        }
        assert!(Journal::read(&text.replace("put t/x", "put ../x")).is_err());
        assert!(Journal::read(&text.replace("set 1", "set 2")).is_err());
    }
}
