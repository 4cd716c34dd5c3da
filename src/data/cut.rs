//! A copy of a campaign in which each section has records of its own, cut from the runs.

use super::{
    Campaign, RecordKind,
    campaign::{CAMPAIGN_FILE, RUN_COLUMN, RUNS, Run, RunStretch},
    hash::sha256,
    origin::{ORIGIN_FILE, ORIGIN_KEY},
    record::{Column, Format, Record, Wanted},
    table::{Cell, Table},
    write::{Entry, FileColumn, Outputs, Values, campaign_yaml_with, in_format, table_csv},
};
use crate::data::prelude::*;
use crate::units::number::significant;

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
        let problem = error(
            "no-runs",
            "the campaign has no runs to cut sections from",
            &campaign.tree.start(),
        );
        return Err(problem.help("each of its sections has records of its own already").into());
    }
    let Some(table) = &campaign.sections else {
        let help = "name a protocol with `use found sections`, or a table with a column `run`";
        return Err(error(
            "no-sections",
            "the campaign has no table of sections, and none were looked for",
            &campaign.runs_span(),
        )
        .help(help)
        .into());
    };
    let header = ["record", "sha256", "run", "cut from", "sha256 of that file"];
    let mut rows = vec![header.map(str::to_string)];
    let mut kinds: Vec<&str> = Vec::new();
    for name in &campaign.names {
        let Some(run) = campaign.run_of(name) else {
            let help = format!("name the run in the column `{RUN_COLUMN}`");
            return Err(problem!(
                "unknown-run",
                &name.span,
                "section `{}` is not part of a run",
                name.value
            )
            .help(help)
            .into());
        };
        for kind in RecordKind::ALL.into_iter().filter(|kind| run.has(*kind)) {
            let (record, from) = stretch(campaign, table, run, kind, name)?;
            let inside = format!("{}/{}", kind.key(), format.file(&name.value));
            let columns: Vec<FileColumn> = record.columns.iter().map(column).collect();
            let bytes = in_format(format, &columns)?;
            outputs.add(&inside, &bytes)?;
            rows.push([inside, sha256(&bytes), run.name.value.clone(), from, record.sha256]);
            kinds.push(kind.key());
        }
    }
    kinds.sort_unstable();
    kinds.dedup();
    rest(campaign, table, &kinds, outputs)?;
    outputs.add(TABLE, table_csv(&rows).as_bytes())?;
    Ok(rows.len() - 1)
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
    let moved = campaign.offset_of(kind, name)?.map_or(0.0, |(_, offset)| offset);
    // As much as the evaluation of a section in a run reads.
    let RunStretch { from, to, .. } = RunStretch::around(axis, (start, end), None);
    let wanted = Wanted::all(&source.headings()?);
    let record = source.stretch(&wanted, axis, from - moved..to - moved, run.known(kind))?;
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
            vec![problem!(
                "not-a-number",
                &name.span,
                "section `{}` has no start or no end",
                name.value
            )]
        })
    };
    let ((dimension, start), (_, end)) = (number("start")?, number("end")?);
    let axis = if dimension == Dimension::TIME { "time" } else { "distance" };
    Ok((axis, start, end))
}

/// A column as it is written.
fn column(Column { name, unit, values, .. }: &Column) -> FileColumn {
    let rounded = values.iter().map(|value| significant(unit.from_si(*value), DIGITS));
    let values = Values::Numbers(rounded.collect());
    FileColumn { heading: format!("{name} [{unit}]"), values, digits: None }
}

/// The files of the copy but its records.
fn rest(
    campaign: &Campaign,
    table: &Table,
    kinds: &[&str],
    outputs: &mut Outputs,
) -> Result<(), Problem> {
    let named = campaign.tree.get("sections").and_then(Node::scalar_text);
    let named = named.map(|named| campaign.inner(named.trim())).transpose()?;
    let named = named.map(|place| place.inside);
    for (inside, bytes) in campaign.plain_files()? {
        let made = [CAMPAIGN_FILE, TABLE, SECTIONS].contains(&inside.as_str());
        if inside == ORIGIN_FILE {
            outputs.add(&inside, origin_of_parts(&bytes).as_bytes())?;
        } else if !made && Some(&inside) != named.as_ref() {
            outputs.add(&inside, &bytes)?;
        }
    }
    outputs.add(SECTIONS, with_facts(campaign, table).as_bytes())?;
    let mut entries = vec![("sections", Entry::Text(SECTIONS))];
    entries.extend(kinds.iter().map(|kind| (*kind, Entry::Text(kind))));
    if let Some(node) = campaign.tree.get(ORIGIN_KEY) {
        let inline = matches!(node.value, Value::Map(_));
        let entry = if inline { Entry::Node(node) } else { Entry::Text(ORIGIN_FILE) };
        entries.push((ORIGIN_KEY, entry));
    }
    entries.push((KEY, Entry::Text(TABLE)));
    let without = [KEY, ORIGIN_KEY, RUNS, "sections"];
    let text = campaign_yaml_with(&campaign.tree, &without, &entries);
    outputs.add(CAMPAIGN_FILE, text.as_bytes())
}

/// The origin without the paths and hashes of whole records, which are not in the copy.
fn origin_of_parts(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let Ok(mut origin) = serde_yaml::from_str::<serde_yaml::Value>(&text) else { return text };
    let Some(records) = origin.get_mut("records").and_then(serde_yaml::Value::as_sequence_mut)
    else {
        return text;
    };
    for record in records.iter_mut().filter_map(serde_yaml::Value::as_mapping_mut) {
        ["path", "sha256"].into_iter().for_each(|key| drop(record.remove(key)));
    }
    serde_yaml::to_string(&origin).unwrap_or(text)
}

/// The table of sections with what the campaign says of each run, without the run.
fn with_facts(campaign: &Campaign, table: &Table) -> String {
    let mut facts: Vec<(&str, Option<&str>)> = Vec::new();
    for fact in campaign.runs().iter().flat_map(|run| &run.facts) {
        if table.column(&fact.name).is_none() && facts.iter().all(|(name, _)| *name != fact.name) {
            facts.push((&fact.name, fact.unit.as_deref()));
        }
    }
    let keep = |column: &usize| table.columns[*column].name != RUN_COLUMN;
    let columns: Vec<usize> = (0..table.columns.len()).filter(keep).collect();
    let heading = |column: &usize| table.columns[*column].span.text().trim_matches('"').to_string();
    let of_fact = |(name, unit): &(&str, Option<&str>)| {
        unit.map_or_else(|| (*name).to_string(), |unit| format!("{name} [{unit}]"))
    };
    let header: Vec<String> =
        columns.iter().map(heading).chain(facts.iter().map(of_fact)).collect();
    let mut rows = vec![header];
    for (row, name) in campaign.names.iter().enumerate() {
        let cell = |column: &usize| Some(table.cell(row, *column)?.value.clone());
        let run = campaign.run_of(name);
        let of_run = |(fact, _): &(&str, _)| Some(run?.fact(fact)?.value.value.clone());
        let cells = columns.iter().map(cell).chain(facts.iter().map(of_run));
        rows.push(cells.map(Option::unwrap_or_default).collect());
    }
    table_csv(&rows)
}
