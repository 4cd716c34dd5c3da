//! Text of the study of the synchronisation.

use super::document::{Chapter, Head, Item, Table};
use super::{BOXES, Opening, percent, sections, share};
use crate::report::number;
use crate::report::sides::capital;
use crate::report::view::Fact;
use crate::result::VerdictWords;
use crate::result::study::{AtOffset, LostSection, SyncStudy};

fn shown(found: &SyncStudy, offset: f64) -> String {
    number::with_unit(&number::significant(offset, 4), &found.axis_unit)
}

pub fn opening(found: &SyncStudy, words: &VerdictWords) -> Opening {
    let shares: Vec<f64> = found
        .offsets
        .iter()
        .filter_map(|at| Some(at.selections.counted().ok()?.share.share))
        .collect();
    let (low, high) =
        shares.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), share| {
            (low.min(*share), high.max(*share))
        });
    let base = found.offsets.iter().find(|at| at.offset.value() == 0.0);
    let same = base.is_none_or(|base| found.offsets.iter().all(|at| at.verdict == base.verdict));
    let (first, last) = (
        found.offsets.first().map_or(0.0, |at| at.offset.value()),
        found.offsets.last().map_or(0.0, |at| at.offset.value()),
    );
    let facts = [
        ("Offsets".to_owned(), format!("{} to {}", shown(found, first), shown(found, last))),
        (format!("{}, minimum", capital(&words.good)), percent(low)),
        (format!("{}, maximum", capital(&words.good)), percent(high)),
        (
            "Estimated offsets removed".to_owned(),
            if found.corrected { "yes" } else { "no" }.to_owned(),
        ),
    ];
    Opening {
        headline: super::stays(
            base.map(|base| base.verdict).filter(|_| same),
            words,
            "The verdict changes",
        ),
        sentence: format!(
            "The measurement was shifted relative to the simulation, from {} to {}. The verdict on all sections together {}. The share of selections with the verdict '{}' is between {} and {}.",
            shown(found, first),
            shown(found, last),
            match base.filter(|_| same) {
                Some(base) => format!("is the same at every offset ({})", words.word(base.verdict)),
                None => "depends on the offset".to_owned(),
            },
            words.good,
            percent(low),
            percent(high)
        ),
        facts: facts.map(|(name, value)| Fact { name, value }).to_vec(),
    }
}

pub fn chapters(found: &SyncStudy, words: &VerdictWords) -> Vec<Chapter> {
    let mut chapters = vec![
        Chapter {
            id: "shares".into(),
            title: format!("Share with the verdict '{}'", words.good),
            items: shares(found, words),
        },
        Chapter { id: "one".into(), title: "Single selection".into(), items: one(found) },
        Chapter {
            id: "estimates".into(),
            title: "Offsets estimated from the signals".into(),
            items: estimates(found),
        },
    ];
    let mut items = Vec::new();
    for (at, offset) in found.offsets.iter().enumerate() {
        if offset.selections.counted().is_ok() {
            let shown = shown(found, offset.offset.value());
            items.push(Item::Heading { text: format!("Offset {shown}") });
            let words = format!(", offset {shown}");
            items.extend(sections::boxes(&offset.quantities, &format!("{BOXES}-{at}"), &words));
        }
    }
    chapters.push(Chapter {
        id: "spread".into(),
        title: "Scatter over the selections".into(),
        items,
    });
    chapters
}

fn shares(found: &SyncStudy, words: &VerdictWords) -> Vec<Item> {
    let row = |at: &AtOffset| {
        let (validated, selections) = match at.selections.counted() {
            Ok(counted) => (share(&counted.share), number::large(counted.combinations)),
            Err(_) => (number::NONE.to_owned(), number::NONE.to_owned()),
        };
        let of = |share: f64, interval| super::share_with(share, interval);
        let (lost, gained) = match at.flips.compared() {
            Some(flips) => {
                (of(flips.lost, flips.lost_interval), of(flips.gained, flips.gained_interval))
            }
            None => (number::NONE.to_owned(), number::NONE.to_owned()),
        };
        let changes =
            if at.changes.is_empty() { number::NONE.to_owned() } else { at.changes.join("; ") };
        vec![
            shown(found, at.offset.value()),
            validated,
            lost,
            gained,
            selections,
            words.word(at.verdict).to_owned(),
            changes,
        ]
    };
    let good = &words.good;
    let mut items = vec![
        Item::figure(
            "shares",
            format!(
                "Share of selections with the verdict '{good}' as a function of the measurement offset"
            ),
            format!(
                "Share of selections with the verdict '{good}' over the offset; the numbers are in the table."
            ),
        ),
        Item::Table {
            table: Table {
                caption: format!(
                    "Influence of the synchronisation: share of selections with the verdict '{good}', share with it without the offset but not with the offset (lost), share with it only with the offset (gained), and the verdict"
                ),
                head: vec![
                    Head::number("Offset"),
                    Head::number(&capital(good)),
                    Head::number("Lost"),
                    Head::number("Gained"),
                    Head::number("Selections"),
                    Head::short("All sections"),
                    Head::text("Changes"),
                ],
                rows: found.offsets.iter().map(row).collect(),
            },
        },
    ];
    let none: Vec<String> = found
        .offsets
        .iter()
        // What stands in brackets are the sections that are lost, which a table of their own lists.
        .filter_map(|at| {
            let reason = at.selections.counted().err()?;
            Some(format!(
                "Offset {}: {}",
                shown(found, at.offset.value()),
                reason.split(" (").next().unwrap_or(reason)
            ))
        })
        .collect();
    if !none.is_empty() {
        items.push(Item::text("Offsets at which no selection can be made:"));
        items.push(Item::List { entries: none });
    }
    let rows: Vec<Vec<String>> =
        found.offsets.iter().flat_map(|at| lost(at, &shown(found, at.offset.value()))).collect();
    if !rows.is_empty() {
        items.push(Item::Table {
            table: Table {
                caption: "Sections that cannot be used at some offsets, so that the selections differ; the reason of the first of them"
                    .into(),
                head: vec![Head::short("Offset"), Head::text("Sections"), Head::text("Reason")],
                rows,
            },
        });
    }
    items
}

/// A row for each rule that sections do not meet at an offset.
fn lost(at: &AtOffset, offset: &str) -> Vec<Vec<String>> {
    let rule = |reason: &str| reason.split(": ").next().unwrap_or(reason).to_owned();
    let mut rules: Vec<(String, Vec<&str>, &str)> = Vec::new();
    for LostSection { section, reason } in &at.lost {
        match rules.iter_mut().find(|(known, ..)| *known == rule(reason)) {
            Some((_, sections, _)) => sections.push(section),
            None => rules.push((rule(reason), vec![section], reason)),
        }
    }
    rules
        .into_iter()
        .map(|(_, sections, reason)| {
            vec![offset.to_owned(), sections.join(", "), reason.to_owned()]
        })
        .collect()
}

fn one(found: &SyncStudy) -> Vec<Item> {
    let mut head = vec![Head::text("Quantity"), Head::short("Statistic")];
    head.extend(found.offsets.iter().map(|at| Head::number(&shown(found, at.offset.value()))));
    let first = found.offsets.iter().find(|at| !at.selected.is_empty());
    let rows =
        first.map_or(&[][..], |at| &at.selected).iter().enumerate().map(|(statistic, one)| {
            let mut row = vec![one.symbol.clone(), format!("{}{}", one.name, one.scope.suffix())];
            row.extend(found.offsets.iter().map(|at| {
                let value = at.selected.get(statistic).and_then(|one| one.normalised);
                value.map_or_else(|| number::NONE.to_owned(), |value| number::beside(value, 1.0, 2))
            }));
            row
        });
    vec![
        Item::text(format!("One selection drawn at random: {}.", found.selection.join(", "))),
        Item::figure(
            "selection",
            "Statistics of a single selection divided by their limits, at each offset",
            "Normalised statistics of one selection at every offset; the numbers are in the table.",
        ),
        Item::Table {
            table: Table {
                caption: "Statistics of a single selection divided by their limits".into(),
                head,
                rows: rows.collect(),
            },
        },
    ]
}

fn estimates(found: &SyncStudy) -> Vec<Item> {
    let number = |value: Option<f64>| number::optional(value, 2);
    let rows = found.estimates.iter().map(|one| {
        vec![
            one.section.clone(),
            one.zone.clone().unwrap_or_default(),
            number(one.shift),
            one.low.map_or_else(
                || number::NONE.to_owned(),
                |_| format!("{} to {}", number(one.low), number(one.high)),
            ),
            number(one.correlation),
        ]
    });
    let what = if found.corrected {
        "These offsets were removed before the offsets of this study were applied."
    } else {
        "They are reported for information; no correction was applied."
    };
    vec![
        Item::text(format!(
            "Estimated by cross-correlation of all filtered signals of both records of a section. The 95 % interval combines a jackknife over eighths of the section with the scatter between groups of signals that share no channel. {what}"
        )),
        Item::Table {
            table: Table {
                caption: format!(
                    "Offset to be added to the axis of the measurement, in {}",
                    number::unit(&found.axis_unit)
                ),
                head: vec![
                    Head::text("Section"),
                    Head::short("Zone"),
                    Head::number("Offset"),
                    Head::number("95 % interval"),
                    Head::number("Correlation"),
                ],
                rows: rows.collect(),
            },
        },
    ]
}
