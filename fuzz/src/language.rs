//! The two surfaces of the language, the phrases in its fields, and the check of whole protocols.

use std::sync::Arc;

use fishplate::certify::{Compiled, compile};
use fishplate::check::{Overrides, family};
use fishplate::graph;
use fishplate::library;
use fishplate::problem::{Problem, Problems};
use fishplate::source::Source;
use fishplate::syntax::document::{Document, Text};
use fishplate::syntax::{self, from_pest, in_order, print_text, print_yaml, same_meaning};

use super::promise;

fn read(name: &str, text: &str) -> (Document, Problems) {
    let mut problems = Problems::default();
    let document = syntax::read(&Source::new(name, text), &mut problems);
    (document, problems)
}

/// A protocol as text.
pub fn protocol_text(input: &[u8]) {
    surface("fuzz.fp", input);
}

/// A protocol as YAML.
pub fn protocol_yaml(input: &[u8]) {
    surface("fuzz.yaml", input);
}

/// What is read without a problem survives both forms, and printing again changes nothing. What is
/// refused says where.
fn surface(name: &str, input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let (document, problems) = read(name, text);
    promise::placed(&problems);
    let (as_text, as_yaml) = (print_text(&document), print_yaml(&document));
    if problems.0.is_empty() {
        keeps(&document, &as_text, &as_yaml);
    }
}

#[track_caller]
fn keeps(document: &Document, as_text: &str, as_yaml: &str) {
    let wanted = in_order(document);
    for (name, printed) in [("printed.fp", as_text), ("printed.yaml", as_yaml)] {
        let (again, problems) = read(name, printed);
        assert!(problems.0.is_empty(), "{}\n{printed}", problems.render(false));
        same(&again, &wanted, printed);
        assert_eq!(print_text(&again), as_text, "{printed}");
        assert_eq!(print_yaml(&again), as_yaml, "{printed}");
    }
}

/// The same blocks and fields. The phrases of a field mean the same; their spelling is that of the
/// printer.
#[track_caller]
fn same(again: &Document, wanted: &Document, printed: &str) {
    assert_eq!(again.blocks.len(), wanted.blocks.len(), "{printed}");
    for (a, b) in again.blocks.iter().zip(&wanted.blocks) {
        assert_eq!((&a.kind, &a.name, &a.title), (&b.kind, &b.name, &b.title), "{printed}");
        assert_eq!(a.fields.len(), b.fields.len(), "{printed}");
        for (one, other) in a.fields.iter().zip(&b.fields) {
            assert_eq!(one.key, other.key, "{printed}");
            let (kind, key) = (a.kind.text.as_str(), one.key.text.as_str());
            let alike =
                one.value == other.value || same_meaning(kind, key, &one.value, &other.value);
            assert!(alike, "{} and {}\n{printed}", one.value.text, other.value.text);
        }
    }
}

/// A whole protocol up to its graph. Formatting, and the other form, keep what it means: the same
/// errors, or a graph of as many operations.
pub fn check(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    let (document, problems) = read("fuzz.fp", text);
    if problems.any_error() {
        return;
    }
    let (found, problems) = compiled("fuzz.fp", text);
    promise::told(&problems.0);
    assert!(found.is_some() || problems.any_error(), "refused without a word");
    if let Some(found) = &found {
        let (graph, plan) = (&found.graph, &found.plan);
        assert!(graph::svg(graph).ends_with("</svg>\n"), "a drawing has no end");
        graph::dot(graph);
        graph::text(graph);
        assert!(serde_json::to_string(&graph::json(graph)).is_ok());
        assert!(plan.quantities.len() <= graph.nodes.len(), "quantities without operations");
    }
    for (name, printed) in [("a.fp", print_text(&document)), ("a.yaml", print_yaml(&document))] {
        let (again, others) = compiled(name, &printed);
        assert_eq!(promise::codes(&problems), promise::codes(&others), "{printed}");
        let nodes = |found: &Option<Compiled>| found.as_ref().map(|found| found.graph.nodes.len());
        assert_eq!(nodes(&found), nodes(&again), "{printed}");
    }
}

fn compiled(name: &str, text: &str) -> (Option<Compiled>, Problems) {
    let mut problems = Problems::default();
    let family = family::read(&Source::new(name, text), &shipped, &mut problems);
    let found = compile(family, &Overrides::new(), &mut problems);
    (found, problems)
}

/// Only what the program carries may be extended: a fuzzed text must not choose files of this
/// machine.
fn shipped(name: &str, _: &Source) -> Result<Arc<Source>, Problem> {
    let says = || Problem::error("no-such-protocol", format!("there is no protocol `{name}`"));
    library::shipped(name).ok_or_else(says)
}

/// A rule of the phrases: whether it reads a text.
type Rule = fn(&Text, &mut Problems) -> bool;

/// The rules of the phrases, chosen by the first byte of an input.
pub const PHRASES: [Rule; 11] = [
    |text, problems| from_pest::expression(text, problems).is_some(),
    |text, problems| from_pest::of_places(text, problems).is_some(),
    |text, problems| from_pest::places(text, problems).is_some(),
    |text, problems| from_pest::list(text, problems).is_some(),
    |text, problems| from_pest::alias(text, problems).is_some(),
    |text, problems| from_pest::axis(text, problems).is_some(),
    |text, problems| from_pest::range(text, problems).is_some(),
    |text, problems| from_pest::chain(text, problems).is_some(),
    |text, problems| from_pest::step_alone(text, problems).is_some(),
    |text, problems| from_pest::limit(text, problems).is_some(),
    |text, problems| from_pest::verdict(text, problems).is_some(),
];

/// A phrase of a field. How the blanks between its words are written does not matter.
pub fn phrase(input: &[u8]) {
    let [rule, input @ ..] = input else { return };
    let Ok(text) = std::str::from_utf8(input) else { return };
    let rule = PHRASES[usize::from(*rule) % PHRASES.len()];
    let as_written = phrase_read(rule, text);
    let blanks = text.split([' ', '\n', '\t']).filter(|word| !word.is_empty());
    // Blanks inside quotes belong to a name.
    if !text.contains('"') {
        let tidy = blanks.collect::<Vec<_>>().join(" ");
        if !tidy.is_empty() {
            assert_eq!(as_written, phrase_read(rule, &tidy), "{text:?}");
        }
    }
}

#[track_caller]
fn phrase_read(rule: Rule, text: &str) -> bool {
    let source = Source::new("fuzz", text);
    let mut problems = Problems::default();
    let text = Text { text: text.to_owned(), span: source.whole(), exact: true };
    let read = rule(&text, &mut problems);
    promise::placed(&problems);
    assert!(read || problems.any_error(), "refused without a word");
    read
}
