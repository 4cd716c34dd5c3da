//! Checks tables in expressions: `table radius: (300 m, 1.2), (600 m, 1)`.

use super::prelude::*;

impl Checker<'_> {
    /// A table of constant points, linear between them.
    pub fn table(
        &mut self,
        of: &Phrase,
        points: &[(Phrase, Phrase)],
        held: bool,
        span: Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let of = self.expr(of, scope)?;
        let over = self.number_type(&of)?;
        let mut found: Vec<(f64, f64)> = Vec::new();
        let mut gives: Option<Dimension> = None;
        for (at, (x, y)) in points.iter().enumerate() {
            let ((x_value, of_x), (y_value, of_y)) =
                (self.constant_phrase(x)?, self.constant_phrase(y)?);
            if of_x != over {
                let says = format!(
                    "the table is over {}, this point is {}",
                    over.in_words(),
                    of_x.in_words()
                );
                let problem = error("unit-mismatch", says, x);
                return self.refuse(problem.also(&of, over.in_words()));
            }
            let wanted = *gives.get_or_insert(of_y);
            if of_y != wanted {
                let says = format!(
                    "the table gives {}, this value is {}",
                    wanted.in_words(),
                    of_y.in_words()
                );
                let problem = error("unit-mismatch", says, y);
                return self.refuse(problem.also(&points[0].1, wanted.in_words()));
            }
            if found.last().is_some_and(|(before, _)| *before >= x_value) {
                let says = "the points of a table stand in ascending order";
                let problem = error("table-order", says, x);
                return self.refuse(problem.also(&points[at - 1].0, "the point before"));
            }
            found.push((x_value, y_value));
        }
        let ty = of.ty.of_dimension(gives?);
        let mapping = Mapping::Table(Table { points: found, held });
        self.folded(Expr { kind: Kind::Mapped(Box::new(of), mapping), ty, span }, scope)
    }
}
