//! Whether what is told of a campaign is what is wrong with it.

use super::answer::{Answer, Found, Place};
use super::fault::Told;

/// How a fault was told.
#[derive(Clone, Debug)]
pub struct Score {
    pub told: bool,
    /// What comes first names the right cause.
    pub first: bool,
    pub verdict: String,
    /// Code and place of what names the fault; empty if nothing does.
    pub naming: String,
    /// Codes and places of the first findings, in their order.
    pub says: String,
}

impl Score {
    pub fn validated(&self) -> bool {
        self.verdict == "validated"
    }
}

/// Number of findings that are listed.
const LISTED: usize = 3;

/// Whether an evaluation tells what is wrong, beside what it tells of the sound campaign.
///
/// The cause is right if the first finding that the sound campaign does not have is of a rule whose
/// cause, up to its first semicolon, is the fault: `right` are these rules, as the protocols name
/// them, and codes of the program for what is wrong with files. A guess that the program puts
/// before the cause of the rule, as a unit, is not right.
pub fn score(answer: &Answer, sound: &Answer, told: &Told, right: &[&str]) -> Score {
    let new = answer.beyond(sound);
    let place = |found: &Found| {
        let place = found.places.iter().find(|place| names(place, told))?;
        Some(line(found, place))
    };
    let naming = new.iter().find_map(place);
    let right_first =
        new.first().is_some_and(|found| !found.guessed && right.contains(&found.code.as_str()));
    let all: Vec<String> =
        new.iter().take(LISTED).map(|found| line(found, &found.places[0])).collect();
    Score {
        told: naming.is_some(),
        first: naming.is_some() && right_first,
        verdict: answer.verdict.clone(),
        naming: naming.unwrap_or_default(),
        says: all.join("; "),
    }
}

/// Whether a place is of the sections and of the channels concerned.
fn names(place: &Place, told: &Told) -> bool {
    let section = told.sections.is_empty() || told.sections.iter().any(|name| place.has(name));
    let channel = told.channels.is_empty() || told.channels.iter().any(|name| place.has_name(name));
    section && channel
}

fn line(found: &Found, place: &Place) -> String {
    let guessed = if found.guessed { ", a guess first" } else { "" };
    let at: Vec<&str> = [&place.section, &place.record, &place.channel]
        .into_iter()
        .map(String::as_str)
        .filter(|part| !part.is_empty())
        .collect();
    format!("[{}{guessed}] {} ({} places)", found.code, at.join(" "), found.places.len())
}

/// What is told wrongly of a sound campaign: every finding, unless it is of the wind that blows.
pub fn wrongly(answer: &Answer, wind: bool) -> Vec<String> {
    let is_wind = |found: &&Found| wind && WIND.contains(&found.code.as_str()) && !found.guessed;
    let says = |found: &Found| {
        let place = &found.places[0];
        format!("{}: {}", line(found, place), place.says)
    };
    let wrong: Vec<&Found> = answer.findings.iter().filter(|found| !is_wind(found)).collect();
    wrong.into_iter().map(says).collect()
}

/// Rules whose cause, up to its first semicolon, is wind.
const WIND: [&str; 1] = ["wind"];
