//! From the pairs of pest to the tree of a phrase.

use super::{Parsed, Rule, keys};
use crate::syntax::phrase::{At, Counted, Fit, Item, Node, Number, Operator, Phrase, Pick, Step};
use crate::units::Unit;

pub(super) fn pick(part: Parsed) -> Pick {
    let comma = part.written().find(',').map_or(usize::MAX, |at| part.range.start + at);
    let (words, more) = part.map(|word| word.named()).partition(|word| word.range.start < comma);
    Pick { words, more }
}

pub(super) fn step(mut part: Parsed) -> Option<At<Step>> {
    let mut step = Step { parts: Vec::new(), when: None };
    for mut inner in part.by_ref() {
        match inner.rule {
            Rule::part | Rule::part_inside => {
                step.parts.push(inner.map(item).collect::<Option<Vec<_>>>()?)
            }
            _ => step.when = Some(either(inner.next()?)?),
        }
    }
    Some(part.at(step))
}

fn item(mut part: Parsed) -> Option<At<Item>> {
    let inner = part.next()?;
    Some(part.at(match inner.rule {
        Rule::phrase_word | Rule::word_inside => Item::Word(inner.written().to_string()),
        _ => Item::Value(value(inner)?),
    }))
}

fn number(part: &mut Parsed) -> Option<Number> {
    let number: f64 = part.next()?.written().parse().ok()?;
    let Some(unit) = part.next() else { return Some(Number { value: number, unit: None }) };
    let unit = Unit::parse(unit.written()).ok()?;
    Some(Number { value: unit.to_si(number), unit: Some(unit) })
}

/// What is read without its neighbours: parentheses, a magnitude, a number, an end of a confidence
/// interval, a percentile or a path.
pub(super) fn value(mut part: Parsed) -> Option<Phrase> {
    let node = match part.rule {
        Rule::parens => in_parens(&mut part)?,
        Rule::magnitude => Node::Magnitude(Box::new(sum(part.next()?)?)),
        Rule::quantity => Node::Number(number(&mut part)?),
        Rule::bound_of => bound_of(&mut part)?,
        Rule::constant => return value(part.next()?),
        Rule::percentile_by => Node::PercentileBy(Box::new(value(part.next()?)?)),
        Rule::percentile => Node::Percentile(part.written().trim_start_matches('p').parse().ok()?),
        _ => Node::Path(part.written().to_string()),
    };
    Some(part.at(node))
}

pub(super) fn cases(mut part: Parsed) -> Option<Phrase> {
    let first = either(part.next()?)?;
    let Some(condition) = part.next() else { return Some(first) };
    let mut arms = vec![(first, either(condition)?)];
    let mut otherwise = None;
    while let Some(mut next) = part.next() {
        if next.rule == Rule::otherwise {
            otherwise = Some(Box::new(either(next.next()?)?));
        } else {
            arms.push((either(next)?, either(part.next()?)?));
        }
    }
    Some(part.at(Node::Cases(arms, otherwise)))
}

/// Two phrases with an operator between them.
fn binary(operator: Operator, left: Phrase, right: Phrase) -> Phrase {
    let whole = left.to(&right, ());
    whole.with(Node::Binary(operator, Box::new(left), Box::new(right)))
}

/// Folds `a op b op c` from the left.
fn fold(
    mut part: Parsed,
    operand: fn(Parsed) -> Option<Phrase>,
    operator: fn(&str) -> Operator,
) -> Option<Phrase> {
    let mut left = operand(part.next()?)?;
    while let Some(next) = part.next() {
        left = match next.rule {
            Rule::add | Rule::multiply => {
                binary(operator(next.written()), left, operand(part.next()?)?)
            }
            _ => binary(operator(""), left, operand(next)?),
        };
    }
    Some(left)
}

pub(super) fn either(part: Parsed) -> Option<Phrase> {
    fold(part, both, |_| Operator::Or)
}

fn both(part: Parsed) -> Option<Phrase> {
    fold(part, negation, |_| Operator::And)
}

fn negation(mut part: Parsed) -> Option<Phrase> {
    let first = part.next()?;
    if first.rule == Rule::not {
        let inner = Box::new(negation(part.next()?)?);
        return Some(part.at(Node::Not(inner)));
    }
    comparison(first)
}

/// `a <= b`, and `a <= b <= c` as `a <= b and b <= c`.
fn comparison(part: Parsed) -> Option<Phrase> {
    let mut inner = part.peekable();
    let mut left = sum(inner.next()?)?;
    if let Some(near) = inner.next_if(|next| next.rule == Rule::near) {
        return self::near(left, near);
    }
    let mut all: Option<Phrase> = None;
    while let (Some(op), Some(right)) = (inner.next(), inner.next()) {
        let right = if right.rule == Rule::in_quotes {
            right.at(Node::Quoted(right.written().trim_matches('"').to_string()))
        } else {
            sum(right)?
        };
        let words: String = op.written().split_whitespace().collect();
        let operator = match words.as_str() {
            "<=" | "≤" => Operator::LessEqual,
            ">=" | "≥" => Operator::GreaterEqual,
            "<" => Operator::Less,
            ">" => Operator::Greater,
            "isnot" => Operator::IsNot,
            _ => Operator::Is,
        };
        let this = binary(operator, left, right.clone());
        all = Some(match all {
            None => this,
            Some(before) => binary(Operator::And, before, this),
        });
        left = right;
    }
    Some(all.unwrap_or(left))
}

/// The condition `near b within c` after a value.
fn near(value: Phrase, mut part: Parsed) -> Option<Phrase> {
    let target = Box::new(sum(part.next()?)?);
    let next = part.next()?;
    let by_factor = next.rule == Rule::a_factor_of;
    let tolerance = Box::new(sum(if by_factor { part.next()? } else { next })?);
    let whole = value.to(&part.at(()), ());
    Some(whole.with(Node::Near { value: Box::new(value), target, tolerance, by_factor }))
}

pub(super) fn sum(part: Parsed) -> Option<Phrase> {
    fold(part, product, |text| if text == "+" { Operator::Add } else { Operator::Subtract })
}

fn product(part: Parsed) -> Option<Phrase> {
    fold(part, signed, |text| if text == "/" { Operator::Divide } else { Operator::Multiply })
}

fn signed(mut part: Parsed) -> Option<Phrase> {
    let mut first = part.next()?;
    if first.rule == Rule::minus {
        let inner = Box::new(signed(part.next()?)?);
        return Some(part.at(Node::Negative(inner)));
    }
    let base = primary(first.next()?)?;
    let Some(mut exponent) = first.next() else { return Some(base) };
    let exponent = Box::new(self::exponent(&mut exponent)?);
    Some(part.at(Node::Power(Box::new(base), exponent)))
}

/// What stands behind `^`, or `²`.
fn exponent(part: &mut Parsed) -> Option<Phrase> {
    let inner = part.next()?;
    let value = match inner.rule {
        Rule::minus => {
            let positive = Box::new(exponent(part)?);
            return Some(part.at(Node::Negative(positive)));
        }
        Rule::square_cube if inner.written() == "²" => 2.0,
        Rule::square_cube => 3.0,
        Rule::number => inner.written().parse().ok()?,
        _ => return value(inner),
    };
    Some(inner.at(Node::Number(Number { value, unit: None })))
}

fn primary(mut part: Parsed) -> Option<Phrase> {
    let mut phrase = without_suffix(part.next()?)?;
    for mut after in part.by_ref() {
        if after.rule == Rule::weighted {
            phrase = weighted(phrase, after)?;
            continue;
        }
        let what = after.next()?;
        let whole = phrase.to(&after.at(()), ());
        phrase = whole.with(match after.rule {
            Rule::over => Node::Over(Box::new(phrase), Box::new(primary(what)?)),
            _ => Node::Through(Box::new(phrase), steps_inside(what)?),
        });
    }
    Some(phrase)
}

/// What a signal passes: a filter by its name, a step, or a chain.
fn steps_inside(part: Parsed) -> Option<Vec<At<Step>>> {
    match part.rule {
        Rule::steps_inside => {
            part.filter(|part| part.rule == Rule::step).map(step).collect::<Option<Vec<_>>>()
        }
        Rule::step_inside => Some(vec![step(part)?]),
        _ => {
            let word = part.at(Item::Word(part.written().to_string()));
            let step = Step { parts: vec![vec![word]], when: None };
            Some(vec![part.at(step)])
        }
    }
}

/// A primary without `through`, `over` and `weighted` behind it.
fn without_suffix(mut part: Parsed) -> Option<Phrase> {
    let node = match part.rule {
        Rule::extreme => {
            let which = part.next()?.named();
            let mut inner = part.by_ref().filter(|part| part.rule != Rule::of);
            Node::Call(which, vec![sum(inner.next()?)?, sum(inner.next()?)?])
        }
        Rule::call => {
            let name = part.next()?.named();
            Node::Call(name, part.by_ref().map(either).collect::<Option<Vec<_>>>()?)
        }
        Rule::table => {
            let of = Box::new(value(part.next()?)?);
            let (mut points, mut held) = (Vec::new(), false);
            for mut part in part.by_ref().filter(|part| part.rule != Rule::comma) {
                if part.rule == Rule::held {
                    held = true;
                } else {
                    let mut inner = part.by_ref().filter(|part| part.rule == Rule::sum);
                    points.push((sum(inner.next()?)?, sum(inner.next()?)?));
                }
            }
            Node::Table { of, points, held }
        }
        Rule::of_percentile => {
            let percentile = value(part.next()?)?;
            match part.find(|part| part.rule != Rule::of) {
                Some(of) => Node::Reduced(Box::new(percentile), Box::new(signed(of)?)),
                None => return Some(percentile),
            }
        }
        Rule::reduced => {
            let mut inner = part.by_ref().filter(|part| part.rule != Rule::of);
            let reducer = value(inner.next()?)?;
            Node::Reduced(Box::new(reducer), Box::new(signed(inner.next()?)?))
        }
        Rule::share => {
            let counted = counted(part.next()?.written());
            let (mut of_sections, mut condition, mut by) = (false, None, None);
            for part in part.by_ref() {
                match part.rule {
                    Rule::of => of_sections = true,
                    Rule::weighted => by = Some(part),
                    _ => condition = Some(Box::new(either(part)?)),
                }
            }
            let share = part.at(Node::Share { counted, of_sections, condition: condition? });
            return match by {
                Some(by) => weighted(share, by),
                None => Some(share),
            };
        }
        Rule::fit => Node::Fit(Box::new(fit(&mut part)?)),
        Rule::place_of => {
            let signal = part.next()?.named();
            Node::PlaceOf(signal, part.by_ref().map(|word| word.named()).collect())
        }
        _ => return value(part),
    };
    Some(part.at(node))
}

/// `share`, `count`, `crossings`, `longest run`, `longest run in time`.
fn counted(words: &str) -> Counted {
    match (words, words.split_whitespace().count()) {
        ("count", _) => Counted::Count,
        ("crossings", _) => Counted::Crossings,
        (_, 1) => Counted::Share,
        (_, words) => Counted::LongestRun { in_time: words > 2 },
    }
}

/// The estimate of a limit: the name of a statistic or estimate, a percentile, the end of an
/// interval, or an expression in parentheses.
pub(super) fn estimate(mut part: Parsed) -> Option<Phrase> {
    let found = value(part.next()?)?;
    match part.next() {
        Some(by) => weighted(found, by),
        None => Some(found),
    }
}

/// What parentheses hold: an expression, or one number of it for each group.
fn in_parens(part: &mut Parsed) -> Option<Node> {
    let found = cases(part.next()?)?;
    match part.next() {
        Some(mut groups) => Some(Node::ForEach(Box::new(found), keys(groups.next()?))),
        None => Some(found.node),
    }
}

/// `weighted by length` after what it is a weight of.
fn weighted(of: Phrase, mut part: Parsed) -> Option<Phrase> {
    let by = value(part.next()?.next()?)?;
    let whole = of.to(&part.at(()), ());
    Some(whole.with(Node::Weighted(Box::new(of), Box::new(by))))
}

/// The end of a confidence interval: `upper 95 % of std by bootstrap`.
fn bound_of(part: &mut Parsed) -> Option<Node> {
    let mut inner = part.filter(|part| part.rule != Rule::of);
    let upper = inner.next()?.written() == "upper";
    let confidence = Box::new(value(inner.next()?)?);
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
fn fit(part: &mut Parsed) -> Option<Fit> {
    let mut fit = Fit {
        prediction: part.next()?.written() == "prediction",
        over: Vec::new(),
        at: Vec::new(),
        confidence: None,
        one_sided: false,
        lower: false,
    };
    for mut part in part {
        match part.rule {
            Rule::regressor => fit.over.push(value(part.next()?)?),
            Rule::sum => fit.at.push(sum(part)?),
            _ => {
                let mut option = part.next()?;
                match option.rule {
                    Rule::confidence => fit.confidence = Some(value(option.next()?)?),
                    Rule::tails => fit.one_sided = option.written().starts_with("one"),
                    _ => fit.lower = option.written() == "lower",
                }
            }
        }
    }
    Some(fit)
}
