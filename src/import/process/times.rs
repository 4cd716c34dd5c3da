//! Gaps and uneven steps of the times of a file, and the account of what was done about rates.

use super::clock::{Clock, Gaps, Grid, How, way};
use super::find::Of;
use super::short;
use crate::data::checks::{self, Steps};
use crate::foreign::Table;
use crate::import::mapping::{ChannelMap, Distance};
use crate::problem::Problem;
use crate::source::{Span, Spanned};
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
    of: &Of<'_>,
    rate: &Spanned<Hertz>,
    base: &Clock,
    (start, end): (f64, f64),
) -> Option<Problem> {
    let Hertz(asked_rate) = rate.value;
    let asked = short(asked_rate);
    let (says, help) = if asked_rate > MOST_FINER * base.rate {
        let says = format!(
            "{}: a rate of {asked} Hz is more than {MOST_FINER} times that of `{}`, {} Hz",
            of.called(),
            of.shown,
            short(base.rate)
        );
        (says, "a rate above that of the file adds nothing to the records")
    } else if end > start && (end - start) * asked_rate < 1.0 {
        let says = format!(
            "{}: a rate of {asked} Hz leaves no two samples of the {} s of `{}`",
            of.called(),
            short(end - start),
            of.shown
        );
        (says, "write the rate of the records, such as `200 Hz`")
    } else {
        return None;
    };
    Some(Problem::error("out-of-range", says).at(&rate.span).help(help))
}

/// Times that do not allow what is asked for: a value in a gap would be invented, and a filter
/// needs even steps.
///
/// Problems: `gap`, `uneven-time`.
///
/// `has_channels`: whether channels of the campaign are made of a table, and not only an axis,
/// which is never filtered.
pub fn faults(
    of: &Of<'_>,
    tables: &[&Table],
    clocks: &[Option<Clock>],
    (base, grid): (usize, &Grid),
    has_channels: &dyn Fn(usize) -> bool,
) -> Vec<Problem> {
    let at = of.side.rate.as_ref().map_or(&of.side.time.span, |rate| &rate.span);
    let from_speed = matches!(of.side.distance, Some(Distance::Speed { .. }));
    let mut faults = Vec::new();
    for (number, (table, clock)) in tables.iter().zip(clocks).enumerate() {
        let Some(clock) = clock else { continue };
        let is_base = number == base;
        let way = way(clock, is_base, grid);
        let file = if table.name.is_empty() {
            of.shown.to_string()
        } else {
            format!("{}`, table `{}", of.shown, table.name)
        };
        match &clock.gaps {
            Some(gaps) if way != How::AsRecorded => {
                faults.push(gap(of, gaps, clock, &file, "resampled", at))
            }
            Some(gaps) if from_speed => {
                faults.push(gap(of, gaps, clock, &file, "integrated to a distance", at))
            }
            None if way == How::Filtered && !clock.even && has_channels(number) => {
                faults.push(uneven(of, clock, &file, grid.rate, at))
            }
            _ => {}
        }
    }
    faults
}

fn gap(of: &Of<'_>, gaps: &Gaps, clock: &Clock, file: &str, done: &str, at: &Span) -> Problem {
    let word = of.mapping.sections.word;
    let more = match gaps.count - 1 {
        0 => String::new(),
        1 => "; there is one more gap".to_string(),
        more => format!("; there are {more} more gaps"),
    };
    let says = format!(
        "{}: the time of `{file}` has a gap of {} s from {} s to {} s, after row {}, at {} Hz otherwise; nothing is {done} across a gap{more}",
        of.called(),
        short(gaps.to - gaps.from),
        short(gaps.from),
        short(gaps.to),
        gaps.row,
        short(checks::whole(clock.rate)),
    );
    let help = match word {
        "run" => {
            "split the file there, and import the parts before and after it as runs of their own"
        }
        _ => {
            "split the file there, and import the part that the section is in; or export the record without interruption"
        }
    };
    let problem = Problem::error("gap", says).at(at);
    // No whole sample is missing in a step that is shorter than two.
    if (gaps.to - gaps.from) * clock.rate < 2.0 {
        problem.help(stated(mean_rate(&clock.times), help))
    } else {
        problem.help(help)
    }
}

fn mean_rate(times: &[f64]) -> f64 {
    (times.len() - 1) as f64 / (times[times.len() - 1] - times[0])
}

fn uneven(of: &Of<'_>, clock: &Clock, file: &str, rate: f64, at: &Span) -> Problem {
    let says = format!(
        "{}: the time of `{file}` has steps of {}, and a filter to {} Hz needs even steps",
        of.called(),
        extent(&clock.times),
        short(rate)
    );
    Problem::error("uneven-time", says)
        .at(at)
        .help(stated(clock.rate, "export the record with a constant rate"))
}

/// The record of a campaign has even steps; otherwise `certify` refuses it. A gap is told by the
/// check of the campaign.
pub fn warning(of: &Of<'_>, times: &[f64]) -> Option<Problem> {
    if times.len() < 3 {
        return None;
    }
    let Steps { rate, gaps, uneven, .. } = checks::steps(times, 1.0);
    uneven.filter(|_| gaps.is_empty())?;
    let says = format!(
        "{}: the time of `{}` has steps of {}; an evaluation needs even steps",
        of.called(),
        of.shown,
        extent(times)
    );
    let rate = short(checks::whole(rate));
    let help = stated(
        checks::whole(rate.parse().unwrap_or(0.0)),
        &format!("interpolate to even steps: `rate: {rate} Hz` beside `time`"),
    );
    Some(Problem::warning("uneven-time", says).at(&of.side.time.span).help(help))
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
    format!("{} s to {} s", step_in_words(least), step_in_words(most))
}

/// Three digits: more of a step would be rounding.
fn step_in_words(step: f64) -> String {
    significant(step, 3).to_string()
}

/// The rows of a record and its rate.
pub fn told(of: &Of<'_>, base: &Clock, grid: &Grid, steps: &mut Vec<String>) {
    if of.side.time.drift.0 != 0.0 {
        steps.push(format!("time divided by 1 + {:.6} (drift of the clock)", of.side.time.drift.0));
    }
    if let Some(shift) = &of.side.time.shift {
        steps.push(format!("time shifted ({})", shift.from_where()));
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
        (None, How::Linear) if base.rate < grid.rate * (1.0 - super::clock::SAME_RATE) => {
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
    maps: &[ChannelMap],
    sampled: &[(How, usize)],
    clocks: &[Option<Clock>],
    (base, grid): (usize, &Grid),
    tables: &[&Table],
    steps: &mut Vec<String>,
) {
    if grid.rows.is_none() && sampled.iter().all(|(how, _)| *how == How::Filtered) {
        return;
    }
    for (number, table) in tables.iter().enumerate().filter(|(number, _)| *number != base) {
        for how in [How::Linear, How::Filtered] {
            let names: Vec<&str> = maps
                .iter()
                .zip(sampled)
                .filter(|(_, (its, of))| *its == how && *of == number)
                .map(|(map, _)| map.name.value.as_str())
                .collect();
            let (false, Some(clock)) = (names.is_empty(), &clocks[number]) else { continue };
            let way = if how == How::Linear {
                "interpolated linearly"
            } else {
                "filtered and interpolated (windowed sinc)"
            };
            let table = if table.name.is_empty() {
                String::new()
            } else {
                format!(" (table `{}`)", table.name)
            };
            steps.push(format!("{} {way} from {} Hz{table}", names.join(", "), short(clock.rate)));
        }
    }
}
