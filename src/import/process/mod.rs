//! From a foreign file to the record of a section: what the mapping states, in a fixed order, each
//! step told with its numbers.
//!
//! | file | content |
//! |---|---|
//! | `recording` | channels in the file, and their units |
//! | `clock` | time of a table, the grid of a record, resampling |
//! | `clocks` | the clocks of the tables of a file as one |
//! | `distance` | distance from a channel, a speed or a trigger; match with the track file |
//! | `times` | gaps and uneven steps of time; the account of rates |
//! | `finish` | the record cut to its section, and its last checks |
//! | `store` | values of columns, in memory or in a file |

mod clock;
mod clocks;
mod distance;
mod finish;
mod recording;
mod store;
mod times;

pub use recording::Recording;
pub use store::{BLOCK, Store, Values};

use super::mapping::{ChannelMap, Channels, Distance, Side, Term, agree};
use crate::data::RecordKind;
use crate::problem::{Problem, Severity, error};
use crate::source::Spanned;
use crate::units::Unit;
use crate::units::number::significant;
use clock::{Clock, Grid, How, grid, on_grid};
use recording::Source;

/// A column of a record in SI.
#[derive(Clone, Debug)]
pub struct Column {
    pub name: String,
    pub unit: Unit,
    pub values: Values,
}

/// The record of a section as it is written.
#[derive(Clone, Debug)]
pub struct Made {
    pub kind: RecordKind,
    pub section: String,
    /// Time and distance first.
    pub columns: Vec<Column>,
    /// What was done, in order.
    pub steps: Vec<String>,
    /// What deserves attention.
    pub warnings: Vec<Problem>,
}

/// The times of the tables that are used, and those of the record.
#[derive(Debug)]
struct Sampling {
    clocks: Vec<Option<Clock>>,
    /// The table whose samples the record has.
    base: usize,
    grid: Grid,
}

impl Sampling {
    /// A signal of a table at the times of the record. An axis is interpolated linearly.
    ///
    /// # Errors
    /// A reason, to follow the name of the signal.
    fn resample(
        &self,
        table: usize,
        values: &[f64],
        axis: bool,
    ) -> Result<(Vec<f64>, How), String> {
        let clock = self.clocks[table].as_ref().ok_or("has no time")?;
        on_grid(values, clock, table == self.base, &self.grid, axis)
    }
}

/// Number of faults of one record that are reported.
const MOST_TOLD: usize = 8;

/// Makes the record of a section.
///
/// # Errors
/// `unknown-table`, `unknown-channel`, `ambiguous-channel`, `no-channel`, `unit-missing`,
/// `unknown-unit`, `unit-mismatch`, `time-missing`, `time-not-increasing`, `too-short`,
/// `no-common-time`, `uneven-time`, `sum-of-tables`, `no-pulses`, `no-match`, `not-finite`,
/// `axis-not-increasing`, `outside-record`; of stated values `unknown-fact`, `wrong-number`.
pub fn record(recording: &Recording<'_>) -> Result<Made, Vec<Problem>> {
    let side = recording.side;
    let maps = maps(recording)?;
    let (lacks, lacked) = missing(recording, &maps);
    if !lacks.is_empty() {
        return Err(lacks);
    }
    let sources = sources(recording, &maps)?;
    let matched = matched(recording)?;
    let used = || sources.iter().map(|(source, _)| source.table);
    let used_or_matched = || used().chain(matched.iter().map(|(table, _)| *table));
    let base = most_used(recording, used());
    let clocks = clocks(recording, used_or_matched())?;
    let curve = match &side.distance {
        Some(distance) => Some(distance::curve(recording, distance, &clocks)?),
        None => None,
    };
    let Some(base_clock) = clocks.get(base).and_then(Option::as_ref) else {
        return Err(recording.time_missing().into());
    };
    let span = span(&clocks, used_or_matched(), curve.as_ref().map(|curve| &curve.clock));
    if let Some(rate) = &side.rate
        && let Some(problem) = times::impossible(recording, rate, base_clock, span)
    {
        return Err(problem.into());
    }
    let rate = side.rate.as_ref().map(|rate| rate.value.0);
    let Some(grid) = grid(base_clock, rate, span) else {
        let says = format!(
            "the channels of `{}` have no time in common ({} s to {} s)",
            recording.shown, span.0, span.1
        );
        return Err(recording.fault("no-common-time", &says, &side.time.span).into());
    };
    let sampling = Sampling { clocks, base, grid };
    let unfit = times::faults(recording, &sampling, &|table| used().any(|used| used == table));
    if !unfit.is_empty() {
        return Err(unfit);
    }
    let mut steps = Vec::new();
    times::told(recording, &sampling, &mut steps);
    left_out(recording, &mut steps);
    // The values of the channels are made one after the other, so that only those of one channel
    // are in memory twice.
    let (mut sampled, mut columns, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    for (map, (source, unit)) in maps.iter().zip(&sources) {
        let name = map.name.value.clone();
        match sampling.resample(source.table, &source.values(map), false) {
            Ok((values, how)) => {
                sampled.push((how, source.table));
                let values = Values::keep(values, recording.store)?;
                columns.push(Column { name, unit: unit.clone(), values });
            }
            Err(why) => faults.push(recording.fault(
                "uneven-time",
                &format!("`{name}` {why}"),
                &map.terms[0].name.span,
            )),
        }
    }
    if !faults.is_empty() {
        return Err(few(faults));
    }
    times::told_tables(recording, &maps, &sampled, &sampling, &mut steps);
    turn(recording, &mut columns, &mut steps);
    let at = match curve {
        Some(curve) => Some(along_track(recording, curve, &matched, &sampling, &mut steps)?),
        None => None,
    };
    let mut made = finish::finish(recording, sampling.grid, at, columns, steps)?;
    made.warnings.splice(0..0, lacked);
    Ok(made)
}

/// Where every channel is, and its unit in the campaign. A channel that the protocol does not know
/// is written in the unit that other channels of its dimension have by the protocol.
fn sources<'a>(
    recording: &Recording<'a>,
    maps: &[ChannelMap],
) -> Result<Vec<(Source<'a>, Unit)>, Vec<Problem>> {
    let targets: Vec<Option<Unit>> = maps.iter().map(|map| recording.target(map)).collect();
    let (mut sources, mut faults) = (Vec::new(), Vec::new());
    for (map, target) in maps.iter().zip(&targets) {
        match Source::find(recording, map, target.as_ref()) {
            Ok(source) => {
                let dimension = source.unit().dimension;
                let alike = || targets.iter().flatten().find(|unit| unit.dimension == dimension);
                let unit = target.as_ref().or_else(alike).cloned();
                let unit = unit.unwrap_or_else(|| plainly(source.unit().clone()));
                sources.push((source, unit));
            }
            Err(problem) => faults.push(problem),
        }
    }
    if faults.is_empty() { Ok(sources) } else { Err(few(faults)) }
}

/// A unit of a file as it is written in campaigns: `m/s^2` for `m/s²`.
fn plainly(unit: Unit) -> Unit {
    let powers = [("⁻¹", "^-1"), ("⁻²", "^-2"), ("²", "^2"), ("³", "^3")];
    Unit {
        text: powers.iter().fold(unit.text, |text, (power, plain)| text.replace(power, plain)),
        ..unit
    }
}

/// The channels, written out where they keep their names.
fn maps(recording: &Recording<'_>) -> Result<Vec<ChannelMap>, Problem> {
    if let Channels::Maps(maps) = &recording.side.channels {
        return Ok(maps.clone());
    }
    let span = &recording.side.span;
    let channels = recording.tables.iter().flat_map(|table| &table.channels);
    let named = channels.filter(|channel| {
        !is_axis(recording, &channel.name) && !is_second_axis(recording, &channel.name)
    });
    let map = |name: &String| {
        let name = Spanned::new(name.clone(), span.clone());
        ChannelMap::named(name.clone(), vec![Term { name, reversed: false }])
    };
    let maps: Vec<ChannelMap> = named.map(|channel| map(&channel.name)).collect();
    if maps.is_empty() {
        return Err(error("no-channel", format!("`{}` has no channels", recording.shown), span));
    }
    Ok(maps)
}

/// Whether the time or the distance is from a channel of the file.
fn is_axis(recording: &Recording<'_>, name: &str) -> bool {
    let Side { time, distance, .. } = recording.side;
    time.from.0.iter().any(|time| time.value == name)
        || matches!(distance, Some(Distance::Channel(map)) if map.terms.iter().any(|term| term.name.value == name))
}

/// A record has one time and one distance: those that the mapping states.
fn is_second_axis(recording: &Recording<'_>, name: &str) -> bool {
    name == "time" || name == "distance" && recording.side.distance.is_some()
}

/// Tells which channels are not kept although all keep their names.
fn left_out(recording: &Recording<'_>, steps: &mut Vec<String>) {
    if recording.side.channels.maps().is_some() {
        return;
    }
    let has = |name: &str| {
        let mut channels = recording.tables.iter().flat_map(|table| &table.channels);
        channels.any(|channel| channel.name == name)
    };
    let is_left_out =
        |name: &&str| is_second_axis(recording, name) && !is_axis(recording, name) && has(name);
    for name in ["time", "distance"].into_iter().filter(is_left_out) {
        steps.push(format!(
            "the channel `{name}` of the file is left out: the mapping states another {name}"
        ));
    }
}

/// Channels that the protocol needs and a file does not have, where all channels keep their names:
/// errors and warnings.
fn missing(recording: &Recording<'_>, maps: &[ChannelMap]) -> (Vec<Problem>, Vec<Problem>) {
    let (Channels::AsNamed, Some(needs)) = (&recording.side.channels, recording.needs) else {
        return Default::default();
    };
    let names: Vec<&str> = maps.iter().map(|map| map.name.value.as_str()).collect();
    let of_side = (recording.mapping, recording.side);
    agree::as_named(of_side, needs, &names, recording.shown)
        .into_iter()
        .partition(|problem| problem.severity == Severity::Error)
}

/// The table of a channel, its values and their unit.
type InTable = (usize, (Vec<f64>, Unit));

/// The channels that are matched with the track.
fn matched(recording: &Recording<'_>) -> Result<Vec<InTable>, Problem> {
    let values = |map: &ChannelMap| {
        let stated = map.written_in.as_ref().map(|unit| unit.value.clone());
        let target = stated
            .or_else(|| agree::unit_needed(&map.name.value, RecordKind::Track, recording.needs));
        let source = Source::find(recording, map, target.as_ref())?;
        Ok((source.table, (source.values(map), source.unit().clone())))
    };
    let wanted = recording.side.matched.iter().flat_map(|wanted| &wanted.channels);
    wanted.map(values).collect()
}

/// The table with the most channels; of equal ones that with the most rows.
fn most_used(recording: &Recording<'_>, used: impl Iterator<Item = usize>) -> usize {
    let mut counts = vec![0_usize; recording.tables.len()];
    used.for_each(|table| counts[table] += 1);
    let rows = |table: usize| recording.tables[table].rows;
    (0..counts.len())
        .max_by_key(|&table| (counts[table], rows(table), std::cmp::Reverse(table)))
        .unwrap_or(0)
}

/// The clocks of the tables that are used, with those of the distance.
fn clocks(
    recording: &Recording<'_>,
    used: impl Iterator<Item = usize>,
) -> Result<Vec<Option<Clock>>, Problem> {
    let mut wanted = vec![false; recording.tables.len()];
    used.for_each(|table| wanted[table] = true);
    if let Some(distance) = &recording.side.distance {
        let map = distance.channel();
        for term in &map.terms {
            wanted[recording.find(&term.name, map.table.as_ref())?.0] = true;
        }
    }
    clocks::clocks(recording, &wanted)
}

/// The time that all used tables cover.
fn span(
    clocks: &[Option<Clock>],
    used: impl Iterator<Item = usize>,
    curve: Option<&Clock>,
) -> (f64, f64) {
    let ends = |clock: &Clock| (clock.times[0], clock.times[clock.times.len() - 1]);
    let all = used.filter_map(|table| clocks.get(table)?.as_ref()).chain(curve).map(ends);
    all.fold((f64::MIN, f64::MAX), |(start, end), (first, last)| (start.max(first), end.min(last)))
}

/// Exchanges channels and signs in a section that was run with the other end leading.
fn turn(recording: &Recording<'_>, columns: &mut [Column], steps: &mut Vec<String>) {
    let is_turned = recording.side.turned.has(recording.section, &recording.mapping.sections);
    let Some(turning) = recording.mapping.turning.as_ref().filter(|_| is_turned) else { return };
    let (mut exchanged, mut reversed) = (0, 0);
    for at in 0..columns.len() {
        let partner = turning.partner(&columns[at].name);
        let partner = columns.iter().position(|column| column.name == partner);
        if let Some(other) = partner.filter(|other| *other != at) {
            exchanged += 1;
            // Each pair once.
            if at < other
                && let Ok([first, second]) = columns.get_disjoint_mut([at, other])
            {
                std::mem::swap(&mut first.values, &mut second.values);
            }
        }
    }
    for column in columns.iter_mut().filter(|column| turning.reverses(&column.name)) {
        column.values.reverse();
        reversed += 1;
    }
    steps.push(format!(
        "turned, with the other end leading: {exchanged} channels exchanged, {reversed} with the opposite sign ({})",
        turning.from
    ));
}

/// The distance of the record: that of the curve, matched with the track, with the stated offset.
fn along_track(
    recording: &Recording<'_>,
    curve: distance::Curve,
    matched: &[(usize, (Vec<f64>, Unit))],
    sampling: &Sampling,
    steps: &mut Vec<String>,
) -> Result<Vec<f64>, Vec<Problem>> {
    let side = recording.side;
    let as_recorded = curve.table == Some(sampling.base);
    let along = on_grid(&curve.values, &curve.clock, as_recorded, &sampling.grid, true);
    let (mut values, how) = along.map_err(|why| {
        recording.fault("uneven-time", &format!("the distance {why}"), &side.span)
    })?;
    let linear = if how == How::Linear && curve.table.is_some() {
        format!(", interpolated linearly from {} Hz", short(curve.clock.rate))
    } else {
        String::new()
    };
    steps.push(format!("{}{linear}", curve.says));
    if let Some(wanted) = &side.matched {
        let mut channels = Vec::new();
        for (table, (values, unit)) in matched {
            let sampled = sampling.resample(*table, values, true);
            let (values, _) = sampled.map_err(|why| {
                error("uneven-time", format!("the channel matched {why}"), &wanted.span)
            })?;
            channels.push((values, unit.clone()));
        }
        let (shift, says) = distance::matched(recording, wanted, &values, &channels)?;
        values.iter_mut().for_each(|value| *value += shift);
        steps.push(says);
    }
    if let Some(offsets) = &side.offsets
        && let Some(offset) =
            offsets.value(recording.section, &recording.mapping.sections, &recording.facts)?
    {
        values.iter_mut().for_each(|value| *value += offset);
        steps.push(format!("{offset:+} m added to the distance (synchronisation)"));
    }
    Ok(values)
}

fn few(mut faults: Vec<Problem>) -> Vec<Problem> {
    let more = faults.len().saturating_sub(MOST_TOLD);
    if more > 0 {
        faults.truncate(MOST_TOLD);
        let says = format!("{more} more channels have such a fault");
        faults.push(Problem::error("more-problems", says));
    }
    faults
}

/// Six digits, for sentences.
pub fn short(value: f64) -> String {
    significant(value, 6).to_string()
}
