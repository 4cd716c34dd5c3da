//! Whether a fault is reported, with its section and channel.

use std::path::Path;

use fishplate::certify::{certify, compile};
use fishplate::check::{Overrides, family};
use fishplate::data::Campaign;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::result::{Certification, Finding, Verdict};
use fishplate::run::Settings;

use crate::faults::{Fault, Told};
use crate::folder::Folder;

/// Result of checking a campaign.
pub enum Outcome {
    Done(Box<Certification>),
    /// It was refused with these problems.
    Refused(Problems),
}

pub struct Score {
    pub fault: &'static str,
    pub told: bool,
    pub validated: bool,
    /// The first finding.
    pub says: String,
}

/// Certifies a folder with the default protocol.
pub fn certified(path: &Path) -> Outcome {
    let mut problems = Problems::default();
    let source = library::find(library::SHIPPED[0].name, None).expect("the default protocol");
    let family = family::read(&source, &library::parent, &mut problems);
    let compiled = compile(family, &Overrides::new(), &mut problems);
    let campaign = Campaign::open(path, &mut problems);
    let (Some(compiled), Some(campaign), false) = (compiled, campaign, problems.any_error()) else {
        return Outcome::Refused(problems);
    };
    match certify(&compiled, &campaign, Settings { traces: 0 }, &|_| {}) {
        Ok(found) => Outcome::Done(Box::new(found)),
        Err(problems) => Outcome::Refused(problems),
    }
}

/// Applies a fault to a copy of a campaign and checks the findings.
pub fn score(sound: &Folder, fault: &Fault) -> Score {
    let mut folder = sound.clone();
    let told = (fault.put)(&mut folder);
    let place = tempfile::tempdir().expect("a temporary folder");
    folder.write(place.path());
    match certified(place.path()) {
        Outcome::Refused(problems) => {
            let says = problems.0.first().map_or(String::new(), |problem| problem.says.clone());
            Score {
                fault: fault.name,
                told: true,
                validated: false,
                says: format!("refused: {says}"),
            }
        }
        Outcome::Done(found) => {
            let checks = found
                .sections
                .iter()
                .filter(|section| !section.used && told.sections.contains(&section.section));
            let checked = checks
                .filter_map(|section| Some(section.reason.as_ref()?.text().to_string()))
                .next()
                .filter(|_| told.channels.is_empty());
            let finding = found.findings.iter().find(|finding| names(finding, &told));
            let says = finding
                .map(|finding| format!("[{}] {}", finding.code, finding.first.text()))
                .or(checked);
            let validated = found.verdict == Verdict::Validated;
            Score {
                fault: fault.name,
                told: says.is_some(),
                validated,
                says: says.unwrap_or_default(),
            }
        }
    }
}

fn names(finding: &Finding, told: &Told) -> bool {
    finding.places().iter().any(|place| {
        let section = place.section.as_ref();
        let right_section = told.sections.is_empty()
            || section.is_some_and(|section| told.sections.contains(section));
        let channel = place.channel.as_deref().unwrap_or_default();
        let says = place.text().to_string();
        let right_channel = told.channels.is_empty()
            || told.channels.iter().any(|name| channel.contains(name) || says.contains(name));
        right_section && right_channel
    })
}
