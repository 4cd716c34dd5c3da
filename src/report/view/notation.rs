//! Symbols, signs and terms used in tables and figures.

use super::{View, verdicts};
use crate::report::{brief::in_full, document::*, number};
use crate::result::{Certification, ChannelInfo, Outcome, QuantityResult};

/// Comparisons with an explanation of their sign, of values called ONE and OTHER. Others are
/// self-explanatory.
const COMPARISONS: [(&str, &str); 3] = [
    (
        "sign(OTHER) * (ONE - OTHER)",
        "Positive: the ONE is larger in the direction of the OTHER. A wrong sign of the ONE gives a large negative difference.",
    ),
    (
        "|ONE| - |OTHER|",
        "Positive: the magnitude of the ONE is larger. The signs of both values are not compared.",
    ),
    ("ONE - OTHER", "Positive: the ONE is larger, with its sign."),
];

/// What the two values of a difference are called in its words, and in a sentence.
const VALUES: [([&str; 2], [&str; 2]); 6] = [
    (["simulated", "measured"], ["simulated value", "measured value"]),
    (["repeat", "original"], ["repeat", "original"]),
    (["simulated", "mean of all"], ["simulated value", "mean of all"]),
    (["simulated", "median of all"], ["simulated value", "median of all"]),
    (["measured", "mean of all"], ["measured value", "mean of all"]),
    (["measured", "median of all"], ["measured value", "median of all"]),
];

/// Each comparison that quantities use, with its meaning.
fn comparisons(found: &Certification) -> Vec<Vec<Cell>> {
    let put =
        |text: &str, [one, other]: [&str; 2]| text.replace("ONE", one).replace("OTHER", other);
    let of_values = |(in_words, named)| {
        let term =
            move |(words, meaning): (&str, &str)| (put(words, in_words), put(meaning, named));
        COMPARISONS.into_iter().map(term)
    };
    let used = |words: &str| found.quantities.iter().any(|quantity| quantity.comparison == words);
    let all = VALUES.into_iter().flat_map(of_values).filter(|(words, _)| used(words));
    all.map(|(words, meaning)| cells![Cell::formula(words), meaning]).collect()
}

/// Terms of a comparison of simulated with measured records.
const COMPARED: [(&str, &str); 4] = [
    (
        "Pair",
        "The simulated and the measured value of one quantity, in one section, for one signal.",
    ),
    (
        "n",
        "Number of sites of the pairs: repeats and positions of one section are not independent of each other.",
    ),
    ("Mean", "Arithmetic mean of the differences of the pairs."),
    (
        "Standard deviation",
        "Scatter of the differences about their mean. The divisor, n − 1 or n, is stated with it.",
    ),
];

/// Terms of an assessment.
const ASSESSED: [(&str, &str); 4] = [
    ("Value", "The number of one record, in one section, for one signal."),
    (
        "Values / n",
        "Number of values of a group, and of its independent units: sites, if the protocol does not say otherwise.",
    ),
    ("Mean, s", "Arithmetic mean and standard deviation (divisor n − 1) of the values of a group."),
    (
        "Estimate",
        "What is compared with the limit: a statistic of the values of a group, or a value predicted from them.",
    ),
];

/// Terms of a comparison of several records of one side.
const AMONG: [(&str, &str); 6] = [
    ("Record", "The number of one record, in one section, for one signal."),
    ("Mean of all, median of all", "That of the numbers of all records of the section."),
    ("Deviation, difference", "Of the number of a record from that of all records."),
    (
        "Max. − min., s",
        "Largest less smallest number and standard deviation (divisor n − 1): of the mean deviations of the records; of the spread, of the \
         deviations of all records in one section, for one signal.",
    ),
    (
        "Rank",
        "By the root mean square of the deviations: 1 is nearest to all records. Equal ones have the same rank.",
    ),
    ("Values / n", "Number of values of a statistic, and of their independent sites."),
];

/// Terms of a comparison of repeats with their originals.
const REPEATED: [(&str, &str); 4] = [
    (
        "Repeat, original",
        "A section that was measured again, and the section that it repeats: the number of each, for one signal.",
    ),
    ("Values / n", "Number of values of a statistic, and of their independent sites."),
    ("Mean", "Arithmetic mean of the values."),
    (
        "Standard deviation",
        "Scatter of the values about their mean. The divisor, n − 1 or n, is stated with it.",
    ),
];

/// Terms explained in every report.
const WORDS: [(&str, &str); 4] = [
    (
        "95 % interval",
        "Confidence interval of the statistic. The mean: Student's t; the standard deviation: chi-square.",
    ),
    (
        "|Value| / limit",
        "Magnitude of the statistic divided by its limit; with ≤ before the limit, the statistic with its sign. With ≥ before the limit, the \
         limit divided by the statistic, and no ratio for a statistic that is not above zero. The criterion is met up to 1. Ratios above \
         1000 are not printed.",
    ),
    (
        "p0.15, p99.85",
        "Value below which 0.15 % or 99.85 % of the samples of a section lie; other percentiles likewise.",
    ),
    ("rms", "Root of the mean of the squares of the samples."),
];

/// Terms explained where a metric, an estimate or a limit uses them: what they are known by in its
/// words.
const WHERE_USED: [(&str, &str, &str); 3] = [
    (
        "misfit",
        "Misfit",
        "Sum of the squared differences of both signals, divided by the smaller of the sums of their squares.",
    ),
    (
        "share where",
        "Share where …",
        "The part of the values of a group that satisfy the condition, from 0 to 1.",
    ),
    (
        "bootstrap",
        "By bootstrap",
        "A bound from 2000 draws of the independent units of a group, with repetition. Of fewer than about ten units it lies too near to the \
         value.",
    ),
];

fn terms(found: &Certification) -> Vec<(&'static str, &'static str)> {
    let words = |quantity: &QuantityResult| {
        let estimates =
            quantity.statistics.iter().flat_map(|one| [one.title.clone(), one.limit_text.clone()]);
        let reported = quantity.reported.iter().map(|one| one.title.clone());
        estimates.chain(reported).chain([quantity.comparison.clone()]).collect::<Vec<String>>()
    };
    let words: Vec<String> = found.quantities.iter().flat_map(words).collect();
    let special =
        WHERE_USED.iter().filter(|(part, ..)| words.iter().any(|text| text.contains(part)));
    let some = |of: fn(&QuantityResult) -> bool| found.quantities.iter().any(of);
    let compared =
        some(|quantity| quantity.from.is_none() && quantity.among.is_none() && !quantity.repeats);
    let kinds: [(bool, &[_]); 4] = [
        (compared, &COMPARED),
        (some(|quantity| quantity.from.is_some()), &ASSESSED),
        (some(|quantity| quantity.among.is_some()), &AMONG),
        (some(|quantity| quantity.repeats), &REPEATED),
    ];
    let used =
        kinds.into_iter().filter(|(used, _)| *used).flat_map(|(_, terms)| terms).chain(&WORDS);
    let used = used.copied().chain(special.map(|(_, word, meaning)| (*word, *meaning)));
    // A word that two kinds explain stands once, as the first explains it.
    let mut all: Vec<(&str, &str)> = Vec::new();
    for (word, meaning) in used {
        if !all.iter().any(|(known, _)| *known == word) {
            all.push((word, meaning));
        }
    }
    all
}

pub fn chapter(view: &View<'_>) -> Chapter {
    let found = view.found;
    let known = |table: Table| (!table.rows.is_empty()).then_some(table);
    let meanings = |caption: &str, head: &str, rows: Vec<Vec<Cell>>| {
        known(
            Table::new(caption).text(head).wide(0.4).text("Meaning").wide(1.0).rows(rows).class(""),
        )
    };
    let terms = if found.quantities.is_empty() { Vec::new() } else { terms(found) };
    let terms = terms.into_iter().map(|(word, meaning)| cells![word, meaning]);
    let tables = [
        known(quantities(view)),
        known(channels(&found.protocol.channels)),
        meanings("Sign of the differences", "Difference", comparisons(found)),
        meanings("Statistics and terms", "Term", terms.collect()),
        meanings("Findings", "Sign", findings(found)),
    ];
    Chapter::new("notation", "Notation", tables.into_iter().flatten().map(Block::from).collect())
}

/// Of many quantities, those with a chapter: the table of all has their words.
fn quantities(view: &View<'_>) -> Table {
    let all = &view.found.quantities;
    let rows = in_full(all).into_iter().map(|at| &all[at]).map(|quantity| {
        cells![
            Cell::symbol(&super::symbol(&quantity.symbol), ""),
            quantity.title,
            number::unit(&quantity.unit),
            quantity.of,
            Cell::formula(&quantity.comparison)
        ]
    });
    Table::new("Quantities")
        .short("Symbol")
        .text("Quantity")
        .wide(1.5)
        .short("Unit")
        .text("Signals")
        .wide(1.1)
        .text(view.words.comparison)
        .wide(1.7)
        .rows(rows)
        .class("")
        .size(8.0)
}

fn channels(all: &[ChannelInfo]) -> Table {
    let row = |channel: &ChannelInfo| {
        let note = Some(&channel.note).filter(|note| !note.is_empty());
        cells![channel.name, channel.title, number::unit(&channel.unit), Cell::or_missing(note)]
    };
    Table::new("Channels and their signs")
        .name("Channel")
        .text("Meaning")
        .wide(1.2)
        .short("Unit")
        .text("Sign and remarks")
        .wide(1.6)
        .rows(all.iter().map(row))
        .class("")
        .size(8.0)
}

fn findings(found: &Certification) -> Vec<Vec<Cell>> {
    let row = |finding: Finding, meaning: &str| cells![finding, meaning];
    let mut rows = vec![
        row(Finding::of(Some(true)), "The acceptance criterion or requirement is met."),
        row(Finding::of(Some(false)), "It is not met."),
        row(Finding::of(None), "It could not be assessed; the reason is stated."),
    ];
    if found.verdicts.iter().any(|verdict| verdict.outcome == Outcome::Open) {
        let open = verdicts::finding(Outcome::Open, "");
        rows.push(row(open, "A person decides it, whom the protocol names."));
    }
    rows
}
