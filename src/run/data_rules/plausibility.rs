//! Plausibility rules in one section: violations as findings.

use std::collections::BTreeSet;

use super::causes;
use super::consequence::consequence;
use super::exchanged;
use crate::check::evaluate::{flag, number, words};
use crate::check::plan::{
    Comparison, Exchanged, InputSide, Looks, Plausibility, Requirement, Test,
};
use crate::graph::{InputNode, NodeId, PositionNodes};
use crate::result::{Finding, FindingData, Occurrence, Reason};
use crate::run::record::Work;
use crate::run::sections::{Known, Unit, needed};
use crate::run::values::{NodeValues, Print, RecordOfSide, SectionValues, Sides};
use crate::units::Dimension;

/// A rule at a recorded position, its nodes and the name of the position.
type Asked<'a> = (&'a Plausibility, &'a PositionNodes, &'a str);

/// What the rules ask of a section.
pub struct Questions<'a>(Vec<Asked<'a>>);

impl<'a> Questions<'a> {
    /// Every rule that applies to the section, at every recorded position. A rule is passed over
    /// where it cannot be determined, for a missing datum, whether it applies or to which signal.
    pub fn of(work: &Work<'a>, unit: &Unit, known: &Known<'_>) -> Self {
        let applies = |rule: &Plausibility| {
            rule.unless.as_ref().map_or(Ok(false), |unless| flag(unless, known)) == Ok(false)
        };
        let decided = |nodes: &PositionNodes| {
            let nodes: BTreeSet<NodeId> = nodes
                .own
                .into_iter()
                .chain(nodes.inputs.iter().flat_map(InputNode::nodes))
                .collect();
            needed(work.graph, &nodes, known).is_ok()
        };
        let (plan, graph, recorded) = (work.plan, work.graph, &work.recorded[unit.campaign]);
        let of_rule = |(at, rule): (usize, &'a Plausibility)| {
            let positions = graph.plausibility[at].positions.iter().zip(&recorded[at]).enumerate();
            let name =
                |position: usize| rule.signals.get(position).map_or("", |(name, _)| name.as_str());
            let asked = positions.filter(|(_, (nodes, recorded))| **recorded && decided(nodes));
            asked
                .map(|(position, (nodes, _))| (rule, nodes, name(position)))
                .collect::<Vec<Asked<'a>>>()
        };
        Self(
            plan.plausibility
                .iter()
                .enumerate()
                .filter(|(_, rule)| applies(rule))
                .flat_map(of_rule)
                .collect(),
        )
    }

    /// Nodes whose values the rules need, of the track record (`track`) or of the other records.
    pub fn wanted(&self, work: &Work<'_>, track: bool) -> BTreeSet<NodeId> {
        let mut wanted = BTreeSet::new();
        for (rule, nodes, _) in &self.0 {
            let of_rule = nodes.inputs.iter().flat_map(InputNode::nodes);
            wanted.extend(of_rule.filter(|&node| work.graph.nodes[node].track == track));
            if let (Test::Distinct(_) | Test::Exchanged(_), Some(own), false) =
                (&rule.test, nodes.own, track)
            {
                wanted.insert(own);
            }
        }
        wanted
    }
}

/// Checks one section and adds its findings to the values.
pub fn look(
    (work, unit): (&Work<'_>, &Unit),
    questions: &Questions<'_>,
    sides: &Sides<'_>,
    track: &NodeValues,
    values: &mut SectionValues,
) {
    let mut channels: Vec<(&Plausibility, Exchanged, exchanged::Channels<'_>)> = Vec::new();
    for &(rule, nodes, name) in &questions.0 {
        match &rule.test {
            Test::Exchanged(test) => match (nodes.own, channels.last_mut()) {
                (Some(own), Some((of, _, list))) if std::ptr::eq(*of, rule) => {
                    list.push((name, own))
                }
                (Some(own), _) => channels.push((rule, *test, vec![(name, own)])),
                (None, _) => {}
            },
            Test::Require(requirement) => {
                let at = Position { work, rule, requirement, unit, name };
                at.look(sides, nodes, track, &mut values.findings);
            }
            Test::Distinct(_) => {
                for record in sides.simulated.iter().chain(sides.measured) {
                    if let Some(samples) = nodes.own.and_then(|own| record.found.samples(own).ok())
                    {
                        let words = work.campaign(unit).record_in_words(record.which);
                        values.prints.push(Print::of(
                            &rule.name,
                            name,
                            (record.which, words),
                            &samples.values,
                        ));
                    }
                }
            }
        }
    }
    for (rule, test, channels) in channels {
        values.findings.extend(exchanged::find(work, rule, test, &channels, unit, sides));
    }
}

/// A requirement at one position in one section.
struct Position<'a> {
    work: &'a Work<'a>,
    rule: &'a Plausibility,
    requirement: &'a Requirement,
    unit: &'a Unit,
    name: &'a str,
}

impl Position<'_> {
    fn look(
        &self,
        sides: &Sides<'_>,
        nodes: &PositionNodes,
        track: &NodeValues,
        findings: &mut Vec<Finding>,
    ) {
        match self.requirement.of {
            Looks::Data => findings.extend(self.finding(sides.known, &[], None)),
            Looks::Track => {
                let inputs: Vec<_> = nodes
                    .inputs
                    .iter()
                    .map(|input: &InputNode| track.number(input.node).map(|(value, _)| value))
                    .collect();
                findings.extend(self.finding(sides.known, &inputs, Some("track".into())));
            }
            Looks::BothSides => {
                for (name, two) in sides.pairs() {
                    let inputs: Vec<_> = nodes
                        .inputs
                        .iter()
                        .map(|input| two.input(input, InputSide::Measured))
                        .collect();
                    findings.extend(self.finding(
                        sides.known,
                        &inputs,
                        name.map(|name| name.to_string()),
                    ));
                }
            }
            Looks::EachSide => {
                for (records, side) in
                    [(sides.simulated, InputSide::Simulated), (sides.measured, InputSide::Measured)]
                {
                    for record in records {
                        let inputs: Vec<_> = nodes
                            .inputs
                            .iter()
                            .map(|input| sides.alone(record).input(input, side))
                            .collect();
                        findings.extend(self.finding(sides.known, &inputs, Some(self.of(record))));
                    }
                }
            }
        }
    }

    fn of(&self, record: &RecordOfSide) -> String {
        self.work.campaign(self.unit).record_in_words(record.which)
    }

    /// `None` where the requirement is met, or cannot be evaluated because a datum is missing.
    fn finding(
        &self,
        known: &Known<'_>,
        inputs: &[Result<f64, Reason>],
        record: Option<String>,
    ) -> Option<Finding> {
        let known = Known { inputs, ..*known };
        if flag(&self.requirement.holds, &known) != Ok(false) {
            return None;
        }
        let failing = self
            .requirement
            .compared
            .iter()
            .find(|comparison| flag(&comparison.holds, &known) == Ok(false));
        let numbers = failing.and_then(|Comparison { found, expected, unit, about, .. }| {
            let of = |expr| number(expr, &known).ok().map(|value| unit.from_si(value));
            Some((of(found)?, of(expected)?, unit, words(found), *about))
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
        let cause = match (guessed, named) {
            (Some(first), Some(second)) => {
                Some(Reason::Both { first: Box::new(first), second: Box::new(second) })
            }
            (guessed, named) => guessed.or(named),
        };
        let value = numbers.as_ref().map(|(value, ..)| *value);
        let expected = numbers.as_ref().map(|(_, expected, ..)| *expected);
        let unit = numbers.as_ref().map(|(_, _, unit, ..)| unit.text.clone());
        let first = Occurrence {
            data: FindingData::Required {
                rule: self.rule.title.clone(),
                what: numbers.map(|(_, _, _, what, _)| what),
                value,
                expected,
                unit: unit.clone().unwrap_or_default(),
                required: self.requirement.words.clone(),
            },
            channel: (!self.name.is_empty()).then(|| self.name.to_string()),
            section: Some(self.unit.name.clone()),
            campaign: self.unit.campaign_name.clone(),
            record,
            value,
            expected,
            unit,
        };
        let consequence = consequence(self.rule.otherwise);
        Some(Finding { cause, consequence, ..Finding::note(&self.rule.name, first) })
    }
}
