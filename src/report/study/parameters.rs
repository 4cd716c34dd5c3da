//! Text of the study of parameters.

use super::document::{Chapter, Head, Item, Table};
use super::{Opening, share_with};
use crate::report::number;
use crate::report::sides::capital;
use crate::report::view::Fact;
use crate::result::VerdictWords;
use crate::result::study::{AtValue, ParameterStudy, Varied};

pub fn opening(found: &ParameterStudy, words: &VerdictWords) -> Opening {
    let deciding: Vec<&str> = found
        .parameters
        .iter()
        .filter(|parameter| parameter.decides)
        .map(|parameter| parameter.title.as_str())
        .collect();
    let values: usize = found.parameters.iter().map(|parameter| parameter.values.len()).sum();
    let sentence = if deciding.is_empty() {
        format!(
            "The baseline verdict is '{}'; no tested value changes it.",
            words.word(found.base.verdict)
        )
    } else {
        format!(
            "The baseline verdict is '{}'. It changes with: {}.",
            words.word(found.base.verdict),
            deciding.join("; ")
        )
    };
    Opening {
        headline: super::stays(
            Some(found.base.verdict).filter(|_| deciding.is_empty()),
            words,
            &format!(
                "{} of {} parameters affect the verdict",
                deciding.len(),
                found.parameters.len()
            ),
        ),
        sentence,
        facts: [
            ("Parameters varied".to_owned(), found.parameters.len().to_string()),
            ("Values tested".to_owned(), values.to_string()),
            ("Baseline verdict".to_owned(), words.word(found.base.verdict).to_owned()),
            (
                format!("Selections: {}", words.good),
                found.base.share.map_or_else(
                    || number::NONE.to_owned(),
                    |share| share_with(share, found.base.interval),
                ),
            ),
        ]
        .map(|(name, value)| Fact { name, value })
        .to_vec(),
    }
}

pub fn chapters(found: &ParameterStudy, words: &VerdictWords) -> Vec<Chapter> {
    let row = |parameter: &Varied, at: &AtValue| {
        vec![
            parameter.name.clone(),
            if at.is_base { format!("{} (baseline)", at.value) } else { at.value.clone() },
            words.word(at.verdict).to_owned(),
            at.largest.as_ref().map_or_else(
                || number::NONE.to_owned(),
                |largest| number::beside(largest.normalised, 1.0, 3),
            ),
            at.largest.as_ref().map_or_else(String::new, |largest| largest.statistic.clone()),
            at.share.map_or_else(
                || at.reason.clone().unwrap_or_default(),
                |share| share_with(share, at.interval),
            ),
        ]
    };
    let rows = found
        .parameters
        .iter()
        .flat_map(|parameter| parameter.values.iter().map(move |at| row(parameter, at)));
    let mut chapters = vec![Chapter {
        id: "choices".into(),
        title: "Parameters that affect the verdict".into(),
        items: vec![
            Item::text(
                "Each parameter is varied individually; all others keep their baseline values. In the figure, baseline values and the parameters that affect the verdict are printed in bold.",
            ),
            Item::figure(
                "choices",
                format!(
                    "Largest statistic divided by its limit for each value, and the share of selections with the verdict '{}'",
                    words.good
                ),
                "For every value of every parameter the largest normalised statistic; the numbers are in the table.",
            ),
            Item::Table {
                table: Table {
                    caption: format!(
                        "Verdict on all sections, largest statistic divided by its limit, and share of selections with the verdict '{}'",
                        words.good
                    ),
                    head: vec![
                        Head::text("Parameter"),
                        Head::text("Value"),
                        Head::short("Verdict"),
                        Head::number("Largest ratio"),
                        Head::text("Statistic"),
                        Head::number(&capital(&words.good)),
                    ],
                    rows: rows.collect(),
                },
            },
        ],
    }];
    let mut items = Vec::new();
    for parameter in &found.parameters {
        items.push(statistics(parameter));
    }
    chapters.push(Chapter {
        id: "statistics".into(),
        title: "Statistics by parameter value".into(),
        items,
    });
    chapters
}

/// Maximum number of values side by side in a table.
const ABREAST: usize = 9;

fn statistics(parameter: &Varied) -> Item {
    let values: Vec<&AtValue> = parameter.values.iter().take(ABREAST).collect();
    let mut head = vec![Head::text("Quantity"), Head::short("Statistic")];
    head.extend(values.iter().map(|at| Head::number(&at.value)));
    let first = values.iter().find(|at| !at.statistics.is_empty());
    let rows = first.map_or(&[][..], |at| &at.statistics).iter().map(|one| {
        let mut row = vec![one.symbol.clone(), format!("{}{}", one.name, one.scope.suffix())];
        row.extend(values.iter().map(|at| {
            let same = at.statistics.iter().find(|other| {
                other.id == one.id && other.name == one.name && other.scope == one.scope
            });
            same.and_then(|other| other.normalised)
                .map_or_else(|| number::NONE.to_owned(), |value| number::beside(value, 1.0, 3))
        }));
        row
    });
    let more = if parameter.values.len() > ABREAST {
        "; further values are in the tables beside this report"
    } else {
        ""
    };
    Item::Table {
        table: Table {
            caption: format!(
                "{}: statistics of all sections divided by their limits{more}",
                parameter.title
            ),
            head,
            rows: rows.collect(),
        },
    }
}
