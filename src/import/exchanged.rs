//! Channels that were exchanged: a measured channel that agrees with another simulated channel much
//! better than with its own.

use rayon::prelude::*;

use super::mapping::Mapping;
use crate::data::record::{Record, Wanted};
use crate::data::{Campaign, RecordKind};
use crate::metrics::resample::{interpolate, uniform_grid};
use crate::metrics::statistics::correlation;
use crate::problem::{Problem, warning};
use crate::source::Spanned;
use crate::units::Dimension;

/// Step of the comparison in m: shorter than the waves that simulation and measurement have in
/// common.
const STEP: f64 = 0.25;
/// Correlation with another channel from which on an exchange is possible, and by how much it must
/// exceed that with its own. The forces of neighbouring wheels are related: in sound records the
/// difference stays below 0.2.
const LEAST: f64 = 0.5;
const MORE: f64 = 0.4;

/// Correlations of one measured channel with the simulated ones of its dimension, in one section.
type Row = Vec<Option<f64>>;

/// A warning for each channel that agrees better with another one in most sections.
pub fn exchanged(mapping: &Mapping, campaign: &Campaign) -> Vec<Problem> {
    let maps = |kind: RecordKind| mapping.side(kind).and_then(|side| side.channels.maps());
    let (Some(measured), Some(simulated)) =
        (maps(RecordKind::Measurement), maps(RecordKind::Simulation))
    else {
        return Vec::new();
    };
    let names = measured.iter().map(|map| &map.name);
    let both: Vec<&Spanned<String>> =
        names.filter(|name| simulated.iter().any(|other| other.name.value == name.value)).collect();
    let sections: Vec<Vec<Row>> = campaign
        .names
        .par_iter()
        .filter_map(|section| correlations(mapping, campaign, section, &both))
        .collect();
    let suspected = |(own, name): (usize, &&Spanned<String>)| {
        let told: Vec<Better> =
            sections.iter().filter_map(|rows| better(own, &rows[own])).collect();
        // The channel named most often, in more than half of the sections.
        let with = |at: usize| told.iter().filter(move |better| better.other == at);
        let most = (0..both.len()).max_by_key(|at| with(*at).count())?;
        let count = with(most).count();
        let mean = |value: fn(&Better) -> f64| with(most).map(value).sum::<f64>() / count as f64;
        let other = both[most];
        let says = format!(
            "the measured `{}` agrees with the simulated `{}` (correlation {:.2}) better than with its own ({:.2}), in {count} of {} sections",
            name.value,
            other.value,
            mean(|better| better.with_other),
            mean(|better| better.with_own),
            sections.len()
        );
        (2 * count > sections.len()).then(|| {
            warning("exchanged", says, &name.span)
                .also(&other.span, "the other channel")
                .help("check whether the two channels are exchanged in one of the records")
        })
    };
    both.iter().enumerate().filter_map(suspected).collect()
}

/// A channel that agrees better with another one than with its own, with both correlations.
struct Better {
    other: usize,
    with_other: f64,
    with_own: f64,
}

fn better(own: usize, row: &Row) -> Option<Better> {
    let with_own = row[own]?;
    let others = row.iter().enumerate().filter(|(at, _)| *at != own);
    let (other, with_other) = others
        .filter_map(|(at, value)| Some((at, (*value)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    (with_other > LEAST && with_other > with_own + MORE).then_some(Better {
        other,
        with_other,
        with_own,
    })
}

/// The correlations of all channels in a section; `None` if its records cannot be compared.
fn correlations(
    mapping: &Mapping,
    campaign: &Campaign,
    section: &Spanned<String>,
    both: &[&Spanned<String>],
) -> Option<Vec<Row>> {
    let mut wanted = vec![Wanted::new("distance", Dimension::LENGTH)];
    wanted.extend(both.iter().map(|name| Wanted {
        name: name.value.clone(),
        dimension: None,
        required: true,
    }));
    let read = |kind: RecordKind| -> Option<Record> {
        Some(campaign.read(kind.into(), section, &wanted, None).ok()?.0)
    };
    let (measured, simulated) = (read(RecordKind::Measurement)?, read(RecordKind::Simulation)?);
    let ends = |record: &Record| {
        let axis = &record.columns[0].values;
        axis.first().copied().zip(axis.last().copied())
    };
    let (one, other) = (ends(&measured)?, ends(&simulated)?);
    let (start, end) = mapping.sections.extent(&section.value).unwrap_or((f64::MIN, f64::MAX));
    let grid =
        uniform_grid(start.max(one.0).max(other.0), end.min(one.1).min(other.1), STEP).ok()?;
    let on_grid = |record: &Record| -> Option<Vec<(Dimension, Vec<f64>)>> {
        let (axis, channels) = record.columns.split_first()?;
        let resampled = channels.iter().map(|column| {
            let values = interpolate(&axis.values, &column.values, &grid).ok()?;
            Some((column.unit.dimension, values))
        });
        resampled.collect()
    };
    let (measured, simulated) = (on_grid(&measured)?, on_grid(&simulated)?);
    let row = |(dimension, values): &(Dimension, Vec<f64>)| {
        let alike = |(other, signal): &(Dimension, Vec<f64>)| {
            if other == dimension { correlation(values, signal) } else { None }
        };
        simulated.iter().map(alike).collect()
    };
    Some(measured.iter().map(row).collect())
}
