//! Text of the study of the synchronisation.

use super::{BOXES, percent, scoped, sections, share};
use crate::report::{document::*, number, sides::capital, view::Opening};
use crate::result::{
    Reason, UnusedSection, VerdictWords,
    study::{AtOffset, SyncStudy},
};

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
        facts: facts.map(|(name, value)| Fact::new(name, value)).to_vec(),
    }
}

pub fn chapters(found: &SyncStudy, words: &VerdictWords) -> Vec<Chapter> {
    let mut blocks = Vec::new();
    for (at, offset) in found.offsets.iter().enumerate() {
        if offset.selections.counted().is_ok() {
            let words = format!(", offset {}", shown(found, offset.offset.value()));
            blocks.push(Block::heading(format!("Offset {}", shown(found, offset.offset.value()))));
            blocks.extend(sections::boxes(&offset.quantities, &format!("{BOXES}-{at}"), &words));
        }
    }
    let share = format!("Share with the verdict '{}'", words.good);
    vec![
        Chapter::new("shares", share, shares(found, words)),
        Chapter::new("one", "Single selection", single_selection(found)),
        Chapter::new("estimates", "Offsets estimated from the signals", estimates(found)),
        Chapter::new("spread", "Scatter over the selections", blocks),
    ]
}

fn shares(found: &SyncStudy, words: &VerdictWords) -> Vec<Block> {
    let row = |at: &AtOffset| {
        let (study, flips) = (at.selections.counted().ok(), at.flips.compared());
        let shown_share = |share: f64, interval| super::share_with(share, interval);
        let changes: Vec<String> = at.changes.iter().map(|of| of.text().to_string()).collect();
        let changes = (!changes.is_empty()).then(|| changes.join("; "));
        vec![
            Cell::from(shown(found, at.offset.value())),
            Cell::or_missing(study.map(|study| share(&study.share))),
            Cell::or_missing(flips.map(|flips| shown_share(flips.lost, flips.lost_interval))),
            Cell::or_missing(flips.map(|flips| shown_share(flips.gained, flips.gained_interval))),
            Cell::number(study.map(|study| study.combinations), Format::Count),
            words.word(at.verdict).into(),
            Cell::or_missing(changes),
        ]
    };
    let good = &words.good;
    let figure = Figure::new(
        "shares",
        format!(
            "Share of selections with the verdict '{good}' as a function of the measurement offset"
        ),
        format!(
            "Share of selections with the verdict '{good}' over the offset; the numbers are in the table."
        ),
        200,
    );
    let caption = format!(
        "Influence of the synchronisation: share of selections with the verdict '{good}', share with it without the offset but not with the offset (lost), share with it only with the offset (gained), and the verdict"
    );
    let table = Table::new(caption)
        .number("Offset")
        .number(capital(good))
        .numbers(["Lost", "Gained", "Selections"])
        .short("All sections")
        .text("Changes")
        .rows(found.offsets.iter().map(row));
    let mut blocks = vec![figure.into(), table.into()];
    let none: Vec<String> = found
        .offsets
        .iter()
        .filter_map(|at| {
            let mut reason = at.selections.counted().err()?.clone();
            // A table of their own lists the sections that are lost.
            if let Reason::TooFewToSelect { unused, .. } = &mut reason {
                unused.clear();
            }
            Some(format!("Offset {}: {}", shown(found, at.offset.value()), reason.text()))
        })
        .collect();
    if !none.is_empty() {
        blocks.push(Block::text("Offsets at which no selection can be made:"));
        blocks.push(Block::list(none));
    }
    let rows: Vec<Vec<Cell>> =
        found.offsets.iter().flat_map(|at| lost(at, &shown(found, at.offset.value()))).collect();
    if !rows.is_empty() {
        let caption = "Sections that cannot be used at some offsets, so that the selections differ; the reason of the first of them";
        let table = Table::new(caption).short("Offset").text("Sections").text("Reason").rows(rows);
        blocks.push(table.into());
    }
    blocks
}

/// A row for each rule that sections do not meet at an offset.
fn lost(at: &AtOffset, offset: &str) -> Vec<Vec<Cell>> {
    let mut rules: Vec<(&Reason, Vec<&str>)> = Vec::new();
    for UnusedSection { section, reason } in &at.lost {
        match rules.iter_mut().find(|(known, _)| known.same_rule(reason)) {
            Some((_, sections)) => sections.push(section),
            None => rules.push((reason, vec![section])),
        }
    }
    rules
        .into_iter()
        .map(|(reason, sections)| cells![offset, sections.join(", "), reason.clone()])
        .collect()
}

fn single_selection(found: &SyncStudy) -> Vec<Block> {
    let first = found.offsets.iter().find(|at| !at.selected.is_empty());
    let all = first.map_or(&[][..], |at| &at.selected);
    let rows = all.iter().enumerate().map(|(statistic, one)| {
        let mut row = cells![Cell::symbol(&one.symbol, ""), scoped(&one.name, &one.scope)];
        row.extend(found.offsets.iter().map(|at| {
            let value = at.selected.get(statistic).and_then(|one| one.normalised);
            Cell::number(value, Format::Beside { limit: 1.0, decimals: 2 })
        }));
        row
    });
    let figure = Figure::new(
        "selection",
        "Statistics of a single selection divided by their limits, at each offset",
        "Normalised statistics of one selection at every offset; the numbers are in the table.",
        200,
    );
    let table = Table::new("Statistics of a single selection divided by their limits")
        .text("Quantity")
        .short("Statistic")
        .numbers(found.offsets.iter().map(|at| shown(found, at.offset.value())))
        .rows(rows);
    vec![
        Block::text(format!("One selection drawn at random: {}.", found.selection.join(", "))),
        figure.into(),
        table.into(),
    ]
}

fn estimates(found: &SyncStudy) -> Vec<Block> {
    let number = |value: Option<f64>| number::optional(value, 2);
    let rows = found.estimates.iter().map(|one| {
        let interval = one.low.map(|_| format!("{} to {}", number(one.low), number(one.high)));
        cells![
            one.section,
            one.zone,
            Cell::number(one.shift, Format::Fixed(2)),
            Cell::or_missing(interval),
            Cell::number(one.correlation, Format::Fixed(2))
        ]
    });
    let what = if found.corrected {
        "These offsets were removed before the offsets of this study were applied."
    } else {
        "They are reported for information; no correction was applied."
    };
    let about = format!(
        "Estimated by cross-correlation of all filtered signals of both records of a section. The 95 % interval combines a jackknife over eighths of the section with the scatter between groups of signals that share no channel. {what}"
    );
    let caption = format!(
        "Offset to be added to the axis of the measurement, in {}",
        number::unit(&found.axis_unit)
    );
    vec![
        Block::text(about),
        Table::new(caption)
            .text("Section")
            .breaks(12)
            .name("Zone")
            .numbers(["Offset", "95 % interval", "Correlation"])
            .rows(rows)
            .into(),
    ]
}
