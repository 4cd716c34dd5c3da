//! Traces one number of a report to the line of its rule and to the rows of its data.

use std::{fmt::Write, path::PathBuf};

use super::carried::Carried;
use crate::certify::Compiled;
use crate::data::Campaigns;
use crate::graph::{Node, Operation};
use crate::problem::{Problem, Problems, problem};
use crate::report::number::significant;
use crate::result::{FileHash, PairValue, QuantityResult, RecordName, RulePlace, StatisticResult};
use crate::run::{
    find, replay,
    single::{Side, single},
};
use crate::source::Span;
use crate::terminal::Lines;
use crate::units::Unit;

/// Identification of the number.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    pub quantity: &'a str,
    pub section: &'a str,
    pub signal: &'a str,
    /// Where the campaign has several: `simpack`, `simpack, run1`.
    pub record: Option<&'a str>,
}

/// The result in words, and whether the campaign still gives the values of the report.
#[derive(Debug)]
pub struct Traced {
    pub text: Lines,
    pub agrees: bool,
}

/// Traces one value of a report to its sources.
///
/// With a campaign, its rows and values are read and computed again.
///
/// # Errors
/// `no-such-quantity`, `no-such-section`, `no-such-signal`, `not-evaluated`; problems of the
/// campaign.
pub fn trace(
    carried: &Carried,
    compiled: Option<&Compiled>,
    asked: Asked<'_>,
    campaigns: &[PathBuf],
) -> Result<Traced, Problems> {
    let (quantity, pair) = find(carried, asked)?;
    let index = compiled.and_then(|compiled| {
        let index = compiled.plan.quantities.iter().position(|known| known.id == quantity.id)?;
        let signal = compiled.plan.quantities[index]
            .positions
            .iter()
            .position(|position| position.name == pair.signal)?;
        Some((index, signal))
    });
    let again = match (compiled, index) {
        (Some(compiled), Some(index)) if !campaigns.is_empty() => {
            let mut opened = super::verify::open(carried, campaigns)?;
            let (plan, graph) = (&compiled.plan, &compiled.graph);
            find::in_all(plan, graph, &mut opened)?;
            Some(single(
                plan,
                graph,
                Campaigns::from(&opened),
                index,
                (asked.section, pair.record.as_ref()),
            )?)
        }
        _ => None,
    };
    let mut out = head(quantity, pair);
    if let Some((compiled, index)) = compiled.zip(index) {
        rule(&mut out, compiled, quantity, index.0);
        operations(&mut out, carried, compiled, index, asked.section).map_err(|says| {
            problem!("not-evaluated", "the result does not match its protocol: {says}")
        })?;
    } else {
        out += "\n";
        let _ = writeln!(
            out,
            "The protocol is not available: give report.pdf, which contains it, or name it with `--protocol`."
        );
    }
    let mut agrees = true;
    let read = |file: &FileHash| {
        again
            .as_ref()
            .is_some_and(|again| again.records.iter().any(|side| side.file.path == file.path))
    };
    let within = compiled.zip(index).and_then(|(compiled, index)| {
        compiled.plan.quantities[index.0].evaluation.pairing()?.within()
    });
    // A run is the record of many sections: it stands once.
    let mut files: Vec<&FileHash> = Vec::new();
    for file in records(carried, pair, within.map(|side| side.kind().key()), &read) {
        if files.iter().all(|known| known.path != file.path) {
            files.push(file);
        }
    }
    for file in &files {
        let side = again
            .as_ref()
            .and_then(|again| again.records.iter().find(|side| side.file.path == file.path));
        agrees &= record(&mut out, file, pair, side, compiled.zip(index));
    }
    if let Some(again) = &again {
        agrees &=
            again.records.iter().all(|side| files.iter().any(|file| file.path == side.file.path));
        agrees &= near(again.difference, pair.difference);
        let same = if near(again.difference, pair.difference) {
            "as in the report"
        } else {
            "NOT as in the report"
        };
        out += "\n";
        let _ =
            writeln!(out, "computed again: {}{}, {same}", again.difference, suffix(&quantity.unit));
    }
    statistics(&mut out, carried, quantity, pair);
    Ok(Traced { text: out, agrees })
}

/// Equality up to rounding; see [`super::compare`].
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= (super::compare::SHARE * a.abs().max(b.abs())).max(super::compare::NEAR)
}

fn find<'a>(
    carried: &'a Carried,
    asked: Asked<'_>,
) -> Result<(&'a QuantityResult, &'a PairValue), Problem> {
    let results = &carried.results;
    let quantity = results
        .quantities
        .iter()
        .find(|quantity| quantity.id == asked.quantity)
        .ok_or_else(|| {
            Problem::error(
                "no-such-quantity",
                format!("the report has no quantity `{}`", asked.quantity),
            )
            .suggest(asked.quantity, results.quantities.iter().map(|quantity| quantity.id.as_str()))
        })?;
    let section = results
        .sections
        .iter()
        .find(|section| section.section == asked.section)
        .ok_or_else(|| {
            Problem::error(
                "no-such-section",
                format!("the report has no section `{}`", asked.section),
            )
            .suggest(asked.section, results.sections.iter().map(|section| section.section.as_str()))
        })?;
    if let Some(reason) = section.reason.as_ref().filter(|_| !section.used) {
        return Err(Problem::error(
            "not-evaluated",
            format!("section {} is not used: {}", section.section, reason.text()),
        ));
    }
    let here: Vec<&PairValue> =
        quantity.values.iter().filter(|pair| pair.section == asked.section).collect();
    let of_signal: Vec<&PairValue> =
        here.iter().filter(|pair| pair.signal == asked.signal).copied().collect();
    if of_signal.is_empty() {
        let says = format!(
            "{} has no value of `{}` in section {}",
            quantity.id, asked.signal, asked.section
        );
        return Err(Problem::error("no-such-signal", says)
            .suggest(asked.signal, here.iter().map(|pair| pair.signal.as_str())));
    }
    let name = |pair: &PairValue| pair.record.as_ref().map(ToString::to_string);
    let names: Vec<String> = of_signal.iter().filter_map(|pair| name(pair)).collect();
    let found = match asked.record {
        Some(record) => of_signal.iter().find(|pair| name(pair).as_deref() == Some(record)),
        None if names.len() > 1 => {
            let says = format!("{} has {} records of this section", quantity.id, names.len());
            let help = format!("name one with `--record`: {}", names.join("; "));
            return Err(Problem::error("several-records", says).help(help));
        }
        None => of_signal.first(),
    };
    found.map(|pair| (quantity, *pair)).ok_or_else(|| {
        let record = asked.record.unwrap_or_default();
        let says = format!("{} has no record `{record}` in section {}", quantity.id, asked.section);
        Problem::error("no-such-record", says).suggest(record, names.iter().map(String::as_str))
    })
}

fn suffix(unit: &str) -> String {
    if unit == "-" { String::new() } else { format!(" {unit}") }
}

fn head(quantity: &QuantityResult, pair: &PairValue) -> Lines {
    let unit = suffix(&quantity.unit);
    let zone = pair.zone.as_ref().map_or_else(String::new, |zone| format!(" (zone {zone})"));
    let record =
        pair.record.as_ref().map_or_else(String::new, |record| format!(", record {record}"));
    let mut out = Lines::default();
    let _ = writeln!(out, "{}: {}", quantity.id, quantity.title);
    let _ = writeln!(out, "section {}{zone}, signal {}{record}", pair.section, pair.signal);
    out += "\n";
    for (name, value) in [("simulated", pair.simulated), ("measured", pair.measured)] {
        if let Some(value) = value {
            let _ = writeln!(out, "  {name:<11}{value}{unit}");
        }
    }
    let name = if pair.simulated.is_some() { "difference" } else { "value" };
    let _ = writeln!(out, "  {name:<11}{}{unit}", pair.difference);
    let _ = writeln!(out, "  samples    {} of the measured signal", pair.samples);
    out
}

/// `annex-t.fp:345`: the file without its folder.
fn place(span: &Span) -> String {
    format!("{}:{}", span.source.file_name(), span.line())
}

fn said(place: &RulePlace) -> String {
    format!("  ({}:{})", place.file, place.line)
}

fn rule(out: &mut Lines, compiled: &Compiled, quantity: &QuantityResult, index: usize) {
    let plan = &compiled.plan.quantities[index];
    *out += "\n";
    let _ = writeln!(out, "rule{}", said(&quantity.rule));
    let rows = [
        ("of", &plan.words.of),
        ("filter", &plan.words.filter),
        ("value", &plan.words.processing),
        ("compared", &plan.words.comparison),
    ];
    for (name, words) in rows {
        let _ = writeln!(out, "  {name:<11}{words}");
    }
    if let Some(source) = &plan.source {
        let _ = writeln!(out, "  {:<11}{source}", "source");
    }
}

fn operations(
    out: &mut Lines,
    carried: &Carried,
    compiled: &Compiled,
    index: (usize, usize),
    section: &str,
) -> Result<(), String> {
    let results = &carried.results;
    let nodes = replay::operations(&compiled.plan, &compiled.graph, results, index, section)?;
    let node = |id: &usize| &compiled.graph.nodes[*id];
    let width =
        nodes.iter().map(|id| node(id).label.text.chars().count()).max().unwrap_or(0).min(60);
    *out += "\n";
    let _ = writeln!(out, "operations in order, each with the first rule that requires it");
    for id in &nodes {
        let Node { operation, label, from, .. } = node(id);
        let _ = writeln!(
            out,
            "  {:<8} {:<width$}  ({})",
            operation.stage().in_words(),
            label.text,
            place(from)
        );
    }
    let columns = nodes.iter().filter_map(|id| match &node(id).operation {
        Operation::Read { column } => Some(column.as_str()),
        _ => None,
    });
    let axis = [Some(&compiled.plan.axis), compiled.plan.time.as_ref()]
        .into_iter()
        .flatten()
        .map(|axis| axis.column.as_str());
    let columns: Vec<&str> = axis.chain(columns).collect();
    *out += "\n";
    let _ = writeln!(out, "columns read: {}", columns.join(", "));
    if let Some(section) = carried.results.sections.iter().find(|known| known.section == section) {
        let (unit, axis) = (suffix(&section.axis_unit), &compiled.plan.axis.column);
        let _ = writeln!(out, "evaluated: {axis} {} to {}{unit}", section.start, section.end);
    }
    Ok(())
}

/// The records that a value was taken from, the simulated one first, and those that were read to
/// compute it again.
fn records<'a>(
    carried: &'a Carried,
    pair: &'a PairValue,
    within: Option<&'static str>,
    read: &'a dyn Fn(&FileHash) -> bool,
) -> impl Iterator<Item = &'a FileHash> {
    let took_part = move |kind: &str, name: Option<&str>| match (within, &pair.record) {
        (Some(within), Some(pair @ RecordName::Pair(..))) => {
            kind == within && name.is_some_and(|name| pair.has(name))
        }
        (_, record) => RecordName::took_part(record.as_ref(), kind == "simulation", name),
    };
    let of = move |file: &&FileHash, kind: &str| {
        file.record.as_ref().is_some_and(|record| {
            let own = record.section == pair.section && took_part(kind, record.name.as_deref());
            record.kind == kind && (own || read(file))
        })
    };
    let all = &carried.results.campaign.files;
    ["simulation", "measurement"]
        .into_iter()
        .flat_map(move |kind| all.iter().filter(move |file| of(file, kind)))
}

/// Describes one record; returns whether it is unchanged and gives the same value.
fn record(
    out: &mut Lines,
    file: &FileHash,
    pair: &PairValue,
    side: Option<&Side>,
    compiled: Option<(&Compiled, (usize, usize))>,
) -> bool {
    *out += "\n";
    let _ = writeln!(out, "{}", file.path);
    let _ = writeln!(out, "  SHA-256    {}", file.sha256);
    let (Some(side), Some((compiled, index))) = (side, compiled) else { return true };
    let mut agrees = side.file.sha256 == file.sha256;
    if !agrees {
        let _ = writeln!(out, "  CHANGED    {} now", side.file.sha256);
    }
    let (first, last) = side.inside;
    let _ = writeln!(
        out,
        "  rows       {first} to {last} lie in the section, {} to {} are filtered",
        side.filtered.0, side.filtered.1
    );
    let plan = &compiled.plan.quantities[index.0];
    for (node, value, samples) in &side.reduced {
        let node = &compiled.graph.nodes[*node];
        let shown = in_unit(*value, node, [&plan.unit, &plan.signal_unit]);
        let _ = writeln!(out, "  {:<10} {shown}, of {samples} values", node.label.text);
    }
    let before = match side.column {
        Some(crate::check::plan::Side::Simulated) => pair.simulated,
        Some(crate::check::plan::Side::Measured) => pair.measured,
        None => None,
    };
    if let (Some(value), Some(before)) = (side.value, before) {
        let same = near(value, before);
        agrees &= same;
        let words = if same {
            "as in the report".to_string()
        } else {
            format!("NOT the {before} of the report")
        };
        let _ = writeln!(out, "  value      {value}{}, {words}", plan.unit.suffix());
    }
    agrees
}

/// A number in the first unit of the right dimension, else in SI units.
fn in_unit(value: f64, node: &Node, units: [&Unit; 2]) -> String {
    match units.into_iter().find(|unit| unit.dimension == node.dimension) {
        Some(unit) => format!("{}{}", unit.from_si(value), unit.suffix()),
        None => format!("{value} {} (SI)", node.dimension),
    }
}

fn statistics(out: &mut Lines, carried: &Carried, quantity: &QuantityResult, pair: &PairValue) {
    *out += "\n";
    let _ = writeln!(out, "enters");
    // Of groups told apart by more than the zone, the estimates of the section's zone are listed.
    let own = |statistic: &&StatisticResult| {
        statistic.scope.zones.len() != 1 || statistic.scope.has_zone(pair.zone.as_deref())
    };
    for statistic in quantity.statistics.iter().filter(own) {
        let scope = statistic.scope.suffix();
        let unit = suffix(&statistic.unit);
        let shown = |value: Option<f64>| {
            value
                .map_or_else(|| "-".to_string(), |value| format!("{}{unit}", significant(value, 5)))
        };
        let holds = match statistic.holds {
            Some(true) => "holds",
            Some(false) => "EXCEEDS",
            None => "not assessable",
        };
        let share =
            statistic.normalised.map_or_else(String::new, |share| format!(", share {share:.3}"));
        let _ = writeln!(
            out,
            "  {}{scope}: {} of {} values, limit {} ({}){share}: {holds}{}",
            statistic.title,
            shown(statistic.value),
            statistic.count,
            shown(statistic.limit),
            statistic.limit_text,
            said(&statistic.rule)
        );
        if let Some(reason) = &statistic.reason {
            let _ = writeln!(out, "    {}", reason.text());
        }
    }
    let _ = writeln!(
        out,
        "verdict of the report: {}",
        carried.results.own_word.as_ref().unwrap_or(&carried.results.verdict_text)
    );
}
