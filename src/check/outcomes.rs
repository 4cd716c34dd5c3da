//! Checks outcomes in order, of quantities and of verdicts.

use super::{plan::Scope as LimitScope, prelude::*};
use crate::result::{Direction, OUTCOME};
use crate::syntax::phrase::Outcome;

/// Words of a report for a verdict that cannot be given or is not given yet. No verdict may use
/// them.
pub const NEITHER: [&str; 2] = ["not assessable", "open"];
/// Words by which a passed verdict is known: one that is failed says none of them, unless it denies
/// it.
const PASSED: [&str; 11] = [
    "validated",
    "valid",
    "holds",
    "met",
    "accepted",
    "approved",
    "passed",
    "pass",
    "fulfilled",
    "satisfied",
    "agreement",
];
const DENIALS: [&str; 5] = ["not", "no", "never", "without", "nothing"];

impl Checker<'_> {
    /// Outcomes of a quantity or a verdict: those that hold first, each word once, the last one for
    /// all that is left.
    pub fn outcomes_in_order(&mut self, fields: &[Field], written: &[(At<String>, bool, bool)]) {
        if fields.len() != written.len() {
            return;
        }
        for (at, ((word, holds, ruled), field)) in written.iter().zip(fields).enumerate() {
            let last = at + 1 == written.len();
            if written[..at].iter().any(|(known, ..)| known.node == word.node) {
                self.tell(problem!("duplicate-name", word, "`{}` is an outcome twice", word.node));
            }
            if *ruled == last {
                let says = match last {
                    true => "the last outcome is that of all other cases and has no rule",
                    false => "this outcome has no rule, so that none behind it can apply",
                };
                self.tell(error("outcome-order", says, field));
            }
            if *holds && written[..at].iter().any(|(_, before, _)| !before) {
                let says = "an outcome that holds stands behind one that fails";
                let help = "write the best outcome first";
                self.tell(error("outcome-order", says, field).help(help));
            }
            let passed = written.iter().filter(|(_, holds, _)| *holds);
            let good = passed.map(|(word, ..)| word.node.as_str());
            if !holds && good.into_iter().any(|good| says_passed(&word.node, good)) {
                let says = format!("`{}` reads as if the verdict held, and it fails", word.node);
                self.tell(error("verdict-words", says, word));
            }
            if NEITHER.contains(&word.node.as_str()) {
                let says =
                    format!("`{}` is reserved for a verdict that cannot be given", word.node);
                self.tell(error("verdict-words", says, word));
            }
        }
        let some = |wanted: bool| written.iter().any(|(_, holds, _)| *holds == wanted);
        if !(some(true) && some(false)) {
            let says = "of the outcomes at least one holds and at least one fails";
            self.tell(error("outcome-order", says, &fields[0]));
        }
    }

    /// The outcomes of a quantity: their words, and a limit of the number of the outcome that
    /// applies, up to the last one that holds. No outcomes without the field.
    pub fn outcomes_of(
        &mut self,
        block: &Block,
        values: Option<Dimension>,
    ) -> Option<(Vec<String>, Option<Limit>)> {
        let fields: Vec<Field> = block.fields_named("outcome").cloned().collect();
        let Some(first) = fields.first() else { return Some((Vec::new(), None)) };
        let written = fields.iter().map(|field| from_pest::outcome(&field.value, self.problems));
        let written = all(written.collect::<Vec<_>>())?;
        self.outcomes_in_order(&fields, &written.iter().map(bare).collect::<Vec<_>>());
        self.unconfirmed = self.values.open(block.name_text());
        let mut scope = Scope::vehicle().of_group(Some(values?));
        let number = |at: usize, span: &Origin| {
            let kind = Kind::Constant(Scalar::Number(1.0 + at as f64));
            Expr::number(kind, Dimension::ONE, span)
        };
        let whole = super::expressions::whole(&first.value);
        let mut arms = Vec::new();
        for (at, outcome) in written.iter().enumerate() {
            let Some(when) = &outcome.when else { continue };
            let condition = self.condition(when, &mut scope)?;
            arms.push((number(at, &condition.span), condition));
        }
        let last = number(written.len() - 1, &whole);
        let ty = Type::Number(Dimension::ONE);
        let kind = Kind::Cases(arms, Some(Box::new(last)));
        let expr = Expr { kind, ty, span: whole.clone() };
        let taken = scope.group.map_or_else(Vec::new, |group| group.taken);
        let of = self.of_something(
            OfGroup { expr, taken },
            "no outcome depends on the values",
            "for instance `outcome good: holds when mean <= 2`",
        )?;
        let words: Vec<String> = written.iter().map(|one| one.word.node.clone()).collect();
        let holding = written.iter().filter(|one| one.holds).count();
        let numbered = words.iter().enumerate().map(|(at, word)| format!("{} {word}", at + 1));
        let title = format!("outcome ({})", numbered.collect::<Vec<_>>().join(", "));
        let best = words.get(holding.checked_sub(1)?)?;
        let printed = format!("at most {holding} ({best})");
        let estimate = Estimate {
            name: OUTCOME.into(),
            title,
            kind: EstimateKind::Of(Box::new(of)),
            of_scatter: false,
            unit: Some(self.own_unit("", Dimension::ONE)),
        };
        let bound = OfGroup { expr: number(holding - 1, &whole), taken: Vec::new() };
        let limit = Limit {
            estimate,
            direction: Direction::AtMost,
            edge: false,
            bound,
            factors: Vec::new(),
            only_when: None,
            scope: LimitScope::default(),
            words: printed.clone(),
            printed,
            unconfirmed: self.unconfirmed,
            span: first.value.span.clone(),
        };
        Some((words, Some(limit)))
    }
}

/// The word of the best outcome and that of the worst.
pub fn ends(grades: &[Grade]) -> [String; 2] {
    let word = |grade: Option<&Grade>| grade.map_or_else(String::new, |grade| grade.word.clone());
    [word(grades.first()), word(grades.last())]
}

/// The word of an outcome, whether it holds, and whether it has a rule.
pub fn bare<T>(outcome: &Outcome<T>) -> (At<String>, bool, bool) {
    (outcome.word.clone(), outcome.holds, outcome.when.is_some())
}

/// The outcomes of a verdict as written.
pub fn outcomes_told(block: Option<&Block>) -> String {
    let fields = block.into_iter().flat_map(|block| block.fields_named("outcome"));
    fields.map(|field| normalised(&field.value.text)).collect::<Vec<_>>().join("; ")
}

/// Whether the word of a failed verdict has one of a passed verdict, its own or a usual one.
pub fn says_passed(bad: &str, good: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        text.to_lowercase()
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let (bad, good) = (words(bad), words(good));
    let passed = bad.windows(good.len().max(1)).any(|part| part == good)
        || bad.iter().any(|word| PASSED.contains(&word.as_str()));
    passed && !bad.iter().any(|word| DENIALS.contains(&word.as_str()))
}
