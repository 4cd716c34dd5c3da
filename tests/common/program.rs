//! The program as a user calls it.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// What a call came to.
#[derive(Debug)]
pub struct Ran {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// The program, not yet called; colours follow the arguments alone.
pub fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_fishplate"));
    command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
    command
}

#[track_caller]
pub fn ran(command: &mut Command) -> Ran {
    let output = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("not ended by a signal");
    let ran = Ran { code, stdout: text(output.stdout), stderr: text(output.stderr) };
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
    ran
}

#[track_caller]
pub fn fishplate(arguments: &[&str]) -> Ran {
    ran(program().args(arguments))
}

/// A call of `certify` and what it left.
#[derive(Debug)]
pub struct Certified {
    pub ran: Ran,
    pub out: TempDir,
}

/// `certify` with an output folder that does not exist before.
#[track_caller]
pub fn certify(campaign: &Path, more: &[&str]) -> Certified {
    let out = tempfile::tempdir().expect("a temporary folder");
    let folder = out.path().join("new/report");
    let ran = ran(program().arg("certify").arg(campaign).arg("--out").arg(&folder).args(more));
    let found = Certified { ran, out };
    let left = files(found.out.path());
    let half = [".fishplate-new", ".fishplate-unfinished", ".tmp"].map(std::ffi::OsStr::new);
    let below = |path: &PathBuf| {
        path.strip_prefix(found.out.path()).map(Path::to_path_buf).unwrap_or_default()
    };
    let half_written = |path: &PathBuf| {
        below(path)
            .iter()
            .any(|part| half.contains(&part) || Path::new(part).extension() == Some("tmp".as_ref()))
    };
    assert!(!left.iter().any(half_written), "half-written files: {left:?}");
    if found.ran.code >= 2 {
        assert!(
            !found.out.path().join("new").exists(),
            "something was written: {left:?}\n{}",
            found.ran.stderr
        );
    } else {
        assert!(
            left.iter().any(|path| path.ends_with("results.json")),
            "nothing was written: {}",
            found.ran.stderr
        );
    }
    found
}

impl Certified {
    pub fn folder(&self) -> PathBuf {
        self.out.path().join("new/report")
    }

    pub fn text(&self, name: &str) -> String {
        let path = self.folder().join(name);
        std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}\n{}", path.display(), self.ran.stderr))
    }

    pub fn results(&self) -> Value {
        serde_json::from_str(&self.text("results.json")).expect("JSON")
    }

    /// Why a section is not used; `None` if it is.
    pub fn reason(&self, section: &str) -> Option<String> {
        let results = self.results();
        let sections = results["sections"].as_array().expect("a list");
        let found = sections
            .iter()
            .find(|entry| entry["section"] == section)
            .unwrap_or_else(|| panic!("no section {section}"));
        assert_eq!(found["used"].as_bool(), Some(found["reason"].is_null()), "{found}");
        found["reason"].as_str().map(str::to_string)
    }
}

/// All files below a folder, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}
