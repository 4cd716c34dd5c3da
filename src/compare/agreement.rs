//! Agreement of protocols and of metrics, section by section.

use indexmap::IndexSet;

use super::found::CampaignComparison;
use crate::metrics::rank::spearman;
use crate::result::{
    Reason,
    comparison::{Agreement, Cell, Score},
};

/// Every pair of protocols, then every pair of metrics of each protocol.
pub fn agreement(names: &[&str], found: &[CampaignComparison]) -> Vec<Agreement> {
    let scores: Vec<&Score> = found.iter().flat_map(|found| &found.scores).collect();
    let of = |protocol: &str, metric: Option<&str>| -> Vec<&Score> {
        scores
            .iter()
            .copied()
            .filter(|score| score.protocol == protocol && score.metric.as_deref() == metric)
            .collect()
    };
    let mut all = Vec::new();
    for (at, a) in names.iter().enumerate() {
        for (later, b) in names.iter().enumerate().skip(at + 1) {
            let pair = pair(&of(a, None), &of(b, None));
            let verdicts = Some(verdicts(found, at, later));
            all.push(Agreement {
                of: "protocols".into(),
                a: (*a).into(),
                b: (*b).into(),
                verdicts,
                ..pair
            });
        }
    }
    for protocol in names {
        let own = scores.iter().filter(|score| score.protocol == *protocol);
        let metrics: IndexSet<&str> = own.filter_map(|score| score.metric.as_deref()).collect();
        for (at, a) in metrics.iter().enumerate() {
            for b in metrics.iter().skip(at + 1) {
                let pair = pair(&of(protocol, Some(a)), &of(protocol, Some(b)));
                let protocol = Some((*protocol).to_string());
                all.push(Agreement {
                    of: "metrics".into(),
                    protocol,
                    a: (*a).into(),
                    b: (*b).into(),
                    ..pair
                });
            }
        }
    }
    all
}

/// Two lists of scores by section.
fn pair(a: &[&Score], b: &[&Score]) -> Agreement {
    let mut scores = Vec::new();
    let mut contingency = [[0; 2]; 2];
    for one in a {
        let same = |other: &&&Score| other.campaign == one.campaign && other.section == one.section;
        let Some(other) = b.iter().find(same) else { continue };
        scores.push((order(one), order(other)));
        contingency[usize::from(!meets(one))][usize::from(!meets(other))] += 1;
    }
    let limited = a.iter().chain(b).all(|score| score.limited);
    let spearman = spearman(&scores);
    let reason = match scores.len() {
        _ if spearman.is_some() => None,
        0 => Some(Reason::NoCommonScore),
        1 | 2 => Some(Reason::TooFewCommonScores),
        _ => Some(Reason::EqualScores),
    };
    Agreement {
        of: String::new(),
        protocol: None,
        a: String::new(),
        b: String::new(),
        sections: scores.len(),
        contingency: limited.then_some(contingency),
        spearman,
        reason,
        verdicts: None,
    }
}

/// A value equal to its limit meets it; this much room is for the rounding of units and sums, as in
/// a verdict.
const EQUAL: f64 = 1e-12;

fn meets(score: &Score) -> bool {
    score.score.is_some_and(|score| score <= 1.0 + EQUAL)
}

/// Where there is no ratio, the value is worse than any with one.
fn order(score: &Score) -> (f64, f64) {
    (score.score.unwrap_or(f64::INFINITY), score.shortfall.unwrap_or(0.0))
}

/// Campaigns by verdict: holds, does not hold, not assessable.
fn verdicts(found: &[CampaignComparison], a: usize, b: usize) -> [[usize; 3]; 3] {
    let place = |cell: &Cell| cell.holds.map_or(2, |holds| usize::from(!holds));
    let mut counts = [[0; 3]; 3];
    for found in found {
        if let (Some(a), Some(b)) = (found.judgements.get(a), found.judgements.get(b)) {
            counts[place(&a.cell)][place(&b.cell)] += 1;
        }
    }
    counts
}
