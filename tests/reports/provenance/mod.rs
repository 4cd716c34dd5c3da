//! Reports that are checked, traced and signed: what agrees, what every change shows, what hostile
//! files do.

use crate::common::campaign;
use crate::common::program;

mod archive;
mod forged;
mod hostile;
mod sign;
mod statement;
mod trace;
mod verify;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use program::{Ran, fishplate};
use tempfile::TempDir;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn example(name: &str) -> PathBuf {
    root().join("examples").join(name)
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// A protocol of two files that have the same name, with a parameter set in the campaign and
/// another on the command line, over a copy of an example; the report of all that, written once.
struct Written {
    folder: TempDir,
}

impl Written {
    fn campaign(&self) -> PathBuf {
        self.folder.path().join("campaign")
    }

    fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn pdf(&self) -> PathBuf {
        self.out().join("report.pdf")
    }

    fn results(&self) -> PathBuf {
        self.out().join("results.json")
    }
}

fn written() -> &'static Written {
    static WRITTEN: OnceLock<Written> = OnceLock::new();
    WRITTEN.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let copied = campaign::copy(&example("coach"));
        std::fs::rename(copied.path(), folder.path().join("campaign")).expect("moved");
        let written = Written { folder };
        let campaign = written.campaign();
        std::fs::create_dir_all(campaign.join("rules/base")).expect("made");
        let base = "protocol base \"A base\"\n  extends  en14363-2016-annex-t\n\nquantity Y_max\n  limit  std 8 kN\n";
        let own = "protocol own \"Ours\"\n  extends  base/p.fp\n\nquantity Q_max\n  limit  std 12 kN\n";
        std::fs::write(campaign.join("rules/base/p.fp"), base).expect("written");
        std::fs::write(campaign.join("rules/p.fp"), own).expect("written");
        let file = campaign.join("campaign.yaml");
        let before = std::fs::read_to_string(&file).expect("readable");
        let more = "protocol: rules/p.fp\nparameters:\n  lowpass_frequency: 19.5 Hz\n";
        std::fs::write(&file, format!("{before}\n{more}")).expect("written");
        let ran = fishplate(&["certify", &text(&campaign), "--out", &text(&written.out()), "--set", "percentile_rule=hazen", "-q"]);
        assert!(ran.code <= 1, "{}", ran.stderr);
        written
    })
}

/// The line of a check and those of its details.
#[track_caller]
fn check<'a>(ran: &'a Ran, name: &str) -> &'a str {
    let found = ran
        .stdout
        .lines()
        .find(|line| line.get(13..).is_some_and(|rest| rest.starts_with(&format!("{name} "))));
    found.unwrap_or_else(|| panic!("no check `{name}`:\n{}{}", ran.stdout, ran.stderr))
}
