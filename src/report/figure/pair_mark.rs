//! The mark of one pair, with its tooltip.

use super::canvas::Group;
use crate::report::number;
use crate::report::sides::Sides;
use crate::result::{PairValue, QuantityResult};

/// The group of one pair's mark, identified for scripts.
pub(super) fn pair_group<'a>(pair: &'a PairValue, title: &'a str) -> Group<'a> {
    Group {
        class: "mark pair",
        edge: 0.35,
        title: Some(title),
        section: Some(&pair.section),
        zone: pair.zone.as_deref(),
        ..Group::default()
    }
}

/// Tooltip of a pair.
pub(super) fn tooltip(pair: &PairValue, quantity: &QuantityResult, decimals: usize) -> String {
    let shown = |value: f64| number::with_unit(&number::fixed(value, decimals), &quantity.unit);
    let mut text = format!("{}, {}", pair.section, pair.signal);
    if let Some(record) = &pair.record {
        text.push_str(&format!(", {record}"));
    }
    if let Some(zone) = &pair.zone {
        text.push_str(&format!(", zone {zone}"));
    }
    match (pair.simulated, pair.measured) {
        (Some(simulated), Some(measured)) => {
            let Sides { one, other, .. } = Sides::of(quantity);
            text.push_str(&format!(
                ": {one} {}, {other} {}, difference {}",
                shown(simulated),
                shown(measured),
                shown(pair.difference)
            ))
        }
        _ => text.push_str(&format!(": {}", shown(pair.difference))),
    }
    text
}
