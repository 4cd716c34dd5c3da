//! Exchanged channels: a measured channel that agrees with another simulated channel better than
//! with its own.

use std::ops::Range;
use std::sync::Arc;

use super::consequence::consequence;
use crate::check::plan::{Exchanged, Plausibility};
use crate::graph::NodeId;
use crate::metrics::resample::Located;
use crate::metrics::statistics::correlation;
use crate::result::{Finding, FindingData, Occurrence, Reason};
use crate::run::record::{Along, Samples, SectionWork};
use crate::run::values::{RecordOfSide, Sides};

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
    let mut covered = Covered::default();
    for (at, (name, node)) in channels.iter().enumerate() {
        let Ok(own) = measured.found.samples(*node) else { continue };
        let mut with = |node: NodeId| {
            simulated.found.samples(node).ok().and_then(|other| covered.agreement(own, other))
        };
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
            consequence: consequence(rule.otherwise),
            ..Finding::note(&rule.name, first)
        });
    }
    findings
}

/// The points of the measurement that the simulation covers, the same for all signals of two
/// records.
#[derive(Default)]
struct Covered(Vec<Both>);

struct Both {
    of: (Arc<Along>, Arc<Along>),
    measured: Range<usize>,
    /// `None` where the simulation has no value.
    simulated: Option<Onto>,
}

enum Onto {
    /// Its samples lie there.
    Samples,
    Interpolated(Located),
}

impl Covered {
    /// Correlation at these points.
    fn agreement(&mut self, measured: &Samples, simulated: &Samples) -> Option<f64> {
        let same = |both: &&Both| {
            Arc::ptr_eq(&both.of.0, &measured.along) && Arc::ptr_eq(&both.of.1, &simulated.along)
        };
        let known = match self.0.iter().position(|both| same(&both)) {
            Some(known) => known,
            None => {
                self.0.push(Both::of(&measured.along, &simulated.along));
                self.0.len() - 1
            }
        };
        let both = &self.0[known];
        let values = measured.values.get(both.measured.clone())?;
        match both.simulated.as_ref()? {
            Onto::Samples => correlation(values, &simulated.values),
            Onto::Interpolated(located) => correlation(values, &located.values(&simulated.values)),
        }
    }
}

impl Both {
    fn of(measured: &Arc<Along>, simulated: &Arc<Along>) -> Self {
        let (axis, along) = (&measured.axis, &simulated.axis);
        let of = (Arc::clone(measured), Arc::clone(simulated));
        if axis == along {
            return Self { of, measured: 0..axis.len(), simulated: Some(Onto::Samples) };
        }
        let (Some(first), Some(last)) = (along.first(), along.last()) else {
            return Self { of, measured: 0..0, simulated: None };
        };
        let inside = axis.partition_point(|at| at < first)..axis.partition_point(|at| at <= last);
        let points = axis.get(inside.clone()).unwrap_or_default();
        Self {
            of,
            measured: inside.clone(),
            simulated: Located::on(along, points).ok().map(Onto::Interpolated),
        }
    }
}
