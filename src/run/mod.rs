//! Executes a graph over a campaign: records in parallel, one at a time per worker, to plain
//! results. The steps in their order:
//!
//! | folder | step |
//! |---|---|
//! | `sections` | the sections of the campaigns, and what is known before any record is read |
//! | `record` | one record through the signal nodes of the graph |
//! | `values` | the records of a section to rows of the table of values |
//! | `data_rules` | what is asked of the data: checks, plausibility, copies |
//! | `reduce` | all sections to their values; by several protocols; one value by itself |
//! | `estimate` | groups of rows, and what is estimated from them |
//! | `limit` | estimates against their limits; the same for selections of sections |
//! | `describe` | what a report tells beside the verdict |
//! | `verdict` | results of quantities and verdicts; the same from the values of a result |
//! | `find` | before all others where a campaign has runs: sections are looked for in them |
//! | `needs` | what the steps read, known from the protocol alone |

mod data_rules;
mod describe;
mod estimate;
pub mod find;
mod limit;
pub mod needs;
mod record;
mod reduce;
mod sections;
mod values;
mod verdict;
mod words;

pub use limit::pool;
pub use record::trial;
pub use reduce::{several, single};
pub use verdict::replay;

use indexmap::IndexMap;

use crate::check::plan::{OnFault, Plan, Side};
use crate::data::{Campaign, Campaigns};
use crate::graph::Graph;
use crate::problem::{Problem, Problems};
use crate::result::study::Reduction;
use crate::result::{
    DataItem, DomainRange, DomainResult, FileHash, Finding, QuantityResult, Reported,
    SectionResult, Trace, Verdict, VerdictResult, ZoneResult,
};

pub use data_rules::consequence::consequence;
use data_rules::copies;
pub use describe::traces::{Kept, Signals};
use describe::{domain, not_asked, told, traces};
use estimate::extrapolation;
pub use estimate::table::Row;
use limit::keep;
use pool::Pool;
use record::Found;
pub use record::shared::Counts;
pub use reduce::shards::{Numbered, Reduced, Shard, reduce};
pub use sections::facts::{Facts, scalar};
pub use sections::unit::Unit;
use sections::{columns, requirements, stretches, units, wanted};
pub use values::print::Print;
pub use values::section_values::SectionValues;
pub use values::synchronisation::{Offset, Shifts};
pub use verdict::basis::Basis;
use verdict::judge as judging;
pub use verdict::judge::Judged;

/// The results of a run. The report adds the descriptions of protocol and campaign.
#[derive(Debug)]
pub struct Outcome {
    pub verdict: Verdict,
    /// The overall verdict in the words of the protocol, if it states them.
    pub own_word: Option<String>,
    pub reasons: Vec<String>,
    /// Verdicts with a name.
    pub verdicts: Vec<VerdictResult>,
    pub quantities: Vec<QuantityResult>,
    pub sections: Vec<SectionResult>,
    pub zones: Vec<ZoneResult>,
    /// Numbers of the data of the sections.
    pub reported: Vec<Reported>,
    pub domain: Vec<DomainRange>,
    pub application: Vec<DomainResult>,
    pub traces: Vec<Trace>,
    /// The vehicle data that the protocol reads.
    pub vehicle: Vec<DataItem>,
    pub findings: Vec<Finding>,
    pub notes: Vec<String>,
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

/// Called after each record, from any thread.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

/// A campaign with every section evaluated, before limits are applied.
#[derive(Debug)]
pub struct Evaluated {
    facts: Facts,
    units: Vec<Unit>,
    values: Vec<SectionValues>,
    findings: Vec<Finding>,
    /// Wanted operation against what the sections used cover.
    application: Vec<DomainResult>,
    notes: Vec<String>,
    reduction: Option<Reduction>,
    /// Sections whose values are missing, in words.
    missing: Option<String>,
    /// Records in the order of the sections.
    pub files: Vec<FileHash>,
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
    let Evaluated { units, findings, notes, files, .. } = &evaluated;
    let judged = evaluated.judge(plan, graph);
    let mut findings = findings.clone();
    findings.extend(requirements::findings(plan, &evaluated.facts, units));
    findings.extend(not_asked::findings(plan, &evaluated.facts, units));
    findings.extend(told::findings(plan, &evaluated.facts, &judged.quantities));
    findings.extend(extrapolation::findings(&judged.quantities));
    let (mut traces, mut notes) = (Vec::new(), notes.clone());
    for trace in traces::traces((plan, graph), units, &judged.quantities, settings.traces, signals)
    {
        match trace {
            Ok(trace) => traces.push(trace),
            Err(note) => notes.push(note),
        }
    }
    let domain = domain::domain(plan, units);
    Ok(Outcome {
        verdict: judged.verdict,
        own_word: judged.own_word,
        reasons: judged.reasons,
        verdicts: judged.verdicts,
        quantities: judged.quantities,
        zones: judged.zones,
        reported: judged.reported,
        domain,
        application: evaluated.application.clone(),
        traces,
        vehicle: evaluated.vehicle(plan),
        findings,
        notes,
        files: files.clone(),
        reduction: evaluated.reduction.clone(),
        sections: units::results(plan, &evaluated.facts, evaluated.units),
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
    let mut values: Vec<Option<SectionValues>> = vec![None; basis.units.len()];
    for (number, of_section) in sections {
        if let Some(place) = values.get_mut(number) {
            *place = Some(of_section);
        }
    }
    basis.evaluated(plan, values, true, None)
}

/// Evaluates every section with the measurement at each of several shifts (SI of the axis). Filters
/// run once.
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
            return Err(Problems(vec![problem]));
        }
    }
    Prepared::new(plan, graph, campaigns)?.evaluate(shifts, progress)
}

impl Evaluated {
    /// Results of quantities and verdicts over all usable sections.
    pub fn judge(&self, plan: &Plan, graph: &Graph) -> Judged {
        let barred =
            self.missing.iter().cloned().chain(domain::barred(&self.application)).collect();
        judging::judge(
            plan,
            graph,
            &self.facts,
            &self.units,
            &self.values,
            &judging::Told { findings: &self.findings, barred },
        )
    }

    /// All values and limits that the verdict depends on.
    pub fn pool(&self, plan: &Plan) -> Pool {
        pool::pool(plan, &self.facts, &self.units, &self.values)
    }

    /// Vehicle data that the protocol reads.
    pub fn vehicle(&self, plan: &Plan) -> Vec<DataItem> {
        self.facts.items(plan)
    }

    /// Sections whose values are missing, in words.
    pub fn missing(&self) -> Option<&str> {
        self.missing.as_deref()
    }

    /// Remarks that do not change the verdict.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Each section with its estimated shift (SI of the axis), where it was requested.
    pub fn offsets(&self) -> impl Iterator<Item = (&str, Option<&str>, Option<&Offset>)> {
        self.units.iter().zip(&self.values).map(|(unit, values)| {
            (unit.name.as_str(), unit.zone.as_deref(), values.offset.as_ref())
        })
    }
}

/// Checks what a run reads before any record: the data of vehicles and sections, and wanted
/// operation. Records need not exist.
pub fn check_data(plan: &Plan, campaign: &Campaign, problems: &mut Problems) {
    let campaigns = Campaigns::from(campaign);
    campaigns.check(problems);
    let facts = Facts::read(plan, campaigns, problems);
    if find::applies(plan, campaign) {
        find::check_facts(plan, campaign, problems);
        wanted::points(plan, campaigns, &facts, problems);
        return;
    }
    let mut units = units::units(plan, campaigns, problems);
    wanted::points(plan, campaigns, &facts, problems);
    if problems.any_error() {
        return;
    }
    requirements::check_data(plan, &facts, &mut units);
    let told = match stop_on_fault(plan, &units, &[]) {
        Ok(()) if units.iter().any(|unit| unit.fault.is_none()) => return,
        Ok(()) => nothing_usable(&units, vec![SectionValues::default(); units.len()]),
        Err(told) => told,
    };
    told.0.into_iter().for_each(|problem| problems.push(problem));
}

/// Data read before any record.
struct Prepared<'a> {
    plan: &'a Plan,
    graph: &'a Graph,
    campaigns: Campaigns<'a>,
    basis: Basis,
    present: Vec<Vec<Vec<bool>>>,
    recorded: Vec<Vec<Vec<bool>>>,
    soundness: record::Soundness,
}

impl<'a> Prepared<'a> {
    fn new(plan: &'a Plan, graph: &'a Graph, campaigns: Campaigns<'a>) -> Result<Self, Problems> {
        let mut problems = Problems::default();
        campaigns.check(&mut problems);
        for asked in &plan.campaigns {
            let names = || campaigns.iter().map(|campaign| campaign.short_name.value.as_str());
            if !names().any(|name| name == asked.value) {
                let says = format!("none of the campaigns is called `{}`", asked.value);
                let problem = Problem::error("unknown-campaign", says)
                    .at(&asked.span)
                    .suggest(&asked.value, names());
                let known = names().collect::<Vec<_>>().join("; ");
                problems.push(if problem.help.is_some() {
                    problem
                } else {
                    problem.help(format!("there is {known}"))
                });
            }
        }
        members(plan, campaigns, &mut problems);
        let facts = Facts::read(plan, campaigns, &mut problems);
        let mut units = units::units(plan, campaigns, &mut problems);
        let wanted = wanted::points(plan, campaigns, &facts, &mut problems);
        if problems.any_error() {
            return Err(problems);
        }
        let mut notes = Vec::new();
        let (mut present, mut recorded) = (Vec::new(), Vec::new());
        for (number, campaign) in campaigns.iter().enumerate() {
            let units: Vec<&Unit> = units.iter().filter(|unit| unit.campaign == number).collect();
            let seen = columns::seen_columns(plan, campaign, &units);
            present.push(columns::present_columns(
                plan, graph, campaign, &seen, &facts, &units, &mut notes,
            ));
            recorded.push(columns::recorded_positions(graph, &seen, &facts, &units));
            if plan.reads(Side::Measured) {
                notes.extend(campaign.offsets_in_words());
            }
        }
        requirements::check_data(plan, &facts, &mut units);
        stop_on_fault(plan, &units, &[])?;
        stretches::share(plan, campaigns, &mut units);
        Ok(Self {
            plan,
            graph,
            campaigns,
            basis: Basis { facts, units, wanted, notes },
            present,
            recorded,
            soundness: record::Soundness::default(),
        })
    }

    fn work(&self) -> record::Work<'_> {
        record::Work {
            plan: self.plan,
            graph: self.graph,
            campaigns: self.campaigns,
            facts: &self.basis.facts,
            units: &self.basis.units,
            present: &self.present,
            recorded: &self.recorded,
            shared: None,
            soundness: &self.soundness,
            stretches: None,
        }
    }

    fn evaluate(
        &self,
        shifts: &Shifts<'_>,
        progress: Progress<'_>,
    ) -> Result<Vec<Evaluated>, Problems> {
        let mut values = self.shifted(Shard::WHOLE, shifts, progress);
        let mut at = |at: usize, reduction: Option<&Reduction>| {
            let values =
                values.iter_mut().map(|(_, all)| Some(std::mem::take(&mut all[at]))).collect();
            self.basis.evaluated(self.plan, values, shifts.offsets[at] == 0.0, reduction)
        };
        // The same sections at every shift: a reduction looks at the records as they are.
        let unmoved = shifts.offsets.iter().position(|offset| *offset == 0.0).unwrap_or(0);
        let first = at(unmoved, None)?;
        let mut all: Vec<Evaluated> = Vec::new();
        for shift in (0..shifts.offsets.len()).filter(|shift| *shift != unmoved) {
            all.push(at(shift, first.reduction.as_ref())?);
        }
        all.insert(unmoved, first);
        Ok(all)
    }
}

/// What a protocol calls by name must be in every campaign.
fn members(plan: &Plan, campaigns: Campaigns<'_>, problems: &mut Problems) {
    for (number, campaign) in campaigns.iter().enumerate() {
        let of = campaigns.name_of(number).map_or_else(String::new, |name| format!(" {name}"));
        for record in &plan.records {
            let kind = record.side.kind();
            let all = campaign.records(kind);
            let names: Vec<&str> = all
                .iter()
                .filter_map(|which| campaign.record_called(*which).map(AsRef::as_ref))
                .collect();
            for member in
                record.members.iter().filter(|member| !names.contains(&member.value.as_str()))
            {
                let says = format!("the campaign{of} has no {} `{}`", kind.key(), member.value);
                let problem = Problem::error("unknown-record", says)
                    .at(&member.span)
                    .suggest(&member.value, names.iter().copied());
                let named = campaign.tree.get(kind.key()).map(|node| node.span.clone());
                let problem = named
                    .map_or(problem.clone(), |at| problem.also(&at, "the records of the campaign"));
                problems.push(match (&problem.help, names.is_empty()) {
                    (Some(_), _) => problem,
                    (None, true) => problem.help(format!(
                        "give its records names in campaign.yaml: `{}: {{{}: folder}}`",
                        kind.key(),
                        member.value
                    )),
                    (None, false) => problem.help(format!("there is {}", names.join(", "))),
                });
            }
        }
    }
}

/// Ends the run at a fault in one section, where the protocol states `stop`. The problems of the
/// records give the place.
fn stop_on_fault(plan: &Plan, units: &[Unit], values: &[SectionValues]) -> Result<(), Problems> {
    if plan.sections.faulty != OnFault::Stop {
        return Ok(());
    }
    let mut problems = Problems::default();
    for (index, unit) in units.iter().enumerate().filter(|(_, unit)| unit.faulty) {
        let told = values.get(index).map_or(&[][..], |values| &values.problems);
        for problem in told {
            problems.push(problem.clone());
        }
        let why = unit
            .fault
            .as_ref()
            .filter(|_| told.is_empty())
            .map_or(String::new(), |fault| format!(": {fault}"));
        let says = format!(
            "section {} is faulty, and the protocol states `stop` for faulty sections{why}",
            unit.name
        );
        let problem = Problem::error("faulty-section", says);
        problems.push(match &unit.span {
            Some(span) => problem.at(span),
            None => problem,
        });
    }
    if problems.any_error() { Err(problems) } else { Ok(()) }
}

/// Used if every section is faulty: the problems of the records are more useful than a report
/// without numbers.
fn nothing_usable(units: &[Unit], values: Vec<SectionValues>) -> Problems {
    const MOST: usize = 8;
    // A problem that occurs in several sections is shown once, with the number of occurrences.
    let mut told: IndexMap<(&str, String), (Problem, usize)> = IndexMap::new();
    for (unit, values) in units.iter().zip(values) {
        let mut problems = values.problems;
        if problems.is_empty() {
            let says = format!("section {}: {}", unit.name, unit.fault.clone().unwrap_or_default());
            let problem = Problem::error("section-not-usable", says);
            problems.push(match &unit.span {
                Some(span) => problem.at(span),
                None => problem,
            });
        }
        for problem in problems {
            let key = (problem.code, problem.says.replace(&unit.name, ""));
            told.entry(key).and_modify(|(_, more)| *more += 1).or_insert((problem, 0));
        }
    }
    let left_out = told.len().saturating_sub(MOST);
    let mut all = Problems::default();
    for (problem, more) in told.into_values().take(MOST) {
        let says = if more == 0 {
            problem.says
        } else {
            format!("{}; the same {more} times more", problem.says)
        };
        all.push(Problem { says, ..problem });
    }
    let end = Problem::error("no-usable-section", "no section of the campaign can be used");
    all.push(if left_out == 0 {
        end
    } else {
        end.help(format!("{left_out} more problems are not shown"))
    });
    all
}
