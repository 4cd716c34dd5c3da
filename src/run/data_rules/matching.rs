//! What belongs together: a measured record agrees with the simulation of its own section better
//! than with that of another one, a channel with its own simulated channel, and no two places are
//! alike.

use std::collections::HashMap;

use super::consequence::consequence;
use crate::metrics::statistics::median;
use crate::run::{
    prelude::*,
    sections::Unit,
    values::{SectionValues, Shape},
};

/// Least number of sections, or of channels, for what is usual.
const FEWEST: usize = 5;
/// A channel agrees far less than usual where Fisher's transform of the correlation is lower by more
/// than this. It is as uncertain at 0.3 as at 0.99, by 1 / sqrt(n) over n waves: over ten waves, this
/// is more than three errors of a difference.
const FAR_BELOW: f64 = 1.5;

/// Shapes of one record.
type Shapes<'a> = Vec<&'a Shape>;
/// Adds a finding at a record or channel; the data by the title of the rule.
type Tell<'a> = dyn FnMut(&Shape, bool, &dyn Fn(String) -> FindingData) + 'a;

/// A section with its first simulation and all measurements.
struct Section<'a> {
    unit: &'a Unit,
    simulated: Shapes<'a>,
    measured: Vec<Shapes<'a>>,
}

/// The rules of one block, and what is usual in the campaign.
struct Matching<'a> {
    plan: &'a Plan,
    test: Exchanged,
    sections: Vec<Section<'a>>,
    /// By channel, the correlation of both sides.
    usual: HashMap<&'a str, f64>,
}

/// The findings of all rules with `exchanged`.
pub fn find<'a>(plan: &'a Plan, units: &'a [Unit], values: &'a [SectionValues]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut done: Vec<&str> = Vec::new();
    for rule in &plan.plausibility {
        let Test::Exchanged(test) = rule.test else { continue };
        if done.contains(&rule.name.as_str()) {
            continue;
        }
        done.push(&rule.name);
        let own = |shape: &&Shape| {
            plan.plausibility.get(shape.rule).is_some_and(|of| of.name == rule.name)
        };
        let section = |(unit, values): (&'a Unit, &'a SectionValues)| {
            let of = |which: WhichRecord| -> Shapes<'a> {
                values.shapes.iter().filter(own).filter(|shape| shape.which == which).collect()
            };
            let measured =
                (0..).map(|number| of(WhichRecord { kind: RecordKind::Measurement, number }));
            Section {
                unit,
                simulated: of(RecordKind::Simulation.into()),
                measured: measured.take_while(|shapes| !shapes.is_empty()).collect(),
            }
        };
        let sections: Vec<Section<'_>> = units.iter().zip(values).map(section).collect();
        let usual = usual(&sections);
        let matching = Matching { plan, test, sections, usual };
        (0..units.len()).for_each(|at| matching.look(at, &mut findings));
    }
    findings
}

/// The simulated shape of the same channel.
fn partner<'a>(shape: &Shape, simulated: &Shapes<'a>) -> Option<&'a Shape> {
    simulated.iter().find(|other| other.channel == shape.channel).copied()
}

/// Mean correlation of the channels that two records have in common.
fn together(one: &Shapes<'_>, other: &Shapes<'_>) -> Option<f64> {
    let of = |shape: &&Shape| shape.agreement(partner(shape, other)?);
    let all: Vec<f64> = one.iter().filter_map(of).collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

fn usual<'a>(sections: &[Section<'a>]) -> HashMap<&'a str, f64> {
    let mut all: HashMap<&str, Vec<f64>> = HashMap::new();
    for section in sections {
        for shape in section.measured.iter().flatten() {
            let own = partner(shape, &section.simulated).and_then(|own| shape.agreement(own));
            all.entry(&shape.channel).or_default().extend(own);
        }
    }
    let enough = all.into_iter().filter(|(_, of)| of.len() >= FEWEST);
    enough.filter_map(|(channel, of)| Some((channel, median(&of)?))).collect()
}

impl Matching<'_> {
    fn look(&self, at: usize, findings: &mut Vec<Finding>) {
        let Section { unit, simulated, measured } = &self.sections[at];
        let elsewhere = |other: &&Section<'_>| other.unit.site != unit.site;
        for (number, shapes) in measured.iter().enumerate() {
            let mut tell = |shape: &Shape, channel: bool, data: &dyn Fn(String) -> FindingData| {
                findings.extend(self.finding(unit, shape, channel, data));
            };
            let Some(first) = shapes.first() else { continue };
            let of_section = |of: &Section<'_>, with: &Shapes<'_>| {
                Some((of.unit.name.clone(), together(shapes, with)?))
            };
            // Of records that are alike all channels are: one is enough to exclude most sections.
            let like = |of: &&Section<'_>| {
                let own = of.measured.get(number).and_then(|shapes| partner(first, shapes));
                let agreed = own.and_then(|own| first.agreement(own));
                agreed >= self.test.alike.map(|alike| 0.5 * alike)
            };
            let earlier = self.sections[..at].iter().filter(elsewhere).filter(like);
            let same = earlier.filter_map(|of| of_section(of, of.measured.get(number)?));
            if let Some((section, found)) =
                self.test.alike.and_then(|alike| best(same).filter(|(_, found)| *found >= alike))
            {
                let of = (Some(section), Some(first.record.clone()));
                tell(first, false, &|rule| matched(rule, of.clone(), (found, None)));
                continue;
            }
            let Some(own) = together(shapes, simulated) else { continue };
            let least = self.test.least.max(own + self.test.more);
            // No correlation is above 1: most records need no comparison with the others.
            let others = self.sections.iter().filter(elsewhere).filter(|_| least <= 1.0);
            let others = others.filter_map(|of| of_section(of, &of.simulated));
            if let Some((section, found)) = best(others).filter(|(_, found)| *found >= least) {
                let of = (Some(section), simulated.first().map(|one| one.record.clone()));
                tell(first, false, &|rule| matched(rule, of.clone(), (found, Some(own))));
                continue;
            }
            self.channels(shapes, simulated, &mut tell);
        }
    }

    /// Each channel of a record against the simulated ones of its rule.
    fn channels(&self, shapes: &Shapes<'_>, simulated: &Shapes<'_>, tell: &mut Tell<'_>) {
        let own = |shape: &&Shape| shape.agreement(partner(shape, simulated)?);
        let all: Vec<f64> = shapes.iter().filter_map(own).collect();
        let of_others = median(&all).filter(|_| all.len() >= FEWEST).unwrap_or(1.0);
        for shape in shapes {
            let Some(own) = own(shape) else { continue };
            let least = self.test.least.max(own.abs() + self.test.more);
            let others = simulated.iter().filter(|other| {
                least <= 1.0 && other.rule == shape.rule && other.channel != shape.channel
            });
            let others = others.filter_map(|other| Some((*other, shape.agreement(other)?)));
            let best = others.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
            let usual = self.usual.get(shape.channel.as_str()).copied().unwrap_or_default();
            if let Some((other, found)) = best.filter(|(_, found)| found.abs() >= least) {
                tell(shape, true, &|rule| FindingData::Exchanged {
                    rule,
                    channel: shape.channel.clone(),
                    other: other.channel.clone(),
                    correlation: found,
                    own_correlation: own,
                });
            } else if fisher(usual.min(of_others)) - fisher(own) > FAR_BELOW {
                tell(shape, true, &|rule| matched(rule, (None, None), (usual, Some(own))));
            }
        }
    }

    fn finding(
        &self,
        unit: &Unit,
        shape: &Shape,
        channel: bool,
        data: &dyn Fn(String) -> FindingData,
    ) -> Option<Finding> {
        let rule: &Plausibility = self.plan.plausibility.get(shape.rule)?;
        let first = Occurrence {
            channel: channel.then(|| shape.channel.clone()),
            section: Some(unit.name.clone()),
            campaign: unit.campaign_name.clone(),
            record: Some(shape.record.clone()),
            ..data(rule.title.clone()).into()
        };
        let otherwise = if channel { rule.otherwise_at(&shape.channel) } else { rule.otherwise };
        Some(Finding {
            causes: rule.cause.clone().map(Reason::said).into_iter().collect(),
            consequence: consequence(otherwise),
            ..Finding::note(&rule.name, first)
        })
    }
}

/// Fisher's transform; finite for full agreement, too.
fn fisher(correlation: f64) -> f64 {
    const LARGEST: f64 = 0.9999;
    correlation.clamp(-LARGEST, LARGEST).atanh()
}

fn best(all: impl Iterator<Item = (String, f64)>) -> Option<(String, f64)> {
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn matched(
    rule: String,
    (section, record): (Option<String>, Option<String>),
    (correlation, own_correlation): (f64, Option<f64>),
) -> FindingData {
    FindingData::Matched { rule, section, record, correlation, own_correlation }
}
