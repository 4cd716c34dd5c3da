//! Checks weights, and numbers of several groups: `mean weighted by length`, `mean of (mean for
//! each zone)`.

use super::Checker;
use super::estimates::{has_weights, reducer_name};
use super::plan::{Expr, Kind, Origin, Scalar, Taking, Type};
use super::scope::{Group, Scope};
use crate::problem::Problem;
use crate::source::Span;
use crate::syntax::document::Text;
use crate::syntax::phrase::{At, Node, Phrase};

impl Checker<'_> {
    /// `mean weighted by length`, `share weighted by length where value <= 60 kN`.
    pub(super) fn weighted(
        &mut self,
        of: &Phrase,
        by: &Phrase,
        text: &Text,
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
            self.problems.push(Problem::error("no-group", says).at(span).help(help));
            return None;
        }
        let name = match &of.node {
            Node::Share { of_sections, condition } => {
                return self.group_share(*of_sections, condition, Some(by), text, span, scope);
            }
            Node::Path(_) | Node::Percentile(_) => reducer_name(of),
            _ => return self.no_weight("this", span),
        };
        if self.names.estimates.contains_key(&name) {
            let says =
                format!("`{name}` is an estimate; only the statistics in it can be weighted");
            let help = "write them there: `mean weighted by length + 3 * std weighted by length`";
            self.problems.push(Problem::error("no-weight", says).at(span).help(help));
            return None;
        }
        if name == "n" {
            return self.no_weight("`n`", span);
        }
        let Some(dimension) = scope.group.as_ref().and_then(|group| group.values) else {
            return self.no_values(span);
        };
        let statistic = self.statistic(&At { node: name, range: of.range.clone() }, text)?;
        if !has_weights(statistic) {
            return self.no_weight(&format!("`{}`", statistic.name()), span);
        }
        let by = self.weight(by, text, scope)?;
        let ddof = self.ddof;
        let kind = scope.group.as_mut()?.take(Taking::Weighted { statistic, ddof, by });
        Some(Expr { kind, ty: Type::Number(dimension), span: span.clone() })
    }

    /// A number from the data of a section.
    pub(super) fn weight(&mut self, by: &Phrase, text: &Text, scope: &Scope) -> Option<Expr> {
        let by =
            self.expr(by, text, &mut Scope { zone: scope.zone.clone(), ..Scope::section() })?;
        self.number_type(&by)?;
        match by.kind {
            Kind::Constant(Scalar::Number(weight)) if weight <= 0.0 => {
                self.problems.push(
                    Problem::error("out-of-range", "a weight must be above zero").at(&by.span),
                );
                None
            }
            _ => Some(by),
        }
    }

    pub(super) fn no_weight(&mut self, what: &str, span: &Span) -> Option<Expr> {
        let problem =
            Problem::error("no-weight", format!("{what} does not depend on weights")).at(span);
        self.problems.push(
            problem.help("`mean`, `std`, `rms`, `median`, `p80` and `share` can be weighted"),
        );
        None
    }

    /// `mean of (mean for each zone)`: of one number for each group of the rows.
    pub(super) fn of_each_group(
        &mut self,
        reducer: &Phrase,
        one: &Phrase,
        keys: &[At<String>],
        text: &Text,
        span: &Origin,
        scope: &mut Scope,
    ) -> Option<Expr> {
        let Some(group) = &scope.group else {
            let says = "groups need the values of a quantity, which are not available here";
            let help = "they are used in a limit or an estimate: `limit (mean of (mean for each zone)) 9 kN`";
            self.problems.push(Problem::error("no-group", says).at(span).help(help));
            return None;
        };
        let Some(values) = group.values else { return self.no_values(span) };
        let reducer = self.group_reducer(reducer, "numbers of groups", text);
        let keys: Option<Vec<_>> = keys.iter().map(|key| self.group_key(key, text)).collect();
        let mut inside = Scope {
            zone: scope.zone.clone(),
            group: Some(Group { values: Some(values), taken: Vec::new() }),
            ..Scope::vehicle()
        };
        let expr = self.expr(one, text, &mut inside)?;
        let dimension = self.number_type(&expr)?;
        let taken = inside.group.map_or_else(Vec::new, |group| group.taken);
        if taken.is_empty() {
            let problem = Problem::error(
                "estimate-of-nothing",
                "this expression uses no statistic of the values",
            )
            .at(&expr.span);
            self.problems.push(problem.help("for instance `mean of (mean for each zone)`"));
            return None;
        }
        let of = Box::new(super::plan::OfGroup { expr, taken });
        let kind =
            scope.group.as_mut()?.take(Taking::EachGroup { reducer: reducer?, keys: keys?, of });
        Some(Expr { kind, ty: Type::Number(dimension), span: span.clone() })
    }

    /// `(mean for each zone)` where one number is needed.
    pub(super) fn many_numbers(
        &mut self,
        keys: &[At<String>],
        text: &Text,
        span: &Origin,
    ) -> Option<Expr> {
        let keys: Vec<&str> =
            keys.iter().filter_map(|key| text.text.get(key.range.clone())).collect();
        let keys = keys.join(" and ");
        let problem = Problem::error(
            "many-numbers",
            format!("this gives a number for each {keys}, but one number is needed"),
        )
        .at(span);
        self.problems.push(problem.help(format!(
            "take one number of them: `mean of (... for each {keys})`; a limit for each group has `for each {keys}` at its end"
        )));
        None
    }
}
