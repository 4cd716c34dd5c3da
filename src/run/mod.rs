//! Runs a graph over a campaign: records in parallel, one at a time per worker, to plain results.

mod domain;
mod facts;
mod judge;
mod limits;
mod pairs;
mod record;
mod requirements;
mod sections;
mod signal;
mod traces;

use rayon::prelude::*;

use crate::check::plan::{OnFault, Plan};
use crate::data::Campaign;
use crate::graph::Graph;
use crate::problem::{Problem, Problems};
use crate::result::{DataItem, FileHash, QuantityResult, SectionResult, Trace, Verdict, ZoneResult};

pub use facts::Facts;
use pairs::SectionValues;
use sections::Unit;

/// What a run computed; the report adds what the protocol and the campaign say about themselves.
#[derive(Debug)]
pub struct Outcome {
    pub verdict: Verdict,
    pub reasons: Vec<String>,
    pub quantities: Vec<QuantityResult>,
    pub sections: Vec<SectionResult>,
    pub zones: Vec<ZoneResult>,
    pub domain: Vec<crate::result::DomainRange>,
    pub traces: Vec<Trace>,
    /// The vehicle data that the protocol reads.
    pub vehicle: Vec<DataItem>,
    pub notes: Vec<String>,
    /// Records in the order of the sections.
    pub files: Vec<FileHash>,
}

/// How a run is done, beside what the protocol says.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// How many sections' traces to keep for plots.
    pub traces: usize,
}

/// Told whenever a record is done, from any thread.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

/// Runs the whole protocol.
///
/// # Errors
/// What makes the campaign unusable as a whole: vehicle data missing, no usable section, or a fault where the protocol says to stop.
pub fn run(plan: &Plan, graph: &Graph, campaign: &Campaign, settings: Settings, progress: Progress<'_>) -> Result<Outcome, Problems> {
    let mut problems = Problems::default();
    let facts = Facts::read(plan, campaign, &mut problems);
    let mut units = sections::units(plan, campaign, &mut problems);
    if problems.any_error() {
        return Err(problems);
    }
    let mut notes = Vec::new();
    let present = record::present_columns(graph, campaign, &facts, &units, &mut notes);
    requirements::check_data(plan, &facts, &mut units);
    stop_on_fault(plan, &units, &[])?;
    let work = record::Work { plan, graph, campaign, facts: &facts, present: &present };
    let values: Vec<SectionValues> = units
        .par_iter()
        // Sections differ in length: shared out one by one, no worker is left with several while another has none.
        .with_max_len(1)
        .map(|unit| {
            let values = if unit.fault.is_some() { SectionValues::default() } else { pairs::of_section(&work, unit) };
            progress(&unit.name);
            values
        })
        .collect();
    requirements::take_over(plan, &mut units, &values, &mut notes)?;
    stop_on_fault(plan, &units, &values)?;
    if units.iter().all(|unit| unit.fault.is_some()) {
        return Err(nothing_usable(&units, values));
    }
    let judged = judge::judge(plan, &facts, &units, &values);
    let traces = traces::traces(&work, &units, &judged.quantities, settings.traces);
    let files = values.iter().flat_map(|values| values.files.iter().cloned()).collect();
    let domain = domain::domain(plan, &units);
    Ok(Outcome {
        verdict: judged.verdict,
        reasons: judged.reasons,
        quantities: judged.quantities,
        zones: judged.zones,
        sections: sections::results(plan, units),
        domain,
        traces,
        vehicle: plan.vehicle.iter().zip(&facts.vehicle).map(|(datum, value)| facts::item(datum, Some(value))).collect(),
        notes,
        files,
    })
}

/// A protocol may say that a fault in one section ends the run. The problems of its records say where it is.
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
        let why = unit.fault.as_ref().filter(|_| told.is_empty()).map_or(String::new(), |fault| format!(": {fault}"));
        let says = format!("section {} is faulty, and the protocol says to stop then{why}", unit.name);
        let problem = Problem::error("faulty-section", says);
        problems.push(match &unit.span {
            Some(span) => problem.at(span),
            None => problem,
        });
    }
    if problems.any_error() { Err(problems) } else { Ok(()) }
}

/// Every section is faulty: the problems of their records say more than a report without numbers would.
fn nothing_usable(units: &[Unit], values: Vec<SectionValues>) -> Problems {
    const MOST: usize = 8;
    let mut problems = Problems::default();
    for problem in values.into_iter().flat_map(|values| values.problems).take(MOST) {
        problems.push(problem);
    }
    let told = problems.0.len();
    for unit in units.iter().filter(|unit| unit.fault.is_some()).take(MOST - told.min(MOST)) {
        let problem = Problem::error("section-not-usable", format!("section {}: {}", unit.name, unit.fault.clone().unwrap_or_default()));
        if told == 0 || !unit.faulty {
            problems.push(match &unit.span {
                Some(span) => problem.at(span),
                None => problem,
            });
        }
    }
    problems.push(
        Problem::error("no-usable-section", "no section of the campaign can be used")
            .help("the problems above say why, section by section"),
    );
    problems
}
