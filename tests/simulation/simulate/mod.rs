//! `simulate` and effects, mostly through the command line: what is added, to what, and what is
//! said where it cannot be.
//!
//! The physics of the model is tested elsewhere; here stand effects, files, other simulators and
//! messages.

use crate::common::program;

mod campaign;
mod cases;
mod confined;
mod external;
mod formulas;
mod increments;
mod one;
mod operators;
mod shipped;
mod steps;

use std::fs;
use std::path::{Path, PathBuf};

use fishplate::data::CampaignPath;
use fishplate::data::record::RecordSource;
use fishplate::effects::Signals;
use fishplate::simulate::signals_of;
use program::{Ran, program, ran};
use tempfile::TempDir;

/// The sections of the small campaign: a straight, a left and two right-hand curves, one in each
/// zone.
const SECTIONS: [&str; 4] = ["S01", "S06", "S10", "S13"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn coach() -> PathBuf {
    root().join("examples/coach")
}

/// A folder with the campaign `small`: four sections of the example.
#[derive(Debug)]
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        for folder in ["measurement", "simulation", "track"] {
            fs::create_dir_all(place.path("small").join(folder)).expect("made");
            for section in SECTIONS {
                let inside = format!("{folder}/{section}.csv");
                fs::copy(coach().join(&inside), place.path("small").join(&inside)).expect("copied");
            }
        }
        for file in ["campaign.yaml", "vehicle.yaml", "profile.csv", "profile_worn.csv"] {
            fs::copy(coach().join(file), place.path("small").join(file)).expect("copied");
        }
        let table = fs::read_to_string(coach().join("sections.csv")).expect("readable");
        let kept = table.lines().filter(|line| {
            line.starts_with("section") || SECTIONS.iter().any(|name| line.starts_with(name))
        });
        place.write("small/sections.csv", &(kept.collect::<Vec<_>>().join("\n") + "\n"));
        place
    }

    fn path(&self, inside: &str) -> PathBuf {
        self.0.path().join(inside)
    }

    fn write(&self, inside: &str, text: &str) -> PathBuf {
        fs::write(self.path(inside), text).expect("written");
        self.path(inside)
    }

    fn text(&self, inside: &str) -> String {
        fs::read_to_string(self.path(inside)).unwrap_or_else(|error| panic!("{inside}: {error}"))
    }

    /// Replaces a text that must be there in a file.
    #[track_caller]
    fn replace(&self, inside: &str, old: &str, new: &str) {
        let text = self.text(inside);
        assert!(text.contains(old), "{old} is not in {inside}");
        self.write(inside, &text.replace(old, new));
    }

    /// `simulate small --out OUT` with more arguments; nothing may be left of a call that fails.
    #[track_caller]
    fn simulate(&self, out: &str, more: &[&str]) -> Ran {
        let ran = ran(program()
            .current_dir(self.0.path())
            .args(["simulate", "small", "--out", out])
            .args(more));
        assert_eq!(self.path(out).exists(), ran.code == 0, "{}", ran.stderr);
        ran
    }

    /// As [`Place::simulate`], which must be done.
    #[track_caller]
    fn simulated(&self, out: &str, more: &[&str]) -> Ran {
        let ran = self.simulate(out, more);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        ran
    }

    /// The simulated record of a section.
    #[track_caller]
    fn record(&self, out: &str, section: &str) -> Signals {
        signals(&self.path(&format!("{out}/simulation/{section}.csv")))
    }
}

#[track_caller]
fn signals(path: &Path) -> Signals {
    let place =
        CampaignPath { path: path.to_path_buf(), shown: "record".into(), inside: "record".into() };
    signals_of(&RecordSource::File(place))
        .unwrap_or_else(|problems| panic!("{}: {problems:?}", path.display()))
        .0
}

#[track_caller]
fn channel<'a>(signals: &'a Signals, name: &str) -> &'a [f64] {
    &signals.channel(name).unwrap_or_else(|| panic!("no {name}")).values
}

/// The largest difference of two channels.
#[track_caller]
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Half a digit of what records are written with, for forces in kN and accelerations in m/s^2, and
/// the rounding of the sum.
const FORCE: f64 = 0.0051;
const ACCELERATION: f64 = 0.000_051;
