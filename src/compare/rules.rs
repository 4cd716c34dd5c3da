//! What differs between two protocols, and what each difference does to the verdict by itself.

use super::{
    found::{CampaignComparison, Judgement},
    subject::{Subject, WithProtocols},
};
use crate::check::{
    diff::{self, Change},
    family::Family,
};
use crate::result::{
    Reason,
    comparison::{Difference, Ratio},
};

/// The differences from one protocol to another.
pub fn changes(before: &Subject, after: &Subject) -> Vec<Change> {
    diff::changes(&before.family.merged, &after.family.merged)
}

/// Whether two protocols are variants of each other: they have a protocol in common that they are
/// or extend, or half of the rules of the first stand in the second. Of others, no rule makes sense
/// in the place of another.
pub fn related(a: &Family, b: &Family) -> bool {
    let common = a.extended().any(|source| b.extended().any(|other| other.text == source.text));
    common || 2 * diff::kept(&a.merged, &b.merged) >= a.merged.blocks.len()
}

/// Every difference by itself on every campaign, then all of them together. None of unrelated
/// protocols.
pub fn differences(
    changes: &[Change],
    campaigns: &[WithProtocols],
    found: &[CampaignComparison],
) -> Vec<Difference> {
    let mut all = Vec::new();
    for (at, change) in changes.iter().enumerate() {
        for (found, opened) in found.iter().zip(campaigns) {
            let deviation = &change.deviation;
            let reason =
                opened.compiled.changed.get(at).and_then(|changed| changed.as_ref().err().cloned());
            let reason = reason.map(Reason::said);
            let after = found.changed.get(at).and_then(Option::as_ref);
            let one = Difference {
                before: deviation.before.clone(),
                after: deviation.after.clone(),
                ..difference(found, after, reason)
            };
            all.push(Difference {
                rule: deviation.rule.clone(),
                words: words(&deviation.before, &deviation.after),
                ..one
            });
        }
    }
    if !changes.is_empty() {
        let number = changes.len();
        for found in found {
            let words = if number == 1 {
                "the one difference".into()
            } else {
                format!("all {number} differences")
            };
            all.push(Difference {
                rule: ALL.into(),
                words,
                ..difference(found, found.judgements.get(1), None)
            });
        }
    }
    all
}

/// In place of a rule: all of them.
pub const ALL: &str = "all rules";

/// `std 9 kN -> std 8 kN`
fn words(before: &Option<String>, after: &Option<String>) -> String {
    match (before, after) {
        (Some(before), Some(after)) => format!("{before} -> {after}"),
        (Some(before), None) => format!("removed: {before}"),
        (None, after) => format!("new: {}", after.as_deref().unwrap_or_default()),
    }
}

fn difference(
    found: &CampaignComparison,
    after: Option<&Judgement>,
    reason: Option<Reason>,
) -> Difference {
    let before = found.judgements.first();
    Difference {
        rule: String::new(),
        words: String::new(),
        before: None,
        after: None,
        campaign: found.campaign.clone(),
        verdict_before: before.map_or_else(String::new, |before| before.cell.verdict.clone()),
        verdict_after: after.map(|after| after.cell.verdict.clone()),
        decided_by_before: before.and_then(|before| before.cell.decided_by.clone()),
        decided_by_after: after.and_then(|after| after.cell.decided_by.clone()),
        ratio_before: before.and_then(|before| before.cell.ratio),
        ratio_after: after.and_then(|after| after.cell.ratio),
        limits_changed: before
            .zip(after)
            .map(|(before, after)| changed(&before.ratios, &after.ratios)),
        reason,
    }
}

/// Limits that are new, gone, or have another value or bound.
fn changed(before: &[Ratio], after: &[Ratio]) -> usize {
    let same = |a: &Ratio, b: &Ratio| {
        a.quantity == b.quantity && a.estimate == b.estimate && a.scope == b.scope
    };
    let other = |ratio: &&Ratio| {
        let known = before.iter().find(|known| same(known, ratio));
        known.is_none_or(|known| {
            known.value != ratio.value || known.limit != ratio.limit || known.holds != ratio.holds
        })
    };
    let gone = before.iter().filter(|ratio| !after.iter().any(|known| same(known, ratio))).count();
    after.iter().filter(other).count() + gone
}
