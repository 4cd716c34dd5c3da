//! Faults of catalogues and of descriptions of simulators: each case lies beside the message that
//! it gives.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use fishplate::effects;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::simulate::{model_parameters, read_program};
use fishplate::source::Source;

use super::root;

/// Compares the problems of every case in a folder with the text beside it, and gathers their
/// codes.
fn cases(
    folder: &str,
    read: impl Fn(&Arc<Source>, &Path, &mut Problems),
) -> BTreeSet<&'static str> {
    let folder = root().join("tests/cases").join(folder);
    let mut codes = BTreeSet::new();
    let mut paths: Vec<_> = fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    paths.sort();
    for path in paths {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let source = Source::new(name.as_str(), fs::read_to_string(&path).expect("readable"));
        let mut problems = Problems::default();
        read(&source, &folder, &mut problems);
        assert!(problems.any_error(), "{name} has no error");
        for problem in &problems.0 {
            assert!(problem.at.is_some(), "{name}: {} has no place", problem.code);
            codes.insert(problem.code);
        }
        let (found, beside) = (problems.render(false), path.with_extension("out"));
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            fs::write(&beside, found).expect("written");
        } else {
            assert_eq!(found, fs::read_to_string(&beside).unwrap_or_default(), "{name}");
        }
    }
    codes
}

/// Codes that stand in a source file as `"code"` after the word `error(` or as the first argument
/// of `fault` and `refuse`.
fn codes_in(file: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(root().join(file)).expect("a source");
    let calls = ["error(", "fault(", "refuse("];
    let after = calls.iter().flat_map(|call| text.split(call).skip(1));
    let quoted = after.filter_map(|rest| {
        rest.trim_start().strip_prefix('"')?.split('"').next().map(str::to_string)
    });
    quoted.collect()
}

#[test]
fn catalogues() {
    let find = |name: &str, from: &Source| {
        if name == from.name {
            Ok(Source::new(name, from.text.clone()))
        } else {
            library::parent_catalogue(name, from)
        }
    };
    let codes = cases("effects", |source, _, problems| {
        effects::read(source, &find, &model_parameters(), problems);
    });
    for file in ["src/effects/read.rs", "src/effects/formulas.rs", "src/effects/expression.rs"] {
        for code in codes_in(file) {
            assert!(codes.contains(code.as_str()), "{file}: no case has `{code}`");
        }
    }
}

#[test]
fn simulators() {
    let codes = cases("simulator", |source, folder, problems| {
        read_program(source, folder, problems);
    });
    for file in ["src/simulate/external/read.rs", "src/simulate/external/words.rs"] {
        for code in codes_in(file) {
            assert!(codes.contains(code.as_str()), "{file}: no case has `{code}`");
        }
    }
}

/// However a text is cut, it gives problems or is right, and never a panic.
#[test]
fn cut_anywhere() {
    let catalogue = library::CATALOGUES[0].text;
    let formulas = fs::read_to_string(root().join("tests/cases/effects/formula-units.yaml"))
        .expect("readable");
    let simulator = "simulator: s\ncommand: [echo, '{set}', '{out}']\nset: ['{name}']\ntimeout: 5 s\nenvironment: {A: b}\n";
    let step = |text: &str| (text.len() / 120).max(1);
    for text in [catalogue, &formulas] {
        for at in (0..text.len()).step_by(step(text)).filter(|at| text.is_char_boundary(*at)) {
            effects::read(
                &Source::new("cut", &text[..at]),
                &library::parent_catalogue,
                &model_parameters(),
                &mut Problems::default(),
            );
        }
    }
    for at in 0..simulator.len() {
        read_program(
            &Source::new("cut", &simulator[..at]),
            Path::new("."),
            &mut Problems::default(),
        );
    }
}
