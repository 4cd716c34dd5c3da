//! Errors of calibration of the measured channels, and of their place.

use super::search::{Grid, round_step};
use crate::check::plan::Plan;
use crate::graph::Graph;
use crate::result::{
    Reason, Verdict,
    margin::{Changed, Margin},
};
use crate::run::{Change, Evaluated, Holding, Line, Lines, needs::needs};
use crate::units::Unit;

/// Step and largest change of a gain in per cent, and of an offset in per cent of the largest
/// value: a calibration that is farther off shows before a test.
const GAIN_STEP: f64 = 1.0;
const STEPS: f64 = 30.0;

/// Step of a shift as a share of the shortest section, and number of steps: farther than a fifth of
/// a section, what is evaluated is another place.
const SHIFT_STEP: f64 = 0.01;
const SHIFT_STEPS: f64 = 20.0;

/// A channel of the protocol as it is measured.
#[derive(Clone, Debug)]
pub struct Channel {
    pub name: String,
    pub unit: Unit,
    /// One for each position.
    pub columns: Vec<String>,
}

/// The measured channels that quantities depend on, in the order of the protocol.
pub fn channels(plan: &Plan, graph: &Graph) -> Vec<Channel> {
    let mut found: Vec<Channel> = Vec::new();
    let axes = [Some(&plan.axis), plan.time.as_ref()];
    for need in needs(plan, graph).channels {
        let axis = axes.iter().flatten().any(|axis| axis.column == need.column);
        let (Some(name), false) = (need.channel, axis || need.users.quantities.is_empty()) else {
            continue;
        };
        if need.record != "measured" {
            continue;
        }
        match found.iter_mut().find(|channel| channel.name == name) {
            Some(channel) => channel.columns.push(need.column),
            None => {
                let Ok(unit) = Unit::parse(&need.unit) else { continue };
                found.push(Channel { name, unit, columns: vec![need.column] });
            }
        }
    }
    found
}

/// The verdict of changed records, as long as every section is used that was.
fn verdict(plan: &Plan, base: &Evaluated, changed: &Evaluated) -> Result<Verdict, Reason> {
    let both = base.sections().zip(changed.sections());
    let lost = both.filter(|((_, before), _)| before.is_none()).find_map(|(_, (_, now))| now);
    match lost {
        Some(reason) => Err(reason.clone()),
        None => Ok(changed.judge(plan).verdict),
    }
}

/// The margins of every channel, and that of the place of the measurement.
pub fn margins(
    plan: &Plan,
    holding: &Holding<'_>,
    channels: &[Channel],
    (is, moves): (Verdict, bool),
    progress: &dyn Fn(&str),
) -> Vec<Margin> {
    let at = |change: Change<'_>| verdict(plan, holding.base, &holding.with(change));
    let mut margins = Vec::new();
    for channel in channels {
        let columns: Vec<String> =
            channel.columns.iter().filter(|name| holding.peak(name).is_some()).cloned().collect();
        let calibrated = |line: Line| {
            let lines: Lines = columns.iter().map(|name| (name.clone(), line)).collect();
            at(Change::Calibrated(&lines))
        };
        let peaks = columns.iter().filter_map(|name| holding.peak(name));
        let Some(peak) = peaks.reduce(f64::max).filter(|peak| *peak > 0.0) else { continue };
        progress(&channel.name);
        let gain =
            Margin { columns: columns.clone(), ..Margin::new(Changed::Gain, &channel.name, "%") };
        let most = GAIN_STEP * STEPS;
        let grid = Grid { below: most, above: most, step: GAIN_STEP, whole: false };
        let found = grid.margin(gain, is, &|change| {
            calibrated(Line { factor: 1.0 + change / 100.0, offset: 0.0 })
        });
        margins.push(found);
        let offset = Margin {
            columns: columns.clone(),
            ..Margin::new(Changed::Offset, &channel.name, &channel.unit.text)
        };
        let step = round_step(channel.unit.from_si(peak) / 100.0);
        let grid = Grid { below: STEPS * step, above: STEPS * step, step, whole: false };
        let found = grid.margin(offset, is, &|change| {
            calibrated(Line { factor: 1.0, offset: channel.unit.to_si(change) })
        });
        margins.push(found);
    }
    let axis = &plan.axis;
    if let Some(length) = holding.shortest().filter(|length| moves && *length > 0.0) {
        progress(&axis.column);
        let step = round_step(axis.unit.from_si(length) * SHIFT_STEP);
        let most = step * SHIFT_STEPS;
        let grid = Grid { below: most, above: most, step, whole: false };
        let shift = Margin::new(Changed::Shift, &axis.column, &axis.unit.text);
        margins.push(grid.margin(shift, is, &|change| at(Change::Moved(axis.unit.to_si(change)))));
    }
    margins
}
