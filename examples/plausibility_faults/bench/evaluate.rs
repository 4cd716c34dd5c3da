//! Certifies a campaign: by this program or another one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::Certification;
use fishplate::run::Settings;

use super::answer::Answer;
use super::folder::Folder;

/// Result of checking a campaign.
pub enum Outcome {
    Done(Box<Certification>),
    /// It was refused with these problems.
    Refused(Problems),
}

/// What evaluates: this program, or another one through its command line.
pub enum Program {
    Own,
    Other(PathBuf),
}

/// Certifies a folder with the default protocol.
pub fn certified(path: &Path) -> Outcome {
    static COMPILED: OnceLock<Compiled> = OnceLock::new();
    with(COMPILED.get_or_init(|| default_protocol(|_| true)), path)
}

/// The default protocol with some kinds of blocks.
fn default_protocol(keep: impl Fn(&str) -> bool) -> Compiled {
    let mut problems = Problems::default();
    let source = library::shipped(library::SHIPPED[0].name).expect("the default protocol");
    let mut family = family::read(&source, &library::parent, &mut problems);
    family.merged.blocks.retain(|block| keep(&block.kind.text));
    compile(family, &Overrides::new(), &mut problems).expect("the default protocol")
}

fn with(compiled: &Compiled, path: &Path) -> Outcome {
    let mut problems = Problems::default();
    let campaign = Campaign::open(path, &mut problems);
    let (Some(campaign), false) = (campaign, problems.any_error()) else {
        return Outcome::Refused(problems);
    };
    match certify(compiled, &campaign, Settings { traces: 0 }, &|_| {}) {
        Ok(found) => Outcome::Done(Box::new(found)),
        Err(problems) => Outcome::Refused(problems),
    }
}

/// The evaluation of a folder.
pub fn answer(program: &Program, path: &Path) -> Answer {
    match program {
        Program::Own => own(certified(path)),
        Program::Other(program) => {
            let out = tempfile::tempdir().expect("a temporary folder");
            let run = Command::new(program)
                .arg("certify")
                .arg(path)
                .args(["--only", "results", "--plots", "0", "--color", "never", "--quiet", "--out"])
                .arg(out.path())
                .output()
                .expect("the program runs");
            match fs::read_to_string(out.path().join("results.json")) {
                Ok(text) => Answer::read(&serde_json::from_str(&text).expect("JSON")),
                Err(_) => Answer::refused(&String::from_utf8_lossy(&run.stderr)),
            }
        }
    }
}

/// The statistics of a folder as they are without any rule of plausibility; `None` if it is
/// refused.
pub fn shares(path: &Path) -> Option<Answer> {
    static COMPILED: OnceLock<Compiled> = OnceLock::new();
    let compiled = COMPILED.get_or_init(|| default_protocol(|kind| kind != "plausibility"));
    match with(compiled, path) {
        done @ Outcome::Done(_) => Some(own(done)),
        Outcome::Refused(_) => None,
    }
}

fn own(outcome: Outcome) -> Answer {
    match outcome {
        Outcome::Done(found) => Answer::read(&serde_json::to_value(&*found).expect("JSON")),
        Outcome::Refused(problems) => Answer::refused(&problems.render(false)),
    }
}

/// The evaluation of a changed campaign, in a folder beside the one it was read from.
pub fn evaluated<T>(folder: &Folder, evaluate: impl FnOnce(&Path) -> T) -> T {
    let beside = folder.path().parent().filter(|path| path.starts_with(std::env::temp_dir()));
    let place = match beside {
        Some(path) => tempfile::tempdir_in(path),
        None => tempfile::tempdir(),
    };
    let place = place.expect("a temporary folder");
    folder.write(place.path());
    evaluate(place.path())
}
