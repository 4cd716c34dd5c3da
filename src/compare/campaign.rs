//! One campaign by all protocols, reduced to plain numbers.

use rayon::prelude::*;

use super::applicability;
use super::found::{Found, Judgement, Moved};
use super::metric::{self, Base};
use super::sensitivity;
use super::subject::WithProtocols;
use super::{KINDS, Settings};
use crate::certify::Compiled;
use crate::check::plan::Decision;
use crate::data::Campaign;
use crate::problem::{Problems, Severity};
use crate::result::comparison::{Applicability, Cell, Ratio, Score};
use crate::result::{FileHash, Outcome, Reason, Verdict};
use crate::run::several::{Rules, several};
use crate::run::trial::Trial;
use crate::run::{Evaluated, Judged, Progress};

/// What the protocols make of a campaign.
pub fn found(
    WithProtocols { name, campaign, compiled }: &WithProtocols,
    names: &[&str],
    trials: &[Trial],
    settings: &Settings,
    progress: Progress<'_>,
) -> Found {
    let name = name.as_str();
    let rules: Vec<Rules<'_>> = compiled
        .protocols
        .iter()
        .map(|compiled| (compiled, true))
        .chain(compiled.changed.iter().flatten().map(|compiled| (compiled, false)))
        .map(|(compiled, tried)| Rules { plan: &compiled.plan, graph: &compiled.graph, tried })
        .collect();
    let mut all = several(&rules, campaign, trials, progress);
    let changed = all.as_recorded.split_off(compiled.protocols.len());
    let judged: Vec<Result<Judged, &Problems>> = compiled
        .protocols
        .par_iter()
        .zip(&all.as_recorded)
        .map(|(compiled, evaluated)| {
            evaluated.as_ref().map(|evaluated| evaluated.judge(&compiled.plan))
        })
        .collect();
    let judgement =
        |label: &str,
         compiled: &Compiled,
         evaluated: Result<&Evaluated, &Problems>,
         judged: Result<&Judged, &Problems>| match (evaluated, judged) {
            (Ok(evaluated), Ok(judged)) => Judgement {
                cell: cell(name, label, compiled, evaluated, judged),
                ratios: ratios(name, label, compiled, judged),
            },
            (Err(problems), _) | (_, Err(problems)) => {
                Judgement { cell: not_assessable(name, label, problems), ratios: Vec::new() }
            }
        };
    let of_protocol = |(at, label): (usize, &&str)| {
        judgement(
            label,
            &compiled.protocols[at],
            all.as_recorded[at].as_ref(),
            judged[at].as_ref().map_err(|problems| *problems),
        )
    };
    let judgements: Vec<Judgement> = names.iter().enumerate().map(of_protocol).collect();
    let mut evaluated = changed.iter();
    let valid: Vec<_> = compiled
        .changed
        .iter()
        .map(|changed| Some((changed.as_ref().ok()?, evaluated.next()?)))
        .collect();
    let of_change = |(compiled, evaluated): (&Compiled, &Result<Evaluated, Problems>)| {
        let judged = evaluated.as_ref().map(|evaluated| evaluated.judge(&compiled.plan));
        judgement(
            names[0],
            compiled,
            evaluated.as_ref(),
            judged.as_ref().map_err(|problems| *problems),
        )
    };
    let changed: Vec<Option<Judgement>> =
        valid.into_par_iter().map(|valid| valid.map(of_change)).collect();
    let base = |at: usize| {
        Some((
            &compiled.protocols[at],
            all.as_recorded[at].as_ref().ok()?,
            judged[at].as_ref().ok()?,
        ))
    };
    let of_base = |at: usize| -> (Vec<Score>, Vec<Vec<Moved>>, Vec<Applicability>) {
        let Some((compiled, evaluated, judged)) = base(at) else { return Default::default() };
        let numbers = metric::numbers(&compiled.plan, judged);
        let base = Base { compiled, evaluated, judged, numbers: &numbers };
        let trial = |at_trial: usize| all.trials.get(at_trial).and_then(|trial| trial[at].as_ref());
        let disturbances = KINDS.len() * settings.sizes.len();
        let moved = sensitivity::moved(&base, &|at| trial(at), settings);
        let tried = applicability::tried(
            &base,
            trial(disturbances),
            trial(disturbances + 1),
            (names[at], name),
        );
        (scores(name, names[at], compiled, evaluated), moved, tried)
    };
    let parts: Vec<_> = (0..names.len()).into_par_iter().map(of_base).collect();
    let mut found = Found {
        campaign: name.to_string(),
        files: files(campaign, all.as_recorded.iter().flatten()),
        judgements,
        changed,
        scores: Vec::new(),
        moved: Vec::new(),
        applicability: Vec::new(),
        counts: all.counts,
    };
    for (scores, moved, applicability) in parts {
        found.scores.extend(scores);
        found.moved.push(moved);
        found.applicability.push(applicability);
    }
    found
}

/// The files of the campaign, and every record that some protocol read.
fn files<'a>(campaign: &Campaign, evaluated: impl Iterator<Item = &'a Evaluated>) -> Vec<FileHash> {
    let own = campaign.files.iter();
    let mut files: Vec<FileHash> = own
        .map(|file| FileHash {
            path: file.path.clone(),
            sha256: file.sha256.clone(),
            bytes: file.bytes,
            record: None,
        })
        .collect();
    for file in evaluated.flat_map(|evaluated| &evaluated.files) {
        if !files.iter().any(|known| known.path == file.path) {
            files.push(file.clone());
        }
    }
    files
}

fn not_assessable(campaign: &str, protocol: &str, problems: &Problems) -> Cell {
    let errors: Vec<&str> = problems
        .0
        .iter()
        .filter(|problem| problem.severity == Severity::Error)
        .map(|problem| problem.says.as_str())
        .collect();
    let mut reasons: Vec<Reason> =
        errors.iter().take(REASONS).map(|says| Reason::said((*says).to_string())).collect();
    if errors.len() > REASONS {
        reasons.push(Reason::AndMore { more: errors.len() - REASONS });
    }
    Cell {
        campaign: campaign.into(),
        protocol: protocol.into(),
        verdict: Verdict::NotAssessable.in_words().into(),
        holds: None,
        decided_by: None,
        ratio: None,
        sections_used: 0,
        reasons,
    }
}

/// Problems of a campaign that are told for one protocol.
const REASONS: usize = 3;

fn cell(
    campaign: &str,
    protocol: &str,
    compiled: &Compiled,
    evaluated: &Evaluated,
    judged: &Judged,
) -> Cell {
    let plan = &compiled.plan;
    let about: Vec<usize> = match &plan.overall().decision {
        Decision::Limits { quantities, .. } => quantities.clone(),
        Decision::Verdicts(_) | Decision::Person(_) => (0..plan.quantities.len()).collect(),
    };
    let limits = about.iter().filter_map(|&at| judged.quantities.get(at));
    let limits = limits.flat_map(|quantity| {
        quantity.statistics.iter().map(move |statistic| (quantity, statistic))
    });
    // One that does not hold is worse than any that does, also where no ratio can be formed.
    let worst =
        limits.filter(|(_, statistic)| statistic.holds.is_some()).max_by(|(_, a), (_, b)| {
            let rank = |holds: Option<bool>, ratio: Option<f64>| {
                (holds == Some(false), ratio.unwrap_or(0.0))
            };
            let (a, b) = (rank(a.holds, a.normalised), rank(b.holds, b.normalised));
            // The first of equal ones stands.
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(std::cmp::Ordering::Greater)
        });
    let open =
        judged.verdicts.iter().any(|verdict| verdict.overall && verdict.outcome == Outcome::Open);
    Cell {
        campaign: campaign.into(),
        protocol: protocol.into(),
        verdict: if open {
            "open".into()
        } else {
            judged.own_word.clone().unwrap_or_else(|| judged.verdict.in_words().into())
        },
        holds: match judged.verdict {
            Verdict::Validated => Some(true),
            Verdict::NotValidated => Some(false),
            Verdict::NotAssessable => None,
        },
        decided_by: worst.map(|(quantity, statistic)| {
            format!("{}, {}{}", quantity.id, statistic.title, statistic.scope.suffix())
        }),
        ratio: worst.and_then(|(_, statistic)| statistic.normalised),
        sections_used: evaluated.sections().filter(|(_, fault)| fault.is_none()).count(),
        reasons: judged.reasons.clone(),
    }
}

fn ratios(campaign: &str, protocol: &str, compiled: &Compiled, judged: &Judged) -> Vec<Ratio> {
    let mut found = Vec::new();
    for (at, quantity) in judged.quantities.iter().enumerate() {
        for statistic in &quantity.statistics {
            found.push(Ratio {
                campaign: campaign.into(),
                protocol: protocol.into(),
                metric: metric::of(&compiled.plan, at, statistic),
                quantity: quantity.id.clone(),
                symbol: quantity.symbol.clone(),
                estimate: statistic.title.clone(),
                scope: statistic.scope.clone(),
                unit: statistic.unit.clone(),
                value: statistic.value,
                limit: statistic.limit,
                ratio: statistic.normalised,
                holds: statistic.holds,
                reason: statistic.reason.clone().or_else(|| quantity.reason.clone()),
            });
        }
    }
    found
}

/// The score of every section by every metric, and by the protocol as a whole.
fn scores(
    campaign: &str,
    protocol: &str,
    compiled: &Compiled,
    evaluated: &Evaluated,
) -> Vec<Score> {
    let plan = &compiled.plan;
    let mut found: Vec<Score> = Vec::new();
    let mut add = |section: &str, metric: Option<String>, limited: bool, score: f64| match found
        .iter_mut()
        .find(|known| {
            known.section == section && known.metric == metric && known.limited == limited
        }) {
        Some(known) => known.score = known.score.max(score),
        None => found.push(Score {
            campaign: campaign.into(),
            section: section.into(),
            protocol: protocol.into(),
            metric,
            score,
            limited,
        }),
    };
    for one in evaluated.section_ratios(plan) {
        let quantity = &plan.quantities[one.quantity];
        let limit = one.limit.and_then(|limit| quantity.limits.get(limit));
        add(
            &one.section,
            Some(metric::name(quantity, limit.map(AsRef::as_ref))),
            limit.is_some(),
            one.ratio,
        );
        if limit.is_some() {
            add(&one.section, None, true, one.ratio);
        }
    }
    found
}
