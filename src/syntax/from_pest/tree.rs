//! From the pairs of pest to the tree of a phrase.

use super::{Part, Rule, keys, parts};
use crate::syntax::phrase::{At, Fit, Item, Node, Number, Operator, Phrase, Pick, Step};
use crate::units::Unit;

pub(super) fn pick(part: Part<'_>) -> Pick {
    let text = part.text;
    let start = part.range.start;
    let comma = text.find(',').map_or(usize::MAX, |at| start + at);
    let (words, more) =
        parts(part).map(|word| word.named()).partition(|word| word.range.start < comma);
    Pick { words, more }
}

pub(super) fn step(part: Part<'_>) -> Option<At<Step>> {
    let range = part.range.clone();
    let mut step = Step { parts: Vec::new(), when: None };
    for part in parts(part) {
        match part.rule {
            Rule::part => step.parts.push(parts(part).map(item).collect::<Option<Vec<_>>>()?),
            _ => step.when = Some(either(parts(part).next()?)?),
        }
    }
    Some(At { node: step, range })
}

fn item(part: Part<'_>) -> Option<At<Item>> {
    let range = part.range.clone();
    let inner = parts(part).next()?;
    let node = match inner.rule {
        Rule::phrase_word => Item::Word(inner.text.to_string()),
        _ => Item::Value(value(inner)?),
    };
    Some(At { node, range })
}

fn number(part: Part<'_>) -> Option<Number> {
    let mut inner = parts(part);
    let number: f64 = inner.next()?.text.parse().ok()?;
    let Some(unit) = inner.next() else { return Some(Number { value: number, unit: None }) };
    let unit = Unit::parse(unit.text).ok()?;
    Some(Number { value: unit.to_si(number), unit: Some(unit) })
}

/// What is read without its neighbours: parentheses, a magnitude, a number, an end of a confidence
/// interval, a percentile or a path.
fn value(part: Part<'_>) -> Option<Phrase> {
    let range = part.range.clone();
    let node = match part.rule {
        Rule::parens => in_parens(part)?,
        Rule::magnitude => Node::Magnitude(Box::new(sum(parts(part).next()?)?)),
        Rule::quantity => Node::Number(number(part)?),
        Rule::bound_of => bound_of(part)?,
        Rule::percentile => Node::Percentile(part.text.trim_start_matches('p').parse().ok()?),
        _ => Node::Path(part.text.to_string()),
    };
    Some(At { node, range })
}

pub(super) fn cases(part: Part<'_>) -> Option<Phrase> {
    let range = part.range.clone();
    let mut inner = parts(part);
    let first = either(inner.next()?)?;
    let Some(condition) = inner.next() else { return Some(first) };
    let mut arms = vec![(first, either(condition)?)];
    let mut otherwise = None;
    while let Some(next) = inner.next() {
        if next.rule == Rule::otherwise {
            otherwise = Some(Box::new(either(parts(next).next()?)?));
        } else {
            arms.push((either(next)?, either(inner.next()?)?));
        }
    }
    Some(At { node: Node::Cases(arms, otherwise), range })
}

/// Folds `a op b op c` from the left.
fn fold(
    part: Part<'_>,
    one: fn(Part<'_>) -> Option<Phrase>,
    operator: fn(&str) -> Operator,
) -> Option<Phrase> {
    let mut inner = parts(part);
    let mut left = one(inner.next()?)?;
    while let Some(next) = inner.next() {
        let (op, right) = match next.rule {
            Rule::add | Rule::multiply => (operator(next.text), inner.next()?),
            _ => (operator(""), next),
        };
        let right = one(right)?;
        let range = left.range.start..right.range.end;
        left = At { node: Node::Binary(op, Box::new(left), Box::new(right)), range };
    }
    Some(left)
}

pub(super) fn either(part: Part<'_>) -> Option<Phrase> {
    fold(part, both, |_| Operator::Or)
}

fn both(part: Part<'_>) -> Option<Phrase> {
    fold(part, negation, |_| Operator::And)
}

fn negation(part: Part<'_>) -> Option<Phrase> {
    let range = part.range.clone();
    let mut inner = parts(part);
    let first = inner.next()?;
    if first.rule == Rule::not {
        return Some(At { node: Node::Not(Box::new(negation(inner.next()?)?)), range });
    }
    comparison(first)
}

/// `a <= b`, and `a <= b <= c` as `a <= b and b <= c`.
fn comparison(part: Part<'_>) -> Option<Phrase> {
    let mut inner = parts(part).peekable();
    let mut left = sum(inner.next()?)?;
    if inner.peek().is_some_and(|next| next.rule == Rule::near) {
        return near(left, inner.next()?);
    }
    let mut all: Option<Phrase> = None;
    while let (Some(op), Some(right)) = (inner.next(), inner.next()) {
        let right = if right.rule == Rule::in_quotes {
            let range = right.range.clone();
            At { node: Node::Quoted(right.text.trim_matches('"').to_string()), range }
        } else {
            sum(right)?
        };
        let words: String = op.text.split_whitespace().collect();
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
fn near(value: Phrase, part: Part<'_>) -> Option<Phrase> {
    let range = value.range.start..part.range.clone().end;
    let mut inner = parts(part);
    let target = Box::new(sum(inner.next()?)?);
    let next = inner.next()?;
    let by_factor = next.rule == Rule::a_factor_of;
    let tolerance = Box::new(sum(if by_factor { inner.next()? } else { next })?);
    Some(At { node: Node::Near { value: Box::new(value), target, tolerance, by_factor }, range })
}

pub(super) fn sum(part: Part<'_>) -> Option<Phrase> {
    fold(part, product, |text| if text == "+" { Operator::Add } else { Operator::Subtract })
}

fn product(part: Part<'_>) -> Option<Phrase> {
    fold(part, signed, |text| if text == "/" { Operator::Divide } else { Operator::Multiply })
}

fn signed(part: Part<'_>) -> Option<Phrase> {
    let range = part.range.clone();
    let mut inner = parts(part);
    let first = inner.next()?;
    if first.rule == Rule::minus {
        return Some(At { node: Node::Negative(Box::new(signed(inner.next()?)?)), range });
    }
    let mut raised = parts(first);
    let base = primary(raised.next()?)?;
    let Some(exponent) = raised.next() else { return Some(base) };
    let exponent = match exponent.text {
        "²" => 2,
        "³" => 3,
        text => text.trim_start_matches('^').parse().ok()?,
    };
    Some(At { node: Node::Power(Box::new(base), exponent), range })
}

fn primary(part: Part<'_>) -> Option<Phrase> {
    let start = part.range.start;
    let mut inner = parts(part);
    let mut phrase = without_suffix(inner.next()?)?;
    for after in inner {
        if after.rule == Rule::weighted {
            phrase = weighted(phrase, after)?;
            continue;
        }
        let (range, rule) = (start..after.range.end, after.rule);
        let what = parts(after).next()?;
        let node = match rule {
            Rule::over => Node::Over(Box::new(phrase), Box::new(primary(what)?)),
            _ => Node::Through(Box::new(phrase), what.named()),
        };
        phrase = At { node, range };
    }
    Some(phrase)
}

/// A primary without `through`, `over` and `weighted` behind it.
fn without_suffix(part: Part<'_>) -> Option<Phrase> {
    let range = part.range.clone();
    let rule = part.rule;
    let without_of = |part| parts(part).filter(|part| part.rule != Rule::of);
    let node = match rule {
        Rule::extreme => {
            let mut inner = without_of(part);
            let which = inner.next()?.named();
            Node::Call(which, vec![sum(inner.next()?)?, sum(inner.next()?)?])
        }
        Rule::call => {
            let mut inner = parts(part);
            let name = inner.next()?.named();
            Node::Call(name, inner.map(either).collect::<Option<Vec<_>>>()?)
        }
        Rule::reduced => {
            let mut inner = without_of(part);
            let reducer = value(inner.next()?)?;
            Node::Reduced(Box::new(reducer), Box::new(signed(inner.next()?)?))
        }
        Rule::share => {
            let (mut of_sections, mut condition, mut by) = (false, None, None);
            for part in parts(part) {
                match part.rule {
                    Rule::of => of_sections = true,
                    Rule::weighted => by = Some(part),
                    _ => condition = Some(Box::new(either(part)?)),
                }
            }
            let share = At { node: Node::Share { of_sections, condition: condition? }, range };
            return match by {
                Some(by) => weighted(share, by),
                None => Some(share),
            };
        }
        Rule::fit => Node::Fit(Box::new(fit(part)?)),
        Rule::place_of => {
            let mut inner = parts(part);
            let signal = inner.next()?.named();
            Node::PlaceOf(signal, inner.map(|word| word.named()).collect())
        }
        _ => return value(part),
    };
    Some(At { node, range })
}

/// The estimate of a limit: the name of a statistic or estimate, a percentile, the end of an
/// interval, or an expression in parentheses.
pub(super) fn estimate(part: Part<'_>) -> Option<Phrase> {
    let mut inner = parts(part);
    let found = value(inner.next()?)?;
    match inner.next() {
        Some(by) => weighted(found, by),
        None => Some(found),
    }
}

/// What parentheses hold: an expression, or one number of it for each group.
fn in_parens(part: Part<'_>) -> Option<Node> {
    let mut inner = parts(part);
    let found = cases(inner.next()?)?;
    match inner.next() {
        Some(groups) => Some(Node::ForEach(Box::new(found), keys(parts(groups).next()?))),
        None => Some(found.node),
    }
}

/// `weighted by length` after what it is a weight of.
fn weighted(of: Phrase, part: Part<'_>) -> Option<Phrase> {
    let range = of.range.start..part.range.end.max(of.range.end);
    let by = value(parts(parts(part).next()?).next()?)?;
    Some(At { node: Node::Weighted(Box::new(of), Box::new(by)), range })
}

/// The end of a confidence interval: `upper 95 % of std by bootstrap`.
fn bound_of(part: Part<'_>) -> Option<Node> {
    let mut inner = parts(part).filter(|part| part.rule != Rule::of);
    let upper = inner.next()?.text == "upper";
    let confidence = number(inner.next()?)?.value;
    let (mut of, mut bootstrap) = (value(inner.next()?)?, false);
    for part in inner {
        match part.rule {
            Rule::weighted => of = weighted(of, part)?,
            _ => bootstrap = true,
        }
    }
    Some(Node::Bound { upper, confidence, of: Box::new(of), bootstrap })
}

/// A regression: `prediction over radius, speed at 300 m, 80 km/h, confidence 99 %`.
fn fit(part: Part<'_>) -> Option<Fit> {
    let mut inner = parts(part);
    let prediction = inner.next()?.text == "prediction";
    let mut fit = Fit {
        prediction,
        over: Vec::new(),
        at: Vec::new(),
        confidence: None,
        one_sided: false,
        lower: false,
    };
    for part in inner {
        match part.rule {
            Rule::regressor => fit.over.push(value(parts(part).next()?)?),
            Rule::sum => fit.at.push(sum(part)?),
            _ => {
                let option = parts(part).next()?;
                match option.rule {
                    Rule::confidence => {
                        let written = parts(option).next()?;
                        let range = written.range.clone();
                        fit.confidence = Some(At { node: number(written)?.value, range });
                    }
                    Rule::tails => fit.one_sided = option.text.starts_with("one"),
                    _ => fit.lower = option.text == "lower",
                }
            }
        }
    }
    Some(fit)
}
