//! Text of the study of parameters.

use super::{scoped, share_with};
use crate::report::{document::*, number, sides::capital, view::Opening};
use crate::result::{
    VerdictWords,
    study::{AtValue, ParameterStudy, Varied},
};

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
        .map(|(name, value)| Fact::new(name, value))
        .to_vec(),
    }
}

/// A ratio of a value and its limit, with enough decimals to compare with 1.
const RATIO: Format = Format::Beside { limit: 1.0, decimals: 3 };

pub fn chapters(found: &ParameterStudy, words: &VerdictWords) -> Vec<Chapter> {
    let good = &words.good;
    let row = |parameter: &Varied, at: &AtValue| {
        let largest = at.largest.as_ref();
        vec![
            Cell::from(&parameter.name),
            if at.is_base { format!("{} (baseline)", at.value).into() } else { (&at.value).into() },
            words.word(at.verdict).into(),
            Cell::number(largest.map(|largest| largest.normalised), RATIO),
            largest.map_or(Cell::BLANK, |largest| (&largest.statistic).into()),
            at.share
                .map_or_else(|| (&at.reason).into(), |share| share_with(share, at.interval).into()),
        ]
    };
    let rows = found
        .parameters
        .iter()
        .flat_map(|parameter| parameter.values.iter().map(move |at| row(parameter, at)));
    let about = "Each parameter is varied individually; all others keep their baseline values. In the figure, baseline values and the parameters that affect the verdict are printed in bold.";
    let figure = Figure::new(
        "choices",
        format!(
            "Largest statistic divided by its limit for each value, and the share of selections with the verdict '{good}'"
        ),
        "For every value of every parameter the largest normalised statistic; the numbers are in the table.",
        200,
    );
    let caption = format!(
        "Verdict on all sections, largest statistic divided by its limit, and share of selections with the verdict '{good}'"
    );
    let table = Table::new(caption)
        .text("Parameter")
        .breaks(NAME)
        .text("Value")
        .short("Verdict")
        .number("Largest ratio")
        .text("Statistic")
        .number(capital(good))
        .rows(rows);
    let blocks = vec![Block::text(about), figure.into(), table.into()];
    let statistics = found.parameters.iter().map(|parameter| statistics(parameter).into());
    vec![
        Chapter::new("choices", "Parameters that affect the verdict", blocks),
        Chapter::new("statistics", "Statistics by parameter value", statistics.collect()),
    ]
}

/// Letters of a name of a parameter that is not broken.
const NAME: usize = 12;
/// Maximum number of values side by side in a table.
const ABREAST: usize = 9;

fn statistics(parameter: &Varied) -> Table {
    let values: Vec<&AtValue> = parameter.values.iter().take(ABREAST).collect();
    let first = values.iter().find(|at| !at.statistics.is_empty());
    let rows = first.map_or(&[][..], |at| &at.statistics).iter().map(|one| {
        let mut row = cells![Cell::symbol(&one.symbol, ""), scoped(&one.name, &one.scope)];
        row.extend(values.iter().map(|at| {
            let same = at.statistics.iter().find(|other| {
                other.id == one.id && other.name == one.name && other.scope == one.scope
            });
            Cell::number(same.and_then(|other| other.normalised), RATIO)
        }));
        row
    });
    let more = if parameter.values.len() > ABREAST {
        "; further values are in the tables beside this report"
    } else {
        ""
    };
    let caption =
        format!("{}: statistics of all sections divided by their limits{more}", parameter.title);
    Table::new(caption)
        .text("Quantity")
        .short("Statistic")
        .numbers(values.iter().map(|at| &at.value))
        .rows(rows)
}
