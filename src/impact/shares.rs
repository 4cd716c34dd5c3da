//! Shares of campaigns whose verdict holds, by words that a campaign has as a whole.

use indexmap::IndexMap;

use crate::check::plan::{Datum, DatumKind, Plan, Scalar};
use crate::result::{Reason, impact::Share};
use crate::run::Evaluated;

/// All campaigns as a group.
const ALL: &str = "all";

/// A datum of words, and the word of the campaign.
pub type Groups = Vec<(String, String)>;

/// The groups of a campaign: by each vehicle datum and each section datum for which the protocol
/// declares words, where all its vehicles, or all its sections, have the same one.
pub fn groups(plan: &Plan, evaluated: &Evaluated) -> Groups {
    let vehicles = |at: usize| evaluated.facts.vehicles.iter().map(|of| &of.data[at]).collect();
    let sections = |at: usize| evaluated.units.iter().map(|unit| &unit.columns[at]).collect();
    let of_vehicle = plan.vehicle.iter().enumerate().map(|(at, of)| common(of, vehicles(at)));
    let of_sections = plan.columns.iter().enumerate().map(|(at, of)| common(of, sections(at)));
    of_vehicle.chain(of_sections).flatten().collect()
}

fn common(datum: &Datum, all: Vec<&Result<Scalar, Reason>>) -> Option<(String, String)> {
    let words = matches!(datum.kind, DatumKind::Words(_));
    let [Ok(Scalar::Word(word)), others @ ..] = all.as_slice() else { return None };
    let same =
        |other: &&Result<Scalar, Reason>| matches!(other, Ok(Scalar::Word(own)) if own == word);
    (words && others.iter().all(same)).then(|| (datum.name.clone(), word.clone()))
}

/// Shares by group, of campaigns with their groups and whether the old and the new verdict hold.
pub fn shares<'a>(cases: impl Iterator<Item = (&'a Groups, [bool; 2])>) -> Vec<Share> {
    let mut found: IndexMap<(&str, &str), Vec<[bool; 2]>> = IndexMap::new();
    for (groups, holds) in cases {
        let own = groups.iter().map(|(by, group)| (by.as_str(), group.as_str()));
        for group in std::iter::once((ALL, ALL)).chain(own) {
            found.entry(group).or_default().push(holds);
        }
    }
    let share = |((by, group), holds): ((&str, &str), Vec<[bool; 2]>)| {
        let of = |which: usize| {
            holds.iter().filter(|holds| holds[which]).count() as f64 / holds.len() as f64
        };
        Share {
            by: by.into(),
            group: group.into(),
            campaigns: holds.len(),
            before: of(0),
            after: of(1),
        }
    };
    let mut all: Vec<Share> = found.into_iter().map(share).collect();
    // Groups of the same datum side by side, in the order of their words.
    let order: Vec<String> = all.iter().map(|share| share.by.clone()).collect();
    let place = |by: &String| order.iter().position(|known| known == by);
    all.sort_by(|a, b| (place(&a.by), &a.group).cmp(&(place(&b.by), &b.group)));
    all
}
