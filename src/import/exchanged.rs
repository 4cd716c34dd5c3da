//! Channels that were exchanged: a measured channel that agrees with another simulated channel much
//! better than with its own.

use rayon::prelude::*;

use super::mapping::Mapping;
use crate::data::record::Wanted;
use crate::data::{Campaign, RecordKind};
use crate::metrics::resample::{interpolate, uniform_grid};
use crate::metrics::statistics::correlation;
use crate::problem::{Problem, warning};
use crate::source::{Span, Spanned};
use crate::units::{Dimension, Unit};

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
    let (Some(measured), Some(simulated)) =
        (mapping.side(RecordKind::Measurement), mapping.side(RecordKind::Simulation))
    else {
        return Vec::new();
    };
    let (Some(measured), Some(simulated)) = (measured.channels.maps(), simulated.channels.maps())
    else {
        return Vec::new();
    };
    let both: Vec<&Spanned<String>> = measured
        .iter()
        .map(|map| &map.name)
        .filter(|name| simulated.iter().any(|other| other.name.value == name.value))
        .collect();
    let sections: Vec<Vec<Row>> = campaign
        .names
        .par_iter()
        .filter_map(|section| of_section(mapping, campaign, section, &both))
        .collect();
    let mut found = Vec::new();
    for (own, name) in both.iter().enumerate() {
        let other = |rows: &Vec<Row>| {
            let row = &rows[own];
            let with_own = row[own]?;
            let (best, with_other) = row
                .iter()
                .enumerate()
                .filter(|(at, _)| *at != own)
                .filter_map(|(at, value)| Some((at, (*value)?)))
                .max_by(|a, b| a.1.total_cmp(&b.1))?;
            (with_other > LEAST && with_other > with_own + MORE)
                .then_some((best, with_other, with_own))
        };
        let told: Vec<(usize, f64, f64)> = sections.iter().filter_map(other).collect();
        // The channel named most often, in more than half of the sections.
        let Some(most) =
            (0..both.len()).max_by_key(|at| told.iter().filter(|(best, ..)| best == at).count())
        else {
            continue;
        };
        let of_most: Vec<&(usize, f64, f64)> =
            told.iter().filter(|(best, ..)| *best == most).collect();
        if 2 * of_most.len() > sections.len() {
            let mean = |value: &dyn Fn(&(usize, f64, f64)) -> f64| {
                of_most.iter().map(|one| value(one)).sum::<f64>() / of_most.len() as f64
            };
            found.push(problem(
                name,
                both[most],
                (mean(&|one| one.1), mean(&|one| one.2)),
                (of_most.len(), sections.len()),
            ));
        }
    }
    found
}

fn problem(
    name: &Spanned<String>,
    other: &Spanned<String>,
    (with_other, with_own): (f64, f64),
    (told, all): (usize, usize),
) -> Problem {
    let says = format!(
        "the measured `{}` agrees with the simulated `{}` (correlation {with_other:.2}) better than with its own ({with_own:.2}), in {told} of {all} sections",
        name.value, other.value
    );
    let at: &Span = &name.span;
    warning("exchanged", says, at)
        .also(&other.span, "the other channel")
        .help("check whether the two channels are exchanged in one of the records")
}

/// The correlations of all channels in a section; `None` if its records cannot be compared.
fn of_section(
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
    let [measured, simulated] = [RecordKind::Measurement, RecordKind::Simulation]
        .map(|kind| campaign.read(kind.into(), section, &wanted, None).ok());
    let (measured, simulated) = (measured?.0, simulated?.0);
    let ends = |record: &crate::data::Record| {
        Some((*record.columns[0].values.first()?, *record.columns[0].values.last()?))
    };
    let (one, other) = (ends(&measured)?, ends(&simulated)?);
    let (start, end) = mapping.sections.extent(&section.value).unwrap_or((f64::MIN, f64::MAX));
    let grid =
        uniform_grid(start.max(one.0).max(other.0), end.min(one.1).min(other.1), STEP).ok()?;
    let on_grid = |record: &crate::data::Record| -> Option<Vec<(Unit, Vec<f64>)>> {
        let axis = &record.columns[0].values;
        record.columns[1..]
            .iter()
            .map(|column| {
                Some((column.unit.clone(), interpolate(axis, &column.values, &grid).ok()?))
            })
            .collect()
    };
    let (measured, simulated) = (on_grid(&measured)?, on_grid(&simulated)?);
    let row = |(unit, values): &(Unit, Vec<f64>)| {
        simulated
            .iter()
            .map(|(of, other)| {
                (of.dimension == unit.dimension).then(|| correlation(values, other)).flatten()
            })
            .collect()
    };
    Some(measured.iter().map(row).collect())
}
