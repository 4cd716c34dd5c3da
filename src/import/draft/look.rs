//! What is in a channel.

use crate::foreign::Table;
use crate::units::Unit;
use crate::units::number::significant;

/// A channel of a file with its figures, in the unit of the file.
#[derive(Clone, Debug)]
pub struct Look {
    pub table: usize,
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

/// Largest deviation from even steps, as a share of a step.
const EVEN: f64 = 0.2;

pub fn look(number: usize, table: &Table) -> Vec<Look> {
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
            let (first, last) =
                (there.first().copied().unwrap_or(0.0), there.last().copied().unwrap_or(0.0));
            let step = (last - first) / (n - 1.0).max(1.0);
            let even = increases
                && there
                    .iter()
                    .enumerate()
                    .all(|(at, value)| (value - (first + step * at as f64)).abs() <= EVEN * step);
            let unit_text = channel.unit.as_deref().unwrap_or("").trim().to_string();
            Look {
                table: number,
                name: channel.name.clone(),
                unit: Unit::parse(&unit_text).ok(),
                unit_text,
                comment: channel.comment.clone().filter(|comment| !comment.trim().is_empty()),
                rate: table.rate,
                rows: channel.values.len(),
                missing: channel.values.len() - there.len(),
                low: there.iter().copied().fold(f64::INFINITY, f64::min),
                high: there.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                mean,
                deviation,
                increases,
                even,
            }
        })
        .collect()
}

impl Look {
    /// `N; 200 Hz, 1794 rows; -3200 to 5100, mean 1130`
    pub fn in_words(&self) -> String {
        let unit =
            if self.unit_text.is_empty() { "no unit".to_string() } else { self.unit_text.clone() };
        let rate = self
            .rate
            .map_or_else(|| "rate not known".to_string(), |rate| format!("{} Hz", short(rate)));
        let missing = if self.missing == 0 {
            String::new()
        } else {
            format!(", {} without a value", self.missing)
        };
        let comment = self.comment.as_ref().map_or_else(String::new, |comment| {
            format!("; \"{}\"", comment.trim().replace(['\n', '\r'], " "))
        });
        if self.missing == self.rows {
            return format!("{unit}; {rate}, {} rows, no values{comment}", self.rows);
        }
        format!(
            "{unit}; {rate}, {} rows{missing}; {} to {}, mean {}{comment}",
            self.rows,
            short(self.low),
            short(self.high),
            short(self.mean)
        )
    }
}

/// Four digits.
pub fn short(value: f64) -> String {
    significant(value, 4).to_string()
}
