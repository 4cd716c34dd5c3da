//! Reference levels of a diagram of differences: mean, standard deviation and their limits.

use plotters::style::RGBColor;

use super::legend::Entry;
use super::style::{self, BLUE, DASH_DOT, DASHED, DOTTED, Dash, INK, SHADE, SOLID, VERMILION};
use crate::report::{estimates, number};
use crate::result::{QuantityResult, StatisticResult};

/// Most limits that the legend names one by one.
const NAMED: usize = 4;

/// A horizontal line over some of the sections.
#[derive(Clone, Debug)]
pub struct Level {
    pub value: f64,
    pub color: RGBColor,
    pub width: f64,
    pub dash: Dash,
    /// `all`, or a zone.
    pub scope: String,
}

/// A background between two values over some of the sections.
#[derive(Clone, Debug)]
pub struct Band {
    pub low: f64,
    pub high: f64,
    pub scope: String,
}

/// Lines and backgrounds with their legend.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    pub lines: Vec<Level>,
    pub bands: Vec<Band>,
    pub legend: Vec<Entry>,
}

impl Levels {
    /// Levels of the statistics in the unit of the values.
    ///
    /// The limit of a standard deviation is drawn around the mean, for comparison with the band of the standard deviation.
    pub fn of(quantity: &QuantityResult) -> Self {
        if quantity.from.is_some() {
            return Self::of_assessed(quantity);
        }
        let mut levels = Self::default();
        let two_sided = quantity.has_sides || quantity.values.iter().any(|pair| pair.difference < 0.0);
        for statistic in quantity.statistics.iter().filter(|statistic| statistic.unit == quantity.unit && statistic.divided_at.is_none()) {
            match statistic.name.as_str() {
                "mean" => levels.mean(statistic, two_sided),
                "std" => levels.deviation(statistic, center(quantity, &statistic.scope)),
                _ => levels.other(statistic, two_sided),
            }
        }
        levels
    }

    /// Limits of an assessed quantity zone by zone. Its estimates are not drawn: one for a further value may lie far beyond all values.
    fn of_assessed(quantity: &QuantityResult) -> Self {
        let mut levels = Self::default();
        let two_sided = quantity.values.iter().any(|pair| pair.difference < 0.0);
        for statistic in quantity.statistics.iter().filter(|statistic| statistic.unit == quantity.unit && statistic.divided_at.is_none()) {
            let zones = estimates::zones(statistic);
            for scope in if zones.is_empty() { vec!["all"] } else { zones } {
                for value in statistic.limit.iter().flat_map(|limit| both(0.0, *limit, two_sided)) {
                    if !levels.lines.iter().any(|line| line.scope == scope && line.value == value) {
                        levels.lines.push(Level { value, color: INK, width: 0.9, dash: DASHED, scope: scope.to_owned() });
                    }
                }
            }
        }
        if !levels.lines.is_empty() {
            let mut all: Vec<f64> = levels.lines.iter().map(|line| line.value.abs()).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            let decimals = number::decimals(&quantity.unit, all.iter().copied());
            let texts: Vec<String> = all.iter().map(|limit| number::fixed(*limit, decimals)).collect();
            let says = match texts.as_slice() {
                [one] => format!("limit {}{one}", sign(two_sided)),
                [first, .., last] if texts.len() > NAMED => format!("limits {}{first} to {last}", sign(two_sided)),
                several => format!("limits {}{}", sign(two_sided), several.join(", ")),
            };
            levels.explain(Entry::line(INK, 0.9, DASHED, says));
        }
        levels
    }

    /// All values of lines and backgrounds.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.lines.iter().map(|line| line.value).chain(self.bands.iter().flat_map(|band| [band.low, band.high]))
    }

    fn line(&mut self, statistic: &StatisticResult, values: &[f64], (color, width, dash): (RGBColor, f64, Dash), text: String) {
        let scope = statistic.scope.clone();
        self.lines.extend(values.iter().map(|value| Level { value: *value, color, width, dash, scope: scope.clone() }));
        self.explain(Entry::line(color, width, dash, text));
    }

    /// Adds an entry once for the same level of several zones.
    fn explain(&mut self, entry: Entry) {
        if !self.legend.iter().any(|known| known.text == entry.text) {
            self.legend.push(entry);
        }
    }

    fn mean(&mut self, statistic: &StatisticResult, two_sided: bool) {
        if let Some(value) = statistic.value {
            self.line(statistic, &[value], (BLUE, 1.3, SOLID), says(statistic, &shown(statistic, value)));
        }
        if let Some(limit) = statistic.limit {
            let text = says_of_limit(statistic, &format!("{}{}", sign(two_sided), shown(statistic, limit)));
            self.line(statistic, &both(0.0, limit, two_sided), (BLUE, 0.9, DASHED), text);
        }
    }

    fn deviation(&mut self, statistic: &StatisticResult, center: f64) {
        if let Some(value) = statistic.value {
            self.bands.push(Band { low: center - value, high: center + value, scope: statistic.scope.clone() });
            self.explain(Entry::ground(SHADE, format!("mean ± {}", says(statistic, &shown(statistic, value)))));
        }
        if let Some(limit) = statistic.limit {
            let text = format!("mean ± {}", says_of_limit(statistic, &shown(statistic, limit)));
            self.line(statistic, &both(center, limit, true), (VERMILION, 0.9, DOTTED), text);
        }
    }

    fn other(&mut self, statistic: &StatisticResult, two_sided: bool) {
        let color = style::color(2);
        if let Some(value) = statistic.value.filter(|_| statistic.name != "each") {
            self.line(statistic, &[value], (color, 1.1, DASH_DOT), says(statistic, &shown(statistic, value)));
        }
        if let Some(limit) = statistic.limit {
            let text = says_of_limit(statistic, &format!("{}{}", sign(two_sided), shown(statistic, limit)));
            self.line(statistic, &both(0.0, limit, two_sided), (INK, 0.9, DASHED), text);
        }
    }
}

/// The mean of the same scope, around which a standard deviation is drawn.
fn center(quantity: &QuantityResult, scope: &str) -> f64 {
    let stated = quantity.statistics.iter().find(|one| one.name == "mean" && one.scope == scope).and_then(|one| one.value);
    stated.unwrap_or_else(|| {
        let within = quantity.values.iter().filter(|pair| speaks_of(scope, pair.zone.as_deref()));
        let (sum, count) = within.fold((0.0, 0_u32), |(sum, count), pair| (sum + pair.difference, count + 1));
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    })
}

/// Whether a scope (`all`, `zone 3`) contains a zone.
pub fn speaks_of(scope: &str, zone: Option<&str>) -> bool {
    scope == "all" || zone.is_some_and(|zone| scope.strip_prefix("zone ").unwrap_or(scope) == zone)
}

fn both(center: f64, limit: f64, two_sided: bool) -> Vec<f64> {
    if two_sided { vec![center - limit, center + limit] } else { vec![center + limit] }
}

fn sign(two_sided: bool) -> &'static str {
    if two_sided { "±" } else { "" }
}

/// The value as in the tables, with the decimals of the limit.
fn shown(statistic: &StatisticResult, value: f64) -> String {
    let decimals = number::decimals(&statistic.unit, statistic.limit.or(Some(value)));
    statistic.limit.map_or_else(|| number::fixed(value, decimals), |limit| number::beside(value, limit, decimals))
}

/// A statistic and its value; without value if it differs between zones.
fn says(statistic: &StatisticResult, value: &str) -> String {
    if statistic.scope == "all" { format!("{} {value}", statistic.title) } else { format!("{} by zone", statistic.title) }
}

fn says_of_limit(statistic: &StatisticResult, limit: &str) -> String {
    if statistic.scope == "all" { format!("limit of {} {limit}", statistic.title) } else { format!("limit of {} by zone", statistic.title) }
}
