//! Checks plausibility rules: their condition, positions and records.

use std::collections::BTreeSet;

use super::{names::Signal, near::Near, prelude::*, steps::after};
use crate::source::Source;

/// Words of the field `distinct`.
const AMONG: [&str; 4] = ["channels", "sections", "sides", "records"];

/// Written in `of` in place of a signal: every channel that a quantity reads.
const EVERY_CHANNEL: &str = "every channel";
/// Stands for the channels of the protocols that use a text without quantities.
const ANY_CHANNEL: &str = "any_channel";

/// Signals with their names, and the unit of values taken from them.
type Of = (Vec<(String, Expr)>, Option<Unit>);

/// The channels of simulation and measurement that quantities read.
#[derive(Debug)]
pub struct ComparedChannels {
    /// In the order of the text.
    names: Vec<String>,
    /// Their columns, at the positions of the quantities.
    columns: BTreeSet<String>,
}

impl ComparedChannels {
    /// The positions of which no quantity reads a channel.
    fn unread(&self, signals: &[(String, Expr)]) -> Vec<String> {
        let read = |part: &Expr| match &part.kind {
            Kind::Channel { column, .. } => self.columns.contains(column),
            _ => false,
        };
        let unread = signals.iter().filter(|(_, signal)| !signal.any(&read));
        unread.map(|(name, _)| name.clone()).collect()
    }
}

impl Checker<'_> {
    /// What quantities read. Of a text without quantities, a channel that stands for those of the
    /// protocols that use it.
    pub fn compared_channels(&mut self, quantities: &[Quantity]) -> ComparedChannels {
        if self.blocks_of("quantity").next().is_none() {
            let any = Signal {
                places: Vec::new(),
                is: None,
                unit: Some(Unit::si(Dimension::ONE)),
                pattern: ANY_CHANNEL.into(),
                track: false,
                span: Source::new("", ANY_CHANNEL).whole(),
            };
            self.names.signals.insert(ANY_CHANNEL.into(), any);
        }
        let mut read = BTreeSet::from([ANY_CHANNEL.to_string()]);
        let mut columns = BTreeSet::new();
        for signal in quantities.iter().flat_map(Quantity::signals) {
            signal.visit(&mut |part| {
                if let (Kind::Channel { column, channel, .. }, false) = (&part.kind, part.track()) {
                    read.insert(channel.clone());
                    columns.insert(column.clone());
                }
            });
        }
        let names = self.names.signals.keys().filter(|name| read.contains(name.as_str())).cloned();
        ComparedChannels { names: names.collect(), columns }
    }

    /// The fields `of` of a block, each with one channel where they say `every channel`.
    fn fields_of(block: &Block, compared: &ComparedChannels) -> Vec<Field> {
        let each = |field: &Field| -> Vec<Field> {
            if normalised(&field.value.text) != EVERY_CHANNEL {
                return vec![field.clone()];
            }
            let named = |name: &String| {
                let value = Text { text: name.clone(), exact: false, ..field.value.clone() };
                Field { value, ..field.clone() }
            };
            compared.names.iter().map(named).collect()
        };
        block.fields_named("of").flat_map(each).collect()
    }

    /// One rule for each field `of` of the block, and for each channel where it says `every
    /// channel`.
    pub fn plausibility(
        &mut self,
        block: &Block,
        compared: &ComparedChannels,
    ) -> Option<Vec<Plausibility>> {
        let (require, distinct, exchanged) =
            (block.field("require"), block.field("distinct"), block.field("exchanged"));
        let tests: Vec<&Field> = [require, distinct, exchanged].into_iter().flatten().collect();
        if let [first, second, ..] = tests[..] {
            let says = "a plausibility rule has one of `require`, `distinct` and `exchanged`";
            let problem = error("require-and-distinct", says, &second.key);
            return self
                .refuse(problem.also(&first.key, "the first of them").help("write two rules"));
        }
        if distinct.or(exchanged).is_none() {
            self.required(block, "require")?;
        } else {
            self.required(block, "of")?;
        }
        let chain = self.chain_of(block);
        let mut all: Vec<Of> = Vec::new();
        let mut whole = true;
        for field in &Self::fields_of(block, compared) {
            match self.signals_with_unit(field, chain.as_deref().unwrap_or_default()) {
                Some(of) => all.push(of),
                None => whole = false,
            }
        }
        if block.field("of").is_none() {
            all.push((Vec::new(), None));
        }
        let unless = if_written(block.field("unless").map(|field| self.section_condition(field)))?;
        let treatments = ["note", "not used", "not assessable", "stop"];
        let otherwise = self.on_fault(block, "otherwise", &treatments);
        let concerns_record = self.concerns_record(block)?;
        let chain = chain.filter(|_| whole)?;
        let mut rules = Vec::new();
        for (signals, unit) in all {
            let test = match (require, distinct, exchanged) {
                (Some(field), ..) => Test::Require(Box::new(self.requirement(
                    field,
                    &signals,
                    &chain,
                    unit.as_ref(),
                )?)),
                (None, Some(field), _) => Test::Distinct(self.distinct(field)?),
                (None, None, Some(field)) => Test::Exchanged(self.exchanged(field)?),
                (None, None, None) => return None,
            };
            let otherwise = otherwise?;
            let mut test = test;
            if let Test::Require(requirement) = &mut test {
                for input in &requirement.inputs {
                    self.samples_are_kept(input.taken, &chain, &requirement.holds.span)?;
                }
                requirement.over_sections = self.over_sections(block, requirement, otherwise)?;
            }
            rules.push(Plausibility {
                name: block.own_name(),
                title: block.title_in_words(),
                unread: compared.unread(&signals),
                signals,
                chain: chain.clone(),
                test,
                unless: unless.clone(),
                otherwise,
                concerns_record,
                cause: block.text("cause"),
                span: block.place(),
            });
        }
        Some(rules)
    }

    /// `concerns record`; without the field, a channel.
    fn concerns_record(&mut self, block: &Block) -> Option<bool> {
        let Some(field) = block.field("concerns") else { return Some(false) };
        let word = normalised(&field.value.text);
        let known = ["channel", "record"];
        if !known.contains(&word.as_str()) {
            return self.refuse(
                problem!("unknown-choice", field, "`concerns` cannot be `{word}`")
                    .suggest(&word, known),
            );
        }
        Some(word == "record")
    }

    /// `over sections`, with `slope 0.9 to 1.1`, or `over order of sections`.
    fn over_sections(
        &mut self,
        block: &Block,
        requirement: &Requirement,
        otherwise: OnFault,
    ) -> Option<Option<OverSections>> {
        let (over, slope) = (block.field("over"), block.field("slope"));
        let Some(field) = over.or(slope) else { return Some(None) };
        let refusal = |says: &str, help: &str| {
            Some(error("over-sections", says, field).help(help.to_string()))
        };
        let ordered = over.is_some_and(|over| normalised(&over.value.text) == "order of sections");
        let near =
            requirement.compared.iter().all(|one| matches!(one.relation, Relation::Within(_)));
        let problem = match over {
            None => {
                refusal("`slope` is that of all sections together", "write `over  sections` too")
            }
            Some(over) if !ordered && normalised(&over.value.text) != "sections" => refusal(
                "a requirement can be `over sections` or `over order of sections`",
                "write `over  sections`",
            ),
            _ if matches!(requirement.of, Looks::Data | Looks::Track) => refusal(
                "a requirement over sections needs values of signals",
                "name a signal in `of`, and take a value of it, such as `median`",
            ),
            _ if requirement.compared.is_empty()
                || requirement
                    .compared
                    .iter()
                    .any(|one| matches!(one.relation, Relation::WithinFactor)) =>
            {
                refusal(
                    "over sections, numbers are compared: `a <= b`, or `a near b within c`",
                    "join comparisons by `and` only, and write a tolerance in place of a factor",
                )
            }
            _ if slope.is_some() && ordered => refusal(
                "in the order of sections, a change is compared, and no slope",
                "write `over  sections`, or leave `slope` out",
            ),
            _ if ordered && !near => refusal(
                "a change is that of the values found less those expected",
                "write `require  a near b within c`",
            ),
            _ if slope.is_some() && !near => refusal(
                "a slope is that of the values found over those expected",
                "write `require  a near b within c`",
            ),
            _ if !matches!(otherwise, OnFault::Note | OnFault::NotAssessable) => refusal(
                "what is found over all sections concerns none of them by itself",
                "write `otherwise  not assessable`, or leave `otherwise` out",
            ),
            _ => None,
        };
        if let Some(problem) = problem {
            return self.refuse(problem);
        }
        if ordered {
            return Some(Some(OverSections::Change));
        }
        let Some(slope) = slope else { return Some(Some(OverSections::Level { slope: None })) };
        let (least, most) = from_pest::range(&slope.value, self.problems)?;
        let (least, most) = (self.constant_phrase(&least)?, self.constant_phrase(&most)?);
        let plain = (least.1, most.1) == (Dimension::ONE, Dimension::ONE);
        let numbers = (plain && least.0 < most.0).then_some((least.0, most.0));
        if numbers.is_none() {
            let says = "`slope` must be two numbers, the smaller one first";
            return self
                .refuse(error("over-sections", says, slope).help("write `slope  0.9 to 1.1`"));
        }
        Some(Some(OverSections::Level { slope: numbers }))
    }

    fn signals_with_unit(&mut self, field: &Field, chain: &[Step]) -> Option<Of> {
        let signals = self.signals_of(&field.value)?;
        let name = from_pest::of_places(&field.value, self.problems)?.signal.node;
        let unit = signals
            .first()
            .map(|first| self.own_unit(&name, after(chain, first.signal.dimension())));
        let named = |position: Position| (position.name, position.signal);
        Some((signals.into_iter().map(named).collect(), unit))
    }

    fn requirement(
        &mut self,
        field: &Field,
        signals: &[(String, Expr)],
        chain: &[Step],
        own_unit: Option<&Unit>,
    ) -> Option<Requirement> {
        let phrase = from_pest::expression(&field.value, self.problems)?;
        let axis = self.axis_dimension();
        let own = signals.first().map(|(_, signal)| after(chain, signal.dimension()));
        let mut scope = Scope {
            factor: after(chain, Dimension::ONE),
            siblings: own.is_some(),
            ..Scope::comparing(own, axis)
        };
        let (holds, compared) = self.compared(&phrase, &mut scope)?;
        self.flag_type(&holds)?;
        self.inputs_of_one_record(&scope.inputs)?;
        let mut comparisons = Vec::new();
        for Near { holds, found, expected, relation } in compared {
            let dimension = self.number_type(&found)?;
            let unit = self.unit_of(&found, &expected, &scope.inputs, dimension, own_unit);
            comparisons.push(Comparison { holds, found, expected, unit, relation });
        }
        let of = looks(&scope.inputs);
        Some(Requirement {
            holds,
            inputs: scope.inputs,
            of,
            compared: comparisons,
            over_sections: None,
            words: normalised(&field.value.text),
        })
    }

    /// The unit in which a value is printed: that of the rule's own signal, of the axis, or SI.
    fn unit_of(
        &self,
        found: &Expr,
        expected: &Expr,
        inputs: &[Input],
        dimension: Dimension,
        own: Option<&Unit>,
    ) -> Unit {
        let named = inputs.iter().find_map(|input| {
            let name = input.signal.as_ref()?.span.text();
            Some(self.own_unit(name.split_whitespace().next()?, dimension))
        });
        let axis = self.axis.as_ref().map(|axis| axis.unit.clone());
        let datum =
            self.datum_unit(found, dimension).or_else(|| self.datum_unit(expected, dimension));
        [own.cloned(), datum, axis, named]
            .into_iter()
            .flatten()
            .find(|unit| unit.dimension == dimension)
            .unwrap_or_else(|| self.own_unit("", dimension))
    }

    fn distinct(&mut self, field: &Field) -> Option<Distinct> {
        let mut distinct = Distinct::default();
        for word in from_pest::list(&field.value, self.problems)? {
            match word.node.as_str() {
                "channels" => distinct.channels = true,
                "sections" => distinct.sections = true,
                "sides" => distinct.sides = true,
                "records" => distinct.records = true,
                other => {
                    return self.refuse(
                        problem!("unknown-choice", &word, "`distinct` cannot be `{other}`")
                            .suggest(other, AMONG),
                    );
                }
            }
        }
        Some(distinct)
    }

    /// `from 0.5, by 0.3, alike from 0.7`; the last part may be left out.
    fn exchanged(&mut self, field: &Field) -> Option<Exchanged> {
        let text = normalised(&field.value.text);
        let span = &field.value.span;
        let mut number = |text: &str| {
            let text = Text { text: text.into(), span: span.clone(), exact: false };
            let (number, unit) = self.constant(&text)?;
            (unit == Dimension::ONE && number > 0.0 && number < 1.0).then_some(number)
        };
        let parts = text.strip_prefix("from ").and_then(|rest| rest.split_once(", by "));
        let found = parts.and_then(|(least, rest)| {
            let (more, alike) = match rest.split_once(", alike from ") {
                Some((more, alike)) => (more, Some(number(alike)?)),
                None => (rest, None),
            };
            Some(Exchanged { least: number(least)?, more: number(more)?, alike })
        });
        if found.is_none() {
            self.tell(
                error("exchanged-numbers", "`exchanged` must be numbers between 0 and 1: a correlation, a difference of two, and from which one on two sections are alike", field)
                    .help("write `exchanged  from 0.5, by 0.3` or `exchanged  from 0.5, by 0.3, alike from 0.7`"),
            );
        }
        found
    }
}

fn looks(inputs: &[Input]) -> Looks {
    let track = |input: &Input| input.signal.as_ref().is_some_and(Expr::track);
    let own =
        |input: &Input| input.side == InputSide::Own && matches!(input.taken, Taken::Reduced(_));
    match inputs {
        [] => Looks::Data,
        inputs if inputs.iter().any(track) => Looks::Track,
        inputs if inputs.iter().any(own) => Looks::EachSide,
        _ => Looks::BothSides,
    }
}
