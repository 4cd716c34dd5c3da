//! One campaign by all protocols, reduced to plain numbers.

use indexmap::IndexMap;
use rayon::prelude::*;

use super::{
    KINDS, Settings, applicability,
    found::{Base, CampaignComparison, Judgement, Moved},
    metric, sensitivity,
    subject::WithProtocols,
};
use crate::certify::Compiled;
use crate::check::plan::Decision;
use crate::data::Campaign;
use crate::problem::{Problems, Severity};
use crate::result::{
    FileHash, Outcome, Reason, Verdict,
    comparison::{Applicability, Cell, Ratio, Score},
};
use crate::run::{
    Evaluated, Progress, file_hash,
    several::{Rules, several},
    trial::Trial,
};

impl<'a> Base<'a> {
    /// # Errors
    /// Why the protocol cannot be evaluated.
    fn new(
        (campaign, protocol): (&'a str, &'a str),
        compiled: &'a Compiled,
        evaluated: &'a Result<Evaluated, Problems>,
    ) -> Result<Self, &'a Problems> {
        let (plan, evaluated) = (&compiled.plan, evaluated.as_ref()?);
        let judged = evaluated.judge(plan);
        let numbers = metric::numbers(plan, &judged);
        Ok(Self { campaign, protocol, plan, evaluated, judged, numbers })
    }
}

/// What the protocols make of a campaign.
pub fn found(
    WithProtocols { name, campaign, compiled }: &WithProtocols,
    names: &[&str],
    trials: &[Trial],
    settings: &Settings,
    progress: Progress<'_>,
) -> CampaignComparison {
    let protocols = compiled.protocols.iter().map(|compiled| (compiled, true));
    let changed = compiled.changed.iter().flatten().map(|compiled| (compiled, false));
    let rules: Vec<Rules<'_>> = protocols
        .chain(changed)
        .map(|(compiled, tried)| Rules { plan: &compiled.plan, graph: &compiled.graph, tried })
        .collect();
    let mut all = several(&rules, campaign, trials, progress);
    let changed = all.as_recorded.split_off(compiled.protocols.len());
    let bases: Vec<Result<Base<'_>, &Problems>> = (0..names.len())
        .into_par_iter()
        .map(|at| {
            Base::new((name.as_str(), names[at]), &compiled.protocols[at], &all.as_recorded[at])
        })
        .collect();
    let judgements = names.iter().zip(&bases);
    let judgements = judgements
        .map(|(label, base)| judgement((name, label), base.as_ref().map_err(|told| *told)));
    let mut evaluated = changed.iter();
    let valid: Vec<_> = compiled
        .changed
        .iter()
        .map(|changed| Some((changed.as_ref().ok()?, evaluated.next()?)))
        .collect();
    let of_change = |(compiled, evaluated)| {
        let label = (name.as_str(), names[0]);
        judgement(label, Base::new(label, compiled, evaluated).as_ref().map_err(|told| *told))
    };
    let mut found = CampaignComparison {
        campaign: name.clone(),
        files: files(campaign, all.as_recorded.iter().flatten()),
        judgements: judgements.collect(),
        changed: valid.into_par_iter().map(|valid| valid.map(of_change)).collect(),
        scores: Vec::new(),
        moved: Vec::new(),
        applicability: Vec::new(),
        counts: all.counts,
    };
    let of_base = |at: usize| -> (Vec<Score>, Vec<Vec<Moved>>, Vec<Applicability>) {
        let Ok(base) = &bases[at] else { return Default::default() };
        let trial = |number: usize| all.trials.get(number)?[at].as_ref();
        let disturbances = KINDS.len() * settings.sizes.len();
        let moved = sensitivity::moved(base, &trial, settings);
        let (doubled, exchanged) = (trial(disturbances), trial(disturbances + 1));
        (base.scores(), moved, applicability::tried(base, doubled, exchanged))
    };
    let parts: Vec<_> = (0..names.len()).into_par_iter().map(of_base).collect();
    for (scores, moved, applicability) in parts {
        found.scores.extend(scores);
        found.moved.push(moved);
        found.applicability.push(applicability);
    }
    found
}

/// The files of the campaign, and every record that some protocol read.
fn files<'a>(campaign: &Campaign, evaluated: impl Iterator<Item = &'a Evaluated>) -> Vec<FileHash> {
    let mut files: Vec<FileHash> =
        campaign.files.iter().map(|file| file_hash(file, None, None)).collect();
    for file in evaluated.flat_map(|evaluated| &evaluated.files) {
        if !files.iter().any(|known| known.path == file.path) {
            files.push(file.clone());
        }
    }
    files
}

/// Problems of a campaign that are told for one protocol.
const REASONS: usize = 3;

/// The verdict of a protocol on a campaign.
fn judgement((campaign, protocol): (&str, &str), base: Result<&Base<'_>, &Problems>) -> Judgement {
    let problems = match base {
        Ok(base) => return Judgement { cell: base.cell(), ratios: base.ratios() },
        Err(problems) => problems,
    };
    let errors = problems.0.iter().filter(|problem| problem.severity == Severity::Error);
    let mut reasons: Vec<Reason> =
        errors.map(|problem| Reason::said(problem.says.clone())).collect();
    if reasons.len() > REASONS {
        let more = reasons.split_off(REASONS).len();
        reasons.push(Reason::AndMore { more });
    }
    let cell = Cell {
        campaign: campaign.into(),
        protocol: protocol.into(),
        verdict: Verdict::NotAssessable.in_words().into(),
        holds: None,
        decided_by: None,
        ratio: None,
        sections_used: 0,
        reasons,
    };
    Judgement { cell, ratios: Vec::new() }
}

impl Base<'_> {
    fn cell(&self) -> Cell {
        let Self { plan, judged, .. } = self;
        let about: Vec<usize> = match &plan.overall().decision {
            Decision::Verdicts(_) | Decision::Person(_) => (0..plan.quantities.len()).collect(),
            decision => decision.quantities(),
        };
        let limits = about.iter().filter_map(|&at| judged.quantities.get(at));
        let limits = limits.flat_map(|quantity| {
            quantity.statistics.iter().map(move |statistic| (quantity, statistic))
        });
        // One that does not hold is worse than any that does, also where no ratio can be formed.
        let worst =
            limits.filter(|(_, statistic)| statistic.holds.is_some()).max_by(|(_, a), (_, b)| {
                let ratio = |ratio: Option<f64>| ratio.unwrap_or(f64::INFINITY);
                // The first of equal ones stands.
                (a.holds == Some(false))
                    .cmp(&(b.holds == Some(false)))
                    .then(ratio(a.normalised).total_cmp(&ratio(b.normalised)))
                    .then(std::cmp::Ordering::Greater)
            });
        let mut verdicts = judged.verdicts.iter();
        let open = verdicts.any(|verdict| verdict.overall && verdict.outcome == Outcome::Open);
        Cell {
            campaign: self.campaign.into(),
            protocol: self.protocol.into(),
            verdict: match &judged.own_word {
                _ if open => "open".into(),
                Some(word) => word.clone(),
                None => judged.verdict.in_words().into(),
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
            sections_used: self.evaluated.used().count(),
            reasons: judged.reasons.clone(),
        }
    }

    fn ratios(&self) -> Vec<Ratio> {
        let mut found = Vec::new();
        for (at, quantity) in self.judged.quantities.iter().enumerate() {
            found.extend(quantity.statistics.iter().map(|statistic| Ratio {
                campaign: self.campaign.into(),
                protocol: self.protocol.into(),
                metric: metric::metric_of(self.plan, at, statistic),
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
            }));
        }
        found
    }

    /// The score of every section by every metric, and by the protocol as a whole.
    fn scores(&self) -> Vec<Score> {
        let mut found: IndexMap<(String, Option<String>, bool), (f64, f64)> = IndexMap::new();
        for one in self.evaluated.section_ratios(self.plan) {
            let quantity = &self.plan.quantities[one.quantity];
            let limit = one.limit.and_then(|limit| quantity.limits.get(limit)).map(AsRef::as_ref);
            let (limited, metric) = (limit.is_some(), metric::name(quantity, limit));
            for metric in std::iter::once(Some(metric)).chain(limited.then_some(None)) {
                let score =
                    found.entry((one.section.clone(), metric, limited)).or_insert(one.score);
                if one.score > *score {
                    *score = one.score;
                }
            }
        }
        let score = |((section, metric, limited), (score, shortfall)): (_, (f64, f64))| Score {
            campaign: self.campaign.into(),
            section,
            protocol: self.protocol.into(),
            metric,
            score: Some(score).filter(|score| score.is_finite()),
            shortfall: score.is_infinite().then_some(shortfall),
            limited,
        };
        found.into_iter().map(score).collect()
    }
}
