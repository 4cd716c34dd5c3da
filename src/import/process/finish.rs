//! The record of a section, cut and checked.

use super::clock::Grid;
use super::recording::Recording;
use super::{Column, Made, Values, distance, few, short, times};
use crate::import::mapping::Distance;
use crate::problem::{Problem, Severity, error};
use crate::units::{Dimension, Unit};

/// Cuts the record, checks that its axes increase and that all values are there. `at`: its
/// distance.
pub fn finish(
    recording: &Recording<'_>,
    Grid { mut times, rows, .. }: Grid,
    mut at: Option<Vec<f64>>,
    mut channels: Vec<Column>,
    mut steps: Vec<String>,
) -> Result<Made, Vec<Problem>> {
    let side = recording.side;
    let extent = recording.mapping.sections.extent(recording.section).filter(|_| at.is_some());
    if let (Some((start, end)), Some(margin), Some(values)) =
        (extent, recording.mapping.margin, &mut at)
    {
        let reach = start - margin..=end + margin;
        let is_inside = |value: &f64| reach.contains(value);
        let (Some(first), Some(last)) =
            (values.iter().position(is_inside), values.iter().rposition(is_inside))
        else {
            return Err(outside(recording, (start, end), values).into());
        };
        steps.push(format!(
            "cut to {margin} m before and after the section, {} rows",
            last + 1 - first
        ));
        times = times[first..=last].to_vec();
        *values = values[first..=last].to_vec();
        channels.iter_mut().for_each(|column| column.values.cut(first..last + 1));
    }
    let mut warnings = Vec::new();
    if rows.is_some() {
        warnings.extend(times::warning(recording, &times));
    }
    let axis = |name: &str, dimension: Dimension, values: &Vec<f64>| Column {
        name: name.into(),
        unit: Unit::si(dimension),
        values: Values::Held(values.clone()),
    };
    let mut columns = vec![axis("time", Dimension::TIME, &times)];
    columns.extend(at.as_ref().map(|values| axis("distance", Dimension::LENGTH, values)));
    columns.extend(channels);
    let mut faults = missing(recording, &columns, &times)?;
    if let Some(values) = at.filter(|_| faults.is_empty()) {
        let (first, last) =
            (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(0.0));
        let is_channel = matches!(side.distance, Some(Distance::Channel(_)));
        let mut jumps = distance::jumps(&times, &values).filter(|_| is_channel);
        if let Some(row) = jumps.next() {
            let says = format!(
                "the distance jumps at {} s, from {} m to {} m{}",
                short(times[row]),
                short(values[row - 1]),
                short(values[row]),
                match jumps.count() {
                    0 => String::new(),
                    more => format!(", and {more} more times"),
                }
            );
            let help = "kilometre posts jump where a line was rebuilt: `distance: {from: ..., jumps: run on}` goes on with the distance before, and sections after the jump are given by that";
            faults.push(recording.fault("distance-jumps", &says, &side.span).help(help));
        } else if let Some(row) = (1..values.len()).find(|&row| values[row] <= values[row - 1]) {
            let says = format!(
                "the distance does not increase at {} s: {} m after {} m",
                short(times[row]),
                short(values[row]),
                short(values[row - 1])
            );
            let help = if last < first {
                "it falls along the record: reverse it, `distance: {from: ..., factor: -1, offset: ... m}`"
            } else {
                "cut off the standstill: `margin: 60 m`"
            };
            faults.push(recording.fault("axis-not-increasing", &says, &side.span).help(help));
        } else if let Some(extent) = extent.filter(|(start, end)| *start < first || *end > last) {
            let problem = outside(recording, extent, &values);
            warnings.push(Problem { severity: Severity::Warning, ..problem });
        }
        steps.push(format!("distance {} m to {} m", short(first), short(last)));
    }
    if !faults.is_empty() {
        return Err(few(faults));
    }
    let section = recording.section.to_string();
    Ok(Made { kind: side.kind, section, columns, steps, warnings })
}

/// Columns without a value in some of their rows.
fn missing(
    recording: &Recording<'_>,
    columns: &[Column],
    times: &[f64],
) -> Result<Vec<Problem>, Problem> {
    let side = recording.side;
    let mut faults = Vec::new();
    for column in columns {
        let Some((row, missing)) = column.values.missing()? else { continue };
        let says = format!(
            "`{}` has no value in {missing} of {} rows, first at {} s",
            column.name,
            column.values.len(),
            short(times[row])
        );
        let mut maps = side.channels.maps().unwrap_or_default().iter();
        let map = maps.find(|map| map.name.value == column.name);
        let place = map.map_or(&side.span, |map| &map.name.span);
        let help = "repair the record, leave the channel out, or cut the record: `margin: 60 m`";
        faults.push(recording.fault("not-finite", &says, place).help(help));
    }
    Ok(faults)
}

fn outside(recording: &Recording<'_>, (start, end): (f64, f64), values: &[f64]) -> Problem {
    let (low, high) = values
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    let (sections, section) = (&recording.mapping.sections, recording.section);
    let says = format!(
        "{} `{section}`, {} to {} m, is not inside its {}, {} to {} m",
        sections.word,
        short(start),
        short(end),
        recording.side.kind.key(),
        short(low),
        short(high)
    );
    let cell = sections.cell(section, "start");
    error("outside-record", says, cell.map_or(&recording.side.span, |cell| &cell.span))
        .help("check start and unit of the distance, and the table of sections")
}
