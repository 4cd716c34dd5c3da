//! From a foreign file to the record of a section: what the mapping states, in a fixed order, each
//! step told with its numbers.
//!
//! | file | content |
//! |---|---|
//! | `find` | channels in the file, and their units |
//! | `clock` | time of a table, the grid of a record, resampling |
//! | `distance` | distance from a channel, a speed or a trigger; match with the track file |
//! | `times` | gaps and uneven steps of time; the account of rates |
//! | `store` | values of columns, in memory or in a file |

mod clock;
mod distance;
mod find;
mod store;
mod times;

pub use find::Of;
pub use store::{BLOCK, Store, Values};

use super::mapping::{ChannelMap, Channels, Distance, Side, Term, agree};
use crate::data::RecordKind;
use crate::foreign::Table;
use crate::problem::{Problem, Severity};
use crate::source::Spanned;
use crate::units::number::significant;
use crate::units::{Dimension, Unit};
use clock::{Clock, Grid, How, clock, grid, on_grid};
use distance::Source;

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

/// Number of faults of one record that are reported.
const MOST_TOLD: usize = 8;

/// Makes the record of a section.
///
/// # Errors
/// `unknown-table`, `unknown-channel`, `ambiguous-channel`, `no-channel`, `unit-missing`,
/// `unknown-unit`, `unit-mismatch`, `time-missing`, `time-not-increasing`, `too-short`,
/// `no-common-time`, `uneven-time`, `sum-of-tables`, `no-pulses`, `no-match`, `not-finite`,
/// `axis-not-increasing`, `outside-record`; of stated values `unknown-fact`, `wrong-number`.
pub fn record(of: &Of<'_>) -> Result<Made, Vec<Problem>> {
    let tables = of.tables()?;
    let facts: Vec<(String, String)> =
        tables.iter().flat_map(|table| &table.facts).chain(&of.file.facts).cloned().collect();
    let maps = maps(of, &tables)?;
    let (lacks, lacked) = missing(of, &maps);
    if !lacks.is_empty() {
        return Err(lacks);
    }
    // Where every channel is; its values are made one after the other below, so that only those of
    // one channel are in memory twice.
    let mut faults = Vec::new();
    let mut sources: Vec<(Source<'_>, Unit)> = Vec::new();
    for map in &maps {
        let target = of.target(map);
        let found = Source::find(of, map, &tables, target.as_ref()).and_then(|source| {
            let own = target.map_or_else(
                || of.unit(map, &map.terms[0].name, source.first.channel, None).map(plainly),
                Ok,
            )?;
            Ok((source, own))
        });
        match found {
            Ok(found) => sources.push(found),
            Err(problem) => faults.push(problem),
        }
    }
    if !faults.is_empty() {
        return Err(few(faults));
    }
    of_their_dimension(of, &maps, &mut sources);
    let used = || sources.iter().map(|(source, _)| source.first.table);
    let matched: Vec<(usize, Vec<f64>, Unit)> = match &of.side.matched {
        None => Vec::new(),
        Some(wanted) => wanted
            .channels
            .iter()
            .map(|map| values_for_match(of, map, &tables))
            .collect::<Result<_, _>>()?,
    };
    let used_or_matched = || used().chain(matched.iter().map(|(table, ..)| *table));
    let base = most_used(used(), &tables);
    let clocks = clocks(of, &tables, &facts, used_or_matched())?;
    let curve = of
        .side
        .distance
        .as_ref()
        .map(|distance| distance::curve(of, distance, &tables, &clocks, &facts))
        .transpose()?;
    let Some(base_clock) = clocks.get(base).and_then(Option::as_ref) else {
        return Err(vec![
            Problem::error("time-missing", format!("`{}` has no time", of.shown))
                .at(&of.side.time.span),
        ]);
    };
    let mut steps = Vec::new();
    let span = span(&clocks, used_or_matched(), curve.as_ref().map(|curve| &curve.clock));
    let rate = of.side.rate.as_ref().map(|rate| rate.value.0);
    if let Some(rate) = &of.side.rate
        && let Some(problem) = times::impossible(of, rate, base_clock, span)
    {
        return Err(vec![problem]);
    }
    let Some(grid) = grid(base_clock, rate, span) else {
        let says = format!(
            "{}: the channels of `{}` have no time in common ({} s to {} s)",
            of.called(),
            of.shown,
            span.0,
            span.1
        );
        return Err(vec![Problem::error("no-common-time", says).at(&of.side.time.span)]);
    };
    let unfit = times::faults(of, &tables, &clocks, (base, &grid), &|table| {
        used().any(|used| used == table)
    });
    if !unfit.is_empty() {
        return Err(unfit);
    }
    times::told(of, base_clock, &grid, &mut steps);
    left_out(of, &tables, &mut steps);
    let (mut sampled, mut columns) = (Vec::new(), Vec::new());
    for (map, (source, unit)) in maps.iter().zip(&sources) {
        let table = source.first.table;
        match clocks[table]
            .as_ref()
            .map(|clock| on_grid(&source.values(map), clock, table == base, &grid, false))
        {
            Some(Ok((values, how))) => {
                sampled.push((how, table));
                let values = Values::keep(values, of.store)?;
                columns.push(Column { name: map.name.value.clone(), unit: unit.clone(), values });
            }
            Some(Err(why)) => faults.push(
                Problem::error(
                    "uneven-time",
                    format!("{}: `{}` {why}", of.called(), map.name.value),
                )
                .at(&map.terms[0].name.span),
            ),
            None => {}
        }
    }
    if !faults.is_empty() {
        return Err(few(faults));
    }
    times::told_tables(&maps, &sampled, &clocks, (base, &grid), &tables, &mut steps);
    turn(of, &mut columns, &mut steps);
    let mut at = None;
    if let Some(curve) = curve {
        let as_recorded = curve.table == Some(base);
        let along = on_grid(&curve.values, &curve.clock, as_recorded, &grid, true);
        let (mut values, how) = along.map_err(|why| {
            vec![
                Problem::error("uneven-time", format!("{}: the distance {why}", of.called()))
                    .at(&of.side.span),
            ]
        })?;
        let linear = if how == How::Linear && curve.table.is_some() {
            format!(", interpolated linearly from {} Hz", short(curve.clock.rate))
        } else {
            String::new()
        };
        steps.push(format!("{}{linear}", curve.says));
        along_track(of, &mut values, &matched, &clocks, (base, &grid), &facts, &mut steps)?;
        at = Some(values);
    }
    let mut made = finish(of, grid, at, columns, steps)?;
    made.warnings.splice(0..0, lacked);
    Ok(made)
}

/// A channel that the protocol does not know is written in the unit that other channels of its
/// dimension have by the protocol.
fn of_their_dimension(of: &Of<'_>, maps: &[ChannelMap], sources: &mut [(Source<'_>, Unit)]) {
    let known: Vec<Unit> = maps.iter().filter_map(|map| of.target(map)).collect();
    for (map, (_, unit)) in maps.iter().zip(sources) {
        if let (None, Some(other)) =
            (of.target(map), known.iter().find(|other| other.dimension == unit.dimension))
        {
            *unit = other.clone();
        }
    }
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
fn maps(of: &Of<'_>, tables: &[&Table]) -> Result<Vec<ChannelMap>, Vec<Problem>> {
    match &of.side.channels {
        Channels::Maps(maps) => Ok(maps.clone()),
        Channels::AsNamed => {
            let span = of.side.span.clone();
            let channels = tables.iter().flat_map(|table| &table.channels);
            let named = channels.filter(|channel| {
                !is_axis(of, &channel.name) && !is_second_axis(of, &channel.name)
            });
            let maps: Vec<ChannelMap> = named
                .map(|channel| {
                    let name = Spanned::new(channel.name.clone(), span.clone());
                    let terms = vec![Term { name: name.clone(), reversed: false }];
                    ChannelMap::named(name, terms)
                })
                .collect();
            if maps.is_empty() {
                return Err(vec![
                    Problem::error("no-channel", format!("`{}` has no channels", of.shown))
                        .at(&span),
                ]);
            }
            Ok(maps)
        }
    }
}

/// Whether the time or the distance is from a channel of the file.
fn is_axis(of: &Of<'_>, name: &str) -> bool {
    let Side { time, distance, .. } = of.side;
    time.from.0.iter().any(|time| time.value == name)
        || matches!(distance, Some(Distance::Channel(map)) if map.terms.iter().any(|term| term.name.value == name))
}

/// A record has one time and one distance: those that the mapping states.
fn is_second_axis(of: &Of<'_>, name: &str) -> bool {
    name == "time" || name == "distance" && of.side.distance.is_some()
}

/// Tells which channels are not kept although all keep their names.
fn left_out(of: &Of<'_>, tables: &[&Table], steps: &mut Vec<String>) {
    for name in ["time", "distance"]
        .into_iter()
        .filter(|name| of.side.channels.maps().is_none() && is_second_axis(of, name))
    {
        if !is_axis(of, name)
            && tables.iter().any(|table| table.channels.iter().any(|channel| channel.name == name))
        {
            steps.push(format!(
                "the channel `{name}` of the file is left out: the mapping states another {name}"
            ));
        }
    }
}

/// Channels that the protocol needs and a file does not have, where all channels keep their names:
/// errors and warnings.
fn missing(of: &Of<'_>, maps: &[ChannelMap]) -> (Vec<Problem>, Vec<Problem>) {
    let (Channels::AsNamed, Some(needs)) = (&of.side.channels, of.needs) else {
        return (Vec::new(), Vec::new());
    };
    let names: Vec<&str> = maps.iter().map(|map| map.name.value.as_str()).collect();
    let is_error = |problem: &Problem| problem.severity == Severity::Error;
    agree::as_named((of.mapping, of.side), needs, &names, of.shown).into_iter().partition(is_error)
}

fn values_for_match(
    of: &Of<'_>,
    map: &ChannelMap,
    tables: &[&Table],
) -> Result<(usize, Vec<f64>, Unit), Problem> {
    let target = map
        .written_in
        .as_ref()
        .map(|unit| unit.value.clone())
        .or_else(|| agree::unit_needed(&map.name.value, RecordKind::Track, of.needs));
    let (found, values) = distance::values(of, map, tables, target.as_ref())?;
    let unit = of.unit(map, &map.terms[0].name, found.channel, target.as_ref())?;
    Ok((found.table, values, unit))
}

/// The table with the most channels; of equal ones that with the most rows.
fn most_used(used: impl Iterator<Item = usize>, tables: &[&Table]) -> usize {
    let mut counts = vec![0_usize; tables.len()];
    used.for_each(|table| counts[table] += 1);
    (0..tables.len())
        .max_by_key(|&table| (counts[table], tables[table].rows, std::cmp::Reverse(table)))
        .unwrap_or(0)
}

/// The clocks of the tables that are used, with those of the distance.
fn clocks(
    of: &Of<'_>,
    tables: &[&Table],
    facts: &[(String, String)],
    used: impl Iterator<Item = usize>,
) -> Result<Vec<Option<Clock>>, Problem> {
    let mut wanted = vec![false; tables.len()];
    used.for_each(|table| wanted[table] = true);
    if let Some(
        Distance::Channel(map)
        | Distance::Speed { speed: map, .. }
        | Distance::Trigger { channel: map, .. },
    ) = &of.side.distance
    {
        for term in &map.terms {
            wanted[find::find(of, tables, &term.name, map.table.as_ref())?.table] = true;
        }
    }
    let alone = wanted.iter().filter(|wanted| **wanted).count() == 1;
    tables
        .iter()
        .zip(wanted)
        .map(|(table, wanted)| wanted.then(|| clock(of, table, alone, facts)).transpose())
        .collect()
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
fn turn(of: &Of<'_>, columns: &mut [Column], steps: &mut Vec<String>) {
    let Some(turning) = of
        .mapping
        .turning
        .as_ref()
        .filter(|_| of.side.turned.has(of.section, &of.mapping.sections))
    else {
        return;
    };
    let partner = |columns: &[Column], at: usize| {
        let partner = turning.partner(&columns[at].name);
        columns.iter().position(|column| column.name == partner).filter(|other| *other != at)
    };
    let (mut exchanged, mut reversed) = (0, 0);
    for at in 0..columns.len() {
        if let Some(other) = partner(columns, at) {
            exchanged += 1;
            // Each pair once.
            if let (before, [second, ..]) = columns.split_at_mut(at.max(other))
                && at < other
            {
                std::mem::swap(&mut before[at].values, &mut second.values);
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

/// Matches the distance with the track and adds the stated offset.
fn along_track(
    of: &Of<'_>,
    values: &mut [f64],
    matched: &[(usize, Vec<f64>, Unit)],
    clocks: &[Option<Clock>],
    (base, grid): (usize, &Grid),
    facts: &[(String, String)],
    steps: &mut Vec<String>,
) -> Result<(), Vec<Problem>> {
    if let Some(wanted) = &of.side.matched {
        let mut channels = Vec::new();
        for (table, values, _) in matched {
            let sampled = clocks[*table]
                .as_ref()
                .map(|clock| on_grid(values, clock, *table == base, grid, true));
            let values = sampled.unwrap_or_else(|| Err("has no time".into()));
            channels.push(
                values
                    .map_err(|why| {
                        vec![
                            Problem::error("uneven-time", format!("the channel matched {why}"))
                                .at(&wanted.span),
                        ]
                    })?
                    .0,
            );
        }
        let units: Vec<Unit> = matched.iter().map(|(.., unit)| unit.clone()).collect();
        let (shift, says) = distance::matched(of, wanted, values, &channels, &units)?;
        values.iter_mut().for_each(|value| *value += shift);
        steps.push(says);
    }
    let offset = of
        .side
        .offsets
        .as_ref()
        .map(|offsets| offsets.of(of.section, &of.mapping.sections, facts))
        .transpose();
    if let Some(offset) = offset?.flatten() {
        values.iter_mut().for_each(|value| *value += offset);
        steps.push(format!("{offset:+} m added to the distance (synchronisation)"));
    }
    Ok(())
}

/// Cuts the record, checks that its axes increase and that all values are there.
fn finish(
    of: &Of<'_>,
    grid: Grid,
    at: Option<Vec<f64>>,
    channels: Vec<Column>,
    mut steps: Vec<String>,
) -> Result<Made, Vec<Problem>> {
    let unit =
        |text: &str, dimension: Dimension| Unit { text: text.into(), factor: 1.0, dimension };
    let as_recorded = grid.rows.is_some();
    let (mut times, mut at, mut channels) = (grid.times, at, channels);
    let extent = of.mapping.sections.extent(of.section).filter(|_| at.is_some());
    let mut warnings = Vec::new();
    if let (Some((start, end)), Some(margin), Some(values)) = (extent, of.mapping.margin, &mut at) {
        let inside: Vec<usize> = (0..values.len())
            .filter(|&row| (start - margin..=end + margin).contains(&values[row]))
            .collect();
        let (Some(&first), Some(&last)) = (inside.first(), inside.last()) else {
            return Err(vec![outside(of, (start, end), values)]);
        };
        steps.push(format!(
            "cut to {margin} m before and after the section, {} rows",
            last + 1 - first
        ));
        times = times[first..=last].to_vec();
        *values = values[first..=last].to_vec();
        channels.iter_mut().for_each(|column| column.values.cut(first..last + 1));
    }
    warnings.extend(times::warning(of, &times).filter(|_| as_recorded));
    let time_of = |row: usize| short(times[row]);
    let mut faults = Vec::new();
    let mut columns = vec![Column {
        name: "time".into(),
        unit: unit("s", Dimension::TIME),
        values: Values::Held(times.clone()),
    }];
    columns.extend(at.clone().map(|values| Column {
        name: "distance".into(),
        unit: unit("m", Dimension::LENGTH),
        values: Values::Held(values),
    }));
    columns.extend(channels);
    for column in &columns {
        if let Some((row, missing)) = column.values.missing()? {
            let says = format!(
                "{}: `{}` has no value in {missing} of {} rows, first at {} s",
                of.called(),
                column.name,
                column.values.len(),
                time_of(row)
            );
            let place = of
                .side
                .channels
                .maps()
                .and_then(|maps| maps.iter().find(|map| map.name.value == column.name))
                .map_or(&of.side.span, |map| &map.name.span);
            faults.push(Problem::error("not-finite", says).at(place).help(
                "repair the record, leave the channel out, or cut the record: `margin: 60 m`",
            ));
        }
    }
    if let Some(values) = at.filter(|_| faults.is_empty()) {
        if let Some(row) = (1..values.len()).find(|&row| values[row] <= values[row - 1]) {
            let says = format!(
                "{}: the distance does not increase at {} s: {} m after {} m",
                of.called(),
                time_of(row),
                short(values[row]),
                short(values[row - 1])
            );
            let backwards = values[values.len() - 1] < values[0];
            let help = if backwards {
                "it falls along the record: reverse it, `distance: {from: ..., factor: -1, offset: ... m}`"
            } else {
                "cut off the standstill: `margin: 60 m`"
            };
            faults.push(Problem::error("axis-not-increasing", says).at(&of.side.span).help(help));
        } else if let Some((start, end)) =
            extent.filter(|(start, end)| *start < values[0] || *end > values[values.len() - 1])
        {
            let mut problem = outside(of, (start, end), &values);
            problem.severity = Severity::Warning;
            warnings.push(problem);
        }
        let ends = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
        steps.push(format!("distance {} m to {} m", short(ends.0), short(ends.1)));
    }
    if !faults.is_empty() {
        return Err(few(faults));
    }
    Ok(Made { kind: of.side.kind, section: of.section.to_string(), columns, steps, warnings })
}

fn outside(of: &Of<'_>, (start, end): (f64, f64), values: &[f64]) -> Problem {
    let (low, high) = values
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    let says = format!(
        "{}, {} to {} m, is not inside its {}, {} to {} m",
        of.called(),
        short(start),
        short(end),
        of.side.kind.key(),
        short(low),
        short(high)
    );
    let place =
        of.mapping.sections.cell(of.section, "start").map_or(&of.side.span, |cell| &cell.span);
    Problem::error("outside-record", says)
        .at(place)
        .help("check start and unit of the distance, and the table of sections")
}

fn few(mut faults: Vec<Problem>) -> Vec<Problem> {
    let more = faults.len().saturating_sub(MOST_TOLD);
    if more > 0 {
        faults.truncate(MOST_TOLD);
        faults.push(Problem::error(
            "more-problems",
            format!("{more} more channels have such a fault"),
        ));
    }
    faults
}

/// Six digits, for sentences.
pub fn short(value: f64) -> String {
    significant(value, 6).to_string()
}
