//! Checks domains: what spans them, and by what sections are told apart.

use super::prelude::*;

impl Checker<'_> {
    /// What sections cover: what spans it, and by what words sections are told apart.
    pub fn domain(&mut self, block: &Block) -> Option<Domain> {
        let field = self.required(block, "over")?;
        let written = from_pest::domain(&field.value, self.problems)?;
        let over = all(written.over.iter().map(|(of, unit)| self.coordinate(of, unit.as_ref())));
        let mut each = all(written.each.iter().map(|key| self.domain_key(key)))?;
        each.dedup();
        let otherwise = self.on_fault(block, "otherwise", &["note", "not assessable"])?;
        Some(Domain {
            name: block.own_name(),
            title: block.title_in_words(),
            over: over?,
            each,
            otherwise,
            clause: block.text("clause"),
            source: block.text("source"),
            notes: block.notes(),
            span: block.place(),
        })
    }

    fn coordinate(&mut self, of: &Phrase, unit: Option<&At<String>>) -> Option<Coordinate> {
        let expr = self.expr(of, &mut Scope::section())?;
        let dimension = self.number_type(&expr)?;
        let words = of.words();
        self.of_wanted_operation(&expr, &words)?;
        let unit = match unit {
            Some(unit) => {
                let found = self.unit(&unit.to_text())?;
                if found.dimension != dimension {
                    return self.refuse(problem!(
                        "unit-mismatch",
                        unit,
                        "`{words}` is {}, `{}` is a unit of {}",
                        dimension.in_words(),
                        unit.place().text(),
                        found.dimension.in_words()
                    ));
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

    /// What spans a domain differs from section to section, and is known of operation that nobody
    /// has run yet.
    fn of_wanted_operation(&mut self, expr: &Expr, words: &str) -> Option<()> {
        let column = expr.any(&|part| matches!(part.kind, Kind::Column(_)));
        let extent = expr.any(&|part| matches!(part.kind, Kind::Start | Kind::End));
        let says = match (column, extent) {
            (true, false) => return Some(()),
            (_, true) => format!(
                "`{words}` depends on where a section begins or ends, which wanted operation does not have"
            ),
            (false, false) => format!("`{words}` is the same for every section"),
        };
        self.refuse(
            error("domain-over", says, expr)
                .help("let it be section data, or an expression of them"),
        )
    }

    /// A section column of words.
    fn domain_key(&mut self, key: &At<String>) -> Option<usize> {
        let name = &key.node;
        let index = self.column_called("column", name, key)?;
        if matches!(self.names.columns[index].kind, DatumKind::Number(_)) {
            return self.refuse(
                problem!(
                    "not-a-word",
                    key,
                    "`{name}` is a number, and groups are told apart by words"
                )
                .help("let it be one of those that span the domain"),
            );
        }
        Some(index)
    }
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
