//! From field text to [`super::phrase`]: the only place that names the rules of `phrase.pest`.

use std::ops::Range;

use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};
use pest::iterators::Pair;

use super::document::Text;
use super::phrase::{Alias, At, Item, Limit, Node, OfPlaces, Operator, Phrase, Pick, Scope, Step, Verdict};
use crate::problem::{Problem, Problems};
use crate::units::Unit;

#[derive(pest_derive::Parser)]
#[grammar = "syntax/phrase.pest"]
struct Grammar;

/// Nesting deeper than this is refused before parsing: it is no rule a person wrote, and recursion has an end.
const DEEPEST: usize = 60;

pub fn expression(text: &Text, problems: &mut Problems) -> Option<Phrase> {
    let pair = parse(Rule::expression, text, problems)?;
    pair.into_inner().next().and_then(cases)
}

pub fn of_places(text: &Text, problems: &mut Problems) -> Option<OfPlaces> {
    let mut inner = parse(Rule::of_places, text, problems)?.into_inner();
    let signal = named(&inner.next()?);
    Some(OfPlaces { signal, picks: inner.filter(|pair| pair.as_rule() == Rule::pick).map(pick).collect() })
}

pub fn places(text: &Text, problems: &mut Problems) -> Option<Vec<Pick>> {
    let inner = parse(Rule::places, text, problems)?.into_inner();
    Some(inner.filter(|pair| pair.as_rule() == Rule::pick).map(pick).collect())
}

pub fn list(text: &Text, problems: &mut Problems) -> Option<Vec<At<String>>> {
    let inner = parse(Rule::list, text, problems)?.into_inner();
    Some(inner.filter(|pair| pair.as_rule() == Rule::item).map(|pair| named(&pair)).collect())
}

pub fn alias(text: &Text, problems: &mut Problems) -> Option<Alias> {
    let mut inner = parse(Rule::alias, text, problems)?.into_inner();
    let name = named(&inner.next()?);
    let mut cases = Vec::new();
    while let (Some(member), Some(condition)) = (inner.next(), inner.next()) {
        if member.as_rule() == Rule::EOI {
            break;
        }
        cases.push((named(&member), either(condition)?));
    }
    Some(Alias { name, cases })
}

/// `distance in m`: the name and the unit text.
pub fn axis(text: &Text, problems: &mut Problems) -> Option<(At<String>, At<String>)> {
    let mut inner = parse(Rule::axis, text, problems)?.into_inner();
    Some((named(&inner.next()?), named(&inner.next()?)))
}

pub fn range(text: &Text, problems: &mut Problems) -> Option<(Phrase, Phrase)> {
    let mut inner = parse(Rule::range, text, problems)?.into_inner();
    Some((sum(inner.next()?)?, sum(inner.next()?)?))
}

pub fn chain(text: &Text, problems: &mut Problems) -> Option<Vec<At<Step>>> {
    let inner = parse(Rule::chain, text, problems)?.into_inner();
    inner.filter(|pair| pair.as_rule() == Rule::step).map(step).collect()
}

pub fn step_alone(text: &Text, problems: &mut Problems) -> Option<At<Step>> {
    step(parse(Rule::steps, text, problems)?.into_inner().next()?)
}

pub fn limit(text: &Text, problems: &mut Problems) -> Option<Limit> {
    let mut inner = parse(Rule::limit, text, problems)?.into_inner().peekable();
    let statistic = named(&inner.next()?);
    let at_least = inner.next_if(|pair| pair.as_rule() == Rule::at_least).is_some();
    let bound = cases(inner.next()?)?;
    let mut limit = Limit { statistic, at_least, bound, factors: Vec::new(), only_when: None, scope: At { node: Scope::All, range: 0..0 } };
    for part in inner {
        let Some(part) = part.into_inner().next() else { continue };
        let place = bytes(&part);
        match part.as_rule() {
            Rule::doubled => {
                let two = At { node: Node::Number { value: 2.0, unit: None }, range: place };
                limit.factors.push((two, either(part.into_inner().next()?)?));
            }
            Rule::times => {
                let mut inner = part.into_inner();
                limit.factors.push((sum(inner.next()?)?, either(inner.next()?)?));
            }
            Rule::only => limit.only_when = Some(either(part.into_inner().next()?)?),
            Rule::scope => {
                let inner = part.into_inner().next()?;
                let node = match inner.as_rule() {
                    Rule::zones_only => Scope::Zones(inner.into_inner().map(|pair| named(&pair)).collect()),
                    Rule::sections_only => Scope::Where(Box::new(either(inner.into_inner().next()?)?)),
                    _ => Scope::EachZone,
                };
                limit.scope = At { node, range: place };
            }
            _ => {}
        }
    }
    Some(limit)
}

pub fn verdict(text: &Text, problems: &mut Problems) -> Option<Verdict> {
    let inner = parse(Rule::verdict, text, problems)?.into_inner().next()?;
    if inner.as_rule() == Rule::every_limit {
        return Some(Verdict::EveryLimit);
    }
    let of_limits = inner.as_str().contains("limits");
    let count = sum(inner.into_inner().find(|pair| pair.as_rule() == Rule::sum)?)?;
    Some(Verdict::AtLeast { count, of_limits })
}

/// Runs one rule over a field; a syntax error becomes a problem at the word where it stands.
fn parse<'t>(rule: Rule, text: &'t Text, problems: &mut Problems) -> Option<Pair<'t, Rule>> {
    let mut depth = 0_usize;
    let mut deepest = 0;
    for c in text.text.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    let runs = ["not", "-", "|", "of"].iter().map(|word| text.text.matches(word).count()).max().unwrap_or(0);
    if deepest > DEEPEST || runs > 3 * DEEPEST || text.text.len() > 20_000 {
        problems.push(
            Problem::error("too-deep", format!("this is nested deeper than {DEEPEST} levels or longer than a rule can be"))
                .at(&text.place(0..text.text.len().min(40)))
                .help("name parts of it with `define`"),
        );
        return None;
    }
    match Grammar::parse(rule, &text.text) {
        Ok(mut pairs) => pairs.next(),
        Err(error) => {
            problems.push(explain(rule, &error, text));
            None
        }
    }
}

fn explain(rule: Rule, error: &pest::error::Error<Rule>, text: &Text) -> Problem {
    let at = match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    let rest = &text.text[at..];
    let found: String = rest.split_whitespace().next().unwrap_or("").chars().take(24).collect();
    let says = if found.is_empty() {
        format!("{} ends too early", in_words(rule))
    } else {
        format!("`{found}` does not fit here in {}", in_words(rule))
    };
    let mut expected: Vec<&str> = Vec::new();
    if let ErrorVariant::ParsingError { positives, .. } = &error.variant {
        for positive in positives {
            let word = in_words(*positive);
            if !word.is_empty() && !expected.contains(&word) {
                expected.push(word);
            }
        }
    }
    // An error in an exact text is underlined at the word; at its end, the last word is.
    let range =
        if found.is_empty() { text.text.trim_end().len().saturating_sub(1)..text.text.trim_end().len() } else { at..at + found.len() };
    let problem = Problem::error("syntax", says).at(&text.place(range));
    match expected.len() {
        0 => problem,
        1..=8 => problem.help(format!("expected {}", one_of(&expected))),
        _ => problem.help(format!("expected {}, ...", expected[..8].join(", "))),
    }
}

fn one_of(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_string(),
        [start @ .., last] => format!("{} or {last}", start.join(", ")),
    }
}

/// What a rule is called in a message; empty where naming it would not help.
fn in_words(rule: Rule) -> &'static str {
    match rule {
        Rule::expression | Rule::cases | Rule::either | Rule::both | Rule::negation | Rule::comparison => "an expression",
        Rule::sum | Rule::product | Rule::signed | Rule::raised | Rule::primary => "a value",
        Rule::of_places => "a signal and its places",
        Rule::pick | Rule::places => "a selection of places",
        Rule::place_of => "a signal at a place",
        Rule::place_word => "a place",
        Rule::list => "a list",
        Rule::item => "a word",
        Rule::alias => "an alias (`outer is L when ..., R when ...`)",
        Rule::axis => "an axis (`distance in m`)",
        Rule::range => "a range (`a to b`)",
        Rule::chain => "a filter chain",
        Rule::step | Rule::steps | Rule::part => "a step",
        Rule::step_when => "`when`",
        Rule::part_item | Rule::phrase_word => "a word or a number",
        Rule::then => "`then`",
        Rule::limit => "a limit",
        Rule::statistic => "a statistic such as `mean` or `std`",
        Rule::at_least => "`at least`",
        Rule::limit_part => "`doubled when`, `times`, `only when` or `for zones`",
        Rule::doubled => "`doubled when`",
        Rule::times => "`times ... when`",
        Rule::only => "`only when`",
        Rule::scope | Rule::each_zone | Rule::zones_only | Rule::sections_only => "`for zones`, `for each zone` or `for sections where`",
        Rule::verdict | Rule::every_limit | Rule::at_least_n => "`when every limit holds` or `when at least N quantities hold`",
        Rule::otherwise => "`otherwise`",
        Rule::not => "`not`",
        Rule::compare | Rule::is | Rule::is_not => "a comparison",
        Rule::add | Rule::minus => "`+` or `-`",
        Rule::multiply | Rule::of => "`*`, `/` or `of`",
        Rule::exponent | Rule::power => "a power",
        Rule::magnitude => "`|...|`",
        Rule::parens => "`(`",
        Rule::extreme | Rule::which => "`larger of`",
        Rule::call => "a function",
        Rule::reduced => "`... of signal`",
        Rule::through => "`through` and a filter",
        Rule::quantity | Rule::number => "a number",
        Rule::percentile => "a percentile such as `p99.85`",
        Rule::name | Rule::path => "a name",
        Rule::unit | Rule::factor | Rule::symbol | Rule::any_unit => "a unit",
        Rule::EOI => "the end",
        Rule::keyword | Rule::modifier | Rule::WHITESPACE | Rule::word_char | Rule::letter => "",
    }
}

fn bytes(pair: &Pair<'_, Rule>) -> Range<usize> {
    let span = pair.as_span();
    let trimmed = pair.as_str().trim_end().len();
    span.start()..span.start() + trimmed
}

fn named(pair: &Pair<'_, Rule>) -> At<String> {
    At { node: pair.as_str().trim().to_string(), range: bytes(pair) }
}

fn pick(pair: Pair<'_, Rule>) -> Pick {
    let text = pair.as_str();
    let start = pair.as_span().start();
    let comma = text.find(',').map_or(usize::MAX, |at| start + at);
    let (words, more) = pair.into_inner().map(|word| named(&word)).partition(|word| word.range.start < comma);
    Pick { words, more }
}

fn step(pair: Pair<'_, Rule>) -> Option<At<Step>> {
    let range = bytes(&pair);
    let mut parts = Vec::new();
    let mut when = None;
    for part in pair.into_inner() {
        match part.as_rule() {
            Rule::part => parts.push(part.into_inner().map(item).collect::<Option<Vec<_>>>()?),
            _ => when = Some(either(part.into_inner().next()?)?),
        }
    }
    Some(At { node: Step { parts, when }, range })
}

fn item(pair: Pair<'_, Rule>) -> Option<At<Item>> {
    let range = bytes(&pair);
    let inner = pair.into_inner().next()?;
    let node = match inner.as_rule() {
        Rule::phrase_word => Item::Word(inner.as_str().trim().to_string()),
        Rule::parens => Item::Value(cases(inner.into_inner().next()?)?),
        _ => Item::Value(At { range: range.clone(), node: quantity(inner)? }),
    };
    Some(At { node, range })
}

fn quantity(pair: Pair<'_, Rule>) -> Option<Node> {
    let mut inner = pair.into_inner();
    let number: f64 = inner.next()?.as_str().parse().ok()?;
    let unit = match inner.next() {
        Some(text) => Some(Unit::parse(text.as_str()).ok()?),
        None => None,
    };
    Some(Node::Number { value: unit.as_ref().map_or(number, |unit| unit.to_si(number)), unit })
}

fn cases(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut arms: Vec<(Phrase, Option<Phrase>)> = Vec::new();
    let mut last = None;
    let mut pending: Option<Phrase> = None;
    for inner in pair.into_inner() {
        if inner.as_rule() == Rule::otherwise {
            last = Some(Box::new(either(inner.into_inner().next()?)?));
            continue;
        }
        let value = either(inner)?;
        match pending.take() {
            Some(first) => arms.push((first, Some(value))),
            None => pending = Some(value),
        }
    }
    if let Some(alone) = pending {
        if arms.is_empty() && last.is_none() {
            return Some(alone);
        }
        arms.push((alone, None));
    }
    Some(At { node: Node::Cases(arms, last), range })
}

/// Folds `a op b op c` from the left.
fn fold(pair: Pair<'_, Rule>, one: fn(Pair<'_, Rule>) -> Option<Phrase>, operator: fn(&str) -> Operator) -> Option<Phrase> {
    let mut inner = pair.into_inner();
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

fn either(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, both, |_| Operator::Or)
}

fn both(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, negation, |_| Operator::And)
}

fn negation(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut inner = pair.into_inner();
    let first = inner.next()?;
    if first.as_rule() == Rule::not {
        return Some(At { node: Node::Not(Box::new(negation(inner.next()?)?)), range });
    }
    comparison(first)
}

/// `a <= b`, and `a <= b <= c` as `a <= b and b <= c`.
fn comparison(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let mut inner = pair.into_inner();
    let mut left = sum(inner.next()?)?;
    let mut all: Option<Phrase> = None;
    while let (Some(op), Some(right)) = (inner.next(), inner.next()) {
        let right = sum(right)?;
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
        let this = At { node: Node::Binary(operator, Box::new(left), Box::new(right.clone())), range };
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

fn sum(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, product, |text| if text == "+" { Operator::Add } else { Operator::Subtract })
}

fn product(pair: Pair<'_, Rule>) -> Option<Phrase> {
    fold(pair, signed, |text| if text == "/" { Operator::Divide } else { Operator::Multiply })
}

fn signed(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let range = bytes(&pair);
    let mut inner = pair.into_inner();
    let first = inner.next()?;
    if first.as_rule() == Rule::minus {
        return Some(At { node: Node::Negative(Box::new(signed(inner.next()?)?)), range });
    }
    let mut parts = first.into_inner();
    let base = primary(parts.next()?)?;
    let Some(exponent) = parts.next() else { return Some(base) };
    let exponent = match exponent.as_str().trim() {
        "²" => 2,
        "³" => 3,
        text => text.trim_start_matches('^').parse().ok()?,
    };
    Some(At { node: Node::Power(Box::new(base), exponent), range })
}

fn primary(pair: Pair<'_, Rule>) -> Option<Phrase> {
    let whole = bytes(&pair);
    let mut inner = pair.into_inner();
    let first = inner.next()?;
    let range = bytes(&first);
    let node = match first.as_rule() {
        Rule::magnitude => Node::Magnitude(Box::new(sum(first.into_inner().next()?)?)),
        Rule::parens => cases(first.into_inner().next()?)?.node,
        Rule::extreme => {
            let mut parts = first.into_inner();
            let which = named(&parts.next()?);
            Node::Call(which, vec![sum(parts.next()?)?, sum(parts.next()?)?])
        }
        Rule::quantity => quantity(first)?,
        Rule::percentile => percentile(&first)?,
        Rule::call => {
            let mut parts = first.into_inner();
            let name = named(&parts.next()?);
            Node::Call(name, parts.map(cases).collect::<Option<Vec<_>>>()?)
        }
        Rule::reduced => {
            let mut parts = first.into_inner();
            let reducer = parts.next()?;
            let node =
                if reducer.as_rule() == Rule::percentile { percentile(&reducer)? } else { Node::Path(reducer.as_str().trim().to_string()) };
            let reducer = At { range: bytes(&reducer), node };
            Node::Reduced(Box::new(reducer), Box::new(signed(parts.next()?)?))
        }
        Rule::place_of => {
            let mut parts = first.into_inner();
            let signal = named(&parts.next()?);
            Node::PlaceOf(signal, parts.map(|word| named(&word)).collect())
        }
        _ => Node::Path(first.as_str().trim().to_string()),
    };
    let mut phrase = At { node, range };
    for through in inner {
        let filter = named(&through.into_inner().next()?);
        phrase = At { node: Node::Through(Box::new(phrase), filter), range: whole.clone() };
    }
    Some(phrase)
}

fn percentile(pair: &Pair<'_, Rule>) -> Option<Node> {
    pair.as_str().trim().trim_start_matches('p').parse().ok().map(Node::Percentile)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use crate::units::SYMBOLS;

    fn text(words: &str) -> Text {
        Text { text: words.to_string(), span: Source::new("test", words).whole(), exact: true }
    }

    fn show(phrase: &Phrase) -> String {
        match &phrase.node {
            Node::Number { value, .. } => format!("{value}"),
            Node::Percentile(percent) => format!("p{percent}"),
            Node::Path(path) => path.clone(),
            Node::Binary(op, a, b) => format!("({op:?} {} {})", show(a), show(b)),
            Node::Negative(a) => format!("(neg {})", show(a)),
            Node::Not(a) => format!("(not {})", show(a)),
            Node::Magnitude(a) => format!("|{}|", show(a)),
            Node::Power(a, n) => format!("{}^{n}", show(a)),
            Node::Call(name, args) => format!("{}({})", name.node, args.iter().map(show).collect::<Vec<_>>().join(" ")),
            Node::Reduced(a, b) => format!("{} of {}", show(a), show(b)),
            Node::PlaceOf(a, words) => format!("{}@{}", a.node, words.iter().map(|w| w.node.as_str()).collect::<Vec<_>>().join(".")),
            Node::Through(a, f) => format!("{}>{}", show(a), f.node),
            Node::Cases(arms, last) => {
                let arms: Vec<_> = arms.iter().map(|(v, c)| format!("{}?{}", show(v), c.as_ref().map_or(String::new(), show))).collect();
                format!("[{}; {}]", arms.join(", "), last.as_ref().map_or(String::new(), |last| show(last)))
            }
        }
    }

    #[test]
    fn expressions_group_as_an_engineer_reads_them() {
        for (words, want) in [
            ("4 kN * (1 + 0.01 * Q0/kN)", "(Multiply 4000 (Add 1 (Divide (Multiply 0.01 Q0) kN)))"),
            ("2/3 of std", "(Multiply (Divide 2 3) std)"),
            ("larger of |p0.15|, |p99.85|", "larger(|p0.15| |p99.85|)"),
            ("|simulated| - |measured|", "(Subtract |simulated| |measured|)"),
            ("400 m <= radius <= 600 m", "(And (LessEqual 400 radius) (LessEqual radius 600))"),
            ("vehicle.category is freight or not vehicle.x", "(Or (Is vehicle.category freight) (not vehicle.x))"),
            ("Y at side R + Y at side L", "(Add Y@side.R Y@side.L)"),
            ("(Y through LP20) / (Q through LP20)", "(Divide Y>LP20 Q>LP20)"),
            (
                "250 m when zone is 1 and v <= 220 km/h, 500 m when zone is 1, otherwise 70 m",
                "[250?(And (Is zone 1) (LessEqual v 61.111111111111114)), 500?(Is zone 1); 70]",
            ),
            ("range of curvature <= 5 % * |mean of curvature|", "(LessEqual range of curvature (Multiply 0.05 |mean of curvature|))"),
            ("-p0.15", "(neg p0.15)"),
            ("x^2 is not 3", "(IsNot x^2 3)"),
        ] {
            let mut problems = Problems::default();
            let phrase = expression(&text(words), &mut problems).unwrap_or_else(|| panic!("{}", problems.render(false)));
            assert_eq!(show(&phrase), want, "{words}");
        }
    }

    #[test]
    fn limits_have_factors_conditions_and_scopes() {
        let mut problems = Problems::default();
        let found = limit(&text("std 0.40 m/s^2, doubled when soft, for zones 3, 4"), &mut problems).expect("a limit");
        assert_eq!(found.statistic.node, "std");
        assert_eq!(found.factors.len(), 1);
        assert!(matches!(&found.scope.node, Scope::Zones(zones) if zones.len() == 2));
        let found = limit(&text("p95 at least 0.8 only when a is b for each zone"), &mut problems).expect("a limit");
        assert!(found.at_least && found.only_when.is_some() && found.scope.node == Scope::EachZone);
    }

    #[test]
    fn chains_split_into_steps_and_parts() {
        let mut problems = Problems::default();
        let found = chain(&text("low-pass 20 Hz, order 4, zero-phase, then sliding mean 2 m every 0.5 m"), &mut problems).expect("a chain");
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].node.parts.len(), 3);
        assert_eq!(found[1].node.parts[0].len(), 5);
    }

    #[test]
    fn every_unit_symbol_can_follow_a_number() {
        for symbol in SYMBOLS.iter().filter(|symbol| !["-", "1"].contains(&symbol.symbol)) {
            let mut problems = Problems::default();
            let phrase = expression(&text(&format!("1 {}", symbol.symbol)), &mut problems).unwrap_or_else(|| panic!("{}", symbol.symbol));
            assert!(matches!(phrase.node, Node::Number { unit: Some(_), .. }), "{}", symbol.symbol);
        }
    }

    #[test]
    fn a_syntax_error_names_the_word() {
        let mut problems = Problems::default();
        assert!(expression(&text("4 kN * * 3"), &mut problems).is_none());
        let shown = problems.render(false);
        assert!(shown.contains("`*` does not fit here"), "{shown}");
    }
}
