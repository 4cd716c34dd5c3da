//! Checks a document and turns it into a [`plan::Plan`]: resolves names, checks dimensions, inserts
//! parameters, finds contradictions.
//!
//! Checking goes on after an error, so that an author sees all of them in one run.

mod cases;
mod clauses;
mod closed;
mod compared;
mod conditions;
pub mod confirm;
pub mod constant;
mod declared;
pub mod diff;
mod domains;
mod estimates;
pub mod evaluate;
mod expressions;
pub mod family;
mod find;
mod finish;
mod functions;
mod groups;
mod idle;
mod intervals;
mod like;
mod limits;
mod metrics;
mod minima;
mod names;
mod near;
mod outcomes;
mod overlap;
mod overlay;
mod overrides;
mod parameters;
pub mod plan;
mod plausibility;
mod positions;
pub mod possible;
mod prelude;
mod printed;
mod quantities;
mod records;
mod references;
mod reports;
mod resolve;
mod rules;
mod samples;
mod scope;
mod signals;
mod slips;
mod spectra;
mod steps;
mod tables;
mod transfer;
mod unused;
pub mod values;
mod verdicts;
mod weights;
mod wordings;

pub use crate::syntax::phrase::normalised;

use std::collections::BTreeSet;

use indexmap::IndexMap;

pub use overrides::{Override, Overrides};

use crate::problem::{Problem, Problems, error, problem};
use crate::source::{Span, Spanned};
use crate::syntax::{
    document::{Block, Document, Field, Text},
    from_pest,
};
use crate::units::Dimension;
use finish::{in_reading_order, name_after_number, rule_count, set_outside, written_rules};
use groups::Grouped;
use names::Names;
use plan::{Axis, Expr, NamedFilter, Parameter, Plan, StatedValues, Step};
use scope::Scope;

/// Largest depth of nested expressions, definitions and signals together. The stack is large enough
/// for it.
const DEEPEST: usize = 80;
/// Largest number of parts of expressions that are checked. Definitions that use each other twice
/// double at every level and would exceed it.
const MOST_WORK: usize = 200_000;

struct Checker<'a> {
    blocks: Vec<Block>,
    problems: &'a mut Problems,
    overrides: &'a Overrides,
    names: Names,
    axis: Option<Axis>,
    zone_names: Vec<String>,
    /// The zone of a section, where there are zones.
    zone: Option<Expr>,
    /// Kind and name of the parent's blocks, to distinguish a misspelt override from a new rule.
    parent_names: Vec<(String, String)>,
    filter_steps: IndexMap<String, Option<Vec<Step>>>,
    /// Named parts being checked, innermost last. One that occurs again is defined by itself.
    open: Vec<String>,
    /// Named parts found to be defined by themselves.
    looped: BTreeSet<String>,
    used_defines: BTreeSet<String>,
    /// Conditions that hold wherever the present expression is evaluated.
    assumed: Vec<Expr>,
    in_quantity: bool,
    /// Values that are to be confirmed.
    values: StatedValues,
    /// Whether what was looked at since this was last put to false has a number that is not
    /// confirmed.
    unconfirmed: bool,
    /// The time of the records, where they have one.
    time: Option<Axis>,
    /// The present expression is one of several values; each applies only in its own cases.
    partial: bool,
    /// Names of campaigns that conditions ask for.
    campaigns: Vec<Spanned<String>>,
    depth: usize,
    work: usize,
    ddof: usize,
    minimum_signals: usize,
    minimum_pairs: usize,
    /// Minimum counts of groups that every quantity has unless it gives its own.
    minimum_of_groups: Vec<Field>,
    /// What the scopes that are looked at group.
    grouped: Grouped,
    /// The limits of each quantity, which may refer to each other.
    limited: Vec<references::Limited>,
}

/// What is checked only where it is written: nothing if it is not, `None` if it has an error.
fn if_written<T>(checked: Option<Option<T>>) -> Option<Option<T>> {
    checked.map_or(Some(None), |checked| checked.map(Some))
}

/// The plan of a protocol with its parameters set; `None` after a problem of severity error.
pub fn check(
    family: &family::Family,
    overrides: &Overrides,
    problems: &mut Problems,
) -> Option<Plan> {
    let document = &family.merged;
    let parent_names = family
        .parent()
        .iter()
        .flat_map(|parent| {
            parent.blocks.iter().map(|block| (block.kind.text.clone(), block.own_name()))
        })
        .collect();
    let mut checker = Checker {
        blocks: document.blocks.clone(),
        problems,
        overrides,
        names: Names::default(),
        axis: None,
        zone_names: document
            .blocks
            .iter()
            .filter(|block| block.kind.text == "zone")
            .map(|block| block.own_name())
            .collect(),
        zone: None,
        parent_names,
        filter_steps: IndexMap::new(),
        open: Vec::new(),
        looped: BTreeSet::new(),
        used_defines: BTreeSet::new(),
        assumed: Vec::new(),
        in_quantity: false,
        values: confirm::values(&document.blocks, overrides),
        unconfirmed: false,
        time: None,
        partial: false,
        campaigns: Vec::new(),
        depth: 0,
        work: 0,
        ddof: 1,
        minimum_signals: 1,
        minimum_pairs: 1,
        minimum_of_groups: Vec::new(),
        grouped: Grouped::default(),
        limited: Vec::new(),
    };
    let before = checker.problems.0.len();
    let plan = checker.plan(document);
    checker.slips(family);
    if plan.is_some() && !checker.problems.any_error() {
        checker.unused(family);
    }
    let names = std::mem::take(&mut checker.names);
    if plan.is_some() && !problems.any_error() {
        let checked = plan.as_ref().map_or(0, rule_count);
        let written = document.blocks.iter().map(written_rules).sum::<usize>();
        // A rule that is lost would change the verdict without a message.
        if checked < written {
            problems.push(Problem::error(
                "internal",
                format!("the text has {written} rules and {checked} were checked; this is an error of the program"),
            ));
        }
    }
    let told = problems.0.split_off(before);
    problems.0.extend(told.into_iter().filter(|problem| family.may_tell(problem)));
    for problem in &mut problems.0[before..] {
        name_after_number(problem, &names);
        set_outside(problem, overrides);
    }
    in_reading_order(problems, before);
    if problems.any_error() { None } else { plan }
}

impl Checker<'_> {
    fn tell(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Tells a problem; there is no result.
    fn refuse<T>(&mut self, problem: Problem) -> Option<T> {
        self.tell(problem);
        None
    }

    /// The expression in a field.
    fn expression(&mut self, text: &Text, scope: &mut Scope) -> Option<Expr> {
        let phrase = from_pest::expression(text, self.problems)?;
        self.expr(&phrase, scope)
    }

    /// Looks at what is evaluated only where a condition holds.
    fn assuming<T>(&mut self, condition: Option<Expr>, look: impl FnOnce(&mut Self) -> T) -> T {
        let known = self.assumed.len();
        self.assumed.extend(condition);
        let found = look(self);
        self.assumed.truncate(known);
        found
    }

    /// Checks one level deeper; `None` after a problem if that is too deep or too much.
    fn deeper<T>(&mut self, at: &Span, look: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        if self.work > MOST_WORK {
            return None;
        }
        self.work += 1;
        if self.work > MOST_WORK {
            return self.refuse(
                error(
                    "too-large",
                    "definitions and signals use each other too often: the rules become too large",
                    at,
                )
                .help("use each part once or twice, not twice at every level"),
            );
        }
        if self.depth >= DEEPEST {
            return self.refuse(error(
                "too-deep",
                "definitions and signals are nested too deeply",
                at,
            ));
        }
        self.depth += 1;
        let found = look(self);
        self.depth -= 1;
        found
    }

    /// Checks a named part; `None` after a problem if it is already being checked.
    fn inside<T>(
        &mut self,
        kind: &str,
        name: &str,
        at: &Span,
        look: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let key = format!("{kind} {name}");
        if self.looped.contains(&key) {
            return None;
        }
        if let Some(from) = self.open.iter().position(|open| *open == key) {
            let round: Vec<String> = self.open[from..]
                .iter()
                .chain([&key])
                .map(|part| format!("`{}`", part.split(' ').next_back().unwrap_or(part)))
                .collect();
            let code = match kind {
                "parameter" => "parameter-loop",
                "signal" => "signal-loop",
                "filter" => "filter-loop",
                "verdict" => "verdict-loop",
                _ => "define-loop",
            };
            let says = if round.len() > 2 {
                format!("{kind} `{name}` is defined by itself: {}", round.join(", then "))
            } else {
                format!("{kind} `{name}` is defined by itself")
            };
            let mut problem = error(code, says, at);
            if let Some(block) = self
                .blocks
                .iter()
                .find(|block| block.kind.text == kind && block.name_text() == name)
            {
                problem = problem.also(block, "begins here");
            }
            self.tell(problem);
            self.looped.extend(self.open[from..].iter().cloned());
            return None;
        }
        self.open.push(key);
        let found = look(self);
        self.open.pop();
        found
    }

    /// The blocks of a kind, in the order of the text.
    fn blocks_of<'b>(&'b self, kind: &'b str) -> impl Iterator<Item = &'b Block> + Clone {
        self.blocks.iter().filter(move |block| block.kind.text == kind)
    }

    fn plan(&mut self, document: &Document) -> Option<Plan> {
        let blocks = self.blocks.clone();
        let of = |kind: &'static str| blocks.iter().filter(move |block| block.kind.text == kind);
        let Some(head) = of("protocol").next() else {
            // Of a text that could not be parsed, nothing more is known.
            if self.problems.0.iter().any(|problem| problem.code == "yaml-syntax") {
                return None;
            }
            return self.refuse(
                error(
                    "no-protocol",
                    "the text has no `protocol` block",
                    &document.source.span(0..0),
                )
                .help("begin with `protocol name-of-it \"Title\"`"),
            );
        };
        self.axis = self
            .required(head, "axis")
            .and_then(|field| self.axis_field(field, &[Dimension::LENGTH, Dimension::TIME]));
        let time = head.field("time").and_then(|field| self.axis_field(field, &[Dimension::TIME]));
        self.time = time.clone();
        self.gather_names();
        self.unknown_overrides(head);
        let mut sections = self.section_rules(of("sections").next());
        self.zones_match(&sections);
        let verdict_block = of("verdict").find(|block| block.name.is_none());
        self.ddof = self.divisor(verdict_block);
        if let Some(block) = verdict_block {
            self.minimum_signals = self.count(block, "minimum signals", 1).unwrap_or(1);
            let minima = self.minima(block);
            self.minimum_pairs = minima.all.flatten().unwrap_or(1);
            self.minimum_of_groups = minima.of_groups;
        }
        let zones: Vec<plan::Zone> = of("zone").filter_map(|block| self.zone(block)).collect();
        sections.computed = self.computed_data(sections.zone).unwrap_or_default();
        sections.find = self.find(of("sections").next(), &sections, zones.len());
        sections.reports = self.reports_of_sections(of("sections").next());
        let checks = of("check").filter_map(|block| self.section_check(block)).collect();
        let filters = of("filter").filter_map(|block| self.named_filter(block)).collect();
        let domains = of("domain").filter_map(|block| self.domain(block)).collect();
        let mut quantities: Vec<plan::Quantity> =
            of("quantity").filter_map(|block| self.quantity(block)).collect();
        self.references();
        references::say_unconfirmed(&mut quantities, self.to_be_confirmed());
        if of("quantity").chain(of("plausibility")).next().is_none() {
            self.tell(error(
                "no-quantity",
                "the protocol has no quantity, so nothing would be compared",
                head,
            ));
        }
        let compared = self.compared_channels(&quantities);
        let plausibility = of("plausibility")
            .filter_map(|block| self.plausibility(block, &compared))
            .flatten()
            .collect();
        self.unused_parts();
        let verdicts = self.verdicts(verdict_block, head, &quantities);
        let independent = self.independent(verdict_block);
        let names = &self.names;
        let parameters = names
            .parameter_blocks
            .keys()
            .filter_map(|name| names.parameters.get_key_value(name))
            .map(|(name, found)| Parameter {
                name: name.clone(),
                title: found.title.clone(),
                value: found.value_words.clone(),
                default: found.default_words.clone(),
                set_by: found.set_by,
                lacking: found.value == Err(plan::Optional::NotAssessable),
                unconfirmed: self.values.why(name),
                choices: if let plan::Type::Word(choices) = &found.ty {
                    choices.clone()
                } else {
                    Vec::new()
                },
                range: match (&found.value, found.range) {
                    (Ok(plan::Scalar::Number(value)), Some(ends)) => {
                        let block = &names.parameter_blocks[name];
                        block
                            .field("range")
                            .map(|range| plan::ParameterRange::new(*value, ends, &range.value.text))
                    }
                    _ => None,
                },
            })
            .collect();
        let clauses = self.clauses()?;
        Some(Plan {
            name: head.own_name(),
            title: head.title_or_name(),
            edition: head.text("edition"),
            source: head.text("source"),
            scope: head.text("scope"),
            notes: head.notes(),
            leaves_out: head
                .fields_named("leaves out")
                .map(|field| field.value.text.clone())
                .collect(),
            clauses,
            axis: self.axis.clone()?,
            time,
            parameters,
            values: self.values.clone(),
            vehicle: self.names.vehicle.clone(),
            columns: self.names.columns.clone(),
            campaigns: self.campaigns.clone(),
            records: self.names.records.clone(),
            optional: self.names.optional.clone(),
            filters,
            zones,
            checks,
            plausibility,
            sections,
            domains,
            quantities,
            independent,
            verdicts,
        })
    }

    fn named_filter(&mut self, block: &Block) -> Option<NamedFilter> {
        let steps = self.filter_named(block.name_text(), block.span())?;
        let title = block.title_text().unwrap_or_default();
        let source = block.field("source").map(|field| field.value.text.clone());
        Some(NamedFilter { name: block.own_name(), title, steps, source })
    }

    fn unknown_overrides(&mut self, head: &Block) {
        for (name, given) in self.overrides.iter() {
            if !self.names.parameter_blocks.contains_key(name) {
                let problem = problem!(
                    "unknown-parameter",
                    &given.text.span,
                    "protocol `{}` has no parameter `{name}`",
                    head.name_text()
                );
                let datum = self.names.vehicle.iter().find(|datum| datum.name == *name);
                self.tell(match datum {
                    Some(datum) => problem.help(format!(
                        "this is a vehicle datum: write `{}` in the vehicle file",
                        datum.key
                    )),
                    None => problem.suggest(name, self.names.parameter_blocks.keys()),
                });
            }
        }
    }
}
