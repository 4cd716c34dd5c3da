//! From a document to a [`plan::Plan`]: names resolved, dimensions right, parameters put in, contradictions found.
//!
//! Every problem is noted and checking goes on, so that an author sees all of them in one go.

pub mod diff;
pub mod evaluate;
pub mod family;
mod names;
mod overlap;
pub mod plan;
mod quantities;
mod rules;
mod scalars;
mod signals;
mod steps;

pub use names::normalised;
pub use quantities::DIFFERENCES;

use indexmap::IndexMap;

use crate::problem::{Problem, Problems};
use crate::syntax::document::{Block, Document, Text};
use crate::units::Dimension;
use names::Names;
use plan::{Axis, NamedFilter, Parameter, Plan, SetBy, Step};

/// A parameter set from outside the protocol.
#[derive(Clone, Debug)]
pub struct Override {
    pub text: Text,
    pub set_by: SetBy,
}

pub type Overrides = IndexMap<String, Override>;

struct Checker<'a> {
    blocks: Vec<Block>,
    problems: &'a mut Problems,
    overrides: &'a Overrides,
    names: Names,
    axis: Option<Axis>,
    zone_names: Vec<String>,
    /// Kind and name of the parent's blocks, to tell a misspelt override from a new rule.
    parent_names: Vec<(String, String)>,
    filter_steps: IndexMap<String, Option<Vec<Step>>>,
    signal_depth: usize,
    ddof: usize,
    minimum_signals: usize,
    minimum_pairs: usize,
}

/// The plan of a protocol with its parameters set, or `None` after problems of severity error were noted.
pub fn check(family: &family::Family, overrides: &Overrides, problems: &mut Problems) -> Option<Plan> {
    let document = &family.merged;
    let parent_names = family
        .parent
        .iter()
        .flat_map(|parent| parent.blocks.iter().map(|block| (block.kind.text.clone(), block.name_text().to_string())))
        .collect();
    let mut checker = Checker {
        blocks: document.blocks.clone(),
        problems,
        overrides,
        names: Names::default(),
        axis: None,
        zone_names: document.blocks.iter().filter(|block| block.kind.text == "zone").map(|block| block.name_text().to_string()).collect(),
        parent_names,
        filter_steps: IndexMap::new(),
        signal_depth: 0,
        ddof: 1,
        minimum_signals: 1,
        minimum_pairs: 1,
    };
    let plan = checker.plan(document);
    if problems.any_error() { None } else { plan }
}

impl Checker<'_> {
    fn plan(&mut self, document: &Document) -> Option<Plan> {
        let blocks = self.blocks.clone();
        let of = |kind: &'static str| blocks.iter().filter(move |block| block.kind.text == kind);
        let Some(head) = of("protocol").next() else {
            self.problems.push(
                Problem::error("no-protocol", "the text does not say which protocol it is")
                    .at(&document.source.span(0..0))
                    .help("begin with `protocol name-of-it \"Title\"`"),
            );
            return None;
        };
        self.axis = match self.required(head, "axis") {
            Some(field) => self.axis_field(field, &[Dimension::LENGTH, Dimension::TIME]),
            None => None,
        };
        let time = head.field("time").and_then(|field| self.axis_field(field, &[Dimension::TIME]));
        self.gather_names();
        self.unknown_overrides(head);
        let verdict_block = of("verdict").next();
        self.ddof = self.divisor(verdict_block);
        if let Some(block) = verdict_block {
            self.minimum_signals = self.count(block, "minimum signals", 1).unwrap_or(1);
            self.minimum_pairs = self.count(block, "minimum pairs", 1).unwrap_or(1);
        }
        // Signals and defines that no quantity uses are checked too: a mistake in them would show on the day they are used.
        self.unused_parts();
        let sections = self.section_rules(of("sections").next());
        self.zones_match(&sections);
        let zones = of("zone").filter_map(|block| self.zone(block)).collect();
        let checks = of("check").filter_map(|block| self.section_check(block)).collect();
        let filters = of("filter").filter_map(|block| self.named_filter(block)).collect();
        let quantities: Vec<plan::Quantity> = of("quantity").filter_map(|block| self.quantity(block)).collect();
        if of("quantity").next().is_none() {
            self.problems.push(Problem::error("no-quantity", "the protocol has no quantity: nothing would be compared").at(head.span()));
        }
        let verdict = self.verdict_rule(verdict_block);
        let parameters = self
            .names
            .parameters
            .iter()
            .map(|(name, found)| Parameter {
                name: name.clone(),
                title: found.title.clone(),
                value: found.value_words.clone(),
                default: found.default_words.clone(),
                set_by: found.set_by,
            })
            .collect();
        let text = |key: &str| head.field(key).map(|field| field.value.text.clone());
        Some(Plan {
            name: head.name_text().to_string(),
            title: head.title.as_ref().map_or_else(|| head.name_text().to_string(), |title| title.text.clone()),
            edition: text("edition"),
            source: text("source"),
            scope: text("scope"),
            notes: head.fields_named("note").map(|note| note.value.text.clone()).collect(),
            axis: self.axis.clone()?,
            time,
            parameters,
            vehicle: self.names.vehicle.clone(),
            columns: self.names.columns.clone(),
            filters,
            zones,
            checks,
            sections,
            quantities,
            verdict,
        })
    }

    fn named_filter(&mut self, block: &Block) -> Option<NamedFilter> {
        let steps = self.filter_named(block.name_text(), block.span())?;
        let title = block.title.as_ref().map_or_else(String::new, |title| title.text.clone());
        let source = block.field("source").map(|field| field.value.text.clone());
        Some(NamedFilter { name: block.name_text().to_string(), title, steps, source })
    }

    fn unknown_overrides(&mut self, head: &Block) {
        for (name, given) in self.overrides {
            if !self.names.parameters.contains_key(name)
                && !self.blocks.iter().any(|block| block.kind.text == "parameter" && block.name_text() == name)
            {
                let known: Vec<String> = self.names.parameters.keys().cloned().collect();
                self.problems.push(
                    Problem::error("unknown-parameter", format!("protocol `{}` has no parameter `{name}`", head.name_text()))
                        .at(&given.text.span)
                        .suggest(name, known.iter().map(String::as_str)),
                );
            }
        }
    }

    fn unused_parts(&mut self) {
        let signals: Vec<(String, names::SignalDef)> =
            self.names.signals.iter().map(|(name, signal)| (name.clone(), signal.clone())).collect();
        for (name, signal) in signals {
            let mut at = names::Assignment::new();
            for place in &signal.places {
                if let Some(member) = self.names.places.get(place).and_then(|place| place.members.first()) {
                    at.insert(place.clone(), member.clone());
                }
            }
            let phrase = crate::syntax::phrase::At { node: crate::syntax::phrase::Node::Path(name), range: 0..0 };
            let text = Text { text: String::new(), span: signal.span.clone(), exact: false };
            self.signal(&phrase, &text, &at);
        }
    }
}
