//! The first campaign of a machine, from pairs of simulated and measured records: campaign,
//! protocol, catalogue, and a stub of a simulator.

pub mod allowances;
pub mod catalogue;
pub mod records;
pub mod scales;
pub mod windows;

use serde_json::{Value as Json, json};

use crate::data::write::{table_csv, yaml_text};
use crate::init::{
    File, filled,
    protocol::{Names, after_number, block_name, identifier, plain_text},
};
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::units::{Unit, number::significant};
use allowances::{Allowance, allowances};
use catalogue::{Entry, entries, listed};
use records::{DISTANCE, Pair, Roles, Series, TIME, roles};
use scales::{Motion, motion, scales};
use windows::{Cut, cut, piece, two_digits};

const CAMPAIGN: &str = include_str!("../../templates/new/campaign.yaml");
const PROTOCOL: &str = include_str!("../../templates/new/protocol.fp");
const CATALOGUE: &str = include_str!("../../templates/new/catalogue.yaml");
const SIM: &str = include_str!("../../templates/new/sim.yaml");
const VEHICLE: &str = include_str!("../../templates/new/vehicle.yaml");
const STUB: &str = include_str!("../../templates/new/simulator.py");
/// Names of the files that commands are given.
pub const PROTOCOL_FILE: &str = "protocol.fp";
pub const CATALOGUE_FILE: &str = "effects.yaml";
/// Limit of a quantity as a share of the measured rms value.
const LIMIT: f64 = 0.1;

/// The machines for which there are effects; names of `domains` in `templates/new/effects.yaml`.
pub const DOMAINS: [&str; 5] = ["rail", "drive", "oscillator", "arm", "generic"];

/// A campaign and what is to be told of it.
#[derive(Debug)]
pub struct Made {
    pub files: Vec<File>,
    pub told: Vec<String>,
}

/// All files of the campaign of a machine.
///
/// # Errors
/// The records do not fit together; `internal`.
pub fn files(folder: &str, domain: &str, pairs: &[Pair]) -> Result<Made, Problem> {
    let roles = roles(pairs)?;
    let cut = cut(pairs, &roles);
    let (allowed, origin) = allowances(pairs, &roles, &cut);
    let scales = scales(pairs, &roles, &cut);
    let motion = motion(pairs, &roles, None);
    let unit = |name: &str| unit_of(pairs, name);
    let sizes: Vec<_> =
        allowed.iter().copied().zip(roles.outputs.iter().map(|name| unit(name))).collect();
    let effects = entries(domain, &scales, &roles, &sizes, &cut)?;
    let mut names = Names::default();
    let compared = roles.outputs.iter().zip(&sizes);
    let channels: Vec<Json> =
        compared.map(|(name, (allowed, unit))| channel(name, allowed, unit, &mut names)).collect();
    let (table, covariates) = sections(pairs, &cut, motion.as_ref(), &roles);
    let of_machine = effects.iter().filter(|effect| effect.operator.is_none());
    let parameters: Vec<Json> = of_machine
        .map(|Entry { parameter, unit, title, term, .. }| {
            json!({"name": parameter, "unit": unit, "title": title, "term": term})
        })
        .collect();
    let column = |name: &str, unit: &str| json!({"name": name, "unit": unit});
    let (time, distance) = (column(TIME, "s"), column(DISTANCE, "m"));
    let axes = if cut.over_distance { vec![distance, time] } else { vec![time] };
    let given = roles.inputs.iter().map(|name| column(name, &unit(name).text));
    let inputs: Vec<Json> = axes.iter().cloned().chain(given).collect();
    let quoted: Vec<String> = roles.outputs.iter().map(|name| yaml_text(name)).collect();
    let bands = listed(&cut.edges);
    let data = json!({
        "name": block_name(folder),
        "title": plain_text(folder),
        "axis": axes[0],
        "time": axes.get(1),
        "inputs": inputs,
        "all": quoted.join(", "),
        "channels": channels,
        "parameters": parameters,
        "effects": effects,
        "highest": two_digits(cut.content.1).to_string(),
        "bands": bands,
        "count": cut.edges.len().saturating_sub(1).to_string(),
        "alike": listed(&[cut.edges[0], cut.edges[cut.edges.len() - 1]]),
        "furthest": cut.furthest.to_string(),
        "step": two_digits(cut.step).to_string(),
        "strata": pairs.len() > 1,
        "covariates": format!("[{}]", covariates.join(", ")),
        "origin": origin,
    });
    let own = |template: &str| Ok::<_, Problem>(filled(template, &data)?.replace("\n\n\n", "\n\n"));
    // The stub keeps the two blank lines that Python has before a function.
    let mut files = vec![
        ("campaign.yaml".to_string(), own(CAMPAIGN)?),
        (PROTOCOL_FILE.to_string(), canonical(&own(PROTOCOL)?)),
        (CATALOGUE_FILE.to_string(), own(CATALOGUE)?),
        ("sim.yaml".to_string(), own(SIM)?),
        ("simulator.py".to_string(), filled(STUB, &data)?),
        ("vehicle.yaml".to_string(), own(VEHICLE)?),
        ("sections.csv".to_string(), table),
    ];
    files.extend(records(pairs, &cut, &roles));
    let given: Vec<&str> = inputs.iter().filter_map(|input| input["name"].as_str()).collect();
    let mut told = vec![
        format!("compared: {}", roles.outputs.join(", ")),
        format!("inputs of the simulator: {}", given.join(", ")),
        format!("{} sections; bands {bands} Hz", cut.windows.len()),
        origin,
    ];
    if scales.is_empty() {
        told.push("no column is a force (N, N m, A, V, Pa) with a motion (m, rad, m/s, ...) beside it: only effects of the measuring chain are offered".into());
    }
    Ok(Made { files, told })
}

fn canonical(text: &str) -> String {
    syntax::print_text(&syntax::read_text(
        &Source::new(PROTOCOL_FILE, text),
        &mut Problems::default(),
    ))
}

/// A compared channel, for the templates.
fn channel(name: &str, allowed: &Allowance, unit: &Unit, names: &mut Names) -> Json {
    let id = names.free(&identifier(name));
    json!({
        "name": name,
        "quoted": yaml_text(name),
        "title": plain_text(name),
        "id": id,
        "group": id,
        "unit": unit.text,
        "number_unit": after_number(unit),
        "limit": two_digits(LIMIT * allowed.rms).to_string(),
        "noise": allowed.noise.to_string(),
        "noise_name": format!("{id} noise"),
        "gain_name": format!("{id} gain"),
        "level_sd": allowed.level.to_string(),
        "band_sd": allowed.band.to_string(),
        "gain_sd": allowed.gain.to_string(),
        "lag_sd": allowed.lag.to_string(),
    })
}

/// The unit of a measured channel.
fn unit_of(pairs: &[Pair], name: &str) -> Unit {
    pairs[0].measured.channel(name).map_or_else(Unit::one, |channel| channel.unit.clone())
}

fn section(at: usize) -> String {
    format!("S{:02}", at + 1)
}

/// The table of sections with mean speed and amplitude, and the names of these columns.
fn sections(
    pairs: &[Pair],
    cut: &Cut,
    motion: Option<&Motion>,
    roles: &Roles,
) -> (String, Vec<String>) {
    let axis = if cut.over_distance { "m" } else { "s" };
    let mut header = vec!["section".to_string(), "record".to_string()];
    header.extend([format!("start [{axis}]"), format!("end [{axis}]")]);
    let mut covariates = Vec::new();
    let speed = motion.filter(|motion| motion.order < 2);
    if let Some(Motion { order, unit, .. }) = speed {
        let unit = if *order == 1 { unit.text.clone() } else { format!("{unit}/s") };
        header.push(format!("mean speed [{unit}]"));
        covariates.push("mean speed".to_string());
    }
    let first = match motion {
        Some(motion) => Some(&motion.column),
        None => roles.inputs.iter().chain(&roles.outputs).next(),
    };
    let first = first.cloned().unwrap_or_default();
    let unit = unit_of(pairs, &first);
    header.push(format!("amplitude [{unit}]"));
    covariates.push("amplitude".to_string());
    let mut rows = vec![header];
    for (at, window) in cut.windows.iter().enumerate() {
        let measured = &pairs[window.pair].measured;
        let of = |name: &str| piece(measured, name, cut.over_distance, window.start, window.end);
        let mut row = vec![
            section(at),
            pairs[window.pair].name.clone(),
            window.start.to_string(),
            window.end.to_string(),
        ];
        if let Some(motion) = speed {
            let mean = of(&motion.column).map_or(0.0, |piece| match motion.order {
                1 => mean(piece.values.iter().map(|value| value.abs())),
                _ => {
                    mean(piece.values.windows(2).map(|pair| (pair[1] - pair[0]).abs() * piece.rate))
                }
            });
            row.push(significant(mean, 3).to_string());
        }
        // A harmonic motion of this amplitude has this rms value.
        let amplitude = of(&first).map_or(0.0, |piece| {
            let middle = mean(piece.values.iter().copied());
            (2.0 * mean(piece.values.iter().map(|value| (value - middle).powi(2)))).sqrt()
        });
        row.push(significant(amplitude, 3).to_string());
        rows.push(row);
    }
    (table_csv(&rows), covariates)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

/// The records of all sections: what is compared on both sides, and what the simulator is given.
fn records(pairs: &[Pair], cut: &Cut, roles: &Roles) -> Vec<File> {
    let mut files = Vec::new();
    for (at, window) in cut.windows.iter().enumerate() {
        let Pair { simulated, measured, .. } = &pairs[window.pair];
        for (folder, series, names) in [
            ("simulation", simulated, &roles.outputs),
            ("measurement", measured, &roles.outputs),
            ("inputs", measured, &roles.inputs),
        ] {
            let text = text(series, names, cut.over_distance, (window.from, window.to));
            files.push((format!("{folder}/{}.csv", section(at)), text));
        }
    }
    files
}

/// Columns of a record in a range of the axis.
fn text(series: &Series, names: &[String], over_distance: bool, (from, to): (f64, f64)) -> String {
    use std::fmt::Write;
    let axis = series.axis(over_distance);
    let (a, b) = (axis.partition_point(|x| *x < from), axis.partition_point(|x| *x <= to));
    let channels: Vec<_> = names.iter().filter_map(|name| series.channel(name)).collect();
    let mut header = vec!["time [s]".to_string()];
    header.extend(over_distance.then(|| "distance [m]".to_string()));
    header.extend(channels.iter().map(|channel| format!("{} [{}]", channel.name, channel.unit)));
    let mut out = table_csv(&[header]);
    for row in a..b {
        // Times are in even steps; nine decimals keep them so.
        let _ = write!(out, "{}", (series.time[row] * 1e9).round() / 1e9);
        if let Some(distance) = series.distance.as_ref().filter(|_| over_distance) {
            let _ = write!(out, ",{}", (distance[row] * 1e6).round() / 1e6);
        }
        channels.iter().for_each(|channel| {
            let _ = write!(out, ",{}", channel.values[row]);
        });
        out.push('\n');
    }
    out
}
