//! Study of offsets between measurement and simulation.

use super::{Settings, joined, too_few};
use crate::certify::Compiled;
use crate::data::Campaigns;
use crate::problem::Problems;
use crate::result::{
    Reason, Remark, UnusedSection, Verdict, VerdictWords,
    study::{AtOffset, Estimated, Flipped, Offset, Study, StudyResult, SyncStudy},
};
use crate::run::{Evaluated, Progress, Shifts, evaluate};
use crate::study::{
    case::Case,
    fails::Fails,
    flips::{Marked, flips},
    marked,
    random::{Random, draw},
    reduced,
};

/// Settings of a study of the synchronisation.
#[derive(Clone, Debug)]
pub struct Synchronisation {
    /// In the unit of the axis; 0 is added if missing.
    pub offsets: Vec<f64>,
    /// Largest offset searched in the signals, in the unit of the axis.
    pub farthest: f64,
    /// Whether the estimated offsets are corrected first.
    pub correct: bool,
}

/// Evaluates the campaign with the measurement shifted by each offset.
///
/// # Errors
/// As [`super::sections`], for the records without offset.
pub fn synchronisation<'a>(
    compiled: &Compiled,
    campaigns: impl Into<Campaigns<'a>>,
    settings: &Settings,
    asked: &Synchronisation,
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let campaigns = campaigns.into();
    let Compiled { plan, graph, .. } = compiled;
    let unit = &plan.axis.unit;
    let mut offsets = asked.offsets.clone();
    offsets.push(0.0);
    offsets.sort_by(f64::total_cmp);
    offsets.dedup();
    let si: Vec<f64> = offsets.iter().map(|offset| unit.to_si(*offset)).collect();
    let shifts =
        Shifts { offsets: &si, farthest: Some(unit.to_si(asked.farthest)), correct: asked.correct };
    let all = evaluate(plan, graph, campaigns, &shifts, progress)?;
    let zero = offsets.iter().position(|offset| *offset == 0.0).unwrap_or(0);
    let mut base = Case::of(&all[zero].pool(plan), settings.take).map_err(too_few)?;
    if let Some(most) = settings.reduce {
        // The same sections at every offset: the reduction uses the records without offset.
        base = reduced(&base, most).0;
    }
    let selection = draw(&base, &mut Random::new(settings.selections.seed, 0));
    let fails = marked(&base, &settings.selections).1;
    let without = Without { case: &base, fails, selection: &selection };
    let mut found: Vec<AtOffset> = all
        .iter()
        .zip(&offsets)
        .map(|(evaluated, offset)| at_offset(evaluated, compiled, settings, *offset, &without))
        .collect();
    let words = plan.verdict_words();
    for at in (0..found.len()).filter(|at| *at != zero) {
        found[at].changes = changes(&found[zero], &found[at], &words);
        found[at].lost = lost(&all[zero], &all[at]);
    }
    let estimates = all[zero].offsets().map(|(section, zone, offset)| Estimated {
        section: section.to_owned(),
        zone: zone.map(str::to_owned),
        shift: offset.map(|offset| unit.from_si(offset.shift)),
        low: offset.map(|offset| unit.from_si(offset.low)),
        high: offset.map(|offset| unit.from_si(offset.high)),
        correlation: offset.map(|offset| offset.correlation),
    });
    let study = SyncStudy {
        axis_unit: unit.text.clone(),
        estimates: estimates.collect(),
        corrected: asked.correct,
        selection: selection.iter().map(|&at| base.sections[at].clone()).collect(),
        offsets: found,
    };
    Ok(joined(compiled, campaigns, &all[zero], StudyResult::Sync(study)))
}

/// The reference without offset.
struct Without<'a> {
    case: &'a Case,
    /// Selections that are not validated.
    fails: Option<Fails>,
    /// The selection of the first figure.
    selection: &'a [usize],
}

fn at_offset(
    evaluated: &Evaluated,
    compiled: &Compiled,
    settings: &Settings,
    offset: f64,
    without: &Without<'_>,
) -> AtOffset {
    let plan = &compiled.plan;
    let judged = evaluated.judge(plan);
    let pool = evaluated.pool(plan);
    let usable = without.selection.iter().all(|&at| pool.sections[at].used);
    let case = Case::of(&pool, settings.take).and_then(|case| match settings.reduce {
        None => Ok(case),
        Some(_) => case.with_sections_of(without.case),
    });
    let selected = case
        .as_ref()
        .ok()
        .filter(|_| usable)
        .map_or_else(Vec::new, |case| case.judge(without.selection).1);
    let counted =
        case.as_ref().map_err(Clone::clone).map(|case| (case, marked(case, &settings.selections)));
    let flips = counted.as_ref().map_err(Clone::clone).and_then(|(case, (_, fails))| {
        let before = Marked { case: without.case, fails: without.fails.as_ref() };
        flips(before, Marked { case, fails: fails.as_ref() }, &settings.selections)
    });
    AtOffset {
        offset: if plan.axis.unit.text == "m" {
            Offset::Metres(offset)
        } else {
            Offset::Other(offset)
        },
        verdict: judged.verdict,
        reasons: judged.reasons,
        selected,
        flips: flips.map_or_else(|reason| Flipped::Impossible { reason }, Flipped::Compared),
        quantities: counted
            .as_ref()
            .map_or_else(|_| Vec::new(), |(_, (study, _))| study.quantities.clone()),
        selections: counted.map(|(_, (study, _))| study.counted).into(),
        changes: Vec::new(),
        lost: Vec::new(),
    }
}

/// Differences from the case without offset: the verdict on all sections, limits of all sections,
/// limits of the single selection, and the number of selections with another verdict.
fn changes(base: &AtOffset, at: &AtOffset, words: &VerdictWords) -> Vec<Remark> {
    let mut changes = Vec::new();
    if base.verdict != at.verdict {
        changes.push(Remark::VerdictChanged {
            now: words.word(at.verdict).into(),
            before: words.word(base.verdict).into(),
        });
    }
    if at.verdict != Verdict::NotAssessable {
        for (of, others, gone) in [(at, base, false), (base, at, true)] {
            let other =
                |reason: &&Reason| !others.reasons.iter().any(|known| known.same_limit(reason));
            let changed = of.reasons.iter().filter(other).cloned();
            changes.extend(changed.map(|reason| Remark::ReasonChanged { gone, reason }));
        }
    }
    for (before, now) in
        base.selected.iter().zip(&at.selected).filter(|(before, now)| before.holds != now.holds)
    {
        changes.push(Remark::CriterionChanged {
            statistic: before.name.clone(),
            quantity: before.id.clone(),
            met: now.holds,
        });
    }
    changes
}

fn lost(base: &Evaluated, at: &Evaluated) -> Vec<UnusedSection> {
    let both = base.sections().zip(at.sections()).filter(|((_, before), _)| before.is_none());
    both.filter_map(|(_, (section, now))| {
        Some(UnusedSection { section: section.into(), reason: now?.clone() })
    })
    .collect()
}
