//! Time of a table, and the grid of a record.

use std::ops::Range;

use super::recording::{Recording, nearest_or_first, two_units};
use super::short;
use crate::data::checks::{self, Steps};
use crate::foreign::{Channel, Table};
use crate::metrics::{resample, sinc};
use crate::problem::{Problem, error};
use crate::source::Spanned;
use crate::units::{Dimension, Unit};
use crate::yaml::Quantity;

/// A rate within this share of another is the same: rates are rounded, and clocks differ by less
/// than 0.01 %.
pub const SAME_RATE: f64 = 1e-3;
/// Largest deviation of a time from even steps, as a share of a step, for a filter to apply. Times
/// rounded to milliseconds at 200 Hz deviate by a tenth.
const EVEN: f64 = 0.2;

/// What the times of a table count from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// A time in ns, of the calendar or of the day.
    Stamp(i64),
    /// That of the channels of time of other tables.
    Numbers,
    /// The first sample, whose time nothing states.
    Start,
}

/// The times of a table in s, increasing, and its rate.
#[derive(Clone, Debug)]
pub struct Clock {
    pub times: Vec<f64>,
    /// The mean rate; with gaps that of the usual step.
    pub rate: f64,
    /// Whether a filter applies.
    pub even: bool,
    /// Whether the steps differ by more than a record of a campaign may have.
    pub uneven: bool,
    pub gaps: Option<Gaps>,
    pub zero: Zero,
    /// Of several tables: seconds from the first that starts.
    pub starts: f64,
    /// Rows that had the time of the row after them.
    pub events: usize,
}

/// Where time has gaps, as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaps {
    /// Row of the file before the first gap, and the times in s before and after it.
    pub row: usize,
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

impl Clock {
    /// Times of events, which have no steps: two at least.
    pub fn of_events(times: Vec<f64>) -> Self {
        let rate = mean_rate(&times);
        Self {
            times,
            rate,
            even: false,
            uneven: true,
            gaps: None,
            zero: Zero::Numbers,
            starts: 0.0,
            events: 0,
        }
    }
}

/// The times of a table, with the shift and the drift of the mapping. `alone`: no other table is
/// used.
pub fn clock(recording: &Recording<'_>, table: &Table, alone: bool) -> Result<Clock, Problem> {
    let time = &recording.side.time;
    let which =
        if table.name.is_empty() { String::new() } else { format!(", table `{}`", table.name) };
    let file = format!("`{}`{which}", recording.shown);
    let named = |name: &str| table.channels.iter().find(|channel| channel.name == name);
    let found = time.from.0.iter().find_map(|name| Some((name, named(&name.value)?)));
    let mut factor = 1.0;
    let zero;
    let mut times: Vec<f64> = match (found, time.from.0.first()) {
        (Some((name, channel)), _) => {
            let unit = time_unit(recording, channel).map_err(|(code, says)| {
                error(code, says, &name.span)
                    .help(format!("write its unit: `time: {{from: {}, unit: s}}`", name.value))
            })?;
            factor = unit.factor;
            zero = channel.since.map_or(Zero::Numbers, Zero::Stamp);
            channel.values.iter().map(|value| unit.to_si(*value)).collect()
        }
        (None, Some(first)) => return Err(no_time(table, first, &file)),
        (None, None) => {
            // Several tables have their own rates; of one, the mapping knows better than the file.
            let stated = time.rate.map(Quantity::si);
            let rate = if alone { stated.or(table.rate) } else { table.rate.or(stated) };
            let Some(rate) = rate.filter(|rate| *rate > 0.0) else {
                let says = format!("{file} states neither a time nor a sampling rate");
                return Err(error("time-missing", says, &time.span).help(
                    "write `time: NAME`, the channel of the time, or `time: {rate: 200 Hz}`",
                ));
            };
            let start = starts(recording, table)?;
            zero = match (start, table.start) {
                (Some(_), _) => Zero::Numbers,
                (None, Some(at)) => Zero::Stamp(at),
                (None, None) => Zero::Start,
            };
            (0..table.rows).map(|row| row as f64 / rate + start.unwrap_or(0.0)).collect()
        }
    };
    let events = if recording.side.rate.is_some() { events(&mut times) } else { 0 };
    increasing(recording, table, &times, &file)?;
    // Before a shift, which would hide that the stamps are rounded.
    let Steps { usual, gaps, uneven, .. } = checks::steps(&times, factor);
    let gaps = gaps.first().map(|&at| Gaps {
        row: table.first_row + at,
        from: times[at],
        to: times[at + 1],
        count: gaps.len(),
    });
    let shift = match &time.shift {
        Some(shift) => {
            shift.value(recording.section, &recording.mapping.sections, &recording.facts)?
        }
        None => None,
    };
    let shift = shift.unwrap_or(0.0);
    times.iter_mut().for_each(|at| *at = *at / (1.0 + time.drift.0) + shift);
    let first = times[0];
    let rate =
        if gaps.is_some() || events > 0 { (1.0 + time.drift.0) / usual } else { mean_rate(&times) };
    let even = times
        .iter()
        .enumerate()
        .all(|(at, time)| (time - (first + at as f64 / rate)).abs() * rate <= EVEN);
    let uneven = uneven.is_some() || gaps.is_some() || events > 0;
    Ok(Clock { times, rate, even, uneven, gaps, zero, starts: 0.0, events })
}

/// Samples per second of times, two at least.
pub fn mean_rate(times: &[f64]) -> f64 {
    (times.len() - 1) as f64 / (times[times.len() - 1] - times[0])
}

/// The unit of a channel of time: as stated, else as the file has it.
///
/// # Errors
/// Code and text: it has none of time, or two.
fn time_unit(recording: &Recording<'_>, channel: &Channel) -> Result<Unit, (&'static str, String)> {
    if let Some(unit) = &recording.side.time.unit {
        return Ok(unit.value.clone());
    }
    if let Some(says) = two_units(channel, recording.shown) {
        return Err(("unit-conflict", says));
    }
    let text = channel.unit.as_deref().map(str::trim).filter(|text| !text.is_empty());
    let unit = text.and_then(|text| recording.stated_unit(text).or_else(|| Unit::parse(text).ok()));
    unit.filter(|unit| unit.dimension == Dimension::TIME).ok_or_else(|| {
        let has = text.map_or_else(|| "no unit".into(), |text| format!("the unit `{text}`"));
        let says = format!("`{}`: the time `{}` has {has}", recording.shown, channel.name);
        ("unit-missing", says)
    })
}

/// None of the names of the time is in a table.
fn no_time(table: &Table, first: &Spanned<String>, file: &str) -> Problem {
    if let Some((_, why)) = table.left_out.iter().find(|(name, _)| *name == first.value) {
        let says = format!("{file}: `{}` is no channel: {why}", first.value);
        return error("no-channel", says, &first.span);
    }
    let known = table.channels.iter().map(|channel| channel.name.as_str());
    let says = format!("{file} has no channel `{}`", first.value);
    let problem = error("unknown-channel", says, &first.span);
    let near = problem.clone().suggest(&first.value, known.clone());
    match near.near {
        Some(_) => near,
        None if table.name.is_empty() => nearest_or_first(problem, &first.value, known),
        None => problem.help("where the groups of a file call their time differently, list the names: `time: [Time, t_slow]`"),
    }
}

fn increasing(
    recording: &Recording<'_>,
    table: &Table,
    times: &[f64],
    file: &str,
) -> Result<(), Problem> {
    if times.len() < 2 {
        let says = format!("{file} has {} samples", times.len());
        return Err(error("too-short", says, &recording.side.files.span));
    }
    let Some(at) = (0..times.len())
        .find(|&at| !times[at].is_finite() || (at > 0 && times[at] <= times[at - 1]))
    else {
        return Ok(());
    };
    let row = table.first_row + at;
    let is = if times[at].is_finite() { "does not increase" } else { "has no value" };
    let says = format!("{file}: the time {is} in row {row}");
    let problem = error("time-not-increasing", says, &recording.side.time.span);
    Err(match rounded(times) {
        Some(rate) => problem.help(format!(
            "the stamps are rounded, so that several samples have the same; state the rate of the recorder: `time: {{rate: {rate} Hz}}`"
        )),
        None => problem.help("export a record without interruption, or repair its time"),
    })
}

/// By which share of a step the row before an event comes before its time.
const BEFORE_AN_EVENT: f64 = 1e-6;

/// Rows that have the time of the row after them, as simulation programs write an event: before and
/// after it. The row before comes a little earlier, so that the later one counts.
fn events(times: &mut [f64]) -> usize {
    if rounded(times).is_some() {
        return 0;
    }
    let mut found = 0;
    let mut later = f64::NAN;
    for at in (0..times.len()).rev() {
        let time = times[at];
        if time == later {
            let step = match at.checked_sub(1) {
                Some(before) => time - times[before],
                None => times.get(at + 2).map_or(0.0, |next| next - time),
            };
            times[at] = times[at + 1] - (BEFORE_AN_EVENT * step).max(f64::MIN_POSITIVE);
            found += 1;
        }
        later = time;
    }
    found
}

/// The rate of a record whose stamps are rounded so coarsely that samples have the same one, in Hz:
/// of every ten samples one at least.
fn rounded(times: &[f64]) -> Option<f64> {
    const SAMPLES_FOR_EACH: usize = 10;
    let stamps: Vec<f64> = times.iter().copied().filter(|time| time.is_finite()).collect();
    let steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let same = steps.iter().filter(|step| **step == 0.0).count();
    if steps.iter().any(|step| *step < 0.0) || same * SAMPLES_FOR_EACH < stamps.len() {
        return None;
    }
    // Whole stretches of equal stamps: the first and the last may be cut.
    let starts: Vec<usize> =
        (0..steps.len()).filter(|at| steps[*at] > 0.0).map(|at| at + 1).collect();
    let (first, last) = (*starts.first()?, *starts.last()?);
    let rate = (last - first) as f64 / (stamps[last] - stamps[first]);
    (rate.is_finite() && rate > 0.0).then(|| checks::whole(short(rate).parse().unwrap_or(rate)))
}

/// The points in time of a record.
#[derive(Clone, Debug)]
pub struct Grid {
    pub times: Vec<f64>,
    pub rate: f64,
    /// The rows of the base table that these are; absent for another rate.
    pub rows: Option<Range<usize>>,
}

fn same_rate(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() <= SAME_RATE
}

/// The grid inside a span: the samples of the base table, or even steps of a wanted rate, also
/// where its samples are uneven.
pub fn grid(base: &Clock, wanted: Option<f64>, (start, end): (f64, f64)) -> Option<Grid> {
    /// Rounding of times, in s.
    const ROUNDING: f64 = 1e-9;
    match wanted.filter(|rate| base.uneven || !same_rate(*rate, base.rate)) {
        None => {
            let from = base.times.partition_point(|time| *time < start - ROUNDING);
            let to = base.times.partition_point(|time| *time <= end + ROUNDING);
            (from + 1 < to).then(|| Grid {
                times: base.times[from..to].to_vec(),
                rate: base.rate,
                rows: Some(from..to),
            })
        }
        Some(rate) => {
            let steps = ((end - start) * rate + 1e-6).floor();
            // A step that is wrong by orders of magnitude gives an error instead of filling the
            // memory.
            (1.0..1e8).contains(&steps).then(|| Grid {
                times: (0..=steps as usize).map(|at| start + at as f64 / rate).collect(),
                rate,
                rows: None,
            })
        }
    }
}

/// How a signal came to the points of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    AsRecorded,
    /// Filtered and interpolated by a windowed sinc.
    Filtered,
    /// Linear between samples.
    Linear,
}

/// How the channels of a table come to the points of the grid.
///
/// A slow channel is interpolated linearly; one of the same rate as well if only its steps are
/// uneven.
pub fn way(clock: &Clock, is_base: bool, grid: &Grid) -> How {
    let uneven = || grid.rows.is_none() && clock.uneven && same_rate(clock.rate, grid.rate);
    match &grid.rows {
        Some(_) if is_base || sampled_at(clock, grid).is_some() => How::AsRecorded,
        _ if clock.rate < grid.rate * (1.0 - SAME_RATE) || uneven() => How::Linear,
        _ => How::Filtered,
    }
}

/// The rows of a table that are sampled at the points of the grid.
fn sampled_at(clock: &Clock, grid: &Grid) -> Option<Range<usize>> {
    /// Difference of two times that are the same, as a share of a step: the rounding of doubles.
    const SAME: f64 = 1e-6;
    let most = SAME / grid.rate;
    let first = grid.times.first()?;
    let from = clock.times.partition_point(|time| *time < first - most);
    let times = clock.times.get(from..from + grid.times.len())?;
    let same = times.iter().zip(&grid.times).all(|(one, other)| (one - other).abs() <= most);
    same.then(|| from..from + grid.times.len())
}

/// A signal at the points of the grid. An axis is always interpolated linearly, and then increases.
///
/// # Errors
/// A reason, to follow the name of the channel.
pub fn on_grid(
    values: &[f64],
    clock: &Clock,
    is_base: bool,
    grid: &Grid,
    axis: bool,
) -> Result<(Vec<f64>, How), String> {
    if let Some(of_base) = &grid.rows
        && let Some(rows) = if is_base { Some(of_base.clone()) } else { sampled_at(clock, grid) }
    {
        return Ok((values[rows].to_vec(), How::AsRecorded));
    }
    if axis || way(clock, is_base, grid) == How::Linear {
        let (first, last) = (clock.times[0], clock.times[clock.times.len() - 1]);
        let points: Vec<f64> = grid.times.iter().map(|time| time.clamp(first, last)).collect();
        return resample::interpolate(&clock.times, values, &points)
            .map(|values| (values, How::Linear))
            .map_err(|error| error.to_string());
    }
    if !clock.even {
        return Err(
            "has uneven steps in time and cannot be resampled; export it with a constant rate"
                .into(),
        );
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(format!("has no value in sample {}, and cannot be filtered", at + 1));
    }
    let last = (values.len() - 1) as f64;
    let points: Vec<f64> = grid
        .times
        .iter()
        .map(|time| ((time - clock.times[0]) * clock.rate).clamp(0.0, last))
        .collect();
    sinc::interpolate(values, &points, grid.rate / clock.rate)
        .map(|values| (values, How::Filtered))
        .ok_or_else(|| "is too short to be resampled".into())
}

/// When a table starts, as the mapping states it.
pub fn starts(recording: &Recording<'_>, table: &Table) -> Result<Option<f64>, Problem> {
    let starts = &recording.side.time.starts.0;
    let known = || recording.tables.iter().map(|table| table.name.as_str());
    if let Some((key, _)) = starts.iter().find(|(key, _)| !known().any(|name| name == key.text)) {
        let says = format!("`{}` has no table `{}`", recording.shown, key.text);
        return Err(error("unknown-table", says, &key.span).suggest(&key.text, known()));
    }
    Ok(starts.iter().find(|(key, _)| key.text == table.name).map(|(_, start)| start.si()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(rate: f64, samples: usize) -> Clock {
        Clock {
            times: (0..samples).map(|at| at as f64 / rate).collect(),
            rate,
            even: true,
            uneven: false,
            gaps: None,
            zero: Zero::Numbers,
            starts: 0.0,
            events: 0,
        }
    }

    #[test]
    fn slow_channels_are_linear_and_fast_ones_filtered() {
        let base = clock(200.0, 401);
        let grid = grid(&base, None, (0.0, 1.0)).expect("a grid");
        assert_eq!((grid.times.len(), grid.rows.clone()), (201, Some(0..201)));
        let slow = clock(20.0, 41);
        let line: Vec<f64> = slow.times.iter().map(|time| 3.0 * time).collect();
        let (found, how) = on_grid(&line, &slow, false, &grid, false).expect("inside");
        assert_eq!(how, How::Linear);
        assert!((found[7] - 3.0 * 0.035).abs() < 1e-12);
        let fast = clock(1000.0, 2001);
        let (found, how) = on_grid(&vec![2.0; 2001], &fast, false, &grid, false).expect("inside");
        assert!(how == How::Filtered && found.iter().all(|value| (value - 2.0).abs() < 1e-12));
        assert_eq!(
            on_grid(&vec![1.0; 401], &base, true, &grid, false).map(|(_, how)| how),
            Ok(How::AsRecorded)
        );
        let uneven = Clock { even: false, ..clock(1000.0, 2001) };
        assert!(
            on_grid(&vec![2.0; 2001], &uneven, false, &grid, false)
                .is_err_and(|says| says.contains("uneven"))
        );
    }

    #[test]
    fn a_wanted_rate_makes_even_steps() {
        let base = clock(600.0, 1201);
        let other = grid(&base, Some(200.0), (0.0, 2.0)).expect("a grid");
        assert_eq!((other.times.len(), other.rows), (401, None));
        // The same rate within a thousandth is kept as recorded.
        assert_eq!(grid(&base, Some(600.1), (0.0, 2.0)).and_then(|grid| grid.rows), Some(0..1201));
        assert!(
            grid(&base, Some(1e12), (0.0, 2.0)).is_none()
                && grid(&base, None, (5.0, 6.0)).is_none()
        );
    }

    #[test]
    fn uneven_samples_of_the_wanted_rate_come_to_even_steps() {
        let mut base = clock(200.0, 401);
        base.times.iter_mut().enumerate().for_each(|(at, time)| *time += 1e-3 * (at as f64).sin());
        base.uneven = true;
        assert!(grid(&base, None, (0.0, 2.0)).is_some_and(|grid| grid.rows.is_some()));
        let even = grid(&base, Some(200.0), (0.1, 1.9)).expect("a grid");
        assert_eq!(
            (even.times.len(), even.rows.clone(), way(&base, true, &even)),
            (361, None, How::Linear)
        );
        let line: Vec<f64> = base.times.iter().map(|time| 3.0 * time).collect();
        let (found, _) = on_grid(&line, &base, true, &even, false).expect("inside");
        assert!(
            found.iter().zip(&even.times).all(|(value, time)| (value - 3.0 * time).abs() < 1e-12)
        );
    }

    #[test]
    fn rounded_stamps_tell_the_rate() {
        let stamps = |rate: f64, to: f64| {
            (0..2000)
                .map(|at| (f64::from(at) / rate / to + 1e-9).floor() * to)
                .collect::<Vec<f64>>()
        };
        assert_eq!(
            (rounded(&stamps(200.0, 1.0)), rounded(&stamps(300.0, 0.01))),
            (Some(200.0), Some(300.0))
        );
        let mut twice = stamps(200.0, 0.005);
        twice[7] = twice[6];
        assert_eq!((rounded(&twice), rounded(&[1.0; 20])), (None, None));
    }
}
