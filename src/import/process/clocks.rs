//! The clocks of the tables of a file as one.

use super::clock::{Clock, Zero, clock};
use super::recording::Recording;
use crate::foreign::NANOSECONDS;
use crate::problem::{Problem, error};

/// The clocks of the tables that are used, as one: their times count from the same zero.
///
/// # Errors
/// `time-missing`, `time-not-increasing`, `too-short`, `unknown-channel`, `unknown-table`,
/// `unit-missing`; of the shift `unknown-fact`, `wrong-number`. `start-missing`: it is not known when
/// one table starts on the clock of another.
pub fn clocks(recording: &Recording<'_>, used: &[bool]) -> Result<Vec<Option<Clock>>, Problem> {
    let alone = used.iter().filter(|used| **used).count() == 1;
    let tables = recording.tables.iter().zip(used);
    let mut clocks = tables
        .map(|(table, used)| used.then(|| clock(recording, table, alone)).transpose())
        .collect::<Result<Vec<_>, Problem>>()?;
    if alone {
        return Ok(clocks);
    }
    let zeros = || clocks.iter().flatten().map(|clock| clock.zero);
    let stamps =
        zeros().filter_map(|zero| if let Zero::Stamp(at) = zero { Some(at) } else { None });
    let first = stamps.min();
    let mut others = zeros().filter(|zero| !matches!(zero, Zero::Stamp(_)));
    if first.is_some() && others.next().is_some() || zeros().any(|zero| zero == Zero::Start) {
        return Err(start_missing(recording, &clocks));
    }
    let drift = recording.side.time.drift.0;
    for clock in clocks.iter_mut().flatten() {
        if let (Some(first), Zero::Stamp(at)) = (first, clock.zero) {
            clock.starts = at.saturating_sub(first) as f64 / NANOSECONDS as f64 / (1.0 + drift);
            clock.times.iter_mut().for_each(|time| *time += clock.starts);
        }
    }
    Ok(clocks)
}

/// The error that tables have no common clock: what each counts from.
fn start_missing(recording: &Recording<'_>, clocks: &[Option<Clock>]) -> Problem {
    let tables = || recording.tables.iter().zip(clocks);
    let counts = tables().filter_map(|(table, clock)| {
        let from = match clock.as_ref()?.zero {
            Zero::Stamp(_) => "a time of the calendar or of the day",
            Zero::Numbers => "the zero of its channel of time",
            Zero::Start => "its first sample",
        };
        Some(format!("`{}` from {from}", table.name))
    });
    let counts: Vec<String> = counts.take(MOST_TOLD).collect();
    let says = format!(
        "`{}`: it is not known when its tables start on one clock; their times count: {}",
        recording.shown,
        counts.join(", ")
    );
    let names = tables().filter(|(_, clock)| clock.is_some()).map(|(table, _)| &table.name);
    let starts: Vec<String> = names.take(MOST_TOLD).map(|name| format!("{name}: 0 s")).collect();
    error("start-missing", says, &recording.side.time.span).help(format!(
        "state it beside the rate: `time: {{starts: {{{}}}}}`; or write the channels of their times, `time: [NAME, NAME]`",
        starts.join(", ")
    ))
}

/// Tables that are named in a problem.
const MOST_TOLD: usize = 6;
