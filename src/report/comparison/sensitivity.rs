//! Sensitivity of metrics to disturbances.

use super::{metric, three};
use crate::report::document::*;
use crate::result::comparison::{Comparison, Sensitivity};

/// A curve: its name, and its values by size.
pub type Curve = (String, Vec<(f64, f64)>);

/// Each disturbance with the curves of the metrics that have limits, in their order.
pub fn disturbances(found: &Comparison) -> Vec<(&str, Vec<Curve>)> {
    let mut all: Vec<(&str, Vec<Curve>)> = Vec::new();
    for one in found.sensitivity.iter().filter(|one| one.limited) {
        let points = one
            .sizes
            .iter()
            .zip(&one.values)
            .filter_map(|(size, value)| Some((*size, (*value)?)))
            .collect();
        let curve = (metric(one, found), points);
        match all.iter_mut().find(|(name, _)| *name == one.disturbance) {
            Some((_, curves)) => curves.push(curve),
            None => all.push((&one.disturbance, vec![curve])),
        }
    }
    all.retain(|(_, curves)| curves.iter().any(|(_, points)| !points.is_empty()));
    all
}

pub fn chapter(found: &Comparison) -> Option<Chapter> {
    let first = found.sensitivity.first()?;
    let mut blocks = vec![Block::text(
        "A disturbance of size x changes the measured samples of a section by x times their standard deviation, as an rms over the section, before any filter. This holds for an offset, a gain, a shift in time and white noise, so that the same size is the same change. The choice of sections of size x leaves out the share x of the sections, drawn at random. The sensitivity is the root mean square of the change of value / limit, over all requirements of the metric and all campaigns.",
    )];
    for (at, (name, _)) in disturbances(found).iter().enumerate() {
        let caption = format!(
            "Sensitivity to {name}: rms change of value / limit over the size of the disturbance"
        );
        let alt = format!("Curves of the sensitivity to {name}; the numbers are in the table.");
        blocks.push(Figure::new(format!("sensitivity-{at}"), caption, alt, 200).into());
    }
    let row = |one: &Sensitivity| {
        let mut row = cells![Cell::sentence(metric(one, found)), Cell::sentence(&one.disturbance)];
        row.extend(one.values.iter().map(|value| three(*value)));
        let changed: Vec<String> = one.verdicts_changed.iter().map(ToString::to_string).collect();
        row.push(format!("{} of {}", changed.join(", "), one.verdicts).into());
        row
    };
    let caption = "Sensitivity by size; at the end, the number of verdicts of the protocol that change at each size";
    let rows = found.sensitivity.iter().filter(|one| one.limited).map(row);
    let table = Table::new(caption)
        .text("Metric")
        .short("Disturbance")
        .numbers(first.sizes.iter().map(|size| format!("Size {size}")))
        .number("Verdicts changed")
        .rows(rows);
    blocks.push(table.into());
    Some(Chapter::new("sensitivity", "Sensitivity", blocks))
}
