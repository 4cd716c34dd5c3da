//! Sensitivity of metrics to disturbances of records and to the choice of sections.

use std::collections::BTreeSet;

use indexmap::IndexSet;

use super::{
    KINDS, Settings,
    found::{Base, CampaignComparison, Moved, OfMetric},
    metric::{self, Number},
};
use crate::metrics::{disturb::stream, random::mixed};
use crate::result::{
    Reason,
    comparison::{OfCampaign, Sensitivity},
};
use crate::run::Evaluated;

/// Choices of sections drawn for each size. The rms of a change over this many draws is known to
/// about a quarter.
pub const DRAWS: usize = 8;

/// Beside the disturbances of records.
const SECTIONS: &str = "choice of sections";

impl Moved {
    fn add(&mut self, base: &[Number], now: &[Number]) {
        for number in now {
            let before =
                base.iter().find(|known| known.of == number.of && known.metric == number.metric);
            let at = self
                .metrics
                .iter()
                .position(|known| known.metric == number.metric && known.limited == number.limited);
            let at = at.unwrap_or_else(|| {
                let (metric, limited) = (number.metric.clone(), number.limited);
                self.metrics.push(OfMetric { metric, limited, ..OfMetric::default() });
                self.metrics.len() - 1
            });
            let metric = &mut self.metrics[at];
            if let Some(share) = number.share {
                metric.largest = Some(metric.largest.map_or(share, |known| known.max(share)));
            }
            if let Some(before) = before {
                metric.squares += (number.value - before.value).powi(2);
                metric.count += 1;
            }
        }
    }

    fn judge(&mut self, base: &Base<'_>, evaluated: &Evaluated) {
        let judged = evaluated.judge(base.plan);
        self.add(&base.numbers, &metric::numbers(base.plan, &judged));
        self.verdicts += 1;
        self.verdicts_changed += usize::from(judged.verdict != base.judged.verdict);
    }
}

/// What a protocol does at every size of every disturbance, in the order of [`KINDS`], and of the
/// choice of sections.
pub fn moved<'a>(
    base: &Base<'_>,
    trial: &dyn Fn(usize) -> Option<&'a Evaluated>,
    settings: &Settings,
) -> Vec<Vec<Moved>> {
    let sizes = &settings.sizes;
    let of_records = |kind: usize| {
        let at_size = |size: usize| {
            let mut moved = Moved::default();
            match trial(kind * sizes.len() + size) {
                Some(evaluated) => match lost(base.evaluated, evaluated) {
                    Some(reason) => moved.reason = Some(reason),
                    None => moved.judge(base, evaluated),
                },
                None => moved.reason = Some(Reason::NotTried),
            }
            moved
        };
        (0..sizes.len()).map(at_size).collect()
    };
    let mut all: Vec<Vec<Moved>> = (0..KINDS.len()).map(of_records).collect();
    all.push(sizes.iter().map(|size| chosen(base, *size)).collect());
    all
}

/// Why a section that was used is not in a trial.
fn lost(base: &Evaluated, trial: &Evaluated) -> Option<Reason> {
    let both = base.sections().zip(trial.sections());
    both.into_iter().find_map(|((_, before), (_, now))| now.filter(|_| before.is_none()).cloned())
}

/// Some sections left out, in several draws.
fn chosen(base: &Base<'_>, size: f64) -> Moved {
    let used: Vec<&str> = base.evaluated.used().collect();
    let mut moved = Moved::default();
    if used.len() < 2 {
        moved.reason = Some(Reason::SectionAlone);
        return moved;
    }
    let out = ((size * used.len() as f64).round() as usize).clamp(1, used.len() - 1);
    for draw in 0..DRAWS {
        let left_out = drawn(&used, draw, out);
        moved.judge(base, &base.evaluated.with_sections(&|name| !left_out.contains(name)));
    }
    moved
}

/// The sections of a draw that are left out: more of them are the same ones and others. A section
/// has the same lot in every protocol.
fn drawn<'a>(sections: &[&'a str], draw: usize, out: usize) -> BTreeSet<&'a str> {
    let mut lots: Vec<(u64, &str)> =
        sections.iter().map(|name| (mixed(stream([*name, &draw.to_string()])), *name)).collect();
    lots.sort_unstable();
    lots.into_iter().take(out).map(|(_, name)| name).collect()
}

/// One curve for each metric and disturbance, over all campaigns.
pub fn curves(names: &[&str], found: &[CampaignComparison], sizes: &[f64]) -> Vec<Sensitivity> {
    let mut all = Vec::new();
    if sizes.is_empty() {
        return all;
    }
    for (at, protocol) in names.iter().enumerate() {
        let moved = found.iter().flat_map(|found| found.moved[at].iter().flatten());
        let metrics: IndexSet<(&str, bool)> = moved
            .flat_map(|moved| &moved.metrics)
            .map(|metric| (metric.metric.as_str(), metric.limited))
            .collect();
        for (metric, limited) in metrics {
            for (kind, name) in KINDS.iter().map(|(_, name)| *name).chain([SECTIONS]).enumerate() {
                let of = |size: usize| {
                    found.iter().filter_map(move |found| {
                        Some((found, found.moved[at].get(kind)?.get(size)?))
                    })
                };
                all.push(Sensitivity {
                    disturbance: name.into(),
                    ..curve((protocol, metric, limited), &of, found, sizes)
                });
            }
        }
    }
    all
}

fn curve<'a, I: Iterator<Item = (&'a CampaignComparison, &'a Moved)>>(
    (protocol, metric, limited): (&str, &str, bool),
    of: &dyn Fn(usize) -> I,
    found: &[CampaignComparison],
    sizes: &[f64],
) -> Sensitivity {
    let own = |moved: &'a Moved| {
        moved.metrics.iter().find(|known| known.metric == metric && known.limited == limited)
    };
    let mut curve = Sensitivity {
        metric: metric.into(),
        protocol: protocol.into(),
        disturbance: String::new(),
        sizes: sizes.to_vec(),
        values: Vec::new(),
        reasons: Vec::new(),
        largest: Vec::new(),
        verdicts_changed: Vec::new(),
        verdicts: of(0).map(|(_, moved)| moved.verdicts).sum(),
        limited,
        by_campaign: found
            .iter()
            .map(|found| OfCampaign { campaign: found.campaign.clone(), values: Vec::new() })
            .collect(),
    };
    for size in 0..sizes.len() {
        let (mut squares, mut count, mut largest, mut reason) = (0.0, 0, None, None);
        for (_, moved) in of(size) {
            reason = reason.or_else(|| moved.reason.clone());
            let Some(metric) = own(moved) else { continue };
            squares += metric.squares;
            count += metric.count;
            largest = metric
                .largest
                .map(|value| largest.map_or(value, |known: f64| known.max(value)))
                .or(largest);
        }
        let value = (count > 0 && reason.is_none()).then(|| (squares / count as f64).sqrt());
        let none = || reason.clone().unwrap_or(Reason::MetricWithoutNumber);
        curve.reasons.push(value.is_none().then(none));
        curve.values.push(value);
        curve.largest.push(largest.filter(|_| limited));
        curve.verdicts_changed.push(of(size).map(|(_, moved)| moved.verdicts_changed).sum());
        for of_campaign in &mut curve.by_campaign {
            let moved = of(size)
                .find(|(found, _)| found.campaign == of_campaign.campaign)
                .and_then(|(_, moved)| own(moved));
            of_campaign.values.push(
                moved
                    .filter(|metric| metric.count > 0)
                    .map(|metric| (metric.squares / metric.count as f64).sqrt()),
            );
        }
    }
    curve
}
