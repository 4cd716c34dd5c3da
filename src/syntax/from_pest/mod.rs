//! From the text of a field to [`super::phrase`]: the only module that uses the rules of
//! `phrase.pest`.

mod depth;
mod explain;
mod tree;
mod units;
mod verdicts;

use std::{ops::Range, sync::Arc, vec::IntoIter};

use pest::{Parser, iterators::Pair};

use super::{
    document::Text,
    phrase::{
        Alias, At, Domain, Limit, Minimum, Node, Number, OfPlaces, Phrase, Pick, Report, Scope,
        Step, normalised,
    },
};
use crate::problem::Problems;
use tree::{cases, either, estimate, pick, step, sum};

pub use verdicts::{outcome, outcome_of_verdict, verdict};

#[derive(pest_derive::Parser)]
#[grammar = "syntax/phrase.pest"]
struct Grammar;

pub fn expression(text: &Text, problems: &mut Problems) -> Option<Phrase> {
    cases(parsed(Rule::expression, text, problems)?.next()?)
}

pub fn of_places(text: &Text, problems: &mut Problems) -> Option<OfPlaces> {
    let mut inner = parsed(Rule::of_places, text, problems)?;
    let mut found = OfPlaces { signal: inner.next()?.named(), picks: Vec::new(), when: None };
    for mut part in inner {
        match part.rule {
            Rule::of_when => found.when = Some(either(part.next()?)?),
            _ => found.picks.push(pick(part)),
        }
    }
    Some(found)
}

pub fn places(text: &Text, problems: &mut Problems) -> Option<Vec<Pick>> {
    Some(parsed(Rule::places, text, problems)?.map(pick).collect())
}

pub fn list(text: &Text, problems: &mut Problems) -> Option<Vec<At<String>>> {
    Some(parsed(Rule::list, text, problems)?.map(|part| part.named()).collect())
}

pub fn alias(text: &Text, problems: &mut Problems) -> Option<Alias> {
    let mut inner = parsed(Rule::alias, text, problems)?.filter(|part| part.rule != Rule::is);
    let name = inner.next()?.named();
    let mut cases = Vec::new();
    while let (Some(member), Some(condition)) = (inner.next(), inner.next()) {
        cases.push((member.named(), either(condition)?));
    }
    Some(Alias { name, cases })
}

/// Name and unit of an axis such as `distance in m`.
pub fn axis(text: &Text, problems: &mut Problems) -> Option<(At<String>, At<String>)> {
    let mut inner = parsed(Rule::axis, text, problems)?;
    Some((inner.next()?.named(), inner.next()?.named()))
}

pub fn range(text: &Text, problems: &mut Problems) -> Option<(Phrase, Phrase)> {
    let mut inner = parsed(Rule::range, text, problems)?;
    Some((sum(inner.next()?)?, sum(inner.next()?)?))
}

pub fn domain(text: &Text, problems: &mut Problems) -> Option<Domain> {
    let mut domain = Domain { over: Vec::new(), each: Vec::new() };
    for mut part in parsed(Rule::domain, text, problems)? {
        if part.rule == Rule::each_keys {
            domain.each = part.map(|key| key.named()).collect();
        } else {
            let of = sum(part.next()?)?;
            domain.over.push((of, part.next().map(|unit| unit.named())));
        }
    }
    Some(domain)
}

pub fn chain(text: &Text, problems: &mut Problems) -> Option<Vec<At<Step>>> {
    parsed(Rule::chain, text, problems)?.map(step).collect()
}

pub fn step_alone(text: &Text, problems: &mut Problems) -> Option<At<Step>> {
    step(parsed(Rule::steps, text, problems)?.next()?)
}

pub fn limit(text: &Text, problems: &mut Problems) -> Option<Limit> {
    let mut inner = parsed(Rule::limit, text, problems)?.peekable();
    let first = inner.next()?;
    let statistic = first.at(normalised(first.written()));
    let estimate = estimate(first)?;
    let mut next_is = |rule| inner.next_if(|part| part.rule == rule).is_some();
    let (at_least, at_most) = (next_is(Rule::at_least), next_is(Rule::at_most));
    let mut bound = inner.next()?;
    let (mut lower, between) = (None, bound.rule == Rule::between);
    if between {
        let mut edges = bound.by_ref().filter(|part| part.rule == Rule::sum);
        lower = Some(sum(edges.next()?)?);
        bound = edges.next()?;
    }
    let mut limit = Limit {
        statistic,
        estimate,
        at_least,
        at_most,
        lower,
        bound: if between { sum(bound)? } else { cases(bound)? },
        factors: Vec::new(),
        only_when: None,
        scope: Scope::default(),
    };
    for mut part in inner {
        let mut part = part.next()?;
        match part.rule {
            Rule::doubled => {
                let two = part.at(Node::Number(Number { value: 2.0, unit: None }));
                limit.factors.push((two, either(part.next()?)?));
            }
            Rule::times => limit.factors.push((sum(part.next()?)?, either(part.next()?)?)),
            Rule::only => {
                let condition = either(part.next()?)?;
                if limit.only_when.is_some() {
                    problems.push(explain::twice("only when", text, part.range));
                    return None;
                }
                limit.only_when = Some(condition);
            }
            _ => {
                if !limit.scope.is_all() {
                    problems.push(explain::twice("for ...", text, part.range));
                    return None;
                }
                limit.scope = scope(part.next()?)?;
            }
        }
    }
    Some(limit)
}

/// How many there must be: `24`, `3 for each zone and wheelset`.
pub fn minimum(text: &Text, problems: &mut Problems) -> Option<Minimum> {
    let mut inner = parsed(Rule::minimum, text, problems)?;
    Some(Minimum { count: cases(inner.next()?)?, scope: scope_or_all(inner.next())? })
}

/// An estimate without a limit: `mean for each zone`, `total of length in km`.
pub fn report(text: &Text, problems: &mut Problems) -> Option<Report> {
    let mut inner = parsed(Rule::report, text, problems)?.peekable();
    let of = cases(inner.next()?)?;
    let unit = inner.next_if(|part| part.rule == Rule::coordinate_unit).map(|unit| unit.named());
    Some(Report { of, unit, scope: scope_or_all(inner.next())? })
}

fn scope_or_all(part: Option<Parsed>) -> Option<Scope> {
    part.map_or(Some(Scope::default()), |mut part| scope(part.next()?))
}

fn scope(part: Parsed) -> Option<Scope> {
    let mut scope = Scope::default();
    for mut part in part {
        match part.rule {
            Rule::zone => scope.zones.push(part.named()),
            Rule::each_keys => scope.each = keys(part),
            Rule::scope_where => scope.condition = Some(either(part.next()?)?),
            _ => scope.condition = Some(either(part)?),
        }
    }
    Some(scope)
}

/// Whether a word is one of the language, so that no part of a protocol can be called by it.
pub fn is_word_of_language(word: &str) -> bool {
    const VALUES: [&str; 8] =
        ["to", "every", "each", "all", "true", "false", "simulated", "measured"];
    is_keyword(word) || VALUES.contains(&word)
}

/// Whether a word holds phrases together, and so is never a name in them.
fn is_keyword(word: &str) -> bool {
    Grammar::parse(Rule::keyword, word).is_ok()
}

/// A field that is parsed with one rule. A syntax error becomes a problem at its word.
fn parsed(rule: Rule, text: &Text, problems: &mut Problems) -> Option<Parsed> {
    if let Some(problem) = depth::too_deep(text) {
        problems.push(problem);
        return None;
    }
    match Grammar::parse(rule, &units::marked(&text.text)) {
        Ok(mut pairs) => Some(Parsed::new(pairs.next()?, &Arc::new(text.clone()))),
        Err(error) => {
            problems.push(explain::syntax(rule, &error, text));
            None
        }
    }
}

/// `each zone and running gear`: a name of several words has `_` between them, as where it is
/// declared.
fn keys(part: Parsed) -> Vec<At<String>> {
    part.map(|key| key.at(normalised(key.written()).replace(' ', "_"))).collect()
}

/// A part of a parsed phrase with its bytes in the field's text; it gives the parts in it one by
/// one, without the keywords.
struct Parsed {
    rule: Rule,
    text: Arc<Text>,
    range: Range<usize>,
    inner: IntoIter<Parsed>,
}

impl Iterator for Parsed {
    type Item = Self;
    fn next(&mut self) -> Option<Self> {
        self.inner.next()
    }
}

impl Parsed {
    fn new(pair: Pair<'_, Rule>, text: &Arc<Text>) -> Self {
        let (rule, start) = (pair.as_rule(), pair.as_span().start());
        let written = text.text[start..pair.as_span().end()].trim_end().len();
        let inner = pair.into_inner().filter(|pair| !explain::joins(pair.as_rule()));
        let inner: Vec<Self> = inner.map(|pair| Self::new(pair, text)).collect();
        let range = start..start + written;
        Self { rule, text: Arc::clone(text), range, inner: inner.into_iter() }
    }

    fn written(&self) -> &str {
        &self.text.text[self.range.clone()]
    }

    fn at<T>(&self, node: T) -> At<T> {
        At { node, text: Arc::clone(&self.text), range: self.range.clone() }
    }

    fn named(&self) -> At<String> {
        self.at(self.written().to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use crate::units::SYMBOLS;

    fn text(words: &str) -> Text {
        Text { text: words.to_string(), span: Source::new("test", words).whole(), exact: true }
    }

    #[test]
    fn a_blank_that_is_no_space_is_named_and_underlined() {
        for (words, place) in
            [("e\u{c}\u{2212}ove", 1..2), ("2 \u{a0}kN", 2..4), ("a + \u{feff}b", 4..7)]
        {
            let mut problems = Problems::default();
            assert!(expression(&text(words), &mut problems).is_none(), "{words:?}");
            let at = problems.0[0].at.as_ref().expect("a place");
            assert_eq!(
                (at.start..at.end, problems.0[0].help.as_deref()),
                (place, Some("write an ordinary space")),
                "{words:?}"
            );
            assert!(
                problems.0[0].says.starts_with("the special blank U+"),
                "{}",
                problems.0[0].says
            );
        }
    }

    /// A phrase with the parts of each operator in parentheses; numbers in SI.
    fn shown(phrase: &Phrase) -> String {
        let all = |phrases: &[Phrase]| phrases.iter().map(shown).collect::<Vec<_>>().join(" ");
        match &phrase.node {
            Node::Number(Number { value, .. }) => {
                format!("{value:.11e}").parse::<f64>().expect("a number").to_string()
            }
            Node::Percentile(percent) => format!("p{percent}"),
            Node::Table { of, points, held } => {
                let points = points.iter().map(|(x, y)| format!("({} {})", shown(x), shown(y)));
                format!("(table {} {}{held})", shown(of), points.collect::<String>())
            }
            Node::PercentileBy(of) => format!("(percentile {})", shown(of)),
            Node::Path(path) => path.clone(),
            Node::Binary(operator, left, right) => {
                format!("({operator:?} {} {})", shown(left), shown(right))
            }
            Node::Negative(inner) => format!("(neg {})", shown(inner)),
            Node::Not(inner) => format!("(not {})", shown(inner)),
            Node::Magnitude(inner) => format!("|{}|", shown(inner)),
            Node::Power(inner, exponent) => format!("{}^{}", shown(inner), shown(exponent)),
            Node::Call(name, arguments) => format!("{}({})", name.node, all(arguments)),
            Node::Reduced(reducer, signal) => format!("{} of {}", shown(reducer), shown(signal)),
            Node::PlaceOf(signal, words) => {
                let words: Vec<&str> = words.iter().map(|word| word.node.as_str()).collect();
                format!("{}@{}", signal.node, words.join("."))
            }
            Node::Through(inner, steps) => {
                let words: Vec<String> = steps.iter().map(At::words).collect();
                format!("{}>{}", shown(inner), words.join(";"))
            }
            Node::Cases(arms, otherwise) => {
                let arms: Vec<String> = arms
                    .iter()
                    .map(|(value, condition)| format!("{}?{}", shown(value), shown(condition)))
                    .collect();
                let otherwise = otherwise.as_deref().map_or(String::new(), shown);
                format!("[{}; {otherwise}]", arms.join(", "))
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn phrases_that_mean_the_same_are_equal() {
        let limit = |words: &str| limit(&text(words), &mut Problems::default()).expect("a limit");
        let first = limit("std 0.40 m/s^2, doubled when soft, for zones 3, 4 and each wheelset");
        let spelt = "std 400 mm/s², times 2 when soft, for zones 4, 3 and each wheelset";
        assert!(first == limit(spelt));
        assert!(first != limit(&spelt.replace("400", "401")));
        assert!(first != limit(&spelt.replace("4, 3", "4")));
        assert!(first.same_slot(&limit("std 9 m/s^2 for zones 3, 4 and each wheelset")));
        let phrase = |words: &str| expression(&text(words), &mut Problems::default());
        assert!(phrase("5 % * |mean of Y|") == phrase("0.05*| mean  of Y |"));
    }

    #[test]
    fn expressions_group_as_an_engineer_reads_them() {
        for (words, want) in [
            ("4 kN * (1 + 0.01 * Q0/kN)", "(Multiply 4000 (Add 1 (Divide (Multiply 0.01 Q0) kN)))"),
            ("2/3 of std", "(Multiply (Divide 2 3) std)"),
            ("larger of |p0.15|, |p99.85|", "larger(|p0.15| |p99.85|)"),
            ("|simulated| - |measured|", "(Subtract |simulated| |measured|)"),
            ("400 m <= radius <= 600 m", "(And (LessEqual 400 radius) (LessEqual radius 600))"),
            (
                "vehicle.category is freight or not vehicle.x",
                "(Or (Is vehicle.category freight) (not vehicle.x))",
            ),
            ("Y at side R + Y at side L", "(Add Y@side.R Y@side.L)"),
            ("(Y through LP20) / (Q through LP20)", "(Divide Y>LP20 Q>LP20)"),
            (
                "Y through LP20-Q through low-pass 10 Hz - 2",
                "(Subtract (Subtract Y>LP20 Q>low-pass 10 Hz) 2)",
            ),
            (
                "Y through (low-pass 10 Hz, order 4, then magnitude)",
                "Y>low-pass 10 Hz, order 4;magnitude",
            ),
            (
                "250 m when zone is 1 and v <= 220 km/h, 500 m when zone is 1, otherwise 70 m",
                "[250?(And (Is zone 1) (LessEqual v 61.1111111111)), 500?(Is zone 1); 70]",
            ),
            (
                "range of curvature <= 5 % * |mean of curvature|",
                "(LessEqual range of curvature (Multiply 0.05 |mean of curvature|))",
            ),
            ("-p0.15", "(neg p0.15)"),
            ("x^2 is not 3", "(IsNot x^2 3)"),
            ("1\tm + 2\n  m", "(Add 1 2)"),
        ] {
            let mut problems = Problems::default();
            let phrase = expression(&text(words), &mut problems)
                .unwrap_or_else(|| panic!("{}", problems.render(false)));
            assert_eq!(shown(&phrase), want, "{words}");
        }
    }

    #[test]
    fn limits_have_factors_conditions_and_scopes() {
        let mut problems = Problems::default();
        let found =
            limit(&text("std 0.40 m/s^2, doubled when soft, for zones 3, 4"), &mut problems)
                .expect("a limit");
        assert_eq!(found.statistic.node, "std");
        assert_eq!(found.factors.len(), 1);
        assert!(found.scope.zones.len() == 2);
        let found = limit(&text("p95 at least 0.8 only when a is b for each zone"), &mut problems)
            .expect("a limit");
        assert!(found.at_least && !found.at_most);
        assert!(found.only_when.is_some() && found.scope.each[0].node == "zone");
        let found = limit(&text("(mean + 3 * std) at most 60 kN"), &mut problems).expect("a limit");
        assert!(found.at_most && !found.at_least);
    }

    #[test]
    fn minima_have_scopes() {
        let mut problems = Problems::default();
        let found =
            minimum(&text("needed - 1 for each zone and running gear where v > 3"), &mut problems)
                .expect("a minimum");
        let keys: Vec<&str> = found.scope.each.iter().map(|key| key.node.as_str()).collect();
        assert_eq!(keys, ["zone", "running_gear"]);
        assert!(found.scope.condition.is_some());
        assert!(minimum(&text("24"), &mut problems).expect("a minimum").scope.is_all());
    }

    #[test]
    fn chains_split_into_steps_and_parts() {
        let mut problems = Problems::default();
        let found = chain(
            &text("low-pass 20 Hz, order 4, zero-phase, then sliding mean 2 m every 0.5 m"),
            &mut problems,
        )
        .expect("a chain");
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].node.parts.len(), 3);
        assert_eq!(found[1].node.parts[0].len(), 5);
    }

    #[test]
    fn every_unit_symbol_can_follow_a_number() {
        for symbol in SYMBOLS.iter().filter(|symbol| !["-", "1"].contains(&symbol.symbol)) {
            let mut problems = Problems::default();
            let phrase = expression(&text(&format!("1 {}", symbol.symbol)), &mut problems)
                .unwrap_or_else(|| panic!("{}", symbol.symbol));
            assert!(
                matches!(phrase.node, Node::Number(Number { unit: Some(_), .. })),
                "{}",
                symbol.symbol
            );
        }
    }

    #[test]
    fn a_syntax_error_names_the_word() {
        let mut problems = Problems::default();
        assert!(expression(&text("4 kN * * 3"), &mut problems).is_none());
        let shown = problems.render(false);
        assert!(shown.contains("`*` is not allowed here"), "{shown}");
    }
}
