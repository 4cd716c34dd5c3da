//! The shipped protocols and catalogues, and the search for them by name or path.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::disk;
use crate::problem::{Problem, problem};
use crate::source::Source;

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
    let shipped = CATALOGUES.iter().any(|shipped| shipped.name == name);
    find_catalogue(name, if shipped { None } else { Path::new(&from.name).parent() })
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

/// A protocol by path, if such a file exists, else by shipped name.
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
    shipped(name).map_or_else(|| find(name, Path::new(&from.name).parent()), Ok)
}

/// The text of a file, if there is one or an object that cannot be read as one, else a shipped one.
fn file_or(
    name: &str,
    beside: Option<&Path>,
    shipped: Option<Arc<Source>>,
    missing: impl FnOnce() -> Problem,
) -> Result<Arc<Source>, Problem> {
    let path = beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name));
    match disk::kind(&path).map_err(|error| unreadable(&path, &error))? {
        Some(disk::Kind::File(_) | disk::Kind::Other) => read(&path),
        _ => shipped.ok_or_else(missing),
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
