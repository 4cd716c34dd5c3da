//! Plausibility rules in one section: violations as findings.

use std::collections::BTreeSet;

use super::{causes, consequence::consequence};
use crate::check::evaluate::words;
use crate::graph::PositionNodes;
use crate::metrics::percentile::{Method, percentile};
use crate::run::{
    prelude::*,
    record::SectionWork,
    sections::{Known, needed},
    values::{NodeValues, Pooled, Print, SectionValues, Shape, Sides},
};
use crate::units::Dimension;

/// A rule at a recorded position.
struct Asked<'a> {
    rule: &'a Plausibility,
    /// Indices of the rule and of the position.
    at: [usize; 2],
    nodes: &'a PositionNodes,
    /// Of the position.
    name: &'a str,
}

/// What the rules ask of a section.
pub struct Questions<'a>(Vec<Asked<'a>>);

impl<'a> Questions<'a> {
    /// Every rule that applies to the section, at every recorded position. A rule is passed over
    /// where it cannot be determined, for a missing datum, whether it applies or to which signal.
    pub fn of(section: &SectionWork<'a>) -> Self {
        let SectionWork { work, unit, known } = *section;
        let decided = |nodes: &PositionNodes| {
            let inputs = nodes.inputs.iter().flat_map(InputNode::nodes);
            needed(work.graph, &nodes.own.into_iter().chain(inputs).collect(), &known).is_ok()
        };
        let mut asked = Vec::new();
        for (at, rule) in work.plan.plausibility.iter().enumerate() {
            let spared = rule.unless.as_ref().map_or(Ok(false), |unless| flag(unless, &known));
            if spared != Ok(false) {
                continue;
            }
            let recorded = &work.recorded[unit.campaign][at];
            let positions = work.graph.plausibility[at].positions.iter().zip(recorded).enumerate();
            for (position, (nodes, recorded)) in positions {
                if *recorded && decided(nodes) {
                    let name = rule.signals.get(position).map_or("", |(name, _)| name.as_str());
                    asked.push(Asked { rule, at: [at, position], nodes, name });
                }
            }
        }
        // The likeliest cause first: the first finding says why a section is not used.
        asked.sort_by_key(|asked| asked.rule.rank());
        Self(asked)
    }

    /// Nodes whose values the rules need, of the records of a side or, without one, of the track
    /// record.
    pub fn wanted(&self, graph: &Graph, side: Option<InputSide>) -> BTreeSet<NodeId> {
        let track = side.is_none();
        let mut wanted = BTreeSet::new();
        for Asked { rule, nodes, .. } in &self.0 {
            let of_side = |input: &&InputNode| {
                input.joint.is_some() || side.is_none_or(|side| input.side.resolve(side) == side)
            };
            let of_rule = nodes.inputs.iter().filter(of_side).flat_map(InputNode::nodes);
            wanted.extend(of_rule.filter(|&node| graph.nodes[node].track == track));
            if !track && matches!(rule.test, Test::Distinct(_) | Test::Exchanged(_)) {
                wanted.extend(nodes.own);
            }
        }
        wanted
    }
}

/// Checks one section and adds its findings to the values.
pub fn look(
    questions: &Questions<'_>,
    sides: &Sides<'_>,
    track: &NodeValues,
    values: &mut SectionValues,
) {
    let section = sides.section;
    for &Asked { rule, at, nodes, name } in &questions.0 {
        match &rule.test {
            Test::Require(requirement) => {
                let others = questions.0.iter().filter(|other| std::ptr::eq(other.rule, rule));
                let siblings =
                    others.map(|other| other.nodes).filter(|other| !std::ptr::eq(*other, nodes));
                let siblings = siblings.collect();
                let position = Position { section, rule, at, requirement, siblings, name };
                position.look(sides, nodes, track, values);
            }
            Test::Distinct(_) | Test::Exchanged(_) => {
                for record in sides.simulated.iter().chain(sides.measured) {
                    if let Some(samples) = nodes.own.and_then(|own| record.found.samples(own).ok())
                    {
                        let words = section.campaign().record_in_words(record.which);
                        let of = (record.which, words);
                        if matches!(rule.test, Test::Distinct(_)) {
                            values.prints.push(Print::of(&rule.name, name, of, &samples.values));
                        } else {
                            let signal = (samples.along.axis.as_slice(), samples.values.as_slice());
                            values.shapes.extend(Shape::of((at[0], name), of, signal));
                        }
                    }
                }
            }
        }
    }
}

/// A requirement at one position in one section.
struct Position<'a> {
    section: &'a SectionWork<'a>,
    rule: &'a Plausibility,
    at: [usize; 2],
    requirement: &'a Requirement,
    /// The nodes of the other positions of the rule.
    siblings: Vec<&'a PositionNodes>,
    name: &'a str,
}

/// Which percentile of the other positions `siblings(...)` is. What happens at one rail shows in
/// half of the wheels, that is in three of the seven others; a fault of one channel in none.
const OF_SIBLINGS: f64 = 75.0;

impl Position<'_> {
    fn look(
        &self,
        sides: &Sides<'_>,
        nodes: &PositionNodes,
        track: &NodeValues,
        values: &mut SectionValues,
    ) {
        let mut look = |value: &dyn Fn(&InputNode) -> Result<f64, Reason>, record| {
            let of_siblings = |at: usize| {
                let of = |nodes: &&PositionNodes| value(nodes.inputs.get(at)?).ok();
                let others: Vec<f64> = self.siblings.iter().filter_map(of).collect();
                percentile(&others, OF_SIBLINGS, Method::Linear).map_err(|_| Reason::NoSignalHere)
            };
            let input = |(at, input): (usize, &InputNode)| {
                if input.siblings { of_siblings(at) } else { value(input) }
            };
            let inputs: Vec<_> = nodes.inputs.iter().enumerate().map(input).collect();
            if self.requirement.over_sections.is_some() {
                values.pooled.extend(self.pooled(&inputs, record));
            } else {
                values.findings.extend(self.finding(&inputs, record));
            }
        };
        match self.requirement.of {
            Looks::Data => values.findings.extend(self.finding(&[], None)),
            Looks::Track => {
                let value = |input: &InputNode| Ok(track.number(input.node)?.0);
                look(&value, Some("track".into()));
            }
            Looks::BothSides => {
                for (name, two) in sides.pairs() {
                    let name = name.map(|name| name.to_string());
                    look(&|input| two.input(input, InputSide::Measured), name);
                }
            }
            Looks::EachSide => {
                for (records, side) in
                    [(sides.simulated, InputSide::Simulated), (sides.measured, InputSide::Measured)]
                {
                    for record in records {
                        let name = self.section.campaign().record_in_words(record.which);
                        look(&|input| sides.alone(record).input(input, side), Some(name));
                    }
                }
            }
        }
    }

    /// The rule asks for samples that are not finite.
    fn not_checked(
        &self,
        inputs: &[Result<f64, Reason>],
        record: Option<String>,
    ) -> Option<Finding> {
        let failed = inputs.iter().filter_map(|input| input.as_ref().err());
        let reason = failed.into_iter().find(|reason| reason.is_of_samples())?.clone();
        let data = FindingData::RuleNotChecked { rule: self.rule.title.clone(), reason };
        Some(self.found(record, data.into()))
    }

    /// What is found of the channel in this section.
    fn found(&self, record: Option<String>, about: Occurrence) -> Finding {
        let first = Occurrence {
            channel: (!self.name.is_empty()).then(|| self.name.to_string()),
            section: Some(self.section.unit.name.clone()),
            campaign: self.section.unit.campaign_name.clone(),
            record,
            ..about
        };
        let consequence = consequence(self.rule.otherwise_at(self.name));
        Finding { consequence, ..Finding::note(&self.rule.name, first) }
    }

    /// The numbers that are compared, of those that have values.
    fn pooled(&self, inputs: &[Result<f64, Reason>], record: Option<String>) -> Vec<Pooled> {
        let known = Known { inputs, ..self.section.known };
        let of = |expr: &Expr| number(expr, &known).ok().filter(|value| value.is_finite());
        let numbers = |(which, compared): (usize, &Comparison)| {
            let room = match &compared.relation {
                Relation::Within(room) => of(room)?,
                _ => 0.0,
            };
            Some(Pooled {
                of: [self.at[0], self.at[1], which],
                record: record.clone(),
                found: of(&compared.found)?,
                expected: of(&compared.expected)?,
                room,
            })
        };
        self.requirement.compared.iter().enumerate().filter_map(numbers).collect()
    }

    /// `None` where the requirement is met, or cannot be evaluated because a datum is missing.
    fn finding(&self, inputs: &[Result<f64, Reason>], record: Option<String>) -> Option<Finding> {
        let known = Known { inputs, ..self.section.known };
        match flag(&self.requirement.holds, &known) {
            Ok(false) => {}
            Ok(true) => return None,
            Err(_) => return self.not_checked(inputs, record),
        }
        let failing = self
            .requirement
            .compared
            .iter()
            .find(|comparison| flag(&comparison.holds, &known) == Ok(false));
        let numbers = failing.and_then(|Comparison { found, expected, unit, relation, .. }| {
            let of = |expr| number(expr, &known).ok().map(|value| unit.from_si(value));
            Some((of(found)?, of(expected)?, unit, words(found), relation.about()))
        });
        // Units explain a ratio of two amounts that should be alike, not of two correlations, nor
        // of a value and a bound.
        let amounts = numbers
            .as_ref()
            .filter(|(_, _, unit, _, about)| *about && unit.dimension != Dimension::ONE);
        let guessed = amounts.and_then(|(value, expected, unit, ..)| {
            causes::likely(*value, *expected, unit.dimension)
        });
        let named = self.rule.cause.clone().map(Reason::said);
        let causes = guessed.into_iter().chain(named).collect();
        let value = numbers.as_ref().map(|(value, ..)| *value);
        let expected = numbers.as_ref().map(|(_, expected, ..)| *expected);
        let unit = numbers.as_ref().map(|(_, _, unit, ..)| unit.text.clone());
        let data = FindingData::Required {
            rule: self.rule.title.clone(),
            what: numbers.map(|(_, _, _, what, _)| what),
            value,
            expected,
            unit: unit.clone().unwrap_or_default(),
            required: self.requirement.words.clone(),
        };
        let about = Occurrence { value, expected, unit, ..data.into() };
        Some(Finding { causes, ..self.found(record, about) })
    }
}
