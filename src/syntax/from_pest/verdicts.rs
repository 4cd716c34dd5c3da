//! Rules of verdicts, and outcomes in order.

use super::{
    Parsed, Rule, parsed,
    tree::{either, sum, value},
};
use crate::problem::Problems;
use crate::syntax::{
    document::Text,
    phrase::{Needed, Node, Number, Outcome, OverVerdicts, Phrase, Verdict, normalised},
};

pub fn verdict(text: &Text, problems: &mut Problems) -> Option<Verdict> {
    verdict_rule(parsed(Rule::verdict, text, problems)?.next()?)
}

/// An outcome of a quantity: `good: holds when mean <= 2`.
pub fn outcome(text: &Text, problems: &mut Problems) -> Option<Outcome<Phrase>> {
    outcome_when(parsed(Rule::outcome, text, problems)?, either)
}

/// An outcome of a verdict: `restricted: holds when at least 11 quantities hold`.
pub fn outcome_of_verdict(text: &Text, problems: &mut Problems) -> Option<Outcome<Verdict>> {
    outcome_when(parsed(Rule::outcome_of_verdict, text, problems)?, verdict_rule)
}

fn outcome_when<T>(mut inner: Parsed, when: fn(Parsed) -> Option<T>) -> Option<Outcome<T>> {
    let word = inner.next()?;
    let word = word.at(normalised(word.written().trim().trim_matches('"')));
    let holds = inner.next()?.rule == Rule::outcome_holds;
    let when = match inner.next() {
        Some(rule) => Some(when(rule)?),
        None => None,
    };
    Some(Outcome { word, holds, when })
}

fn verdict_rule(inner: Parsed) -> Option<Verdict> {
    if inner.rule == Rule::some_verdict {
        return Some(Verdict::Over(over_verdicts(inner)?));
    }
    let (mut needed, mut draws) = (None, None);
    let mut count = None;
    for mut part in inner {
        match part.rule {
            Rule::sum => count = Some(sum(part)?),
            Rule::of_quantities | Rule::of_limits => {
                let of_limits = part.rule == Rule::of_limits;
                needed = Some(Needed { count: count.take()?, of_limits });
            }
            Rule::in_draws => draws = Some(value(part.next()?)?),
            _ => {}
        }
    }
    Some(Verdict::Limits { needed, draws })
}

fn over_verdicts(part: Parsed) -> Option<OverVerdicts> {
    let rule = part.rule;
    let mut inner = part.peekable();
    match rule {
        Rule::some_verdict | Rule::all_verdicts => {
            let mut all = inner.map(over_verdicts).collect::<Option<Vec<_>>>()?;
            match (all.len(), rule) {
                (1, _) => all.pop(),
                (_, Rule::some_verdict) => Some(OverVerdicts::Any(all)),
                _ => Some(OverVerdicts::All(all)),
            }
        }
        Rule::one_verdict => {
            let not = inner.next_if(|part| part.rule == Rule::not).is_some();
            let over = over_verdicts(inner.next()?)?;
            Some(if not { OverVerdicts::Not(Box::new(over)) } else { over })
        }
        Rule::enough_verdicts => {
            let mut inner = inner.filter(|part| !matches!(part.rule, Rule::at_least | Rule::of));
            let count = inner.next()?;
            let node = match count.rule {
                Rule::number => {
                    Node::Number(Number { value: count.written().parse().ok()?, unit: None })
                }
                _ => Node::Path(count.written().to_string()),
            };
            Some(OverVerdicts::AtLeast {
                count: count.at(node),
                of: inner.map(|name| name.named()).collect(),
            })
        }
        _ => {
            let name = inner.next()?.named();
            let Some(next) = inner.next() else { return Some(OverVerdicts::Holds(name)) };
            let over = match inner.next() {
                Some(other) => OverVerdicts::Same(name, other.named()),
                None => OverVerdicts::Holds(name),
            };
            Some(if next.rule == Rule::is { over } else { OverVerdicts::Not(Box::new(over)) })
        }
    }
}
