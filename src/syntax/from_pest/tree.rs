//! From the pairs of pest to the tree of a phrase.

use pest::iterators::Pair;

use super::{Rule, bytes, keys, named, parts};
use crate::syntax::phrase::{At, Fit, Item, Node, Operator, Phrase, Pick, Step};
use crate::units::Unit;

pub(super) fn pick(pair: Pair<'_, Rule>) -> Pick {
    let text = pair.as_str();
    let start = pair.as_span().start();
    let comma = text.find(',').map_or(usize::MAX, |at| start + at);
    let (words, more) =
        parts(pair).map(|word| named(&word)).partition(|word| word.range.start < comma);
    Pick { words, more }
}

pub(super) fn step(pair: Pair<'_, Rule>) -> Option<At<Step>> {
    let range = bytes(&pair);
    let mut step = Step { parts: Vec::new(), when: None };
    for part in parts(pair) {
        match part.as_rule() {
            Rule::part => step.parts.push(parts(part).map(item).collect::<Option<Vec<_>>>()?),
            _ => step.when = Some(either(parts(part).next()?)?),
        }
    }
    Some(At { node: step, range })
}

fn item(pair: Pair<'_, Rule>) -> Option<At<Item>> {
    let range = bytes(&pair);
    let inner = parts(pair).next()?;
    let node = match inner.as_rule() {
        Rule::phrase_word => Item::Word(inner.as_str().trim().to_string()),
        Rule::parens => Item::Value(At { range: range.clone(), node: in_parens(inner)? }),
        _ => Item::Value(At { range: range.clone(), node: quantity(inner)? }),
    };
    Some(At { node, range })
}

fn quantity(pair: Pair<'_, Rule>) -> Option<Node> {
    let mut inner = parts(pair);
    let number: f64 = inner.next()?.as_str().parse().ok()?;
    let unit = match inner.next() {
        Some(text) => Some(Unit::parse(text.as_str()).ok()?),
        None => None,
    };
    Some(Node::Number { value: unit.as_ref().map_or(number, |unit| unit.to_si(number)), unit })
}

pub(super) fn cases(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut inner = parts(pair);
    let first = either(inner.next()?)?;
    let Some(condition) = inner.next() else { return Some(first) };
    let mut arms = vec![(first, either(condition)?)];
    let mut otherwise = None;
    while let Some(next) = inner.next() {
        if next.as_rule() == Rule::otherwise {
            otherwise = Some(Box::new(either(parts(next).next()?)?));
        } else {
            arms.push((either(next)?, either(inner.next()?)?));
        }
    }
    Some(At { node: Node::Cases(arms, otherwise), range })
}

/// Folds `a op b op c` from the left.
fn fold(
    pair: Pair<'_, Rule>,
    one: fn(Pair<'_, Rule>) -> Option<Phrase>,
    operator: fn(&str) -> Operator,
) -> Option<Phrase> {
    let mut inner = parts(pair);
    let mut left = one(inner.next()?)?;
    while let Some(next) = inner.next() {
        let (op, right) = match next.as_rule() {
            Rule::add | Rule::multiply => (operator(next.as_str().trim()), inner.next()?),
            _ => (operator(""), next),
        };
        let right = one(right)?;
        let range = left.range.start..right.range.end;
        left = At { node: Node::Binary(op, Box::new(left), Box::new(right)), range };
    }
    Some(left)
}

pub(super) fn either(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, both, |_| Operator::Or)
}

fn both(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, negation, |_| Operator::And)
}

fn negation(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut inner = parts(pair);
    let first = inner.next()?;
    if first.as_rule() == Rule::not {
        return Some(At { node: Node::Not(Box::new(negation(inner.next()?)?)), range });
    }
    comparison(first)
}

/// `a <= b`, and `a <= b <= c` as `a <= b and b <= c`.
fn comparison(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let mut inner = parts(pair).peekable();
    let mut left = sum(inner.next()?)?;
    if inner.peek().is_some_and(|next| next.as_rule() == Rule::near) {
        return near(left, inner.next()?);
    }
    let mut all: Option<Phrase> = None;
    while let (Some(op), Some(right)) = (inner.next(), inner.next()) {
        let right = if right.as_rule() == Rule::in_quotes {
            let range = bytes(&right);
            At { node: Node::Quoted(right.as_str().trim_matches('"').to_string()), range }
        } else {
            sum(right)?
        };
        let words: String = op.as_str().split_whitespace().collect();
        let operator = match words.as_str() {
            "<=" | "≤" => Operator::LessEqual,
            ">=" | "≥" => Operator::GreaterEqual,
            "<" => Operator::Less,
            ">" => Operator::Greater,
            "isnot" => Operator::IsNot,
            _ => Operator::Is,
        };
        let range = left.range.start..right.range.end;
        let this =
            At { node: Node::Binary(operator, Box::new(left), Box::new(right.clone())), range };
        all = Some(match all {
            None => this,
            Some(before) => {
                let range = before.range.start..this.range.end;
                At { node: Node::Binary(Operator::And, Box::new(before), Box::new(this)), range }
            }
        });
        left = right;
    }
    Some(all.unwrap_or(left))
}

/// The condition `near b within c` after a value.
fn near(value: Phrase, pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = value.range.start..bytes(&pair).end;
    let mut inner = parts(pair);
    let target = Box::new(sum(inner.next()?)?);
    let next = inner.next()?;
    let by_factor = next.as_rule() == Rule::a_factor_of;
    let tolerance = Box::new(sum(if by_factor { inner.next()? } else { next })?);
    Some(At { node: Node::Near { value: Box::new(value), target, tolerance, by_factor }, range })
}

pub(super) fn sum(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, product, |text| if text == "+" { Operator::Add } else { Operator::Subtract })
}

fn product(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, signed, |text| if text == "/" { Operator::Divide } else { Operator::Multiply })
}

fn signed(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut inner = parts(pair);
    let first = inner.next()?;
    if first.as_rule() == Rule::minus {
        return Some(At { node: Node::Negative(Box::new(signed(inner.next()?)?)), range });
    }
    let mut raised = parts(first);
    let base = primary(raised.next()?)?;
    let Some(exponent) = raised.next() else { return Some(base) };
    let exponent = match exponent.as_str().trim() {
        "²" => 2,
        "³" => 3,
        text => text.trim_start_matches('^').parse().ok()?,
    };
    Some(At { node: Node::Power(Box::new(base), exponent), range })
}

fn primary(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let whole = bytes(&pair);
    let mut inner = parts(pair);
    let first = inner.next()?;
    let range = bytes(&first);
    let node = match first.as_rule() {
        Rule::magnitude => Node::Magnitude(Box::new(sum(parts(first).next()?)?)),
        Rule::parens => in_parens(first)?,
        Rule::extreme => {
            let mut inner = parts(first).filter(|pair| pair.as_rule() != Rule::of);
            let which = named(&inner.next()?);
            Node::Call(which, vec![sum(inner.next()?)?, sum(inner.next()?)?])
        }
        Rule::quantity => quantity(first)?,
        Rule::call => {
            let mut inner = parts(first);
            let name = named(&inner.next()?);
            Node::Call(name, inner.map(either).collect::<Option<Vec<_>>>()?)
        }
        Rule::reduced => {
            let mut inner = parts(first).filter(|pair| pair.as_rule() != Rule::of);
            let reducer = inner.next()?;
            let reducer = At { range: bytes(&reducer), node: word(&reducer)? };
            Node::Reduced(Box::new(reducer), Box::new(signed(inner.next()?)?))
        }
        Rule::bound_of => bound_of(first)?,
        Rule::share => {
            let all: Vec<Pair<'_, Rule>> = parts(first).collect();
            let of_sections = all.iter().any(|pair| pair.as_rule() == Rule::of);
            let condition = all.iter().find(|pair| pair.as_rule() == Rule::either)?;
            let share =
                Node::Share { of_sections, condition: Box::new(either(condition.clone())?) };
            match all.into_iter().find(|pair| pair.as_rule() == Rule::weighted) {
                Some(by) => weighted(At { node: share, range: range.clone() }, by)?.node,
                None => share,
            }
        }
        Rule::fit => Node::Fit(Box::new(fit(first)?)),
        Rule::place_of => {
            let mut inner = parts(first);
            let signal = named(&inner.next()?);
            Node::PlaceOf(signal, inner.map(|word| named(&word)).collect())
        }
        _ => word(&first)?,
    };
    let mut phrase = At { node, range };
    for after in inner {
        let range = whole.start..bytes(&after).end;
        let rule = after.as_rule();
        if rule == Rule::weighted {
            phrase = weighted(phrase, after)?;
            continue;
        }
        let what = parts(after).next()?;
        let node = match rule {
            Rule::over => Node::Over(Box::new(phrase), Box::new(primary(what)?)),
            _ => Node::Through(Box::new(phrase), named(&what)),
        };
        phrase = At { node, range };
    }
    Some(phrase)
}

/// The estimate of a limit: the name of a statistic or estimate, a percentile, the end of an
/// interval, or an expression in parentheses.
pub(super) fn estimate(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let mut inner = parts(pair);
    let first = inner.next()?;
    let range = bytes(&first);
    let node = match first.as_rule() {
        Rule::bound_of => bound_of(first)?,
        Rule::parens => in_parens(first)?,
        _ => word(&first)?,
    };
    let found = At { node, range };
    match inner.next() {
        Some(by) => weighted(found, by),
        None => Some(found),
    }
}

/// What parentheses hold: an expression, or one number of it for each group.
fn in_parens(pair: Pair<'_, Rule>) -> Option<Node> {
    let mut inner = parts(pair);
    let found = cases(inner.next()?)?;
    match inner.next() {
        Some(groups) => Some(Node::ForEach(Box::new(found), keys(parts(groups).next()?))),
        None => Some(found.node),
    }
}

/// `weighted by length` after what it is a weight of.
fn weighted(of: Phrase, pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = of.range.start..bytes(&pair).end.max(of.range.end);
    let by = parts(pair).next()?;
    let at = bytes(&by);
    let inner = parts(by).next()?;
    let node = match inner.as_rule() {
        Rule::parens => in_parens(inner)?,
        Rule::magnitude => Node::Magnitude(Box::new(sum(parts(inner).next()?)?)),
        _ => word(&inner)?,
    };
    Some(At { node: Node::Weighted(Box::new(of), Box::new(At { node, range: at })), range })
}

/// The end of a confidence interval: `upper 95 % of std by bootstrap`.
fn bound_of(pair: Pair<'_, Rule>) -> Option<Node> {
    let mut inner = parts(pair).filter(|pair| pair.as_rule() != Rule::of);
    let upper = inner.next()?.as_str().trim() == "upper";
    let Node::Number { value: confidence, .. } = quantity(inner.next()?)? else { return None };
    let of = inner.next()?;
    let range = bytes(&of);
    let node = if of.as_rule() == Rule::parens { in_parens(of)? } else { word(&of)? };
    let (mut of, mut bootstrap) = (At { node, range }, false);
    for part in inner {
        match part.as_rule() {
            Rule::weighted => of = weighted(of, part)?,
            _ => bootstrap = true,
        }
    }
    Some(Node::Bound { upper, confidence, of: Box::new(of), bootstrap })
}

/// A regression: `prediction over radius, speed at 300 m, 80 km/h, confidence 99 %`.
fn fit(pair: Pair<'_, Rule>) -> Option<Fit> {
    let mut inner = parts(pair);
    let prediction = inner.next()?.as_str().trim() == "prediction";
    let mut fit = Fit {
        prediction,
        over: Vec::new(),
        at: Vec::new(),
        confidence: None,
        one_sided: false,
        lower: false,
    };
    for part in inner {
        match part.as_rule() {
            Rule::regressor => {
                let range = bytes(&part);
                let of = parts(part).next()?;
                let node = match of.as_rule() {
                    Rule::parens => in_parens(of)?,
                    Rule::magnitude => Node::Magnitude(Box::new(sum(parts(of).next()?)?)),
                    _ => word(&of)?,
                };
                fit.over.push(At { node, range });
            }
            Rule::sum => fit.at.push(sum(part)?),
            _ => {
                let option = parts(part).next()?;
                match option.as_rule() {
                    Rule::confidence => {
                        let written = parts(option).next()?;
                        let range = bytes(&written);
                        let Node::Number { value, .. } = quantity(written)? else { return None };
                        fit.confidence = Some(At { node: value, range });
                    }
                    Rule::tails => fit.one_sided = option.as_str().starts_with("one"),
                    _ => fit.lower = option.as_str().trim() == "lower",
                }
            }
        }
    }
    Some(fit)
}

/// A percentile or a path.
fn word(pair: &Pair<'_, Rule>) -> Option<Node> {
    let text = pair.as_str().trim();
    if pair.as_rule() == Rule::percentile {
        return text.trim_start_matches('p').parse().ok().map(Node::Percentile);
    }
    Some(Node::Path(text.to_string()))
}
