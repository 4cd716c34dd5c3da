//! The sections that are imported: a table, or a list of names.

use std::path::Path;
use std::sync::Arc;

use super::reader::{Reader, at, metre, placeholders};
use crate::data::RecordKind;
use crate::data::Table;
use crate::data::table::Cell;
use crate::data::text::read_text;
use crate::problem::{Problem, Problems};
use crate::source::{Source, Span, Spanned};
use crate::yaml::{Node, Value};

/// The column that names the sections.
const NAME: &str = "section";

#[derive(Clone, Debug)]
pub struct Sections {
    /// The path as written and the table; absent for a list of names.
    pub table: Option<(Spanned<String>, Arc<Table>)>,
    pub names: Vec<Cell>,
    pub span: Span,
    /// What one of them is called: `section`, or `run` where whole runs are imported.
    pub word: &'static str,
}

impl Sections {
    pub(super) fn none(source: &Arc<Source>) -> Self {
        Self { table: None, names: Vec::new(), span: source.span(0..0), word: NAME }
    }

    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.table
            .iter()
            .flat_map(|(_, table)| table.columns.iter().map(|column| column.name.as_str()))
    }

    /// Placeholders of a path must be known: `{section}`, of runs `{run}`, or a column of the table
    /// of sections.
    pub(super) fn check_placeholders(&self, written: &Spanned<String>, reader: &mut Reader<'_>) {
        for name in placeholders(&written.value) {
            if name != self.word && !self.has_column(name) {
                let says = match self.word {
                    "run" => format!("`{{{name}}}` is not `{{run}}`"),
                    word => format!(
                        "`{{{name}}}` is neither `{{{word}}}` nor a column of the table of sections"
                    ),
                };
                let problem = Problem::error("unknown-placeholder", says);
                let known = std::iter::once(self.word).chain(self.columns());
                reader.problems.push(problem.at(&written.span).suggest(name, known));
            }
        }
    }

    pub fn has_column(&self, name: &str) -> bool {
        self.columns().any(|known| known == name)
    }

    /// The cell of a section in a column.
    pub fn cell(&self, section: &str, column: &str) -> Option<&Cell> {
        let (_, table) = self.table.as_ref()?;
        table.cell(table.row_named(section)?, table.column(column)?)
    }

    /// The number of a section in a column, in SI.
    ///
    /// # Errors
    /// Of the column; the cell is empty.
    pub fn number(&self, section: &str, column: &str) -> Result<f64, Problem> {
        let (_, table) = self.table.as_ref().ok_or_else(|| {
            Problem::error("no-sections", "there is no table of sections").at(&self.span)
        })?;
        let numbers = table
            .numbers(table.need_column(column)?, Some(metre().dimension))
            .map_err(|mut problems| problems.swap_remove(0))?;
        let row = table.row_named(section);
        row.and_then(|row| numbers.get(row).copied().flatten()).ok_or_else(|| {
            let place = self.cell(section, column).map_or(&self.span, |cell| &cell.span);
            Problem::error("not-a-number", format!("{} `{section}` has no `{column}`", self.word))
                .at(place)
        })
    }

    /// Start and end of a section in m, if the table states them.
    pub fn extent(&self, section: &str) -> Option<(f64, f64)> {
        Some((self.number(section, "start").ok()?, self.number(section, "end").ok()?))
    }

    /// A text with `{section}` (of runs `{run}`) and `{column}` replaced.
    pub fn fill(&self, pattern: &str, section: &str) -> String {
        let mut out = String::new();
        let mut rest = pattern;
        while let Some((before, after)) = rest.split_once('{') {
            out.push_str(before);
            let Some((name, after)) = after.split_once('}') else {
                out.push('{');
                rest = after;
                continue;
            };
            out.push_str(if name == self.word {
                section
            } else {
                self.cell(section, name).map_or("", |cell| cell.value.as_str())
            });
            rest = after;
        }
        out + rest
    }
}

pub(super) fn read(reader: &mut Reader<'_>, tree: &Node, folder: &Path) -> Option<Sections> {
    let Some(node) = tree.get("sections") else {
        let problem = Problem::error(
            "key-missing",
            "`sections` is missing: the table of sections, or their names",
        )
        .at(&tree.span.part(0..0));
        reader.problems.push(problem.help("write `sections: sections.csv`, or `sections: [S01, S02]` where whole records are evaluated"));
        return None;
    };
    if let Value::List(items) = &node.value {
        let names: Vec<Cell> =
            items.iter().filter_map(|item| reader.text_of(item, "sections")).collect();
        let before = reader.problems.errors();
        for (number, name) in names.iter().enumerate() {
            if let Some(first) = names[..number].iter().find(|first| first.value == name.value) {
                let problem = Problem::error(
                    "duplicate-name",
                    format!("two sections are called `{}`", name.value),
                )
                .at(&name.span);
                reader.problems.push(problem.also(&first.span, "the first of them"));
            }
        }
        check(reader.problems, &names);
        return (reader.problems.errors() == before).then_some(Sections {
            table: None,
            names,
            span: node.span.clone(),
            word: NAME,
        });
    }
    let written = reader.text_of(node, "sections")?;
    let path = folder.join(&written.value);
    let shown = path.display().to_string();
    if let Err(problem) = read_text(&path, &shown) {
        reader.problems.push(at(problem, &written.span));
        return None;
    }
    let table = Table::read(&path, &shown, Some(NAME), reader.problems)?;
    let names: Vec<Cell> = table.names().cloned().collect();
    let before = reader.problems.errors();
    check(reader.problems, &names);
    (reader.problems.errors() == before).then(|| Sections {
        span: written.span.clone(),
        table: Some((written, Arc::new(table))),
        names,
        word: NAME,
    })
}

/// Names become names of files.
pub(super) fn check(problems: &mut Problems, names: &[Cell]) {
    for name in names {
        let bad = name.value.contains(['/', '\\', ':'])
            || name.value.starts_with('.')
            || name.value.chars().any(char::is_control);
        if bad || name.value.is_empty() || name.value.len() > 200 {
            let says = format!(
                "`{}` becomes the name of a file and must not contain `/`, `\\` or `:` or begin with a point",
                name.value
            );
            problems.push(Problem::error("path-outside", says).at(&name.span));
        }
    }
}

/// A section that the mapping names must exist.
pub(super) fn known(reader: &mut Reader<'_>, sections: &Sections, name: &str, span: &Span) {
    if !sections.names.is_empty() && !sections.names.iter().any(|known| known.value == name) {
        let problem =
            Problem::error("unknown-section", format!("there is no {} `{name}`", sections.word))
                .at(span);
        reader
            .problems
            .push(problem.suggest(name, sections.names.iter().map(|known| known.value.as_str())));
    }
}

/// The record of a section in the campaign.
pub fn record_path(kind: RecordKind, section: &str, ending: &str) -> String {
    format!("{}/{section}.{ending}", kind.key())
}
