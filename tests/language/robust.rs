//! Whatever is written, reading and checking end, soon and in words: no panic, no overflow of the
//! stack, no exponential time.

use std::sync::Arc;
use std::time::{Duration, Instant};

use fishplate::check::{self, Overrides, family};
use fishplate::graph;
use fishplate::library;
use fishplate::problem::Problems;
use fishplate::source::Source;
use fishplate::syntax::document::Text;
use fishplate::syntax::{from_pest, print_yaml, read};
use proptest::prelude::*;

/// Reads, checks, and renders what is found; the plan is compiled where there is one.
fn whole_way(source: &Arc<Source>) -> bool {
    let mut problems = Problems::default();
    let family = family::read(source, &library::parent, &mut problems);
    let plan = check::check(&family, &Overrides::new(), &mut problems);
    if let Some(plan) = &plan {
        assert!(!problems.any_error());
        graph::text(&graph::from_plan(plan));
    } else {
        assert!(problems.any_error(), "nothing is said against\n{}", source.text);
    }
    for problem in &problems.0 {
        assert!(
            !problem.says.contains("error of the program"),
            "{}\n{}",
            problem.render(false),
            source.text
        );
        problem.render(false);
    }
    plan.is_some()
}

fn text(words: &str) -> Text {
    Text { text: words.to_string(), span: Source::new("test", words).whole(), exact: true }
}

/// All that is written in phrases of the language, as every kind of phrase.
fn every_phrase(words: &str) {
    let text = text(words);
    let problems = &mut Problems::default();
    from_pest::expression(&text, problems);
    from_pest::of_places(&text, problems);
    from_pest::places(&text, problems);
    from_pest::list(&text, problems);
    from_pest::alias(&text, problems);
    from_pest::axis(&text, problems);
    from_pest::range(&text, problems);
    from_pest::chain(&text, problems);
    from_pest::step_alone(&text, problems);
    from_pest::limit(&text, problems);
    from_pest::verdict(&text, problems);
    problems.render(false);
}

const SHIPPED_TEXTS: [&str; 3] = ["en14363-2016-annex-t", "sprague-geers", "stationary-sway"];

fn shipped(name: &str) -> Arc<Source> {
    library::shipped(name).expect("a shipped protocol")
}

#[test]
fn every_beginning_of_a_protocol_is_read() {
    for name in SHIPPED_TEXTS {
        let source = shipped(name);
        let yaml = print_yaml(&read(&source, &mut Problems::default()));
        for (name, text) in [("cut.fp", &source.text), ("cut.yaml", &yaml)] {
            // A step that is no divisor of common lengths, so that cuts fall everywhere.
            for end in (0..text.len()).step_by(47).filter(|&end| text.is_char_boundary(end)) {
                whole_way(&Source::new(name, &text[..end]));
            }
        }
    }
}

/// Words of a text with what parts them.
fn words(text: &str) -> Vec<&str> {
    text.split_inclusive([' ', '\n', ',', '(', ')', '|']).collect()
}

#[test]
fn a_word_left_out_or_twice_or_exchanged_is_no_harm() {
    for name in SHIPPED_TEXTS {
        let source = shipped(name);
        let words = words(&source.text);
        for at in (0..words.len() - 1).step_by(13) {
            let (before, after) = (words[..at].concat(), words[at + 2..].concat());
            let (this, next) = (words[at], words[at + 1]);
            for change in [next.to_string(), format!("{next}{this}"), format!("{this}{this}{next}")]
            {
                whole_way(&Source::new("changed.fp", format!("{before}{change}{after}")));
            }
        }
    }
}

/// A protocol in which one phrase stands in every field that takes one.
fn protocol_with(phrase: &str) -> String {
    let phrase = phrase.replace(['\n', '#', '"'], " ");
    format!(
        "protocol p \"P\"\n  axis  distance in m\n\nparameter a\n  default  {phrase}\n\nplace side\n  members  R, L\n  alias    outer is {phrase}\n\n\
         section zone\n  one of  zones\n\nsection radius\n  in  m\n\nvehicle Q0\n  in  kN\n\nchannel Y\n  in  kN\n  at  each side\n\n\
         signal S\n  is  {phrase}\n\nfilter F\n  step  {phrase}\n\ndefine d\n  is  {phrase}\n\nzone 1\n  where  {phrase}\n\n\
         sections\n  zone  zone\n\nquantity q\n  of          {phrase}\n  filter      {phrase}\n  value       {phrase}\n  difference  {phrase}\n  limit       std {phrase}\n\n\
         quantity r\n  of          Y\n  value       {phrase}\n  difference  {phrase}\n  limit       {phrase}\n  where       {phrase}\n\nverdict\n  validated  when {phrase}\n"
    )
}

/// What could nest, or be read in two ways, over and over. Two megabytes of stack, as threads have,
/// must do.
#[test]
fn deep_and_long_phrases_end_soon() {
    let many = |piece: &str, count: usize| piece.repeat(count);
    let mut phrases = Vec::new();
    for count in [10, 20, 28, 29, 30, 60, 100, 300, 3000] {
        for (open, middle, close) in [
            ("(", "1", ")"),
            ("not ", "true", ""),
            ("-", "1", ""),
            ("|", "1", "|"),
            ("sqrt(", "1", ")"),
            ("larger(1, ", "1", ")"),
            ("larger(1 when a, ", "1", ")"),
            ("larger of 1, ", "1", ""),
            ("a of ", "b", ""),
            ("mean of (", "Y", ")"),
            ("2 of (", "a", ")"),
            ("(1 when ", "true", ", otherwise 2)"),
            ("(1, ", "1", ")"),
        ] {
            phrases.push(format!("{}{middle}{}", many(open, count), many(close, count)));
            // The same with a fault at its end, which must not be looked for again at every level.
            phrases.push(format!("{}{middle} * *{}", many(open, count), many(close, count)));
            phrases.push(many(open, count));
        }
        for piece in [
            "1 + ",
            "1 * ",
            "true or ",
            "true and ",
            "1 <= ",
            "1 when true, ",
            "a, ",
            "Y at side R + ",
            "1 kN/",
            "then ",
            "order 4, ",
            "p1",
            "|",
            "| ",
            "||- ",
        ] {
            phrases.push(format!("{}1", many(piece, count)));
        }
    }
    phrases.extend([
        many("a+", 10_000) + "a",
        many("|", 20_000),
        many("(", 20_000),
        many("not ", 5_000) + "a",
        many("1 ", 10_000),
    ]);
    for phrase in phrases {
        let begun = Instant::now();
        every_phrase(&phrase);
        whole_way(&Source::new("deep.fp", protocol_with(&phrase)));
        let taken = begun.elapsed();
        // Hundreds of times what it takes, and nothing to what exponential growth would.
        assert!(
            taken < Duration::from_secs(5),
            "{taken:?} for {}",
            phrase.chars().take(60).collect::<String>()
        );
    }
}

/// Definitions and signals that use each other twice at every level double with every line.
#[test]
fn definitions_that_double_each_other_up_are_refused() {
    for (kind, first) in [("define", "is  Q0 + 1 kN"), ("signal", "is  Y at side R")] {
        let mut protocol =
            protocol_with("1").split("signal S").next().expect("a beginning").to_string();
        protocol += &format!("{kind} x0\n  {first}\n\n");
        for level in 1..60 {
            protocol += &format!("{kind} x{level}\n  is  x{0} + x{0}\n\n", level - 1);
        }
        let begun = Instant::now();
        assert!(!whole_way(&Source::new("doubling.fp", protocol)));
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    }
}

/// A long line of definitions, each of the one before, is followed as far as the stack surely
/// holds.
#[test]
fn a_long_line_of_definitions_ends() {
    for (kind, first, next) in [
        ("define", "is  Q0 + 1 kN", "x% + 1 kN"),
        ("signal", "is  Y at side R", "-(x% + 1 kN)"),
        ("parameter", "default  3", "x% + 1"),
    ] {
        for length in [20, 100, 1000] {
            let mut protocol =
                protocol_with("1").split("signal S").next().expect("a beginning").to_string();
            protocol += &format!("{kind} x0\n  {first}\n\n");
            let field = if kind == "parameter" { "default" } else { "is" };
            // From the last to the first, so that each is looked into before the one it is made of.
            for level in (1..length).rev() {
                protocol += &format!(
                    "{kind} x{level}\n  {field}  {}\n\n",
                    next.replace('%', &(level - 1).to_string())
                );
            }
            whole_way(&Source::new("line.fp", protocol));
        }
    }
}

/// Words of the language, names, numbers and signs in any order.
fn token() -> impl Strategy<Value = String> {
    let words = "and or not is when otherwise of at through larger smaller doubled times for only then least each zone zones sections where to every limit \
                 limits quantities hold holds true false simulated measured mean std median p99.85 p0.15 p105 each low-pass band-pass sliding rms resample order \
                 zero-phase causal remove magnitude correlation sprague-geers phase hysteresis maximum over side R L outer 1 2.5 3 kN m/s^2 Hz 1/m % 4a zone Y S F d \
                 radius Q0 vehicle.Q0 section.zone length start sqrt hypot sign ( ) | , + - * / ^2 ² <= >= < > = ; . § ä # \u{0} \" \\ 𝄞";
    let words: Vec<String> =
        words.split(' ').filter(|word| !word.is_empty()).map(str::to_string).collect();
    prop_oneof![9 => prop::sample::select(words), 1 => "[a-zA-Z0-9 .,|()+*/^<>=_-]{0,6}"]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn any_words_are_read(tokens in prop::collection::vec(token(), 0..24)) {
        let phrase = tokens.join(" ");
        every_phrase(&phrase);
        whole_way(&Source::new("any.fp", protocol_with(&phrase)));
    }

    #[test]
    fn any_text_is_read(text in "\\PC{0,200}") {
        every_phrase(&text);
        whole_way(&Source::new("any.fp", text.as_str()));
        whole_way(&Source::new("any.yaml", text.as_str()));
    }
}
