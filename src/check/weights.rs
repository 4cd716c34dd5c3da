//! Checks weights, and numbers of several groups: `mean weighted by length`, `mean of (mean for
//! each zone)`.

use super::{
    estimates::{has_weights, reducer_name},
    prelude::*,
};

impl Checker<'_> {
    /// `mean weighted by length`, `share weighted by length where value <= 60 kN`.
    pub fn weighted(
        &mut self,
        of: &Phrase,
        by: &Phrase,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        if scope.group.is_none() {
            let says = "weights need the values of a group, which are not available here";
            let help = if scope.value.is_some() {
                "the weight stands before the condition: `share weighted by length where value <= 60 kN`"
            } else {
                "weights are used in a limit or an estimate: `limit mean weighted by length 9 kN`"
            };
            return self.refuse(error("no-group", says, span).help(help));
        }
        let name = match &of.node {
            Node::Share { counted, of_sections, condition } => {
                let of = (*counted, *of_sections);
                return self.group_share(of, condition, Some(by), span, scope);
            }
            Node::Path(_) | Node::Percentile(_) => reducer_name(of),
            _ => return self.no_weight("this", span),
        };
        if self.names.estimates.contains_key(&name) {
            let help = "write them there: `mean weighted by length + 3 * std weighted by length`";
            return self.refuse(
                problem!(
                    "no-weight",
                    span,
                    "`{name}` is an estimate; only the statistics in it can be weighted"
                )
                .help(help),
            );
        }
        if name == "n" {
            return self.no_weight("`n`", span);
        }
        let Some(dimension) = scope.values() else { return self.no_values(span) };
        let statistic = self.statistic(&of.with(name))?;
        if !has_weights(statistic) {
            return self.no_weight(&format!("`{}`", statistic.name()), span);
        }
        let by = self.weight(by, scope)?;
        let ddof = self.ddof;
        scope.take(Taking::Weighted { statistic, ddof, by }, dimension, span)
    }

    /// A number from the data of a section.
    pub fn weight(&mut self, by: &Phrase, scope: &Scope) -> Option<Expr> {
        let by = self.expr(by, &mut scope.of_section())?;
        self.number_type(&by)?;
        match by.kind {
            Kind::Constant(Scalar::Number(weight)) if weight <= 0.0 => {
                self.refuse(error("out-of-range", "a weight must be above zero", &by.span))
            }
            _ => Some(by),
        }
    }

    /// Reports what does not depend on weights.
    pub fn no_weight(&mut self, what: &str, span: &Span) -> Option<Expr> {
        self.refuse(
            problem!("no-weight", span, "{what} does not depend on weights")
                .help("`mean`, `std`, `rms`, `median`, `p80` and `share` can be weighted"),
        )
    }

    /// `mean of (mean for each zone)`: of one number for each group of the rows.
    pub fn of_each_group(
        &mut self,
        reducer: &Phrase,
        one: &Phrase,
        keys: &[At<String>],
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        if scope.group.is_none() {
            let says = "groups need the values of a quantity, which are not available here";
            let help = "they are used in a limit or an estimate: `limit (mean of (mean for each zone)) 9 kN`";
            return self.refuse(error("no-group", says, span).help(help));
        }
        let values = scope.values();
        if values.is_none() {
            return self.no_values(span);
        }
        let reducer = self.group_reducer(reducer, "numbers of groups");
        let keys: Option<Vec<_>> = keys.iter().map(|key| self.group_key(key)).collect();
        let of = self.of_group(one, values, scope)?;
        let says = "this expression uses no statistic of the values";
        let of = self.of_something(of, says, "for instance `mean of (mean for each zone)`")?;
        let dimension = of.expr.dimension();
        let taking = Taking::EachGroup { reducer: reducer?, keys: keys?, of: Box::new(of) };
        scope.take(taking, dimension, span)
    }

    /// `(mean for each zone)` where one number is needed.
    pub fn many_numbers(&mut self, keys: &[At<String>], span: &Origin) -> Option<Expr> {
        let keys = keys.iter().map(At::words).collect::<Vec<_>>().join(" and ");
        self.refuse(problem!("many-numbers", span, "this gives a number for each {keys}, but one number is needed").help(format!(
            "take one number of them: `mean of (... for each {keys})`; a limit for each group has `for each {keys}` at its end"
        )))
    }
}
