//! Scales with round tick values.

use super::style::{TICK, text_width};
use crate::report::number;

/// Two values, or two edges in points: from one to the other.
pub type Range = (f64, f64);

/// A linear scale from values to points on the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub low: f64,
    pub high: f64,
    /// Position of `low`, in points.
    pub from: f64,
    /// Position of `high`, in points.
    pub to: f64,
}

impl Scale {
    /// The values of a range between two positions, in points.
    pub fn new((low, high): Range, (from, to): Range) -> Self {
        Self { low, high, from, to }
    }

    /// Position of a value, in points.
    pub fn at(&self, value: f64) -> f64 {
        // Halved, so that a very large range does not overflow.
        self.from
            + (value / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0)
                * (self.to - self.from)
    }

    /// Whether a value is within the scale.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Position of a value, or of the end of the scale that it is beyond.
    pub fn within(&self, value: f64) -> f64 {
        self.at(value.clamp(self.low, self.high))
    }

    /// At most `most` round values within the scale.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        let step = round_step((self.high / 2.0 - self.low / 2.0) * 2.0 / most.max(1) as f64);
        if !(step.is_finite() && step > 0.0) {
            return Vec::new();
        }
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let first = (self.low / step - 1e-9).ceil();
        (0..=most)
            .map(|n| (first + n as f64) * step)
            .take_while(|value| *value <= self.high + 1e-9 * step)
            .map(|value| Tick { value, label: number::fixed(value, decimals) })
            .collect()
    }
}

/// A position on an axis with its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    pub label: String,
}

/// Space of a y axis with at most so many numbers and a title to its left, in points.
pub fn room(range: Range, most: usize) -> f64 {
    number_room(&Scale::new(range, (0.0, 1.0)).ticks(most)) + 11.5
}

/// Space of the numbers alone.
pub fn number_room(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|tick| text_width(&tick.label, TICK)).fold(0.0, f64::max) + 5.0
}

/// A range over all values with a margin at both ends; -1 to 1 without values.
pub fn over(values: impl IntoIterator<Item = f64>) -> Range {
    let (low, high) = extent(values).unwrap_or((-1.0, 1.0));
    let room = 0.06 * (high - low);
    (low - room, high + room)
}

/// Minimum and maximum of the finite values, widened if they are equal.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<Range> {
    let (low, high) = values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    if low > high {
        return None;
    }
    let least = low.abs().max(high.abs()) * 1e-9;
    if high - low > least {
        return Some((low, high));
    }
    let around = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
    Some((low - around, high + around))
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `width`.
fn round_step(width: f64) -> f64 {
    let power = 10_f64.powf(width.log10().floor());
    let step = [1.0, 2.0, 5.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|step| *step >= width * (1.0 - 1e-9));
    step.unwrap_or(10.0 * power)
}

/// Title of an axis with its unit: `measured [kN]`.
pub fn title(what: &str, unit: &str) -> String {
    let unit = number::unit(unit);
    if unit == number::NONE { what.to_owned() } else { format!("{what} [{unit}]") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, most: usize) -> Vec<String> {
        Scale { low, high, from: 0.0, to: 1.0 }
            .ticks(most)
            .into_iter()
            .map(|tick| tick.label)
            .collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(-1.25, 1.25, 6), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(0.0, 37.0, 5), ["0", "10", "20", "30"]);
        assert_eq!(labels(0.0012, 0.0049, 5), ["0.002", "0.003", "0.004"]);
        assert_eq!(labels(1000.0, 9000.0, 5), ["2000", "4000", "6000", "8000"]);
        assert_eq!(labels(0.0, 0.0, 5), [""; 0]);
        assert!(labels(f64::MIN, f64::MAX, 5).len() <= 6);
    }

    #[test]
    fn scales_cover_their_values_and_survive_having_none() {
        assert_eq!(extent([]), None);
        assert_eq!(extent([f64::NAN, 2.0, 5.0]), Some((2.0, 5.0)));
        assert_eq!(extent([0.0]), Some((-1.0, 1.0)));
        assert_eq!(extent([-50.0, -50.0]), Some((-55.0, -45.0)));
        let scale = Scale::new(over([1.0, 3.0]), (100.0, 0.0));
        assert!(
            scale.at(1.0) < 100.0 && scale.at(3.0) > 0.0 && (scale.at(2.0) - 50.0).abs() < 1e-12
        );
        assert_eq!(Scale { low: f64::MIN, high: f64::MAX, from: 0.0, to: 8.0 }.at(0.0), 4.0);
    }

    #[test]
    fn titles_name_units() {
        assert_eq!(title("measured", "m/s^2"), "measured [m/s²]");
        assert_eq!(title("measured", "-"), "measured");
    }
}
