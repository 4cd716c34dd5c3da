//! The shipped protocols and catalogues, their editions, and the search for them by name or path.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::disk;
use crate::hash::sha256;
use crate::problem::{Problem, problem};
use crate::source::Source;

/// The editions of released versions: name and SHA-256 in each line.
const EDITIONS: &str = include_str!("../protocols/editions.txt");

/// Maximum size of a protocol or catalogue in bytes: a hundred times the longest shipped one.
const LARGEST: u64 = 2 << 20;

/// A protocol shipped with the program.
#[derive(Debug)]
pub struct Shipped {
    pub name: &'static str,
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        &[$(Shipped { name: $name, text: include_str!(concat!("../protocols/", $name, ".fp")) }),*]
    };
}

/// In the order of the list; the first is the default of `certify`.
pub const SHIPPED: &[Shipped] = shipped![
    "en14363-2016-annex-t",
    "en14363-2016-annex-t-strict-acceleration",
    "en14363-2016-annex-t-six-sections",
    "en14363-2016-annex-t-population-deviation",
    "en14363-2016-annex-t-confidence",
    "en14363-next-edition",
    "en14363-on-track-assessment",
    "en14363-on-track-assessment-two-dimensional",
    "en14363-on-track-assessment-multiple-regression",
    "en14363-virtual-test",
    "en14363-virtual-against-measured",
    "uic518-2009-comparison",
    "gm-rt2141-comparison",
    "en14067-6-wheel-unloading",
    "en14067-6-flexibility",
    "en14363-2016-annex-t-application",
    "en14363-2016-annex-t-found-sections",
    "sprague-geers",
    "bogojevic-lucanin",
    "kraft",
    "metrics-side-by-side",
    "code-benchmark",
    "code-benchmark-reference",
    "stationary-sway",
    "en12299-mean-comfort",
    "cfr-213-333",
    "cfr-238-appendix-c",
    "cfr-238-appendix-c-stationary",
    "gbt5599",
    "aar-m1001-chapter-11",
    "iso2631-msdv",
    "iso18571-weighted-rating",
    "en-score",
    "tost-equivalence",
];

/// Shipped texts without quantities, whose rules protocols share.
pub const SHARED: &[Shipped] = shipped!["plausibility-signals"];

/// The shipped catalogues of effects; the first is the default.
pub const CATALOGUES: &[Shipped] =
    &[Shipped { name: "bogie-vehicle", text: include_str!("../effects/bogie-vehicle.yaml") }];

/// The shipped conventions: names of channels, and what is exchanged when a vehicle is turned.
pub const CONVENTIONS: &[Shipped] =
    &[Shipped { name: "bogie-vehicle", text: include_str!("../conventions/bogie-vehicle.yaml") }];

/// A catalogue of effects by path or shipped name.
///
/// # Errors
/// `no-such-catalogue`, `unreadable`, `not-utf8`.
pub fn find_catalogue(name: &str, beside: Option<&Path>) -> Result<Arc<Source>, Problem> {
    let shipped = CATALOGUES.iter().find(|shipped| shipped.name == name);
    let shipped = shipped.map(|shipped| Source::new(format!("effects/{name}.yaml"), shipped.text));
    file_or(name, beside, shipped, || {
        let known = CATALOGUES.iter().map(|shipped| shipped.name);
        problem!("no-such-catalogue", "there is no file and no shipped catalogue `{name}`")
            .suggest(name, known)
    })
}

/// The catalogue that another extends: a shipped name, or a path relative to its folder.
///
/// # Errors
/// As [`find_catalogue`].
pub fn parent_catalogue(name: &str, from: &Source) -> Result<Arc<Source>, Problem> {
    find_catalogue(name, Path::new(&from.name).parent())
}

/// The shipped protocols, and the texts whose rules they share.
pub fn texts() -> impl Iterator<Item = &'static Shipped> {
    SHIPPED.iter().chain(SHARED)
}

/// Names of the shipped protocols.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|shipped| shipped.name)
}

/// The text of a shipped protocol, or of one whose rules they share.
pub fn shipped(name: &str) -> Option<Arc<Source>> {
    let shipped = texts().find(|shipped| shipped.name == name)?;
    Some(Source::new(format!("protocols/{name}.fp"), shipped.text))
}

/// The edition, counted from 1, in which a text is or was shipped under a name.
pub fn edition(name: &str, text: &str) -> Option<usize> {
    let now = texts().find(|shipped| shipped.name == name)?;
    let own = sha256(text.as_bytes());
    let earlier: Vec<&str> = EDITIONS
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter_map(|(of, hash)| (of == name).then_some(hash))
        .collect();
    let known = earlier.iter().position(|hash| *hash == own);
    known.or((text == now.text).then_some(earlier.len())).map(|at| at + 1)
}

/// A protocol by shipped name, else by path.
///
/// # Errors
/// `no-such-protocol`, or `unreadable` with the system's error.
pub fn find(name: &str, beside: Option<&Path>) -> Result<Arc<Source>, Problem> {
    file_or(name, beside, shipped(name), || {
        problem!("no-such-protocol", "there is no file and no shipped protocol `{name}`")
            .suggest(name, names())
    })
}

/// The protocol named by `extends`: a shipped name, or a path relative to the folder of the text.
///
/// # Errors
/// As [`find`].
pub fn parent(name: &str, from: &Source) -> Result<Arc<Source>, Problem> {
    find(name, Path::new(&from.name).parent())
}

/// A shipped text, else that of a file.
fn file_or(
    name: &str,
    beside: Option<&Path>,
    shipped: Option<Arc<Source>>,
    missing: impl FnOnce() -> Problem,
) -> Result<Arc<Source>, Problem> {
    if let Some(shipped) = shipped {
        return Ok(shipped);
    }
    let path = beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    match disk::kind(&path).map_err(|error| unreadable(&path, &error))? {
        Some(disk::Kind::File(_) | disk::Kind::Other) => read(&path),
        _ => Err(missing()),
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Problem {
    problem!("unreadable", "{} cannot be read: {error}", path.display())
}

/// Reads a protocol file.
///
/// # Errors
/// `unreadable`, `not-utf8`.
pub fn read(path: &Path) -> Result<Arc<Source>, Problem> {
    let shown = path.display().to_string();
    let bytes = disk::read(path, LARGEST).map_err(|error| unreadable(path, &error))?;
    match std::str::from_utf8(&bytes) {
        Ok(text) => Ok(Source::new(shown, text)),
        Err(error) => {
            let at = error.valid_up_to();
            let row = bytes[..at].iter().filter(|byte| **byte == b'\n').count() + 1;
            Err(problem!("not-utf8", "{shown} is not UTF-8: byte {at}, in row {row}")
                .help("save it as UTF-8"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_has_an_edition_and_released_ones_keep_theirs() {
        for shipped in texts() {
            assert!(edition(shipped.name, shipped.text).is_some(), "{}", shipped.name);
            assert_eq!(edition(shipped.name, &format!("{} ", shipped.text)), None);
        }
        let lines = EDITIONS.lines().filter(|line| !line.starts_with('#'));
        for line in lines {
            let (name, hash) = line.split_once(' ').expect("name and hash");
            assert!(texts().any(|shipped| shipped.name == name), "{line}");
            assert!(hash.len() == 64 && hash.bytes().all(|digit| digit.is_ascii_hexdigit()));
        }
    }
}
