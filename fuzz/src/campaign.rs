//! A whole campaign from its folder to its result, with one of its files fuzzed.

use std::path::PathBuf;
use std::sync::LazyLock;

use fishplate::certify::{Compiled, certify, compile};
use fishplate::check::plan::SetBy;
use fishplate::check::{Override, Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::text;
use fishplate::result::{Certification, Verdict};
use fishplate::run::Settings;
use fishplate::source::Source;
use fishplate::syntax::document::Text;

use super::promise;
use super::records::{folder, write};

pub const CAMPAIGN: &str = "name: Fuzzed\nvehicle: vehicle.yaml\nsections: sections.csv\n\
    measurement: measurement\nsimulation: simulation\nline: Somewhere\n\
    report:\n  number: R1\n  customer: Somebody\nparameters:\n  share: 0.5\n";
pub const VEHICLE: &str =
    "name: Wagon\ncategory: passenger\nsuspension: true\nstatic_wheel_load: 50\n";
pub const SECTIONS: &str = "section,zone [-],start [m],end [m],radius [m],direction\nS1,1,1,9,700,right\nS2,2,1,9,500,left\n";

/// The three files in which a campaign says what it is.
const FILES: [(&str, &str); 3] =
    [("campaign.yaml", CAMPAIGN), ("vehicle.yaml", VEHICLE), ("sections.csv", SECTIONS)];

/// A record of 10 m: 50 samples, 100 a second.
fn samples(turned: f64) -> String {
    let mut text = "time [s],distance [m],Y_R [kN],Y_L [kN]\n".to_string();
    for row in 0..50_u32 {
        let at = f64::from(row);
        let wave = (at * 0.3 + turned).sin();
        let (y, z) = (8.0 + 2.0 * wave, -3.0 + wave);
        text += &format!("{:.2},{:.1},{y:.3},{z:.3}\n", at / 100.0, at / 5.0);
    }
    text
}

/// The folder of a sound campaign of this thread.
fn sound() -> PathBuf {
    thread_local! {
        static MADE: PathBuf = {
            let at = folder().join("campaign");
            for (kind, turned) in [("measurement", 0.0), ("simulation", 0.2)] {
                std::fs::create_dir_all(at.join(kind)).expect("a folder");
                for name in ["S1.csv", "S2.csv"] {
                    write(&at.join(kind).join(name), samples(turned).as_bytes());
                }
            }
            at
        };
    }
    MADE.with(Clone::clone)
}

/// A campaign with a file replaced by an input.
fn with(fuzzed: &str, input: &[u8]) -> PathBuf {
    let at = sound();
    for (name, text) in FILES {
        let bytes = if name == fuzzed { input } else { text.as_bytes() };
        write(&at.join(name), bytes);
    }
    at
}

/// `campaign.yaml`: whatever it says, the run ends with a result or with errors.
pub fn campaign(input: &[u8]) {
    runs("campaign.yaml", input);
}

/// `vehicle.yaml`: whatever it says, the run ends with a result or with errors.
pub fn vehicle(input: &[u8]) {
    runs("vehicle.yaml", input);
}

/// `sections.csv`: whatever it says, the run ends with a result or with errors.
pub fn sections(input: &[u8]) {
    runs("sections.csv", input);
}

fn runs(fuzzed: &str, input: &[u8]) {
    let folder = with(fuzzed, input);
    let mut problems = Problems::default();
    let opened = Campaign::open(&folder, &mut problems);
    promise::told(&problems.0);
    let Some(campaign) = opened else { return assert!(problems.any_error(), "no word") };
    let mut overrides = Overrides::new();
    for parameter in &campaign.parameters {
        let value = &parameter.value;
        let text = Text { text: value.raw.clone(), span: value.span.clone(), exact: value.exact };
        let set = Override { text, set_by: SetBy::Campaign };
        overrides.insert(parameter.name.text.clone(), set);
    }
    let compiled = compiled(&overrides, &mut problems);
    promise::told(&problems.0);
    let Some(compiled) = compiled else { return assert!(problems.any_error(), "no word") };
    match certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {}) {
        Err(problems) => {
            assert!(problems.any_error(), "no word");
            promise::told(&problems.0);
        }
        Ok(found) => sensible(&found),
    }
}

/// The small protocol with parameters of a campaign.
pub fn compiled(overrides: &Overrides, problems: &mut Problems) -> Option<Compiled> {
    let source = Source::new("small.fp", include_str!("small.fp"));
    let family = family::read(&source, &library::parent, problems);
    compile(family, overrides, problems)
}

/// No number is NaN or infinite, "validated" stands only where every statistic holds, and the
/// result can be read back.
#[track_caller]
fn sensible(found: &Certification) {
    let mut all = true;
    for quantity in &found.quantities {
        for pair in &quantity.values {
            let sides = [pair.simulated, pair.measured, Some(pair.difference)];
            assert!(sides.into_iter().flatten().all(f64::is_finite), "{}", quantity.id);
        }
        for statistic in &quantity.statistics {
            let numbers = [statistic.value, statistic.limit, statistic.normalised];
            assert!(numbers.into_iter().flatten().all(f64::is_finite), "{}", quantity.id);
            assert!(statistic.value.is_some() || statistic.holds.is_none());
            all &= statistic.holds == Some(true);
        }
    }
    if found.verdict == Verdict::Validated {
        assert!(all && !found.quantities.is_empty(), "validated without reason");
    } else {
        assert!(!found.reasons.is_empty(), "no reason for the verdict");
    }
    let text = text(found);
    assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "{text}");
}

/// The result of the sound campaign.
pub fn certified() -> Certification {
    static FOUND: LazyLock<Certification> = LazyLock::new(|| {
        let mut problems = Problems::default();
        let campaign = Campaign::open(&with("", b""), &mut problems);
        let compiled = compiled(&Overrides::new(), &mut problems);
        let (Some(campaign), Some(compiled)) = (campaign, compiled) else {
            panic!("{}", problems.render(false))
        };
        certify(&compiled, &campaign, Settings { traces: 1 }, &|_| {})
            .unwrap_or_else(|problems| panic!("{}", problems.render(false)))
    });
    FOUND.clone()
}
