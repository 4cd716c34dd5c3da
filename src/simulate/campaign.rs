//! Records of a campaign as signals, and signals as records of a campaign.

use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};

use super::section::Section;
use crate::data::{
    Campaign, RecordKind,
    campaign::ReadFile,
    checks,
    record::{Format, Frame, Record, RecordSource, Wanted},
    write::{Digits, OutColumn, record},
};
use crate::effects::{Channel, Signals};
use crate::problem::Problem;
use crate::units::{Dimension, Unit};

/// Units of channels, by name.
pub type Units = Vec<(String, Unit)>;

/// Column with the time.
const TIME: &str = "time";
/// Column with the axis of a record; the time if it is missing.
const AXIS: &str = "distance";

/// A record of a section with all its channels, each in its own unit, and those units.
///
/// # Errors
/// As [`Campaign::read`]; the record has no `time`.
pub fn recorded(
    campaign: &Campaign,
    kind: RecordKind,
    section: &Section,
) -> Result<(Signals, Units, ReadFile), Vec<Problem>> {
    let (record, file) = whole(campaign, kind, section)?;
    let (signals, units) = signals(&record)?;
    Ok((signals, units, file))
}

/// As [`recorded`], of a record that has the whole section.
///
/// # Errors
/// As [`recorded`]; `section-reversed`, `outside-record`, `section-empty`.
pub fn recorded_inside(
    campaign: &Campaign,
    kind: RecordKind,
    section: &Section,
) -> Result<(Signals, Units), Vec<Problem>> {
    let (record, _) = whole(campaign, kind, section)?;
    let found = signals(&record)?;
    let axis = record
        .column(AXIS)
        .or_else(|| record.column(TIME))
        .filter(|_| section.start.is_finite() && section.end.is_finite());
    if let Some(axis) = axis {
        let wanted = checks::Section {
            start: section.start,
            end: section.end,
            at: Some(section.cell.span.clone()),
        };
        checks::check_section(&record, axis, &wanted)?;
    }
    Ok(found)
}

fn whole(
    campaign: &Campaign,
    kind: RecordKind,
    section: &Section,
) -> Result<(Record, ReadFile), Vec<Problem>> {
    campaign.file_for_each_section()?;
    let headings = campaign.record_source(kind, &section.cell)?.headings()?;
    campaign.read(kind.into(), &section.cell, &Wanted::all(&headings), None)
}

/// As [`recorded`], of a record that need not be in a campaign.
///
/// # Errors
/// Of reading; the record has no `time`.
pub fn signals_of(source: &RecordSource) -> Result<(Signals, Units), Vec<Problem>> {
    let headings = source.headings()?;
    signals(&source.read(&Wanted::all(&headings))?)
}

fn signals(record: &Record) -> Result<(Signals, Units), Vec<Problem>> {
    let Some(time) = record.column(TIME) else {
        let problem =
            Problem::error("missing-channel", format!("{} has no column `{TIME}`", record.shown));
        return Err(vec![problem.suggest(TIME, record.channels.iter().map(String::as_str))]);
    };
    let span =
        time.values.last().zip(time.values.first()).map_or(0.0, |(last, first)| last - first);
    if record.rows < 2 || span <= 0.0 {
        return Err(vec![Problem::error(
            "too-short",
            format!("{} has {} samples: too few", record.shown, record.rows),
        )]);
    }
    let over_time = record.column(AXIS).is_none();
    let axis = record.column(AXIS).unwrap_or(time);
    let mut units = Vec::new();
    let mut channels = Vec::new();
    for column in record.columns.iter().filter(|column| column.name != TIME && column.name != AXIS)
    {
        let values = column.values.iter().map(|value| column.unit.from_si(*value)).collect();
        channels.push(Channel { name: column.name.clone(), values });
        units.push((column.name.clone(), column.unit.clone()));
    }
    Ok((
        Signals {
            axis: axis.values.clone(),
            over_time,
            rate: (record.rows - 1) as f64 / span,
            channels,
        },
        units,
    ))
}

/// Converts channels to other units; those for which `to` has none are unchanged.
///
/// # Errors
/// `unit-mismatch`: a channel has another dimension.
pub fn in_units(
    signals: &mut Signals,
    units: &Units,
    to: &dyn Fn(&str) -> Option<Unit>,
) -> Result<(), Problem> {
    for channel in &mut signals.channels {
        let from = units.iter().find(|(name, _)| *name == channel.name).map(|(_, unit)| unit);
        let (Some(from), Some(to)) = (from, to(&channel.name)) else { continue };
        if from.dimension != to.dimension {
            let says = format!(
                "the channel `{}` is in {from}, which cannot be converted to {to}",
                channel.name
            );
            return Err(Problem::error("unit-mismatch", says));
        }
        if from.factor != to.factor {
            channel.values.iter_mut().for_each(|value| *value = to.from_si(from.to_si(*value)));
        }
    }
    Ok(())
}

/// The columns with the axes of a record: time and distance, or the time alone if it is the axis.
fn axes(signals: &Signals) -> Vec<(&'static str, Unit, Vec<f64>)> {
    let (second, metre) = (Unit::si(Dimension::TIME), Unit::si(Dimension::LENGTH));
    if signals.over_time {
        return vec![(TIME, second, signals.axis.clone())];
    }
    let time = (0..signals.axis.len()).map(|n| n as f64 / signals.rate).collect();
    vec![(TIME, second, time), (AXIS, metre, signals.axis.clone())]
}

/// The columns that [`record_file`] writes, with their headings. Nothing is rounded.
///
/// # Errors
/// A value is not finite, which is a fault of the simulator.
pub fn columns(
    name: &str,
    signals: &Signals,
    units: &dyn Fn(&str) -> Unit,
) -> Result<Vec<(String, Vec<f64>)>, Problem> {
    let heading = |name: &str, unit: &Unit| format!("{name} [{unit}]");
    let axes = axes(signals).into_iter().map(|(name, unit, values)| (heading(name, &unit), values));
    let channels = signals.channels.iter();
    let channels =
        channels.map(|Channel { name, values }| (heading(name, &units(name)), values.clone()));
    let columns: Vec<(String, Vec<f64>)> = axes.chain(channels).collect();
    match columns.iter().find(|(_, values)| values.iter().any(|value| !value.is_finite())) {
        None => Ok(columns),
        Some((column, _)) => Err(Problem::error(
            "not-finite",
            format!("`{column}` of `{name}` has a value that is not finite"),
        )),
    }
}

/// A record in memory, with the [`columns`] of its signals.
///
/// # Errors
/// As [`columns`].
pub fn frame(
    name: &str,
    signals: &Signals,
    units: &dyn Fn(&str) -> Unit,
) -> Result<Frame, Problem> {
    let arrays = columns(name, signals, units)?
        .into_iter()
        .map(|(name, values)| (name, Arc::new(Float64Array::from(values)) as ArrayRef));
    let batch = RecordBatch::try_from_iter(arrays)
        .map_err(|error| Problem::error("record-invalid", format!("`{name}`: {error}")))?;
    let schema = batch.schema();
    Frame::new(name, &schema, vec![batch])
}

/// Decimals of the time in s at a sampling rate in Hz: three, or more where the step needs them.
fn decimals_of(rate: f64) -> usize {
    const MOST: usize = 9;
    let whole = |decimals: &usize| {
        let step = 10_f64.powi(*decimals as i32) / rate;
        (step - step.round()).abs() < 1e-9 * step
    };
    (3..MOST).find(whole).unwrap_or(MOST)
}

/// Zeros after the decimal point of the largest value.
fn leading_zeros(values: &[f64]) -> usize {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest > 0.0 && largest < 0.1 {
        (-largest.log10()).floor().min(Digits::MOST as f64 / 2.0) as usize
    } else {
        0
    }
}

/// A record as a file: time from 0 and distance, or the time alone if it is the axis; forces in kN
/// to 0.01, accelerations in m/s^2 to 0.0001, all other channels to six decimals; a channel that
/// stays below 0.1 with more, so that no digits are lost.
///
/// # Errors
/// A value is not finite, which is a fault of the simulator; detected before any file is written.
pub fn record_file(
    format: Format,
    signals: &Signals,
    units: &dyn Fn(&str) -> Unit,
) -> Result<Vec<u8>, Problem> {
    let units: Vec<Unit> = signals.channels.iter().map(|channel| units(&channel.name)).collect();
    let values: Vec<Vec<f64>> = signals
        .channels
        .iter()
        .zip(&units)
        .map(|(channel, unit)| channel.values.iter().map(|value| unit.to_si(*value)).collect())
        .collect();
    let of_time = decimals_of(signals.rate);
    let decimals = if signals.over_time { [6.max(of_time), 0] } else { [of_time, 3] };
    let axes = axes(signals);
    let mut columns: Vec<OutColumn<'_>> = axes
        .iter()
        .zip(decimals)
        .map(|((name, unit, values), decimals)| OutColumn { name, unit, values, decimals })
        .collect();
    for ((channel, unit), values) in signals.channels.iter().zip(&units).zip(&values) {
        let decimals = match unit.text.as_str() {
            "kN" => 2,
            "m/s^2" => 4,
            _ => 6,
        } + leading_zeros(&channel.values);
        columns.push(OutColumn { name: &channel.name, unit, values, decimals });
    }
    record(format, &columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small signals keep their digits; the step of the time is exact at any rate that divides a
    /// power of ten.
    #[test]
    fn decimals_follow_the_values() {
        assert_eq!(
            [0.0, 0.1, 25.0, 0.099, 0.01, 5e-3, 1.98e-8].map(|value| leading_zeros(&[0.0, -value])),
            [0, 0, 0, 1, 2, 2, 7]
        );
        assert_eq!([200.0, 1000.0, 400.0, 256.0, 300.0].map(decimals_of), [3, 3, 4, 8, 9]);
        let channel = Channel { name: "force".into(), values: vec![0.0, 1.986_693_31e-8, -4e-9] };
        let signals = Signals {
            axis: vec![0.0, 0.0025, 0.005],
            rate: 400.0,
            over_time: true,
            channels: vec![channel],
        };
        let written = record_file(Format::Csv, &signals, &|_| Unit::parse("N").expect("a unit"))
            .expect("written");
        let text = String::from_utf8(written).expect("text");
        assert_eq!(text.lines().nth(2), Some("0.002500,0.0000000198669"), "{text}");
    }
}
