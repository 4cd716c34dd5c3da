//! The import: what a mapping does to records, and how its faults are told.
//!
//! `tests/cases/import/bad` holds mappings with a fault each, and the expected text beside them
//! (`.out`); `UPDATE_EXPECT=1` rewrites it. Numbers are compared with closed forms.

mod confined;
mod early;
mod example;
mod exports;
mod memory;
mod origin;
mod process;
mod runs;
mod times;

use std::fs;
use std::path::{Path, PathBuf};

use fishplate::data::record::Format;
use fishplate::data::write::Outputs;
use fishplate::disk::SetKind;
use fishplate::import::import;
use fishplate::import::mapping::{self, Paths};
use fishplate::prepare::for_import;
use fishplate::problem::Problems;
use fishplate::run::needs::needs;
use fishplate::source::Source;

/// Relative, so that messages are the same on every machine; tests run in the folder of the
/// package.
const CASES: &str = "tests/cases/import";

/// Imports a mapping into a folder: its problems, and whether there is an error among them.
pub fn imported(text: &str, name: &str, folder: &Path, out: &Path) -> (Problems, bool) {
    let mut problems = Problems::default();
    let paths = Paths::allowed(folder, true).expect("a folder");
    let found = mapping::read(&Source::new(name, text), paths, &mut problems);
    let Some(mapping) = found else { return (problems, false) };
    let Some(compiled) = for_import(&mapping, &mut problems) else { return (problems, false) };
    let needs = compiled.map(|compiled| needs(&compiled.plan, &compiled.graph));
    let mut outputs = Outputs::of(SetKind::Campaign, out).for_this_run();
    match import(&mapping, needs.as_ref(), Format::Csv, &mut outputs, &|_| {}) {
        Ok(warnings) => {
            warnings.0.into_iter().for_each(|warning| problems.push(warning));
            outputs.commit().expect("written");
            (problems, true)
        }
        Err(found) => {
            found.0.into_iter().for_each(|problem| problems.push(problem));
            (problems, false)
        }
    }
}

#[test]
fn faults_are_told_with_their_places() {
    let update = std::env::var_os("UPDATE_EXPECT").is_some();
    let mut cases: Vec<PathBuf> = fs::read_dir(Path::new(CASES).join("bad"))
        .expect("cases")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    cases.retain(|path| path.extension().is_some_and(|ending| ending == "yaml"));
    cases.sort();
    assert!(cases.len() > 20, "{} cases", cases.len());
    let mut wrong = Vec::new();
    for case in &cases {
        let name = case.file_name().expect("a name").to_string_lossy().into_owned();
        let out = tempfile::tempdir().expect("a folder");
        let (problems, done) = imported(
            &fs::read_to_string(case).expect("readable"),
            &name,
            Path::new(CASES),
            &out.path().join("c"),
        );
        assert!(!done && problems.any_error(), "{name} has no fault");
        assert!(
            problems
                .0
                .iter()
                .all(|problem| problem.at.is_some() || problem.code == "more-problems"),
            "{name}: {}",
            problems.render(false)
        );
        // Nothing is left of an import that failed.
        assert!(!out.path().join("c").exists(), "{name}");
        let (found, expected) = (problems.render(false), case.with_extension("out"));
        if update {
            fs::write(&expected, &found).expect("writable");
        } else if fs::read_to_string(&expected).unwrap_or_default() != found {
            wrong.push(format!("{name}:\n{found}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_prefix_of_a_mapping_is_survived() {
    let text = fs::read_to_string(Path::new(CASES).join("good.yaml")).expect("readable");
    let paths = Paths::inside(Path::new(CASES)).expect("a folder");
    for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
        let mut problems = Problems::default();
        let found = mapping::read(&Source::new("m", &text[..end]), paths.clone(), &mut problems);
        assert_eq!(found.is_none(), problems.any_error(), "{end}");
        problems.render(false);
    }
}
