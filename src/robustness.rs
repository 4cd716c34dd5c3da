//! The studies: what another choice of sections, another synchronisation or another parameter would have said.
//!
//! Joins the stages as `certify` does: records are evaluated by `run`, selections are counted by `study`.

use crate::certify::{Compiled, campaign_info, compile, protocol_info};
use crate::check::family::Family;
use crate::check::plan::{Parameter, Plan, SetBy};
use crate::check::{Override, Overrides};
use crate::data::Campaign;
use crate::problem::{Problem, Problems};
use crate::result::Verdict;
use crate::result::study::{AtOffset, AtValue, Estimated, Found, ParameterStudy, Selected, SelectionStudy, Study, SyncStudy, Varied};
use crate::run::{Evaluated, Progress, Shifts, evaluate};
use crate::source::Source;
use crate::study::case::Case;
use crate::study::sampling::{Random, draw};
use crate::study::{self, reduced, selections};
use crate::syntax::document::Text;

/// What is asked of every study.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    pub selections: study::Settings,
    /// Sections of each zone that a selection takes, if not the protocol's number.
    pub take: Option<usize>,
    /// Sections of each zone that are kept before anything is selected.
    pub reduce: Option<usize>,
}

/// Every selection of sections.
///
/// # Errors
/// As [`crate::run::run`]; `too-few-sections`: a zone has fewer usable sections than a selection takes.
pub fn sections(compiled: &Compiled, campaign: &Campaign, settings: &Settings, progress: Progress<'_>) -> Result<Study, Problems> {
    let evaluated = evaluate(&compiled.plan, &compiled.graph, campaign, &Shifts::NONE, progress)?.swap_remove(0);
    let found = selected(&evaluated, &compiled.plan, settings).map_err(too_few)?;
    Ok(joined(compiled, campaign, &evaluated, Found::Sections(found)))
}

fn too_few(says: String) -> Problems {
    Problems(vec![Problem::error("too-few-sections", says).help("give more sections, or fewer for each selection with `--take`")])
}

fn selected(evaluated: &Evaluated, plan: &Plan, settings: &Settings) -> Result<SelectionStudy, String> {
    let case = Case::of(&evaluated.pool(plan), settings.take)?;
    match settings.reduce {
        None => Ok(selections(&case, &settings.selections)),
        Some(most) => {
            let (smaller, reduction) = reduced(&case, most);
            Ok(SelectionStudy { reduction: Some(reduction), ..selections(&smaller, &settings.selections) })
        }
    }
}

fn joined(compiled: &Compiled, campaign: &Campaign, evaluated: &Evaluated, found: Found) -> Study {
    Study {
        protocol: protocol_info(compiled),
        campaign: campaign_info(&compiled.plan, campaign, evaluated.files.clone(), evaluated.vehicle(&compiled.plan)),
        notes: evaluated.notes().to_vec(),
        found,
    }
}

/// How a study of the synchronisation is done.
#[derive(Clone, Debug)]
pub struct Synchronisation {
    /// In the unit of the axis; 0 is added if it is missing.
    pub offsets: Vec<f64>,
    /// Farthest offset looked for in the signals, in the unit of the axis.
    pub farthest: f64,
    /// Whether what is found there is taken out first.
    pub correct: bool,
}

/// The measurement shifted against the simulation.
///
/// # Errors
/// As [`sections`], for the records without offset.
pub fn synchronisation(
    compiled: &Compiled,
    campaign: &Campaign,
    settings: &Settings,
    asked: &Synchronisation,
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let Compiled { plan, graph, .. } = compiled;
    let unit = &plan.axis.unit;
    let mut offsets = asked.offsets.clone();
    offsets.push(0.0);
    offsets.sort_by(f64::total_cmp);
    offsets.dedup();
    let si: Vec<f64> = offsets.iter().map(|offset| unit.to_si(*offset)).collect();
    let shifts = Shifts { offsets: &si, farthest: Some(unit.to_si(asked.farthest)), correct: asked.correct };
    let all = evaluate(plan, graph, campaign, &shifts, progress)?;
    let zero = offsets.iter().position(|offset| *offset == 0.0).unwrap_or(0);
    let base = Case::of(&all[zero].pool(plan), settings.take).map_err(too_few)?;
    let selection = draw(&base, &mut Random::new(settings.selections.seed, 0));
    let mut found: Vec<AtOffset> =
        all.iter().zip(&offsets).map(|(evaluated, offset)| at_offset(evaluated, plan, settings, *offset, &selection)).collect();
    for at in (0..found.len()).filter(|at| *at != zero) {
        found[at].changes = changes(&found[zero], &found[at]);
        found[at].lost = lost(&all[zero], &all[at], plan);
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
    Ok(joined(compiled, campaign, &all[zero], Found::Sync(study)))
}

fn at_offset(evaluated: &Evaluated, plan: &Plan, settings: &Settings, offset: f64, selection: &[usize]) -> AtOffset {
    let judged = evaluated.judge(plan);
    let pool = evaluated.pool(plan);
    let usable = selection.iter().all(|&at| pool.sections[at].used);
    let case = Case::of(&pool, settings.take);
    let selected = case.as_ref().ok().filter(|_| usable).map_or_else(Vec::new, |case| case.judge(selection).1);
    AtOffset {
        offset,
        verdict: judged.verdict,
        reasons: judged.reasons,
        selected,
        study: case.map(|case| selections(&case, &settings.selections)),
        changes: Vec::new(),
        lost: Vec::new(),
    }
}

/// What is otherwise than without offset: the verdict on all sections, limits of all sections, limits of the one selection.
fn changes(base: &AtOffset, at: &AtOffset) -> Vec<String> {
    let mut changes = Vec::new();
    if base.verdict != at.verdict {
        changes.push(format!("all sections: {} instead of {}", at.verdict.in_words(), base.verdict.in_words()));
    }
    for reason in at.reasons.iter().filter(|reason| at.verdict != Verdict::NotAssessable && !same_limit(&base.reasons, reason)) {
        changes.push(format!("all sections: {reason}"));
    }
    for reason in base.reasons.iter().filter(|reason| at.verdict != Verdict::NotAssessable && !same_limit(&at.reasons, reason)) {
        changes.push(format!("all sections: no longer {reason}"));
    }
    for (before, now) in base.selected.iter().zip(&at.selected).filter(|(before, now)| before.holds != now.holds) {
        let word = if now.holds { "holds" } else { "fails" };
        changes.push(format!(
            "the one selection: {} of {} {word} instead of {}",
            before.name,
            before.id,
            if now.holds { "failing" } else { "holding" }
        ));
    }
    changes
}

/// Reasons end in the share of the limit, which is another at every offset.
fn same_limit(reasons: &[String], reason: &str) -> bool {
    let limit = |text: &str| text.rsplit_once(" (").map_or_else(|| text.to_owned(), |(limit, _)| limit.to_owned());
    reasons.iter().any(|known| limit(known) == limit(reason))
}

fn lost(base: &Evaluated, at: &Evaluated, plan: &Plan) -> Vec<(String, String)> {
    let (before, now) = (base.pool(plan).sections, at.pool(plan).sections);
    let gone = before.into_iter().zip(now).filter(|(before, now)| before.used && !now.used);
    gone.map(|(_, now)| (now.name, now.reason.unwrap_or_default())).collect()
}

/// A parameter and the values it is to take, as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    pub name: String,
    pub values: Vec<String>,
}

/// Every parameter that is a choice of words, over all its words.
pub fn all_choices(plan: &Plan) -> Vec<Vary> {
    let choices = plan.parameters.iter().filter(|parameter| !parameter.choices.is_empty());
    choices.map(|parameter| Vary { name: parameter.name.clone(), values: parameter.choices.clone() }).collect()
}

/// The verdict along parameters of the protocol, each varied by itself, the others as they are.
///
/// `progress` is told the value that is being evaluated.
///
/// # Errors
/// A value that the protocol does not admit; as [`crate::run::run`].
pub fn parameters(
    compiled: &Compiled,
    campaign: &Campaign,
    overrides: &Overrides,
    settings: &Settings,
    vary: &[Vary],
    progress: Progress<'_>,
) -> Result<Study, Problems> {
    let plan = &compiled.plan;
    // All values are compiled before any is evaluated: a wrong one is told at once.
    let mut compiled_values = Vec::new();
    let mut problems = Problems::default();
    for varied in vary {
        let Some(parameter) = plan.parameters.iter().find(|parameter| parameter.name == varied.name) else {
            let known = plan.parameters.iter().map(|parameter| parameter.name.as_str());
            problems.push(
                Problem::error("unknown-parameter", format!("protocol `{}` has no parameter `{}`", plan.name, varied.name))
                    .suggest(&varied.name, known),
            );
            continue;
        };
        let values: Vec<Option<Compiled>> =
            varied.values.iter().map(|value| with(compiled.family.clone(), overrides, &varied.name, value, &mut problems)).collect();
        compiled_values.push((varied, parameter, values));
    }
    if problems.any_error() {
        return Err(problems);
    }
    let quiet = |_: &str| {};
    let evaluated = evaluate(plan, &compiled.graph, campaign, &Shifts::NONE, &quiet)?.swap_remove(0);
    progress("as it is");
    let base = at_value(&evaluated, plan, settings, "as it is", true);
    let mut parameters = Vec::new();
    for (varied, parameter, values) in compiled_values {
        let mut found = Vec::new();
        for (value, other) in varied.values.iter().zip(values.into_iter().flatten()) {
            let shown = set_to(&other.plan, &varied.name).map_or_else(|| value.clone(), |parameter| parameter.value.clone());
            progress(&format!("{} {shown}", varied.name));
            if shown == parameter.value {
                found.push(AtValue { value: shown, ..base.clone() });
                continue;
            }
            let evaluated = evaluate(&other.plan, &other.graph, campaign, &Shifts::NONE, &quiet)?.swap_remove(0);
            found.push(at_value(&evaluated, &other.plan, settings, &shown, false));
        }
        parameters.push(Varied {
            name: varied.name.clone(),
            title: parameter.title.clone(),
            base: parameter.value.clone(),
            decides: found.iter().any(|at| at.verdict != base.verdict),
            values: found,
        });
    }
    Ok(joined(compiled, campaign, &evaluated, Found::Parameters(ParameterStudy { base, parameters })))
}

fn set_to<'a>(plan: &'a Plan, name: &str) -> Option<&'a Parameter> {
    plan.parameters.iter().find(|parameter| parameter.name == name)
}

fn with(family: Family, overrides: &Overrides, name: &str, value: &str, problems: &mut Problems) -> Option<Compiled> {
    let mut overrides = overrides.clone();
    let source = Source::new("--vary", format!("{name}={value}"));
    let span = source.span(name.len() + 1..source.text.len());
    let text = Text { text: value.to_owned(), span, exact: true };
    overrides.insert(name.to_owned(), Override { text, set_by: SetBy::CommandLine });
    compile(family, &overrides, problems)
}

fn at_value(evaluated: &Evaluated, plan: &Plan, settings: &Settings, value: &str, is_base: bool) -> AtValue {
    let judged = evaluated.judge(plan);
    let statistics: Vec<Selected> = judged
        .quantities
        .iter()
        .flat_map(|quantity| {
            quantity.statistics.iter().map(|statistic| Selected {
                id: quantity.id.clone(),
                symbol: quantity.symbol.clone(),
                name: statistic.name.clone(),
                scope: statistic.scope.clone(),
                normalised: statistic.normalised,
                holds: statistic.holds == Some(true),
            })
        })
        .collect();
    let largest = statistics
        .iter()
        .filter_map(|statistic| statistic.normalised.map(|share| (format!("{} of {}", statistic.name, statistic.symbol), share)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let study = selected(evaluated, plan, settings);
    AtValue {
        value: value.to_owned(),
        is_base,
        verdict: judged.verdict,
        reasons: judged.reasons,
        statistics,
        largest,
        combinations: study.as_ref().map_or(0.0, |study| study.combinations),
        share: study.as_ref().ok().map(|study| study.share),
        reason: study.err(),
    }
}
