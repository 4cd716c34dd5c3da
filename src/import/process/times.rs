//! Gaps and uneven steps of the times of a file, and the account of what was done about rates.

use super::clock::{Clock, Gaps, How, SAME_RATE, mean_rate, way};
use super::recording::Recording;
use super::{Sampling, short};
use crate::data::checks::{self, Steps};
use crate::import::mapping::{ChannelMap, Distance};
use crate::problem::{Problem, Severity};
use crate::source::Spanned;
use crate::units::number::significant;
use crate::yaml::Hertz;

/// Most samples that are made for each one of the file. Interpolation adds nothing to a record but
/// its size.
const MOST_FINER: f64 = 20.0;

/// A rate that is no rate of these records: so high that they would fill the memory, or so low that
/// no two samples are left.
///
/// Problems: `out-of-range`.
pub fn impossible(
    recording: &Recording<'_>,
    rate: &Spanned<Hertz>,
    base: &Clock,
    (start, end): (f64, f64),
) -> Option<Problem> {
    let Hertz(asked) = rate.value;
    let (says, help) = if asked > MOST_FINER * base.rate {
        let says = format!(
            "a rate of {} Hz is more than {MOST_FINER} times that of `{}`, {} Hz",
            short(asked),
            recording.shown,
            short(base.rate)
        );
        (says, "a rate above that of the file adds nothing to the records")
    } else if end > start && (end - start) * asked < 1.0 {
        let says = format!(
            "a rate of {} Hz leaves no two samples of the {} s of `{}`",
            short(asked),
            short(end - start),
            recording.shown
        );
        (says, "write the rate of the records, such as `200 Hz`")
    } else {
        return None;
    };
    Some(recording.fault("out-of-range", &says, &rate.span).help(help))
}

/// Times that do not allow what is asked for: a value in a gap would be invented, and a filter
/// needs even steps.
///
/// Problems: `gap`, `uneven-time`.
///
/// `has_channels`: whether channels of the campaign are made of a table, and not only an axis,
/// which is never filtered.
pub fn faults(
    recording: &Recording<'_>,
    sampling: &Sampling,
    has_channels: &dyn Fn(usize) -> bool,
) -> Vec<Problem> {
    let side = recording.side;
    let at = side.rate.as_ref().map_or(&side.time.span, |rate| &rate.span);
    let from_speed = matches!(side.distance, Some(Distance::Speed { .. }));
    let grid = &sampling.grid;
    let mut faults = Vec::new();
    for (number, (table, clock)) in recording.tables.iter().zip(&sampling.clocks).enumerate() {
        let Some(clock) = clock else { continue };
        let way = way(clock, number == sampling.base, grid);
        let file = match table.name.as_str() {
            "" => recording.shown.to_string(),
            name => format!("{}`, table `{name}", recording.shown),
        };
        let done = match way {
            _ if clock.gaps.is_none() => None,
            How::AsRecorded => from_speed.then_some("integrated to a distance"),
            _ => Some("resampled"),
        };
        let (code, says, help) = match (&clock.gaps, done) {
            (Some(gaps), Some(done)) => {
                let (says, help) = gap(recording, gaps, clock, &file, done);
                ("gap", says, help)
            }
            (None, _) if way == How::Filtered && !clock.even && has_channels(number) => {
                let says = format!(
                    "the time of `{file}` has steps of {}, and a filter to {} Hz needs even steps",
                    extent(&clock.times),
                    short(grid.rate)
                );
                let help = stated(clock.rate, "export the record with a constant rate");
                ("uneven-time", says, help)
            }
            _ => continue,
        };
        faults.push(recording.fault(code, &says, at).help(help));
    }
    faults
}

/// What is wrong about a gap, and the help.
fn gap(
    recording: &Recording<'_>,
    gaps: &Gaps,
    clock: &Clock,
    file: &str,
    done: &str,
) -> (String, String) {
    let more = match gaps.count - 1 {
        0 => String::new(),
        1 => "; there is one more gap".to_string(),
        more => format!("; there are {more} more gaps"),
    };
    let says = format!(
        "the time of `{file}` has a gap of {} s from {} s to {} s, after row {}, at {} Hz otherwise; nothing is {done} across a gap{more}",
        short(gaps.to - gaps.from),
        short(gaps.from),
        short(gaps.to),
        gaps.row,
        short(checks::whole(clock.rate)),
    );
    let help = match recording.mapping.sections.word {
        "run" => {
            "split the file there, and import the parts before and after it as runs of their own"
        }
        _ => {
            "split the file there, and import the part that the section is in; or export the record without interruption"
        }
    };
    // No whole sample is missing in a step that is shorter than two.
    if (gaps.to - gaps.from) * clock.rate < 2.0 {
        (says, stated(mean_rate(&clock.times), help))
    } else {
        (says, help.to_string())
    }
}

/// The record of a campaign has even steps; otherwise `certify` refuses it. A gap is told by the
/// check of the campaign.
pub fn warning(recording: &Recording<'_>, times: &[f64]) -> Option<Problem> {
    if times.len() < 3 {
        return None;
    }
    let Steps { rate, gaps, uneven, .. } = checks::steps(times, 1.0);
    uneven.filter(|_| gaps.is_empty())?;
    let says = format!(
        "the time of `{}` has steps of {}; an evaluation needs even steps",
        recording.shown,
        extent(times)
    );
    let rate = short(checks::whole(rate));
    let help = stated(
        checks::whole(rate.parse().unwrap_or(0.0)),
        &format!("interpolate to even steps: `rate: {rate} Hz` beside `time`"),
    );
    let problem = recording.fault("uneven-time", &says, &recording.side.time.span).help(help);
    Some(Problem { severity: Severity::Warning, ..problem })
}

/// What to do about uneven stamps.
fn stated(rate: f64, otherwise: &str) -> String {
    let rate = short(checks::whole(rate));
    format!(
        "if the recorder sampled evenly and only the stamps are inexact, state its rate: `time: {{rate: {rate} Hz}}`; else {otherwise}"
    )
}

/// `0.0041 s to 0.0062 s`
fn extent(times: &[f64]) -> String {
    let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
    let (least, most) =
        steps.fold((f64::MAX, f64::MIN), |(least, most), step| (least.min(step), most.max(step)));
    // Three digits: more of a step would be rounding.
    format!("{} s to {} s", significant(least, 3), significant(most, 3))
}

/// The rows of a record and its rate.
pub fn told(recording: &Recording<'_>, sampling: &Sampling, steps: &mut Vec<String>) {
    let Some(base) = &sampling.clocks[sampling.base] else { return };
    let (time, grid) = (&recording.side.time, &sampling.grid);
    if time.drift.0 != 0.0 {
        steps.push(format!("time divided by 1 + {:.6} (drift of the clock)", time.drift.0));
    }
    if let Some(shift) = &time.shift {
        steps.push(format!("time shifted ({})", shift.from_where()));
    }
    for (table, clock) in recording.tables.iter().zip(&sampling.clocks) {
        if let Some(starts) = clock.as_ref().map(|clock| clock.starts).filter(|at| *at > 0.0) {
            let name = &table.name;
            steps.push(format!("table `{name}` starts {} s after the first", short(starts)));
        }
        if let Some(events) = clock.as_ref().map(|clock| clock.events).filter(|count| *count > 0) {
            steps.push(format!("{events} rows have the time of the row after them (events of a simulation), which counts"));
        }
    }
    let (count, rate, to) = (grid.times.len(), short(base.rate), short(grid.rate));
    steps.push(match (&grid.rows, way(base, true, grid)) {
        (Some(rows), _) => {
            let (before, after) = (rows.start, base.times.len() - rows.end);
            let dropped = if before + after == 0 {
                String::new()
            } else {
                format!(", without {before} rows at the start and {after} at the end that other channels do not cover")
            };
            format!("{count} rows at {} Hz{dropped}", short(grid.rate))
        }
        (None, How::Linear) if base.rate < grid.rate * (1.0 - SAME_RATE) => {
            format!("resampled from {rate} Hz to {to} Hz, {count} rows (interpolated linearly)")
        }
        (None, How::Linear) => {
            let uneven = extent(&base.times);
            format!("brought to even steps of {to} Hz, {count} rows (interpolated linearly): the time had steps of {uneven}")
        }
        (None, _) => {
            let cutoff = short(crate::metrics::sinc::CUTOFF * grid.rate.min(base.rate));
            format!("resampled from {rate} Hz to {to} Hz, {count} rows (windowed sinc, -6 dB at {cutoff} Hz)")
        }
    });
}

/// Channels of other tables than the base, of which [`told`] says what was done.
pub fn told_tables(
    recording: &Recording<'_>,
    maps: &[ChannelMap],
    sampled: &[(How, usize)],
    sampling: &Sampling,
    steps: &mut Vec<String>,
) {
    if sampling.grid.rows.is_none() && sampled.iter().all(|(how, _)| *how == How::Filtered) {
        return;
    }
    let tables = recording.tables.iter().zip(&sampling.clocks).enumerate();
    for (number, (table, clock)) in tables.filter(|(number, _)| *number != sampling.base) {
        for (how, way) in [
            (How::Linear, "interpolated linearly"),
            (How::Filtered, "filtered and interpolated (windowed sinc)"),
        ] {
            let mapped = maps.iter().zip(sampled).filter(|(_, sampled)| **sampled == (how, number));
            let names: Vec<&str> = mapped.map(|(map, _)| map.name.value.as_str()).collect();
            let (false, Some(clock)) = (names.is_empty(), clock) else { continue };
            let table = match table.name.as_str() {
                "" => String::new(),
                name => format!(" (table `{name}`)"),
            };
            steps.push(format!("{} {way} from {} Hz{table}", names.join(", "), short(clock.rate)));
        }
    }
}
