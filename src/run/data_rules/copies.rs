//! Finds signals that are copies: of another channel, of another section, of the other side.

use std::collections::BTreeMap;

use rayon::slice::ParallelSliceMut;

use super::consequence::consequence;
use crate::result::Channels;
use crate::run::{prelude::*, sections::Unit, values::SectionValues};
use crate::words;

/// Two signals are copies if they share at least this part of the marks of the shorter one ...
const SHARED: f64 = 0.3;
/// ... and at least this many marks, which is about 100 samples.
const LEAST: usize = 6;
/// Number of earlier signals that a copy is counted against.
const EARLIER: usize = 4;

/// Where a print was taken: section, and index among its prints.
type PrintIndex = (usize, usize);

/// Two records that share signals: the later and the earlier one, with the channels of both.
type Shared<'a> = BTreeMap<(usize, WhichRecord, usize, WhichRecord), SharedChannels<'a>>;

/// Channels of the later and of the earlier record, and both records in words.
#[derive(Debug, Default, PartialEq)]
struct SharedChannels<'a> {
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
            let prints = values[later].prints.iter();
            let all = prints.filter(|print| print.rule == rule.name && print.which == which);
            let part = later == earlier && which != of && found.channels.len() < all.count();
            if part && !(distinct.sides && of_sides(which, of)) {
                continue;
            }
            let (later, earlier) = (&units[later], &units[earlier]);
            // A rule of several channels stands once for each of them.
            let of_name = plan.plausibility.iter().filter(|other| other.name == rule.name);
            let unread: Vec<&String> = of_name.flat_map(|rule| &rule.unread).collect();
            let read = |(later, _): &(&str, &str)| !unread.iter().any(|unread| *unread == later);
            let note = Plausibility { otherwise: OnFault::Note, ..rule.clone() };
            let stays = rule.otherwise == OnFault::NotUsed && !found.channels.iter().any(read);
            findings.push(finding(
                if stays { &note } else { rule },
                (later, found.later),
                (&earlier.name, found.earlier),
                &found.channels,
            ));
        }
    }
    findings
}

/// Which marks may stand in several places: nearly all stand in one, and need not be sorted. It
/// errs on one side only: a mark that stands in several places is never left out.
struct Several {
    once: Vec<u64>,
    again: Vec<u64>,
}

impl Several {
    /// Bits for each mark: one mark in eight that stands alone is sorted with the others.
    const BITS: usize = 8;

    fn of(count: usize, marks: impl Iterator<Item = u32>) -> Self {
        let words = (count * Self::BITS / 64 + 1).next_power_of_two();
        let mut found = Self { once: vec![0; words], again: vec![0; words] };
        for mark in marks {
            let (word, bit) = found.place(mark);
            found.again[word] |= found.once[word] & bit;
            found.once[word] |= bit;
        }
        found
    }

    fn may_have(&self, mark: u32) -> bool {
        let (word, bit) = self.place(mark);
        self.again[word] & bit != 0
    }

    /// Marks are hashes: their bits are as good as random.
    fn place(&self, mark: u32) -> (usize, u64) {
        ((mark >> 6) as usize & (self.once.len() - 1), 1 << (mark & 63))
    }
}

/// Whether two records are compared channel by channel. What two simulations do differently may not
/// act on a channel at all.
fn of_sides(a: WhichRecord, b: WhichRecord) -> bool {
    (a.kind, b.kind) != (RecordKind::Simulation, RecordKind::Simulation)
}

fn shared<'a>(rule: &str, distinct: Distinct, values: &'a [SectionValues]) -> Shared<'a> {
    let print = |(section, at): PrintIndex| &values[section].prints[at];
    let prints = || {
        let of_section = |(section, values): (usize, &'a SectionValues)| {
            values
                .prints
                .iter()
                .enumerate()
                .filter(|(_, print)| print.rule == rule)
                .map(move |(at, print)| ((section, at), print))
        };
        values.iter().enumerate().flat_map(of_section)
    };
    let count = prints().map(|(_, print)| print.marks.len()).sum();
    let several = Several::of(count, prints().flat_map(|(_, print)| print.marks.iter().copied()));
    let mut all: Vec<(u32, PrintIndex)> = Vec::new();
    for (place, print) in prints() {
        all.extend(
            print.marks.iter().filter(|mark| several.may_have(**mark)).map(|mark| (*mark, place)),
        );
    }
    all.par_sort_unstable();
    let mut counts: BTreeMap<(PrintIndex, PrintIndex), usize> = BTreeMap::new();
    for alike in all.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        // A copy is counted against one earlier signal; not all pairs of many copies are counted.
        for (number, (_, later)) in alike.iter().enumerate().skip(1) {
            for (_, earlier) in &alike[..number.min(EARLIER)] {
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
            (true, false, _) => {
                let whole = distinct.records && (&a.channel, a.whole) == (&b.channel, b.whole);
                whole || distinct.sides && of_sides(a.which, b.which)
            }
            (false, true, true) => distinct.sections,
            // Another channel of another section: reported if equality between sections and between
            // channels (or sides) is to be found.
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
    (unit, record): (&Unit, &str),
    (of_section, of_record): (&str, &str),
    channels: &[(&str, &str)],
) -> Finding {
    let (own, other): (Vec<&str>, Vec<&str>) = channels.iter().copied().unzip();
    let names = Channels::of(&own);
    let first = Occurrence {
        channel: Some(words::text(&names).to_string()),
        campaign: unit.campaign_name.clone(),
        section: Some(unit.name.clone()),
        record: Some(record.to_string()),
        ..Occurrence::from(FindingData::Copies {
            rule: rule.title.clone(),
            channels: names,
            copied: (own != other || own.len() == 1).then(|| Channels::of(&other)),
            record: (record != of_record).then(|| of_record.to_string()),
            section: (unit.name != of_section).then(|| of_section.to_string()),
        })
    };
    Finding {
        causes: rule.cause.clone().map(Reason::said).into_iter().collect(),
        consequence: consequence(rule.otherwise),
        ..Finding::note(&rule.name, first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::random::mixed;
    use crate::run::values::print::{Print, shortened};

    fn signal(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        (0..count)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                ((state >> 40) as f64 / 100.0).round() * 0.01
            })
            .collect()
    }

    #[test]
    fn no_mark_of_several_places_is_left_out() {
        let mark = |k: u64| shortened(mixed(k));
        let mut marks: Vec<u32> = (0..20_000).map(mark).collect();
        marks.extend((0..100).map(mark));
        let several = Several::of(marks.len(), marks.iter().copied());
        assert!((0..100).all(|k| several.may_have(mark(k))));
        let alone = (100..20_000).filter(|k| several.may_have(mark(*k))).count();
        assert!(alone < 20_000 / 6, "{alone}");
    }

    fn values(prints: Vec<Print>) -> SectionValues {
        SectionValues { prints, ..SectionValues::default() }
    }

    const ALL: Distinct = Distinct { channels: true, sections: true, sides: true, records: false };

    #[test]
    fn copies_are_found_where_they_stand_and_live_signals_are_not() {
        let print = |channel: &str, kind: RecordKind, samples: &[f64]| {
            Print::of("copies", channel, (kind.into(), kind.key().into()), samples)
        };
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
            [
                ((1, simulated, 0, simulated), vec![("Y", "Y")]),
                ((1, simulated, 1, simulated), vec![("Z", "Q")])
            ]
        );
    }

    #[test]
    fn only_what_was_asked_for_is_told() {
        let a = signal(1, 900);
        let print = |channel: &str, kind: RecordKind| {
            Print::of("copies", channel, (kind.into(), kind.key().into()), &a)
        };
        let sections = [values(vec![
            print("Y", RecordKind::Simulation),
            print("Y", RecordKind::Measurement),
            print("Z", RecordKind::Simulation),
        ])];
        let sides = Distinct { channels: false, sections: false, sides: true, records: false };
        let found = shared("copies", sides, &sections);
        assert!(found.keys().all(|(_, later, _, earlier)| later != earlier), "{found:?}");
    }
}
