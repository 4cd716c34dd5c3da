//! What is in a channel.

use crate::foreign::{Table, even_step};
use crate::units::Unit;
use crate::units::number::significant;

/// A channel of a file with its figures, in the unit of the file.
#[derive(Clone, Debug, Default)]
pub struct Look {
    pub name: String,
    /// As the file has it; empty if it has none.
    pub unit_text: String,
    pub unit: Option<Unit>,
    pub comment: Option<String>,
    pub rate: Option<f64>,
    pub rows: usize,
    pub missing: usize,
    pub low: f64,
    pub high: f64,
    pub mean: f64,
    pub deviation: f64,
    /// Whether the values increase from row to row, and in even steps.
    pub increases: bool,
    pub even: bool,
}

/// What is in the channels of a table.
pub fn look(table: &Table) -> Vec<Look> {
    table
        .channels
        .iter()
        .map(|channel| {
            let there: Vec<f64> =
                channel.values.iter().copied().filter(|value| value.is_finite()).collect();
            let n = there.len().max(1) as f64;
            let mean = there.iter().sum::<f64>() / n;
            let deviation =
                (there.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt();
            let increases = there.len() > 1
                && there.len() == channel.values.len()
                && there.windows(2).all(|pair| pair[1] > pair[0]);
            // Of two units, a person decides.
            let unit = channel.unit.as_deref().filter(|_| channel.other_unit.is_none());
            let unit_text = unit.unwrap_or("").trim().to_string();
            let units = channel.unit.as_ref().zip(channel.other_unit.as_ref());
            let units = units.map(|(one, other)| format!("units {one} and {other}"));
            Look {
                name: channel.name.clone(),
                unit: Unit::parse(&unit_text).ok(),
                unit_text,
                comment: units
                    .or_else(|| channel.comment.clone())
                    .filter(|text| !text.trim().is_empty()),
                rate: table.rate,
                rows: channel.values.len(),
                missing: channel.values.len() - there.len(),
                low: there.iter().copied().fold(f64::INFINITY, f64::min),
                high: there.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                mean,
                deviation,
                increases,
                even: increases && even_step(&there).is_some(),
            }
        })
        .collect()
}

impl Look {
    /// `N; 200 Hz, 1794 rows; -3200 to 5100, mean 1130`
    pub fn in_words(&self) -> String {
        let unit = if self.unit_text.is_empty() { "no unit" } else { &self.unit_text };
        let rate = self.rate.map_or("rate not known".into(), |rate| format!("{} Hz", short(rate)));
        let values = match self.missing {
            missing if missing == self.rows => ", no values".to_string(),
            missing => {
                let without = match missing {
                    0 => String::new(),
                    missing => format!(", {missing} without a value"),
                };
                let [low, high, mean] = [self.low, self.high, self.mean].map(short);
                format!("{without}; {low} to {high}, mean {mean}")
            }
        };
        let comment = self.comment.as_ref().map_or_else(String::new, |comment| {
            format!("; \"{}\"", comment.trim().replace(['\n', '\r'], " "))
        });
        format!("{unit}; {rate}, {} rows{values}{comment}", self.rows)
    }
}

/// Four digits.
pub fn short(value: f64) -> String {
    significant(value, 4).to_string()
}
