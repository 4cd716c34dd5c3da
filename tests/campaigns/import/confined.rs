//! A mapping names files inside its folder only, unless the user allows others; no message prints
//! a line of a file that is not what the mapping takes it for.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::program::{Ran, program, ran};

/// A word that stands in files outside the folder, and must not be printed.
const SECRET: &str = "hunter2";

struct Case {
    temp: tempfile::TempDir,
}

impl Case {
    /// The shipped example in `in`, and beside it what it must not see.
    fn new() -> Self {
        let temp = tempfile::tempdir().expect("a folder");
        for folder in ["", "messung", "simulation"] {
            let from = Path::new("examples/foreign").join(folder);
            let to = temp.path().join("in").join(folder);
            fs::create_dir_all(&to).expect("made");
            for entry in fs::read_dir(from).expect("a folder") {
                let entry = entry.expect("an entry");
                if entry.path().is_file() {
                    fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
                }
            }
        }
        for name in ["secret", "secret.csv", "S12.csv"] {
            let text = format!("{SECRET}:x:0:0,more\nroot:{SECRET}:1,more\n");
            fs::write(temp.path().join(name), text).expect("written");
        }
        Self { temp }
    }

    fn at(&self, path: &str) -> PathBuf {
        self.temp.path().join(path)
    }

    /// Imports the mapping with a change, and gives what the program printed.
    fn import(&self, change: &dyn Fn(&str) -> String, more: &[&str]) -> (Ran, String) {
        let text = fs::read_to_string("examples/foreign/mapping.yaml").expect("the mapping");
        fs::write(self.at("in/mapping.yaml"), change(&text)).expect("written");
        let _ = fs::remove_dir_all(self.at("out"));
        let mut words = vec!["import", "in/mapping.yaml", "--out", "out"];
        words.extend(more);
        let ran = ran(program().current_dir(self.temp.path()).args(words));
        let told = format!("{}{}", ran.stdout, ran.stderr);
        (ran, told)
    }
}

/// The mapping with another line in place of the one that begins with a key.
fn with(key: &str, line: &str) -> impl Fn(&str) -> String + use<> {
    let (key, line) = (key.to_string(), line.to_string());
    move |text| {
        let has = text.lines().any(|old| old.starts_with(&key));
        let more = if has { "" } else { &line };
        let new = |old: &str| if old.starts_with(&key) { line.clone() } else { old.to_string() };
        text.lines().map(new).chain([more.to_string()]).map(|line| line + "\n").collect()
    }
}

#[test]
fn no_key_of_a_mapping_leads_out_of_its_folder() {
    let case = Case::new();
    let absolute = case.at("secret").display().to_string();
    std::os::unix::fs::symlink(case.at("secret"), case.at("in/link")).expect("linked");
    std::os::unix::fs::symlink(case.temp.path(), case.at("in/up")).expect("linked");
    let outside = ["../secret", "up/secret", "link", "x/../../secret", &absolute];
    for key in ["copy", "vehicle", "sections", "protocol", "turning"] {
        for path in outside {
            let (output, told) =
                case.import(&with(&format!("{key}:"), &format!("{key}: {path}")), &[]);
            assert_eq!(output.code, 2, "{key}: {path}: {told}");
            assert!(told.contains("error[path-outside]"), "{key}: {path}: {told}");
            assert!(told.contains("--allow-outside"), "{told}");
            assert!(!told.contains(SECRET), "{key}: {path}: {told}");
            assert!(!case.at("out").exists());
        }
    }
    for (key, path) in [
        ("track:", "track: .."),
        ("track:", "track: ../{section}.csv"),
        ("track:", "track: up/{section}.csv"),
        ("  files: messung", "  files: ../{section}.csv"),
        ("  files: messung", "  files: up/{section}.csv"),
    ] {
        let (output, told) = case.import(&with(key, path), &[]);
        assert_eq!(output.code, 2, "{path}: {told}");
        assert!(told.contains("error[path-outside]") && !told.contains(SECRET), "{told}");
    }
    // A cell of the table of sections becomes a part of a path.
    let table = fs::read_to_string(case.at("in/sections.csv")).expect("a table");
    let mut lines = table.lines();
    let mut changed = format!("{},folder\n", lines.next().expect("a header"));
    lines.for_each(|line| changed += &format!("{line},../..\n"));
    fs::write(case.at("in/sections.csv"), changed).expect("written");
    let files = "  files: messung/{folder}/Messung_{section}.csv";
    let (_, told) = case.import(&with("  files: messung", files), &[]);
    assert!(told.contains("error[path-outside]"), "{told}");
}

#[test]
fn what_a_protocol_of_the_mapping_extends_is_inside_too() {
    let case = Case::new();
    let own = "protocol own \"Own\"\n  extends \"../secret\"\n  edition \"1\"\n";
    fs::write(case.at("in/own.fp"), own).expect("written");
    let (output, told) = case.import(&with("protocol:", "protocol: own.fp"), &[]);
    assert_eq!(output.code, 2, "{told}");
    assert!(told.contains("error[path-outside]") && !told.contains(SECRET), "{told}");
}

#[test]
fn other_files_are_taken_if_the_user_allows_it_and_their_lines_are_not_printed() {
    let case = Case::new();
    fs::copy(case.at("in/vehicle.yaml"), case.at("vehicle.yaml")).expect("copied");
    let vehicle = with("vehicle:", "vehicle: ../vehicle.yaml");
    assert_eq!(case.import(&vehicle, &[]).0.code, 2);
    let (output, told) = case.import(&vehicle, &["--allow-outside"]);
    assert_eq!(output.code, 0, "{told}");
    assert!(case.at("out/vehicle.yaml").exists());
    for key in ["vehicle", "sections", "protocol", "turning"] {
        let change = with(&format!("{key}:"), &format!("{key}: ../secret"));
        let (output, told) = case.import(&change, &["--allow-outside"]);
        assert_eq!(output.code, 2, "{key}: {told}");
        assert!(told.contains("secret:") && !told.contains(SECRET), "{key}: {told}");
    }
}

#[test]
fn a_draft_says_when_its_files_lie_outside() {
    let case = Case::new();
    let draft = |out: &str| {
        let file = "in/simulation/S13.parquet";
        let words = ["import", "--draft", file, "--out", out];
        let done = ran(program().current_dir(case.temp.path()).args(words));
        assert_eq!(done.code, 0, "{}", done.stderr);
        fs::read_to_string(case.at(out)).expect("a draft").contains("--allow-outside")
    };
    assert!(draft("in/messung/draft.yaml"));
    assert!(!draft("in/draft.yaml"));
}
