//! The sections that are imported: a table, or a list of names.

use std::sync::Arc;

use super::Paths;
use crate::data::table::Cell;
use crate::data::{RecordKind, Table, check_file_name};
use crate::problem::{Problem, Problems, error};
use crate::source::{Source, Span, Spanned};
use crate::units::Dimension;
use crate::yaml::{FromNode, Node, Reader, Value};

/// The column that names the sections.
pub const NAME: &str = "section";

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
        let (_, table) = self
            .table
            .as_ref()
            .ok_or_else(|| error("no-sections", "there is no table of sections", &self.span))?;
        let numbers = table
            .numbers_named(column, Some(Dimension::LENGTH))
            .map_err(|mut problems| problems.swap_remove(0))?;
        let row = table.row_named(section);
        row.and_then(|row| numbers.get(row).copied().flatten()).ok_or_else(|| {
            let place = self.cell(section, column).map_or(&self.span, |cell| &cell.span);
            error("not-a-number", format!("{} `{section}` has no `{column}`", self.word), place)
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

/// The table of sections, or a list of their names.
pub fn read(reader: &mut Reader<'_>, tree: &Node, paths: &Paths) -> Option<Sections> {
    let Some((key, node)) = tree.entry("sections") else {
        let says = "`sections` is missing: the table of sections, or their names";
        let problem = error("key-missing", says, &tree.span.part(0..0));
        reader.tell(problem.help("write `sections: sections.csv`, or `sections: [S01, S02]` where whole records are evaluated"));
        return None;
    };
    let before = reader.problems.errors();
    let (table, names, span) = if matches!(node.value, Value::List(_)) {
        let names: Vec<Cell> = Vec::from_node(reader, key, node)?;
        (None, names, node.span.clone())
    } else {
        let written: Spanned<String> = Spanned::from_node(reader, key, node)?;
        let (text, sha256) = reader.keep(paths.read_text(&written))?;
        let table = Table::parse(text, sha256, Some(NAME), reader.problems)?;
        let names = table.names().cloned().collect();
        let span = written.span.clone();
        (Some((written, Arc::new(table))), names, span)
    };
    check_names(reader.problems, &names, NAME);
    (reader.problems.errors() == before).then_some(Sections { table, names, span, word: NAME })
}

/// Names are different, and become names of files.
pub fn check_names(problems: &mut Problems, names: &[Cell], word: &str) {
    for (number, name) in names.iter().enumerate() {
        if let Some(first) = names[..number].iter().find(|first| first.value == name.value) {
            let says = format!("two {word}s are called `{}`", name.value);
            let problem = error("duplicate-name", says, &name.span);
            problems.push(problem.also(&first.span, "the first of them"));
        }
        if let Err(problem) = check_file_name(&name.value, &name.span) {
            problems.push(problem);
        }
    }
}

/// Placeholders of a path must be known: `{section}`, of runs `{run}`, or a column of the table of
/// sections.
pub fn check_placeholders(reader: &mut Reader<'_, &Sections>, written: &Spanned<String>) {
    let sections = reader.with;
    let word = sections.word;
    let names = written.value.split('{').skip(1).filter_map(|rest| rest.split_once('}'));
    for (name, _) in names.filter(|(name, _)| *name != word && !sections.has_column(name)) {
        let says = match word {
            "run" => format!("`{{{name}}}` is not `{{run}}`"),
            word => format!(
                "`{{{name}}}` is neither `{{{word}}}` nor a column of the table of sections"
            ),
        };
        let problem = error("unknown-placeholder", says, &written.span);
        let known = std::iter::once(word).chain(sections.columns());
        reader.tell(problem.suggest(name, known));
    }
}

/// A column that the mapping names must exist.
pub fn check_column(reader: &mut Reader<'_, &Sections>, name: &str, span: &Span) {
    if !reader.with.has_column(name) {
        let says = format!("the table of sections has no column `{name}`");
        let problem = error("unknown-column", says, span);
        reader.tell(problem.suggest(name, reader.with.columns()));
    }
}

/// A section that the mapping names must exist.
pub fn known(reader: &mut Reader<'_, &Sections>, name: &str, span: &Span) {
    let Sections { names, word, .. } = reader.with;
    if !names.is_empty() && !names.iter().any(|known| known.value == name) {
        let problem = error("unknown-section", format!("there is no {word} `{name}`"), span);
        let names = names.iter().map(|known| known.value.as_str());
        reader.tell(problem.suggest(name, names));
    }
}

/// The record of a section in the campaign.
pub fn record_path(kind: RecordKind, section: &str, ending: &str) -> String {
    format!("{}/{section}.{ending}", kind.key())
}
