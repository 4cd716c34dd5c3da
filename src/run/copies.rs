//! Finds signals that are copies: of another channel, of another section, of the other side.

use std::collections::BTreeMap;

use rayon::slice::ParallelSliceMut;
use serde::{Deserialize, Serialize};

use super::plausibility::consequence;
use super::section::SectionValues;
use super::sections::Unit;
use crate::check::plan::{Distinct, Plan, Plausibility, Test};
use crate::data::{RecordKind, WhichRecord};
use crate::result::Finding;

/// Number of consecutive samples of a mark. Two independent signals with a resolution of a thousandth of their range agree in eight
/// consecutive samples by chance at one of 10^21 places.
const RUN: usize = 8;
/// One run of samples in this many becomes a mark. It is chosen by its content, so that the same runs are chosen wherever they are
/// in a record.
const ONE_IN: u64 = 16;
/// Two signals are copies if they share at least this part of the marks of the shorter one ...
const SHARED: f64 = 0.3;
/// ... and at least this many marks, which is about 100 samples.
const LEAST: usize = 6;
/// Largest number of channels that a finding names; the others are counted.
const NAMED: usize = 4;

/// Marks of one signal in one section.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Print {
    rule: String,
    channel: String,
    which: WhichRecord,
    /// The record in words: `measurement run1`.
    record: String,
    /// Sorted, without duplicates. A file of values has them in binary form.
    #[serde(skip)]
    pub marks: Vec<u64>,
}

impl Print {
    pub fn of(rule: &str, channel: &str, (which, record): (WhichRecord, String), samples: &[f64]) -> Self {
        let mut marks = marks(samples);
        marks.sort_unstable();
        marks.dedup();
        Self { rule: rule.to_string(), channel: channel.to_string(), which, record, marks }
    }
}

/// Marks of a signal: rolling hashes of runs of samples. Constant runs are equal everywhere and give no mark; another rule reports
/// them.
fn marks(samples: &[f64]) -> Vec<u64> {
    const BASE: u64 = 0x9E37_79B9_7F4A_7C15;
    let leaving = (1..RUN).fold(1_u64, |power, _| power.wrapping_mul(BASE));
    let hashes: Vec<u64> = samples.iter().map(|value| mixed(value.to_bits())).collect();
    let mut rolled = 0_u64;
    let mut unchanged = 0;
    let mut found = Vec::new();
    for (at, hash) in hashes.iter().enumerate() {
        if at >= RUN {
            rolled = rolled.wrapping_sub(hashes[at - RUN].wrapping_mul(leaving));
        }
        rolled = rolled.wrapping_mul(BASE).wrapping_add(*hash);
        unchanged = if at > 0 && samples[at] == samples[at - 1] { unchanged + 1 } else { 0 };
        if at + 1 >= RUN && unchanged + 1 < RUN {
            let mark = mixed(rolled);
            if mark.is_multiple_of(ONE_IN) {
                found.push(mark);
            }
        }
    }
    found
}

/// Mixes the bits (finaliser of SplitMix64, Steele et al. 2014).
fn mixed(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

/// Where a print was taken: section, and index among its prints.
type Place = (usize, usize);

/// Two records that share signals: the later and the earlier one, with the channels of both.
type Shared<'a> = BTreeMap<(usize, WhichRecord, usize, WhichRecord), Found<'a>>;

/// Channels of the later and of the earlier record, and both records in words.
#[derive(Debug, Default, PartialEq)]
struct Found<'a> {
    channels: Vec<(&'a str, &'a str)>,
    later: &'a str,
    earlier: &'a str,
}

/// Copies among the signals of every rule with `distinct`.
pub fn find(plan: &Plan, units: &[Unit], values: &[SectionValues]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut done: Vec<&str> = Vec::new();
    for rule in &plan.plausibility {
        let Test::Distinct(distinct) = rule.test else { continue };
        if done.contains(&rule.name.as_str()) {
            continue;
        }
        done.push(&rule.name);
        for ((later, which, earlier, of), found) in shared(&rule.name, distinct, values) {
            // A repeated section may be compared with the same simulation.
            let again = later != earlier && units[later].site == units[earlier].site;
            if again && (which.kind, of.kind) == (RecordKind::Simulation, RecordKind::Simulation) {
                continue;
            }
            let (later, earlier) = (&units[later], &units[earlier]);
            let found = finding(rule, (&later.name, found.later), (&earlier.name, found.earlier), &found.channels);
            findings.push(Finding { campaign: later.campaign_name.clone(), ..found });
        }
    }
    findings
}

fn shared<'a>(rule: &str, distinct: Distinct, values: &'a [SectionValues]) -> Shared<'a> {
    let print = |(section, at): Place| &values[section].prints[at];
    let mut all: Vec<(u64, Place)> = Vec::new();
    for (section, values) in values.iter().enumerate() {
        for (at, print) in values.prints.iter().enumerate().filter(|(_, print)| print.rule == rule) {
            all.extend(print.marks.iter().map(|mark| (*mark, (section, at))));
        }
    }
    all.par_sort_unstable();
    let mut counts: BTreeMap<(Place, Place), usize> = BTreeMap::new();
    for alike in all.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        // A copy is counted against one earlier signal; not all pairs of many copies are counted.
        for (number, (_, later)) in alike.iter().enumerate().skip(1) {
            for (_, earlier) in &alike[..number.min(NAMED)] {
                *counts.entry((*earlier, *later)).or_default() += 1;
            }
        }
    }
    let mut found = Shared::new();
    for ((earlier, later), count) in counts {
        let (a, b) = (print(earlier), print(later));
        let shorter = a.marks.len().min(b.marks.len());
        if count < LEAST || (count as f64) < SHARED * shorter as f64 {
            continue;
        }
        let asked = match (earlier.0 == later.0, a.which == b.which, a.channel == b.channel) {
            (true, true, _) => distinct.channels,
            (true, false, _) => distinct.sides,
            (false, true, true) => distinct.sections,
            // Another channel of another section: reported if equality between sections and between channels (or sides) is to be
            // found.
            (false, ..) => distinct.sections && (distinct.channels || distinct.sides),
        };
        if asked {
            let found = found.entry((later.0, b.which, earlier.0, a.which)).or_default();
            found.channels.push((&b.channel, &a.channel));
            (found.later, found.earlier) = (&b.record, &a.record);
        }
    }
    found
}

fn finding(
    rule: &Plausibility,
    (section, record): (&str, &str),
    (of_section, of_record): (&str, &str),
    channels: &[(&str, &str)],
) -> Finding {
    let (own, other): (Vec<&str>, Vec<&str>) = channels.iter().copied().unzip();
    let place = match (section == of_section, record == of_record) {
        (true, true) => String::new(),
        (true, false) => format!(" of the {of_record}"),
        (false, true) => format!(" of section {of_section}"),
        (false, false) => format!(" of the {of_record} of section {of_section}"),
    };
    let what = if own == other && own.len() > 1 { "the same channels".to_string() } else { named(&other) };
    Finding {
        channel: Some(named(&own)),
        section: Some(section.to_string()),
        record: Some(record.to_string()),
        cause: rule.cause.clone(),
        consequence: consequence(rule.otherwise),
        ..Finding::note(&rule.name, format!("{}: {} repeats the samples of {what}{place}", rule.title, named(&own)))
    }
}

fn named(channels: &[&str]) -> String {
    let mut names: Vec<&str> = Vec::new();
    channels.iter().for_each(|name| {
        if !names.contains(name) {
            names.push(name)
        }
    });
    if names.len() <= NAMED + 1 {
        return names.join(", ");
    }
    format!("{} and {} more", names[..NAMED].join(", "), names.len() - NAMED)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        (0..count)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                ((state >> 40) as f64 / 100.0).round() * 0.01
            })
            .collect()
    }

    fn values(prints: Vec<Print>) -> SectionValues {
        SectionValues { prints, ..SectionValues::default() }
    }

    const ALL: Distinct = Distinct { channels: true, sections: true, sides: true };

    #[test]
    fn copies_are_found_where_they_stand_and_live_signals_are_not() {
        let print =
            |channel: &str, kind: RecordKind, samples: &[f64]| Print::of("copies", channel, (kind.into(), kind.key().into()), samples);
        let (a, b, c) = (signal(1, 1500), signal(2, 1500), signal(3, 1500));
        let first = values(vec![
            print("Y", RecordKind::Simulation, &a),
            print("Q", RecordKind::Simulation, &b),
            print("Y", RecordKind::Measurement, &c),
        ]);
        // Half of the simulated Y of the first section, later in the record, and one channel twice.
        let mut half = signal(4, 700);
        half.extend(&a[..800]);
        let d = signal(5, 1500);
        let second = values(vec![
            print("Y", RecordKind::Simulation, &half),
            print("Q", RecordKind::Simulation, &d),
            print("Z", RecordKind::Simulation, &d),
            print("Y", RecordKind::Measurement, &[3.0; 1500]),
        ]);
        let sections = [first, second];
        let found = shared("copies", ALL, &sections);
        let simulated: WhichRecord = RecordKind::Simulation.into();
        assert_eq!(
            found.into_iter().map(|(place, found)| (place, found.channels)).collect::<Vec<_>>(),
            [((1, simulated, 0, simulated), vec![("Y", "Y")]), ((1, simulated, 1, simulated), vec![("Z", "Q")])]
        );
    }

    #[test]
    fn only_what_was_asked_for_is_told() {
        let a = signal(1, 900);
        let print = |channel: &str, kind: RecordKind| Print::of("copies", channel, (kind.into(), kind.key().into()), &a);
        let sections =
            [values(vec![print("Y", RecordKind::Simulation), print("Y", RecordKind::Measurement), print("Z", RecordKind::Simulation)])];
        let sides = Distinct { channels: false, sections: false, sides: true };
        let found = shared("copies", sides, &sections);
        assert!(found.keys().all(|(_, later, _, earlier)| later != earlier), "{found:?}");
    }
}
