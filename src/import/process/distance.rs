//! The distance of a record: from a channel, a speed or a trigger, and its match with the track
//! file.

use super::clock::Clock;
use super::recording::{Recording, Source};
use super::short;
use crate::data::record::{Record, Wanted, read_record};
use crate::import::mapping::{ChannelMap, Distance, Jumps, Match, Stated};
use crate::metrics::synchronise::{self, Estimate, Pair, Search};
use crate::metrics::{along, resample, statistics};
use crate::problem::{Problem, error};
use crate::units::{Dimension, Unit};
use crate::yaml::Metres;

/// Distance over time, both increasing or to be checked.
#[derive(Clone, Debug)]
pub struct Curve {
    pub clock: Clock,
    pub values: Vec<f64>,
    /// Number of the table, where the points are its rows.
    pub table: Option<usize>,
    pub says: String,
}

/// The distance as the mapping states it.
pub fn curve(
    recording: &Recording<'_>,
    distance: &Distance,
    clocks: &[Option<Clock>],
) -> Result<Curve, Problem> {
    let clock_of =
        |table: usize| clocks.get(table).cloned().flatten().ok_or_else(|| recording.time_missing());
    let start_of = |start: &Option<Stated<Metres>>| -> Result<(f64, String), Problem> {
        let Some(start) = start else { return Ok((0.0, String::new())) };
        let sections = &recording.mapping.sections;
        let value = start.value(recording.section, sections, &recording.facts)?;
        let value = value.ok_or_else(|| {
            let says =
                format!("no `start` is stated for {} `{}`", sections.word, recording.section);
            error("start-missing", says, &recording.side.span)
        })?;
        Ok((value, format!(" from {value} m ({})", start.from_where())))
    };
    match distance {
        Distance::Channel(map) => {
            let source = Source::find(recording, map, Some(&Unit::si(Dimension::LENGTH)))?;
            let (clock, mut values) = (clock_of(source.table)?, source.values(map));
            let mut says = format!("distance = {}", map.in_words());
            if let Some(Jumps::RunOn) = recording.side.jumps {
                says += &run_on(&clock.times, &mut values);
            }
            Ok(Curve { clock, values, table: Some(source.table), says })
        }
        Distance::Speed { speed, start } => {
            let per_second = Unit { text: "m/s".into(), ..Unit::si(Dimension::SPEED) };
            let source = Source::find(recording, speed, Some(&per_second))?;
            let clock = clock_of(source.table)?;
            let (start, from) = start_of(start)?;
            let mut values =
                along::integral(&clock.times, &source.values(speed)).unwrap_or_default();
            values.iter_mut().for_each(|value| *value += start);
            let says = format!(
                "distance = integral of {} over time (trapezoidal rule){from}",
                speed.in_words()
            );
            Ok(Curve { clock, values, table: Some(source.table), says })
        }
        Distance::Trigger { channel, every, threshold, start } => {
            let term = &channel.terms[0];
            let (table, recorded) = recording.find(&term.name, channel.table.as_ref())?;
            let clock = clock_of(table)?;
            let sign = if term.reversed { -1.0 } else { 1.0 } * channel.factor;
            let signal: Vec<f64> = recorded.values.iter().map(|value| sign * value).collect();
            let finite = signal.iter().filter(|value| value.is_finite());
            let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), value| {
                (low.min(*value), high.max(*value))
            });
            let level = threshold.unwrap_or((low + high) / 2.0);
            let times = crossings(&clock.times, &signal, level);
            let pulses = times.len();
            if pulses < 2 {
                let says = format!(
                    "`{}` rises through {level} {pulses} times; two pulses are needed at least",
                    term.name.value
                );
                return Err(recording
                    .fault("no-pulses", &says, &term.name.span)
                    .help("state the level: `threshold`"));
            }
            let (start, from) = start_of(start)?;
            let values = (0..pulses).map(|pulse| start + pulse as f64 * every).collect();
            let says = format!(
                "distance = {every} m for each of {pulses} pulses of {} (level {level}){from}; linear between pulses",
                channel.in_words()
            );
            Ok(Curve { clock: Clock::of_events(times), values, table: None, says })
        }
    }
}

/// Fastest that a vehicle runs on rails, in m/s; the record is 603 km/h (2015), which is 167.5 m/s. A
/// distance that goes on faster jumps, as kilometre posts do where a line was rebuilt.
const FASTEST: f64 = 200.0;
/// Jumps that are told with their places.
const JUMPS_TOLD: usize = 5;

/// The rows at which a distance jumps, forward or back.
pub fn jumps<'a>(times: &'a [f64], values: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
    (1..values.len().min(times.len())).filter(|&row| {
        (values[row] - values[row - 1]).abs() > FASTEST * (times[row] - times[row - 1])
    })
}

/// Makes a distance go on at its jumps with the step before; tells where.
fn run_on(times: &[f64], values: &mut [f64]) -> String {
    let rows: Vec<usize> = jumps(times, values).collect();
    let as_read = values.to_vec();
    let (mut moved, mut left) = (0.0, rows.iter().peekable());
    for row in 1..values.len() {
        if left.next_if(|jump| **jump == row).is_some() {
            let step = if row > 1 { values[row - 1] - values[row - 2] } else { 0.0 };
            moved = values[row - 1] + step - as_read[row];
        }
        values[row] = as_read[row] + moved;
    }
    let told = rows.iter().take(JUMPS_TOLD).map(|&row| {
        let [before, after] = [as_read[row - 1], as_read[row]].map(short);
        format!("{before} m to {after} m at {} s", short(times[row]))
    });
    let told = told.collect::<Vec<_>>().join(", ");
    match rows.len() {
        0 => "; it does not jump".into(),
        1 => format!("; it jumps from {told}, and runs on there"),
        count => format!("; it jumps {count} times, from {told}, and runs on there"),
    }
}

/// Times at which a signal rises through a level, linear between samples.
fn crossings(times: &[f64], signal: &[f64], level: f64) -> Vec<f64> {
    let rises = |at: &usize| signal[at - 1] < level && signal[*at] >= level;
    (1..signal.len().min(times.len()))
        .filter(rises)
        .map(|at| {
            let share = (level - signal[at - 1]) / (signal[at] - signal[at - 1]);
            times[at - 1] + share * (times[at] - times[at - 1])
        })
        .collect()
}

/// Smallest correlation of the matched channels with the track for the match to count. Curvature of
/// a sound record agrees with the track file to 0.95 and more.
const LEAST_CORRELATION: f64 = 0.8;
/// Steps of the search up to its largest move; the search refines the best one by a factor of five.
const STEPS: f64 = 100.0;

/// The move that is to be added to the distance of a record for its channels to agree with the
/// track file, and what was found. `channels`: each with its unit, in the order of the match.
pub fn matched(
    recording: &Recording<'_>,
    wanted: &Match,
    distance: &[f64],
    channels: &[(Vec<f64>, Unit)],
) -> Result<(f64, String), Vec<Problem>> {
    let mapping = recording.mapping;
    let Some(pattern) = &mapping.track else {
        let says = "a distance is matched with the track file, and the mapping names none";
        let problem = error("key-missing", says, &wanted.span);
        return Err(problem.help("write `track: track/{section}.csv`").into());
    };
    let place = mapping.place_of(pattern, recording.section)?;
    let shown = place.shown.as_str();
    let mut columns = vec![Wanted::new("distance", Dimension::LENGTH)];
    columns.extend(
        wanted
            .channels
            .iter()
            .zip(channels)
            .map(|(map, (_, unit))| Wanted::new(map.name.value.as_str(), unit.dimension)),
    );
    let track = read_record(&place.path, shown, &columns)?;
    let at = &track.columns[0].values;
    let estimate = |channels: &[Vec<f64>], search: &Search| {
        let both = track.columns[1..].iter().zip(channels).enumerate();
        let pairs: Vec<Pair<'_>> = both
            .map(|(group, (column, channel))| Pair {
                simulated: (at, &column.values),
                measured: (distance, channel),
                group,
            })
            .collect();
        synchronise::estimate(&pairs, search)
    };
    let ends =
        |axis: &[f64]| (axis.first().copied().unwrap_or(0.0), axis.last().copied().unwrap_or(0.0));
    let ((track_start, track_end), (start, end)) = (ends(at), ends(distance));
    // The record must cover the range compared at every move.
    let search = Search {
        start: track_start.max(start + wanted.within),
        end: track_end.min(end - wanted.within),
        farthest: wanted.within,
        step: wanted.within / STEPS,
    };
    let names =
        wanted.channels.iter().map(|map| map.name.value.as_str()).collect::<Vec<_>>().join(", ");
    let none = |says: String| Err(recording.fault("no-match", &says, &wanted.span).into());
    let opposite = |map: &ChannelMap| {
        let (name, term) = (&map.name.value, &map.terms[0].name);
        let says = format!("`{name}` of the record has the sign opposite to the track file");
        let problem = recording.fault("no-match", &says, &term.span);
        Err(problem.help(format!("reverse it: `{name}: -{}`", term.value)).into())
    };
    let agrees = |found: &Estimate| found.correlation >= LEAST_CORRELATION;
    let recorded: Vec<Vec<f64>> = channels.iter().map(|(values, _)| values.clone()).collect();
    let found = estimate(&recorded, &search);
    if !found.as_ref().is_some_and(agrees) {
        let mut reversed = recorded.clone();
        reversed.iter_mut().flatten().for_each(|value| *value = -*value);
        if let Some(map) = wanted.channels.first()
            && estimate(&reversed, &search).as_ref().is_some_and(agrees)
        {
            return opposite(map);
        }
    }
    let Some(Estimate { shift, low, high, correlation }) = found else {
        return none(format!(
            "{names} of the record and of `{shown}` do not agree at any move up to {} m, or best at the largest",
            wanted.within
        ));
    };
    if correlation < LEAST_CORRELATION {
        return none(format!(
            "the correlation of {names} with `{shown}` is {correlation:.2} at best; at least {LEAST_CORRELATION} is needed"
        ));
    }
    let moved: Vec<f64> = distance.iter().map(|at| at + shift).collect();
    if let Some(number) = reversed(&track, &moved, &recorded) {
        return opposite(&wanted.channels[number]);
    }
    let says = format!(
        "distance moved by {shift:+.2} m to match {names} with the track file (95 % interval {low:+.2} to {high:+.2} m, correlation {correlation:.3})"
    );
    Ok((shift, says))
}

/// Of several channels, the number of one that has the sign opposite to the track, at the distances
/// of the record.
fn reversed(track: &Record, distance: &[f64], channels: &[Vec<f64>]) -> Option<usize> {
    let (at, columns) = track.columns.split_first()?;
    let reach = distance[0]..=distance[distance.len() - 1];
    let inside: Vec<f64> = at.values.iter().copied().filter(|at| reach.contains(at)).collect();
    columns.iter().zip(channels).position(|(column, channel)| {
        let of_track =
            resample::interpolate(&at.values, &column.values, &inside).unwrap_or_default();
        let of_record = resample::interpolate(distance, channel, &inside).unwrap_or_default();
        statistics::correlation(&of_track, &of_record).is_some_and(|found| found < 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_timed_between_samples() {
        let times: Vec<f64> = (0..100).map(|at| f64::from(at) * 0.01).collect();
        let signal: Vec<f64> = (0..100).map(|at| if at % 10 < 5 { 0.0 } else { 5.0 }).collect();
        let found = crossings(&times, &signal, 2.5);
        assert_eq!(found.len(), 10);
        assert!((found[0] - 0.045).abs() < 1e-12 && (found[1] - found[0] - 0.1).abs() < 1e-12);
        assert!(crossings(&times, &[f64::NAN; 100], 0.0).is_empty());
    }
}
