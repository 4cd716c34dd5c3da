//! Checks domains: what spans them, and by what sections are told apart.

use super::Checker;
use super::names::normalised;
use super::plan::{Coordinate, DatumKind, Domain, Expr, Kind, OnFault};
use super::scope::Scope;
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::{Block, Field, Text};
use crate::syntax::from_pest;
use crate::syntax::phrase::{At, Phrase};
use crate::units::Dimension;

impl Checker<'_> {
    pub(super) fn domain(&mut self, block: &Block) -> Option<Domain> {
        let field = self.required(block, "over")?;
        let written = from_pest::domain(&field.value, self.problems)?;
        let over: Vec<Option<Coordinate>> = written
            .over
            .iter()
            .map(|(of, unit)| self.coordinate(of, unit.as_ref(), field))
            .collect();
        let each: Vec<Option<usize>> = written
            .each
            .iter()
            .map(|key| self.domain_key(&key.node, &field.value.place(key.range.clone())))
            .collect();
        let over = over.into_iter().collect::<Option<Vec<_>>>();
        let mut each = each.into_iter().collect::<Option<Vec<_>>>()?;
        each.dedup();
        let otherwise = match block.field("otherwise") {
            Some(_) => self.on_fault(block, "otherwise", &["note", "not assessable"])?,
            None => OnFault::Note,
        };
        let text = |key: &str| block.field(key).map(|field| field.value.text.clone());
        Some(Domain {
            name: block.name_text().to_string(),
            title: block
                .title
                .as_ref()
                .map_or_else(|| block.name_text().replace('_', " "), |title| title.text.clone()),
            over: over?,
            each,
            otherwise,
            clause: text("clause"),
            source: text("source"),
            notes: block.fields_named("note").map(|note| note.value.text.clone()).collect(),
            span: block.span().clone(),
        })
    }

    fn coordinate(
        &mut self,
        of: &Phrase,
        unit: Option<&At<String>>,
        field: &Field,
    ) -> Option<Coordinate> {
        let expr = self.expr(of, &field.value, &mut Scope::section())?;
        let dimension = self.number_type(&expr)?;
        let words = normalised(&field.value.text[of.range.clone()]);
        self.of_wanted_operation(&expr, &words)?;
        let unit = match unit {
            Some(unit) => {
                let at = field.value.place(unit.range.clone());
                let found = self.unit(&Text {
                    text: unit.node.clone(),
                    span: at.clone(),
                    exact: field.value.exact,
                })?;
                if found.dimension != dimension {
                    self.unit_of_other_dimension(&words, dimension, found.dimension, &at);
                    return None;
                }
                found
            }
            None => {
                self.datum_unit(&expr, dimension).unwrap_or_else(|| self.own_unit("", dimension))
            }
        };
        let name = match &expr.kind {
            Kind::Column(index) => self.names.columns[*index].title.clone(),
            _ => capital(&words.replace('_', " ")),
        };
        Some(Coordinate { expr, name, unit })
    }

    fn unit_of_other_dimension(
        &mut self,
        words: &str,
        dimension: Dimension,
        found: Dimension,
        at: &Span,
    ) {
        let says = format!(
            "`{words}` is {}, `{}` is a unit of {}",
            dimension.in_words(),
            at.text(),
            found.in_words()
        );
        self.problems.push(Problem::error("unit-mismatch", says).at(at));
    }

    /// What spans a domain differs from section to section, and is known of operation that nobody
    /// has run yet.
    fn of_wanted_operation(&mut self, expr: &Expr, words: &str) -> Option<()> {
        let (mut column, mut extent) = (false, false);
        expr.visit(&mut |part| {
            column |= matches!(part.kind, Kind::Column(_));
            extent |= matches!(part.kind, Kind::Start | Kind::End);
        });
        let says = match (column, extent) {
            (true, false) => return Some(()),
            (_, true) => format!(
                "`{words}` depends on where a section begins or ends, which wanted operation does not have"
            ),
            (false, false) => format!("`{words}` is the same for every section"),
        };
        self.problems.push(
            Problem::error("domain-over", says)
                .at(&expr.span)
                .help("let it be section data, or an expression of them"),
        );
        None
    }

    /// A section column of words.
    fn domain_key(&mut self, name: &str, at: &Span) -> Option<usize> {
        let found = self.names.columns.iter().position(|datum| datum.name == name);
        let is_number =
            |index: usize| matches!(self.names.columns[index].kind, DatumKind::Number(_));
        match found {
            Some(index) if is_number(index) => {
                let says = format!("`{name}` is a number, and groups are told apart by words");
                self.problems.push(
                    Problem::error("not-a-word", says)
                        .at(at)
                        .help("let it be one of those that span the domain"),
                );
                None
            }
            Some(index) => Some(index),
            None => {
                let known: Vec<String> =
                    self.names.columns.iter().map(|datum| datum.name.clone()).collect();
                let problem =
                    Problem::error("unknown-name", format!("no section column is called `{name}`"))
                        .at(at);
                self.problems.push(problem.suggest(name, known.iter().map(String::as_str)));
                None
            }
        }
    }
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
