//! Scores of blind diagnoses as chapters of a page.

use crate::report::number;
use crate::report::study::{Chapter, Head, Item, Table};
use crate::result::blind::{Blind, Case};

/// Whether the answer is right. If no effect of the catalogue is hidden, no cause may be named with
/// confidence.
fn right(case: &Case) -> bool {
    match case.kind.as_str() {
        "none" => case.named.is_empty(),
        "outside" => case.verdict != "explained",
        _ => case.first_is_right,
    }
}

/// Scores, cases, confusion, detectability, calibration.
#[must_use]
pub fn chapters(blind: &Blind) -> Vec<Chapter> {
    let number = |value: Option<f64>| {
        value.map_or_else(|| number::NONE.to_owned(), |value| number::fixed(value, 3))
    };
    let chapter =
        |id: &str, title: &str, head: Vec<Head>, rows: Vec<Vec<String>>, caption: &str| Chapter {
            id: id.into(),
            title: title.into(),
            items: vec![Item::Table { table: Table { caption: caption.into(), head, rows } }],
        };
    let between =
        |low: f64, high: f64| format!("{} to {}", number::fixed(low, 2), number::fixed(high, 2));
    let scores = blind.scores.iter().map(|score| {
        let interval =
            score.low.zip(score.high).map_or_else(String::new, |(low, high)| between(low, high));
        vec![score.name.clone(), score.cases.to_string(), number(score.value), interval]
    });
    let cases = blind.cases.iter().map(|case| {
        vec![
            case.campaign.clone(),
            case.kind.clone(),
            case.truth.join(", "),
            case.fault.clone().unwrap_or_else(|| case.verdict.clone()),
            case.named.join(", "),
            if right(case) { "yes".into() } else { "no".into() },
            number(case.detectability),
            number(case.weakest),
            number(case.parameter_error),
            number(case.shrink_said),
            number(case.shrink_true),
        ]
    });
    let mut confusion = Vec::new();
    for (truth, named) in &blind.confusion {
        confusion.extend(
            named.iter().map(|(name, count)| vec![truth.clone(), name.clone(), count.to_string()]),
        );
    }
    let by_size = blind.by_detectability.iter().filter(|one| one.cases > 0).map(|one| {
        vec![
            number::fixed(one.from, 0),
            one.cases.to_string(),
            one.named.to_string(),
            between(one.low, one.high),
        ]
    });
    let calibration = blind.calibration.iter().map(|bin| {
        vec![
            number::fixed(bin.said, 2),
            bin.cases.to_string(),
            bin.right.to_string(),
            between(bin.low, bin.high),
        ]
    });
    let (text, short, numeric) = (Head::text, Head::short, Head::number);
    vec![
        chapter(
            "scores",
            "Scores",
            vec![
                text("Score"),
                numeric("Cases, cells or sections"),
                numeric("Value"),
                numeric("95 % interval"),
            ],
            scores.collect(),
            "Shares with Wilson's intervals",
        ),
        chapter(
            "cases",
            "Cases",
            vec![
                text("Campaign"),
                short("Kind"),
                text("Truth"),
                text("Verdict"),
                text("Named first"),
                short("Right"),
                numeric("d"),
                numeric("Least d"),
                numeric("Parameter error"),
                numeric("Removed, stated"),
                numeric("Removed, true"),
            ],
            cases.collect(),
            "All campaigns; d is the whitened size of the true effects; least d is the smallest part of one of several effects that the others do not reproduce",
        ),
        chapter(
            "confusion",
            "Confusion of effects",
            vec![text("Truth"), text("Named first, or verdict"), numeric("Cases")],
            confusion,
            "Counts",
        ),
        chapter(
            "detectability",
            "Score against detectability",
            vec![
                numeric("d from"),
                numeric("Cases"),
                numeric("Named first"),
                numeric("95 % interval of the share"),
            ],
            by_size.collect(),
            "Single effects",
        ),
        chapter(
            "calibration",
            "Probabilities",
            vec![
                numeric("Stated"),
                numeric("Cases"),
                numeric("Right"),
                numeric("95 % interval of the share"),
            ],
            calibration.collect(),
            "Mean probability of the first cause, and number of cases in which it is right",
        ),
    ]
}
