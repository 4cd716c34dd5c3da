//! The mark of one pair, with its tooltip.

use super::kit::*;
use crate::report::sides::Sides;
use crate::result::{PairValue, QuantityResult};

/// The pairs of a quantity, and the decimals of their values.
#[derive(Clone, Copy, Debug)]
pub struct Pairs<'a> {
    quantity: &'a QuantityResult,
    decimals: usize,
}

impl<'a> Pairs<'a> {
    /// With the decimals that tell the differences apart.
    pub fn new(quantity: &'a QuantityResult) -> Self {
        let differences = quantity.values.iter().map(|pair| pair.difference);
        Self::with_decimals_of(quantity, differences)
    }

    /// With the decimals that tell some values apart.
    pub fn with_decimals_of(
        quantity: &'a QuantityResult,
        values: impl Iterator<Item = f64>,
    ) -> Self {
        Self { quantity, decimals: number::decimals(&quantity.unit, values) }
    }

    /// Draws the mark of a pair, identified for scripts.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        pair: &PairValue,
        look: (Mark, Color),
        at: Point,
        radius: f64,
    ) {
        let title = self.tooltip(pair);
        let group = Group { class: "mark pair", ..Group::mark(&title) }.edge(0.35);
        canvas.group(&group.at(&pair.section, pair.zone.as_deref()), |canvas| {
            canvas.mark(look, at, radius);
        });
    }

    fn tooltip(&self, pair: &PairValue) -> String {
        let shown = |value: f64| {
            number::with_unit(&number::fixed(value, self.decimals), &self.quantity.unit)
        };
        let mut text = format!("{}, {}", pair.section, pair.signal);
        if let Some(record) = &pair.record {
            text.push_str(&format!(", {record}"));
        }
        if let Some(zone) = &pair.zone {
            text.push_str(&format!(", zone {zone}"));
        }
        match (pair.simulated, pair.measured) {
            (Some(simulated), Some(measured)) => {
                let Sides { one, other, .. } = Sides::of(self.quantity);
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
}
