//! Columns of the section table that the catalogue names, with values in the words of the protocol.

use crate::certify::Compiled;
use crate::data::Campaign;
use crate::diagnose::settings::Settings;
use crate::problem::{Problem, Problems};
use crate::simulate::Section;

/// Replaces values by the words that the protocol declares for the column: a zone `1.0` is zone 1.
///
/// Problems, all of them warnings: `unknown-column` for a column that is not in the table,
/// `section-data` for a value that is not declared in the protocol.
pub fn in_words_of(
    compiled: &Compiled,
    settings: &Settings,
    campaign: &Campaign,
    sections: &mut [Section],
    problems: &mut Problems,
) {
    let Some(table) = &campaign.sections else { return };
    let mut done: Vec<&str> = Vec::new();
    for (column, named) in &settings.columns {
        if column == "section" || done.contains(&column.as_str()) {
            continue;
        }
        done.push(column);
        let Some(at) = table.column(column) else {
            let says = format!(
                "the section table has no column `{column}`; it is not used to distinguish sections"
            );
            let known = table.columns.iter().map(|heading| heading.name.as_str());
            problems
                .push(Problem::warning("unknown-column", says).at(named).suggest(column, known));
            continue;
        };
        for section in sections.iter_mut() {
            let cell = table.row_named(section.name()).and_then(|row| table.cell(row, at));
            let (Some(cell), Some(fact)) = (cell, section.facts.get_mut(at)) else { continue };
            match compiled.word(column, &fact.text) {
                None => {}
                Some(Ok(word)) => fact.text = word,
                Some(Err(says)) => {
                    let problem = Problem::warning("section-data", format!("`{column}`: {says}"))
                        .at(&cell.span);
                    problems.push(problem.help("the protocol does not use this section; the diagnosis treats it as a separate kind"));
                }
            }
        }
    }
}
