//! What fuzzing begins with: the cases of the tests, the examples and what is shipped.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, io};

use fishplate::catalog;
use fishplate::data::record::read_raw;
use fishplate::data::write;
use fishplate::problem::Problems;
use fishplate::source::Source;
use fishplate::syntax::keys::KINDS;
use fishplate::syntax::{self, is_yaml, print_yaml};

use super::campaign::{CAMPAIGN, SECTIONS, VEHICLE};
use super::language::PHRASES;

/// Longer inputs are left out: they only slow the fuzzer down.
const LONGEST: usize = 40_000;
/// Lines that are kept of a record.
const ROWS: usize = 12;

/// An input of a target.
pub type Seed = (&'static str, Vec<u8>);

/// All seeds, from the folder of the package.
pub fn seeds(root: &Path) -> Vec<Seed> {
    let mut files = Vec::new();
    for folder in
        ["protocols", "effects", "examples", "tests/cases", "tests/campaigns/foreign/data/small"]
    {
        walk(&root.join(folder), &mut files);
    }
    files.sort();
    let mut seeds = Vec::new();
    for path in files {
        let Ok(bytes) = fs::read(&path) else { continue };
        of_file(&path, bytes, &mut seeds);
    }
    seeds.push(("campaign", CAMPAIGN.into()));
    seeds.push(("vehicle", VEHICLE.into()));
    seeds.push(("sections", SECTIONS.into()));
    seeds.extend(DIALECTS.map(|text| ("foreign", text.into())));
    for text in HOSTILE {
        seeds.push(("escape", text.into()));
        seeds.push(("report", text.into()));
    }
    seeds.retain(|(_, bytes)| bytes.len() <= LONGEST);
    seeds
}

/// Texts of other systems in small.
const DIALECTS: [&str; 5] = [
    "t;y\ns;kN\n0;1,5\n0,5;-2\n",
    "# Channel 1: t [s]\n# Channel 2: y [kN]\n  0.0   1.5\n  0.5  -2.0\n",
    "* GENSYS\n* 1 t s\n* 2 y kN\n*\n 0.0D+00 1.5D+00\n 5.0D-01-2.0D+00\n",
    "Zeit;y\n13.05.2024 23:59:59,500;1\n14.05.2024 00:00:00,000;2\n",
    "\"time [s]\"\t\"Y (kN)\"\r\n0\t1.5\r\n0.5\t\r\n",
];

/// Texts that were trouble to others.
const HOSTILE: [&str; 8] = [
    "</p><script>alert('1')</script>",
    "\" onmouseover=\"alert(1)\" x='",
    "{{ data }}{% include 'x' %}",
    "#eval(\"1\") $x^2$ @ref <label> *bold* `raw`",
    "]]>&lt;&amp;&#x3c;<!-- -->",
    "a\u{202e}b\u{0}c\u{1b}[31md\u{feff}\u{2028}",
    "<svg onload=alert(1)>",
    "a very long name without end, over and over again, until no column can hold it any more",
];

fn walk(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            walk(&path, files);
        } else {
            files.push(path);
        }
    }
}

fn of_file(path: &Path, bytes: Vec<u8>, seeds: &mut Vec<Seed>) {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let inside = |folder: &str| path.components().any(|part| part.as_os_str() == folder);
    let shown = path.to_string_lossy().replace('\\', "/");
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("fp") => protocol(&name, bytes, seeds),
        Some("yaml") if name == "campaign.yaml" => seeds.push(("campaign", bytes)),
        Some("yaml") if name == "vehicle.yaml" => seeds.push(("vehicle", bytes)),
        Some("yaml") if name == "sim.yaml" || shown.contains("cases/simulator/") => {
            seeds.push(("simulator", bytes));
        }
        Some("yaml") if inside("effects") || name == "effects.yaml" => {
            seeds.push(("catalogue", bytes));
        }
        Some("yaml") if name == "mapping.yaml" || shown.contains("cases/import/") => {
            seeds.push(("mapping", bytes))
        }
        Some("yaml") if inside("protocols") || inside("syntax") || inside("check") => {
            protocol(&name, bytes, seeds);
        }
        Some("mf4") => seeds.push(("mdf4", bytes)),
        Some("mat") => seeds.push(("mat", bytes)),
        Some("xlsx") => seeds.push(("xlsx", bytes)),
        Some("tdms") => seeds.push(("tdms", bytes)),
        Some("parquet" | "feather" | "arrow") => seeds.push(("columnar", bytes)),
        Some("csv") if inside("messung") => seeds.push(("foreign", first_rows(bytes))),
        Some("csv") if inside("record") || inside("measurement") || inside("simulation") => {
            let rows = first_rows(bytes);
            seeds.extend(parquet(&rows).map(|bytes| ("parquet", bytes)));
            seeds.push(("record", rows));
        }
        Some("csv") => {
            let rows = first_rows(bytes);
            if name == "sections.csv" {
                seeds.push(("sections", rows.clone()));
            }
            seeds.push(("table", rows));
        }
        _ => {}
    }
}

/// The same record as a Parquet file, where it is one.
fn parquet(rows: &[u8]) -> Option<Vec<u8>> {
    let path = super::records::folder().join("seed.csv");
    super::records::write(&path, rows);
    write::parquet(&read_raw(&path, "seed.csv").ok()?).ok()
}

fn first_rows(bytes: Vec<u8>) -> Vec<u8> {
    let ends = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
    match ends.clone().nth(ROWS) {
        Some(end) => bytes[..end].to_vec(),
        None => bytes,
    }
}

/// A protocol in both forms, and each of its fields as a phrase.
fn protocol(name: &str, bytes: Vec<u8>, seeds: &mut Vec<Seed>) {
    if is_yaml(name) {
        return seeds.push(("protocol_yaml", bytes));
    }
    if let Ok(text) = std::str::from_utf8(&bytes) {
        let document = syntax::read(&Source::new(name, text), &mut Problems::default());
        seeds.push(("protocol_yaml", print_yaml(&document).into_bytes()));
        for field in document.blocks.iter().flat_map(|block| &block.fields) {
            let rule = match field.key.text.as_str() {
                "at" | "of" => 1,
                "members" | "one of" => 3,
                "alias" => 4,
                "axis" | "time" => 5,
                "range" => 6,
                "filter" | "step" => 7,
                "limit" => 9,
                "validated" => 10,
                _ => 0,
            };
            let text = field.value.text.as_bytes();
            if rule < PHRASES.len() && text.len() < 200 {
                seeds.push(("phrase", [&[rule as u8], text].concat()));
            }
        }
    }
    seeds.push(("check", bytes.clone()));
    seeds.push(("protocol_text", bytes));
}

/// Writes the seeds of a target below `corpus`, inputs that once failed among them, and
/// `TARGET.dict`: the words of the language for the fuzzer to put together. Each target has its
/// own, as several start at a time.
///
/// # Errors
/// A file cannot be written.
pub fn write(root: &Path, corpus: &Path, target: &str) -> io::Result<()> {
    let folder = corpus.join(target);
    fs::create_dir_all(&folder)?;
    if let Ok(failed) = fs::read_dir(root.join("tests/cases/fuzz").join(target)) {
        for path in failed.flatten().map(|entry| entry.path()) {
            fs::copy(&path, folder.join(path.file_name().unwrap_or_default()))?;
        }
    }
    let own = seeds(root).into_iter().filter(|(name, _)| *name == target);
    for (number, (_, bytes)) in own.enumerate() {
        fs::write(folder.join(format!("seed-{number:05}")), bytes)?;
    }
    let mut words: BTreeSet<&str> = WORDS.into();
    for kind in KINDS {
        words.insert(kind.word);
        words.extend(kind.keys.iter().map(|key| key.word));
    }
    words.extend(catalog::FUNCTIONS.iter().map(|function| function.name));
    let lines = words.into_iter().map(|word| format!("\"{}\"\n", word.escape_default()));
    fs::write(corpus.join(format!("{target}.dict")), lines.collect::<String>())
}

/// Words of phrases, of campaigns and of descriptions of simulators.
const WORDS: [&str; 48] = [
    "when",
    "otherwise",
    "and",
    "or",
    "not",
    "is",
    "larger of",
    "smaller of",
    "at least",
    "doubled when",
    "times",
    "only when",
    "for each zone",
    "of std",
    "p99.85",
    "rms",
    "median",
    "each",
    "mean",
    "std",
    "measured(",
    "simulated(",
    "kN",
    "m/s^2",
    "1/m",
    "%",
    "-",
    "zone",
    "radius",
    "direction",
    "right",
    "left",
    "straight",
    "|",
    "name: ",
    "vehicle: ",
    "sections: ",
    "parameters:",
    "measurement: ",
    "simulation: ",
    "command: ",
    "{set}",
    "{out}",
    "{name}",
    "{value}",
    "&a ",
    "*a",
    "<<: ",
];
