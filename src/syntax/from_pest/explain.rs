//! Messages for syntax errors, in the words of the language and not of the grammar.

use std::ops::Range;

use pest::error::{Error, ErrorVariant, InputLocation};

use super::{Rule, is_keyword};
use crate::problem::{Problem, error, problem};
use crate::syntax::{document::Text, idiom, phrase::normalised};
use crate::units::Unit;

pub(super) fn twice(what: &str, text: &Text, range: Range<usize>) -> Problem {
    problem!("syntax", &text.place(range), "a limit can have only one `{what}`")
        .help("write two limits, or join the conditions with `and`")
}

pub(super) fn syntax(rule: Rule, failed: &Error<Rule>, text: &Text) -> Problem {
    let at = match failed.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    let (before, rest) = text.text.split_at(at.min(text.text.len()));
    let found = first_word(rest);
    if let Some(problem) = decimal_comma(at, text) {
        return problem;
    }
    let at = at + (rest.len() - after_blanks(rest).len());
    if let Some(problem) = unknown_unit(before, found, at, text) {
        return problem;
    }
    // Pasted text can contain blanks that look like a space or are invisible.
    let odd_blank =
        found.chars().next().filter(|c| c.is_whitespace() || matches!(c, '\u{200b}' | '\u{feff}'));
    let says = if found.is_empty() {
        format!("{} ends too early", in_words(rule))
    } else if let Some(blank) = odd_blank {
        format!("the special blank U+{:04X} is not allowed in {}", u32::from(blank), in_words(rule))
    } else {
        format!("`{found}` is not allowed here in {}", in_words(rule))
    };
    let mut expected: Vec<&str> = Vec::new();
    if let ErrorVariant::ParsingError { positives, .. } = &failed.variant {
        for positive in positives {
            let word = in_words(*positive);
            if !word.is_empty() && !expected.contains(&word) {
                expected.push(word);
            }
        }
    }
    // Where an operator is possible, `at`, `through` and `over` are possible as well, but seldom
    // meant.
    if expected.contains(&OPERATOR) {
        expected.retain(|word| {
            ![Rule::kw_at, Rule::kw_through, Rule::kw_over].map(in_words).contains(word)
        });
    }
    // So are weights and the groups of an estimate in parentheses.
    expected.retain(|word| {
        *word != in_words(Rule::kw_weighted)
            && (rule != Rule::expression || *word != in_words(Rule::kw_for))
    });
    // In an exact text, the error is underlined at the word, or at the last word if the text ends
    // too early.
    let end = text.text.trim_end().len();
    let last = text.text[..end].rfind(char::is_whitespace).map_or(0, |at| at + 1);
    let range = if found.is_empty() { last..end } else { at..at + found.len() };
    let problem = error("syntax", says, &text.place(range));
    if odd_blank.is_some() {
        return problem.help("write an ordinary space");
    }
    if let Some(help) = advice(rule, before, found, text) {
        return problem.help(help);
    }
    match expected.as_slice() {
        [] => problem,
        [..] if expected.len() <= 6 => problem.help(format!("expected {}", one_of(&expected))),
        _ => problem.help(format!("expected {}, ...", expected[..6].join(", "))),
    }
}

/// What is probably meant by a text with an error, or how it is written.
fn advice(rule: Rule, before: &str, found: &str, text: &Text) -> Option<String> {
    const SIGNS: [&str; 5] = ["+", "-", "−", "*", "/"];
    let words = before.split_whitespace().count();
    if rule == Rule::expression && joins_places(before) {
        return Some(
            "in an expression, write places without `and`: `NAME at PLACE MEMBER PLACE MEMBER`"
                .into(),
        );
    }
    if rule == Rule::of_places && (SIGNS.contains(&found) || ["|", "("].contains(&found)) {
        let is = normalised(&text.text);
        return Some(format!(
            "`of` names one signal; declare what is computed: `signal NAME` with `is  {is}`"
        ));
    }
    if let Some(step) = step_after_through(before) {
        return Some(format!(
            "after `through` stands the name of a filter: declare `filter NAME` with `step  {step} ...`, and write `through NAME`"
        ));
    }
    if rule == Rule::limit && SIGNS.contains(&found) && words == 1 {
        return Some("write an estimate of several statistics in parentheses: `limit (mean + 3 * std) 60 kN`".into());
    }
    if rule == Rule::limit && words == 2 && found.starts_with(|c: char| c.is_ascii_digit()) {
        return Some("a statistic is one word, such as `mean`, `std` (standard deviation) or `p95`: `limit std 5 kN`".into());
    }
    None
}

/// A decimal comma, such as `0,5`: a comma between two digits where no comma is possible.
fn decimal_comma(at: usize, text: &Text) -> Option<Problem> {
    let bytes = text.text.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    // The comma itself or, where a comma is possible, the text after it.
    let comma = [Some(at), at.checked_sub(1)]
        .into_iter()
        .flatten()
        .find(|&at| bytes.get(at) == Some(&b','))?;
    if comma == 0 || !digit(comma - 1) || !digit(comma + 1) {
        return None;
    }
    let start = (0..comma).rev().take_while(|&at| digit(at)).last()?;
    let end = (comma + 1..bytes.len()).take_while(|&at| digit(at)).last()? + 1;
    let number = &text.text[start..end];
    Some(
        problem!("decimal-comma", &text.place(start..end), "`{number}` has a decimal comma")
            .help(format!("write numbers with a point: `{}`", number.replace(',', "."))),
    )
}

/// An unknown unit, such as `4 kn`: a word after a number that is not a word of the language.
fn unknown_unit(before: &str, found: &str, at: usize, text: &Text) -> Option<Problem> {
    const FOLLOW: [&str; 7] = ["to", "every", "quantities", "where", "each", "hold", "holds"];
    let last = before
        .trim_end()
        .rsplit(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.')))
        .next()
        .unwrap_or("");
    if last.parse::<f64>().is_err()
        || is_keyword(found)
        || FOLLOW.contains(&found)
        || !found.starts_with(char::is_alphabetic)
    {
        return None;
    }
    let unknown = Unit::parse(found).err()?;
    let problem = problem!(
        "unknown-unit",
        &text.place(at..at + found.len()),
        "`{}` is not a known unit",
        unknown.word
    );
    Some(match unknown.near.filter(|_| !is_name(found)) {
        Some(near) => problem.meant(near),
        None if let Some(help) = idiom(found) => problem.help(help),
        None => {
            let product = format!("{last} * {}", up_to_keyword(&text.text[at..]));
            problem.help(format!("a product is written with its sign: `{product}`; units are written like kN, m/s^2, km/h, mrad"))
        }
    })
}

/// Whether a word is rather a name than a misspelt unit: `Q0`, `k_1`.
fn is_name(word: &str) -> bool {
    let first = word.split(['/', '*', '^', '-']).next().unwrap_or(word);
    first.contains('_') || first.contains(|c: char| c.is_ascii_digit())
}

/// The rest of a product: to the next comma, keyword, or parenthesis that closes more than it
/// opens.
fn up_to_keyword(text: &str) -> &str {
    const END: [&str; 9] =
        ["when", "for", "only", "doubled", "times", "otherwise", "and", "or", "then"];
    let mut depth = 0_i32;
    let mut word_from = None;
    for (at, c) in text.char_indices() {
        if c.is_alphanumeric() || c == '_' {
            let from = *word_from.get_or_insert(at);
            let end = text[from..]
                .find(|c: char| !(c.is_alphanumeric() || c == '_'))
                .map_or(text.len(), |end| from + end);
            if from == at && END.contains(&&text[from..end]) {
                return text[..at].trim_end();
            }
            continue;
        }
        word_from = None;
        depth += i32::from(c == '(') - i32::from(c == ')');
        if c == ',' && depth == 0 || depth < 0 {
            return text[..at].trim_end();
        }
    }
    text.trim_end()
}

/// Whether the text ends as `Y at wheelset 1 and side`, before `R`.
fn joins_places(before: &str) -> bool {
    let words: Vec<&str> = before.split_whitespace().collect();
    matches!(words.as_slice(), [.., "and", _]) && words.contains(&"at")
}

/// The word of a filter step that is written where the name of a filter is expected: a text that
/// ends in `through low-pass`, before its number.
fn step_after_through(before: &str) -> Option<&str> {
    let (_, step) = before.rsplit_once("through ")?;
    let step = step.trim();
    let of_step = |c: char| c.is_ascii_alphabetic() || matches!(c, '-' | ' ');
    (step.contains(['-', ' ']) && step.chars().all(of_step)).then_some(step)
}

fn after_blanks(text: &str) -> &str {
    text.trim_start_matches([' ', '\t', '\r', '\n'])
}

/// The first word or sign of a text, after blanks of the grammar. Other blanks count as a sign.
fn first_word(text: &str) -> &str {
    let text = after_blanks(text);
    let of_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '/' | '^' | '-');
    let mut end = text.find(|c| !of_word(c)).unwrap_or(text.len());
    if end == 0 || !text.starts_with(char::is_alphanumeric) {
        end = text.chars().next().map_or(0, char::len_utf8);
    }
    let most = text.char_indices().map(|(at, _)| at).nth(24).unwrap_or(text.len());
    &text[..end.min(most)]
}

fn one_of(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_string(),
        [start @ .., last] => format!("{} or {last}", start.join(", ")),
    }
}

/// Words that hold a phrase together and have no value.
pub(super) fn joins(rule: Rule) -> bool {
    use Rule::*;
    matches!(
        rule,
        EOI | kw_and
            | kw_or
            | kw_when
            | kw_otherwise
            | kw_at
            | kw_through
            | kw_doubled
            | kw_times
            | kw_only
            | kw_for
            | kw_zones
            | kw_each
            | kw_sections
            | kw_where
            | kw_to
            | kw_in
            | kw_every
            | kw_near
            | kw_within
            | kw_over
            | kw_confidence
            | kw_percentile
            | kw_table
            | kw_weighted
            | kw_by
            | kw_holds
            | then
            | comma
            | close_bar
            | close_paren
    )
}

const OPERATOR: &str = "an operator";

/// Name of a grammar rule in messages; empty where it would not help.
fn in_words(rule: Rule) -> &'static str {
    use Rule::*;
    match rule {
        expression | cases | either | both | negation | comparison => "an expression",
        sum | product | signed | raised | primary => "a value",
        of_places => "a signal and its places",
        pick | places => "a selection of places",
        place_of => "a signal at a place",
        place_word => "a place",
        list => "a list",
        item => "a word",
        alias => "an alias (`outer is L when ..., R when ...`)",
        axis => "an axis (`distance in m`)",
        range => "a range (`a to b`)",
        domain | coordinate => "what spans a domain (`a, b for each c`)",
        chain => "a filter chain",
        step | steps | part | steps_inside | step_inside | part_inside => "a step",
        step_when | of_when | kw_when => "`when`",
        part_item | phrase_word | item_inside | word_inside => "a word or a number",
        then => "`then`",
        limit => "a limit",
        statistic => "a statistic such as `mean` or `std`, or an estimate in parentheses",
        at_least => "`at least`",
        at_most => "`at most`",
        between | kw_between => "`between`",
        limit_part => "`doubled when`, `times`, `only when` or `for zones`",
        doubled | kw_doubled => "`doubled when`",
        times | kw_times => "`times ... when`",
        only | kw_only => "`only when`",
        scope | each_group | zones_only | sections_only | kw_for => {
            "`for zones`, `for each zone` or `for sections where`"
        }
        each_keys => "`each` and a key such as `zone` or a place",
        key | key_word => "a key such as `zone` or a place",
        fit | fit_kind => "`prediction over ... at ...`",
        regressor => "section data, or an expression of them in parentheses",
        fit_option | tails => "`one-sided` or `two-sided`",
        confidence | kw_confidence => "`confidence` and a share",
        bound_of | end => "`upper 95 % of ...`",
        by_bootstrap => "`by bootstrap`",
        weighted | kw_weighted => "`weighted by ...`",
        kw_by => "`by`",
        weight => "a weight: section data, or an expression of them in parentheses",
        for_groups => "`for each ...`",
        minimum => "a minimum",
        report => "an estimate such as `mean` or `total of length`",
        share | counted => "`share where ...`",
        in_quotes => "a name in quotes",
        over | kw_over => "`over`",
        over_what => "a signal",
        verdict | verdict_rule => "the rule of a verdict",
        outcome | outcome_of_verdict | outcome_word => "`good: holds when ...`",
        outcome_holds | outcome_fails => "`holds` or `fails`",
        every_limit => "`every limit holds`",
        in_draws | kw_draws => "`in 95 % of draws`",
        at_least_n => "`at least N quantities hold`",
        some_verdict | all_verdicts | one_verdict | named_verdict => "`some_verdict holds`",
        enough_verdicts => "`at least N of a, b, c hold`",
        verdict_name => "the name of a verdict",
        does_not_hold => "`does not hold`",
        of_quantities | of_limits => "`quantities` or `limits`",
        otherwise | kw_otherwise => "`otherwise`",
        not => "`not`",
        compare | is | is_not | add | multiply | of | exponent | square_cube | kw_and | kw_or => {
            OPERATOR
        }
        near | kw_near => "`near ... within ...`",
        kw_within => "`within` and a tolerance",
        a_factor_of => "`a factor of`",
        minus => "`-`",
        magnitude => "`|...|`",
        parens => "`(`",
        extreme | which => "`larger of`",
        call => "a function",
        reduced => "`... of signal`",
        through | kw_through => "`through` and a filter",
        quantity | number => "a number",
        percentile => "a percentile such as `p99.85`",
        of_percentile | percentile_by | kw_percentile => "`percentile` and a number",
        constant => "a number or a parameter",
        table | kw_table => "`table x: (x, y), ...`",
        point => "a point such as `(300 m, 1.2)`",
        held => "`held`",
        name | path | label | plain => "a name",
        unit | any_unit | coordinate_unit => "a unit",
        zone => "a zone",
        kw_at => "`at`",
        kw_zones => "`zones`",
        kw_each => "`each`",
        kw_sections => "`sections`",
        kw_where | scope_where => "`where`",
        kw_to => "`to`",
        kw_in => "`in`",
        kw_every => "`every`",
        kw_holds => "`hold`",
        comma => "`,`",
        close_bar => "`|`",
        close_paren => "`)`",
        EOI => "the end",
        keyword | modifier | WHITESPACE | word_char | letter | any_char | mark => "",
    }
}
