//! The distance of a record: from a channel, a speed or a trigger, and its match with the track
//! file.

use super::clock::Clock;
use super::find::{Found, Of, find};
use crate::data::record::{Column, Wanted, read_record};
use crate::foreign::{Channel, Table};
use crate::import::mapping::{ChannelMap, Distance, Match, Stated};
use crate::metrics::synchronise::{self, Estimate, Pair, Search};
use crate::metrics::{along, resample, statistics};
use crate::problem::Problem;
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
    of: &Of<'_>,
    distance: &Distance,
    tables: &[&Table],
    clocks: &[Option<Clock>],
    facts: &[(String, String)],
) -> Result<Curve, Problem> {
    let start_of = |start: &Option<Stated<Metres>>| -> Result<(f64, String), Problem> {
        let Some(start) = start else { return Ok((0.0, String::new())) };
        let value = start.of(of.section, &of.mapping.sections, facts)?;
        let Some(value) = value else {
            return Err(Problem::error(
                "start-missing",
                format!("no `start` is stated for {}", of.called()),
            )
            .at(&of.side.span));
        };
        Ok((value, format!(" from {value} m ({})", start.from_where())))
    };
    let metre = Unit { text: "m".into(), factor: 1.0, dimension: Dimension::LENGTH };
    match distance {
        Distance::Channel(map) => {
            let (found, values) = values(of, map, tables, Some(&metre))?;
            let clock = need(of, clocks, found)?;
            let says = format!("distance = {}", map.in_words());
            Ok(Curve { clock, values, table: Some(found.table), says })
        }
        Distance::Speed { speed, start } => {
            let per_second = Unit {
                text: "m/s".into(),
                factor: 1.0,
                dimension: Dimension::LENGTH / Dimension::TIME,
            };
            let (found, values) = values(of, speed, tables, Some(&per_second))?;
            let clock = need(of, clocks, found)?;
            let (start, from) = start_of(start)?;
            let mut values = along::integral(&clock.times, &values).unwrap_or_default();
            values.iter_mut().for_each(|value| *value += start);
            let says = format!(
                "distance = integral of {} over time (trapezoidal rule){from}",
                speed.in_words()
            );
            Ok(Curve { clock, values, table: Some(found.table), says })
        }
        Distance::Trigger { channel, every, threshold, start } => {
            let found = find(of, tables, &channel.terms[0].name, channel.table.as_ref())?;
            let clock = need(of, clocks, found)?;
            let sign = if channel.terms[0].reversed { -1.0 } else { 1.0 } * channel.factor;
            let signal: Vec<f64> = found.channel.values.iter().map(|value| sign * value).collect();
            let (low, high) = signal
                .iter()
                .filter(|value| value.is_finite())
                .fold((f64::MAX, f64::MIN), |(low, high), value| {
                    (low.min(*value), high.max(*value))
                });
            let level = threshold.unwrap_or((low + high) / 2.0);
            let times = crossings(&clock.times, &signal, level);
            if times.len() < 2 {
                let says = format!(
                    "{}: `{}` rises through {level} {} times; two pulses are needed at least",
                    of.called(),
                    channel.terms[0].name.value,
                    times.len()
                );
                return Err(Problem::error("no-pulses", says)
                    .at(&channel.terms[0].name.span)
                    .help("state the level: `threshold`"));
            }
            let (start, from) = start_of(start)?;
            let values = (0..times.len()).map(|pulse| start + pulse as f64 * every).collect();
            let says = format!(
                "distance = {every} m for each of {} pulses of {} (level {level}){from}; linear between pulses",
                times.len(),
                channel.in_words()
            );
            Ok(Curve { clock: Clock::of_events(times), values, table: None, says })
        }
    }
}

fn need(of: &Of<'_>, clocks: &[Option<Clock>], found: Found<'_>) -> Result<Clock, Problem> {
    clocks.get(found.table).cloned().flatten().ok_or_else(|| {
        Problem::error("time-missing", format!("`{}` has no time", of.shown)).at(&of.side.time.span)
    })
}

/// The channels of a file that a channel of the campaign is made of, all in one table.
#[derive(Debug)]
pub struct Source<'a> {
    pub first: Found<'a>,
    /// Each with its unit and its sign.
    terms: Vec<(&'a Channel, Unit, f64)>,
}

impl<'a> Source<'a> {
    /// Finds the channels and their units.
    pub fn find(
        of: &Of<'_>,
        map: &ChannelMap,
        tables: &[&'a Table],
        wanted: Option<&Unit>,
    ) -> Result<Self, Problem> {
        let mut source: Option<Self> = None;
        for term in &map.terms {
            let found = find(of, tables, &term.name, map.table.as_ref())?;
            let unit = of.unit(map, &term.name, found.channel, wanted)?;
            let source = source.get_or_insert(Self { first: found, terms: Vec::new() });
            if source.first.table != found.table {
                let says = format!(
                    "`{}` is a sum of channels of different tables: `{}` and `{}`",
                    map.name.value, tables[source.first.table].name, tables[found.table].name
                );
                return Err(Problem::error("sum-of-tables", says).at(&term.name.span));
            }
            source.terms.push((found.channel, unit, if term.reversed { -1.0 } else { 1.0 }));
        }
        source
            .ok_or_else(|| Problem::error("key-missing", "no channel is stated").at(&map.name.span))
    }

    /// The values in SI.
    pub fn values(&self, map: &ChannelMap) -> Vec<f64> {
        let mut sum: Vec<f64> = Vec::new();
        for (number, (channel, unit, sign)) in self.terms.iter().enumerate() {
            let values = channel.values.iter().map(|value| sign * unit.to_si(*value));
            match number {
                0 => sum = values.collect(),
                _ => sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value),
            }
        }
        let offset = map.offset.as_ref().map_or(0.0, |offset| offset.value.si);
        if map.factor != 1.0 || offset != 0.0 {
            sum.iter_mut().for_each(|value| *value = map.factor * *value + offset);
        }
        sum
    }
}

/// The values of a channel in SI in its own table, and where the first of its terms is.
pub fn values<'a>(
    of: &Of<'_>,
    map: &ChannelMap,
    tables: &[&'a Table],
    wanted: Option<&Unit>,
) -> Result<(Found<'a>, Vec<f64>), Problem> {
    let source = Source::find(of, map, tables, wanted)?;
    Ok((source.first, source.values(map)))
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
/// track file, and what was found.
pub fn matched(
    of: &Of<'_>,
    wanted: &Match,
    distance: &[f64],
    channels: &[Vec<f64>],
    units: &[Unit],
) -> Result<(f64, String), Vec<Problem>> {
    let mapping = of.mapping;
    let Some(pattern) = &mapping.track else {
        let problem = Problem::error(
            "key-missing",
            "a distance is matched with the track file, and the mapping names none",
        )
        .at(&wanted.span);
        return Err(vec![problem.help("write `track: track/{section}.csv`")]);
    };
    let (path, shown) = mapping.place(&mapping.sections.fill(&pattern.value, of.section));
    let mut columns = vec![Wanted::new("distance", Dimension::LENGTH)];
    columns.extend(
        wanted
            .channels
            .iter()
            .zip(units)
            .map(|(map, unit)| Wanted::new(map.name.value.as_str(), unit.dimension)),
    );
    let track = read_record(&path, &shown, &columns)?;
    let at = &track.columns[0].values;
    let estimate = |channels: &[Vec<f64>], search: &Search| {
        let both = track.columns[1..].iter().zip(channels).enumerate();
        let pair = |(group, (column, channel))| {
            let (column, channel): (&Column, &Vec<f64>) = (column, channel);
            Pair { simulated: (at, &column.values), measured: (distance, channel), group }
        };
        let pairs: Vec<Pair<'_>> = both.map(pair).collect();
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
    let none = |says: String| {
        Err(vec![Problem::error("no-match", format!("{}: {says}", of.called())).at(&wanted.span)])
    };
    let opposite = |map: &ChannelMap| {
        let says = format!(
            "{}: `{}` of the record has the sign opposite to the track file",
            of.called(),
            map.name.value
        );
        let (name, term) = (&map.name.value, &map.terms[0].name);
        vec![
            Problem::error("no-match", says)
                .at(&term.span)
                .help(format!("reverse it: `{name}: -{}`", term.value)),
        ]
    };
    let found = estimate(channels, &search);
    if found.is_none_or(|found| found.correlation < LEAST_CORRELATION) {
        let reversed: Vec<Vec<f64>> =
            channels.iter().map(|channel| channel.iter().map(|value| -value).collect()).collect();
        if let Some(map) = wanted.channels.first()
            && estimate(&reversed, &search)
                .is_some_and(|found| found.correlation >= LEAST_CORRELATION)
        {
            return Err(opposite(map));
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
    // Of several channels, one may be reversed.
    let moved: Vec<f64> = distance.iter().map(|at| at + shift).collect();
    for (map, (column, channel)) in
        wanted.channels.iter().zip(track.columns[1..].iter().zip(channels))
    {
        let inside: Vec<f64> = at
            .iter()
            .copied()
            .filter(|at| (moved[0]..=moved[moved.len() - 1]).contains(at))
            .collect();
        let of_track = resample::interpolate(at, &column.values, &inside).unwrap_or_default();
        let of_record = resample::interpolate(&moved, channel, &inside).unwrap_or_default();
        if statistics::correlation(&of_track, &of_record)
            .is_some_and(|correlation| correlation < 0.0)
        {
            return Err(opposite(map));
        }
    }
    let says = format!(
        "distance moved by {shift:+.2} m to match {names} with the track file (95 % interval {low:+.2} to {high:+.2} m, correlation {correlation:.3})"
    );
    Ok((shift, says))
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
