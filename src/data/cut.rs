//! A copy of a campaign in which each section has records of its own, cut from the runs.

use std::collections::BTreeMap;

use super::campaign::{CAMPAIGN_FILE, Part, RUN_COLUMN, RUNS, Run};
use super::hash::sha256;
use super::origin::{ORIGIN_FILE, ORIGIN_KEY};
use super::record::{Format, Record, Wanted};
use super::table::{Cell, Table};
use super::text::read_any;
use super::write::{
    Entry, FileColumn, Outputs, Values, campaign_yaml_with, csv, parquet, table_csv,
};
use super::{Campaign, RecordKind};
use crate::problem::Problem;
use crate::source::Spanned;
use crate::units::Dimension;
use crate::units::number::significant;
use crate::yaml::{Node, Value};

/// The key of `campaign.yaml` that names the table of cut records.
const KEY: &str = "records_cut";
/// That table: each record with the run and its file, and the hash of that file.
const TABLE: &str = "cut.csv";
/// The table of sections.
const SECTIONS: &str = "sections.csv";
/// Significant digits of the numbers: those that a run has are kept, and the rounding of units is
/// not.
const DIGITS: usize = 12;

/// Adds all files of the copy to the outputs; gives the number of records.
///
/// # Errors
/// `no-runs`; of reading a run; `no-sections`, `unknown-run`: a section is not part of a run; of
/// writing.
pub fn cut(
    campaign: &Campaign,
    format: Format,
    outputs: &mut Outputs,
) -> Result<usize, Vec<Problem>> {
    if campaign.runs().is_empty() {
        let problem = Problem::error("no-runs", "the campaign has no runs to cut sections from")
            .at(&campaign.tree.span.part(0..0));
        return Err(vec![problem.help("each of its sections has records of its own already")]);
    }
    let Some(table) = &campaign.sections else {
        let problem = Problem::error(
            "no-sections",
            "the campaign has no table of sections, and none were looked for",
        );
        return Err(vec![
            problem
                .at(&campaign.runs_span())
                .help("name a protocol with `use found sections`, or a table with a column `run`"),
        ]);
    };
    let mut rows = vec![
        ["record", "sha256", "run", "cut from", "sha256 of that file"].map(str::to_string).to_vec(),
    ];
    let mut kinds = BTreeMap::new();
    for name in &campaign.names {
        let Some(run) = campaign.run_of(name) else {
            let says = format!("section `{}` is not part of a run", name.value);
            return Err(vec![
                Problem::error("unknown-run", says)
                    .at(&name.span)
                    .help(format!("name the run in the column `{RUN_COLUMN}`")),
            ]);
        };
        for kind in RecordKind::ALL.into_iter().filter(|kind| run.has(*kind)) {
            let (record, from) = stretch(campaign, table, run, kind, name)?;
            let inside = format!("{}/{}.{}", kind.key(), name.value, format.ending());
            let bytes = bytes(&record, format)?;
            outputs.add(&inside, &bytes)?;
            rows.push(vec![
                inside,
                sha256(&bytes),
                run.name.value.clone(),
                from,
                record.sha256.clone(),
            ]);
            kinds.insert(kind.key(), ());
        }
    }
    let records = rows.len() - 1;
    rest(campaign, table, kinds.keys().copied().collect(), outputs)?;
    outputs.add(TABLE, table_csv(&rows).as_bytes())?;
    Ok(records)
}

/// All channels of a section with what is beside it, and the file that they are from.
fn stretch(
    campaign: &Campaign,
    table: &Table,
    run: &Run,
    kind: RecordKind,
    name: &Cell,
) -> Result<(Record, String), Vec<Problem>> {
    let source = campaign.run_source(run, kind)?;
    let (axis, start, end) = extent(table, name)?;
    let moved = match kind {
        RecordKind::Measurement => campaign.offset(name)?.map_or(0.0, |(_, offset)| offset),
        RecordKind::Simulation | RecordKind::Track => 0.0,
    };
    // As much as the evaluation of a section in a run reads.
    let Part { from, to, .. } = Part::around(axis, (start, end), None);
    let headings = source.headings()?;
    let wanted = Wanted::all(&headings);
    let range = from - moved..to - moved;
    let record = source.stretch(&wanted, axis, range, run.known(kind))?;
    Ok((record, source.inside().to_string()))
}

/// The axis of a section, its start and its end.
fn extent(table: &Table, name: &Cell) -> Result<(&'static str, f64, f64), Vec<Problem>> {
    let number = |column: &str| -> Result<(Dimension, f64), Vec<Problem>> {
        let column = table.need_column(column)?;
        let dimension = table.columns[column].unit(None)?.dimension;
        let row = table.row_named(&name.value).unwrap_or(0);
        let value = table.numbers(column, Some(dimension))?.get(row).copied().flatten();
        value.map(|value| (dimension, value)).ok_or_else(|| {
            let says = format!("section `{}` has no start or no end", name.value);
            vec![Problem::error("not-a-number", says).at(&name.span)]
        })
    };
    let ((dimension, start), (_, end)) = (number("start")?, number("end")?);
    let axis = if dimension == Dimension::TIME { "time" } else { "distance" };
    Ok((axis, start, end))
}

fn bytes(record: &Record, format: Format) -> Result<Vec<u8>, Problem> {
    let columns = record.columns.iter().map(|column| FileColumn {
        heading: format!("{} [{}]", column.name, column.unit),
        values: Values::Numbers(
            column
                .values
                .iter()
                .map(|value| significant(column.unit.from_si(*value), DIGITS))
                .collect(),
        ),
        digits: None,
    });
    let columns: Vec<FileColumn> = columns.collect();
    match format {
        Format::Csv => Ok(csv(&columns)),
        Format::Parquet => parquet(&columns),
    }
}

/// The files of the copy but its records.
fn rest(
    campaign: &Campaign,
    table: &Table,
    kinds: Vec<&str>,
    outputs: &mut Outputs,
) -> Result<(), Problem> {
    let at = campaign.tree.span.part(0..0);
    let named = campaign
        .tree
        .get("sections")
        .and_then(Node::scalar_text)
        .map(|written| written.trim().to_string());
    let table_inside = named
        .map(|named| campaign.place(&Spanned::new(named, at.clone())))
        .transpose()?
        .map(|place| place.inside);
    for inside in campaign.plain_files()? {
        if inside != CAMPAIGN_FILE
            && inside != TABLE
            && Some(&inside) != table_inside.as_ref()
            && inside != SECTIONS
        {
            let place = campaign.place(&Spanned::new(inside.clone(), at.clone()))?;
            outputs.add(&inside, &read_any(&place.path, &place.shown)?)?;
        }
    }
    outputs.add(SECTIONS, with_facts(campaign, table).as_bytes())?;
    let mut entries = vec![("sections", Entry::Text(SECTIONS))];
    entries.extend(kinds.iter().map(|kind| (*kind, Entry::Text(kind))));
    if let Some(node) = campaign.tree.get(ORIGIN_KEY) {
        entries.push((
            ORIGIN_KEY,
            if matches!(node.value, Value::Map(_)) {
                Entry::Node(node)
            } else {
                Entry::Text(ORIGIN_FILE)
            },
        ));
    }
    entries.push((KEY, Entry::Text(TABLE)));
    let without = [KEY, ORIGIN_KEY, RUNS, "sections"];
    let text = campaign_yaml_with(&campaign.tree, &without, &entries);
    outputs.add(CAMPAIGN_FILE, text.as_bytes())
}

/// The table of sections with what the campaign says of each run, without the run.
fn with_facts(campaign: &Campaign, table: &Table) -> String {
    let mut facts: Vec<(&str, Option<&str>)> = Vec::new();
    for fact in campaign.runs().iter().flat_map(|run| &run.facts) {
        let new =
            table.column(&fact.name).is_none() && facts.iter().all(|(name, _)| *name != fact.name);
        facts.extend(new.then_some((fact.name.as_str(), fact.unit.as_deref())));
    }
    let keep = |column: &usize| table.columns[*column].name != RUN_COLUMN;
    let heading = |column: usize| table.columns[column].span.text().trim_matches('"').to_string();
    let of_fact = |(name, unit): &(&str, Option<&str>)| {
        unit.map_or_else(|| (*name).to_string(), |unit| format!("{name} [{unit}]"))
    };
    let columns: Vec<usize> = (0..table.columns.len()).filter(keep).collect();
    let mut rows = vec![
        columns
            .iter()
            .map(|&column| heading(column))
            .chain(facts.iter().map(of_fact))
            .collect::<Vec<_>>(),
    ];
    for (row, name) in campaign.names.iter().enumerate() {
        let cells = columns.iter().map(|&column| {
            table.cell(row, column).map_or_else(String::new, |cell| cell.value.clone())
        });
        let run = campaign.run_of(name);
        let of_run = facts.iter().map(|(fact, _)| {
            run.and_then(|run| run.fact(fact))
                .map_or_else(String::new, |fact| fact.value.value.clone())
        });
        rows.push(cells.chain(of_run).collect());
    }
    table_csv(&rows)
}
