//! Scores of blind diagnoses as a page.

use crate::report::{document::*, number};
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

/// Scores, cases, confusion, detectability, calibration; without a cover.
pub fn document(title: &str, blind: &Blind) -> Document {
    Document {
        title: title.to_owned(),
        program: PROGRAM,
        issued: None,
        draft: false,
        cover: None,
        chapters: vec![
            scores(blind),
            cases(blind),
            confusion(blind),
            detectability(blind),
            calibration(blind),
        ],
    }
}

fn number(value: Option<f64>) -> Cell {
    Cell::number(value, Format::Fixed(3))
}

fn between(low: f64, high: f64) -> Cell {
    format!("{} to {}", number::fixed(low, 2), number::fixed(high, 2)).into()
}

fn scores(blind: &Blind) -> Chapter {
    let rows = blind.scores.iter().map(|score| {
        let interval =
            score.low.zip(score.high).map_or(Cell::BLANK, |(low, high)| between(low, high));
        cells![score.name, score.cases, number(score.value), interval]
    });
    let numbers = ["Cases, cells or sections", "Value", "95 % interval"];
    let table =
        Table::new("Shares with Wilson's intervals").text("Score").numbers(numbers).rows(rows);
    Chapter::new("scores", "Scores", vec![table.into()])
}

fn cases(blind: &Blind) -> Chapter {
    let rows = blind.cases.iter().map(|case| {
        cells![
            case.campaign,
            case.kind,
            case.truth.join(", "),
            case.fault.as_ref().unwrap_or(&case.verdict),
            case.named.join(", "),
            if right(case) { "yes" } else { "no" },
            number(case.detectability),
            number(case.weakest),
            number(case.parameter_error),
            number(case.shrink_said),
            number(case.shrink_true)
        ]
    });
    let caption = "All campaigns; d is the whitened size of the true effects; least d is the smallest part of one of several effects that the others do not reproduce";
    let table = Table::new(caption)
        .text("Campaign")
        .short("Kind")
        .text("Truth")
        .text("Verdict")
        .text("Named first")
        .short("Right")
        .numbers(["d", "Least d", "Parameter error", "Removed, stated", "Removed, true"])
        .rows(rows);
    Chapter::new("cases", "Cases", vec![table.into()])
}

fn confusion(blind: &Blind) -> Chapter {
    let rows = blind.confusion.iter().flat_map(|(truth, named)| {
        named.iter().map(move |(name, count)| cells![truth, name, (*count)])
    });
    let table = Table::new("Counts")
        .text("Truth")
        .text("Named first, or verdict")
        .number("Cases")
        .rows(rows);
    Chapter::new("confusion", "Confusion of effects", vec![table.into()])
}

fn detectability(blind: &Blind) -> Chapter {
    let rows = blind.by_detectability.iter().filter(|one| one.cases > 0).map(|one| {
        cells![
            Cell::number(one.from, Format::Fixed(0)),
            one.cases,
            one.named,
            between(one.low, one.high)
        ]
    });
    let columns = ["d from", "Cases", "Named first", "95 % interval of the share"];
    let table = Table::new("Single effects").numbers(columns).rows(rows);
    Chapter::new("detectability", "Score against detectability", vec![table.into()])
}

fn calibration(blind: &Blind) -> Chapter {
    let rows = blind.calibration.iter().map(|bin| {
        cells![
            Cell::number(bin.said, Format::Fixed(2)),
            bin.cases,
            bin.right,
            between(bin.low, bin.high)
        ]
    });
    let columns = ["Stated", "Cases", "Right", "95 % interval of the share"];
    let caption = "Mean probability of the first cause, and number of cases in which it is right";
    let table = Table::new(caption).numbers(columns).rows(rows);
    Chapter::new("calibration", "Probabilities", vec![table.into()])
}
