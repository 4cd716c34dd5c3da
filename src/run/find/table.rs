//! Found sections as a table of sections: the same columns as one that is written by hand, and the
//! run.

use super::place::{Candidate, is_stated};
use crate::data::{
    campaign::{OFFSET, RUN_COLUMN, Run},
    table::Table,
    write::table_csv,
};
use crate::problem::nearest;
use crate::run::{
    prelude::*,
    sections::{computed_of_runs, of_run, trimmed},
};

/// What the table of found sections is called in messages: it is in no file.
const NAME: &str = "found sections";
/// Data of a run that say on which line it was: sections of the same line at the same place are of
/// one site.
const LINE: &str = "line";

/// Section data that are neither found nor have a default must be stated of every run, and what is
/// stated must be possible.
///
/// Problems: `missing-run-data`, `wrong-run-data`, `computed-column`.
pub fn check_facts(plan: &Plan, find: &Find, campaign: &Campaign, problems: &mut Problems) {
    computed_of_runs(plan, campaign, problems);
    let stated = || {
        (0..plan.columns.len())
            .filter(|&index| is_stated(plan, find, index))
            .map(|index| &plan.columns[index])
    };
    for datum in stated() {
        for run in campaign.runs() {
            let Some(fact) = run.fact(&datum.key) else { continue };
            if let Err(reason) = of_run(datum, run, &campaign.short_name.value) {
                problems.push(
                    Problem::error("wrong-run-data", reason.text())
                        .at(&fact.value.span)
                        .also(&datum.span, "what the protocol knows"),
                );
            }
        }
    }
    for datum in stated().filter(|datum| datum.default.is_none()) {
        for run in campaign.runs().iter().filter(|run| run.fact(&datum.key).is_none()) {
            let says = format!(
                "`{}` of the sections of run `{}` is neither found nor stated",
                datum.key, run.name.value
            );
            let problem = Problem::error("missing-run-data", says)
                .at(&run.name.span)
                .also(&datum.span, "the protocol needs it");
            let slip = nearest(&datum.key, run.facts.iter().map(|fact| fact.name.as_str()));
            problems.push(problem.help(match slip {
                Some(slip) => format!("the run states `{slip}`: if `{0}` is meant, write `{0}`", datum.key),
                None => format!("state it of the run in campaign.yaml, or write how it is found: `found ...` in `section {}`", datum.name),
            }));
        }
    }
}

/// `offsets` is what is added to the axis of each section's measurement, SI.
///
/// # Errors
/// Those of a table that is read.
pub fn table(
    plan: &Plan,
    places: &[(&Run, Candidate)],
    offsets: Option<&[f64]>,
) -> Result<Table, Problem> {
    let axis = &plan.axis.unit;
    let columns: Vec<usize> =
        (0..plan.columns.len()).filter(|index| plan.columns[*index].is_stated()).collect();
    let of_line = places.iter().any(|(run, _)| run.fact(LINE).is_some())
        && plan.columns.iter().all(|datum| datum.key != "track");
    let heading = |datum: &Datum, zone: bool| match &datum.kind {
        DatumKind::Number(unit) => format!("{} [{}]", datum.key, unit.text),
        _ if zone => format!("{} [-]", datum.key),
        _ => datum.key.clone(),
    };
    let mut rows = vec![vec![
        "section".to_string(),
        RUN_COLUMN.to_string(),
        format!("start [{axis}]"),
        format!("end [{axis}]"),
    ]];
    rows[0].extend(of_line.then(|| "track".to_string()));
    rows[0].extend(
        columns
            .iter()
            .map(|&index| heading(&plan.columns[index], plan.sections.zone == Some(index))),
    );
    rows[0].extend(offsets.map(|_| format!("{OFFSET} [{axis}]")));
    let digits = places.len().to_string().len().max(2);
    for (number, (run, place)) in places.iter().enumerate() {
        let mut row = vec![format!("S{:0digits$}", number + 1), run.name.value.clone()];
        row.extend([place.start, place.end].map(|x| trimmed(axis.from_si(x))));
        row.extend(of_line.then(|| {
            run.fact(LINE).map_or(run.name.value.clone(), |fact| fact.value.value.clone())
        }));
        row.extend(columns.iter().map(|&index| cell(&plan.columns[index], &place.columns[index])));
        // To a thousandth: an estimate is not better than a tenth of the distance between samples.
        row.extend(offsets.map(|offsets| format!("{:.3}", axis.from_si(offsets[number]))));
        rows.push(row);
    }
    Table::of_text(NAME, &table_csv(&rows))
}

fn cell(datum: &Datum, value: &Result<Scalar, Reason>) -> String {
    match (value, &datum.kind) {
        (Ok(Scalar::Number(value)), DatumKind::Number(unit)) => trimmed(unit.from_si(*value)),
        (Ok(Scalar::Number(value)), _) => trimmed(*value),
        (Ok(Scalar::Word(word)), _) => word.clone(),
        (Ok(Scalar::Flag(flag)), _) => flag.to_string(),
        // As an empty cell of a table: a missing value.
        (Err(_), _) => String::new(),
    }
}
