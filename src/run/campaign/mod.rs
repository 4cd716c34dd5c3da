//! Whole campaigns: by one protocol (reduced to values, judged, or both), by several, and one value by
//! itself.

pub mod several;
pub mod single;

use crate::result::{DataItem, DomainRange, DomainResult, SectionResult, Trace, study::Reduction};
use crate::run::{
    data_rules::causes,
    describe::{
        domain, not_asked, told,
        traces::{self, Kept, Signals},
    },
    estimate::{extrapolation, used},
    prelude::*,
    reduce::{
        Numbered, Prepared, Progress, Shard,
        held::{self, Holding},
    },
    sections::{Basis, units},
    values::{SectionValues, Shifts},
    verdict::{Evaluated, Judged, all_values},
};

/// The results of a run. The report adds the descriptions of protocol and campaign.
#[derive(Debug)]
pub struct Outcome {
    pub judged: Judged,
    pub sections: Vec<SectionResult>,
    pub domain: Vec<DomainRange>,
    pub application: Vec<DomainResult>,
    pub traces: Vec<Trace>,
    /// The vehicle data that the protocol reads.
    pub vehicle: Vec<DataItem>,
    pub findings: Vec<Finding>,
    pub notes: Vec<Remark>,
    /// The sections that are kept, where the protocol reduces them.
    pub reduction: Option<Reduction>,
    /// Records in the order of the sections.
    pub files: Vec<FileHash>,
}

/// Settings of a run that are not part of the protocol.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Number of sections whose traces are kept for plots.
    pub traces: usize,
}

/// Executes the whole protocol: reduces every section to its values, then judges them.
///
/// # Errors
/// Reasons why the campaign cannot be used as a whole: missing vehicle data, no usable section, or
/// a fault for which the protocol states `stop`.
pub fn run<'a>(
    plan: &Plan,
    graph: &Graph,
    campaigns: impl Into<Campaigns<'a>>,
    settings: Settings,
    progress: Progress<'_>,
) -> Result<Outcome, Problems> {
    let prepared = Prepared::new(plan, graph, campaigns.into())?;
    let sections = prepared.sections(Shard::WHOLE, progress);
    judge(plan, graph, (&prepared.basis, sections), (settings, &Signals::Of(&prepared.work())))
}

/// As [`run`], without traces, where the values of some sections are known: those that are neither
/// changed nor repeat a changed one. Also returns the values of all sections.
///
/// # Errors
/// As [`run`].
pub fn again(
    plan: &Plan,
    graph: &Graph,
    campaign: &Campaign,
    known: &[Numbered],
    changed: &dyn Fn(&str) -> bool,
) -> Result<(Vec<Numbered>, Outcome), Problems> {
    let prepared = Prepared::new(plan, graph, campaign.into())?;
    let units = &prepared.basis.units;
    let same = |number: usize| {
        let changed = |number: usize| changed(&units[number].name);
        !changed(number) && !units[number].original.is_some_and(changed)
    };
    let known: Vec<&Numbered> = known.iter().filter(|(number, _)| same(*number)).collect();
    let is_known = |number: &usize| known.iter().any(|(known, _)| known == number);
    let others = (0..units.len()).filter(|number| !is_known(number));
    let mut sections = prepared.numbered(others, &|_| {});
    sections.extend(known.into_iter().cloned());
    let settings = Settings { traces: 0 };
    let of = (&prepared.basis, sections.clone());
    let outcome = judge(plan, graph, of, (settings, &Signals::Of(&prepared.work())))?;
    Ok((sections, outcome))
}

/// Judges the values of sections. Sections without values are missing, and the verdict is then not
/// assessable.
///
/// # Errors
/// As [`run`].
pub fn judge(
    plan: &Plan,
    graph: &Graph,
    (basis, sections): (&Basis, Vec<Numbered>),
    (settings, signals): (Settings, &Signals<'_>),
) -> Result<Outcome, Problems> {
    let evaluated = evaluated(plan, basis, sections)?;
    let Evaluated { facts, units, findings, notes, files, application, reduction, .. } = &evaluated;
    let mut findings = findings.clone();
    let judged = evaluated.judge(plan);
    findings.extend(not_asked::findings(plan, facts, units));
    findings.extend(told::findings(plan, facts, &judged.quantities));
    findings.extend(extrapolation::findings(&judged.quantities));
    let (mut traces, mut notes) = (Vec::new(), notes.clone());
    notes.extend(told::not_assessed(&judged.quantities, &used(units, &evaluated.values)));
    for trace in traces::traces((plan, graph), units, &judged.quantities, settings.traces, signals)
    {
        match trace {
            Ok(trace) => traces.push(trace),
            Err(note) => notes.push(note),
        }
    }
    Ok(Outcome {
        domain: domain::domain(plan, units),
        vehicle: facts.items(plan),
        sections: units::results(plan, facts, units),
        judged,
        application: application.clone(),
        traces,
        findings: causes::by_cause(plan, units.len(), findings),
        notes,
        files: files.clone(),
        reduction: reduction.clone(),
    })
}

/// The values of some sections as those of a campaign.
///
/// # Errors
/// As [`run`].
pub fn evaluated(
    plan: &Plan,
    basis: &Basis,
    sections: Vec<Numbered>,
) -> Result<Evaluated, Problems> {
    basis.evaluated(plan, all_values(basis, sections))
}

/// The values of some sections, and what they are judged with.
#[derive(Clone, Debug)]
pub struct Reduced {
    pub basis: Basis,
    pub sections: Vec<Numbered>,
    /// Signals for the plots of a report.
    pub traces: Vec<Kept>,
}

/// Evaluates the sections of a shard. `plots`: whether signals are kept for the plots of a report.
///
/// # Errors
/// The campaign cannot be used as a whole; a record that cannot be used is a fault of its section.
pub fn reduce<'a>(
    plan: &Plan,
    graph: &Graph,
    campaigns: impl Into<Campaigns<'a>>,
    (shard, plots): (Shard, bool),
    progress: Progress<'_>,
) -> Result<Reduced, Problems> {
    let prepared = Prepared::new(plan, graph, campaigns.into())?;
    let sections = prepared.sections(shard, progress);
    let traces = if plots { traces::kept(&prepared.work(), &sections) } else { Vec::new() };
    Ok(Reduced { basis: prepared.basis, sections, traces })
}

/// Evaluates every section with the measurement at each of several shifts (SI of the axis). Filters
/// run once. Sections that cannot be used without a shift are not used at any.
///
/// # Errors
/// As [`run`].
pub fn evaluate<'a>(
    plan: &Plan,
    graph: &Graph,
    campaigns: impl Into<Campaigns<'a>>,
    shifts: &Shifts<'_>,
    progress: Progress<'_>,
) -> Result<Vec<Evaluated>, Problems> {
    let campaigns = campaigns.into();
    if !shifts.plain() {
        let one = campaigns.one_of_each().err();
        let repeats = plan.quantities.iter().find(|quantity| quantity.evaluation.of_repeats()).map(|quantity| {
            let says = format!("`{}` compares repeats, whose records cannot be moved along the track against the simulation", quantity.id);
            Problem::error("repeats-shifted", says)
                .at(&quantity.span)
                .help("remove the quantity with `remove quantity ...` in a protocol that extends this one")
        });
        if let Some(problem) = one.or(repeats) {
            return Err(problem.into());
        }
    }
    let prepared = Prepared::new(plan, graph, campaigns)?;
    let mut values = prepared.shifted(Shard::WHOLE, shifts, progress);
    let mut at =
        |at: usize| values.iter_mut().map(|(_, all)| std::mem::take(&mut all[at])).collect();
    // Rules of plausibility ask about the records as they are: a shift that the study makes is no
    // fault of the data, and every shift is judged with the same sections.
    let unmoved = shifts.offsets.iter().position(|offset| *offset == 0.0).unwrap_or(0);
    let as_recorded: Vec<SectionValues> = at(unmoved);
    let values = as_recorded.into_iter().map(Some).collect();
    let first = prepared.basis.evaluated(plan, values)?;
    let others = (0..shifts.offsets.len()).filter(|shift| *shift != unmoved);
    let mut all: Vec<Evaluated> = others.map(|shift| first.in_trial(plan, at(shift))).collect();
    all.insert(unmoved, first);
    Ok(all)
}

/// Evaluates every section, and then again as `then` asks, with the measured records in memory.
/// `moves`: whether they are moved along the axis too.
///
/// # Errors
/// As [`run`]; `records-not-held`: a record that was read before cannot be read now.
pub fn hold<T>(
    plan: &Plan,
    graph: &Graph,
    campaigns: Campaigns<'_>,
    moves: bool,
    progress: Progress<'_>,
    then: impl FnOnce(&Holding<'_>) -> T,
) -> Result<(Evaluated, T), Problems> {
    let prepared = Prepared::new(plan, graph, campaigns)?;
    let sections = prepared.sections(Shard::WHOLE, progress);
    let base = evaluated(plan, &prepared.basis, sections)?;
    let done = held::hold(&prepared, &base, moves, then)
        .map_err(|reason| Problem::error("records-not-held", reason.text()))?;
    Ok((base, done))
}
