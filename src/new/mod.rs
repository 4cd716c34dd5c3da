//! The first campaign of a machine, from pairs of simulated and measured records: campaign,
//! protocol, catalogue, and a stub of a simulator.

#![allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

pub mod allowances;
pub mod catalogue;
pub mod records;
pub mod scales;
pub mod windows;

use serde::Serialize;

use crate::data::write::{table_csv, yaml_text};
use crate::init::protocol::{Names, after_number, block_name, identifier, plain_text};
use crate::init::{File, filled};
use crate::problem::{Problem, Problems};
use crate::source::Source;
use crate::syntax;
use crate::units::Unit;
use crate::units::number::significant;
use allowances::allowances;
use catalogue::{Entry, entries};
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

/// A compared channel in templates.
#[derive(Serialize)]
struct Compared {
    name: String,
    quoted: String,
    title: String,
    id: String,
    group: String,
    unit: String,
    /// ` kN` after a number.
    number_unit: String,
    limit: String,
    noise: String,
    noise_name: String,
    gain_name: String,
    level_sd: String,
    band_sd: String,
    gain_sd: String,
    lag_sd: String,
}

#[derive(Serialize)]
struct Column {
    name: String,
    unit: String,
}

#[derive(Serialize)]
struct Parameter {
    name: String,
    unit: String,
    title: String,
    term: String,
}

#[derive(Serialize)]
struct Parts {
    name: String,
    title: String,
    axis: Column,
    time: Option<Column>,
    inputs: Vec<Column>,
    channels: Vec<Compared>,
    all: String,
    parameters: Vec<Parameter>,
    effects: Vec<Entry>,
    highest: String,
    bands: String,
    count: String,
    alike: String,
    furthest: String,
    step: String,
    strata: bool,
    covariates: String,
    origin: String,
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
    let unit = |name: &str| {
        pairs[0].measured.channel(name).map_or_else(Unit::one, |channel| channel.unit.clone())
    };
    let sizes: Vec<_> =
        allowed.iter().copied().zip(roles.outputs.iter().map(|name| unit(name))).collect();
    let effects = entries(domain, &scales, &roles, &sizes, &cut)?;
    let mut names = Names::default();
    let channels: Vec<Compared> = roles
        .outputs
        .iter()
        .zip(&sizes)
        .map(|(name, (allowed, unit))| compared(name, allowed, unit, &mut names))
        .collect();
    let (table, covariates) = sections(pairs, &cut, motion.as_ref(), &roles);
    let parameters: Vec<Parameter> = effects
        .iter()
        .filter(|effect| effect.operator.is_none())
        .map(|effect| Parameter {
            name: effect.parameter.clone(),
            unit: effect.unit.clone(),
            title: effect.title.clone(),
            term: effect.term.clone(),
        })
        .collect();
    let column = |name: &str, unit: &str| Column { name: name.into(), unit: unit.into() };
    let time = column(TIME, "s");
    let (axis, time) =
        if cut.over_distance { (column(DISTANCE, "m"), Some(time)) } else { (time, None) };
    let given = [column(axis.name.as_str(), axis.unit.as_str())]
        .into_iter()
        .chain(time.as_ref().map(|time| column(&time.name, &time.unit)));
    let inputs = given
        .chain(roles.inputs.iter().map(|name| Column { name: name.clone(), unit: unit(name).text }))
        .collect();
    let highest = two_digits(cut.content.1).to_string();
    let parts = Parts {
        name: block_name(folder),
        title: plain_text(folder),
        axis,
        time,
        inputs,
        all: channels.iter().map(|channel| channel.quoted.clone()).collect::<Vec<_>>().join(", "),
        channels,
        parameters,
        effects,
        highest,
        bands: listed(&cut.edges),
        count: cut.edges.len().saturating_sub(1).to_string(),
        alike: listed(&[cut.edges[0], cut.edges[cut.edges.len() - 1]]),
        furthest: cut.furthest.to_string(),
        step: two_digits(cut.step).to_string(),
        strata: pairs.len() > 1,
        covariates: format!("[{}]", covariates.join(", ")),
        origin,
    };
    let fill = |template: &str| filled(template, &parts).map_err(|problem| *problem);
    let own = |template: &str| Ok::<_, Problem>(fill(template)?.replace("\n\n\n", "\n\n"));
    // The stub keeps the two blank lines that Python has before a function.
    let mut files = vec![
        ("campaign.yaml".to_string(), own(CAMPAIGN)?),
        (PROTOCOL_FILE.to_string(), canonical(&own(PROTOCOL)?)),
        (CATALOGUE_FILE.to_string(), own(CATALOGUE)?),
        ("sim.yaml".to_string(), own(SIM)?),
        ("simulator.py".to_string(), fill(STUB)?),
        ("vehicle.yaml".to_string(), own(VEHICLE)?),
        ("sections.csv".to_string(), table),
    ];
    files.extend(records(pairs, &cut, &roles));
    let told = told(&parts, &cut, &scales);
    Ok(Made { files, told })
}

fn canonical(text: &str) -> String {
    syntax::print_text(&syntax::read_text(
        &Source::new(PROTOCOL_FILE, text),
        &mut Problems::default(),
    ))
}

fn compared(
    name: &str,
    allowed: &allowances::Allowance,
    unit: &Unit,
    names: &mut Names,
) -> Compared {
    let id = names.free(&identifier(name));
    Compared {
        name: name.into(),
        quoted: yaml_text(name),
        title: plain_text(name),
        group: id.clone(),
        unit: unit.text.clone(),
        number_unit: after_number(unit),
        limit: two_digits(LIMIT * allowed.rms).to_string(),
        noise: allowed.noise.to_string(),
        noise_name: format!("{id} noise"),
        gain_name: format!("{id} gain"),
        id,
        level_sd: allowed.level.to_string(),
        band_sd: allowed.band.to_string(),
        gain_sd: allowed.gain.to_string(),
        lag_sd: allowed.lag.to_string(),
    }
}

fn listed(numbers: &[f64]) -> String {
    format!("[{}]", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
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
    let mut header: Vec<String> = ["section", "record"].iter().map(ToString::to_string).collect();
    header.extend([format!("start [{axis}]"), format!("end [{axis}]")]);
    let speed = motion.filter(|motion| motion.order < 2).map(|motion| {
        let unit =
            if motion.order == 1 { motion.unit.text.clone() } else { format!("{}/s", motion.unit) };
        (motion, unit)
    });
    let first = motion
        .map(|motion| motion.column.clone())
        .or_else(|| roles.inputs.iter().chain(&roles.outputs).next().cloned())
        .unwrap_or_default();
    let unit =
        pairs[0].measured.channel(&first).map_or_else(Unit::one, |channel| channel.unit.clone());
    let mut covariates = vec!["amplitude".to_string()];
    if let Some((_, unit)) = &speed {
        header.push(format!("mean speed [{unit}]"));
        covariates.insert(0, "mean speed".into());
    }
    header.push(format!("amplitude [{unit}]"));
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
        if let Some((motion, _)) = &speed {
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
        let pair = &pairs[window.pair];
        let of = |series: &Series, names: &[String]| {
            text(series, names, cut.over_distance, (window.from, window.to))
        };
        files
            .push((format!("simulation/{}.csv", section(at)), of(&pair.simulated, &roles.outputs)));
        files
            .push((format!("measurement/{}.csv", section(at)), of(&pair.measured, &roles.outputs)));
        files.push((format!("inputs/{}.csv", section(at)), of(&pair.measured, &roles.inputs)));
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

fn told(parts: &Parts, cut: &Cut, scales: &[scales::Scales]) -> Vec<String> {
    let names = |columns: Vec<&str>| columns.join(", ");
    let mut told = vec![
        format!(
            "compared: {}",
            names(parts.channels.iter().map(|channel| channel.name.as_str()).collect())
        ),
        format!(
            "inputs of the simulator: {}",
            names(parts.inputs.iter().map(|column| column.name.as_str()).collect())
        ),
        format!("{} sections; bands {} Hz", cut.windows.len(), parts.bands),
        parts.origin.clone(),
    ];
    if scales.is_empty() {
        told.push("no column is a force (N, N m, A, V, Pa) with a motion (m, rad, m/s, ...) beside it: only effects of the measuring chain are offered".into());
    }
    told
}
