//! What a metric can be applied to, found by trying: one quantity, one section, doubled and
//! exchanged records.

use super::{
    found::{Base, CampaignComparison},
    metric,
};
use crate::check::plan::Plan;
use crate::result::{
    PairValue, QuantityResult, Verdict,
    comparison::{Applicability, Tried},
};
use crate::run::{Evaluated, Judged};

/// Values are the same, or twice as large, to this share of the largest: the rounding of filters
/// over doubled records.
const SAME: f64 = 1e-9;

/// Tries every metric of a protocol.
pub fn tried(
    base: &Base<'_>,
    doubled: Option<&Evaluated>,
    exchanged: Option<&Evaluated>,
) -> Vec<Applicability> {
    let plan = base.plan;
    let (doubled, exchanged) =
        (doubled.map(|trial| trial.judge(plan)), exchanged.map(|trial| trial.judge(plan)));
    let metrics = metric::all(plan);
    let of_metric = |(name, limited): &(String, bool)| {
        let own = quantities(plan, name);
        let pairs = |trial| pairs(&base.judged, trial, &own);
        Applicability {
            protocol: base.protocol.into(),
            quantities: own.len(),
            scale: doubled.as_ref().and_then(|trial| scale(&pairs(trial))).map(str::to_string),
            symmetric: exchanged.as_ref().and_then(|trial| symmetric(&pairs(trial))),
            campaign: Some(base.campaign.into()),
            metric: if *limited { name.clone() } else { format!("{name} (no limit)") },
            number_of_one_quantity: Tried::default(),
            number_of_one_section: Tried::default(),
            verdict_of_one_quantity: Tried::default(),
            verdict_of_one_section: Tried::default(),
        }
    };
    let mut found: Vec<Applicability> = metrics.iter().map(of_metric).collect();
    for at in 0..plan.quantities.len() {
        if base.judged.quantities[at].values.is_empty() {
            continue;
        }
        let judged = base.evaluated.with_quantity(at).judge(plan);
        let numbers = numbers(plan, &judged, at);
        for (one, metric) in found.iter_mut().zip(&metrics) {
            if quantities(plan, &metric.0).contains(&at) {
                one.number_of_one_quantity.add(numbers.contains(metric));
                one.verdict_of_one_quantity.add(judged.verdict != Verdict::NotAssessable);
            }
        }
    }
    for section in base.evaluated.used() {
        let judged = base.evaluated.with_sections(&|name| name == section).judge(plan);
        let numbers: Vec<(String, bool)> =
            (0..plan.quantities.len()).flat_map(|at| numbers(plan, &judged, at)).collect();
        for (one, metric) in found.iter_mut().zip(&metrics) {
            let own = quantities(plan, &metric.0);
            // A section that a quantity leaves out says nothing about the metric.
            if own.iter().any(|&at| !judged.quantities[at].values.is_empty()) {
                one.number_of_one_section.add(numbers.contains(metric));
                one.verdict_of_one_section.add(judged.verdict != Verdict::NotAssessable);
            }
        }
    }
    found
}

/// The quantities with a metric.
fn quantities(plan: &Plan, name: &str) -> Vec<usize> {
    let has = |at: &usize| {
        let quantity = &plan.quantities[*at];
        let limits =
            quantity.limits.iter().any(|limit| metric::name(quantity, Some(limit)) == name);
        limits || quantity.limits.is_empty() && metric::name(quantity, None) == name
    };
    (0..plan.quantities.len()).filter(has).collect()
}

/// The metrics that have a number of a quantity, and whether they have limits.
fn numbers(plan: &Plan, judged: &Judged, at: usize) -> Vec<(String, bool)> {
    let quantity = &judged.quantities[at];
    let statistics = quantity.statistics.iter().filter(|statistic| statistic.value.is_some());
    let mut found: Vec<(String, bool)> =
        statistics.map(|statistic| (metric::metric_of(plan, at, statistic), true)).collect();
    if quantity.statistics.is_empty() && !quantity.values.is_empty() {
        found.push((metric::name(&plan.quantities[at], None), false));
    }
    found
}

/// Values of some quantities before and in a trial.
type Pairs<'a> = Vec<(&'a PairValue, &'a PairValue)>;

fn pairs<'a>(before: &'a Judged, now: &'a Judged, quantities: &[usize]) -> Pairs<'a> {
    let same = |(a, b): &(&PairValue, &PairValue)| {
        a.section == b.section && a.signal == b.signal && a.taken == b.taken
    };
    let of = |(a, b): (&'a QuantityResult, &'a QuantityResult)| {
        a.values.iter().zip(&b.values).filter(same).collect::<Vec<_>>()
    };
    quantities.iter().flat_map(|&at| of((&before.quantities[at], &now.quantities[at]))).collect()
}

/// Whether values stay (`relative`) or double (`absolute`) with the records. Differences of values
/// that do not double themselves, such as those of a ratio of two channels, say nothing.
fn scale(pairs: &[(&PairValue, &PairValue)]) -> Option<&'static str> {
    let says = |(before, now): &&(&PairValue, &PairValue)| match (
        before.measured.or(before.simulated),
        now.measured.or(now.simulated),
    ) {
        (Some(before), Some(now)) => (now - before).abs() > SAME * before.abs(),
        _ => true,
    };
    let told: Vec<(f64, f64)> = pairs
        .iter()
        .filter(says)
        .map(|(before, now)| (before.difference, now.difference))
        .collect();
    let largest = told.iter().map(|(before, now)| before.abs().max(now.abs())).fold(0.0, f64::max);
    if largest == 0.0 {
        return None;
    }
    let all = |factor: f64| {
        told.iter().all(|(before, now)| (now - factor * before).abs() <= SAME * largest)
    };
    Some(match (all(1.0), all(2.0)) {
        (true, _) => "relative",
        (_, true) => "absolute",
        _ => "neither",
    })
}

/// Whether magnitudes stay the same; `None` where there is nothing to compare.
fn symmetric(pairs: &[(&PairValue, &PairValue)]) -> Option<bool> {
    let largest = pairs
        .iter()
        .map(|(before, now)| before.difference.abs().max(now.difference.abs()))
        .fold(0.0, f64::max);
    let same = |(before, now): &(&PairValue, &PairValue)| {
        (before.difference.abs() - now.difference.abs()).abs() <= SAME * largest
    };
    (!pairs.is_empty()).then(|| pairs.iter().all(same))
}

/// For each protocol the first campaign on which it has a verdict, else the first on which it can
/// be evaluated.
pub fn put_together(found: &[CampaignComparison]) -> Vec<Applicability> {
    let protocols = found.first().map_or(0, |found| found.judgements.len());
    let of_protocol = |at: usize| {
        let assessable = found.iter().find(|found| found.judgements[at].cell.holds.is_some());
        let any = || found.iter().find(|found| !found.applicability[at].is_empty());
        assessable.or_else(any).map_or_else(Vec::new, |found| found.applicability[at].clone())
    };
    (0..protocols).flat_map(of_protocol).collect()
}
