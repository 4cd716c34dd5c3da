//! Exchanged channels: a measured channel that agrees with another simulated channel better than
//! with its own.

use super::consequence::consequence;
use crate::check::plan::{Exchanged, Plausibility};
use crate::graph::NodeId;
use crate::metrics::statistics::correlation;
use crate::result::{Finding, FindingData, Occurrence, Reason};
use crate::run::record::{Samples, SectionWork};
use crate::run::values::{Meetings, RecordOfSide, Sides};

/// Channels of one rule in a section: name, and the signal.
pub type Channels<'a> = Vec<(&'a str, NodeId)>;

/// A finding for each measured channel that another simulated channel of the rule explains better.
pub fn find(
    rule: &Plausibility,
    test: Exchanged,
    channels: &Channels<'_>,
    sides: &Sides<'_>,
) -> Vec<Finding> {
    let (Some(simulated), false) = (sides.simulated.first(), channels.len() < 2) else {
        return Vec::new();
    };
    let in_record =
        |measured| in_record((rule, test), channels, sides.section, simulated, measured);
    sides.measured.iter().flat_map(in_record).collect()
}

fn in_record(
    (rule, test): (&Plausibility, Exchanged),
    channels: &Channels<'_>,
    section: &SectionWork<'_>,
    simulated: &RecordOfSide,
    measured: &RecordOfSide,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let meetings = Meetings::default();
    for (at, (name, node)) in channels.iter().enumerate() {
        let Ok(own) = measured.found.samples(*node) else { continue };
        let with = |node: NodeId| agreement(&meetings, own, simulated.found.samples(node).ok()?);
        let Some(with_own) = with(*node) else { continue };
        // No correlation is above 1: most channels need no comparison with the others.
        if with_own + test.more >= 1.0 {
            continue;
        }
        let others = channels.iter().enumerate().filter(|(other, _)| *other != at);
        let best = others
            .filter_map(|(_, (other, node))| Some((*other, with(*node)?)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((other, with_other)) =
            best.filter(|(_, best)| *best >= test.least && *best > with_own + test.more)
        else {
            continue;
        };
        let first = Occurrence {
            channel: Some((*name).to_string()),
            section: Some(section.unit.name.clone()),
            campaign: section.unit.campaign_name.clone(),
            record: Some(section.campaign().record_in_words(measured.which)),
            value: Some(with_own),
            expected: Some(with_other),
            unit: Some("-".into()),
            data: FindingData::Exchanged {
                rule: rule.title.clone(),
                channel: (*name).to_string(),
                other: other.to_string(),
                correlation: with_other,
                own_correlation: with_own,
            },
        };
        findings.push(Finding {
            cause: rule.cause.clone().map(Reason::said),
            consequence: consequence(rule.otherwise_at(name)),
            ..Finding::note(&rule.name, first)
        });
    }
    findings
}

/// Correlation at the points of the measurement that the simulation covers.
fn agreement(meetings: &Meetings, measured: &Samples, simulated: &Samples) -> Option<f64> {
    let axis = &simulated.along.axis;
    let covered = (*axis.first()?, *axis.last()?);
    let meeting = meetings.of(simulated, measured, Some(covered), 0.0).ok()?;
    correlation(meeting.measured(measured), &meeting.simulated(simulated))
}
